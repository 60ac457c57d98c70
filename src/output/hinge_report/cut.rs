//! The `cut` block of `hinges.json`: how the sheet is cut, and what that takes.

use serde_json::{Value, json};

use crate::fabrication::layout::Tabs;
use crate::fabrication::plan::{CutOrder, CutReport, EngraveReport, LeadReport, LeadShape, Pierce, Times};

/// The block.
pub fn cut_object(report: &CutReport) -> Value {
    let copies: Vec<[f64; 2]> = report.copies.iter().map(|by| [by.x, by.y]).collect();
    let finite = |value: f64| value.is_finite().then_some(value);
    let price = report
        .price
        .map(|price| json!({ "cuts": price.cuts, "travel_mm": price.travel, "time_s": price.time }));
    json!({
        "kerf_applied": true,
        "copies_mm": copies,
        "pierce": match report.pierce {
            Pierce::SlitEnd => "slit-end",
            Pierce::MidSlit => "mid-slit",
            Pierce::Scrap => "scrap",
        },
        "order": match report.order {
            CutOrder::Travel => "travel",
            CutOrder::Heat { .. } => "heat",
        },
        "hinge_rest_s": finite(report.rest.least),
        "hinge_distance_mm": finite(report.rest.apart),
        "early_cuts": report.rest.early,
        "price": price,
        "leads": report.leads.as_ref().map(leads),
        "tabs": report.tabs.as_ref().map(tabs),
        "engraved": report.engraved.as_ref().map(engraved),
        "end_gap_mm": finite(report.end_gap),
        "join_tolerance_mm": finite(report.join_tolerance()),
        "passes": report.passes,
        "cuts": report.cuts,
        "length_mm": report.length,
        "travel_mm": report.travel.length,
        "travel_bound_mm": report.travel.bound,
        "travel_least_mm": report.least_way,
        "time_s": report.times.as_ref().map(times),
        "cost": report.times.as_ref().and_then(Times::cost),
    })
}

fn leads(leads: &LeadReport) -> Value {
    json!({
        "shape": match leads.shape {
            LeadShape::Line => "line",
            LeadShape::Arc => "arc",
        },
        "count": leads.count,
        "lengths_mm": leads.lengths,
        "without": leads.without,
    })
}

fn tabs(tabs: &Tabs) -> Value {
    json!({
        "width_mm": tabs.width,
        "places_mm": tabs.places.iter().map(|place| [place.x, place.y]).collect::<Vec<_>>(),
    })
}

fn engraved(engraved: &EngraveReport) -> Value {
    json!({
        "texts": engraved.texts,
        "length_mm": engraved.length,
        "pieces_too_small": engraved.too_small,
        "named": engraved.named,
    })
}

fn times(times: &Times) -> Value {
    json!({
        "total": times.total(),
        "cutting": times.cutting,
        "travel": times.travel,
        "piercing": times.piercing,
    })
}
