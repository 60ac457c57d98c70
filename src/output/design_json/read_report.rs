//! Reading the `report` of `design.json` back, for a design whose files are made anew.

use std::collections::BTreeMap;
use std::fmt;

use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};

use super::report::HELD;
use super::{Stage, state_name};
use crate::kirigami::design::State;
use crate::kirigami::quality::{Fit, Quality};
use crate::solver::{Iteration, Report, Termination};

/// What a design file tells of its origin.
#[derive(Debug, Clone)]
pub struct Origin {
    /// Name of the job.
    pub job: String,
    /// Name of the target.
    pub target: String,
    /// Hashes of input files by name.
    pub hashes: BTreeMap<String, String>,
    /// The figures; NaN where the file holds null.
    pub quality: Quality,
    /// What the solver did.
    pub stages: Vec<Stage>,
}

#[derive(serde::Deserialize)]
struct FileText {
    report: ReportText,
}

#[derive(serde::Deserialize)]
struct ReportText {
    job: String,
    target: String,
    hashes: BTreeMap<String, String>,
    stages: Vec<StageText>,
    #[serde(flatten)]
    figures: BTreeMap<String, serde_json::Value>,
}

#[derive(serde::Deserialize)]
struct StageText {
    name: String,
    phases: Vec<String>,
    iterations: Vec<RowText>,
}

#[derive(serde::Deserialize)]
struct RowText {
    phase: usize,
    energies: Energies,
    damping: f64,
}

/// Energies by term in the file's order.
struct Energies(Vec<(String, f64)>);

impl<'de> Deserialize<'de> for Energies {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct InOrder;
        impl<'de> Visitor<'de> for InOrder {
            type Value = Energies;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("energies by term")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Energies, A::Error> {
                let mut rows = Vec::new();
                while let Some(row) = map.next_entry()? {
                    rows.push(row);
                }
                Ok(Energies(rows))
            }
        }
        deserializer.deserialize_map(InOrder)
    }
}

/// Reads the report in the content of a design file. `None` where it is not as this program writes it: a design of
/// another program need not have one.
pub fn parse_report(bytes: &[u8]) -> Option<Origin> {
    let FileText { report } = serde_json::from_slice(bytes).ok()?;
    let figure = |key: &str| report.figures.get(key).and_then(serde_json::Value::as_f64).unwrap_or(f64::NAN);
    let fit = |state: State| {
        let object = report.figures.get(state_name(state))?;
        let figure = |key: &str| object.get(key)?.as_f64();
        let fit = Fit {
            distance_max: figure("distance_max_mm")?,
            sagitta_max: figure("sagitta_max_mm")?,
            coverage_max: figure("coverage_max_mm")?,
            boundary_max: figure("boundary_max_mm")?,
            target_diagonal: figure("target_diagonal_mm")?,
            held: object.get(HELD)?.as_bool()?,
            covered: figure("covered")?,
        };
        Some((state, fit))
    };
    let quality = Quality {
        fits: [State::Closed, State::Open].into_iter().filter_map(fit).collect(),
        closed_step_max: figure("closed_step_max_mm"),
        open_state: None,
        e_isom: figure("e_isom"),
        max_length_error: figure("max_length_error"),
        planarity: figure("planarity"),
        distance_max: figure("distance_max_mm"),
        sagitta_max: figure("sagitta_max_mm"),
        coverage_max: figure("coverage_max_mm"),
        boundary_max: figure("boundary_max_mm"),
        target_diagonal: figure("target_diagonal_mm"),
        mean_edge: figure("mean_edge_mm"),
        asked_edge: figure("asked_edge_mm"),
        area_expansion: figure("area_expansion"),
        stretch_ratio: figure("stretch_ratio"),
    };
    let stages = report.stages.into_iter().map(stage).collect::<Option<_>>()?;
    Some(Origin { job: report.job, target: report.target, hashes: report.hashes, quality, stages })
}

fn stage(text: StageText) -> Option<Stage> {
    let name = ["stage-1", "stage-2", "stage-3"].into_iter().find(|name| *name == text.name)?;
    let mut reports: Vec<Report> = text
        .phases
        .iter()
        .map(|reason| {
            let termination = Termination::ALL.into_iter().find(|known| known.reason() == reason)?;
            Some(Report { terms: Vec::new(), iterations: Vec::new(), next_damping: 0.0, termination })
        })
        .collect::<Option<_>>()?;
    for RowText { phase, energies: Energies(energies), damping } in text.iterations {
        let report = reports.get_mut(phase)?;
        let (terms, energies): (Vec<String>, Vec<f64>) = energies.into_iter().unzip();
        report.terms = terms;
        report.iterations.push(Iteration { energies, damping });
    }
    Some(Stage { name, reports })
}
