//! Whether a rim comes too close to itself: thin webs of a piece between two stretches of one cut, and windows
//! that close up.

use kurbo::Point;
use rstar::primitives::{GeomWithData, Line};
use rstar::{AABB, RTree};

use crate::fabrication::error::FabricationError;
use crate::fabrication::layout::{CutKind, CutPath};
use crate::fabrication::web::{kind_name, nearest_on_segment, segment_gap};

/// Chords stay this near to arcs, millimetres: coarse, since webs and windows are a hundred times wider.
const TOLERANCE: f64 = 2e-3;
/// Stretches that are nearer along the cut than this many limits form a corner, no web: sharper than 30 degrees it
/// counts as one all the same.
const CORNER: f64 = 4.0;

/// Checks every path against itself: where it turns its left sides to each other at least `min_web` of material
/// stands between the burned grooves, where it turns its right sides at least `kerf` lies between them.
///
/// `paths`: closed, the material to the left.
///
/// # Errors
/// The first place that is too narrow.
pub fn check_rims(paths: &[CutPath], kerf: f64, min_web: f64) -> Result<(), FabricationError> {
    paths.iter().try_for_each(|path| check_rim(path, kerf, min_web))
}

fn check_rim(path: &CutPath, kerf: f64, min_web: f64) -> Result<(), FabricationError> {
    let segments = path.segments(TOLERANCE);
    let count = segments.len();
    let mut along = Vec::with_capacity(count + 1);
    along.push(0.0);
    for (i, [a, b]) in segments.iter().enumerate() {
        along.push(along[i] + a.distance(*b));
    }
    let item = |(i, [a, b]): (usize, &[Point; 2])| GeomWithData::new(Line::new([a.x, a.y], [b.x, b.y]), i);
    let tree = RTree::bulk_load(segments.iter().enumerate().map(item).collect());
    let needed = kerf + min_web;
    for (i, &[a, b]) in segments.iter().enumerate() {
        let low = [a.x.min(b.x) - needed, a.y.min(b.y) - needed];
        let high = [a.x.max(b.x) + needed, a.y.max(b.y) + needed];
        for other in tree.locate_in_envelope_intersecting(&AABB::from_corners(low, high)) {
            let j = other.data;
            if j <= i + 1 || (i == 0 && j + 1 == count) {
                continue; // each pair once, neighbours never
            }
            let (gap, at) = segment_gap([a, b], segments[j]);
            let on_the_way = (along[j] - along[i + 1]).min(along[count] - along[j + 1] + along[i]);
            let material = (b - a).cross(at - nearest_on_segment(at, [a, b])) > 0.0;
            let limit = if material { needed } else { kerf };
            // A micrometre: ligaments may be exactly as wide as the least web.
            if gap > 0.0 && (gap >= limit - 1e-3 || on_the_way < CORNER * limit) {
                continue;
            }
            let Point { x, y } = at;
            if gap > 0.0 && material {
                let name = kind_name(path.kind);
                let web = gap - kerf;
                return Err(FabricationError::Web { first: name, second: name, x, y, web, limit: min_web });
            }
            let kind = if path.kind == CutKind::Border { "notch in the border" } else { "window" };
            return Err(FabricationError::NarrowWindow { kind, x, y, width: gap, kerf });
        }
    }
    Ok(())
}
