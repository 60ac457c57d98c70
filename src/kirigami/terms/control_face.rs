//! Terms of the control faces of Stage 2, Eqs. (4), (5) and (10).

use super::PointAt;
use crate::geometry::Vector3;
use crate::solver::Term;

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

/// The same principal stretches in every face, Eq. (10): two residuals per face, along and across the grid's first
/// direction. The paper's V is the expanded state, here "open".
pub struct PrincipalStretches {
    faces: Vec<(Diagonals, Diagonals, Vec<usize>, [f64; 2])>,
}

impl PrincipalStretches {
    /// Over pairs of faces (closed, open), each with the direction of its white diagonal, 0 or 1, and the stretches along
    /// the grid's two directions.
    pub fn new(
        faces: impl IntoIterator<Item = ((Diagonals, Diagonals), usize)>,
        stretches: [f64; 2],
    ) -> Self {
        let face = |((closed, open), direction): ((Diagonals, Diagonals), usize)| {
            let unknowns = [closed.unknowns(), open.unknowns()].concat();
            (closed, open, unknowns, [stretches[direction], stretches[1 - direction]])
        };
        Self { faces: faces.into_iter().map(face).collect() }
    }
}

impl Term for PrincipalStretches {
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
        let (closed, open, unknowns, [along, across]) = &self.faces[b];
        let columns = unknowns.len();
        let first_open = closed.points.iter().map(|(p, ..)| p.dimension).sum::<usize>();
        let (white, black) = closed.values(x);
        let (open_white, open_black) = open.values(x);
        let none = Vector3::zeros();
        let (along, across) = (along * along, across * across);
        residuals[0] = open_white.norm_squared() - along * white.norm_squared();
        residuals[1] = open_black.norm_squared() - across * black.norm_squared();
        let (first, second) = jacobian.split_at_mut(columns);
        closed.write(&(white * (-2.0 * along)), &none, &mut first[..first_open]);
        open.write(&(open_white * 2.0), &none, &mut first[first_open..]);
        closed.write(&none, &(black * (-2.0 * across)), &mut second[..first_open]);
        open.write(&none, &(open_black * 2.0), &mut second[first_open..]);
    }
}
