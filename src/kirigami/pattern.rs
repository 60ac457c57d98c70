//! The pattern in both states, and its unknowns in Stage 3.
//!
//! The unknowns are the corner midpoints of the closed sheet (in the plane) and one open point per edge: the
//! hinge that the edge carries, shared by its two pieces, so that Eq. (8) holds exactly. The two hinges of a
//! closed corner stand `gap` apart: at the midpoint plus and minus gap/2 along the unit normal of the slit
//! that passes between them.

use super::control_mesh::ControlMesh;
use super::cover::Cover;
use super::piece_mesh::{Edge, PieceMesh};
use super::terms::PointAt;
use crate::geometry::{Point2, Point3, Vector2};

/// The pattern in both states.
#[derive(Debug, Clone, PartialEq)]
pub struct Pattern {
    /// Corner midpoints of the closed sheet.
    pub corners: Vec<Point2>,
    /// For each edge the offset of its closed hinge point from the midpoint of its hinge corner.
    pub offsets: Vec<Vector2>,
    /// For each edge its open hinge point (at the border: the free vertex of its piece).
    pub open: Vec<Point3>,
}

impl Pattern {
    /// The closed hinge point of an edge.
    pub fn closed_hinge(&self, mesh: &PieceMesh, edge: usize) -> Point2 {
        self.corners[mesh.edges[edge].hinge_corner] + self.offsets[edge]
    }
}

/// Offsets of the closed hinge points: half the gap along the normal of the slit that passes the hinge's
/// corner, towards the edge's other end. Zero where no slit passes.
pub fn hinge_offsets(mesh: &PieceMesh, corners: &[Point2], gap: f64) -> Vec<Vector2> {
    (0..mesh.edges.len())
        .map(|e| {
            let edge = &mesh.edges[e];
            let corner = edge.hinge_corner;
            let (before, after) = mesh.fans[corner].neighbours(mesh.fan_position(corner, e));
            let passes = [before, after].into_iter().flatten().any(|n| !mesh.edges[n].is_border());
            if !passes {
                return Vector2::zeros();
            }
            let end =
                |n: Option<usize>| n.map_or(corners[corner], |n| corners[mesh.edges[n].other_end(corner)]);
            let along = end(after) - end(before);
            let normal = Vector2::new(-along.y, along.x).normalize();
            let outwards = corners[edge.other_end(corner)] - corners[corner];
            normal * (0.5 * gap * normal.dot(&outwards).signum())
        })
        .collect()
}

/// The start of Stage 3: the open hinge of an edge divides the open cell's side as in the model cell (section
/// 2.1: the part next to the hinge's corner is the other side's share of a + b).
pub fn initial_pattern(cover: &Cover, control: &ControlMesh, gap: f64) -> Pattern {
    let mesh = &cover.mesh;
    let [a, b] = cover.cell.closed;
    let open = mesh
        .edges
        .iter()
        .map(|edge| {
            let near = control.open_corners[edge.hinge_corner];
            let far = control.open_corners[edge.other_end(edge.hinge_corner)];
            near + (far - near) * (cover.cell.closed[1 - edge.direction] / (a + b))
        })
        .collect();
    let corners = control.closed_corners.clone();
    Pattern { offsets: hinge_offsets(mesh, &corners, gap), corners, open }
}

/// Where the points of a pattern stand among the unknowns.
pub struct Unknowns {
    /// Number of corners.
    pub corners: usize,
    /// 2 where the closed state lies in the plane, 3 where it lies in space.
    pub closed_dimension: usize,
}

impl Unknowns {
    /// A corner midpoint of the closed sheet.
    pub fn corner(&self, i: usize) -> PointAt {
        PointAt { start: self.closed_dimension * i, dimension: self.closed_dimension }
    }

    /// The open hinge of an edge.
    pub fn open(&self, edge: usize) -> PointAt {
        PointAt { start: self.closed_dimension * self.corners + 3 * edge, dimension: 3 }
    }
}

/// A place of each unknown on the grid; the closed state has `closed_dimension` unknowns per corner.
pub fn places(cover: &Cover, closed_dimension: usize) -> Vec<[f64; 2]> {
    let corners: Vec<[f64; 2]> = cover.positions.iter().map(|p| p.map(f64::from)).collect();
    let middle = |edge: &Edge| {
        let [p, q] = edge.corners.map(|c| corners[c]);
        [0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])]
    };
    let edges: Vec<[f64; 2]> = cover.mesh.edges.iter().map(middle).collect();
    let closed = corners.iter().flat_map(|p| std::iter::repeat_n(*p, closed_dimension));
    closed.chain(edges.iter().flat_map(|p| [*p; 3])).collect()
}

/// The unknowns of a pattern, in units of `scale` millimetres.
pub fn pack(pattern: &Pattern, scale: f64) -> Vec<f64> {
    let plane = pattern.corners.iter().flat_map(|p| [p.x, p.y]);
    let space = pattern.open.iter().flat_map(|p| [p.x, p.y, p.z]);
    plane.chain(space).map(|value| value / scale).collect()
}

/// Takes the points of a pattern from the unknowns.
pub fn unpack(x: &[f64], scale: f64, pattern: &mut Pattern) {
    let (plane, space) = x.split_at(2 * pattern.corners.len());
    for (p, values) in pattern.corners.iter_mut().zip(plane.chunks_exact(2)) {
        *p = Point2::new(values[0], values[1]) * scale;
    }
    for (p, values) in pattern.open.iter_mut().zip(space.chunks_exact(3)) {
        *p = Point3::new(values[0], values[1], values[2]) * scale;
    }
}
