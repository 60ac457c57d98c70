//! The terms of Stage 3 over the unknowns of a pattern.

use super::control_mesh::Goal;
use super::cover::Cover;
use super::design::State;
use super::guides::guide_terms;
use super::pattern::{Pattern, Unknowns};
use super::phases::Phase;
use super::piece_mesh::{Edge, PieceMesh};
use super::stage2::held;
use super::stage3::Problem;
use super::terms::{
    ClosedVertex, Isometry, LeastWidths, Lengths, LinearTerm, PieceAt, Planarity, PointAt, RightAngles,
};
use crate::solver::{Coupling, Term, Weighted};

/// What pieces must keep: congruent in both states, Eq. (7), and flat.
pub fn hard_terms(mesh: &PieceMesh, at: &Unknowns, pattern: &Pattern, scale: f64) -> Vec<Weighted<'static>> {
    let pieces = pieces(mesh, at, pattern, scale);
    let terms: [Box<dyn Term>; 2] = [Box::new(Isometry::new(&pieces)), Box::new(Planarity::new(&pieces))];
    terms.into_iter().map(|term| Weighted { term, weight: 1.0, coupling: Coupling::Full }).collect()
}

/// Closed cells narrower than this, in mean edges, are widened: strongly curved targets would otherwise take their
/// stretch from a few rows of pieces until these are slivers or turned over. At 0.4 pieces leave the target instead.
const LEAST_WIDTH: f64 = 0.25;

/// Weight of the steps between the hinge points of a closed corner in space: they are to be no larger than needed.
const LEVEL: f64 = 1.0;

/// Where the open state is free its fairness is phased out with the other soft terms, from this part of its weight on.
const FREE_FAIR: f64 = 0.1;

/// Weight of a guide. Much more, and a single place comes near by a cusp in the sheet.
const GUIDE: f64 = 0.02;

/// They are also widened up to this many gaps: hinge polygons are up to a gap narrower than their cells, and two gaps
/// of them must be left.
const LEAST_WIDTH_IN_GAPS: f64 = 3.0;

/// The terms that decide what isometry leaves free. Those that the weights leave out are not among them; those that a
/// phase leaves out have weight 0. Where no grid follows the outline border points are held to where they are in
/// `border`; guided places are those that are near the guides `now`. `coupling` is that of fairness.
pub fn soft_terms<'a>(
    problem: &Problem<'a>,
    [border, now]: [&Pattern; 2],
    at: &Unknowns,
    phase: &Phase,
    coupling: Coupling,
) -> Vec<Weighted<'a>> {
    let &Problem { cover, gap, weights, .. } = problem;
    let mesh = &cover.mesh;
    let scale = cover.cell.edge();
    let least = LEAST_WIDTH.max(LEAST_WIDTH_IN_GAPS * gap / scale);
    let [fair_closed, fair_open] = fairness(cover, at);
    let full = Coupling::Full;
    // Where nothing else shapes the open state, fairness must: it stays beside the other soft terms.
    let free = matches!(problem.goals.open, Goal::Free);
    let open_fair = if free { phase.fair.max(FREE_FAIR * phase.soft) } else { phase.fair };
    // Widths are zero at a good solution: no need to phase them out.
    let widths = if phase.soft > 0.0 { 1.0 } else { 0.0 };
    let mut terms: Vec<(Box<dyn Term>, f64, f64, Coupling)> = Vec::new();
    for state in [State::Open, State::Closed] {
        let held = held_points(problem, border, at, state);
        let weights = [weights.prox, weights.boundary, weights.corners];
        terms.extend(held.into_iter().zip(weights).map(|(term, weight)| (term, weight, phase.soft, full)));
    }
    terms.extend::<[(Box<dyn Term>, f64, f64, Coupling); 6]>([
        (Box::new(Lengths::new("sides", border_sides(cover, at))), weights.sides, phase.soft, full),
        (Box::new(RightAngles::new("opening", hinge_sides(mesh, at))), weights.opening, phase.soft, coupling),
        (
            Box::new(RightAngles::new("rectangles", piece_corners(mesh, at))),
            weights.rectangles,
            phase.soft,
            full,
        ),
        (Box::new(LeastWidths::new(piece_corners(mesh, at), least)), weights.widths, widths, full),
        (Box::new(fair_closed), weights.fair, phase.fair, coupling),
        (Box::new(fair_open), weights.fair, open_fair, coupling),
    ]);
    let guides = guide_terms(problem.goals.guides, mesh, at, now, scale);
    terms.extend(guides.into_iter().map(|(term, weight)| {
        let term: Box<dyn Term> = Box::new(term);
        (term, GUIDE * weight, phase.soft, full)
    }));
    let lifts: Vec<_> = (0..mesh.corner_count).filter_map(|c| at.lift(c)).collect();
    if !lifts.is_empty() {
        let level = |start| vec![(PointAt { start, dimension: 1 }, 1.0)];
        let level = LinearTerm::new("level", 1, &lifts.into_iter().map(level).collect::<Vec<_>>());
        terms.push((Box::new(level), LEVEL, phase.soft, full));
    }
    let asked = terms.into_iter().filter(|(_, weight, ..)| *weight > 0.0);
    asked
        .map(|(term, weight, factor, coupling)| Weighted { term, weight: weight * factor, coupling })
        .collect()
}

/// What holds a state of the pattern to its goal: closeness, boundary and fixed corners.
fn held_points<'a>(
    problem: &Problem<'a>,
    border: &Pattern,
    at: &Unknowns,
    state: State,
) -> Vec<Box<dyn Term + 'a>> {
    let &Problem { cover, goals, .. } = problem;
    let mesh = &cover.mesh;
    let terms = match state {
        State::Closed => {
            let edge = (0..mesh.corner_count).filter(|&c| !mesh.fans[c].closed);
            let edge = edge.map(|c| (at.corner(c), border.corners[c]));
            held(cover, goals, state, (0..mesh.corner_count).map(|c| at.corner(c)), edge, |c| at.corner(c))
        }
        State::Open => {
            let edge = (0..mesh.edges.len()).filter(|&e| mesh.edges[e].is_border());
            let edge = edge.map(|e| (at.open(e), border.open[e]));
            // The vertex of a corner's only piece there.
            let tip = |corner: usize| {
                let mut edges = mesh.fans[corner].edges.iter().copied();
                let own = edges.find(|&e| mesh.edges[e].hinge_corner == corner);
                at.open(own.expect("one of its edges owns the vertex"))
            };
            held(cover, goals, state, (0..mesh.edges.len()).map(|e| at.open(e)), edge, tip)
        }
    };
    terms.into_iter().map(|term| Box::new(term) as Box<dyn Term>).collect()
}

fn pieces(mesh: &PieceMesh, at: &Unknowns, pattern: &Pattern, scale: f64) -> Vec<PieceAt> {
    let vertex = |e: usize| {
        let corner = mesh.edges[e].hinge_corner;
        let lift = at.lift(corner).map(|unknown| (unknown, pattern.rises[e]));
        ClosedVertex { corner: at.corner(corner), offset: pattern.offsets[e] / scale, lift }
    };
    mesh.owned
        .iter()
        .map(|owned| PieceAt {
            closed: owned.iter().map(|&e| vertex(e)).collect(),
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
    [
        LinearTerm::new("fair-closed", at.closed_dimension, &closed),
        LinearTerm::new("fair-open", at.open_dimension, &open),
    ]
}
