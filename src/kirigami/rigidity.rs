//! How rigid pieces really are: what the best rigid motion leaves between the two states.

use super::design::{Design, Piece};
use crate::geometry::Point3;
use crate::geometry::rotation::RigidMotion;

/// The piece that is least rigid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Misfit {
    /// Which piece.
    pub piece: usize,
    /// Largest distance between its vertices of the open state and those of the closed state moved rigidly to fit
    /// them best, over the mean side of all pieces.
    pub strain: f64,
}

/// Mean side of polygons; a side of two polygons counts twice.
pub fn mean_side<'a>(polygons: impl IntoIterator<Item = &'a Vec<Point3>>) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for polygon in polygons {
        for (i, p) in polygon.iter().enumerate() {
            sum += (polygon[(i + 1) % polygon.len()] - p).norm();
            count += 1.0;
        }
    }
    sum / count
}

/// Mean side of the closed hinge polygons, millimetres.
pub fn mean_piece_side(design: &Design) -> f64 {
    mean_side(design.pieces.iter().map(|piece| &piece.closed))
}

/// The misfit of each piece, in mean sides.
pub fn strains(design: &Design) -> Vec<f64> {
    let side = mean_piece_side(design);
    design.pieces.iter().map(|piece| misfit(piece) / side).collect()
}

/// The least rigid piece, the first of equals; `None` of no pieces.
pub fn worst(design: &Design) -> Option<Misfit> {
    let strains = strains(design).into_iter().enumerate();
    strains
        .map(|(piece, strain)| Misfit { piece, strain })
        .reduce(|worst, next| if next.strain > worst.strain { next } else { worst })
}

fn misfit(piece: &Piece) -> f64 {
    misfit_of(&piece.closed, &piece.open)
}

/// Largest distance that the best rigid motion from `from` to `to` leaves.
pub fn misfit_of(from: &[Point3], to: &[Point3]) -> f64 {
    let motion = RigidMotion::fit(from, to);
    from.iter().zip(to).map(|(p, q)| (motion.apply(p) - q).norm()).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Vector3;

    fn square(stretch: f64) -> Vec<Point3> {
        [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
            .map(|[x, y]| Point3::new(stretch * x, y, 0.0))
            .to_vec()
    }

    #[test]
    fn what_is_left_is_half_the_stretch() {
        // A square stretched by e about its centre: every corner is e off.
        assert!((misfit_of(&square(1.0), &square(1.01)) - 0.01).abs() < 1e-12);
        let turn = *nalgebra::Rotation3::from_euler_angles(0.4, 1.3, -1.0).matrix();
        let motion = RigidMotion { rotation: turn, translation: Vector3::new(5.0, 1.0, 2.0) };
        let moved: Vec<Point3> = square(1.0).iter().map(|p| motion.apply(p)).collect();
        assert!(misfit_of(&square(1.0), &moved) < 1e-14);
        assert!((mean_side([&square(1.0), &square(2.0)]) - 2.5).abs() < 1e-15);
    }
}
