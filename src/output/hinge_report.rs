//! The hinge placement report: `hinges.json`, `hinges.csv`, and a table for the terminal.
//!
//! Both files have one row per hinge and the same columns; the CSV splits pairs and vectors. Lengths are millimetres,
//! angles degrees, strains plain ratios, points and axes in the sheet's frame. `hinges.json` holds full precision and
//! is described in `docs/hinges.schema.json`; `hinges.csv` is RFC 4180 with line feeds and rounds to 0.1 micrometre. Not
//! known (a torque above yield, the distance to another cut where there is none) is null in JSON, empty in CSV.

mod csv;
mod cut;
mod table;

use std::io::{self, BufWriter, Write};

use serde::Serialize;

use super::json_rows::write_rows;
use crate::fabrication::hinge_table::{HingeRow, Verdict};
use crate::fabrication::plan::CutReport;
use crate::profile::Profile;

pub use csv::write_csv;
pub use cut::cut_object;
pub use table::{Extreme, Summary, summary, table};

/// The version of the format that is written.
pub const VERSION: u64 = 1;

/// Why no report was written.
#[derive(Debug, thiserror::Error)]
pub enum WriteHingesError {
    /// A number is NaN or infinite.
    #[error("cannot write the hinge report: hinge {hinge}: {column} is {value}, not a finite number")]
    NotFinite {
        /// The hinge's id.
        hinge: usize,
        /// The key in `hinges.json`.
        column: &'static str,
        /// Its value.
        value: f64,
    },
    /// The output refused the bytes.
    #[error("cannot write the hinge report: {0}")]
    Io(#[from] io::Error),
}

/// Writes `hinges.json`; `cut`: what cutting takes, where there is a sheet to cut; `mill`: what milling takes.
///
/// # Errors
/// A number that is not finite, before anything is written, or the error of `out`.
pub fn write_json<W: Write>(
    rows: &[HingeRow],
    profile: &Profile,
    cut: Option<&CutReport>,
    mill: Option<&serde_json::Value>,
    out: W,
) -> Result<(), WriteHingesError> {
    check(rows)?;
    let name = serde_json::to_string(&profile.name).map_err(io::Error::from)?;
    let mut out = BufWriter::new(out);
    writeln!(out, "{{\n  \"version\": {VERSION},\n  \"profile\": {name},")?;
    writeln!(out, "  \"kerf_mm\": {:?},", profile.cut.kerf)?;
    writeln!(out, "  \"ligament_width_mm\": {:?},", profile.ligament.width)?;
    writeln!(out, "  \"sheet_thickness_mm\": {:?},", profile.sheet.thickness)?;
    writeln!(out, "  \"sheet_mm\": [{:?}, {:?}],", profile.sheet.width, profile.sheet.height)?;
    let cut = serde_json::to_string(&cut.map(cut_object)).map_err(io::Error::from)?;
    writeln!(out, "  \"cut\": {cut},")?;
    if let Some(mill) = mill {
        writeln!(out, "  \"mill\": {mill},")?;
    }
    write_rows(&mut out, "  ", "hinges", rows.iter().map(JsonRow::new))?;
    writeln!(out, "\n}}")?;
    Ok(out.flush()?)
}

/// Refuses numbers that are not finite; only the distance to a next cut that does not exist may be infinite.
pub(super) fn check(rows: &[HingeRow]) -> Result<(), WriteHingesError> {
    for row in rows {
        let numbers = [
            ("point", row.point.x),
            ("point", row.point.y),
            ("point", row.point.z),
            ("axis", row.axis.x),
            ("axis", row.axis.y),
            ("axis", row.axis.z),
            ("tilt_deg", row.tilt),
            ("angle_deg", row.angle),
            ("width_mm", row.width),
            ("length_mm", row.length),
            ("effective_length_mm", row.effective_length),
            ("pole_offset_mm", row.pole_offset),
            ("centre_offset_mm", row.centre_offset),
            ("strain", row.strain),
            ("stiffness_n_mm_per_rad", row.stiffness),
            ("conditioned_stiffness_n_mm_per_rad", row.conditioned_stiffness.unwrap_or(0.0)),
            ("width_margin_mm", row.width_margin),
            ("heat_margin_mm", row.heat_margin.unwrap_or(0.0)),
            ("torque_n_mm", row.torque.unwrap_or(0.0)),
            ("nearest_cut_mm", nearest_cut(row).unwrap_or(0.0)),
        ];
        if let Some(&(column, value)) = numbers.iter().find(|(_, value)| !value.is_finite()) {
            return Err(WriteHingesError::NotFinite { hinge: row.id, column, value });
        }
    }
    Ok(())
}

/// Distance to the next cut; `None` if there is no other cut.
fn nearest_cut(row: &HingeRow) -> Option<f64> {
    (row.nearest_cut != f64::INFINITY).then_some(row.nearest_cut)
}

fn verdict_name(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Ok => "ok",
        Verdict::Warn => "warn",
        Verdict::Fail => "fail",
    }
}

#[derive(Serialize)]
struct JsonRow<'a> {
    id: usize,
    pieces: [usize; 2],
    point: [f64; 3],
    axis: [f64; 3],
    tilt_deg: f64,
    angle_deg: f64,
    width_mm: f64,
    length_mm: f64,
    effective_length_mm: f64,
    pole_offset_mm: f64,
    centre_offset_mm: f64,
    strain: f64,
    strain_class: String,
    stiffness_n_mm_per_rad: f64,
    conditioned_stiffness_n_mm_per_rad: Option<f64>,
    width_margin_mm: f64,
    heat_margin_mm: Option<f64>,
    torque_n_mm: Option<f64>,
    fatigue: String,
    nearest_cut_mm: Option<f64>,
    verdict: &'static str,
    reason: &'a str,
}

impl<'a> JsonRow<'a> {
    fn new(row: &'a HingeRow) -> Self {
        Self {
            id: row.id,
            pieces: row.pieces,
            point: row.point.into(),
            axis: row.axis.into(),
            tilt_deg: row.tilt.to_degrees(),
            angle_deg: row.angle.to_degrees(),
            width_mm: row.width,
            length_mm: row.length,
            effective_length_mm: row.effective_length,
            pole_offset_mm: row.pole_offset,
            centre_offset_mm: row.centre_offset,
            strain: row.strain,
            strain_class: row.strain_class.to_string(),
            stiffness_n_mm_per_rad: row.stiffness,
            conditioned_stiffness_n_mm_per_rad: row.conditioned_stiffness,
            width_margin_mm: row.width_margin,
            heat_margin_mm: row.heat_margin,
            torque_n_mm: row.torque,
            fatigue: row.fatigue.to_string(),
            nearest_cut_mm: nearest_cut(row),
            verdict: verdict_name(row.verdict),
            reason: &row.reason,
        }
    }
}
