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
    /// Unit vector tangent to the surface, perpendicular to the boundary, pointing out of the surface.
    pub conormal: Vector3,
}

struct Segment {
    ends: [Point3; 2],
    conormal: Vector3,
}

impl Segment {
    fn closest(&self, query: &Point3) -> Point3 {
        let along = self.ends[1] - self.ends[0];
        let t = (query - self.ends[0]).dot(&along) / along.norm_squared();
        self.ends[0] + along * t.clamp(0.0, 1.0)
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
        (self.closest(&query) - query).norm_squared()
    }
}

impl BoundaryCurve {
    /// The boundary of a disk. `cycle` holds its boundary loop, the surface on the left
    /// (see [`super::topology::disk`]).
    pub fn new(mesh: &TriMesh, cycle: &[usize]) -> Self {
        let opposite: BTreeMap<(usize, usize), usize> =
            mesh.faces.iter().flat_map(|&[a, b, c]| [((a, b), c), ((b, c), a), ((c, a), b)]).collect();
        let segments = (0..cycle.len())
            .map(|i| {
                let (u, v) = (cycle[i], cycle[(i + 1) % cycle.len()]);
                let [a, b, c] = [u, v, opposite[&(u, v)]].map(|w| mesh.vertices[w]);
                let along = (b - a).normalize();
                let inward = (c - a) - along * (c - a).dot(&along);
                Segment { ends: [a, b], conormal: -inward.normalize() }
            })
            .collect();
        let points = cycle.iter().map(|&v| mesh.vertices[v]).collect();
        Self { segments: RTree::bulk_load(segments), points }
    }

    /// The nearest point of the curve.
    ///
    /// # Panics
    /// Never for a curve made by [`BoundaryCurve::new`].
    pub fn closest(&self, query: &Point3) -> BoundaryPoint {
        let segment =
            self.segments.nearest_neighbor(&[query.x, query.y, query.z]).expect("a curve with segments");
        BoundaryPoint { point: segment.closest(query), conormal: segment.conormal }
    }
}
