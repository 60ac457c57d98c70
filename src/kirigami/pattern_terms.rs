//! The terms of Stage 3 over the unknowns of a pattern.

use super::control_mesh::Targets;
use super::cover::Cover;
use super::pattern::Unknowns;
use super::piece_mesh::{Edge, PieceMesh};
use super::stage2::{closed_holds, corner_holds};
use super::stage3::{Phase, Weights};
use super::terms::{
    Held, Hold, Isometry, LeastWidths, Lengths, LinearTerm, PieceAt, Planarity, PointAt, RightAngles,
};
use crate::geometry::{Vector2, Vector3};
use crate::solver::{Coupling, Term, Weighted};

/// What pieces must keep: congruent in both states, Eq. (7), and flat.
pub fn hard_terms(
    mesh: &PieceMesh,
    at: &Unknowns,
    offsets: &[Vector2],
    scale: f64,
) -> Vec<Weighted<'static>> {
    let pieces = pieces(mesh, at, offsets, scale);
    let terms: [Box<dyn Term>; 2] = [Box::new(Isometry::new(&pieces)), Box::new(Planarity::new(&pieces))];
    terms.into_iter().map(|term| Weighted { term, weight: 1.0, coupling: Coupling::Full }).collect()
}

/// Closed cells narrower than this, in mean edges, are widened: strongly curved targets would otherwise take their
/// stretch from a few rows of pieces until these are slivers or turned over. At 0.4 pieces leave the target instead.
const LEAST_WIDTH: f64 = 0.25;

/// They are also widened up to this many gaps: hinge polygons are up to a gap narrower than their cells, and two gaps
/// of them must be left.
const LEAST_WIDTH_IN_GAPS: f64 = 3.0;

/// What the terms of a pattern speak of.
pub struct Softly<'a> {
    /// The grid.
    pub cover: &'a Cover,
    /// What the two states are held to.
    pub targets: Targets<'a>,
    /// What the border points of the open state are held to.
    pub holds: &'a [(PointAt, Hold)],
    /// Distance between the two hinge points of a corner, millimetres.
    pub gap: f64,
    /// Weights.
    pub weights: &'a Weights,
    /// Of fairness.
    pub coupling: Coupling,
}

/// The terms that decide what isometry leaves free. A closed state in space is held to its own surface and boundary as
/// the open one is; least widths are known in the plane only. Those that the weights leave out are not among them; those that
/// a phase leaves out have weight 0.
pub fn soft_terms<'a>(softly: &Softly<'a>, at: &Unknowns, phase: &Phase) -> Vec<Weighted<'a>> {
    let &Softly { cover, targets, holds, gap, weights, coupling } = softly;
    let target = targets.open;
    let mesh = &cover.mesh;
    let scale = cover.cell.edge();
    let points = (0..mesh.edges.len()).map(|e| (at.open(e), Hold::Surface));
    let border = holds.iter().copied();
    // The vertex of a corner's only piece there.
    let tip = |corner: usize| {
        let mut edges = mesh.fans[corner].edges.iter().copied();
        at.open(
            edges.find(|&e| mesh.edges[e].hinge_corner == corner).expect("one of its edges owns the vertex"),
        )
    };
    let corners = corner_holds(cover, target, tip);
    let least = LEAST_WIDTH.max(LEAST_WIDTH_IN_GAPS * gap / scale);
    let [fair_closed, fair_open] = fairness(cover, at);
    let full = Coupling::Full;
    // Widths are zero at a good solution: no need to phase them out.
    let widths = if phase.soft > 0.0 { 1.0 } else { 0.0 };
    let mut terms: Vec<(Box<dyn Term>, f64, f64, Coupling)> = vec![
        (Box::new(Held::new("prox", points, target, scale)), weights.prox, phase.soft, full),
        (Box::new(Held::new("boundary", border, target, scale)), weights.boundary, phase.soft, full),
        (Box::new(Held::new("corners", corners, target, scale)), weights.corners, phase.soft, full),
        (Box::new(Lengths::new("sides", border_sides(cover, at))), weights.sides, phase.soft, full),
        (Box::new(RightAngles::new("opening", hinge_sides(mesh, at))), weights.opening, phase.soft, coupling),
        (
            Box::new(RightAngles::new("rectangles", piece_corners(mesh, at))),
            weights.rectangles,
            phase.soft,
            full,
        ),
        (Box::new(fair_closed), weights.fair, phase.fair, coupling),
        (Box::new(fair_open), weights.fair, phase.fair, coupling),
    ];
    match targets.closed {
        // In the place where it stands in reports.
        None => terms.insert(
            6,
            (Box::new(LeastWidths::new(piece_corners(mesh, at), least)), weights.widths, widths, full),
        ),
        Some(closed) => {
            let [prox, boundary] = closed_holds(mesh, closed, scale, |c| at.corner(c));
            terms.push((Box::new(prox), weights.prox, phase.soft, full));
            terms.push((Box::new(boundary), weights.boundary, phase.soft, full));
        }
    }
    let asked = terms.into_iter().filter(|(_, weight, ..)| *weight > 0.0);
    asked
        .map(|(term, weight, factor, coupling)| Weighted { term, weight: weight * factor, coupling })
        .collect()
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
    [LinearTerm::new("fair-closed", at.closed_dimension, &closed), LinearTerm::new("fair-open", 3, &open)]
}
