//! The combinatorics of a pattern from a quad or polygon mesh that the user made (Fig. 12), with its cuts.
//!
//! ```text
//! PolyMesh (mm) ──control | faces──> pieces over the file's vertices
//!   ──cuts──> corners doubled along cuts ──alternation──> odd corners and holes, proposed cuts
//!   ──> PatternMesh: PieceMesh with senses and directions, and the surface to flatten
//! ```
//!
//! Two readings ([`Reading`]): every face a piece; or the paper's control mesh, in which every face is an edge
//! between two pieces and every second vertex a piece.
//!
//! # Cuts
//! A cut runs along sides that two pieces share, and takes their hinges away. Corners are doubled along it, so
//! that each corner of the result has one fan of pieces; where a cut ends inside the sheet its end stays one corner,
//! at the border now. A cut that reaches the border, or another cut that does, leaves the sheet a disk. A cut with
//! both ends inside makes a hole: [`PatternMesh::mesh`] has it, and hinges are absent along it, but
//! [`FlattenMesh`] does not, since a flattening needs a disk. A cut that leaves the sheet in two is refused.
//!
//! # Alternation
//! Neighbours turn in opposite senses, so the number of pieces around every inner corner and around every hole
//! must be even. Where it is not, a cut mends it; see [`proposal`].
//!
//! Vertices, faces and pieces count from 0 here and from 1 in messages, as in OBJ files.

use std::collections::{BTreeMap, BTreeSet};

use crate::geometry::Point3;
use crate::geometry::mesh::PolyMesh;

use super::piece_mesh::PieceMesh;

mod alternation;
mod control;
mod cut_paths;
mod directions;
mod error;
mod faces;
mod flatten_mesh;
mod matching;
pub mod proposal;
mod sheet;

pub use alternation::{Alternation, Odd, OddPlace};
pub use cut_paths::{CutPath, MATCH_TOLERANCE, cut_paths, own_cut_paths};
pub use error::{CutError, PatternMeshError};
pub use flatten_mesh::FlattenMesh;

use faces::Tiling;
use sheet::{Sheet, border_loops};

/// What the mesh's faces stand for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reading {
    /// Every face is a piece.
    Pieces,
    /// Every face is a quad with two opposite corners in piece centres and two in piece corners, and stands for the
    /// edge between two pieces.
    ControlMesh {
        /// A vertex that is to be the centre of a piece; `None` for the choice with fewer odd corners, then the
        /// one with more pieces, then the one with the first vertex in a centre.
        pieces_at: Option<usize>,
    },
}

/// What to do where neighbours cannot turn in opposite senses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CutRequest {
    /// Make the given cuts alone, and refuse.
    AsGiven,
    /// Make the shortest cuts too that mend it. They may have both ends inside.
    Automatic,
    /// Make such cuts that reach the border: somewhat longer ones, and the sheet stays a disk if the given cuts leave
    /// it one.
    AutomaticToBorder,
}

/// A pattern's combinatorics, and what of the source each part comes from.
#[derive(Debug, Clone)]
pub struct PatternMesh {
    /// Pieces, edges and fans of the cut sheet. The first piece turns counter-clockwise.
    pub mesh: PieceMesh,
    /// #corners: where the source has each corner, millimetres.
    pub corners: Vec<Point3>,
    /// #pieces: the centre of each piece, millimetres: the control mesh's vertex where pieces surround it, else the
    /// mean of the corners.
    pub centres: Vec<Point3>,
    /// #corners: the source's vertex at each corner.
    pub source_vertex: Vec<usize>,
    /// #pieces: the source's face, or in a control mesh the vertex, that each piece comes from.
    pub source_piece: Vec<usize>,
    /// The border, the sheet on the left, in corners: the longest loop first, then the holes.
    pub loops: Vec<Vec<usize>>,
    /// Whether every quad's sides have directions 0, 1, 0, 1 and directions go straight on through inner corners of
    /// four pieces. Otherwise directions are of no use, and pieces cannot have unequal sides.
    pub directions_agree: bool,
    /// Where neighbours could not alternate, and the cuts that were made for it; both empty where they could.
    pub mended: Alternation,
    /// Vertices of a control mesh that are piece centres but have too few neighbours there to be a piece.
    pub dropped: Vec<usize>,
    /// Faces that were wound against the others, and were turned over.
    pub turned_faces: Vec<usize>,
    /// The surface that Stage 1 flattens.
    pub flatten: FlattenMesh,
}

/// Fewest pieces that are a pattern: 2 x 2.
pub const LEAST_PIECES: usize = 4;

/// Reads a pattern from a mesh, coordinates in millimetres. The normals of most faces tell its upper side.
///
/// # Errors
/// A mesh that is no disk or does not suit the reading, cuts that do not run between pieces or leave the sheet in
/// two, neighbours that cannot alternate.
pub fn pattern_mesh(
    mesh: &PolyMesh,
    reading: Reading,
    cuts: &[CutPath],
    request: CutRequest,
) -> Result<PatternMesh, PatternMeshError> {
    let (mesh, turned_faces) = faces::checked(mesh)?;
    let tiling = match reading {
        Reading::Pieces => faces::pieces(&mesh),
        Reading::ControlMesh { pieces_at } => control::pieces(&mesh, pieces_at, cuts)?,
    };
    if tiling.pieces.len() < LEAST_PIECES {
        return Err(PatternMeshError::TooFew { pieces: tiling.pieces.len() });
    }
    let mut cut = cut_paths::cut_edges(&tiling, cuts)?;
    let mut sheet = Sheet::new(&tiling, &cut)?;
    let mut mended = alternation::alternation(&sheet, &mesh.vertices, request);
    if !mended.odd.is_empty() {
        if request == CutRequest::AsGiven {
            return Err(PatternMeshError::Alternation(Box::new(mended)));
        }
        cut.extend(mended.edges());
        sheet = Sheet::new(&tiling, &cut)?;
    }
    let Some(senses) = alternation::senses(&sheet.mesh) else {
        mended = alternation::alternation(&sheet, &mesh.vertices, request);
        return Err(PatternMeshError::Alternation(Box::new(mended)));
    };
    check_single_joints(&sheet, &tiling)?;
    let flatten = FlattenMesh::new(&tiling, &sheet, &cut, &mesh.vertices)?;
    let Sheet { pieces, source_vertex, apart, .. } = sheet;
    let mut pieces = PieceMesh::from_polygons(source_vertex.len(), pieces, senses, &apart);
    let directions_agree = directions::assign(&mut pieces);
    let corners: Vec<Point3> = source_vertex.iter().map(|&v| mesh.vertices[v]).collect();
    let loops = border_loops(&pieces, &corners);
    let Tiling { centres, source: source_piece, dropped, .. } = tiling;
    Ok(PatternMesh {
        mesh: pieces,
        corners,
        centres,
        source_vertex,
        source_piece,
        loops,
        directions_agree,
        mended,
        dropped,
        turned_faces,
        flatten,
    })
}

/// Two pieces that share two sides would be hinged in two points and could not turn.
fn check_single_joints(sheet: &Sheet, tiling: &Tiling) -> Result<(), PatternMeshError> {
    let mut joints: BTreeMap<[usize; 2], [usize; 2]> = BTreeMap::new();
    for edge in &sheet.mesh.edges {
        let Some(neighbour) = edge.neighbour else { continue };
        let pair = [edge.piece.min(neighbour), edge.piece.max(neighbour)];
        let ends = edge.corners.map(|c| sheet.source_vertex[c]);
        if let Some(first) = joints.insert(pair, ends) {
            let pieces = pair.map(|piece| tiling.source[piece]);
            return Err(PatternMeshError::SharedTwice { what: tiling.what, pieces, sides: [first, ends] });
        }
    }
    Ok(())
}

/// A mesh edge, the lesser vertex first.
fn sorted([a, b]: [usize; 2]) -> [usize; 2] {
    [a.min(b), a.max(b)]
}

/// Edges of the source, each with the lesser vertex first.
type EdgeSet = BTreeSet<[usize; 2]>;

#[cfg(test)]
mod tests;
