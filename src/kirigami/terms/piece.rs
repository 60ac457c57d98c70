//! Terms of whole pieces: congruent in both states, Eq. (7), and flat.

use super::PointAt;
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
        closed.chain(self.open_unknowns()).collect()
    }

    /// Whether the closed state lies in the plane.
    fn is_flat(&self) -> bool {
        self.closed[0].0.dimension == 2
    }

    fn open_unknowns(&self) -> impl Iterator<Item = usize> {
        self.open.iter().flat_map(|p| p.indices())
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

/// Pieces keep their signed volumes: those spanned by vertices 0, 1, 2 and each further one are the same in both
/// states, open minus closed. One residual per further vertex.
///
/// In a flat closed state they vanish, so that pieces stay flat. (The distances of Eq. (7) see a flat piece's bending
/// to second order only, and do not tell a piece from its mirror image.)
pub struct Planarity {
    pieces: Vec<(PieceAt, Vec<usize>)>,
}

impl Planarity {
    /// Over these pieces. Closed vertices in the plane do not count among the unknowns.
    pub fn new(pieces: &[PieceAt]) -> Self {
        let unknowns = |p: &PieceAt| if p.is_flat() { p.open_unknowns().collect() } else { p.unknowns() };
        Self { pieces: pieces.iter().map(|piece| (piece.clone(), unknowns(piece))).collect() }
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
        self.pieces[b].0.open.len() - 3
    }
    fn unknowns(&self, b: usize) -> &[usize] {
        &self.pieces[b].1
    }
    fn evaluate(&self, b: usize, x: &[f64], residuals: &mut [f64], jacobian: &mut [f64]) {
        let (piece, unknowns) = &self.pieces[b];
        let n = piece.open.len();
        let first_open = unknowns.len() - 3 * n;
        for k in 3..n {
            let line = &mut jacobian[(k - 3) * unknowns.len()..][..unknowns.len()];
            let (closed, open) = line.split_at_mut(first_open);
            residuals[k - 3] = volume(k, |i| piece.open[i].read(x), 1.0, open);
            if !piece.is_flat() {
                let at = |i: usize| piece.closed[i].0.read(x) + piece.closed[i].1;
                residuals[k - 3] -= volume(k, at, -1.0, closed);
            }
        }
    }
}

/// Six times the signed volume of the tetrahedron of points 0, 1, 2 and `k`. Adds its derivatives, times `sign`, to
/// `line` (three entries per point).
fn volume(k: usize, at: impl Fn(usize) -> Vector3, sign: f64, line: &mut [f64]) -> f64 {
    let origin = at(0);
    let [u, v, w] = [1, 2, k].map(|i| at(i) - origin);
    for (vertex, slope) in [(1, v.cross(&w)), (2, w.cross(&u)), (k, u.cross(&v))] {
        for axis in 0..3 {
            line[3 * vertex + axis] += sign * slope[axis];
            line[axis] -= sign * slope[axis];
        }
    }
    u.cross(&v).dot(&w)
}
