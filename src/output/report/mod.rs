//! `report.html`: all that a person decides by, in one page that opens from disk without a network.
//!
//! The page holds its style, its script and one block of JSON ([`Report`] as the script reads it); the script draws and fills in
//! texts as text, so nothing of a job is ever read as markup. It decides nothing: figures, verdicts and words are those of the
//! run. What the reader may try out in it ("what if") is computed with the formulas of [`crate::fabrication::mechanics`]. The
//! same input gives the same bytes. The sheet is drawn in millimetres, y down.

mod hinges;
mod sheet;
mod space;
mod steps;
#[cfg(test)]
mod tests;

use std::io::{self, Write};

use serde_json::{Value, json};

use super::design_json::Stage;
use super::hinge_report::{WriteHingesError, check, summary};
use super::{Heading, snap_report};
use crate::fabrication::hinge_table::{HingeRow, Verdict};
use crate::fabrication::plan::{CutPlan, CutReport, Pierce};
use crate::fabrication::product::Product;
use crate::geometry::closest::ClosestPoints;
use crate::kirigami::design::State;
use crate::kirigami::quality::{Limits, Quality};
use crate::morph::Morph;
use crate::profile::{Material, Process, Profile, Shape, embedded};
use crate::snap::assess::Snap;

const PAGE: &str = include_str!("page.html");
const STYLE: &str = include_str!("style.css");
/// In the order in which they run.
const SCRIPT: [&str; 13] = [
    include_str!("mechanics.js"),
    include_str!("page.js"),
    include_str!("sheet.js"),
    include_str!("detail.js"),
    include_str!("table.js"),
    include_str!("charts.js"),
    include_str!("space.js"),
    include_str!("solid.js"),
    include_str!("orbit.js"),
    include_str!("way.js"),
    include_str!("morph.js"),
    include_str!("what_if.js"),
    include_str!("start.js"),
];

/// What the view in space uses of three.js (three/package.json makes it); it defines `THREE`.
const THREE: &str = include_str!("three/three.min.js");

/// The version of the page's data.
pub const VERSION: u64 = 1;

/// What the page shows.
#[derive(Clone, Copy)]
pub struct Report<'a> {
    /// What it is called, and the figures of the summary.
    pub heading: Heading<'a>,
    /// What became of the run, as the summary says it.
    pub outcome: &'a str,
    /// What is made, with its hinges.
    pub product: &'a Product,
    /// Measures of it.
    pub quality: &'a Quality,
    /// What they had to keep.
    pub limits: &'a Limits,
    /// What the solver did.
    pub stages: &'a [Stage],
    /// What else the summary says, one line each.
    pub remarks: &'a [String],
    /// How a bistable sheet snaps.
    pub snap: Option<&'a Snap>,
    /// How the sheet is cut.
    pub plan: Option<&'a CutPlan>,
    /// What the summary says of that, one line each.
    pub cutting: &'a [String],
    /// The set-up sheet of a sheet that is milled: label and value.
    pub setup: &'a [(&'static str, String)],
    /// Where its program may be begun again, the first line saying how.
    pub restarts: &'a [String],
    /// What is seen besides.
    pub seen: Seen<'a>,
}

/// What the page shows besides; nothing of what is not known.
#[derive(Clone, Copy, Default)]
pub struct Seen<'a> {
    /// The surfaces that states are to become, in the design's coordinates of the state.
    pub targets: &'a [(State, ClosestPoints)],
    /// The map of where the target asks for how much stretch, as SVG.
    pub map: Option<&'a str>,
    /// The way between the states.
    pub morph: Option<&'a Morph>,
}

/// Writes the page.
///
/// # Errors
/// A hinge whose numbers are not finite, before anything is written, or the error of `out`.
pub fn write<W: Write>(report: &Report<'_>, mut out: W) -> Result<(), WriteHingesError> {
    check(report.product.hinges())?;
    let data = for_script(&serde_json::to_string(&object(report)).map_err(io::Error::from)?);
    let title = for_html(&format!("{}: report", report.heading.name));
    let script = SCRIPT.join("\n");
    // Filled in one pass: what is put in is not searched for further places.
    let mut rest = PAGE;
    while let Some((before, after)) = rest.split_once("{{") {
        let (name, after) = after.split_once("}}").unwrap_or((after, ""));
        out.write_all(before.as_bytes())?;
        out.write_all(match name {
            "title" => title.as_bytes(),
            "style" => STYLE.as_bytes(),
            "data" => data.as_bytes(),
            "three" => THREE.as_bytes(),
            _ => script.as_bytes(),
        })?;
        rest = after;
    }
    out.write_all(rest.as_bytes())?;
    Ok(out.flush()?)
}

/// JSON in which no markup begins: `<` only stands in texts there, where it can be escaped.
fn for_script(json: &str) -> String {
    json.replace('<', "\\u003c")
}

fn for_html(text: &str) -> String {
    super::plain_line(text).replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// All that the script reads.
fn object(report: &Report) -> Value {
    let Heading { name, target, profile, figures } = report.heading;
    let rows = report.product.hinges();
    let mut materials = vec![material(&profile.material)];
    let others = embedded().into_iter().map(|other| material(&other.material));
    materials.extend(others.filter(|other| *other != materials[0]).collect::<Vec<_>>());
    let (columns, words) = hinges::columns(report.product);
    json!({
        "version": VERSION,
        "program": concat!("kirimorph ", env!("CARGO_PKG_VERSION")),
        "job": name,
        "target": target,
        "profile": profile.name,
        "material": format!("{}, {} mm thick", profile.material.name, profile.sheet.thickness),
        "process": match profile.process {
            Process::Laser => "laser",
            Process::Milling => "milling",
        },
        "verdict": verdict(report.outcome, rows),
        "figures": figures,
        "limits": limits(report),
        "remarks": report.remarks,
        "snap": report.snap.map(snap_report::figures),
        "sheet": sheet::object(report),
        "space": space::object(report),
        "map": report.seen.map,
        "mechanics": mechanics(profile),
        "materials": materials,
        "hinges": columns,
        "words": words,
        "cut": report.plan.map_or_else(Vec::new, |plan| cut(&plan.report, profile)),
        "cut_lines": report.cutting,
        "setup": report.setup,
        "restarts": report.restarts,
        "steps": steps::steps(report),
        "stages": report.stages.iter().map(stage).collect::<Vec<_>>(),
    })
}

fn verdict(outcome: &str, rows: &[HingeRow]) -> Value {
    let level = match rows.iter().map(|row| row.verdict).max() {
        Some(Verdict::Fail) => "fail",
        Some(Verdict::Warn) => "warn",
        _ => "ok",
    };
    json!({ "level": level, "text": outcome, "hinges": summary(rows).map(|summary| summary.to_string()) })
}

/// The figures that have limits; those that compare with a target only where there is one.
fn limits(report: &Report) -> Vec<Value> {
    let Report { quality, heading: Heading { profile, .. }, .. } = report;
    let allowed = report.limits;
    let edge = quality.mean_edge;
    let cell = std::f64::consts::SQRT_2 * edge;
    let mut rows = vec![
        ("relative length error", quality.max_length_error, allowed.length_error, ""),
        ("bending of pieces, in edges", quality.planarity, allowed.planarity, ""),
    ];
    if !quality.target_diagonal.is_nan() {
        let deviation = (edge / quality.asked_edge - 1.0).abs();
        rows.extend([
            ("hinge points off the target", quality.distance_max, allowed.distance_edges * edge, " mm"),
            ("target not covered", quality.coverage_max, allowed.boundary_cells * cell, " mm"),
            ("boundary gap", quality.boundary_max, allowed.boundary_cells * cell, " mm"),
            ("mean edge beside the asked one, relative", deviation, allowed.edge_deviation, ""),
        ]);
    }
    let hinges = report.product.hinges();
    let largest = |figure: fn(&HingeRow) -> f64| hinges.iter().map(figure).fold(0.0, f64::max);
    // Chosen lengths meet the limit up to rounding.
    let strain = profile.material.strain_limit * (1.0 + 1e-6);
    rows.push(("largest strain of a hinge", largest(|row| row.strain), strain, ""));
    rows.into_iter()
        // Not known, or not asked for.
        .filter(|(_, value, limit, _)| !value.is_nan() && limit.is_finite())
        .map(|(what, value, limit, unit)| {
            json!({
                "what": what,
                "value": format!("{}{unit}", figure(value)),
                "limit": format!("{}{unit}", figure(limit)),
                "kept": value <= limit,
            })
        })
        .collect()
}

fn figure(value: f64) -> String {
    if value == 0.0 || value.abs() >= 1e-3 { format!("{value:.3}") } else { format!("{value:.1e}") }
}

/// What the formulas of the page need: lengths in millimetres, modulus in MPa.
pub fn mechanics(profile: &Profile) -> Value {
    let (shape, compliance) = match profile.ligament.shape {
        Shape::Beam(beam) => ("beam", beam.root_compliance),
        Shape::Rounded(beam) => ("rounded", beam.root_compliance),
        Shape::Notch { .. } => ("notch", 0.0),
    };
    json!({
        "width": profile.ligament.width,
        "thickness": profile.sheet.thickness,
        "kerf": profile.cut.kerf,
        "shape": shape,
        "rootCompliance": compliance,
        "lengths": profile.ligament_lengths(),
        "material": material(&profile.material),
    })
}

fn material(material: &Material) -> Value {
    json!({
        "name": material.name,
        "youngsModulus": material.youngs_modulus,
        "yieldStrain": material.yield_strain,
        "strainLimit": material.strain_limit,
        "elongation": material.elongation,
        "enduranceStrain": material.endurance_strain,
        "coffinManson": material.coffin_manson,
    })
}

/// What cutting takes: label and value.
fn cut(report: &CutReport, profile: &Profile) -> Vec<(&'static str, String)> {
    let seconds = |value: f64| format!("{value:.0} s ({:.1} min)", value / 60.0);
    let mut rows = vec![
        (
            "stock",
            format!(
                "{} x {} mm, {} mm thick",
                profile.sheet.width, profile.sheet.height, profile.sheet.thickness
            ),
        ),
        ("groove", format!("{} mm wide, already applied", report.kerf)),
        ("copies", report.copies.len().to_string()),
        ("length of the cuts", format!("{:.2} m", 1e-3 * report.length)),
    ];
    // What a mill does besides, its own lines tell.
    if profile.process == Process::Milling {
        return rows;
    }
    rows.extend([
        ("passes", report.passes.to_string()),
        ("cuts", report.cuts.to_string()),
        ("way between them", format!("{:.2} m", 1e-3 * report.travel.length)),
        (
            "slits begin",
            match report.pierce {
                Pierce::SlitEnd | Pierce::Scrap => "at an end".to_owned(),
                Pierce::MidSlit => "away from ligaments".to_owned(),
            },
        ),
    ]);
    if let Some(times) = &report.times {
        rows.extend([
            ("time, about", seconds(times.total())),
            ("of it cutting", seconds(times.cutting)),
            ("travel", seconds(times.travel)),
            ("piercing", seconds(times.piercing)),
        ]);
        rows.extend(times.cost().map(|cost| ("cost", format!("{cost:.2}"))));
    }
    rows
}

/// What a stage of the solver did, phase by phase.
fn stage(stage: &Stage) -> Value {
    let phases = stage.reports.iter().map(|report| {
        let energies: Vec<_> = report.iterations.iter().map(|iteration| &iteration.energies).collect();
        json!({ "terms": report.terms, "energies": energies })
    });
    json!({
        "name": stage.name,
        "stopped": stage.reports.last().map_or("no iterations recorded", |report| report.termination.reason()),
        "phases": phases.collect::<Vec<_>>(),
    })
}
