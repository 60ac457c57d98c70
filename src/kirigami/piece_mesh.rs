//! Combinatorics of a rotating-piece pattern: which pieces, which corners, which edge carries which hinge.
//!
//! Pieces tile the closed sheet. Neighbours turn in opposite senses. A piece that turns counter-clockwise
//! has, on every edge, its hinge at the edge's start (edges run counter-clockwise around the piece); a
//! clockwise one at the edge's end. Neighbours run through their common edge in opposite directions, so they
//! agree. Each vertex of a piece therefore belongs to exactly one of its edges: the *owned* edge. At the
//! sheet's border the owned edge has no neighbour and the vertex is free.

use std::collections::{BTreeMap, BTreeSet};

/// An edge between two corners of the closed sheet.
#[derive(Debug, Clone, PartialEq)]
pub struct Edge {
    /// Its ends, in the direction of the first piece.
    pub corners: [usize; 2],
    /// The piece on its left.
    pub piece: usize,
    /// The piece on its right; `None` at the border.
    pub neighbour: Option<usize>,
    /// The corner, one of `corners`, at which the edge's hinge stands.
    pub hinge_corner: usize,
    /// 0 for edges along the grid's first direction, 1 along the second. 0 for all where no grid tells.
    pub direction: usize,
}

impl Edge {
    /// The end that is not `corner`.
    pub fn other_end(&self, corner: usize) -> usize {
        if self.corners[0] == corner { self.corners[1] } else { self.corners[0] }
    }

    /// Whether the edge lies on the sheet's border.
    pub fn is_border(&self) -> bool {
        self.neighbour.is_none()
    }
}

/// The edges around a corner, counter-clockwise.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Fan {
    /// Edge indices. At a border corner the first and the last one are border edges.
    pub edges: Vec<usize>,
    /// Whether pieces surround the corner completely.
    pub closed: bool,
    /// Whether every piece at the corner has four corners.
    pub quads: bool,
}

impl Fan {
    /// Edges before and after position `i`, counter-clockwise; `None` beyond the border.
    pub fn neighbours(&self, i: usize) -> (Option<usize>, Option<usize>) {
        let n = self.edges.len();
        let step = |j: usize| self.edges[j % n];
        let before = (self.closed || i > 0).then(|| step(i + n - 1));
        let after = (self.closed || i + 1 < n).then(|| step(i + 1));
        (before, after)
    }

    /// Pairs of edges that continue each other straight through the corner: at an inner corner of four edges, and
    /// between quads at a border corner of three or four (a straight border, the inside of an L). Elsewhere the
    /// pattern has no lines: inner corners of other valences are its singularities.
    pub fn opposite_pairs(&self) -> Vec<[usize; 2]> {
        match self.edges[..] {
            [a, b, c, d] if self.closed || self.quads => vec![[a, c], [b, d]],
            [a, _, c] if !self.closed && self.quads => vec![[a, c]],
            _ => Vec::new(),
        }
    }
}

/// The combinatorics of a pattern.
#[derive(Debug, Clone, PartialEq)]
pub struct PieceMesh {
    /// Number of corners.
    pub corner_count: usize,
    /// Corners of each piece, counter-clockwise.
    pub pieces: Vec<Vec<usize>>,
    /// Whether each piece turns counter-clockwise when the sheet opens.
    pub counter_clockwise: Vec<bool>,
    /// All edges.
    pub edges: Vec<Edge>,
    /// For each piece the edge that each of its vertices owns.
    pub owned: Vec<Vec<usize>>,
    /// The edges around each corner.
    pub fans: Vec<Fan>,
}

impl PieceMesh {
    /// Builds the combinatorics from cells of a grid: `cells` holds (column, row) of each piece.
    ///
    /// Returns also the grid position of each corner.
    pub fn from_cells(cells: &[[i32; 2]]) -> (Self, Vec<[i32; 2]>) {
        let mut corner_of: BTreeMap<[i32; 2], usize> = BTreeMap::new();
        let mut positions = Vec::new();
        let mut pieces = Vec::with_capacity(cells.len());
        for &[i, j] in cells {
            let around = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]];
            pieces.push(Vec::from(around.map(|position| {
                *corner_of.entry(position).or_insert_with(|| {
                    positions.push(position);
                    positions.len() - 1
                })
            })));
        }
        let senses = cells.iter().map(|[i, j]| (i + j).rem_euclid(2) == 0).collect();
        let directions = |_: usize, side: usize| side % 2;
        (Self::new(positions.len(), pieces, senses, directions, &BTreeSet::new()), positions)
    }

    /// Builds the combinatorics from pieces of any number of corners, listed counter-clockwise, all edges of
    /// direction 0.
    ///
    /// Pieces are neighbours where they run through an edge in opposite directions, unless its ends, the lesser
    /// first, are in `apart`: a slit of one edge, whose two sides end at the same two corners. The pieces at each
    /// corner must hang together through edges, and neighbours should turn in opposite senses: `counter_clockwise`
    /// says which way each piece turns.
    pub fn from_polygons(
        corner_count: usize,
        pieces: Vec<Vec<usize>>,
        counter_clockwise: Vec<bool>,
        apart: &BTreeSet<[usize; 2]>,
    ) -> Self {
        Self::new(corner_count, pieces, counter_clockwise, |_, _| 0, apart)
    }

    fn new(
        corner_count: usize,
        pieces: Vec<Vec<usize>>,
        counter_clockwise: Vec<bool>,
        direction: impl Fn(usize, usize) -> usize,
        apart: &BTreeSet<[usize; 2]>,
    ) -> Self {
        let mut edge_of: BTreeMap<[usize; 2], usize> = BTreeMap::new();
        let mut edges: Vec<Edge> = Vec::new();
        let mut sides = Vec::with_capacity(pieces.len());
        for (piece, corners) in pieces.iter().enumerate() {
            let n = corners.len();
            let mut own_sides = Vec::with_capacity(n);
            for side in 0..n {
                let ends = [corners[side], corners[(side + 1) % n]];
                let joined = !apart.contains(&[ends[0].min(ends[1]), ends[0].max(ends[1])]);
                if let Some(&edge) = edge_of.get(&[ends[1], ends[0]]).filter(|_| joined) {
                    edges[edge].neighbour = Some(piece);
                    own_sides.push(edge);
                    continue;
                }
                edge_of.insert(ends, edges.len());
                own_sides.push(edges.len());
                let hinge_corner = ends[usize::from(!counter_clockwise[piece])];
                let direction = direction(piece, side);
                edges.push(Edge { corners: ends, piece, neighbour: None, hinge_corner, direction });
            }
            sides.push(own_sides);
        }
        let fans = fans(corner_count, &pieces, &sides);
        let owned = sides
            .iter()
            .zip(&counter_clockwise)
            .map(|(sides, &ccw)| {
                let n = sides.len();
                (0..n).map(|i| if ccw { sides[i] } else { sides[(i + n - 1) % n] }).collect()
            })
            .collect();
        Self { corner_count, pieces, counter_clockwise, edges, owned, fans }
    }

    /// Position of an edge in the fan of one of its corners.
    ///
    /// # Panics
    /// If the edge does not end there.
    pub fn fan_position(&self, corner: usize, edge: usize) -> usize {
        self.fans[corner].edges.iter().position(|&e| e == edge).expect("the edge ends at the corner")
    }

    /// The vertex of a piece that stands where the hinge of one of its edges is.
    ///
    /// # Panics
    /// If the edge is not one of the piece's.
    pub fn vertex_of(&self, piece: usize, edge: usize) -> usize {
        self.owned[piece].iter().position(|&owned| owned == edge).expect("the piece owns the edge")
    }

    /// The pieces around each corner, counter-clockwise.
    pub fn pieces_around(&self) -> Vec<Vec<usize>> {
        // The piece between two consecutive edges of the fan lies on the left of the first one as it leaves the
        // corner.
        let left_of = |corner: usize, edge: usize| {
            let edge = &self.edges[edge];
            if edge.corners[0] == corner { Some(edge.piece) } else { edge.neighbour }
        };
        let fans = self.fans.iter().enumerate();
        fans.map(|(corner, fan)| fan.edges.iter().filter_map(|&e| left_of(corner, e)).collect()).collect()
    }

    /// Triples of consecutive edges along the pattern's lines, each with the two corners between them.
    pub fn edge_triples(&self) -> Vec<([usize; 3], [usize; 2])> {
        let mut triples = Vec::new();
        let opposite = |corner: usize, edge: usize| {
            self.fans[corner].opposite_pairs().into_iter().find_map(|[a, b]| match edge {
                e if e == a => Some(b),
                e if e == b => Some(a),
                _ => None,
            })
        };
        for (edge, Edge { corners: [p, q], .. }) in self.edges.iter().enumerate() {
            if let (Some(before), Some(after)) = (opposite(*p, edge), opposite(*q, edge)) {
                triples.push(([before, edge, after], [*p, *q]));
            }
        }
        triples
    }
}

/// Orders the edges around every corner.
fn fans(corner_count: usize, pieces: &[Vec<usize>], sides: &[Vec<usize>]) -> Vec<Fan> {
    // Counter-clockwise around a corner, each piece leads from its side that leaves the corner to the one
    // that arrives.
    let mut next: Vec<BTreeMap<usize, usize>> = vec![BTreeMap::new(); corner_count];
    let mut quads = vec![true; corner_count];
    for (corners, sides) in pieces.iter().zip(sides) {
        let n = corners.len();
        for i in 0..n {
            next[corners[i]].insert(sides[i], sides[(i + n - 1) % n]);
            quads[corners[i]] &= n == 4;
        }
    }
    next.iter()
        .zip(quads)
        .map(|(next, quads)| {
            let arrivals: Vec<usize> = next.values().copied().collect();
            let border = next.keys().find(|edge| !arrivals.contains(edge));
            let Some(&start) = border.or(next.keys().next()) else { return Fan::default() };
            let mut edges = vec![start];
            let mut at = start;
            while let Some(&after) = next.get(&at).filter(|&&after| after != start) {
                edges.push(after);
                at = after;
            }
            Fan { edges, closed: border.is_none(), quads }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(columns: i32, rows: i32) -> PieceMesh {
        let cells: Vec<[i32; 2]> = (0..rows).flat_map(|j| (0..columns).map(move |i| [i, j])).collect();
        PieceMesh::from_cells(&cells).0
    }

    #[test]
    fn counts_of_a_grid() {
        let (m, n) = (5, 4);
        let mesh = block(m as i32, n as i32);
        assert_eq!(mesh.corner_count, (m + 1) * (n + 1));
        assert_eq!(mesh.edges.len(), m * (n + 1) + n * (m + 1));
        assert_eq!(mesh.edges.iter().filter(|edge| !edge.is_border()).count(), 2 * m * n - m - n);
        assert_eq!(mesh.fans.iter().filter(|fan| fan.closed).count(), (m - 1) * (n - 1));
    }

    #[test]
    fn hinges_alternate_around_every_corner_and_neighbours_agree() {
        let mesh = block(6, 5);
        for (corner, fan) in mesh.fans.iter().enumerate() {
            for pair in fan.edges.windows(2) {
                let hinged = |edge: usize| mesh.edges[edge].hinge_corner == corner;
                assert_ne!(hinged(pair[0]), hinged(pair[1]), "corner {corner}");
            }
        }
        for (piece, owned) in mesh.owned.iter().enumerate() {
            for (vertex, &edge) in owned.iter().enumerate() {
                // The vertex stands where the hinge of its owned edge is, for both pieces at that edge.
                assert_eq!(mesh.edges[edge].hinge_corner, mesh.pieces[piece][vertex]);
            }
            let mut sorted = owned.clone();
            sorted.sort_unstable();
            sorted.dedup();
            assert_eq!(sorted.len(), 4);
        }
    }

    #[test]
    fn fans_run_counter_clockwise() {
        let cells = [[0, 0], [1, 0], [0, 1], [1, 1]];
        let (mesh, positions) = PieceMesh::from_cells(&cells);
        let centre = positions.iter().position(|&p| p == [1, 1]).unwrap();
        let fan = &mesh.fans[centre];
        assert!(fan.closed && fan.edges.len() == 4);
        let angle = |edge: usize| {
            let [x, y] = positions[mesh.edges[edge].other_end(centre)];
            f64::from(y - 1).atan2(f64::from(x - 1))
        };
        for i in 0..4 {
            let turn = angle(fan.edges[(i + 1) % 4]) - angle(fan.edges[i]);
            let quarter = turn.rem_euclid(2.0 * std::f64::consts::PI);
            assert!((quarter - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
        }
    }
}
