//! Stage 1: the pair of control meshes V (closed) and V' (open).
//!
//! Black vertices are piece centres, white ones the corners of closed pieces; each edge between two pieces is
//! one control face (section 3.1 and Fig. 7 of the paper). The regular grids V0 (cells a x b) and V0' (cells
//! w x w) correspond with the user's principal stretches. A state that has a surface gets its grid by the inverse of
//! that surface's flattening; a flat one takes the regular grid as it is.

use super::cover::Cover;
use super::design::State;
use super::guides::Guide;
use crate::geometry::boundary::BoundaryCurve;
use crate::geometry::closest::ClosestPoints;
use crate::geometry::mesh::TriMesh;
use crate::geometry::{Point2, Point3, Vector3};

/// Positions of the control vertices in both states, millimetres. A flat state has z = 0.
#[derive(Debug, Clone, PartialEq)]
pub struct ControlMesh {
    /// White vertices of V: corners of the closed sheet.
    pub closed_corners: Vec<Point3>,
    /// Black vertices of V: centres of the closed pieces.
    pub closed_centres: Vec<Point3>,
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

/// What a state is to become.
#[derive(Clone, Copy)]
pub enum Goal<'a> {
    /// A flat sheet in the plane z = 0.
    Plane,
    /// A surface.
    Surface {
        /// The surface.
        target: &'a Target,
        /// Whether the sheet's border is held to its boundary; else the sheet may cover a part of it.
        outline: bool,
    },
    /// Whatever its pieces make of it.
    Free,
}

impl<'a> Goal<'a> {
    /// Unknowns per point: 2 in the plane, 3 in space.
    pub fn dimension(&self) -> usize {
        if matches!(self, Goal::Plane) { 2 } else { 3 }
    }

    /// The surface, if there is one.
    pub fn target(&self) -> Option<&'a Target> {
        match self {
            Goal::Surface { target, .. } => Some(target),
            _ => None,
        }
    }

    /// The surface to whose boundary the sheet's border is held, if there is one.
    pub fn outline(&self) -> Option<&'a Target> {
        match self {
            Goal::Surface { target, outline: true } => Some(target),
            _ => None,
        }
    }
}

/// What the two states are to become.
#[derive(Clone, Copy)]
pub struct Goals<'a> {
    /// The closed state.
    pub closed: Goal<'a>,
    /// The open state.
    pub open: Goal<'a>,
    /// What guides an open state that is free.
    pub guides: &'a [Guide],
}

impl<'a> Goals<'a> {
    /// A flat closed sheet that opens to a surface, border to boundary.
    pub fn opening(target: &'a Target) -> Self {
        Self { closed: Goal::Plane, open: Goal::Surface { target, outline: true }, guides: &[] }
    }

    /// That of a state.
    pub fn of(&self, state: State) -> Goal<'a> {
        match state {
            State::Closed => self.closed,
            State::Open => self.open,
        }
    }

    /// The flat state, if there is one; the closed one if both are flat.
    pub fn sheet_state(&self) -> Option<State> {
        [State::Closed, State::Open].into_iter().find(|&state| matches!(self.of(state), Goal::Plane))
    }
}

/// Where Stage 1 puts a state.
pub enum Layout {
    /// The regular grid in the plane, with the state's model cells.
    Grid,
    /// The cover's points in the plane, times a factor.
    Scaled(f64),
    /// The cover's points, taken into a surface.
    Lifted(LinearMap),
}

impl Layout {
    /// The corners and the centres of a cover whose model cells have these sides.
    fn place(&self, cover: &Cover, [a, b]: [f64; 2]) -> (Vec<Point3>, Vec<Point3>) {
        let mean = |points: &[Point3], piece: &Vec<usize>| {
            Point3::from(piece.iter().map(|&c| points[c].coords).sum::<Vector3>() / piece.len() as f64)
        };
        match self {
            Self::Grid => {
                let corners: Vec<Point3> =
                    cover.places.iter().map(|[i, j]| Point3::new(a * i, b * j, 0.0)).collect();
                let centres = cover.mesh.pieces.iter().map(|piece| mean(&corners, piece)).collect();
                (corners, centres)
            }
            Self::Scaled(factor) => {
                let place = |p: &Point2| Point3::new(p.x * factor, p.y * factor, 0.0);
                (cover.corners.iter().map(place).collect(), cover.centres.iter().map(place).collect())
            }
            Self::Lifted(map) => {
                let place = |p: &Point2| map.apply(p);
                (cover.corners.iter().map(place).collect(), cover.centres.iter().map(place).collect())
            }
        }
    }
}

/// Where Stage 1 puts both states.
pub struct Layouts {
    /// The closed one.
    pub closed: Layout,
    /// The open one.
    pub open: Layout,
}

/// Lays the pair of regular grids of a cover into the plane and into the targets.
pub fn stage1(cover: &Cover, layouts: &Layouts) -> ControlMesh {
    let (closed_corners, closed_centres) = layouts.closed.place(cover, cover.cell.closed);
    let (open_corners, open_centres) = layouts.open.place(cover, cover.cell.open);
    ControlMesh { closed_corners, closed_centres, open_corners, open_centres }
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

    /// Distance of a point of the plane from the triangulation; 0 inside.
    pub fn distance(&self, p: &Point2) -> f64 {
        self.flat.distance(&Point3::new(p.x, p.y, 0.0))
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
