//! What cuts of all sheets have in common.

use kurbo::{Point, Rect};

use super::layout::CutPath;

/// Distance by which flattened arcs may stay inside the true ones, millimetres: far below any laser's accuracy.
pub const ARC_TOLERANCE: f64 = 1e-4;

/// Two paths that meet on purpose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Touch {
    /// Indices into the list of paths.
    pub paths: [usize; 2],
    /// Where they meet.
    pub point: Point,
}

/// The box of all paths' centre lines.
pub fn bounding_box(paths: &[CutPath]) -> Rect {
    let mut points = paths.iter().flat_map(|path| path.flatten(ARC_TOLERANCE));
    let first = points.next().unwrap_or_default();
    points.fold(Rect::from_points(first, first), |all, point| all.union_pt(point))
}
