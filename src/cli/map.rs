//! The map of where a target asks for how much stretch, as files and reports show it.

use std::ops::ControlFlow;

use crate::job::Job;
use crate::output::stretch_map::{StretchMap, write_figure};
use crate::pipeline::{Clock, Prediction, Progress, predict};

/// The figure of the report; `None` where nothing can be predicted.
pub fn figure(job: &Job, clock: &mut Clock) -> Option<String> {
    clock.run("feasibility", |_| {
        let mut quiet = |_: &Progress| ControlFlow::Continue(());
        let prediction = predict(job, &mut Clock::new(&mut quiet)).ok()?;
        let mut svg = Vec::new();
        write_figure(&map(&prediction, "", &figures(&prediction)), &mut svg).ok()?;
        String::from_utf8(svg).ok()
    })
}

/// The map with its title and figures.
pub fn map<'a>(
    prediction: &'a Prediction,
    title: &'a str,
    figures: &'a [(String, String)],
) -> StretchMap<'a> {
    let found = &prediction.feasibility;
    StretchMap {
        title,
        mesh: &prediction.mesh,
        flat: &prediction.flat,
        openings: &found.openings,
        beyond: &found.beyond,
        worst: found.worst.triangle,
        figures,
    }
}

/// The numbers: label and value.
pub fn figures(prediction: &Prediction) -> Vec<(String, String)> {
    let found = &prediction.feasibility;
    let ([low, high], worst) = (found.range, &found.worst);
    let rows = [
        ("triangles", prediction.mesh.faces.len().to_string()),
        ("worst stretch ratio", format!("{:.4}", found.worst_ratio)),
        ("conformal ratio", format!("{:.4}", found.conformal_ratio)),
        ("opening stretches", format!("{low:.3} to {high:.3}")),
        ("area within reach", format!("{:.2} %", 100.0 * found.reached)),
        ("off full opening, mean", format!("{:.2} %", 100.0 * found.mean_deviation)),
        ("off full opening, most", format!("{:.2} %", 100.0 * found.largest_deviation)),
        ("worst at face", prediction.worst_face.to_string()),
        ("worst place", format!("{:.2}, {:.2}, {:.2} mm", worst.at.x, worst.at.y, worst.at.z)),
        ("stretches there", format!("{:.3} and {:.3}", worst.stretches[0], worst.stretches[1])),
        ("verdict", found.verdict.word().to_owned()),
    ];
    rows.into_iter().map(|(label, value)| (label.to_owned(), value)).collect()
}
