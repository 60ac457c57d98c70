//! The `cut` block of `hinges.json`: how the sheet is cut, and what that takes.

use serde_json::{Value, json};

use crate::fabrication::plan::{CutOrder, CutReport, Pierce, Times};

/// The block.
pub fn cut_object(report: &CutReport) -> Value {
    let copies: Vec<[f64; 2]> = report.copies.iter().map(|by| [by.x, by.y]).collect();
    let times = |times: &Times| {
        json!({
            "total": times.total(),
            "cutting": times.cutting,
            "travel": times.travel,
            "piercing": times.piercing,
        })
    };
    json!({
        "kerf_applied": true,
        "copies_mm": copies,
        "pierce": match report.pierce {
            Pierce::SlitEnd => "slit-end",
            Pierce::MidSlit => "mid-slit",
        },
        "order": match report.order {
            CutOrder::Travel => "travel",
            CutOrder::Heat(_) => "heat",
        },
        "hinge_rest_s": report.rest.least.is_finite().then_some(report.rest.least),
        "passes": report.passes,
        "cuts": report.cuts,
        "length_mm": report.length,
        "travel_mm": report.travel.length,
        "travel_bound_mm": report.travel.bound,
        "time_s": report.times.as_ref().map(times),
        "cost": report.times.as_ref().and_then(Times::cost),
    })
}
