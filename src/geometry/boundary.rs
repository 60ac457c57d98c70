//! The boundary of a disk-shaped mesh as a closed curve: nearest points and outward directions.

use super::mesh::TriMesh;
use super::{Point3, Vector3};
use rstar::{AABB, PointDistance, RTree, RTreeObject};
use std::collections::BTreeMap;

/// A mesh's boundary curve prepared for nearest-point queries.
pub struct BoundaryCurve {
    segments: RTree<Segment>,
    /// Points of the curve, in order.
    pub points: Vec<Point3>,
}

/// The point of a boundary curve nearest to a query point.
#[derive(Debug, Clone, Copy)]
pub struct BoundaryPoint {
    /// The point.
    pub point: Point3,
    /// Unit vector tangent to the surface, perpendicular to the boundary, pointing out of the surface; at a vertex of
    /// the curve the mean of the two sides', so that rounding does not decide to which side a corner belongs.
    pub conormal: Vector3,
}

struct Segment {
    ends: [Point3; 2],
    conormal: Vector3,
    /// At the two ends.
    end_conormals: [Vector3; 2],
}

/// Nearer to an end of a segment than this part of its length counts as the end: far above rounding.
const AT_END: f64 = 1e-6;

impl Segment {
    /// Where along the segment, 0 to 1, the nearest point lies.
    fn parameter(&self, query: &Point3) -> f64 {
        let along = self.ends[1] - self.ends[0];
        ((query - self.ends[0]).dot(&along) / along.norm_squared()).clamp(0.0, 1.0)
    }

    fn closest(&self, query: &Point3) -> BoundaryPoint {
        let t = self.parameter(query);
        let conormal = match t {
            t if t < AT_END => self.end_conormals[0],
            t if t > 1.0 - AT_END => self.end_conormals[1],
            _ => self.conormal,
        };
        BoundaryPoint { point: self.ends[0] + (self.ends[1] - self.ends[0]) * t, conormal }
    }
}

impl RTreeObject for Segment {
    type Envelope = AABB<[f64; 3]>;

    fn envelope(&self) -> Self::Envelope {
        AABB::from_corners(self.ends[0].into(), self.ends[1].into())
    }
}

impl PointDistance for Segment {
    fn distance_2(&self, point: &[f64; 3]) -> f64 {
        let query = Point3::from(*point);
        (self.closest(&query).point - query).norm_squared()
    }
}

impl BoundaryCurve {
    /// The boundary of a disk. `cycle` holds its boundary loop, the surface on the left
    /// (see [`super::topology::disk`]).
    pub fn new(mesh: &TriMesh, cycle: &[usize]) -> Self {
        let opposite: BTreeMap<(usize, usize), usize> =
            mesh.faces.iter().flat_map(|&[a, b, c]| [((a, b), c), ((b, c), a), ((c, a), b)]).collect();
        let count = cycle.len();
        let conormals: Vec<Vector3> = (0..count)
            .map(|i| {
                let (u, v) = (cycle[i], cycle[(i + 1) % count]);
                let [a, b, c] = [u, v, opposite[&(u, v)]].map(|w| mesh.vertices[w]);
                let along = (b - a).normalize();
                let inward = (c - a) - along * (c - a).dot(&along);
                -inward.normalize()
            })
            .collect();
        // The conormals of two sides that turn back on each other cancel; either is as good then.
        let mean =
            |i: usize, j: usize| (conormals[i] + conormals[j]).try_normalize(1e-6).unwrap_or(conormals[i]);
        let points: Vec<Point3> = cycle.iter().map(|&v| mesh.vertices[v]).collect();
        let segments = (0..count)
            .map(|i| {
                let (before, after) = ((i + count - 1) % count, (i + 1) % count);
                Segment {
                    ends: [points[i], points[after]],
                    conormal: conormals[i],
                    end_conormals: [mean(before, i), mean(i, after)],
                }
            })
            .collect();
        Self { segments: RTree::bulk_load(segments), points }
    }

    /// The nearest point of the curve.
    ///
    /// # Panics
    /// Never for a curve made by [`BoundaryCurve::new`].
    pub fn closest(&self, query: &Point3) -> BoundaryPoint {
        let nearest = self.segments.nearest_neighbor(&[query.x, query.y, query.z]);
        nearest.expect("a curve with segments").closest(query)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_does_not_decide_to_which_side_a_corner_belongs() {
        let vertices = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]].map(|[x, y]| Point3::new(x, y, 0.0));
        let mesh = TriMesh { vertices: vertices.to_vec(), faces: vec![[0, 1, 2], [0, 2, 3]] };
        let curve = BoundaryCurve::new(&mesh, &[0, 1, 2, 3]);
        let diagonal = Vector3::new(1.0, 1.0, 0.0).normalize();
        // On the corner, off it by rounding in all directions, and outside of both sides.
        for (x, y) in [(0.0, 0.0), (1e-15, -1e-14), (-1e-14, 1e-15), (-1e-15, -1e-15), (0.3, 0.1), (0.1, 0.3)]
        {
            let found = curve.closest(&Point3::new(2.0 + x, 1.0 + y, 0.4));
            assert!((found.conormal - diagonal).norm() < 1e-12, "{x} {y}: {}", found.conormal);
            assert!((found.point - vertices[2]).norm() < 1e-12);
        }
        let found = curve.closest(&Point3::new(2.5, 0.5, 0.0));
        assert_eq!((found.point, found.conormal), (Point3::new(2.0, 0.5, 0.0), Vector3::x()));
    }
}
