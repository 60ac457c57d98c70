//! Which pieces, edges and hinges meet at each corner of the sheet: edges with their hinges, the fan of edges
//! around each corner, and the border loops. Combinatorics only; the positions serve error messages.

mod half_edges;

use kurbo::Point;

use super::error::FabricationError;
use super::states::{corner_place, sheet_vertices};
use crate::kirigami::design::{Design, PatternKind, State};

use half_edges::HalfEdges;

/// A side of a piece: interior if a second piece lies to its right, else border.
#[derive(Debug, Clone, PartialEq)]
pub struct Edge {
    /// The end corners, in the counter-clockwise sense of the piece to the left.
    pub ends: [usize; 2],
    /// The piece to the left.
    pub left: usize,
    /// The piece to the right; `None` at the sheet's border.
    pub right: Option<usize>,
    /// The hinge that the edge carries; `None` at the border and along slits of bistable sheets that hold nothing.
    pub hinge: Option<EdgeHinge>,
}

/// The hinge of an interior edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct EdgeHinge {
    /// Index into [`Design::hinges`].
    pub id: usize,
    /// The end corner at which it stands.
    pub corner: usize,
}

impl Edge {
    /// The end that is not `corner`.
    pub fn far(&self, corner: usize) -> usize {
        if self.ends[0] == corner { self.ends[1] } else { self.ends[0] }
    }

    /// The hinge, if it stands at `corner`.
    pub fn hinge_at(&self, corner: usize) -> Option<usize> {
        self.hinge.filter(|hinge| hinge.corner == corner).map(|hinge| hinge.id)
    }
}

/// What meets at a corner, counter-clockwise. At a border corner the first edge is the border edge that leaves
/// the corner and the last one the border edge that arrives, travelling with the sheet to the left.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Fan {
    /// Edges: as many as pieces at an inner corner, one more at the border. Empty if no piece uses the corner.
    pub edges: Vec<usize>,
    /// `pieces[i]` lies counter-clockwise after `edges[i]`.
    pub pieces: Vec<usize>,
    /// Whether the corner is on a border loop.
    pub border: bool,
}

/// The combinatorics of a sheet.
#[derive(Debug, Clone, PartialEq)]
pub struct Topology {
    /// All edges.
    pub edges: Vec<Edge>,
    /// One fan per corner of the design.
    pub fans: Vec<Fan>,
    /// Border edges of each loop in travelling order, the sheet to the left.
    pub loops: Vec<Vec<usize>>,
}

/// Builds the combinatorics.
///
/// # Errors
/// Indices out of range, numbers that are not finite, an edge used twice in one direction, an edge with several hinges,
/// or, where the pattern is that of rotating rectangles, without one, a piece without hinges, pieces that touch in one
/// point only.
pub fn topology(design: &Design) -> Result<Topology, FabricationError> {
    check_numbers(design)?;
    let half_edges = HalfEdges::new(design)?;
    let mut edges = edges(&half_edges);
    attach_hinges(design, &mut edges, &half_edges)?;
    let fans = fans(design, &half_edges)?;
    let loops = border_loops(&edges, &fans);
    Ok(Topology { edges, fans, loops })
}

/// The sheet is flat at z = 0; a micrometre is far below any laser's accuracy.
const OFF_SHEET: f64 = 1e-3;

fn check_numbers(design: &Design) -> Result<(), FabricationError> {
    for (corner, point) in design.corners.iter().enumerate() {
        // Of an open sheet they lie on the closed target.
        let flat = design.sheet_state != Some(State::Open);
        if !point.iter().all(|c| c.is_finite()) || (flat && point.z.abs() > OFF_SHEET) {
            let reason = format!("z is {} mm, but the sheet state must be finite and lie in z = 0", point.z);
            return Err(FabricationError::Corner { corner, x: point.x, y: point.y, reason });
        }
    }
    for (index, piece) in design.pieces.iter().enumerate() {
        let bad = |reason: String| Err(FabricationError::BadPiece { piece: index, reason });
        let count = piece.corners.len();
        if count < 3 || piece.closed.len() != count || piece.open.len() != count {
            return bad(format!(
                "it has {count} corners, {} closed and {} open vertices, but needs three or more, equally many",
                piece.closed.len(),
                piece.open.len()
            ));
        }
        if let Some(&corner) = piece.corners.iter().find(|&&c| c >= design.corners.len()) {
            return bad(format!("corner {corner} is out of range (the design has {})", design.corners.len()));
        }
        if !piece.closed.iter().chain(&piece.open).all(|p| p.iter().all(|c| c.is_finite())) {
            return bad("a vertex is not finite".into());
        }
        if let Some(point) = sheet_vertices(design, piece).iter().find(|point| point.z.abs() > OFF_SHEET) {
            return bad(format!("a vertex of its sheet state has z = {} mm instead of 0", point.z));
        }
    }
    Ok(())
}

fn edges(half_edges: &HalfEdges) -> Vec<Edge> {
    let mut edges: Vec<Edge> = Vec::new();
    for (from, side) in half_edges.each() {
        // Of an inner edge the second side comes later.
        if side.edge < edges.len() {
            continue;
        }
        let right = half_edges.get([side.to, from]).map(|twin| twin.at.0);
        edges.push(Edge { ends: [from, side.to], left: side.at.0, right, hinge: None });
    }
    edges
}

fn attach_hinges(
    design: &Design,
    edges: &mut [Edge],
    half_edges: &HalfEdges,
) -> Result<(), FabricationError> {
    let mut found = vec![0; edges.len()];
    for (id, hinge) in design.hinges.iter().enumerate() {
        let bad = |reason: String| FabricationError::BadHinge { hinge: id, reason };
        if !hinge.angle.is_finite() || !hinge.axis.iter().chain(hinge.point.iter()).all(|c| c.is_finite()) {
            return Err(bad("its point, axis or angle is not finite".into()));
        }
        let corner_of =
            |side: usize| design.pieces.get(hinge.pieces[side])?.corners.get(hinge.vertices[side]).copied();
        let (Some(corner), Some(other)) = (corner_of(0), corner_of(1)) else {
            return Err(bad("a piece or vertex index is out of range".into()));
        };
        if corner != other {
            return Err(bad(format!("its vertices belong to two corners, {corner} and {other}")));
        }
        let piece = &design.pieces[hinge.pieces[0]];
        let count = piece.corners.len();
        let next = piece.corners[(hinge.vertices[0] + 1) % count];
        let previous = piece.corners[(hinge.vertices[0] + count - 1) % count];
        let mut shared = [next, previous].into_iter().filter_map(|end| {
            let edge = half_edges.edge([corner, end]);
            let pieces = [Some(edges[edge].left), edges[edge].right];
            pieces.contains(&Some(hinge.pieces[1])).then_some(edge)
        });
        let Some(edge) = shared.next() else {
            return Err(bad(format!("pieces {:?} share no edge at corner {corner}", hinge.pieces)));
        };
        if shared.next().is_some() {
            return Err(bad(format!("pieces {:?} share two edges at corner {corner}", hinge.pieces)));
        }
        found[edge] += 1;
        edges[edge].hinge = Some(EdgeHinge { id, corner });
    }
    let least = usize::from(design.pattern == PatternKind::RotatingRectangles);
    for (edge, &found) in edges.iter().zip(&found) {
        if let Some(right) = edge.right
            && !(least..=1).contains(&found)
        {
            return Err(FabricationError::EdgeHinges {
                pieces: [edge.left, right],
                corners: edge.ends,
                found,
            });
        }
    }
    let mut held = vec![false; design.pieces.len()];
    design.hinges.iter().flat_map(|hinge| hinge.pieces).for_each(|piece| held[piece] = true);
    match held.iter().position(|held| !held) {
        Some(piece) if held.len() > 1 => {
            let reason = "no hinge holds it, so that it would fall out of the sheet".into();
            Err(FabricationError::BadPiece { piece, reason })
        }
        _ => Ok(()),
    }
}

fn fans(design: &Design, half_edges: &HalfEdges) -> Result<Vec<Fan>, FabricationError> {
    let mut incident = vec![Vec::new(); design.corners.len()];
    for (index, piece) in design.pieces.iter().enumerate() {
        for (vertex, &corner) in piece.corners.iter().enumerate() {
            incident[corner].push((index, vertex));
        }
    }
    let fan_at = |(corner, uses): (usize, &Vec<(usize, usize)>)| {
        fan(design, half_edges, corner, uses).ok_or_else(|| {
            let Point { x, y } = corner_place(design, corner);
            let reason = "pieces touch here in one point only, which no ligament can hold: add or remove a piece \
                          so that the sheet's border passes the corner once";
            FabricationError::Corner { corner, x, y, reason: reason.into() }
        })
    };
    incident.iter().enumerate().map(fan_at).collect()
}

/// The fan of one corner; `None` if its pieces do not form one run.
fn fan(design: &Design, half_edges: &HalfEdges, corner: usize, uses: &[(usize, usize)]) -> Option<Fan> {
    let next_of = |(piece, vertex): (usize, usize)| {
        let corners = &design.pieces[piece].corners;
        corners[(vertex + 1) % corners.len()]
    };
    let previous_of = |(piece, vertex): (usize, usize)| {
        let corners = &design.pieces[piece].corners;
        corners[(vertex + corners.len() - 1) % corners.len()]
    };
    let on_border = |&&at: &&(usize, usize)| half_edges.get([next_of(at), corner]).is_none();
    let mut starts = uses.iter().filter(on_border);
    let Some(&start) = starts.next().or(uses.first()) else {
        return Some(Fan::default());
    };
    let mut fan = Fan { edges: vec![half_edges.edge([corner, next_of(start)])], ..Fan::default() };
    let mut at = start;
    loop {
        fan.pieces.push(at.0);
        let far = previous_of(at);
        let next = half_edges.get([corner, far]).map(|side| side.at);
        if next == Some(start) {
            break;
        }
        fan.edges.push(half_edges.edge([corner, far]));
        match next {
            Some(piece) => at = piece,
            None => {
                fan.border = true;
                break;
            }
        }
    }
    (fan.pieces.len() == uses.len() && starts.next().is_none()).then_some(fan)
}

fn border_loops(edges: &[Edge], fans: &[Fan]) -> Vec<Vec<usize>> {
    let mut seen = vec![false; edges.len()];
    let mut loops = Vec::new();
    for start in 0..edges.len() {
        let mut run = Vec::new();
        let mut edge = start;
        while edges[edge].right.is_none() && !seen[edge] {
            seen[edge] = true;
            run.push(edge);
            edge = fans[edges[edge].ends[1]].edges[0];
        }
        if !run.is_empty() {
            loops.push(run);
        }
    }
    loops
}
