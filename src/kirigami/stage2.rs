//! Stage 2: control meshes of the right local dimensions (section 3.2).
//!
//! Levenberg-Marquardt over both control meshes: orthogonal diagonals, square open faces, constant mean
//! stretch, closeness to the target and to its boundary, fairness.

use super::control_mesh::{ControlMesh, Goals, Target};
use super::cover::{Boundary, Cover};
use super::design::State;
use super::phases::soft_precision;
use super::piece_mesh::{Edge, PieceMesh};
use super::terms::{
    CellDimensions, Diagonals, Held, Hold, LinearTerm, OrthogonalDiagonals, PointAt, PrincipalStretches,
};
use crate::geometry::Point3;
use crate::solver::{Coupling, Options, Report, Run, System, Term, Weighted};

/// Weights of the terms, for meshes whose mean edge is 1.
#[derive(Debug, Clone, PartialEq)]
pub struct Weights {
    /// Orthogonal diagonals.
    pub orth: f64,
    /// Square open faces and constant mean stretch.
    pub geom: f64,
    /// Closeness to the target.
    pub prox: f64,
    /// Distance to the target's boundary.
    pub boundary: f64,
    /// Distance of fixed corners from the outline's.
    pub corners: f64,
    /// Fairness of the mesh polylines.
    pub fair: f64,
}

impl Default for Weights {
    /// The paper's hard weights; closeness ten times the paper's and fairness a tenth of it, because the
    /// pattern then stays on the target at its size instead of shrinking.
    fn default() -> Self {
        Self { orth: 1.0, geom: 1.0, prox: 0.1, boundary: 0.1, corners: 0.6, fair: 0.001 }
    }
}

/// The factor lambda of Eq. (5): closed over open sum of diagonals.
const LAMBDA: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Positions of the four families of control vertices among the unknowns.
#[derive(Debug, Clone, Copy)]
pub struct Unknowns {
    /// Number of white vertices.
    pub corners: usize,
    /// Number of black vertices.
    pub pieces: usize,
    /// Unknowns per point of the closed state: 2 where it lies in the plane, 3 in space.
    pub closed_dimension: usize,
    /// Likewise of the open state.
    pub open_dimension: usize,
}

impl Unknowns {
    /// Those of control meshes over this mesh.
    pub fn new(mesh: &PieceMesh, goals: &Goals) -> Self {
        Self {
            corners: mesh.corner_count,
            pieces: mesh.pieces.len(),
            closed_dimension: goals.closed.dimension(),
            open_dimension: goals.open.dimension(),
        }
    }

    /// A white vertex of V.
    pub fn closed_corner(&self, i: usize) -> PointAt {
        PointAt { start: self.closed_dimension * i, dimension: self.closed_dimension }
    }
    /// A black vertex of V.
    pub fn closed_centre(&self, i: usize) -> PointAt {
        self.closed_corner(self.corners + i)
    }
    /// A white vertex of V'.
    pub fn open_corner(&self, i: usize) -> PointAt {
        let dimension = self.open_dimension;
        PointAt { start: self.closed_dimension * (self.corners + self.pieces) + dimension * i, dimension }
    }
    /// A black vertex of V'.
    pub fn open_centre(&self, i: usize) -> PointAt {
        self.open_corner(self.corners + i)
    }

    fn corner(&self, state: State, i: usize) -> PointAt {
        if state == State::Closed { self.closed_corner(i) } else { self.open_corner(i) }
    }

    fn centre(&self, state: State, i: usize) -> PointAt {
        self.corner(state, self.corners + i)
    }

    /// A place of each unknown on the grid.
    pub fn places(&self, cover: &Cover) -> Vec<[f64; 2]> {
        let centre = |piece: &Vec<usize>| {
            let sum =
                piece.iter().fold([0.0; 2], |[x, y], &c| [x + cover.places[c][0], y + cover.places[c][1]]);
            sum.map(|s| s / piece.len() as f64)
        };
        let centres = cover.mesh.pieces.iter().map(centre);
        let points: Vec<[f64; 2]> = cover.places.iter().copied().chain(centres).collect();
        let closed = points.iter().flat_map(|p| std::iter::repeat_n(*p, self.closed_dimension));
        closed.chain(points.iter().flat_map(|p| std::iter::repeat_n(*p, self.open_dimension))).collect()
    }

    /// The unknowns of control meshes, in units of `scale` millimetres.
    pub fn pack(&self, meshes: &ControlMesh, scale: f64) -> Vec<f64> {
        let closed = meshes.closed_corners.iter().chain(&meshes.closed_centres);
        let open = meshes.open_corners.iter().chain(&meshes.open_centres);
        let closed = closed.flat_map(|p| p.iter().take(self.closed_dimension));
        closed
            .chain(open.flat_map(|p| p.iter().take(self.open_dimension)))
            .map(|value| value / scale)
            .collect()
    }

    /// The control meshes that these unknowns stand for.
    pub fn unpack(&self, x: &[f64], scale: f64) -> ControlMesh {
        let points =
            |count, at: &dyn Fn(usize) -> PointAt| (0..count).map(|i| at(i).point(x, scale)).collect();
        ControlMesh {
            closed_corners: points(self.corners, &|i| self.closed_corner(i)),
            closed_centres: points(self.pieces, &|i| self.closed_centre(i)),
            open_corners: points(self.corners, &|i| self.open_corner(i)),
            open_centres: points(self.pieces, &|i| self.open_centre(i)),
        }
    }
}

/// What Stage 2 works on.
#[derive(Clone, Copy)]
pub struct Problem<'a> {
    /// The grid.
    pub cover: &'a Cover,
    /// What the states are held to.
    pub goals: Goals<'a>,
    /// Distance between the two hinge points of a corner, millimetres.
    pub gap: f64,
    /// What the cells' dimensions are to be.
    pub cells: Cells,
    /// Weights.
    pub weights: &'a Weights,
}

/// What the dimensions of the cells are to be in the two states.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Cells {
    /// Square open cells of constant mean stretch, Eqs. (4) and (5).
    Rotating,
    /// The same principal stretches everywhere along the grid's two directions, Eq. (10).
    Stretched([f64; 2]),
}

/// When to stop, on a grid of so many pieces.
pub fn course(pieces: usize) -> Options {
    let precision = soft_precision(pieces);
    Options { iterations: 10, energy_tolerance: 1e-2, precision, ..Options::default() }
}

/// Optimises a pair of control meshes; `name` is that of the minimisation in the journal.
pub fn stage2(
    problem: &Problem,
    start: &ControlMesh,
    options: &Options,
    name: &str,
    run: &mut Run,
) -> (ControlMesh, Report) {
    let scale = problem.cover.cell.edge();
    let at = Unknowns::new(&problem.cover.mesh, &problem.goals);
    let mut x = at.pack(start, scale);
    let mut system = System::new(at.places(problem.cover));
    let report =
        run.journal.minimize(name, &mut system, || terms(problem, start, &at), &mut x, options, run.watch);
    (at.unpack(&x, scale), report)
}

/// All terms that have a weight. `start` tells where border corners are held on outlines that no grid follows.
pub fn terms<'a>(problem: &Problem<'a>, start: &ControlMesh, at: &Unknowns) -> Vec<Weighted<'a>> {
    let &Problem { cover, goals, gap, weights, cells } = problem;
    let scale = cover.cell.edge();
    let mesh = &cover.mesh;
    let faces: Vec<(Diagonals, Diagonals)> = faces(mesh, at);
    let dimensions: Box<dyn Term> = match cells {
        Cells::Rotating => Box::new(CellDimensions::new(faces.iter().cloned(), LAMBDA, gap / scale)),
        Cells::Stretched(stretches) => {
            let directions = face_edges(mesh).map(|edge| edge.direction);
            Box::new(PrincipalStretches::new(faces.iter().cloned().zip(directions), stretches))
        }
    };
    let both = faces.iter().flat_map(|(closed, open)| [closed.clone(), open.clone()]);
    let mut terms: Vec<(Box<dyn Term>, f64)> =
        vec![(Box::new(OrthogonalDiagonals::new(both)), weights.orth), (dimensions, weights.geom)];
    for (state, places) in [(State::Open, &start.open_corners), (State::Closed, &start.closed_corners)] {
        let border = (0..mesh.corner_count).filter(|&c| !mesh.fans[c].closed);
        let border = border.map(|c| (at.corner(state, c), places[c]));
        let points = (0..mesh.corner_count + mesh.pieces.len()).map(|i| at.corner(state, i));
        let held = held(cover, goals, state, points, border, |c| at.corner(state, c));
        let weights = [weights.prox, weights.boundary, weights.corners];
        terms.extend(
            held.into_iter().zip(weights).map(|(held, weight)| (Box::new(held) as Box<dyn Term>, weight)),
        );
    }
    terms.push((Box::new(fairness(mesh, at, State::Closed)), weights.fair));
    terms.push((Box::new(fairness(mesh, at, State::Open)), weights.fair));
    let asked = terms.into_iter().filter(|(_, weight)| *weight > 0.0);
    asked.map(|(term, weight)| Weighted { term, weight, coupling: Coupling::Full }).collect()
}

/// What holds a state to its goal: `points` to the surface, `border` (with where it starts) to the boundary, and fixed
/// corners to the outline's. `corner` gives the unknowns of a corner of the sheet. Nothing, where there is no surface.
pub(super) fn held<'a>(
    cover: &Cover,
    goals: Goals<'a>,
    state: State,
    points: impl Iterator<Item = PointAt>,
    border: impl Iterator<Item = (PointAt, Point3)>,
    corner: impl Fn(usize) -> PointAt,
) -> Vec<Held<'a>> {
    let goal = goals.of(state);
    let Some(target) = goal.target() else { return Vec::new() };
    let scale = cover.cell.edge();
    let [prox, boundary, corners] = match state {
        State::Open => ["prox", "boundary", "corners"],
        State::Closed => ["prox-closed", "boundary-closed", "corners-closed"],
    };
    let mut held = vec![Held::new(prox, points.map(|p| (p, Hold::Surface)), target, scale)];
    if goal.outline().is_some() {
        held.push(Held::new(boundary, border_holds(border, target, cover.boundary), target, scale));
        held.push(Held::new(corners, corner_holds(cover, target, corner), target, scale));
    }
    held
}

/// What border points are held to. `border` gives of each point its unknowns and where it starts.
///
/// The target's boundary where the grid follows the outline; else the place, measured across the boundary, where
/// the point starts, or the boundary itself if that is outside.
fn border_holds(
    border: impl Iterator<Item = (PointAt, Point3)>,
    target: &Target,
    boundary: Boundary,
) -> Vec<(PointAt, Hold)> {
    let hold = |p: Point3| {
        if boundary != Boundary::Trimmed {
            return Hold::Boundary;
        }
        let foot = target.boundary.closest(&p);
        let outside = (p - foot.point).dot(&foot.conormal) > 0.0;
        Hold::Inside(if outside { foot.point } else { p }, foot.conormal)
    };
    border.map(|(at, p)| (at, hold(p))).collect()
}

/// What pins fixed corners of the sheet to the outline's; `at` gives the unknowns of a corner of the sheet.
fn corner_holds(cover: &Cover, target: &Target, at: impl Fn(usize) -> PointAt) -> Vec<(PointAt, Hold)> {
    let pins = |&(corner, outline): &(usize, usize)| {
        Hold::pins(target.boundary.points[outline]).map(|hold| (at(corner), hold))
    };
    cover.tips.iter().flat_map(pins).collect()
}

/// The control face of each edge, in both states.
fn faces(mesh: &PieceMesh, at: &Unknowns) -> Vec<(Diagonals, Diagonals)> {
    let face = |edge: &Edge| {
        [State::Closed, State::Open].map(|state| {
            let [p, q] = edge.corners.map(|c| at.corner(state, c));
            let centre = |k| at.centre(state, k);
            Diagonals::new(p, q, centre(edge.piece), edge.neighbour.map(centre))
        })
    };
    face_edges(mesh).map(face).map(|[closed, open]| (closed, open)).collect()
}

/// The edges that have a control face.
fn face_edges(mesh: &PieceMesh) -> impl Iterator<Item = &Edge> {
    // Triangles along the border are halves of cells: their centres are not those of control faces.
    let half = |&piece: &usize| {
        let border = mesh.owned[piece].iter().any(|&e| mesh.edges[e].is_border());
        mesh.pieces[piece].len() == 3 && border
    };
    mesh.edges.iter().filter(move |edge| ![Some(edge.piece), edge.neighbour].iter().flatten().any(half))
}

/// Second differences, Eq. (6), along the mesh polylines: through quad pieces from corner to corner and
/// through inner corners from piece to piece, in one of the states.
fn fairness(mesh: &PieceMesh, at: &Unknowns, state: State) -> LinearTerm {
    let corner = |i| at.corner(state, i);
    let centre = |i| at.centre(state, i);
    let mut blocks = Vec::new();
    for (piece, corners) in mesh.pieces.iter().enumerate() {
        if let [a, b, c, d] = corners[..] {
            for [p, q] in [[a, c], [b, d]] {
                blocks.push(vec![(corner(p), 1.0), (centre(piece), -2.0), (corner(q), 1.0)]);
            }
        }
    }
    let around = mesh.pieces_around();
    for (c, pieces) in around.iter().enumerate().filter(|&(c, _)| mesh.fans[c].closed) {
        if let [a, b, d, e] = pieces[..] {
            for [p, q] in [[a, d], [b, e]] {
                blocks.push(vec![(centre(p), 1.0), (corner(c), -2.0), (centre(q), 1.0)]);
            }
        }
    }
    match state {
        State::Closed => LinearTerm::new("fair-closed", at.closed_dimension, &blocks),
        State::Open => LinearTerm::new("fair-open", at.open_dimension, &blocks),
    }
}
