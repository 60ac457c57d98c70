//! Stage 3 on a design that is there already: pieces become congruent in both states, and nothing else changes much.
//!
//! Unknowns are the points of both states; vertices that are one point in a state stay one. A flat sheet state stays in
//! its plane: it has two unknowns per point. Isometry, Eq. (7), and planarity (signed volumes) are minimised together
//! with a weak pull towards where the points were, which is phased out: the last phase is hard.
//!
//! With a gap, the hinge points of a closed flat sheet move off their corners to where ligaments stand: half the gap to
//! either side of the slit that passes. Corners are then the unknowns, and the offsets are fixed during each phase.

mod gap;

pub use gap::Slits;

use super::design::{Design, Piece, State};
use super::repeated::NEARLY;
use super::rigidity::mean_piece_side;
use super::terms::{ClosedVertex, Isometry, PieceAt, Planarity, PointAt, Pull};
use crate::geometry::coincidence::{clusters, mean, members, near_pairs};
use crate::geometry::plane::Plane;
use crate::geometry::rotation::RigidMotion;
use crate::geometry::{Point3, Vector3, centroid};
use crate::solver::{self, Coupling, Report, Run, Step, System, Term, Termination, Weighted};

/// Weights of the pull in the soft phases, for a mean side of 1, and most iterations of each.
const SOFT: [(f64, usize); 2] = [(1e-2, 10), (1e-4, 10)];

/// The hard phase stops at this sum of squared residuals.
const FLOOR: f64 = 1e-29;

/// Most iterations of the hard phase.
const HARD: usize = 30;

/// The points of one state.
struct Points {
    /// The point of each vertex, piece by piece.
    of: Vec<Vec<usize>>,
    /// Where each is, millimetres, relative to `centre`.
    at: Vec<Vector3>,
    /// What was taken off to keep digits.
    centre: Vector3,
}

impl Points {
    /// Vertices of different pieces that are nearer than `tolerance` become one point, at their mean.
    fn new(polygons: &[&Vec<Point3>], tolerance: f64) -> Self {
        let row: Vec<Point3> = polygons.iter().flat_map(|polygon| polygon.iter().copied()).collect();
        let owners: Vec<usize> = polygons
            .iter()
            .enumerate()
            .flat_map(|(i, polygon)| std::iter::repeat_n(i, polygon.len()))
            .collect();
        let point_of = clusters(near_pairs(&row, tolerance), &owners);
        let centre = centroid(&row).coords;
        let at = members(&point_of).iter().map(|m| mean(m.iter().map(|&v| row[v])).coords - centre).collect();
        let mut rest = &point_of[..];
        let of = polygons
            .iter()
            .map(|polygon| {
                let (own, others) = rest.split_at(polygon.len());
                rest = others;
                own.to_vec()
            })
            .collect();
        Self { of, at, centre }
    }

    /// The design's corners in place of its vertices.
    fn become_corners(&mut self, design: &Design) {
        self.centre = centroid(&design.corners).coords;
        self.at = design.corners.iter().map(|corner| corner.coords - self.centre).collect();
        self.of = design.pieces.iter().map(|piece| piece.corners.clone()).collect();
    }
}

/// The unknowns: the points of the sheet state (plane or space), then those of the other.
struct Unknowns {
    states: [Points; 2],
    /// 2 where the first state is flat.
    dimension: usize,
    scale: f64,
    /// Offset of each vertex of the first state from its point, millimetres.
    offsets: Vec<Vec<Vector3>>,
}

impl Unknowns {
    fn place(&self, state: usize, point: usize) -> PointAt {
        let d = self.dimension;
        if state == 0 {
            PointAt { start: d * point, dimension: d }
        } else {
            PointAt { start: d * self.states[0].at.len() + 3 * point, dimension: 3 }
        }
    }

    fn pieces(&self) -> Vec<PieceAt> {
        let [first, other] = &self.states;
        let vertex = |point: usize, offset: &Vector3| ClosedVertex {
            corner: self.place(0, point),
            offset: offset / self.scale,
            lift: None,
        };
        first
            .of
            .iter()
            .zip(&other.of)
            .zip(&self.offsets)
            .map(|((first, other), offsets)| PieceAt {
                closed: first.iter().zip(offsets).map(|(&p, by)| vertex(p, by)).collect(),
                open: other.iter().map(|&p| self.place(1, p)).collect(),
            })
            .collect()
    }

    fn pack(&self) -> Vec<f64> {
        let [first, other] = &self.states;
        let start = first.at.iter().flat_map(|p| p.iter().take(self.dimension));
        start.chain(other.at.iter().flat_map(|p| p.iter())).map(|value| value / self.scale).collect()
    }

    fn read(&self, x: &[f64], state: usize, point: usize) -> Point3 {
        let PointAt { start, dimension } = self.place(state, point);
        let z = if dimension == 3 { x[start + 2] } else { 0.0 };
        let at = Vector3::new(x[start], x[start + 1], z) * self.scale;
        let mut p = Point3::from(at + self.states[state].centre);
        if dimension == 2 {
            p.z = 0.0;
        }
        p
    }

    /// A place in a plane of each unknown: that of its point in the first state, laid on its best plane.
    fn places(&self) -> Vec<[f64; 2]> {
        let [first, other] = &self.states;
        let points: Vec<Point3> = first.at.iter().map(|p| Point3::from(*p)).collect();
        let laid = Plane::fit(&points).laid_flat();
        let flat: Vec<[f64; 2]> = points
            .iter()
            .map(|p| {
                let p = laid.apply(p) / self.scale;
                [p.x, p.y]
            })
            .collect();
        let mut far = vec![([0.0, 0.0], 0.0); other.at.len()];
        for (p, q) in first.of.iter().flatten().zip(other.of.iter().flatten()) {
            let (sum, count) = &mut far[*q];
            *sum = [sum[0] + flat[*p][0], sum[1] + flat[*p][1]];
            *count += 1.0;
        }
        let near = flat.iter().flat_map(|p| std::iter::repeat_n(*p, self.dimension));
        near.chain(far.iter().flat_map(|(sum, count)| [[sum[0] / count, sum[1] / count]; 3])).collect()
    }
}

/// How a design is improved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Vertices of different pieces nearer than this in a state are one point there, millimetres.
    pub tolerance: f64,
    /// Distance between the two hinge points of a closed corner, millimetres; `None` leaves the points what they are.
    /// Only for a design whose closed state is flat and closed, and has no gap.
    pub gap: Option<f64>,
}

/// Improves a design. Returns the pieces and one report per phase; corners, axes and angles are then to be found anew.
pub fn improve(design: &Design, options: &Options, run: &mut Run) -> (Vec<Piece>, Vec<Report>) {
    let from_open = design.sheet_state == Some(State::Open);
    let polygons = |open: bool| -> Vec<&Vec<Point3>> {
        design.pieces.iter().map(|piece| if open { &piece.open } else { &piece.closed }).collect()
    };
    let mut states = [from_open, !from_open].map(|open| Points::new(&polygons(open), options.tolerance));
    if options.gap.is_some() {
        states[0].become_corners(design);
    }
    let dimension = if design.sheet_state.is_some() { 2 } else { 3 };
    let offsets = design.pieces.iter().map(|piece| vec![Vector3::zeros(); piece.closed.len()]).collect();
    let mut unknowns = Unknowns { states, dimension, scale: mean_piece_side(design), offsets };
    let mut x = unknowns.pack();
    let slits = options.gap.map(|gap| (gap, Slits::new(design)));
    let reports = minimize(design, &mut unknowns, slits.as_ref(), &mut x, run);
    let mut pieces = design.pieces.clone();
    for (i, piece) in pieces.iter_mut().enumerate() {
        let [first, other] = [0, 1].map(|state| {
            let of = &unknowns.states[state].of[i];
            of.iter().map(|&point| unknowns.read(&x, state, point)).collect::<Vec<_>>()
        });
        let first = first.iter().zip(&unknowns.offsets[i]).map(|(p, offset)| p + offset).collect();
        (piece.closed, piece.open) = if from_open { (other, first) } else { (first, other) };
    }
    carry_nearly_repeated(&unknowns, from_open, &mut pieces);
    (pieces, reports)
}

fn minimize(
    design: &Design,
    unknowns: &mut Unknowns,
    slits: Option<&(f64, Slits)>,
    x: &mut [f64],
    run: &mut Run,
) -> Vec<Report> {
    let start = x.to_vec();
    let hard = solver::Options {
        iterations: HARD,
        energy_tolerance: 0.5,
        energy_floor: FLOOR,
        damping: 1e-6,
        ..solver::Options::default()
    };
    let soft =
        SOFT.map(|(pull, iterations)| (pull, solver::Options { iterations, ..solver::Options::default() }));
    let phases: Vec<(f64, solver::Options)> = soft.into_iter().chain([(0.0, hard)]).collect();
    let mut system = System::new(unknowns.places());
    let mut reports = Vec::new();
    for (number, (pull, options)) in phases.iter().enumerate() {
        if let Some((gap, slits)) = slits {
            let count = unknowns.states[0].at.len();
            let corners: Vec<Point3> = (0..count).map(|point| unknowns.read(x, 0, point)).collect();
            let offsets = slits.offsets(design, &corners);
            let halved = |offsets: Vec<Vector3>| offsets.iter().map(|offset| offset * (0.5 * gap)).collect();
            unknowns.offsets = offsets.into_iter().map(halved).collect();
        }
        let pieces = unknowns.pieces();
        let terms = || {
            let terms: [(Box<dyn Term>, f64); 3] = [
                (Box::new(Isometry::new(&pieces)), 1.0),
                (Box::new(Planarity::new(&pieces)), 1.0),
                (Box::new(Pull::new("pull", &start)), *pull),
            ];
            terms
                .into_iter()
                .map(|(term, weight)| Weighted { term, weight, coupling: Coupling::Full })
                .collect()
        };
        let later = phases[number + 1..].iter().map(|(_, options)| options.iterations).sum();
        let watch = &mut |step: &Step| (run.watch)(&Step { phase: number, later, ..*step });
        let report = run.journal.minimize("stage-3", &mut system, terms, x, options, watch);
        let interrupted = report.termination == Termination::Interrupted;
        reports.push(report);
        if interrupted {
            break;
        }
    }
    reports
}

/// Vertices that nearly coincide with another of their piece: squared lengths below rounding say nothing about them, so
/// their piece carries them. Only free vertices of the other state are moved.
fn carry_nearly_repeated(unknowns: &Unknowns, from_open: bool, pieces: &mut [Piece]) {
    let other = &unknowns.states[1].of;
    let mut holders = vec![0; unknowns.states[1].at.len()];
    other.iter().flatten().for_each(|&point| holders[point] += 1);
    for (piece, points) in pieces.iter_mut().zip(other) {
        let (from, to) =
            if from_open { (&piece.open, &mut piece.closed) } else { (&piece.closed, &mut piece.open) };
        let n = from.len();
        let near = |i: usize, j: usize| (from[i] - from[j]).norm() < NEARLY * unknowns.scale;
        let carried =
            (0..n).find(|&i| holders[points[i]] == 1 && (0..n).any(|j| j != i && near(i, j)) && n > 3);
        if let Some(i) = carried {
            let others =
                |list: &[Point3]| -> Vec<Point3> { (0..n).filter(|&j| j != i).map(|j| list[j]).collect() };
            to[i] = RigidMotion::fit(&others(from), &others(to)).apply(&from[i]);
        }
    }
}

/// Largest distance that a vertex of either state has moved, millimetres.
pub fn largest_move(before: &[Piece], after: &[Piece]) -> f64 {
    let points = |pieces: &[Piece]| -> Vec<Point3> {
        pieces.iter().flat_map(|piece| piece.closed.iter().chain(&piece.open).copied()).collect()
    };
    points(before).iter().zip(points(after)).map(|(p, q)| (p - q).norm()).fold(0.0, f64::max)
}
