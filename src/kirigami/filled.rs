//! The pattern as one surface in each state.
//!
//! Closed, the pieces' cells between corner midpoints tile the sheet. Open, the vertices are the hinge points, one per
//! edge of the piece mesh; every piece is a face, and so is the hole at every inner corner, whose vertices are the hinges
//! of the edges around that corner. Both are disks wherever the sheet is, and they are what "the pattern covers the
//! target" means: slits and holes count as covered.

use super::design::Design;
use super::piece_mesh::PieceMesh;
use crate::geometry::Point3;
use crate::geometry::mesh::PolyMesh;

/// The closed sheet, slits filled: one face per piece. Faces are counter-clockwise seen from outside.
pub fn closed_surface(design: &Design) -> PolyMesh {
    let faces = design.pieces.iter().map(|piece| piece.corners.clone()).collect();
    PolyMesh { vertices: design.corners.clone(), faces }
}

/// The open sheet, holes filled: first one face per piece, then one per inner corner in the corners' order.
pub fn open_surface(mesh: &PieceMesh, design: &Design) -> PolyMesh {
    let mut vertices = vec![Point3::origin(); mesh.edges.len()];
    for (owned, piece) in mesh.owned.iter().zip(&design.pieces) {
        for (&edge, &point) in owned.iter().zip(&piece.open) {
            vertices[edge] = point;
        }
    }
    let holes = mesh.fans.iter().filter(|fan| fan.closed).map(|fan| fan.edges.clone());
    PolyMesh { vertices, faces: mesh.owned.iter().cloned().chain(holes).collect() }
}
