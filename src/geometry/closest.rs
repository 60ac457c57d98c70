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
    /// Unit normals of the vertices.
    vertex_normals: Vec<Vector3>,
    tree: RTree<IndexedTriangle>,
    /// Points nearer than this to the mesh have few triangles about them.
    near: f64,
}

/// A point is near where it is within so many edges of average length.
const NEAR: f64 = 2.0;

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
        let [a, b, c] = &self.corners;
        AABB::from_corners(a.inf(b).inf(c).into(), a.sup(b).sup(c).into())
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
        vertex_normals.iter_mut().for_each(|normal| *normal = normal.normalize());
        let triangles: Vec<IndexedTriangle> = mesh
            .faces
            .iter()
            .enumerate()
            .map(|(index, face)| IndexedTriangle { index, corners: corners_of(face) })
            .collect();
        let perimeters = triangles.iter().map(|IndexedTriangle { corners: [a, b, c], .. }| {
            (b - a).norm() + (c - b).norm() + (a - c).norm()
        });
        let near = NEAR * perimeters.sum::<f64>() / (3 * triangles.len()).max(1) as f64;
        Self { vertex_normals, tree: RTree::bulk_load(triangles), near, mesh }
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
        self.point_of(found, query)
    }

    /// The nearest point of the mesh, sooner found where `guess`, a triangle, is near it: at the query's last place, say. The
    /// guess does not change the answer.
    ///
    /// # Panics
    /// If the mesh has no such triangle.
    pub fn closest_from(&self, query: &Point3, guess: usize) -> Closest {
        let corners = self.mesh.faces[guess].map(|v| self.mesh.vertices[v]);
        let guess = IndexedTriangle { index: guess, corners };
        let query_array = [query.x, query.y, query.z];
        let mut bound = guess.distance_2(&query_array).sqrt();
        if bound > self.near {
            let found = self.tree.nearest_neighbor(&query_array).expect("a mesh with triangles");
            bound = found.distance_2(&query_array).sqrt();
            if bound > self.near {
                return self.point_of(found, query);
            }
        }
        // Of triangles that are equally near the first counts, so all of them have to be met: a little farther than rounding.
        let reach = Vector3::repeat(bound + 1e-12 * (bound + self.near));
        let place = AABB::from_corners((query - reach).into(), (query + reach).into());
        let around = self.tree.locate_in_envelope_intersecting(&place);
        let measured = around.map(|triangle| (triangle.distance_2(&query_array), triangle));
        let nearest = measured.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.index.cmp(&b.1.index)));
        self.point_of(nearest.map_or(&guess, |(_, found)| found), query)
    }

    /// The point of a triangle that is nearest to the query.
    fn point_of(&self, found: &IndexedTriangle, query: &Point3) -> Closest {
        let barycentric = closest_in_triangle(query, &found.corners);
        let face = self.mesh.faces[found.index];
        let smooth: Vector3 = (0..3).map(|i| self.vertex_normals[face[i]] * barycentric[i]).sum();
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
            for guess in 0..faces.len() {
                let guessed = index.closest_from(&query, guess);
                assert!(((guessed.point - query).norm() - distance).abs() < 1e-14, "{guess}");
                assert_eq!(guessed.triangle, index.closest_from(&query, 0).triangle);
            }
            assert!((found.normal.norm() - 1.0).abs() < 1e-12 && found.normal.z > 0.0);
        }
    }
}
