//! The plane that fits points best, and the normal of a polygon.

use super::rotation::RigidMotion;
use super::{Point3, Vector3, centroid};
use nalgebra::Matrix3;

/// A plane through a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    /// A point of it.
    pub point: Point3,
    /// Unit normal.
    pub normal: Vector3,
}

impl Plane {
    /// The plane with the least sum of squared distances from `points` (one or more). Points of one height lie in a
    /// plane whose normal is +z exactly.
    pub fn fit(points: &[Point3]) -> Self {
        let point = centroid(points);
        if points.iter().all(|p| p.z == points[0].z) {
            return Self { point: Point3::new(point.x, point.y, points[0].z), normal: Vector3::z() };
        }
        let scatter: Matrix3<f64> = points.iter().map(|p| (p - point) * (p - point).transpose()).sum();
        let eigen = scatter.symmetric_eigen();
        Self { point, normal: eigen.eigenvectors.column(eigen.eigenvalues.imin()).into_owned() }
    }

    /// Signed distance of a point, positive on the side of the normal.
    pub fn distance(&self, p: &Point3) -> f64 {
        (p - self.point).dot(&self.normal)
    }

    /// The rigid motion that lays the plane on z = 0 with its normal up, by the least turn. A plane that is level stays
    /// where it is in x and y, to the last bit; one that is level and upside down is turned about the x axis.
    pub fn laid_flat(&self) -> RigidMotion {
        let up = Vector3::z();
        let rotation = if self.normal == up {
            Matrix3::identity()
        } else if self.normal == -up {
            Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0))
        } else {
            let turn = nalgebra::Rotation3::rotation_between(&self.normal, &up);
            // Nearly upside down: any half turn about a level axis will do.
            turn.map_or(Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0)), |turn| *turn.matrix())
        };
        let height = (rotation * self.point.coords).z;
        RigidMotion { rotation, translation: Vector3::new(0.0, 0.0, -height) }
    }
}

/// Twice the vector area of a polygon (M. E. Newell): along its normal, from which it runs counter-clockwise.
pub fn doubled_area(polygon: &[Point3]) -> Vector3 {
    let n = polygon.len();
    (0..n).map(|i| (polygon[i] - polygon[0]).cross(&(polygon[(i + 1) % n] - polygon[0]))).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat() -> Vec<Point3> {
        [[0.0, 0.0], [2.0, 0.1], [2.1, 1.0], [-0.1, 1.2], [0.7, 0.4]]
            .map(|[x, y]| Point3::new(x, y, 0.0))
            .to_vec()
    }

    #[test]
    fn a_tilted_plane_is_found_and_laid_flat() {
        let turn = *nalgebra::Rotation3::from_euler_angles(0.4, -0.3, 1.0).matrix();
        let motion = RigidMotion { rotation: turn, translation: Vector3::new(3.0, -1.0, 2.0) };
        let moved: Vec<Point3> = flat().iter().map(|p| motion.apply(p)).collect();
        let plane = Plane::fit(&moved);
        assert!(moved.iter().all(|p| plane.distance(p).abs() < 1e-14));
        assert!((plane.normal.cross(&(turn * Vector3::z()))).norm() < 1e-14);
        let laid = plane.laid_flat();
        assert!(moved.iter().all(|p| laid.apply(p).z.abs() < 1e-14));
        assert!((laid.rotation.determinant() - 1.0).abs() < 1e-14);
    }

    #[test]
    fn level_planes_keep_their_bits() {
        let raised: Vec<Point3> = flat().iter().map(|p| p + Vector3::new(0.0, 0.0, 7.25)).collect();
        let laid = Plane::fit(&raised).laid_flat();
        assert!(raised.iter().zip(flat()).all(|(p, q)| laid.apply(p) == q));
        let over = Plane { normal: -Vector3::z(), ..Plane::fit(&raised) }.laid_flat();
        assert!(raised.iter().zip(flat()).all(|(p, q)| over.apply(p) == Point3::new(q.x, -q.y, 0.0)));
    }

    #[test]
    fn the_area_points_to_where_the_polygon_runs_counter_clockwise() {
        let square = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]].map(|[x, y]| Point3::new(x, y, 5.0));
        assert_eq!(doubled_area(&square), Vector3::new(0.0, 0.0, 4.0));
    }
}
