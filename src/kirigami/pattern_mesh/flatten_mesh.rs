//! The surface that Stage 1 flattens: the pieces, opened along the cuts that reach the border.

use std::collections::BTreeSet;

use crate::geometry::Point3;
use crate::geometry::mesh::TriMesh;
use crate::geometry::topology::{self, NotADisk};
use crate::geometry::union_find::UnionFind;

use super::faces::Tiling;
use super::sheet::Sheet;
use super::{EdgeSet, PatternMeshError};

/// A disk of triangles: each piece a fan around its centre.
#[derive(Debug, Clone, PartialEq)]
pub struct FlattenMesh {
    /// The triangles, millimetres. Corners first, then centres; those of a piece follow each other in the order of its
    /// sides.
    pub mesh: TriMesh,
    /// #corners of the pattern: the vertex at each. Two corners share one along cuts with both ends inside.
    pub corner_vertex: Vec<usize>,
    /// #pieces: the vertex at each piece's centre.
    pub centre_vertex: Vec<usize>,
    /// #F: the piece that each triangle belongs to.
    pub piece_of: Vec<usize>,
    /// The boundary loop, the surface on the left, beginning with the least vertex.
    pub boundary: Vec<usize>,
}

impl FlattenMesh {
    pub(super) fn new(
        tiling: &Tiling,
        sheet: &Sheet,
        cut: &EdgeSet,
        vertices: &[Point3],
    ) -> Result<Self, PatternMeshError> {
        let opened = Sheet::new(tiling, &reaching_the_border(tiling, cut, vertices.len()))?;
        let disk = topology::disk(&opened.pieces).map_err(|defect| {
            // Only holes of the mesh itself that no cut opens.
            PatternMeshError::Mesh(NotADisk { defect, at: None })
        })?;
        let corner_count = opened.source_vertex.len();
        let mut corner_vertex = vec![0; sheet.source_vertex.len()];
        for (corners, opened) in sheet.pieces.iter().zip(&opened.pieces) {
            corners.iter().zip(opened).for_each(|(&corner, &vertex)| corner_vertex[corner] = vertex);
        }
        let mut faces = Vec::new();
        let mut piece_of = Vec::new();
        for (piece, corners) in opened.pieces.iter().enumerate() {
            let n = corners.len();
            faces.extend((0..n).map(|i| [corners[i], corners[(i + 1) % n], corner_count + piece]));
            piece_of.extend(std::iter::repeat_n(piece, n));
        }
        let points = opened.source_vertex.iter().map(|&v| vertices[v]);
        Ok(Self {
            mesh: TriMesh { vertices: points.chain(tiling.centres.iter().copied()).collect(), faces },
            corner_vertex,
            centre_vertex: (corner_count..corner_count + opened.pieces.len()).collect(),
            piece_of,
            boundary: disk.boundary,
        })
    }
}

/// The cut edges that hang together with the border.
fn reaching_the_border(tiling: &Tiling, cut: &EdgeSet, vertex_count: usize) -> EdgeSet {
    let sides = |piece: &Vec<usize>| -> Vec<[usize; 2]> {
        (0..piece.len()).map(|i| [piece[i], piece[(i + 1) % piece.len()]]).collect()
    };
    let all: BTreeSet<[usize; 2]> = tiling.pieces.iter().flat_map(sides).collect();
    // One more element stands for the border.
    let mut joined = UnionFind::new(vertex_count + 1);
    for &[a, b] in all.iter().filter(|[a, b]| !all.contains(&[*b, *a])) {
        joined.join(a, vertex_count);
        joined.join(b, vertex_count);
    }
    cut.iter().for_each(|&[a, b]| joined.join(a, b));
    cut.iter().copied().filter(|&[a, _]| joined.same(a, vertex_count)).collect()
}
