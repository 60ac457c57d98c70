//! The sides of all pieces by the corners that they join.

use crate::fabrication::error::FabricationError;
use crate::kirigami::design::Design;

/// A side of a piece, which leads counter-clockwise from one corner to the next.
#[derive(Debug, Clone, Copy)]
pub(super) struct HalfEdge {
    /// The corner that it leads to.
    pub to: usize,
    /// The piece, and the vertex at which the side begins.
    pub at: (usize, usize),
    /// The edge of which it is one side.
    pub edge: usize,
}

/// All sides, by the corner that they come from and then by that which they lead to.
pub(super) struct HalfEdges {
    /// Where those of each corner begin; one number more than corners.
    first: Vec<usize>,
    sides: Vec<HalfEdge>,
}

impl HalfEdges {
    /// Of a design whose corners are all in range; edges are numbered in the order of [`HalfEdges::each`].
    ///
    /// # Errors
    /// A side without length, or that two pieces have in the same direction.
    pub fn new(design: &Design) -> Result<Self, FabricationError> {
        let mut first = vec![0; design.corners.len() + 1];
        for (piece, corners) in design.pieces.iter().map(|piece| &piece.corners).enumerate() {
            for (vertex, &corner) in corners.iter().enumerate() {
                if corner == corners[(vertex + 1) % corners.len()] {
                    let reason = format!("corner {corner} occurs twice in a row");
                    return Err(FabricationError::BadPiece { piece, reason });
                }
                first[corner + 1] += 1;
            }
        }
        (1..first.len()).for_each(|corner| first[corner] += first[corner - 1]);
        let mut free = first.clone();
        let none = HalfEdge { to: 0, at: (0, 0), edge: usize::MAX };
        let mut sides = vec![none; first[first.len() - 1]];
        for (piece, corners) in design.pieces.iter().map(|piece| &piece.corners).enumerate() {
            for (vertex, &corner) in corners.iter().enumerate() {
                let to = corners[(vertex + 1) % corners.len()];
                sides[free[corner]] = HalfEdge { to, at: (piece, vertex), ..none };
                free[corner] += 1;
            }
        }
        let mut all = Self { first, sides };
        for from in 0..all.first.len() - 1 {
            all.sides[all.first[from]..all.first[from + 1]].sort_unstable_by_key(|side| (side.to, side.at));
            if let Some([one, two]) = all.of(from).array_windows().find(|[one, two]| one.to == two.to) {
                let (other, to) = (one.at.0, one.to);
                let reason = format!("piece {other} has the same side from corner {from} to corner {to}");
                return Err(FabricationError::BadPiece { piece: two.at.0, reason });
            }
        }
        all.number();
        Ok(all)
    }

    /// Numbers the edges: of the two sides of an inner one the first tells.
    fn number(&mut self) {
        let mut count = 0;
        for from in 0..self.first.len() - 1 {
            for i in self.first[from]..self.first[from + 1] {
                let to = self.sides[i].to;
                match self.find([to, from]) {
                    Some(twin) if to < from => self.sides[i].edge = self.sides[twin].edge,
                    _ => {
                        self.sides[i].edge = count;
                        count += 1;
                    }
                }
            }
        }
    }

    /// The sides that come from a corner.
    fn of(&self, from: usize) -> &[HalfEdge] {
        &self.sides[self.first[from]..self.first[from + 1]]
    }

    fn find(&self, [from, to]: [usize; 2]) -> Option<usize> {
        self.of(from).binary_search_by_key(&to, |side| side.to).ok().map(|i| self.first[from] + i)
    }

    /// The side from one corner to another.
    pub fn get(&self, ends: [usize; 2]) -> Option<&HalfEdge> {
        self.find(ends).map(|i| &self.sides[i])
    }

    /// The edge between two corners.
    ///
    /// # Panics
    /// If there is none.
    pub fn edge(&self, [from, to]: [usize; 2]) -> usize {
        let side = self.get([from, to]).or_else(|| self.get([to, from]));
        side.expect("two neighbouring corners of a piece").edge
    }

    /// All sides with the corners that they come from.
    pub fn each(&self) -> impl Iterator<Item = (usize, &HalfEdge)> {
        (0..self.first.len() - 1).flat_map(|from| self.of(from).iter().map(move |side| (from, side)))
    }
}
