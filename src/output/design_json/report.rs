//! The `report` of `design.json`: provenance, figures, and what the solver did.

use std::io::{self, Write};
use std::path::Path;

use serde::ser::{Serialize, SerializeMap, Serializer};

use serde_json::{Value, json};

use super::{DesignFile, Stage, WriteDesignError, state_name};
use crate::kirigami::design::{Design, State};
use crate::kirigami::guides::{OpenState, Reach};
use crate::kirigami::quality::{Fit, Quality};
use crate::kirigami::rigidity;
use crate::output::json_rows::write_rows;
use crate::solver::Iteration;

/// What a stage without solver reports says about its end.
const NOT_RECORDED: &str = "no iterations recorded";

/// The keys of the figures and their values, in the file's order.
pub fn figures(quality: &Quality) -> [(&'static str, f64); 13] {
    [
        ("e_isom", quality.e_isom),
        ("max_length_error", quality.max_length_error),
        ("planarity", quality.planarity),
        ("distance_max_mm", quality.distance_max),
        ("coverage_max_mm", quality.coverage_max),
        ("boundary_max_mm", quality.boundary_max),
        ("sagitta_max_mm", quality.sagitta_max),
        ("closed_step_max_mm", quality.closed_step_max),
        ("mean_edge_mm", quality.mean_edge),
        ("asked_edge_mm", quality.asked_edge),
        ("area_expansion", quality.area_expansion),
        ("stretch_ratio", quality.stretch_ratio),
        ("target_diagonal_mm", quality.target_diagonal),
    ]
}

/// The keys of the figures of one state and their values.
pub(super) fn fit_figures(fit: &Fit) -> [(&'static str, f64); 6] {
    [
        ("distance_max_mm", fit.distance_max),
        ("coverage_max_mm", fit.coverage_max),
        ("boundary_max_mm", fit.boundary_max),
        ("sagitta_max_mm", fit.sagitta_max),
        ("target_diagonal_mm", fit.target_diagonal),
        ("covered", fit.covered),
    ]
}

/// The figures of a state as the value of its key; null where it has no target.
pub fn fit_object(quality: &Quality, state: State) -> serde_json::Value {
    let Some((_, fit)) = quality.fits.iter().find(|(of, _)| *of == state) else {
        return serde_json::Value::Null;
    };
    let figures = fit_figures(fit).into_iter().map(|(key, value)| (key.to_owned(), value.into()));
    let held = (HELD.to_owned(), fit.held.into());
    serde_json::Value::Object(figures.chain([held]).collect())
}

/// The key that says whether a state's border is held to its target's boundary.
pub(super) const HELD: &str = "boundary_held";

/// The figures that compare with a target, or with what was asked for.
const OF_TARGET: [&str; 8] = [
    "distance_max_mm",
    "coverage_max_mm",
    "boundary_max_mm",
    "sagitta_max_mm",
    "asked_edge_mm",
    "area_expansion",
    "stretch_ratio",
    "target_diagonal_mm",
];

/// Refuses figures and energies that JSON cannot hold.
///
/// Without a target, whose diagonal is then NaN, all figures that compare with one may be NaN; they are written as null.
pub(super) fn check(file: &DesignFile) -> Result<(), WriteDesignError> {
    let finite = |value: f64, place: &dyn Fn() -> String| match value.is_finite() {
        true => Ok(()),
        false => Err(WriteDesignError::NotFinite { place: place(), value }),
    };
    let no_target = file.quality.target_diagonal.is_nan();
    for (key, value) in figures(file.quality) {
        if !(no_target && value.is_nan() && OF_TARGET.contains(&key)) {
            finite(value, &|| format!("report.{key}"))?;
        }
    }
    for (state, fit) in &file.quality.fits {
        for (key, value) in fit_figures(fit) {
            finite(value, &|| format!("report.{}.{key}", state_name(*state)))?;
        }
    }
    if let Some(open) = &file.quality.open_state {
        finite(open.area, &|| "report.open_state.area_mm2".into())?;
        for (i, guide) in open.guides.iter().enumerate() {
            finite(guide.distance + guide.mean_distance, &|| format!("report.guides, guide {i}"))?;
        }
    }
    finite(rigid_residual(file.design), &|| "report.rigid_residual".into())?;
    finite(file.max_strain.unwrap_or(0.0), &|| "report.max_strain".into())?;
    for stage in file.stages {
        for (number, row) in rows(stage).enumerate() {
            let place = |what: &str| format!("report, {}, iteration {number}, {what}", stage.name);
            for (term, &energy) in row.terms.iter().zip(&row.iteration.energies) {
                finite(energy, &|| place(term))?;
            }
            finite(row.iteration.damping, &|| place("damping"))?;
        }
    }
    Ok(())
}

/// Writes `"report": {...}` at an indent of two spaces, without a line end.
pub(super) fn write(file: &DesignFile, out: &mut impl Write) -> io::Result<()> {
    let provenance = &file.provenance;
    writeln!(out, "  \"report\": {{")?;
    write_entry(out, "program", &concat!("kirimorph ", env!("CARGO_PKG_VERSION")))?;
    write_entry(out, "job", &file_name(provenance.job))?;
    write_entry(out, "target", &file_name(provenance.target))?;
    write_entry(out, "hashes", provenance.hashes)?;
    for (key, value) in figures(file.quality) {
        write_entry(out, key, &value)?;
    }
    for state in [State::Closed, State::Open] {
        write_entry(out, state_name(state), &fit_object(file.quality, state))?;
    }
    if let Some(open) = &file.quality.open_state {
        write_entry(out, "open_state", &covered(open))?;
        write_entry(out, "guides", &open.guides.iter().map(reach).collect::<Vec<_>>())?;
    }
    write_entry(out, "rigid_residual", &rigid_residual(file.design))?;
    write_entry(out, "max_strain", &file.max_strain)?;
    write_entry(out, "pieces", &file.design.pieces.len())?;
    write_entry(out, "hinges", &file.design.hinges.len())?;
    write!(out, "    \"stages\": [")?;
    for (i, stage) in file.stages.iter().enumerate() {
        write!(out, "{}\n      {{\n", if i == 0 { "" } else { "," })?;
        write_stage(stage, out)?;
        write!(out, "\n      }}")?;
    }
    write!(out, "{}]\n  }}", if file.stages.is_empty() { "" } else { "\n    " })
}

/// What an open state without a target covers.
fn covered(open: &OpenState) -> Value {
    let [low, high] = open.bounds.map(|p| [p.x, p.y, p.z]);
    json!({ "area_mm2": open.area, "low_mm": low, "high_mm": high })
}

/// How near a guide was reached.
fn reach(guide: &Reach) -> Value {
    json!({
        "kind": if guide.curve { "curve" } else { "point" },
        "places": guide.places,
        "distance_mm": guide.distance,
        "mean_distance_mm": guide.mean_distance,
    })
}

/// How far the least rigid piece is from rigid, in mean sides of the pieces.
fn rigid_residual(design: &Design) -> f64 {
    rigidity::worst(design).map_or(0.0, |worst| worst.strain)
}

fn write_entry<T: Serialize + ?Sized>(out: &mut impl Write, key: &str, value: &T) -> io::Result<()> {
    write!(out, "    \"{key}\": ")?;
    serde_json::to_writer(&mut *out, value)?;
    writeln!(out, ",")
}

fn write_stage(stage: &Stage, out: &mut impl Write) -> io::Result<()> {
    let reasons: Vec<&str> = stage.reports.iter().map(|report| report.termination.reason()).collect();
    for (key, text) in [
        ("name", serde_json::to_string(stage.name)?),
        ("stopped", serde_json::to_string(reasons.last().unwrap_or(&NOT_RECORDED))?),
        ("phases", serde_json::to_string(&reasons)?),
    ] {
        writeln!(out, "        \"{key}\": {text},")?;
    }
    write_rows(out, "        ", "iterations", rows(stage))
}

/// The last part of a path: reports must not tell where somebody keeps files.
fn file_name(path: &str) -> String {
    Path::new(path).file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// One line of a stage's iteration table.
struct Row<'a> {
    phase: usize,
    terms: &'a [String],
    iteration: &'a Iteration,
}

fn rows(stage: &Stage) -> impl Iterator<Item = Row<'_>> {
    stage.reports.iter().enumerate().flat_map(|(phase, report)| {
        let terms = report.terms.as_slice();
        report.iterations.iter().map(move |iteration| Row { phase, terms, iteration })
    })
}

impl Serialize for Row<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(3))?;
        map.serialize_entry("phase", &self.phase)?;
        map.serialize_entry("energies", &Energies(self))?;
        map.serialize_entry("damping", &self.iteration.damping)?;
        map.end()
    }
}

/// The energies by term, in the terms' order.
struct Energies<'a>(&'a Row<'a>);

impl Serialize for Energies<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.terms.iter().zip(&self.0.iteration.energies))
    }
}
