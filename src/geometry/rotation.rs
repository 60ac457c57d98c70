//! Best-fit rigid motions and the axis and angle of rotations.

use super::{Point3, Vector3};
use nalgebra::Matrix3;

/// A rigid motion `p -> rotation p + translation`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigidMotion {
    /// Proper rotation.
    pub rotation: Matrix3<f64>,
    /// Translation, applied after the rotation.
    pub translation: Vector3,
}

impl RigidMotion {
    /// The motion that takes the points `from` to the points `to` with the least sum of squared errors
    /// (W. Kabsch 1976), as a proper rotation even where the points lie in a plane.
    pub fn fit(from: &[Point3], to: &[Point3]) -> Self {
        let centre = |points: &[Point3]| -> Vector3 {
            points.iter().map(|p| p.coords).sum::<Vector3>() / points.len() as f64
        };
        let (start, end) = (centre(from), centre(to));
        let mut covariance = Matrix3::zeros();
        for (p, q) in from.iter().zip(to) {
            covariance += (q.coords - end) * (p.coords - start).transpose();
        }
        let rotation = nearest_rotation(&covariance);
        Self { rotation, translation: end - rotation * start }
    }

    /// Moves a point.
    pub fn apply(&self, p: &Point3) -> Point3 {
        Point3::from(self.rotation * p.coords + self.translation)
    }

    /// No motion.
    pub fn identity() -> Self {
        Self { rotation: Matrix3::identity(), translation: Vector3::zeros() }
    }

    /// First `first`, then this one.
    pub fn after(&self, first: &Self) -> Self {
        Self {
            rotation: self.rotation * first.rotation,
            translation: self.rotation * first.translation + self.translation,
        }
    }

    /// The motion back.
    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.transpose();
        Self { rotation, translation: -(rotation * self.translation) }
    }
}

/// The proper rotation nearest to a matrix, entry by entry.
pub fn nearest_rotation(matrix: &Matrix3<f64>) -> Matrix3<f64> {
    let svd = matrix.svd(true, true);
    let (u, v_t) = (svd.u.expect("asked for"), svd.v_t.expect("asked for"));
    // Singular values come in descending order: a mirror is undone along the least direction.
    let sign = (u * v_t).determinant().signum();
    u * Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, sign)) * v_t
}

/// Axis (unit) and angle (0 to pi) of a proper rotation: counter-clockwise by the angle seen against the
/// axis.
///
/// `None` for the axis where the rotation is too close to the identity to have one.
pub fn axis_angle(rotation: &Matrix3<f64>) -> (Option<Vector3>, f64) {
    let twice_sine_axis = Vector3::new(
        rotation[(2, 1)] - rotation[(1, 2)],
        rotation[(0, 2)] - rotation[(2, 0)],
        rotation[(1, 0)] - rotation[(0, 1)],
    );
    let angle = twice_sine_axis.norm().atan2(rotation.trace() - 1.0);
    if angle < 1e-9 {
        return (None, angle);
    }
    if angle < 3.1 {
        return (Some(twice_sine_axis.normalize()), angle);
    }
    // Near a half turn the skew part vanishes; the symmetric part holds the axis up to its sign.
    let symmetric = (rotation + rotation.transpose()) * 0.5 - Matrix3::identity() * angle.cos();
    let column =
        (0..3).max_by(|&i, &j| symmetric[(i, i)].total_cmp(&symmetric[(j, j)])).expect("three columns");
    let axis = symmetric.column(column).normalize();
    (Some(if axis.dot(&twice_sine_axis) < 0.0 { -axis } else { axis }), angle)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation3;

    #[test]
    fn recovers_axis_and_angle() {
        for angle in [1e-6, 0.3, 1.57, 3.0, 3.13, 3.1414] {
            let axis = Vector3::new(0.3, -0.5, 0.8).normalize();
            let rotation = Rotation3::from_axis_angle(&nalgebra::Unit::new_normalize(axis), angle);
            let (found, turned) = axis_angle(rotation.matrix());
            assert!((turned - angle).abs() < 1e-12, "{angle} {turned}");
            // The axis of a small turn is known to rounding divided by the angle.
            assert!((found.unwrap() - axis).norm() < 1e-14 / angle + 1e-9, "{angle}");
        }
        assert!(axis_angle(&Matrix3::identity()).0.is_none());
    }

    #[test]
    fn fits_a_flat_quad_without_mirroring() {
        let quad = [[0.0, 0.0], [2.0, 0.1], [2.1, 1.0], [-0.1, 1.2]].map(|[x, y]| Point3::new(x, y, 0.0));
        let motion = RigidMotion {
            rotation: *Rotation3::from_euler_angles(0.2, -0.4, 2.0).matrix(),
            translation: Vector3::new(5.0, -3.0, 2.0),
        };
        let moved: Vec<Point3> = quad.iter().map(|p| motion.apply(p)).collect();
        let found = RigidMotion::fit(&quad, &moved);
        assert!((found.rotation - motion.rotation).norm() < 1e-12);
        assert!((found.translation - motion.translation).norm() < 1e-12);
        let back = found.inverse();
        assert!(quad.iter().zip(&moved).all(|(p, q)| (back.apply(q) - p).norm() < 1e-12));
    }
}
