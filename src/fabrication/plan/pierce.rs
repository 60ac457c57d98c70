//! Slits that are pierced in the middle: two cuts each, from there to both ends.

use kurbo::Point;
use rstar::RTree;

use crate::fabrication::layout::{CutKind, CutPath, PathVertex};

/// Every slit as two cuts from a place well away from ligaments to its ends, the one to its beginning first.
pub fn in_mid_slit(order: Vec<CutPath>, ligaments: &RTree<[f64; 2]>) -> Vec<CutPath> {
    let halves = |path: CutPath| match path.kind {
        CutKind::Slit => split(&path, ligaments).to_vec(),
        _ => vec![path],
    };
    order.into_iter().flat_map(halves).collect()
}

/// The two halves of a slit of straight segments: split in the middle of the long segment whose middle is farthest from any
/// ligament, the first of those that are nearly so. Short ones lead to the border.
fn split(path: &CutPath, ligaments: &RTree<[f64; 2]>) -> [CutPath; 2] {
    let points: Vec<Point> = path.vertices.iter().map(|vertex| vertex.point).collect();
    let clearance = |i: usize| {
        let middle = points[i].midpoint(points[i + 1]);
        let near = ligaments.nearest_neighbor(&[middle.x, middle.y]);
        near.map_or(f64::INFINITY, |&[x, y]| middle.distance(Point::new(x, y)))
    };
    let lengths: Vec<f64> = points.windows(2).map(|pair| pair[0].distance(pair[1])).collect();
    let longest = lengths.iter().copied().fold(0.0, f64::max);
    let clear: Vec<f64> =
        (0..lengths.len()).map(|i| if lengths[i] < 0.5 * longest { 0.0 } else { clearance(i) }).collect();
    let most = clear.iter().copied().fold(0.0, f64::max);
    let segment = clear.iter().position(|&clear| clear >= 0.9 * most).unwrap_or(0);
    let middle = points[segment].midpoint(points[segment + 1]);
    let cut = |points: &mut dyn Iterator<Item = Point>| CutPath {
        kind: CutKind::Slit,
        vertices: std::iter::once(middle)
            .chain(points)
            .map(|point| PathVertex { point, bulge: 0.0 })
            .collect(),
        closed: false,
    };
    [cut(&mut points[..=segment].iter().rev().copied()), cut(&mut points[segment + 1..].iter().copied())]
}
