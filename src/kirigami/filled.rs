//! The open pattern as one surface: pieces and the holes between them.
//!
//! Its vertices are the open hinge points, one per edge of the piece mesh. Every piece is a face, and so is
//! the hole at every inner corner, whose vertices are the hinges of the edges around that corner. It is a
//! disk wherever the sheet is, and it is what "the pattern covers the target" means: holes count as covered.

use super::piece_mesh::PieceMesh;
use crate::geometry::Point3;
use crate::geometry::mesh::PolyMesh;

/// The open pattern with its holes filled: first one face per piece, then one per inner corner in the
/// corners' order; `open` holds the open point of each edge. All faces are counter-clockwise seen from
/// outside.
pub fn filled_surface(mesh: &PieceMesh, open: &[Point3]) -> PolyMesh {
    let holes = mesh.fans.iter().filter(|fan| fan.closed).map(|fan| fan.edges.clone());
    PolyMesh { vertices: open.to_vec(), faces: mesh.owned.iter().cloned().chain(holes).collect() }
}
