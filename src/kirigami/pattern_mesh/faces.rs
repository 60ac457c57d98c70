//! Faces of the source, checked, and the reading in which each is a piece.

use crate::geometry::mesh::PolyMesh;
use crate::geometry::topology::{self, Defect, check_disk};
use crate::geometry::{Point3, centroid};

use super::PatternMeshError;

/// Pieces over the source's vertices, before any cut.
pub(super) struct Tiling {
    /// The source's vertices around each piece, counter-clockwise.
    pub pieces: Vec<Vec<usize>>,
    /// #pieces: the face or vertex of the source that the piece comes from.
    pub source: Vec<usize>,
    /// What `source` counts: "face", or "the piece at vertex".
    pub what: &'static str,
    /// #pieces, millimetres.
    pub centres: Vec<Point3>,
    /// Vertices of a control mesh that would be centres of pieces too small to be.
    pub dropped: Vec<usize>,
}

impl Tiling {
    /// Whether a vertex of the source is the centre of a piece, or of one that was dropped.
    pub fn is_centre(&self, vertex: usize) -> bool {
        self.dropped.contains(&vertex) || (self.what != FACE && self.source.contains(&vertex))
    }
}

/// What the sources of pieces are where faces are pieces.
const FACE: &str = "face";

/// The mesh with its faces wound alike, and the faces that were turned over for it. A surface with holes passes:
/// cuts may yet open them.
pub(super) fn checked(mesh: &PolyMesh) -> Result<(PolyMesh, Vec<usize>), PatternMeshError> {
    let mut mesh = mesh.clone();
    for (face, vertices) in mesh.faces.iter().enumerate() {
        let mut sorted = vertices.clone();
        sorted.sort_unstable();
        if let Some(pair) = sorted.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(PatternMeshError::RepeatedVertex { face, vertex: pair[0] });
        }
        for (i, &from) in vertices.iter().enumerate() {
            let to = vertices[(i + 1) % vertices.len()];
            if mesh.vertices[from] == mesh.vertices[to] {
                let at = mesh.vertices[from];
                return Err(PatternMeshError::NoLength { face, ends: [from, to], at });
            }
        }
    }
    let turned = topology::orient(&mut mesh.faces);
    match check_disk(&mesh) {
        Err(fault) if !matches!(fault.defect, Defect::Holes { .. }) => Err(PatternMeshError::Mesh(fault)),
        _ => Ok((mesh, turned)),
    }
}

/// Every face a piece.
pub(super) fn pieces(mesh: &PolyMesh) -> Tiling {
    let centre = |face: &Vec<usize>| centroid(&face.iter().map(|&v| mesh.vertices[v]).collect::<Vec<_>>());
    Tiling {
        pieces: mesh.faces.clone(),
        source: (0..mesh.faces.len()).collect(),
        what: FACE,
        centres: mesh.faces.iter().map(centre).collect(),
        dropped: Vec::new(),
    }
}
