//! A JSON file of pieces and motions, version 1; the format is described in `docs/pieces.schema.json`.

use std::path::Path;

use nalgebra::{Matrix3, Quaternion, UnitQuaternion};
use serde::Deserialize;

use super::error::ImportError;
use super::source::Source;
use crate::geometry::read::{MAX_COORDINATE, read_file};
use crate::geometry::rotation::RigidMotion;
use crate::geometry::{Point3, Vector3};

/// The version of the format that is read.
const VERSION: u64 = 1;

/// Largest deviation from a rotation that counts as rounding of printed digits; what is within is made exact.
const ROUNDING: f64 = 1e-5;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileText {
    version: u64,
    state: StateText,
    pieces: Vec<PieceText>,
}

#[derive(Deserialize, Clone, Copy, PartialEq)]
#[serde(rename_all = "lowercase")]
enum StateText {
    Closed,
    Open,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PieceText {
    polygon: Vec<[f64; 3]>,
    rotation: RotationText,
    translation: [f64; 3],
}

#[derive(Deserialize)]
#[serde(untagged)]
enum RotationText {
    Quaternion([f64; 4]),
    Matrix([[f64; 3]; 3]),
}

/// Reads the file.
///
/// # Errors
/// The place and the value that are wrong.
pub fn read_pieces_json(path: &Path) -> Result<Source, ImportError> {
    let wrong = |what: String| ImportError::File { path: path.to_owned(), what };
    let format = |error: serde_json::Error| {
        wrong(format!("{error} (the format is described in docs/pieces.schema.json)"))
    };
    let file: FileText = serde_json::from_slice(&read_file(path)?).map_err(format)?;
    if file.version != VERSION {
        return Err(wrong(format!("version {} of the format; this program reads {VERSION}", file.version)));
    }
    if file.pieces.is_empty() {
        return Err(wrong("there are no pieces".to_owned()));
    }
    let mut source = Source::default();
    for (index, piece) in file.pieces.iter().enumerate() {
        let at_piece = |what: String| wrong(format!("piece {index}: {what}"));
        let polygon = polygon(&piece.polygon).map_err(at_piece)?;
        let translation = Vector3::from(piece.translation);
        check(&translation).map_err(|what| wrong(format!("piece {index}: {what}")))?;
        let rotation = rotation(&piece.rotation).map_err(|what| wrong(format!("piece {index}: {what}")))?;
        let motion = RigidMotion { rotation, translation };
        let moved = polygon.iter().map(|p| motion.apply(p)).collect();
        let (closed, open) =
            if file.state == StateText::Closed { (polygon, moved) } else { (moved, polygon) };
        source.closed.push(closed);
        source.open.push(open);
    }
    Ok(source)
}

fn check(point: &Vector3) -> Result<(), String> {
    match point.iter().find(|c| !c.is_finite() || c.abs() > MAX_COORDINATE) {
        Some(value) => Err(format!("{value:e} is beyond the limit of {MAX_COORDINATE:e}")),
        None => Ok(()),
    }
}

fn polygon(rows: &[[f64; 3]]) -> Result<Vec<Point3>, String> {
    if rows.len() < 3 {
        return Err(format!("its polygon has {} corners; it needs at least 3", rows.len()));
    }
    rows.iter().map(|row| check(&Vector3::from(*row)).map(|()| Point3::from(*row))).collect()
}

fn rotation(text: &RotationText) -> Result<Matrix3<f64>, String> {
    match *text {
        RotationText::Quaternion([w, x, y, z]) => {
            let quaternion = Quaternion::new(w, x, y, z);
            let norm = quaternion.norm();
            if norm.is_nan() || (norm - 1.0).abs() > ROUNDING {
                return Err(format!("its quaternion has length {norm}, not 1"));
            }
            Ok(*UnitQuaternion::from_quaternion(quaternion).to_rotation_matrix().matrix())
        }
        RotationText::Matrix(rows) => {
            let matrix = Matrix3::from_fn(|row, column| rows[row][column]);
            let error = (matrix * matrix.transpose() - Matrix3::identity()).abs().max();
            if error.is_nan() || error > ROUNDING {
                return Err(format!("its matrix is no rotation: R times its transpose is {error:.1e} off 1"));
            }
            if matrix.determinant() < 0.0 {
                return Err("its matrix mirrors (its determinant is -1): a piece can only turn".to_owned());
            }
            let svd = matrix.svd(true, true);
            Ok(svd.u.expect("asked for") * svd.v_t.expect("asked for"))
        }
    }
}
