//! Whether neighbours can turn in opposite senses, and where they cannot.
//!
//! Going around an inner corner, or around a hole from piece to piece, the sense changes with every side that is
//! crossed, so their number must be even. On a surface without handles this suffices. A side belongs to two corners:
//! hence the odd places, counting the outer border as one, are even in number.

use std::collections::BTreeMap;

use crate::geometry::{Point3, centroid};
use crate::kirigami::piece_mesh::PieceMesh;

use super::proposal::{Graph, shortest, to_border};
use super::sheet::{Sheet, border_loops};
use super::{CutRequest, EdgeSet, sorted};

/// What an odd number of pieces surrounds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Odd {
    /// An inner corner.
    Corner,
    /// A hole of the sheet, or one that cuts made.
    Hole,
}

/// A place around which neighbours cannot alternate.
#[derive(Debug, Clone, PartialEq)]
pub struct OddPlace {
    /// What it is.
    pub kind: Odd,
    /// The source's vertices there: one for a corner, all around a hole.
    pub vertices: Vec<usize>,
    /// The corner, or the middle of the hole's corners, millimetres.
    pub at: Point3,
    /// How many sides between pieces one crosses around it: the number of pieces, one that is met twice counted twice.
    pub pieces: usize,
}

/// Where neighbours cannot alternate, and what would mend it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Alternation {
    /// All odd places: corners by the source's vertices, then holes.
    pub odd: Vec<OddPlace>,
    /// Proposed cuts, as paths over the source's vertices along sides between pieces.
    pub paths: Vec<Vec<usize>>,
    /// Their length together, millimetres.
    pub length: f64,
    /// Whether it is certain that no shorter cuts would do; see [`super::proposal`].
    pub shortest: bool,
}

impl Alternation {
    /// The edges that the proposed cuts run along, each with the lesser vertex first.
    pub fn edges(&self) -> EdgeSet {
        self.paths.iter().flat_map(|path| path.windows(2)).map(|pair| sorted([pair[0], pair[1]])).collect()
    }
}

/// Finds all odd places of a sheet and the cuts to propose. `vertices` are the source's.
pub(super) fn alternation(sheet: &Sheet, vertices: &[Point3], request: CutRequest) -> Alternation {
    let mesh = &sheet.mesh;
    let corners: Vec<Point3> = sheet.source_vertex.iter().map(|&v| vertices[v]).collect();
    let loops = border_loops(mesh, &corners);
    let graph = Graph::new(mesh, &corners, &loops);
    let crossed = graph.valences();
    let inner: Vec<usize> = (0..mesh.corner_count).filter(|&c| mesh.fans[c].closed).collect();
    let odd_corner = |&&corner: &&usize| crossed[graph.node_of[corner]] % 2 == 1;
    let mut odd: Vec<OddPlace> = inner
        .iter()
        .filter(odd_corner)
        .map(|&corner| OddPlace {
            kind: Odd::Corner,
            vertices: vec![sheet.source_vertex[corner]],
            at: corners[corner],
            pieces: crossed[graph.node_of[corner]],
        })
        .collect();
    odd.extend(loops.iter().skip(1).filter_map(|cycle| {
        let pieces = crossed[graph.node_of[cycle[0]]];
        (pieces % 2 == 1).then(|| OddPlace {
            kind: Odd::Hole,
            vertices: cycle.iter().map(|&c| sheet.source_vertex[c]).collect(),
            at: centroid(&cycle.iter().map(|&c| corners[c]).collect::<Vec<_>>()),
            pieces,
        })
    }));
    if odd.is_empty() {
        return Alternation { shortest: true, ..Alternation::default() };
    }
    let terminals: Vec<usize> = (0..crossed.len()).filter(|&node| crossed[node] % 2 == 1).collect();
    let proposal = match request {
        CutRequest::AsGiven | CutRequest::Automatic => shortest(&graph, mesh, &terminals),
        CutRequest::AutomaticToBorder => to_border(&graph, mesh, &terminals),
    };
    let paths = proposal.paths.iter().map(|path| path.iter().map(|&c| sheet.source_vertex[c]).collect());
    Alternation { odd, paths: paths.collect(), length: proposal.length, shortest: proposal.shortest }
}

/// A sense of turning for each piece, opposite to its neighbours', the first counter-clockwise; `None` where that
/// cannot be.
pub(super) fn senses(mesh: &PieceMesh) -> Option<Vec<bool>> {
    let mut neighbours: Vec<Vec<usize>> = vec![Vec::new(); mesh.pieces.len()];
    for edge in &mesh.edges {
        if let Some(neighbour) = edge.neighbour {
            neighbours[edge.piece].push(neighbour);
            neighbours[neighbour].push(edge.piece);
        }
    }
    let mut senses: Vec<Option<bool>> = vec![None; mesh.pieces.len()];
    let mut open = vec![(0, true)];
    while let Some((piece, sense)) = open.pop() {
        match senses[piece] {
            None => {
                senses[piece] = Some(sense);
                open.extend(neighbours[piece].iter().map(|&neighbour| (neighbour, !sense)));
            }
            Some(other) if other != sense => return None,
            Some(_) => {}
        }
    }
    senses.into_iter().collect()
}

/// The number of inner corners with an odd number of pieces around.
pub(super) fn odd_corners(pieces: &[Vec<usize>]) -> usize {
    let mut around: BTreeMap<usize, (usize, EdgeSet)> = BTreeMap::new();
    for corners in pieces {
        let n = corners.len();
        for i in 0..n {
            let (pieces, edges) = around.entry(corners[i]).or_default();
            *pieces += 1;
            edges.insert(sorted([corners[i], corners[(i + 1) % n]]));
            edges.insert(sorted([corners[i], corners[(i + n - 1) % n]]));
        }
    }
    around.values().filter(|(pieces, edges)| *pieces == edges.len() && pieces % 2 == 1).count()
}
