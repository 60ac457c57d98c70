//! The residual terms of Stages 2 and 3, Eqs. (4) to (9) of the paper, with the boundary and planarity terms
//! that keep the pattern from collapsing and from bending its pieces.
//!
//! Unknowns are numbers; a point of a state is a run of two (plane) or three (space) of them. All terms are
//! in units in which the mean edge is 1.

use super::control_mesh::Target;
use crate::geometry::{Point3, Vector3};
use crate::solver::Term;

/// The position of a point as a run of unknowns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PointAt {
    /// Index of its first coordinate.
    pub start: usize,
    /// 2 in the plane, 3 in space.
    pub dimension: usize,
}

impl PointAt {
    fn indices(self) -> std::ops::Range<usize> {
        self.start..self.start + self.dimension
    }

    fn read(self, x: &[f64]) -> Vector3 {
        let z = if self.dimension == 3 { x[self.start + 2] } else { 0.0 };
        Vector3::new(x[self.start], x[self.start + 1], z)
    }
}

fn indices(points: &[PointAt]) -> Vec<usize> {
    points.iter().flat_map(|p| p.indices()).collect()
}

/// Soft linear conditions `sum of coefficients times points = 0`: fairness, Eqs. (6) and (9).
pub struct LinearTerm {
    name: &'static str,
    dimension: usize,
    blocks: Vec<(Vec<usize>, Vec<f64>)>,
}

impl LinearTerm {
    /// Each block holds points with their coefficients.
    pub fn new(name: &'static str, dimension: usize, blocks: &[Vec<(PointAt, f64)>]) -> Self {
        let blocks = blocks
            .iter()
            .map(|block| {
                let (points, coefficients): (Vec<PointAt>, Vec<f64>) = block.iter().copied().unzip();
                (indices(&points), coefficients)
            })
            .collect();
        Self { name, dimension, blocks }
    }
}

impl Term for LinearTerm {
    fn name(&self) -> &'static str {
        self.name
    }
    fn blocks(&self) -> usize {
        self.blocks.len()
    }
    fn rows(&self, _: usize) -> usize {
        self.dimension
    }
    fn unknowns(&self, b: usize) -> &[usize] {
        &self.blocks[b].0
    }
    fn evaluate(&self, b: usize, x: &[f64], residuals: &mut [f64], jacobian: &mut [f64]) {
        let (unknowns, coefficients) = &self.blocks[b];
        for row in 0..self.dimension {
            residuals[row] = 0.0;
            for (k, coefficient) in coefficients.iter().enumerate() {
                let column = k * self.dimension + row;
                residuals[row] += coefficient * x[unknowns[column]];
                jacobian[row * unknowns.len() + column] = *coefficient;
            }
        }
    }
}

/// A control face in one state: its white diagonal (along the edge between two pieces) and its black one
/// (from piece centre to piece centre), each as a linear combination of the face's points.
#[derive(Debug, Clone)]
pub struct Diagonals {
    /// Points with their coefficients in the white and in the black diagonal.
    pub points: Vec<(PointAt, f64, f64)>,
}

impl Diagonals {
    /// The face of the edge from `p` to `q` between the pieces centred at `c1` and `c2`; at the border `c2`
    /// is the mirror image of `c1` in the edge's midpoint.
    pub fn new(p: PointAt, q: PointAt, c1: PointAt, c2: Option<PointAt>) -> Self {
        let points = match c2 {
            Some(c2) => vec![(p, -1.0, 0.0), (q, 1.0, 0.0), (c1, 0.0, -1.0), (c2, 0.0, 1.0)],
            None => vec![(p, -1.0, 1.0), (q, 1.0, 1.0), (c1, 0.0, -2.0)],
        };
        Self { points }
    }

    fn unknowns(&self) -> Vec<usize> {
        self.points.iter().flat_map(|(p, _, _)| p.indices()).collect()
    }

    fn values(&self, x: &[f64]) -> (Vector3, Vector3) {
        self.points.iter().fold((Vector3::zeros(), Vector3::zeros()), |(white, black), (p, w, b)| {
            let at = p.read(x);
            (white + at * *w, black + at * *b)
        })
    }

    /// Writes the row of derivatives of a function with these gradients for the two diagonals.
    fn write(&self, white: &Vector3, black: &Vector3, row: &mut [f64]) {
        let mut column = 0;
        for (p, w, b) in &self.points {
            for axis in 0..p.dimension {
                row[column] = w * white[axis] + b * black[axis];
                column += 1;
            }
        }
    }
}

/// Orthogonal diagonals, c_orth of section 3.2: one residual per face.
pub struct OrthogonalDiagonals {
    faces: Vec<(Diagonals, Vec<usize>)>,
}

impl OrthogonalDiagonals {
    /// Over these faces, of either state.
    pub fn new(faces: impl IntoIterator<Item = Diagonals>) -> Self {
        Self { faces: faces.into_iter().map(|face| (face.clone(), face.unknowns())).collect() }
    }
}

impl Term for OrthogonalDiagonals {
    fn name(&self) -> &'static str {
        "orth"
    }
    fn blocks(&self) -> usize {
        self.faces.len()
    }
    fn rows(&self, _: usize) -> usize {
        1
    }
    fn unknowns(&self, b: usize) -> &[usize] {
        &self.faces[b].1
    }
    fn evaluate(&self, b: usize, x: &[f64], residuals: &mut [f64], jacobian: &mut [f64]) {
        let face = &self.faces[b].0;
        let (white, black) = face.values(x);
        residuals[0] = white.dot(&black);
        face.write(&black, &white, jacobian);
    }
}

/// Equal diagonals in the open state and constant mean stretch, Eqs. (4) and (5): two residuals per face.
///
/// With a gap the closed diagonals are together longer by it, because half of it is lost on either side of
/// each slit; gap = 0 is Eq. (5) itself.
pub struct CellDimensions {
    faces: Vec<(Diagonals, Diagonals, Vec<usize>)>,
    lambda: f64,
    gap: f64,
}

impl CellDimensions {
    /// Over pairs of faces (closed, open), with the factor lambda of Eq. (5).
    pub fn new(faces: impl IntoIterator<Item = (Diagonals, Diagonals)>, lambda: f64, gap: f64) -> Self {
        let faces = faces
            .into_iter()
            .map(|(closed, open)| {
                let unknowns = [closed.unknowns(), open.unknowns()].concat();
                (closed, open, unknowns)
            })
            .collect();
        Self { faces, lambda, gap }
    }
}

impl Term for CellDimensions {
    fn name(&self) -> &'static str {
        "geom"
    }
    fn blocks(&self) -> usize {
        self.faces.len()
    }
    fn rows(&self, _: usize) -> usize {
        2
    }
    fn unknowns(&self, b: usize) -> &[usize] {
        &self.faces[b].2
    }
    fn evaluate(&self, b: usize, x: &[f64], residuals: &mut [f64], jacobian: &mut [f64]) {
        let (closed, open, unknowns) = &self.faces[b];
        let columns = unknowns.len();
        let first_open = closed.points.iter().map(|(p, ..)| p.dimension).sum::<usize>();
        let (white, black) = closed.values(x);
        let (open_white, open_black) = open.values(x);
        residuals[0] = open_white.norm_squared() - open_black.norm_squared();
        open.write(&(open_white * 2.0), &(open_black * -2.0), &mut jacobian[first_open..columns]);
        residuals[1] =
            white.norm() + black.norm() - self.gap - self.lambda * (open_white.norm() + open_black.norm());
        let unit = |v: Vector3| v.try_normalize(0.0).unwrap_or_default();
        let row = &mut jacobian[columns..];
        closed.write(&unit(white), &unit(black), &mut row[..first_open]);
        open.write(
            &(unit(open_white) * -self.lambda),
            &(unit(open_black) * -self.lambda),
            &mut row[first_open..],
        );
    }
}

/// Closeness to the target, c_prox: the distance to the tangent plane at the nearest point.
pub struct Proximity<'a> {
    points: Vec<PointAt>,
    unknowns: Vec<usize>,
    target: &'a Target,
    /// Millimetres per unit of length of the unknowns.
    scale: f64,
    feet: Vec<(Vector3, f64)>,
}

impl<'a> Proximity<'a> {
    /// Over points in space.
    pub fn new(points: Vec<PointAt>, target: &'a Target, scale: f64) -> Self {
        let feet = vec![(Vector3::zeros(), 0.0); points.len()];
        Self { unknowns: indices(&points), points, target, scale, feet }
    }
}

impl Term for Proximity<'_> {
    fn name(&self) -> &'static str {
        "prox"
    }
    fn blocks(&self) -> usize {
        self.points.len()
    }
    fn rows(&self, _: usize) -> usize {
        1
    }
    fn unknowns(&self, b: usize) -> &[usize] {
        &self.unknowns[3 * b..3 * b + 3]
    }
    fn evaluate(&self, b: usize, x: &[f64], residuals: &mut [f64], jacobian: &mut [f64]) {
        let (normal, offset) = &self.feet[b];
        residuals[0] = self.points[b].read(x).dot(normal) - offset;
        jacobian.copy_from_slice(normal.as_slice());
    }
    fn refresh(&mut self, x: &[f64]) {
        for (point, foot) in self.points.iter().zip(&mut self.feet) {
            let found = self.target.surface.closest(&Point3::from(point.read(x) * self.scale));
            *foot = (found.normal, found.point.coords.dot(&found.normal) / self.scale);
        }
    }
}

/// Lengths: the squared distance of two points minus the squared model length. One residual per pair.
pub struct Lengths {
    name: &'static str,
    pairs: Vec<([PointAt; 2], Vec<usize>, f64)>,
}

impl Lengths {
    /// Pairs of points of the same dimension with their model lengths.
    pub fn new(name: &'static str, pairs: impl IntoIterator<Item = ([PointAt; 2], f64)>) -> Self {
        let pairs = pairs.into_iter().map(|(points, length)| (points, indices(&points), length)).collect();
        Self { name, pairs }
    }
}

impl Term for Lengths {
    fn name(&self) -> &'static str {
        self.name
    }
    fn blocks(&self) -> usize {
        self.pairs.len()
    }
    fn rows(&self, _: usize) -> usize {
        1
    }
    fn unknowns(&self, b: usize) -> &[usize] {
        &self.pairs[b].1
    }
    fn evaluate(&self, b: usize, x: &[f64], residuals: &mut [f64], jacobian: &mut [f64]) {
        let ([p, q], _, length) = &self.pairs[b];
        let along = q.read(x) - p.read(x);
        residuals[0] = along.norm_squared() - length * length;
        for axis in 0..p.dimension {
            jacobian[axis] = -2.0 * along[axis];
            jacobian[p.dimension + axis] = 2.0 * along[axis];
        }
    }
}

/// What a border point of the pattern is held to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Hold {
    /// The target's boundary; the point may glide along it.
    Boundary,
    /// A plane given by a point (millimetres) and a unit normal.
    Plane(Point3, Vector3),
}

/// Keeps the pattern's border on the target's boundary, or where it was in Stage 1, measured outwards along
/// the surface.
pub struct Boundary<'a> {
    points: Vec<(PointAt, Hold)>,
    unknowns: Vec<usize>,
    target: &'a Target,
    /// Millimetres per unit of length of the unknowns.
    scale: f64,
    feet: Vec<(Vector3, f64)>,
}

impl<'a> Boundary<'a> {
    /// Over points in space with what they are held to.
    pub fn new(points: Vec<(PointAt, Hold)>, target: &'a Target, scale: f64) -> Self {
        let unknowns = points.iter().flat_map(|(p, _)| p.indices()).collect();
        let feet = vec![(Vector3::zeros(), 0.0); points.len()];
        Self { points, unknowns, target, scale, feet }
    }
}

impl Term for Boundary<'_> {
    fn name(&self) -> &'static str {
        "boundary"
    }
    fn blocks(&self) -> usize {
        self.points.len()
    }
    fn rows(&self, _: usize) -> usize {
        1
    }
    fn unknowns(&self, b: usize) -> &[usize] {
        &self.unknowns[3 * b..3 * b + 3]
    }
    fn evaluate(&self, b: usize, x: &[f64], residuals: &mut [f64], jacobian: &mut [f64]) {
        let (normal, offset) = &self.feet[b];
        residuals[0] = self.points[b].0.read(x).dot(normal) - offset;
        jacobian.copy_from_slice(normal.as_slice());
    }
    fn refresh(&mut self, x: &[f64]) {
        for ((point, hold), foot) in self.points.iter().zip(&mut self.feet) {
            let (at, normal) = match hold {
                Hold::Plane(at, normal) => (*at, *normal),
                Hold::Boundary => {
                    let found = self.target.boundary.closest(&Point3::from(point.read(x) * self.scale));
                    (found.point, found.conormal)
                }
            };
            *foot = (normal, at.coords.dot(&normal) / self.scale);
        }
    }
}

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

/// Right angles: the product of two sides that meet in a point vanishes. One residual per angle.
///
/// Over the open hinges it keeps the pattern fully open, as the model cell is; over the corners of closed
/// pieces it keeps these near rectangles.
pub struct RightAngles {
    name: &'static str,
    angles: Vec<([PointAt; 3], Vec<usize>)>,
}

impl RightAngles {
    /// Each angle's apex with the far ends of its two sides; all points have the same dimension.
    pub fn new(name: &'static str, angles: impl IntoIterator<Item = [PointAt; 3]>) -> Self {
        Self { name, angles: angles.into_iter().map(|points| (points, indices(&points))).collect() }
    }
}

impl Term for RightAngles {
    fn name(&self) -> &'static str {
        self.name
    }
    fn blocks(&self) -> usize {
        self.angles.len()
    }
    fn rows(&self, _: usize) -> usize {
        1
    }
    fn unknowns(&self, b: usize) -> &[usize] {
        &self.angles[b].1
    }
    fn evaluate(&self, b: usize, x: &[f64], residuals: &mut [f64], jacobian: &mut [f64]) {
        let points = &self.angles[b].0;
        let [apex, p, q] = points.map(|point| point.read(x));
        let (u, v) = (p - apex, q - apex);
        residuals[0] = u.dot(&v);
        let dimension = points[0].dimension;
        for axis in 0..dimension {
            jacobian[axis] = -u[axis] - v[axis];
            jacobian[dimension + axis] = v[axis];
            jacobian[2 * dimension + axis] = u[axis];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::mesh::TriMesh;
    use crate::solver::derivative_check::largest_jacobian_error;

    fn at(start: usize, dimension: usize) -> PointAt {
        PointAt { start, dimension }
    }

    /// Numbers without a pattern.
    fn scattered(n: usize) -> Vec<f64> {
        (0..n).map(|i| ((i * i + 3 * i) as f64 * 0.7391).sin() * 1.7).collect()
    }

    fn piece(n: usize) -> PieceAt {
        let closed = (0..n).map(|i| (at(2 * i, 2), Vector3::new(0.1 * i as f64, -0.05, 0.0))).collect();
        PieceAt { closed, open: (0..n).map(|i| at(2 * n + 3 * i, 3)).collect() }
    }

    fn target() -> Target {
        let vertices = [[-9.0, -9.0, 0.1], [9.0, -8.0, 0.0], [8.0, 9.0, 0.4], [-9.0, 8.0, -0.3]];
        Target::new(
            TriMesh { vertices: vertices.map(Point3::from).to_vec(), faces: vec![[0, 1, 2], [0, 2, 3]] },
            &[0, 1, 2, 3],
        )
    }

    #[test]
    fn jacobians_agree_with_differences() {
        let x = scattered(40);
        let target = target();
        let inner = |d: usize, s: usize| {
            Diagonals::new(at(s, d), at(s + d, d), at(s + 2 * d, d), Some(at(s + 3 * d, d)))
        };
        let border = |d: usize, s: usize| Diagonals::new(at(s, d), at(s + d, d), at(s + 2 * d, d), None);
        let mut terms: Vec<Box<dyn Term + '_>> = vec![
            Box::new(LinearTerm::new("fair", 3, &[vec![(at(0, 3), 1.0), (at(3, 3), -2.5), (at(9, 3), 1.5)]])),
            Box::new(OrthogonalDiagonals::new([inner(2, 0), inner(3, 8), border(2, 0), border(3, 8)])),
            Box::new(CellDimensions::new(
                [(inner(2, 0), inner(3, 8)), (border(2, 0), border(3, 8))],
                0.7,
                0.05,
            )),
            Box::new(Isometry::new(&[piece(4), piece(5)])),
            Box::new(Planarity::new(&[piece(4), piece(6)])),
            Box::new(Lengths::new("sides", [([at(0, 2), at(6, 2)], 0.9), ([at(8, 2), at(2, 2)], 1.2)])),
            Box::new(RightAngles::new("opening", [[at(0, 3), at(6, 3), at(30, 3)]])),
            Box::new(RightAngles::new("rectangles", [[at(0, 2), at(6, 2), at(30, 2)]])),
            Box::new(Proximity::new(vec![at(0, 3), at(6, 3)], &target, 2.0)),
            Box::new(Boundary::new(
                vec![
                    (at(0, 3), Hold::Plane(Point3::new(1.0, 2.0, 3.0), Vector3::y())),
                    (at(3, 3), Hold::Boundary),
                ],
                &target,
                2.0,
            )),
        ];
        for term in &mut terms {
            term.refresh(&x);
            // Cubic residuals at most: the central difference errs by h^2 = 1e-10, rounding by 1e-16 / 1e-5.
            let error = largest_jacobian_error(term.as_ref(), &x, 1e-5);
            assert!(error < 1e-8, "{}: {error}", term.name());
            assert!(term.blocks() > 0);
        }
    }

    #[test]
    fn proximity_and_boundary_measure_distances() {
        let target = target();
        let mut proximity = Proximity::new(vec![at(0, 3)], &target, 1.0);
        let x = [1.0, 2.0, 3.0];
        proximity.refresh(&x);
        let mut residual = [0.0];
        proximity.evaluate(0, &x, &mut residual, &mut [0.0; 3]);
        let distance = target.surface.distance(&Point3::from(x));
        // The two facets differ by about two degrees, so the smooth normal shortens by at most 1e-3.
        assert!((residual[0].abs() / distance - 1.0).abs() < 1e-3, "{} {distance}", residual[0]);
        // A point outside, straight before the middle of the edge y = -9 .. -8: positive distance outwards.
        let mut boundary = Boundary::new(vec![(at(0, 3), Hold::Boundary)], &target, 1.0);
        let outside = [0.0, -10.5, 0.05];
        boundary.refresh(&outside);
        boundary.evaluate(0, &outside, &mut residual, &mut [0.0; 3]);
        assert!((residual[0] - 2.0).abs() < 0.02, "{}", residual[0]);
    }

    #[test]
    fn a_rigid_motion_has_no_isometry_residual() {
        let piece = piece(4);
        let closed = [[0.0, 0.0], [1.0, 0.1], [1.1, 0.9], [-0.1, 1.0]];
        let mut x: Vec<f64> = closed.concat();
        let turn = nalgebra::Rotation3::from_euler_angles(0.4, -0.8, 2.0);
        for (i, (_, offset)) in piece.closed.iter().enumerate() {
            let p = turn * (Vector3::new(closed[i][0], closed[i][1], 0.0) + offset)
                + Vector3::new(3.0, 1.0, -2.0);
            x.extend(p.iter());
        }
        let mut residuals = [0.0; 6];
        Isometry::new(std::slice::from_ref(&piece)).evaluate(0, &x, &mut residuals, &mut [0.0; 6 * 20]);
        assert!(residuals.iter().all(|r| r.abs() < 1e-14), "{residuals:?}");
        Planarity::new(&[piece]).evaluate(0, &x, &mut residuals[..1], &mut [0.0; 12]);
        assert!(residuals[0].abs() < 1e-14);
    }
}
