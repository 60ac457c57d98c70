//! Stage 2: control meshes of the right local dimensions (section 3.2).
//!
//! Levenberg-Marquardt over both control meshes: orthogonal diagonals, square open faces, constant mean
//! stretch, closeness to the target and to its boundary, fairness.

use super::control_mesh::{ControlMesh, Target, Targets};
use super::cover::{Boundary, Cover};
use super::design::State;
use super::piece_mesh::PieceMesh;
use super::terms::{CellDimensions, Diagonals, Held, Hold, LinearTerm, OrthogonalDiagonals, PointAt};
use crate::geometry::{Point2, Point3};
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
pub struct Unknowns {
    /// Number of white vertices.
    pub corners: usize,
    /// Number of black vertices.
    pub pieces: usize,
    /// 2 where the closed state lies in the plane, 3 where it lies in space.
    pub closed_dimension: usize,
}

impl Unknowns {
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
        PointAt { start: self.closed_dimension * (self.corners + self.pieces) + 3 * i, dimension: 3 }
    }
    /// A black vertex of V'.
    pub fn open_centre(&self, i: usize) -> PointAt {
        self.open_corner(self.corners + i)
    }
}

/// Optimises a pair of control meshes.
///
/// `gap` is the distance between the two hinge points of a corner, millimetres; `name` is that of the minimisation
/// in the journal.
#[expect(clippy::too_many_arguments)] // Each is one plain thing, and there is one caller.
pub fn stage2(
    cover: &Cover,
    start: &ControlMesh,
    target: &Target,
    gap: f64,
    weights: &Weights,
    options: &Options,
    name: &str,
    run: &mut Run,
) -> (ControlMesh, Report) {
    let scale = cover.cell.edge();
    let mesh = &cover.mesh;
    let at = Unknowns { corners: mesh.corner_count, pieces: mesh.pieces.len(), closed_dimension: 2 };
    let targets = Targets { closed: None, open: target };
    let mut x = pack(start, scale);
    let terms = || terms(cover, &start.open_corners, targets, &at, gap / scale, weights);
    let mut system = System::new(places(cover, at.closed_dimension));
    let report = run.journal.minimize(name, &mut system, terms, &mut x, options, run.watch);
    (unpack(&x, &at, scale), report)
}

/// A place of each unknown on the grid; the closed state has `closed_dimension` unknowns per vertex.
pub fn places(cover: &Cover, closed_dimension: usize) -> Vec<[f64; 2]> {
    let corners: Vec<[f64; 2]> = cover.positions.iter().map(|p| p.map(f64::from)).collect();
    let centre = |piece: &Vec<usize>| {
        let sum = piece.iter().fold([0.0; 2], |sum, &c| [sum[0] + corners[c][0], sum[1] + corners[c][1]]);
        sum.map(|s| s / piece.len() as f64)
    };
    let points: Vec<[f64; 2]> = corners.iter().copied().chain(cover.mesh.pieces.iter().map(centre)).collect();
    let closed = points.iter().flat_map(|p| std::iter::repeat_n(*p, closed_dimension));
    closed.chain(points.iter().flat_map(|p| [*p; 3])).collect()
}

/// All terms that have a weight. `open_corners` are the open white vertices at the start, millimetres; `gap` is in mean
/// edges. A closed state in space is held to its own surface and boundary as the open one is.
pub fn terms<'a>(
    cover: &Cover,
    open_corners: &[Point3],
    targets: Targets<'a>,
    at: &Unknowns,
    gap: f64,
    weights: &Weights,
) -> Vec<Weighted<'a>> {
    let scale = cover.cell.edge();
    let target = targets.open;
    let mesh = &cover.mesh;
    let faces: Vec<(Diagonals, Diagonals)> = faces(mesh, at);
    let border = (0..mesh.corner_count)
        .filter(|&c| !mesh.fans[c].closed)
        .map(|c| (at.open_corner(c), open_corners[c]));
    let boundary = border_holds(border, target, cover.boundary);
    let corners = corner_holds(cover, target, |c| at.open_corner(c));
    let open = (0..mesh.corner_count)
        .map(|i| at.open_corner(i))
        .chain((0..mesh.pieces.len()).map(|i| at.open_centre(i)))
        .map(|point| (point, Hold::Surface));
    let both = faces.iter().flat_map(|(closed, open)| [closed.clone(), open.clone()]);
    let mut terms: Vec<(Box<dyn Term>, f64)> = vec![
        (Box::new(OrthogonalDiagonals::new(both)), weights.orth),
        (Box::new(CellDimensions::new(faces.clone(), LAMBDA, gap)), weights.geom),
        (Box::new(Held::new("prox", open, target, scale)), weights.prox),
        (Box::new(Held::new("boundary", boundary, target, scale)), weights.boundary),
        (Box::new(Held::new("corners", corners, target, scale)), weights.corners),
        (Box::new(fairness(mesh, at, State::Closed)), weights.fair),
        (Box::new(fairness(mesh, at, State::Open)), weights.fair),
    ];
    if let Some(closed) = targets.closed {
        let [prox, boundary] = closed_holds(mesh, closed, scale, |c| at.closed_corner(c));
        let centres = (0..mesh.pieces.len()).map(|i| (at.closed_centre(i), Hold::Surface));
        terms.push((Box::new(prox), weights.prox));
        terms.push((Box::new(Held::new("prox-closed", centres, closed, scale)), weights.prox));
        terms.push((Box::new(boundary), weights.boundary));
    }
    let asked = terms.into_iter().filter(|(_, weight)| *weight > 0.0);
    asked.map(|(term, weight)| Weighted { term, weight, coupling: Coupling::Full }).collect()
}

/// What border points are held to. `border` gives of each point its unknowns and where it starts.
///
/// The target's boundary where the grid follows the outline; else the place, measured across the boundary, where
/// the point starts, or the boundary itself if that is outside.
pub(super) fn border_holds(
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

/// What holds the corners of a closed state in space: all to the target's surface, those of the border to its boundary.
/// `at` gives the unknowns of a corner.
pub(super) fn closed_holds<'a>(
    mesh: &PieceMesh,
    closed: &'a Target,
    scale: f64,
    at: impl Fn(usize) -> PointAt,
) -> [Held<'a>; 2] {
    let border = |&c: &usize| !mesh.fans[c].closed;
    let surface = (0..mesh.corner_count).map(|c| (at(c), Hold::Surface));
    let boundary = (0..mesh.corner_count).filter(border).map(|c| (at(c), Hold::Boundary));
    [Held::new("prox-closed", surface, closed, scale), Held::new("boundary-closed", boundary, closed, scale)]
}

/// What pins fixed corners of the sheet to the outline's; `at` gives the unknowns of a corner of the sheet.
pub(super) fn corner_holds(
    cover: &Cover,
    target: &Target,
    at: impl Fn(usize) -> PointAt,
) -> Vec<(PointAt, Hold)> {
    let pins = |&(corner, outline): &(usize, usize)| {
        Hold::pins(target.boundary.points[outline]).map(|hold| (at(corner), hold))
    };
    cover.tips.iter().flat_map(pins).collect()
}

/// The control face of each edge, in both states.
fn faces(mesh: &PieceMesh, at: &Unknowns) -> Vec<(Diagonals, Diagonals)> {
    mesh.edges
        .iter()
        .map(|edge| {
            let [p, q] = edge.corners;
            let closed = Diagonals::new(
                at.closed_corner(p),
                at.closed_corner(q),
                at.closed_centre(edge.piece),
                edge.neighbour.map(|k| at.closed_centre(k)),
            );
            let open = Diagonals::new(
                at.open_corner(p),
                at.open_corner(q),
                at.open_centre(edge.piece),
                edge.neighbour.map(|k| at.open_centre(k)),
            );
            (closed, open)
        })
        .collect()
}

/// Second differences, Eq. (6), along the mesh polylines: through quad pieces from corner to corner and
/// through inner corners from piece to piece, in one of the states.
fn fairness(mesh: &PieceMesh, at: &Unknowns, state: State) -> LinearTerm {
    let closed = state == State::Closed;
    let corner = |i| if closed { at.closed_corner(i) } else { at.open_corner(i) };
    let centre = |i| if closed { at.closed_centre(i) } else { at.open_centre(i) };
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
    let (name, dimension) = if closed { ("fair-closed", at.closed_dimension) } else { ("fair-open", 3) };
    LinearTerm::new(name, dimension, &blocks)
}

fn pack(meshes: &ControlMesh, scale: f64) -> Vec<f64> {
    let plane = meshes.closed_corners.iter().chain(&meshes.closed_centres).flat_map(|p| [p.x, p.y]);
    let space = meshes.open_corners.iter().chain(&meshes.open_centres).flat_map(|p| [p.x, p.y, p.z]);
    plane.chain(space).map(|value| value / scale).collect()
}

fn unpack(x: &[f64], at: &Unknowns, scale: f64) -> ControlMesh {
    let plane = |p: PointAt| Point2::new(x[p.start], x[p.start + 1]) * scale;
    let space = |p: PointAt| Point3::new(x[p.start], x[p.start + 1], x[p.start + 2]) * scale;
    ControlMesh {
        closed_corners: (0..at.corners).map(|i| plane(at.closed_corner(i))).collect(),
        closed_centres: (0..at.pieces).map(|i| plane(at.closed_centre(i))).collect(),
        open_corners: (0..at.corners).map(|i| space(at.open_corner(i))).collect(),
        open_centres: (0..at.pieces).map(|i| space(at.open_centre(i))).collect(),
    }
}
