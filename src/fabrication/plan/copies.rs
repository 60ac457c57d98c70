//! Several copies of a part on one sheet: in rows from the lower left, the first where the part lies.

use kurbo::{Affine, Rect, Vec2};

use super::error::PlanError;
use crate::fabrication::layout::{CutPath, PathVertex};
use crate::profile::Sheet;

/// What rounding may take of the room, millimetres.
const ROUNDING: f64 = 1e-6;

/// Where each copy lies, from the first one, row by row. `part`: the burned box of the first, at the sheet's margins;
/// `spacing`: between burned boxes, millimetres.
///
/// # Errors
/// More copies than fit, with how many do.
pub fn offsets(part: Rect, sheet: &Sheet, copies: usize, spacing: f64) -> Result<Vec<Vec2>, PlanError> {
    let fit = |size: f64, from: f64, side: f64| {
        let room = side - sheet.margin - from - size;
        1 + ((room + ROUNDING) / (size + spacing)).max(0.0) as usize
    };
    let columns = fit(part.width(), part.x0, sheet.width);
    let rows = fit(part.height(), part.y0, sheet.height);
    if copies > columns * rows {
        return Err(PlanError::TooManyCopies {
            copies,
            fit: columns * rows,
            columns,
            rows,
            width: part.width(),
            height: part.height(),
            spacing,
        });
    }
    let step = [part.width() + spacing, part.height() + spacing];
    let place = |copy: usize| Vec2::new((copy % columns) as f64 * step[0], (copy / columns) as f64 * step[1]);
    Ok((0..copies).map(place).collect())
}

/// A cut elsewhere.
pub fn moved(path: &CutPath, by: Vec2) -> CutPath {
    let vertex = |v: &PathVertex| PathVertex { point: Affine::translate(by) * v.point, bulge: v.bulge };
    CutPath { vertices: path.vertices.iter().map(vertex).collect(), ..path.clone() }
}
