//! Cotangent weights.
//!
//! Sign: the Laplacian `L` here is positive semidefinite, `(L u)_i = sum_j w_ij (u_i - u_j)` with
//! `w_ij = (cot alpha + cot beta) / 2` over the two angles opposite to edge ij.

use super::mesh::TriMesh;

/// Half cotangent of the angle opposite to each edge of each face: entry `i` belongs to the edge from corner
/// `i + 1` to corner `i + 2`, opposite to corner `i`.
pub fn half_cotangents(mesh: &TriMesh) -> Vec<[f64; 3]> {
    mesh.faces
        .iter()
        .map(|face| {
            std::array::from_fn(|i| {
                let [p, q, r] = [0, 1, 2].map(|k| mesh.vertices[face[(i + k) % 3]]);
                let (a, b) = (q - p, r - p);
                0.5 * a.dot(&b) / a.cross(&b).norm()
            })
        })
        .collect()
}

/// Angle at each corner of each face, radians.
pub fn corner_angles(mesh: &TriMesh) -> Vec<[f64; 3]> {
    half_cotangents(mesh).into_iter().map(|row| row.map(|half| 1.0_f64.atan2(2.0 * half))).collect()
}
