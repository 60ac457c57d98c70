//! Mirrored pieces: the distances within a piece are the same in its mirror image, so that only this check tells them apart.

use super::design::Piece;
use super::rigidity::misfit_of;
use crate::geometry::rotation::RigidMotion;
use crate::geometry::{Point3, Vector3};

/// Whether the open piece is the mirror image of the closed one, not the piece turned. `normals` are those of the closed
/// and of the open sheet where the piece is.
///
/// A piece that bends is mirrored if a reflection fits it better than every rotation. A flat one fits both alike: there the
/// rotation tells, which turns a mirrored piece upside down.
pub fn is_mirrored(piece: &Piece, normals: [Vector3; 2]) -> bool {
    let motion = RigidMotion::fit(&piece.closed, &piece.open);
    let upright = (motion.rotation * normals[0]).dot(&normals[1]) > 0.0;
    // Whatever is not a number must not pass.
    !(upright && motion.rotation.determinant() > 0.0) || fits_mirrored(&piece.closed, &piece.open)
}

/// A misfit below this part of a piece is rounding, of which a reflection may have less by chance.
const ROUNDING: f64 = 1e-9;

/// Whether a reflection leaves less than half of what the best rotation leaves.
fn fits_mirrored(from: &[Point3], to: &[Point3]) -> bool {
    // Any reflection will do: the best rotation that follows takes it to the best one.
    let mirrored: Vec<Point3> = from.iter().map(|p| Point3::new(p.x, p.y, -p.z)).collect();
    let turned = misfit_of(from, to);
    let size = from.iter().map(|p| (p - from[0]).norm()).fold(0.0, f64::max);
    turned > ROUNDING * size && misfit_of(&mirrored, to) < 0.5 * turned
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation3;

    /// A quad with a vertex at this height off the plane of the others, and what `image` makes of it.
    fn piece(height: f64, image: impl Fn(Point3) -> Point3) -> Piece {
        let closed = [[0.0, 0.0, 0.0], [3.0, 0.2, 0.0], [2.7, 2.0, height], [-0.2, 1.8, 0.0]];
        let closed: Vec<Point3> = closed.iter().map(|&[x, y, z]| Point3::new(x, y, z)).collect();
        let open = closed.iter().map(|&p| image(p)).collect();
        Piece { corners: vec![0, 1, 2, 3], closed, open }
    }

    fn turn() -> Rotation3<f64> {
        Rotation3::from_euler_angles(0.5, -0.3, 0.8)
    }

    #[test]
    fn turned_pieces_are_not_mirrored_and_mirrored_ones_are_found() {
        let normals = [Vector3::z(), turn() * Vector3::z()];
        let shift = Vector3::new(5.0, 1.0, -2.0);
        for height in [0.0, 1e-3, 0.2] {
            assert!(!is_mirrored(&piece(height, |p| turn() * p + shift), normals), "{height}");
            // Within its plane, as a pattern that has slipped over itself would do.
            let across = |p: Point3| turn() * Point3::new(-p.x, p.y, p.z) + shift;
            assert!(is_mirrored(&piece(height, across), normals), "{height}");
        }
        // Bent the other way: its outline is that of the turned piece.
        let below = |p: Point3| turn() * Point3::new(p.x, p.y, -p.z);
        assert!(is_mirrored(&piece(1e-3, below), normals));
        assert!(!is_mirrored(&piece(0.0, below), normals), "a flat piece is its own image");
        assert!(is_mirrored(&piece(0.1, |p| Point3::new(f64::NAN, p.y, p.z)), normals));
    }

    #[test]
    fn a_piece_that_does_not_quite_fit_is_not_mirrored() {
        // Stretched, then turned: a rotation leaves as little as any reflection.
        let stretched = |p: Point3| turn() * Point3::new(1.01 * p.x, p.y, p.z);
        assert!(!is_mirrored(&piece(0.0, stretched), [Vector3::z(), turn() * Vector3::z()]));
    }
}
