//! Stage 2: control meshes of the right local dimensions (section 3.2).
//!
//! Levenberg-Marquardt over both control meshes: orthogonal diagonals, square open faces, constant mean
//! stretch, closeness to the target and to its boundary, fairness.

use super::control_mesh::{ControlMesh, Target};
use super::cover::Cover;
use super::piece_mesh::PieceMesh;
use super::terms::{CellDimensions, Diagonals, Held, Hold, LinearTerm, OrthogonalDiagonals, PointAt};
use crate::geometry::{Point2, Point3};
use crate::solver::{Options, Report, Run, Weighted};

/// Weights of the terms, for meshes whose mean edge is 1.
#[derive(Debug, Clone)]
pub struct Weights {
    /// Orthogonal diagonals.
    pub orth: f64,
    /// Square open faces and constant mean stretch.
    pub geom: f64,
    /// Closeness to the target.
    pub prox: f64,
    /// Distance to the target's boundary.
    pub boundary: f64,
    /// Fairness of the mesh polylines.
    pub fair: f64,
}

impl Default for Weights {
    /// The paper's hard weights; closeness ten times the paper's and fairness a tenth of it, because the
    /// pattern then stays on the target at its size instead of shrinking.
    fn default() -> Self {
        Self { orth: 1.0, geom: 1.0, prox: 0.1, boundary: 0.1, fair: 0.001 }
    }
}

/// The factor lambda of Eq. (5): closed over open sum of diagonals.
const LAMBDA: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Positions of the four families of control vertices among the unknowns.
struct Unknowns {
    corners: usize,
    pieces: usize,
}

impl Unknowns {
    fn closed_corner(&self, i: usize) -> PointAt {
        PointAt { start: 2 * i, dimension: 2 }
    }
    fn closed_centre(&self, i: usize) -> PointAt {
        PointAt { start: 2 * (self.corners + i), dimension: 2 }
    }
    fn open_corner(&self, i: usize) -> PointAt {
        PointAt { start: 2 * (self.corners + self.pieces) + 3 * i, dimension: 3 }
    }
    fn open_centre(&self, i: usize) -> PointAt {
        PointAt { start: 2 * (self.corners + self.pieces) + 3 * (self.corners + i), dimension: 3 }
    }
}

/// Optimises a pair of control meshes.
///
/// `gap` is the distance between the two hinge points of a corner, millimetres.
pub fn stage2(
    cover: &Cover,
    start: &ControlMesh,
    target: &Target,
    gap: f64,
    weights: &Weights,
    options: &Options,
    run: &mut Run,
) -> (ControlMesh, Report) {
    let scale = cover.cell.edge();
    let mesh = &cover.mesh;
    let at = Unknowns { corners: mesh.corner_count, pieces: mesh.pieces.len() };
    let mut x = pack(start, scale);
    let terms = || terms(cover, start, target, &at, gap / scale, weights);
    let report = run.journal.minimize("stage-2", terms, &mut x, options, run.watch);
    (unpack(&x, &at, scale), report)
}

/// All terms; `gap` in mean edges.
fn terms<'a>(
    cover: &Cover,
    start: &ControlMesh,
    target: &'a Target,
    at: &Unknowns,
    gap: f64,
    weights: &Weights,
) -> Vec<Weighted<'a>> {
    let scale = cover.cell.edge();
    let mesh = &cover.mesh;
    let faces: Vec<(Diagonals, Diagonals)> = faces(mesh, at);
    let border: Vec<usize> = (0..mesh.corner_count).filter(|&c| !mesh.fans[c].closed).collect();
    let holds = holds(border.iter().map(|&c| start.open_corners[c]), target, cover.follows_outline);
    let open = (0..mesh.corner_count)
        .map(|i| at.open_corner(i))
        .chain((0..mesh.pieces.len()).map(|i| at.open_centre(i)))
        .map(|point| (point, Hold::Surface));
    let boundary = border.iter().zip(holds).map(|(&c, hold)| (at.open_corner(c), hold));
    let both = faces.iter().flat_map(|(closed, open)| [closed.clone(), open.clone()]);
    vec![
        Weighted { term: Box::new(OrthogonalDiagonals::new(both)), weight: weights.orth },
        Weighted { term: Box::new(CellDimensions::new(faces.clone(), LAMBDA, gap)), weight: weights.geom },
        Weighted { term: Box::new(Held::new("prox", open, target, scale)), weight: weights.prox },
        Weighted { term: Box::new(Held::new("boundary", boundary, target, scale)), weight: weights.boundary },
        Weighted { term: Box::new(fairness(mesh, at, 2)), weight: weights.fair },
        Weighted { term: Box::new(fairness(mesh, at, 3)), weight: weights.fair },
    ]
}

/// What border points are held to: the target's boundary where the grid follows the outline; else the place,
/// measured across the boundary, where they are now, or the boundary itself if they are outside.
pub(super) fn holds(
    points: impl Iterator<Item = Point3>,
    target: &Target,
    follows_outline: bool,
) -> Vec<Hold> {
    points
        .map(|p| {
            if follows_outline {
                return Hold::Boundary;
            }
            let foot = target.boundary.closest(&p);
            let outside = (p - foot.point).dot(&foot.conormal) > 0.0;
            Hold::Plane(if outside { foot.point } else { p }, foot.conormal)
        })
        .collect()
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
/// through inner corners from piece to piece. In the plane (closed) or in space (open).
fn fairness(mesh: &PieceMesh, at: &Unknowns, dimension: usize) -> LinearTerm {
    let corner = |i| if dimension == 2 { at.closed_corner(i) } else { at.open_corner(i) };
    let centre = |i| if dimension == 2 { at.closed_centre(i) } else { at.open_centre(i) };
    let mut blocks = Vec::new();
    for (piece, corners) in mesh.pieces.iter().enumerate() {
        if let [a, b, c, d] = corners[..] {
            for [p, q] in [[a, c], [b, d]] {
                blocks.push(vec![(corner(p), 1.0), (centre(piece), -2.0), (corner(q), 1.0)]);
            }
        }
    }
    let mut around: Vec<Vec<usize>> = vec![Vec::new(); mesh.corner_count];
    for (c, fan) in mesh.fans.iter().enumerate().filter(|(_, fan)| fan.closed && fan.edges.len() == 4) {
        // The piece between two consecutive edges of the fan lies on the left of the first one as it leaves
        // the corner.
        around[c] = fan
            .edges
            .iter()
            .filter_map(|&e| {
                let edge = &mesh.edges[e];
                if edge.corners[0] == c { Some(edge.piece) } else { edge.neighbour }
            })
            .collect();
    }
    for (c, pieces) in around.iter().enumerate() {
        if let [a, b, d, e] = pieces[..] {
            for [p, q] in [[a, d], [b, e]] {
                blocks.push(vec![(centre(p), 1.0), (corner(c), -2.0), (centre(q), 1.0)]);
            }
        }
    }
    LinearTerm::new(if dimension == 2 { "fair-closed" } else { "fair-open" }, dimension, &blocks)
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
