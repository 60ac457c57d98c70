//! Terms of whole pieces: congruent in both states, Eq. (7), and flat.

use super::PointAt;
use crate::geometry::Vector3;
use crate::solver::Term;

/// A closed vertex as the unknowns see it.
#[derive(Debug, Clone, Copy)]
pub struct ClosedVertex {
    /// The corner's point.
    pub corner: PointAt,
    /// What is added to it.
    pub offset: Vector3,
    /// An unknown, and what is added for each unit of it. All vertices of a piece have one, or none has.
    pub lift: Option<(usize, Vector3)>,
}

impl ClosedVertex {
    fn read(&self, x: &[f64]) -> Vector3 {
        let lift = self.lift.map_or(Vector3::zeros(), |(unknown, direction)| direction * x[unknown]);
        self.corner.read(x) + self.offset + lift
    }
}

/// A piece as the unknowns see it.
#[derive(Debug, Clone)]
pub struct PieceAt {
    /// The closed vertices.
    pub closed: Vec<ClosedVertex>,
    /// The open vertex.
    pub open: Vec<PointAt>,
}

impl PieceAt {
    fn unknowns(&self) -> Vec<usize> {
        let closed = self.closed.iter().flat_map(|vertex| vertex.corner.indices());
        let open = self.open.iter().flat_map(|p| p.indices());
        closed.chain(open).chain(self.lifts()).collect()
    }

    /// Dimensions of the closed and of the open state.
    fn dimensions(&self) -> [usize; 2] {
        [self.closed[0].corner.dimension, self.open[0].dimension]
    }

    /// The unknowns that lift its closed vertices.
    fn lifts(&self) -> impl Iterator<Item = usize> {
        self.closed.iter().filter_map(|vertex| Some(vertex.lift?.0))
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
        let [closed_dimension, open_dimension] = piece.dimensions();
        let columns = unknowns.len();
        let mut row = 0;
        for i in 0..n {
            for j in i + 1..n {
                let (p, q) = (&piece.closed[i], &piece.closed[j]);
                let closed = p.read(x) - q.read(x);
                let open = piece.open[i].read(x) - piece.open[j].read(x);
                residuals[row] = closed.norm_squared() - open.norm_squared();
                let line = &mut jacobian[row * columns..(row + 1) * columns];
                for axis in 0..closed_dimension {
                    line[i * closed_dimension + axis] = 2.0 * closed[axis];
                    line[j * closed_dimension + axis] = -2.0 * closed[axis];
                }
                let line = &mut line[n * closed_dimension..];
                for axis in 0..open_dimension {
                    line[i * open_dimension + axis] = -2.0 * open[axis];
                    line[j * open_dimension + axis] = 2.0 * open[axis];
                }
                if let (Some((_, up)), Some((_, down))) = (p.lift, q.lift) {
                    let line = &mut line[n * open_dimension..];
                    line[i] = 2.0 * closed.dot(&up);
                    line[j] = -2.0 * closed.dot(&down);
                }
                row += 1;
            }
        }
    }
}

/// Pieces stay flat: the signed volumes spanned by vertices 0, 1, 2 and each further one vanish in every state that lies
/// in space. One residual per further vertex and such state.
///
/// The distances of Eq. (7) see a flat piece's bending to second order only; where one state is flat they leave it free
/// to first order in the other.
pub struct Planarity {
    pieces: Vec<(PieceAt, Vec<usize>)>,
}

impl Planarity {
    /// Over these pieces. Vertices in the plane do not count among the unknowns.
    pub fn new(pieces: &[PieceAt]) -> Self {
        let unknowns = |piece: &PieceAt| {
            let closed = piece.closed.iter().map(|vertex| &vertex.corner);
            let in_space = closed.chain(&piece.open).filter(|p| p.dimension == 3);
            in_space.flat_map(|p| p.indices()).chain(piece.lifts()).collect()
        };
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
        let piece = &self.pieces[b].0;
        let states = piece.dimensions().into_iter().filter(|&dimension| dimension == 3).count();
        states * (piece.open.len() - 3)
    }
    fn unknowns(&self, b: usize) -> &[usize] {
        &self.pieces[b].1
    }
    fn evaluate(&self, b: usize, x: &[f64], residuals: &mut [f64], jacobian: &mut [f64]) {
        let (piece, unknowns) = &self.pieces[b];
        let n = piece.open.len();
        let closed = |i: usize| piece.closed[i].read(x);
        let open = |i: usize| piece.open[i].read(x);
        let (mut row, mut column) = (0, 0);
        for (dimension, at) in
            piece.dimensions().into_iter().zip([&closed as &dyn Fn(usize) -> Vector3, &open])
        {
            if dimension != 3 {
                continue;
            }
            for k in 3..n {
                residuals[row] = volume(k, at, &mut jacobian[row * unknowns.len() + column..][..3 * n]);
                row += 1;
            }
            column += 3 * n;
        }
        // What lifts a closed vertex moves it like its corner: the closed rows and columns come first.
        for (i, vertex) in piece.closed.iter().enumerate() {
            let Some((_, direction)) = vertex.lift else { continue };
            for line in jacobian.chunks_exact_mut(unknowns.len()).take(n - 3) {
                line[column + i] = (0..3).map(|axis| line[3 * i + axis] * direction[axis]).sum();
            }
        }
    }
}

/// Six times the signed volume of the tetrahedron of points 0, 1, 2 and `k`. Adds its derivatives to `line` (three entries
/// per point).
fn volume(k: usize, at: &dyn Fn(usize) -> Vector3, line: &mut [f64]) -> f64 {
    let origin = at(0);
    let [u, v, w] = [1, 2, k].map(|i| at(i) - origin);
    for (vertex, slope) in [(1, v.cross(&w)), (2, w.cross(&u)), (k, u.cross(&v))] {
        for axis in 0..3 {
            line[3 * vertex + axis] += slope[axis];
            line[axis] -= slope[axis];
        }
    }
    u.cross(&v).dot(&w)
}
