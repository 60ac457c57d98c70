//! Stage 1: the pair of control meshes V (closed) and V' (open).
//!
//! Black vertices are piece centres, white ones the corners of closed pieces; each edge between two pieces is
//! one control face (section 3.1 and Fig. 7 of the paper). The regular grids V0 (cells a x b) and V0' (cells
//! w x w) correspond with the user's principal stretches. V0 lies in the plane as it is; V0' is laid into the
//! target by the inverse of its as-rigid-as-possible flattening.

use super::cover::Cover;
use crate::geometry::boundary::BoundaryCurve;
use crate::geometry::closest::ClosestPoints;
use crate::geometry::mesh::TriMesh;
use crate::geometry::{Point2, Point3, Vector3};

/// Positions of the control vertices in both states.
#[derive(Debug, Clone, PartialEq)]
pub struct ControlMesh {
    /// White vertices of V: corners of the closed sheet.
    pub closed_corners: Vec<Point2>,
    /// Black vertices of V: centres of the closed pieces.
    pub closed_centres: Vec<Point2>,
    /// White vertices of V'.
    pub open_corners: Vec<Point3>,
    /// Black vertices of V'.
    pub open_centres: Vec<Point3>,
}

/// A target prepared for the optimisation: nearest points and boundary.
pub struct Target {
    /// Nearest points on the surface.
    pub surface: ClosestPoints,
    /// Its boundary.
    pub boundary: BoundaryCurve,
}

impl Target {
    /// Prepares a disk. `cycle` holds its boundary loop, the surface on the left.
    pub fn new(mesh: TriMesh, cycle: &[usize]) -> Self {
        Self { boundary: BoundaryCurve::new(&mesh, cycle), surface: ClosestPoints::new(mesh) }
    }
}

/// What the two states are held to.
#[derive(Clone, Copy)]
pub struct Targets<'a> {
    /// The closed state's; `None` where that lies in the plane.
    pub closed: Option<&'a Target>,
    /// The open state's.
    pub open: &'a Target,
}

/// Lays the pair of regular grids of a cover into the plane and into the target.
///
/// `lift` takes the flattening back to the target.
pub fn stage1(cover: &Cover, lift: &LinearMap) -> ControlMesh {
    let [a, b] = cover.cell.closed;
    let corner = |&[i, j]: &[i32; 2]| Point2::new(a * f64::from(i), b * f64::from(j));
    let closed_corners: Vec<Point2> = cover.positions.iter().map(corner).collect();
    let closed_centres = cover
        .mesh
        .pieces
        .iter()
        .map(|piece| {
            let sum: nalgebra::Vector2<f64> = piece.iter().map(|&c| closed_corners[c].coords).sum();
            Point2::from(sum / piece.len() as f64)
        })
        .collect();
    ControlMesh {
        closed_corners,
        closed_centres,
        open_corners: cover.corners.iter().map(|p| lift.apply(p)).collect(),
        open_centres: cover.centres.iter().map(|p| lift.apply(p)).collect(),
    }
}

/// A piecewise linear map from a triangulated part of the plane to space; beyond its boundary the nearest
/// triangle's map goes on.
pub struct LinearMap {
    flat: ClosestPoints,
    image: TriMesh,
}

impl LinearMap {
    /// The map that takes vertex i of the flat triangulation to vertex i of `image`.
    pub fn new(image: TriMesh, flat: &[Point2]) -> Self {
        let vertices = flat.iter().map(|p| Point3::new(p.x, p.y, 0.0)).collect();
        Self { flat: ClosestPoints::new(TriMesh { vertices, faces: image.faces.clone() }), image }
    }

    /// The image of the nearest point of the triangulation.
    pub fn apply_nearest(&self, p: &Point2) -> Point3 {
        let found = self.flat.closest(&Point3::new(p.x, p.y, 0.0));
        let corners = self.image.faces[found.triangle].map(|v| self.image.vertices[v].coords);
        Point3::from((0..3).map(|i| corners[i] * found.barycentric[i]).sum::<Vector3>())
    }

    /// The image of a point.
    pub fn apply(&self, p: &Point2) -> Point3 {
        let face = self.flat.closest(&Point3::new(p.x, p.y, 0.0)).triangle;
        let face = self.image.faces[face];
        let [a, b, c] = face.map(|v| self.flat.mesh().vertices[v].xy());
        let (ab, ac, ap) = (b - a, c - a, p - a);
        let area = ab.perp(&ac);
        let (v, w) = (ap.perp(&ac) / area, ab.perp(&ap) / area);
        let [a, b, c] = face.map(|v| self.image.vertices[v].coords);
        Point3::from(a * (1.0 - v - w) + b * v + c * w)
    }
}
