//! What cuts of all sheets have in common.

use kurbo::{Point, Rect};
use rstar::RTree;
use rstar::primitives::GeomWithData;

use super::layout::CutPath;

/// Distance by which flattened arcs may stay inside the true ones, millimetres: far below any laser's accuracy.
pub const ARC_TOLERANCE: f64 = 1e-4;

/// Ends that coincide meet on purpose, millimetres.
const SAME_POINT: f64 = 1e-5;

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

/// The two ends of all open cuts.
pub fn ends(paths: &[CutPath]) -> impl Iterator<Item = (usize, Point)> + '_ {
    let open = paths.iter().enumerate().filter(|(_, path)| !path.closed);
    open.flat_map(|(index, path)| [0, path.vertices.len() - 1].map(|i| (index, path.vertices[i].point)))
}

/// Least distance between ends of different cuts that do not coincide, millimetres; infinite where there are none. Programs that
/// join ends with a greater tolerance weld cuts together.
pub fn end_gap(paths: &[CutPath]) -> f64 {
    let points: Vec<_> =
        ends(paths).map(|(path, point)| GeomWithData::new([point.x, point.y], path)).collect();
    let tree = RTree::bulk_load(points.clone());
    let mut least = f64::INFINITY;
    for end in &points {
        for (other, distance2) in tree.nearest_neighbor_iter_with_distance_2(end.geom()) {
            let distance: f64 = distance2;
            if distance >= least * least {
                break;
            }
            if other.data != end.data && distance > SAME_POINT * SAME_POINT {
                least = distance.sqrt();
                break;
            }
        }
    }
    least
}
