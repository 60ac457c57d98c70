//! The snap of a sheet: `snap.json`, its path as CSV, lines for the terminal.
//!
//! Energies are millijoules (N mm), torques N mm, strains plain ratios, shares those of the hinges' full turns.

use std::fmt::Write as _;

use serde_json::{Value, json};

use crate::snap::assess::{CellSnap, Snap};
use crate::snap::sheet::Sample;

mod plot;

pub use plot::write_plot;

/// The version of the format that is written.
pub const VERSION: u64 = 1;

/// The model, in a line; `docs/snap.md` tells the rest.
pub const MODEL: &str = "rigid pieces, ligaments as springs in series with the pieces' compliance; energies elastic, all \
                         cells at once; 'snaps' of the mean cell with ligaments that yield";

/// The report's object.
pub fn object(snap: &Snap, profile: &str) -> Value {
    let sheet = &snap.sheet;
    json!({
        "version": VERSION,
        "profile": profile,
        "model": MODEL,
        "bistable": sheet.bistable,
        "snaps": snap.cell.as_ref().map(|cell| cell.passage.snaps()),
        "barrier_mj": sheet.barrier,
        "back_barrier_mj": sheet.back_barrier,
        "largest_strain": sheet.worst.strain,
        "largest_strain_hinge": sheet.worst.hinge,
        "largest_strain_share": sheet.worst.share,
        "released": sample(&sheet.released),
        "path": sheet.path.iter().map(sample).collect::<Vec<_>>(),
        "back": sheet.back.iter().map(sample).collect::<Vec<_>>(),
        "cell": snap.cell.as_ref().map(cell),
    })
}

fn sample(sample: &Sample) -> Value {
    json!({ "share": sample.share, "energy_mj": sample.energy, "largest_strain": sample.strain })
}

fn cell(snap: &CellSnap) -> Value {
    let passage = &snap.passage;
    json!({
        "rectangle_mm": snap.cell.rectangle,
        "phi_deg": snap.cell.phi.to_degrees(),
        "rectangles": snap.rectangles,
        "snapping": snap.snapping,
        "barrier_mj": snap.barrier,
        "back_barrier_mj": snap.back_barrier,
        "snaps": passage.snaps(),
        "resistance_n_mm": passage.resistance,
        "release_n_mm": passage.release.max(0.0),
        "work_mj": passage.work,
        "torques_n_mm": passage.torques,
    })
}

/// The path to the open state and back as CSV.
pub fn csv(snap: &Snap) -> String {
    let mut text = String::from("way,share,energy_mj,largest_strain,hinge\n");
    let ways = [("out", &snap.sheet.path), ("back", &snap.sheet.back)];
    for (way, samples) in ways {
        for s in samples {
            _ = writeln!(text, "{way},{:.6},{:.6},{:.6},{}", s.share, s.energy, s.strain, s.hinge);
        }
    }
    text
}

/// Label and value, for the terminal and the summary of a run.
pub fn figures(snap: &Snap) -> Vec<(String, String)> {
    let sheet = &snap.sheet;
    let rest = if sheet.bistable {
        format!("yes, at {:.0} % of its turns", 100.0 * sheet.released.share)
    } else {
        format!("no, goes back to {:.0} %", 100.0 * sheet.released.share)
    };
    let mut rows = vec![
        ("stays put (elastic)", rest),
        ("barrier", format!("{:.1} mJ out, {:.1} mJ back", sheet.barrier, sheet.back_barrier)),
        (
            "strain on the way",
            format!(
                "{:.1} % at hinge {}, {:.0} % open",
                100.0 * sheet.worst.strain,
                sheet.worst.hinge,
                100.0 * sheet.worst.share
            ),
        ),
    ];
    if let Some(cell) = &snap.cell {
        let passage = &cell.passage;
        let verdict = if passage.snaps() { "snaps" } else { "does not snap" };
        rows.extend([
            (
                "mean cell",
                format!(
                    "{:.2} x {:.2} mm, phi {:.1} deg",
                    cell.cell.rectangle[0],
                    cell.cell.rectangle[1],
                    cell.cell.phi.to_degrees()
                ),
            ),
            (
                "cell, yielding",
                format!("{verdict}; {} of {} rectangles snap", cell.snapping, cell.rectangles),
            ),
            (
                "cell's torque",
                format!(
                    "{:.1} N mm against, {:.1} N mm with the snap",
                    passage.resistance,
                    passage.release.max(0.0)
                ),
            ),
        ]);
    }
    rows.into_iter().map(|(label, value)| (label.to_owned(), value)).collect()
}
