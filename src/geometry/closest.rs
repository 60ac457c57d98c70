//! Nearest points on a triangle mesh.
//!
//! An R-tree of the triangles (crate `rstar`) with the exact distance from a point to a triangle (C. Ericson,
//! *Real-Time Collision Detection*, 5.1.5).

use super::mesh::TriMesh;
use super::{Point3, Vector3};
use rstar::{AABB, PointDistance, RTree, RTreeObject};

/// A triangle mesh prepared for nearest-point queries.
pub struct ClosestPoints {
    mesh: TriMesh,
    vertex_normals: Vec<Vector3>,
    tree: RTree<IndexedTriangle>,
}

/// The point of a mesh nearest to a query point.
#[derive(Debug, Clone, Copy)]
pub struct Closest {
    /// The triangle it lies in.
    pub triangle: usize,
    /// Weights of the triangle's three vertices; they sum to 1.
    pub barycentric: [f64; 3],
    /// The point.
    pub point: Point3,
    /// Unit normal there, interpolated from the vertices' normals.
    pub normal: Vector3,
}

struct IndexedTriangle {
    index: usize,
    corners: [Point3; 3],
}

impl RTreeObject for IndexedTriangle {
    type Envelope = AABB<[f64; 3]>;

    fn envelope(&self) -> Self::Envelope {
        let coordinates: Vec<[f64; 3]> = self.corners.iter().map(|p| [p.x, p.y, p.z]).collect();
        AABB::from_points(&coordinates)
    }
}

impl PointDistance for IndexedTriangle {
    fn distance_2(&self, point: &[f64; 3]) -> f64 {
        let query = Point3::from(*point);
        let weights = closest_in_triangle(&query, &self.corners);
        (interpolate(&self.corners, &weights) - query).norm_squared()
    }
}

impl ClosestPoints {
    /// Builds the index. Vertex normals are the sums of the area-weighted normals of the faces around.
    pub fn new(mesh: TriMesh) -> Self {
        let corners_of = |face: &[usize; 3]| face.map(|v| mesh.vertices[v]);
        let mut vertex_normals = vec![Vector3::zeros(); mesh.vertices.len()];
        for face in &mesh.faces {
            let [a, b, c] = corners_of(face);
            let normal = (b - a).cross(&(c - a));
            face.iter().for_each(|&v| vertex_normals[v] += normal);
        }
        let triangles = mesh.faces.iter().enumerate();
        let tree = RTree::bulk_load(
            triangles.map(|(index, face)| IndexedTriangle { index, corners: corners_of(face) }).collect(),
        );
        Self { mesh, vertex_normals, tree }
    }

    /// The mesh that the answers refer to.
    pub fn mesh(&self) -> &TriMesh {
        &self.mesh
    }

    /// The nearest point of the mesh.
    ///
    /// # Panics
    /// If the mesh has no triangle: a broken invariant of the caller.
    pub fn closest(&self, query: &Point3) -> Closest {
        let found = self.tree.nearest_neighbor(&[query.x, query.y, query.z]).expect("a mesh with triangles");
        let barycentric = closest_in_triangle(query, &found.corners);
        let face = self.mesh.faces[found.index];
        let smooth: Vector3 = (0..3).map(|i| self.vertex_normals[face[i]].normalize() * barycentric[i]).sum();
        let [a, b, c] = found.corners;
        let flat = (b - a).cross(&(c - a)).normalize();
        // Vertex normals may cancel at a sharp fold; the face's own normal is right there.
        let normal = smooth.try_normalize(1e-3).filter(|n| n.dot(&flat) > 0.0).unwrap_or(flat);
        Closest {
            triangle: found.index,
            barycentric,
            point: interpolate(&found.corners, &barycentric),
            normal,
        }
    }

    /// Distance from a point to the mesh.
    pub fn distance(&self, query: &Point3) -> f64 {
        (self.closest(query).point - query).norm()
    }
}

fn interpolate(corners: &[Point3; 3], weights: &[f64; 3]) -> Point3 {
    Point3::from((0..3).map(|i| corners[i].coords * weights[i]).sum::<Vector3>())
}

/// Barycentric weights of the point of a triangle nearest to `p`.
fn closest_in_triangle(p: &Point3, [a, b, c]: &[Point3; 3]) -> [f64; 3] {
    let (ab, ac) = (b - a, c - a);
    let ap = p - a;
    let (d1, d2) = (ab.dot(&ap), ac.dot(&ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(&bp), ac.dot(&bp));
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let v = d1 / (d1 - d3);
        return [1.0 - v, v, 0.0];
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(&cp), ac.dot(&cp));
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let w = d2 / (d2 - d6);
        return [1.0 - w, 0.0, w];
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        let w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return [0.0, 1.0 - w, w];
    }
    let sum = va + vb + vc;
    [va / sum, vb / sum, vc / sum]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_dense_sampling_and_brute_force() {
        // A wavy strip; the oracle samples every triangle densely.
        let n = 6;
        let vertices: Vec<Point3> = (0..n * n)
            .map(|i| ((i % n) as f64, (i / n) as f64))
            .map(|(x, y)| Point3::new(x, y, (x * 0.9).sin() * (y * 0.7).cos()))
            .collect();
        let mut faces = Vec::new();
        for j in 0..n - 1 {
            for i in 0..n - 1 {
                let a = j * n + i;
                faces.push([a, a + 1, a + n + 1]);
                faces.push([a, a + n + 1, a + n]);
            }
        }
        let index = ClosestPoints::new(TriMesh { vertices: vertices.clone(), faces: faces.clone() });
        for k in 0..40 {
            let t = k as f64;
            let query =
                Point3::new(2.5 + 4.0 * (t * 1.3).sin(), 2.5 + 4.0 * (t * 0.7).cos(), 1.5 * (t * 2.1).sin());
            let found = index.closest(&query);
            let distance = (found.point - query).norm();
            let mut sampled = f64::INFINITY;
            for face in &faces {
                for s in 0..=40 {
                    for r in 0..=40 - s {
                        let (u, v) = (s as f64 / 40.0, r as f64 / 40.0);
                        let corners = face.map(|i| vertices[i]);
                        let point = interpolate(&corners, &[1.0 - u - v, u, v]);
                        sampled = sampled.min((point - query).norm());
                    }
                }
            }
            assert!(distance <= sampled + 1e-12, "{distance} {sampled}");
            // Samples are 1/40 of an edge (at most 2) apart.
            assert!(sampled - distance < 0.05, "{distance} {sampled}");
            assert!((found.barycentric.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            assert!((found.normal.norm() - 1.0).abs() < 1e-12 && found.normal.z > 0.0);
        }
    }
}
