//! `hinges.csv`: RFC 4180 quoting, line feeds, a header line, decimals with a point.

use std::borrow::Cow;
use std::io::{BufWriter, Write};

use super::{WriteHingesError, check, nearest_cut, verdict_name};
use crate::fabrication::hinge_table::HingeRow;

/// The header; the order is that of `hinges.json`.
const COLUMNS: [&str; 27] = [
    "id",
    "piece_j",
    "piece_k",
    "x_mm",
    "y_mm",
    "z_mm",
    "axis_x",
    "axis_y",
    "axis_z",
    "tilt_deg",
    "angle_deg",
    "width_mm",
    "length_mm",
    "effective_length_mm",
    "pole_offset_mm",
    "centre_offset_mm",
    "strain",
    "strain_class",
    "stiffness_n_mm_per_rad",
    "conditioned_stiffness_n_mm_per_rad",
    "width_margin_mm",
    "heat_margin_mm",
    "torque_n_mm",
    "fatigue",
    "nearest_cut_mm",
    "verdict",
    "reason",
];

/// Decimals of millimetres: 0.1 micrometre, a thousandth of a fine kerf.
const MM: usize = 4;
/// Decimals of an axis' components: a microradian, as far as the angles' decimals go.
const AXIS: usize = 6;
/// Decimals of degrees: 0.001 degrees are 0.2 micrometres on a piece of 10 mm.
const DEGREES: usize = 3;
/// Decimals of strains: 0.001 per cent, a hundredth of steel's yield strain.
const STRAIN: usize = 5;
/// Decimals of torques, N mm.
const TORQUE: usize = 3;

/// Writes `hinges.csv`.
///
/// # Errors
/// A number that is not finite, before anything is written, or the error of `out`.
pub fn write_csv<W: Write>(rows: &[HingeRow], out: W) -> Result<(), WriteHingesError> {
    check(rows)?;
    let mut out = BufWriter::new(out);
    writeln!(out, "{}", COLUMNS.join(","))?;
    for row in rows {
        writeln!(out, "{}", fields(row).map(|field| quoted(&field).into_owned()).join(","))?;
    }
    Ok(out.flush()?)
}

fn fields(row: &HingeRow) -> [String; COLUMNS.len()] {
    let optional = |value: Option<f64>, decimals| value.map_or(String::new(), |value| fixed(value, decimals));
    [
        row.id.to_string(),
        row.pieces[0].to_string(),
        row.pieces[1].to_string(),
        fixed(row.point.x, MM),
        fixed(row.point.y, MM),
        fixed(row.point.z, MM),
        fixed(row.axis.x, AXIS),
        fixed(row.axis.y, AXIS),
        fixed(row.axis.z, AXIS),
        fixed(row.tilt.to_degrees(), DEGREES),
        fixed(row.angle.to_degrees(), DEGREES),
        fixed(row.width, MM),
        fixed(row.length, MM),
        fixed(row.effective_length, MM),
        fixed(row.pole_offset, MM),
        fixed(row.centre_offset, MM),
        fixed(row.strain, STRAIN),
        row.strain_class.to_string(),
        fixed(row.stiffness, TORQUE),
        optional(row.conditioned_stiffness, TORQUE),
        fixed(row.width_margin, MM),
        optional(row.heat_margin, MM),
        optional(row.torque, TORQUE),
        row.fatigue.to_string(),
        optional(nearest_cut(row), MM),
        verdict_name(row.verdict).to_string(),
        row.reason.clone(),
    ]
}

/// A number with fixed decimals and without a negative zero.
pub(super) fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(digits) if digits.bytes().all(|byte| matches!(byte, b'0' | b'.')) => digits.to_string(),
        _ => text,
    }
}

/// A field in quotes where it holds a comma, a quote or a line break.
fn quoted(field: &str) -> Cow<'_, str> {
    if field.contains([',', '"', '\n', '\r']) {
        Cow::Owned(format!("\"{}\"", field.replace('"', "\"\"")))
    } else {
        Cow::Borrowed(field)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_have_no_sign() {
        let shown = [-0.00004, 0.00004, -0.00006, -1.0, 12.34567].map(|value| fixed(value, MM));
        assert_eq!(shown, ["0.0000", "0.0000", "-0.0001", "-1.0000", "12.3457"]);
        assert_eq!(fixed(-0.4, 0), "0");
    }

    #[test]
    fn quotes_where_needed_only() {
        assert_eq!(quoted("plain; text 1.5 %"), "plain; text 1.5 %");
        assert_eq!(quoted("a, \"b\""), "\"a, \"\"b\"\"\"");
        assert_eq!(quoted("a\nb"), "\"a\nb\"");
    }
}
