//! Principal stretches of a map between triangle meshes of the same combinatorics.
//!
//! A linear map of the plane is kept as two complex numbers: `v -> turning * v + mirroring * conj(v)`. Its
//! singular values are `|turning| + |mirroring|` and `|turning| - |mirroring|`, the second negative where the
//! map turns triangles over: the closed formula for 2 x 2 matrices, without angles.

use super::mesh::TriMesh;
use super::{Point2, Vector2};
use nalgebra::Complex;

/// A linear map of the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneMap {
    /// The part that turns and scales.
    pub turning: Complex<f64>,
    /// The part that turns and scales after a reflection in the x axis.
    pub mirroring: Complex<f64>,
}

impl PlaneMap {
    /// The singular values, largest first; the second has the sign of the determinant.
    pub fn singular_values(&self) -> [f64; 2] {
        let (q, r) = (self.turning.norm(), self.mirroring.norm());
        [q + r, q - r]
    }

    /// The nearest map whose singular values lie between two positive bounds.
    pub fn within(&self, low: f64, high: f64) -> Self {
        let (q, r) = (self.turning.norm(), self.mirroring.norm());
        let [first, second] = [q + r, q - r].map(|s| s.clamp(low, high));
        // A map without a turning part has no nearest rotation: any will do.
        let turning =
            if q > 0.0 { self.turning / q } else { Complex::new(1.0, 0.0) } * (0.5 * (first + second));
        let mirroring = if r > 0.0 { self.mirroring * (0.5 * (first - second) / r) } else { self.mirroring };
        Self { turning, mirroring }
    }

    /// Image of a vector.
    pub fn apply(&self, v: Complex<f64>) -> Complex<f64> {
        self.turning * v + self.mirroring * v.conj()
    }
}

/// A triangle of a surface, ready to measure maps of it into the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gradients {
    /// Gradients of the three barycentric coordinates in a frame of the triangle's own plane.
    pub of_corners: [Complex<f64>; 3],
    /// Area of the triangle.
    pub area: f64,
}

impl Gradients {
    /// Of one face of a mesh. Its frame begins along the face's first edge.
    pub fn new(mesh: &TriMesh, face: &[usize; 3]) -> Self {
        let [_, b, c] = laid_out(mesh, face);
        let (length, along, across) = (b.x, c.x, c.y);
        // Each gradient is perpendicular to the opposite edge and as long as the inverse height.
        let at_b = Complex::new(1.0 / length, -along / (length * across));
        let at_c = Complex::new(0.0, 1.0 / across);
        Self { of_corners: [-at_b - at_c, at_b, at_c], area: 0.5 * length * across }
    }

    /// The map that takes the triangle's corners to these points of the plane.
    pub fn map_to(&self, corners: [Point2; 3]) -> PlaneMap {
        let mut map = PlaneMap { turning: Complex::new(0.0, 0.0), mirroring: Complex::new(0.0, 0.0) };
        for (gradient, corner) in self.of_corners.iter().zip(corners) {
            let half = Complex::new(0.5 * (corner.x - corners[0].x), 0.5 * (corner.y - corners[0].y));
            map.turning += half * gradient.conj();
            map.mirroring += half * gradient;
        }
        map
    }
}

/// A face laid into the plane: its first corner at the origin, its second on the x axis.
pub fn laid_out(mesh: &TriMesh, face: &[usize; 3]) -> [Point2; 3] {
    let [a, b, c] = face.map(|v| mesh.vertices[v]);
    let (ab, ac) = (b - a, c - a);
    let length = ab.norm();
    let along = ac.dot(&ab) / length;
    let across = (ac - ab * (along / length)).norm();
    [Point2::origin(), Point2::new(length, 0.0), Point2::new(along, across)]
}

/// How a triangle of the plane is stretched when it becomes its counterpart on the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// Length on the surface over length in the plane: largest, smallest. Infinite or negative where the
    /// triangle of the plane has no area or is turned over.
    pub principal: [f64; 2],
    /// Unit vector of the plane that is stretched most; any where both are equal.
    pub direction: Vector2,
    /// Area on the surface.
    pub area: f64,
}

/// Stretches of the map from a flattening (#V points) back to the surface, one per face.
pub fn stretches(mesh: &TriMesh, flat: &[Point2]) -> Vec<Stretch> {
    let stretch = |face: &[usize; 3]| {
        let gradients = Gradients::new(mesh, face);
        let map = gradients.map_to(face.map(|v| flat[v]));
        let [first, second] = map.singular_values();
        // In the image the directions of the singular values are at the mean angle of the two parts (first)
        // and across it (second); the second is shortened most by the flattening, so stretched most on the
        // way back.
        let along = (map.turning * map.mirroring).sqrt();
        let length = along.norm();
        let direction = if length > 0.0 { Vector2::new(-along.im, along.re) / length } else { Vector2::x() };
        Stretch { principal: [1.0 / second, 1.0 / first], direction, area: gradients.area }
    };
    mesh.faces.iter().map(stretch).collect()
}

/// Stretches of the map between two meshes with the same faces, one per face: from `start` to `end`.
///
/// Directions are in a frame of each start triangle that begins along its first edge. Triangles in space are not turned
/// over, so nothing is negative.
pub fn stretches_between(start: &TriMesh, end: &TriMesh) -> Vec<Stretch> {
    let stretch = |face: &[usize; 3]| {
        let gradients = Gradients::new(start, face);
        let image = laid_out(end, face);
        let map = gradients.map_to(image);
        // Before the map the direction stretched most is at half the angle between the two parts.
        let direction = (map.mirroring * map.turning.conj()).sqrt();
        let norm = direction.norm();
        let direction =
            if norm > 0.0 { Vector2::new(direction.re, direction.im) / norm } else { Vector2::x() };
        Stretch { principal: map.singular_values(), direction, area: 0.5 * image[1].x * image[2].y }
    };
    start.faces.iter().map(stretch).collect()
}

/// Largest over smallest stretch of a whole map; infinite where a triangle is turned over.
pub fn worst_ratio(stretches: &[Stretch]) -> f64 {
    let start = (0.0_f64, f64::INFINITY);
    let (most, least) = stretches.iter().fold(start, |(most, least), s| {
        (most.max(s.principal[0]), least.min(s.principal[0]).min(s.principal[1]))
    });
    if least > 0.0 { most / least } else { f64::INFINITY }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point3, Vector3};
    use nalgebra::{Matrix2, Rotation3};

    /// A bent strip of the plane: three vertices wide, with its preimage in the plane.
    fn strip(map: impl Fn(f64, f64) -> Point3) -> (TriMesh, Vec<Point2>) {
        let n = 9;
        let at = |i: usize| (0.1 * (i % n) as f64, 0.07 * (i / n) as f64 + 0.003 * ((i * i) % 7) as f64);
        let flat: Vec<Point2> = (0..n * n).map(|i| Point2::new(at(i).0, at(i).1)).collect();
        let vertices = flat.iter().map(|p| map(p.x, p.y)).collect();
        let faces = (0..n - 1)
            .flat_map(|j| (0..n - 1).map(move |i| j * n + i))
            .flat_map(|a| [[a, a + 1, a + n + 1], [a, a + n + 1, a + n]])
            .collect();
        (TriMesh { vertices, faces }, flat)
    }

    #[test]
    fn affine_maps_have_the_singular_values_of_their_matrix() {
        for k in 0..20 {
            let t = f64::from(k);
            let (m1, m2) = (1.4 + 0.5 * t.sin(), 0.6 + 0.2 * (2.0 * t).cos());
            let (c, s) = ((0.7 * t).cos(), (0.7 * t).sin());
            let (e, f) = ((1.9 * t).cos(), (1.9 * t).sin());
            // A turn, stretches along the axes, another turn: the first row of the last is the direction.
            let matrix =
                Matrix2::new(c, -s, s, c) * Matrix2::new(m1, 0.0, 0.0, m2) * Matrix2::new(e, f, -f, e);
            let (mesh, flat) = strip(|x, y| {
                let p = matrix * Vector2::new(x, y);
                Point3::new(p.x, p.y, 3.0)
            });
            for stretch in stretches(&mesh, &flat) {
                assert!((stretch.principal[0] - m1).abs() < 1e-12, "{stretch:?}");
                assert!((stretch.principal[1] - m2).abs() < 1e-12, "{stretch:?}");
                assert!(stretch.direction.perp(&Vector2::new(e, f)).abs() < 1e-12, "{stretch:?}");
            }
            // The same between two meshes, the first of which is turned in space.
            let tilt = Rotation3::from_euler_angles(0.4, -0.8, 1.7);
            let tilted = flat.iter().map(|p| tilt * Point3::new(p.x, p.y, 0.0)).collect();
            let start = TriMesh { vertices: tilted, faces: mesh.faces.clone() };
            for (face, stretch) in mesh.faces.iter().zip(stretches_between(&start, &mesh)) {
                assert!((stretch.principal[0] - m1).abs() < 1e-11, "{stretch:?}");
                assert!((stretch.principal[1] - m2).abs() < 1e-11, "{stretch:?}");
                let side = (flat[face[1]] - flat[face[0]]).normalize();
                let local = Vector2::new(side.x * e + side.y * f, side.x * f - side.y * e);
                assert!(stretch.direction.perp(&local).abs() < 1e-11, "{stretch:?}");
            }
        }
    }

    #[test]
    fn a_rolled_up_sheet_and_a_turned_over_one() {
        // The chord over an arc of 0.1 is shorter by a part of 0.1^2 / 24.
        let (mesh, flat) = strip(|x, y| Point3::new(x.sin(), y, x.cos()));
        assert!((worst_ratio(&stretches(&mesh, &flat)) - 1.0).abs() < 1e-3);
        let mirrored: Vec<Point2> = flat.iter().map(|p| Point2::new(-p.x, p.y)).collect();
        assert!(worst_ratio(&stretches(&mesh, &mirrored)).is_infinite());
    }

    #[test]
    fn nothing_depends_on_position_scale_or_numbers() {
        let shape = |x: f64, y: f64| Point3::new(1.3 * x, y, 0.4 * (x * x - 0.5 * x * y));
        let (mesh, flat) = strip(shape);
        let base = stretches(&mesh, &flat);
        let turn = Rotation3::from_euler_angles(0.3, -1.1, 2.0);
        let moved: Vec<Point3> =
            mesh.vertices.iter().map(|p| turn * (p * 25.4) + Vector3::new(5.0, -70.0, 3.0)).collect();
        let scaled: Vec<Point2> = flat.iter().map(|p| p * 25.4 + Vector2::new(-3.0, 9.0)).collect();
        let count = flat.len();
        // Vertices counted backwards, faces begun elsewhere.
        let faces =
            mesh.faces.iter().map(|&[a, b, c]| [count - 1 - b, count - 1 - c, count - 1 - a]).collect();
        let other = TriMesh { vertices: moved.into_iter().rev().collect(), faces };
        let scaled: Vec<Point2> = scaled.into_iter().rev().collect();
        for (one, two) in base.iter().zip(stretches(&other, &scaled)) {
            for (m, n) in one.principal.iter().zip(two.principal) {
                assert!((m - n).abs() < 1e-10, "{m} {n}");
            }
            assert!((two.area / one.area / 25.4_f64.powi(2) - 1.0).abs() < 1e-10);
            let anisotropy = one.principal[0] / one.principal[1] - 1.0;
            assert!(one.direction.perp(&two.direction).abs() * anisotropy < 1e-10);
        }
    }

    #[test]
    fn a_cap_laid_out_with_true_radii() {
        // Azimuthal equidistant map of the unit sphere: 1 along meridians, sin(r) / r across.
        let polar = |r: f64, phi: f64| {
            (
                Point2::new(r * phi.cos(), r * phi.sin()),
                Point3::new(r.sin() * phi.cos(), r.sin() * phi.sin(), r.cos()),
            )
        };
        let h = 1e-3;
        for r in [0.3, 0.8, 1.4] {
            let corners = [polar(r, 0.0), polar(r + h, 0.0), polar(r, h / r)];
            let mesh = TriMesh { vertices: corners.map(|c| c.1).to_vec(), faces: vec![[0, 1, 2]] };
            let stretch = stretches(&mesh, &corners.map(|c| c.0))[0];
            assert!((stretch.principal[0] - 1.0).abs() < h, "{stretch:?}");
            assert!((stretch.principal[1] - r.sin() / r).abs() < h, "{stretch:?}");
            // The meridian through the triangle is the x axis.
            assert!(stretch.direction.x.abs() > 0.99, "{stretch:?}");
        }
    }

    #[test]
    fn bounded_maps_are_nearest() {
        let map = PlaneMap { turning: Complex::new(0.8, 0.3), mirroring: Complex::new(-0.5, 0.4) };
        let bounded = map.within(0.7, 1.2);
        let [first, second] = bounded.singular_values();
        assert!((first - 1.2).abs() < 1e-12 && (second - 0.7).abs() < 1e-12);
        // Any other admissible map is farther: turn the two parts a little, or move the values inwards.
        let distance =
            |m: &PlaneMap| (m.turning - map.turning).norm_sqr() + (m.mirroring - map.mirroring).norm_sqr();
        let nudge = Complex::from_polar(1.0, 0.01);
        let nudged = [
            PlaneMap { turning: bounded.turning * nudge, ..bounded },
            PlaneMap { mirroring: bounded.mirroring * nudge, ..bounded },
            map.within(0.71, 1.2),
            map.within(0.7, 1.19),
        ];
        assert!(nudged.iter().all(|other| distance(other) > distance(&bounded)));
    }
}
