//! Terms of whole pieces: congruent in both states, Eq. (7), and flat.

use super::{PointAt, indices};
use crate::geometry::Vector3;
use crate::solver::Term;

/// A piece as the unknowns see it: per vertex the closed corner with its fixed offset, and the open point.
#[derive(Debug, Clone)]
pub struct PieceAt {
    /// The closed vertex is the corner's point plus the offset.
    pub closed: Vec<(PointAt, Vector3)>,
    /// The open vertex.
    pub open: Vec<PointAt>,
}

impl PieceAt {
    fn unknowns(&self) -> Vec<usize> {
        let closed = self.closed.iter().flat_map(|(p, _)| p.indices());
        closed.chain(self.open.iter().flat_map(|p| p.indices())).collect()
    }
}

/// Equal distances between all vertices of a piece in both states, Eq. (7).
pub struct Isometry {
    pieces: Vec<(PieceAt, Vec<usize>)>,
}

impl Isometry {
    /// Over these pieces.
    pub fn new(pieces: &[PieceAt]) -> Self {
        Self { pieces: pieces.iter().map(|piece| (piece.clone(), piece.unknowns())).collect() }
    }
}

impl Term for Isometry {
    fn name(&self) -> &'static str {
        "isom"
    }
    fn blocks(&self) -> usize {
        self.pieces.len()
    }
    fn rows(&self, b: usize) -> usize {
        let n = self.pieces[b].0.open.len();
        n * (n - 1) / 2
    }
    fn unknowns(&self, b: usize) -> &[usize] {
        &self.pieces[b].1
    }
    fn evaluate(&self, b: usize, x: &[f64], residuals: &mut [f64], jacobian: &mut [f64]) {
        let (piece, unknowns) = &self.pieces[b];
        let n = piece.open.len();
        let plane = piece.closed[0].0.dimension;
        let columns = unknowns.len();
        let mut row = 0;
        for i in 0..n {
            for j in i + 1..n {
                let ((p, p_offset), (q, q_offset)) = (&piece.closed[i], &piece.closed[j]);
                let closed = p.read(x) + p_offset - q.read(x) - q_offset;
                let open = piece.open[i].read(x) - piece.open[j].read(x);
                residuals[row] = closed.norm_squared() - open.norm_squared();
                let line = &mut jacobian[row * columns..(row + 1) * columns];
                for axis in 0..plane {
                    line[i * plane + axis] = 2.0 * closed[axis];
                    line[j * plane + axis] = -2.0 * closed[axis];
                }
                let first_open = n * plane;
                for axis in 0..3 {
                    line[first_open + 3 * i + axis] = -2.0 * open[axis];
                    line[first_open + 3 * j + axis] = 2.0 * open[axis];
                }
                row += 1;
            }
        }
    }
}

/// Flat pieces stay flat to first order: the signed volumes spanned by vertices 0, 1, 2 and each further one
/// vanish in the open state, as they do in a flat closed state. (The distances of Eq. (7) see a flat piece's
/// bending to second order only.)
pub struct Planarity {
    pieces: Vec<(Vec<PointAt>, Vec<usize>)>,
}

impl Planarity {
    /// Over the open vertices of these pieces.
    pub fn new(pieces: &[PieceAt]) -> Self {
        Self { pieces: pieces.iter().map(|piece| (piece.open.clone(), indices(&piece.open))).collect() }
    }
}

impl Term for Planarity {
    fn name(&self) -> &'static str {
        "planarity"
    }
    fn blocks(&self) -> usize {
        self.pieces.len()
    }
    fn rows(&self, b: usize) -> usize {
        self.pieces[b].0.len() - 3
    }
    fn unknowns(&self, b: usize) -> &[usize] {
        &self.pieces[b].1
    }
    fn evaluate(&self, b: usize, x: &[f64], residuals: &mut [f64], jacobian: &mut [f64]) {
        let (points, unknowns) = &self.pieces[b];
        let at = |k: usize| points[k].read(x);
        let origin = at(0);
        let (u, v) = (at(1) - origin, at(2) - origin);
        for k in 3..points.len() {
            let w = at(k) - origin;
            residuals[k - 3] = u.cross(&v).dot(&w);
            let slopes = [(1, v.cross(&w)), (2, w.cross(&u)), (k, u.cross(&v))];
            let line = &mut jacobian[(k - 3) * unknowns.len()..][..unknowns.len()];
            for (vertex, slope) in slopes {
                for axis in 0..3 {
                    line[3 * vertex + axis] += slope[axis];
                    line[axis] -= slope[axis];
                }
            }
        }
    }
}
