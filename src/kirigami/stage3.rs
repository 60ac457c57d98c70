//! Stage 3: pieces that are congruent in both states (section 3.3).
//!
//! The unknowns are the corner midpoints of the closed sheet (in the plane) and one open point per edge: the
//! hinge that the edge carries, shared by its two pieces, so that Eq. (8) holds exactly. The two hinges of a
//! closed corner stand `gap` apart: at the midpoint plus and minus gap/2 along the unit normal of the slit
//! that passes between them. The normals are taken from the closed sheet before each phase and stay fixed
//! while it runs.

use super::control_mesh::{ControlMesh, Target};
use super::cover::Cover;
use super::piece_mesh::{Edge, PieceMesh};
use super::stage2::holds;
use super::terms::{Held, Hold, Isometry, Lengths, LinearTerm, PieceAt, Planarity, PointAt, RightAngles};
use crate::geometry::{Point2, Point3, Vector2, Vector3};
use crate::solver::{Options, Report, Run, Step, Term, Termination, Weighted};

/// Weights of the soft phase, for a mean edge of 1. Isometry and planarity have weight 1.
#[derive(Debug, Clone)]
pub struct Weights {
    /// Closeness to the target.
    pub prox: f64,
    /// Distance to the target's boundary.
    pub boundary: f64,
    /// Fairness, Eqs. (6) and (9), in the first phase.
    pub fair: f64,
    /// Fully open hinges.
    pub opening: f64,
    /// Right angles of closed pieces.
    pub rectangles: f64,
    /// Lengths of the closed sides that touch the border, where fairness does not reach.
    pub sides: f64,
}

impl Default for Weights {
    /// Found on eight targets with 12 to 40 pieces a side. The three shape terms are a thousandth or less of
    /// the hard ones: they decide only what the hard ones leave free. Without them pieces at the border
    /// become slivers and hinges turn by up to 180 degrees.
    fn default() -> Self {
        Self { prox: 0.6, boundary: 0.05, fair: 1e-3, opening: 1e-3, rectangles: 1e-3, sides: 1e-4 }
    }
}

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

/// Optimises the pattern: a soft phase with fairness, one without, and a hard phase of isometry and planarity
/// alone.
///
/// Returns the pattern and one report per phase; fewer, the last of them interrupted, where the watch says
/// so.
pub fn stage3(
    cover: &Cover,
    start: Pattern,
    target: &Target,
    gap: f64,
    weights: &Weights,
    run: &mut Run,
) -> (Pattern, Vec<Report>) {
    let mesh = &cover.mesh;
    let scale = cover.cell.edge();
    let border: Vec<usize> = (0..mesh.edges.len()).filter(|&e| mesh.edges[e].is_border()).collect();
    let held = holds(border.iter().map(|&e| start.open[e]), target, cover.follows_outline);
    let held: Vec<(usize, Hold)> = border.into_iter().zip(held).collect();
    let at = Unknowns { corners: mesh.corner_count };
    let mut pattern = start;
    let mut reports = Vec::new();
    let phases = phases(weights);
    for (number, phase) in phases.iter().enumerate() {
        pattern.offsets = hinge_offsets(mesh, &pattern.corners, gap);
        let terms = || {
            let pieces = pieces(mesh, &at, &pattern.offsets, scale);
            let mut terms = vec![
                Weighted { term: Box::new(Isometry::new(&pieces)), weight: 1.0 },
                Weighted { term: Box::new(Planarity::new(&pieces)), weight: 1.0 },
            ];
            if phase.soft > 0.0 {
                terms.extend(soft_terms(cover, target, &at, &held, weights, phase));
            }
            terms
        };
        let later = phases[number + 1..].iter().map(|phase| phase.options.iterations).sum();
        let watch = &mut |step: &Step| (run.watch)(&Step { phase: number, later, ..*step });
        let mut x = pack(&pattern, scale);
        let report = run.journal.minimize("stage-3", terms, &mut x, &phase.options, watch);
        unpack(&x, scale, &mut pattern);
        let interrupted = report.termination == Termination::Interrupted;
        reports.push(report);
        if interrupted {
            break;
        }
    }
    (pattern, reports)
}

struct Phase {
    soft: f64,
    fair: f64,
    options: Options,
}

/// The hard phase stops at this sum of squared residuals: relative length errors near 1e-15 for a few
/// thousand pieces.
const HARD_FLOOR: f64 = 1e-28;

/// The phases of Stage 3: factor of closeness and boundary, factor of fairness, most iterations, and the
/// relative decrease below which a phase ends. Closeness first gains and then phases out, so that the hard
/// phase has little left to correct; fairness phases out throughout.
const SOFT_PHASES: [(f64, f64, usize, f64); 5] = [
    (1.0, 1.0, 12, 1e-2),
    (2.0, 0.2, 12, 1e-3),
    (2.0, 0.04, 12, 1e-3),
    (0.2, 4e-3, 10, 1e-3),
    (0.02, 4e-4, 10, 1e-3),
];

/// Most steps of all phases together.
pub fn most_steps() -> usize {
    phases(&Weights::default()).iter().map(|phase| phase.options.iterations).sum()
}

fn phases(weights: &Weights) -> Vec<Phase> {
    let soft = SOFT_PHASES.iter().map(|&(soft, fair, iterations, energy_tolerance)| Phase {
        soft,
        fair: fair * weights.fair,
        options: Options { iterations, energy_tolerance, ..Options::default() },
    });
    let hard = Options {
        iterations: 20,
        energy_tolerance: 0.5,
        energy_floor: HARD_FLOOR,
        damping: 1e-6,
        ..Options::default()
    };
    soft.chain([Phase { soft: 0.0, fair: 0.0, options: hard }]).collect()
}

/// The terms that decide what isometry leaves free.
fn soft_terms<'a>(
    cover: &Cover,
    target: &'a Target,
    at: &Unknowns,
    holds: &[(usize, Hold)],
    weights: &Weights,
    phase: &Phase,
) -> Vec<Weighted<'a>> {
    let mesh = &cover.mesh;
    let scale = cover.cell.edge();
    let points = (0..mesh.edges.len()).map(|e| (at.open(e), Hold::Surface));
    let border = holds.iter().map(|&(e, hold)| (at.open(e), hold));
    let [fair_closed, fair_open] = fairness(cover, at);
    let terms: [(Box<dyn Term>, f64); 7] = [
        (Box::new(Held::new("prox", points, target, scale)), phase.soft * weights.prox),
        (Box::new(Held::new("boundary", border, target, scale)), phase.soft * weights.boundary),
        (Box::new(Lengths::new("sides", border_sides(cover, at))), phase.soft * weights.sides),
        (Box::new(RightAngles::new("opening", hinge_sides(mesh, at))), phase.soft * weights.opening),
        (Box::new(RightAngles::new("rectangles", piece_corners(mesh, at))), phase.soft * weights.rectangles),
        (Box::new(fair_closed), phase.fair),
        (Box::new(fair_open), phase.fair),
    ];
    terms.into_iter().map(|(term, weight)| Weighted { term, weight }).collect()
}

struct Unknowns {
    corners: usize,
}

impl Unknowns {
    fn corner(&self, i: usize) -> PointAt {
        PointAt { start: 2 * i, dimension: 2 }
    }
    fn open(&self, edge: usize) -> PointAt {
        PointAt { start: 2 * self.corners + 3 * edge, dimension: 3 }
    }
}

fn pieces(mesh: &PieceMesh, at: &Unknowns, offsets: &[Vector2], scale: f64) -> Vec<PieceAt> {
    mesh.owned
        .iter()
        .map(|owned| PieceAt {
            closed: owned
                .iter()
                .map(|&e| {
                    let offset = offsets[e] / scale;
                    (at.corner(mesh.edges[e].hinge_corner), Vector3::new(offset.x, offset.y, 0.0))
                })
                .collect(),
            open: owned.iter().map(|&e| at.open(e)).collect(),
        })
        .collect()
}

/// For every inner edge its open hinge and the far ends of the sides that the two pieces turn to the slit
/// along it.
fn hinge_sides(mesh: &PieceMesh, at: &Unknowns) -> Vec<[PointAt; 3]> {
    let far = |piece: usize, edge: usize| {
        let owned = &mesh.owned[piece];
        let (n, vertex) = (owned.len(), mesh.vertex_of(piece, edge));
        owned[if mesh.counter_clockwise[piece] { (vertex + 1) % n } else { (vertex + n - 1) % n }]
    };
    let sides = |(e, edge): (usize, &Edge)| {
        let k = edge.neighbour?;
        Some([at.open(e), at.open(far(edge.piece, e)), at.open(far(k, e))])
    };
    mesh.edges.iter().enumerate().filter_map(sides).collect()
}

/// The corners of all closed quads: each corner with its two neighbours around the piece.
fn piece_corners(mesh: &PieceMesh, at: &Unknowns) -> Vec<[PointAt; 3]> {
    let quads = mesh.pieces.iter().filter(|corners| corners.len() == 4);
    quads.flat_map(|c| (0..4).map(|i| [c[i], c[(i + 1) % 4], c[(i + 3) % 4]].map(|c| at.corner(c)))).collect()
}

/// The closed sides that touch the border, with their lengths in the model cell, in units of the mean edge.
fn border_sides(cover: &Cover, at: &Unknowns) -> Vec<([PointAt; 2], f64)> {
    let mesh = &cover.mesh;
    let touches = |edge: &&Edge| edge.corners.iter().any(|&c| !mesh.fans[c].closed);
    let side = |edge: &Edge| {
        (edge.corners.map(|c| at.corner(c)), cover.cell.closed[edge.direction] / cover.cell.edge())
    };
    mesh.edges.iter().filter(touches).map(side).collect()
}

/// Fairness of the closed corners, Eq. (6), and of the open hinges, Eq. (9).
///
/// Consecutive open hinges on a line of the grid lie sqrt 2 times the passing slit's half length apart, so s
/// is the ratio of these lengths at the two corners between three hinges: a/b and b/a, alternately.
fn fairness(cover: &Cover, at: &Unknowns) -> [LinearTerm; 2] {
    let mesh = &cover.mesh;
    let mut closed = Vec::new();
    for (corner, fan) in mesh.fans.iter().enumerate() {
        for [e, f] in fan.opposite_pairs() {
            let [p, q] = [e, f].map(|e| mesh.edges[e].other_end(corner));
            closed.push(vec![(at.corner(p), 1.0), (at.corner(corner), -2.0), (at.corner(q), 1.0)]);
        }
    }
    let spacing = |corner: usize, edge: usize| {
        let along = mesh.edges[edge].direction;
        let hinged_here = mesh.edges[edge].hinge_corner == corner;
        cover.cell.closed[if hinged_here { 1 - along } else { along }]
    };
    let open: Vec<_> = mesh
        .edge_triples()
        .into_iter()
        .map(|([i, j, k], [p, q])| {
            let s = spacing(p, j) / spacing(q, j);
            vec![(at.open(i), 1.0), (at.open(j), -1.0 - s), (at.open(k), s)]
        })
        .collect();
    [LinearTerm::new("fair-closed", 2, &closed), LinearTerm::new("fair-open", 3, &open)]
}

fn pack(pattern: &Pattern, scale: f64) -> Vec<f64> {
    let plane = pattern.corners.iter().flat_map(|p| [p.x, p.y]);
    let space = pattern.open.iter().flat_map(|p| [p.x, p.y, p.z]);
    plane.chain(space).map(|value| value / scale).collect()
}

fn unpack(x: &[f64], scale: f64, pattern: &mut Pattern) {
    let (plane, space) = x.split_at(2 * pattern.corners.len());
    for (p, values) in pattern.corners.iter_mut().zip(plane.chunks_exact(2)) {
        *p = Point2::new(values[0], values[1]) * scale;
    }
    for (p, values) in pattern.open.iter_mut().zip(space.chunks_exact(3)) {
        *p = Point3::new(values[0], values[1], values[2]) * scale;
    }
}
