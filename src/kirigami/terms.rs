//! The residual terms of Stages 2 and 3, Eqs. (4) to (9) of the paper, with the boundary and planarity terms
//! that keep the pattern from collapsing and from bending its pieces.
//!
//! Unknowns are numbers; a point of a state is a run of two (plane) or three (space) of them. All terms are
//! in units in which the mean edge is 1.

mod control_face;

mod guided;

mod piece;

mod pull;

mod shape;

mod target;

mod width;

#[cfg(test)]
mod ideal_cells;

#[cfg(test)]
mod tests;

pub use control_face::{CellDimensions, Diagonals, OrthogonalDiagonals, PrincipalStretches};
pub use guided::Guided;
pub use piece::{ClosedVertex, Isometry, PieceAt, Planarity};
pub use pull::Pull;
pub use shape::{Lengths, LinearTerm, RightAngles};
pub use target::{Held, Hold};
pub use width::LeastWidths;

use crate::geometry::{Point3, Vector3};

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

    /// The point, where the unknowns are in units of `scale` millimetres.
    pub(super) fn point(self, x: &[f64], scale: f64) -> Point3 {
        Point3::from(self.read(x) * scale)
    }
}

fn indices(points: &[PointAt]) -> Vec<usize> {
    points.iter().flat_map(|p| p.indices()).collect()
}
