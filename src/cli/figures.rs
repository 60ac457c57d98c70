//! The figures by which a person judges a result: label and value, short enough for one line of the preview.

use super::open_state;
use crate::fabrication::hinge_table::HingeRow;
use crate::fabrication::product::Product;
use crate::kirigami::quality::{Fit, Quality};
use crate::output::design_json;

/// Label and value.
type Row = (&'static str, String);

/// Those of a job's result, with how it fits its targets.
pub fn of_job(product: &Product, quality: &Quality) -> Vec<(String, String)> {
    let mut rows = vec![
        counts(product),
        mean_edge(quality),
        ("asked edge", format!("{:.3} mm", quality.asked_edge)),
        length_error(quality),
        bending(quality),
    ];
    rows.extend(fit_rows(quality));
    if quality.closed_step_max > 0.0 {
        rows.push(("step at closed hinges", format!("{:.3} mm", quality.closed_step_max)));
    }
    rows.extend([
        ("area expansion", format!("{:.3}", quality.area_expansion)),
        ("target's stretch", format!("{:.3}", quality.stretch_ratio)),
    ]);
    rows.extend(turns(product.hinges()));
    named(rows).chain(open_state::figures(quality)).collect()
}

/// Those of a design that was laid out: of its target only what it tells itself.
pub fn of_layout(product: &Product, quality: &Quality) -> Vec<(String, String)> {
    let mut rows = vec![counts(product), mean_edge(quality), length_error(quality), bending(quality)];
    if quality.distance_max.is_finite() {
        rows.push(("off the target", format!("{:.3} mm", quality.distance_max)));
    }
    rows.extend(turns(product.hinges()));
    named(rows).collect()
}

fn named(rows: Vec<Row>) -> impl Iterator<Item = (String, String)> {
    rows.into_iter().map(|(label, value)| (label.to_owned(), value))
}

fn counts(product: &Product) -> Row {
    ("pieces, hinges", format!("{}, {}", product.design().pieces.len(), product.hinges().len()))
}

fn mean_edge(quality: &Quality) -> Row {
    ("mean edge", format!("{:.3} mm", quality.mean_edge))
}

fn length_error(quality: &Quality) -> Row {
    ("length error", format!("{:.1e} relative", quality.max_length_error))
}

fn bending(quality: &Quality) -> Row {
    ("bending", format!("{:.1e} edges", quality.planarity))
}

/// How far the hinges turn, and how far their axes lean.
fn turns(hinges: &[HingeRow]) -> [Row; 2] {
    let angles = hinges.iter().map(|row| row.angle.to_degrees());
    let (least, most) = angles.fold((f64::INFINITY, 0.0_f64), |(l, m), a| (l.min(a), m.max(a)));
    let tilt = hinges.iter().map(|row| row.tilt.to_degrees()).fold(0.0, f64::max);
    [("hinge angles", format!("{least:.1} to {most:.1} deg")), ("largest tilt", format!("{tilt:.1} deg"))]
}

/// How the design fits its targets: one column, or where both states have a target one for each.
fn fit_rows(quality: &Quality) -> Vec<Row> {
    let cell = std::f64::consts::SQRT_2 * quality.mean_edge;
    let both = |figure: &dyn Fn(&Fit) -> String| match quality.fits.as_slice() {
        [(_, fit)] => figure(fit),
        fits => fits
            .iter()
            .map(|(state, fit)| format!("{} {}", design_json::state_name(*state), figure(fit)))
            .collect::<Vec<_>>()
            .join(", "),
    };
    let both_states = quality.fits.len() > 1;
    let boundary = |fit: &Fit| match fit.held {
        true if both_states => format!("{:.2} mm", fit.boundary_max),
        true => format!("{:.2} mm ({:.2} pieces)", fit.boundary_max, fit.boundary_max / cell),
        false => String::from("free"),
    };
    let mut rows = vec![
        ("off the target", both(&|fit| format!("{:.3} mm", fit.distance_max))),
        ("off, of diagonal", both(&|fit| format!("{:.1e}", fit.distance_max / fit.target_diagonal))),
        ("boundary gap", both(&boundary)),
        ("piece centres off", both(&|fit| format!("{:.3} mm", fit.sagitta_max))),
    ];
    if quality.fits.iter().any(|(_, fit)| !fit.held) {
        rows.push(("area covered", both(&|fit| format!("{:.0} %", 100.0 * fit.covered))));
    }
    rows
}
