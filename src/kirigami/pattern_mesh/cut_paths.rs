//! The user's cuts: polylines of an OBJ file, and the sides between pieces that they run along.
//!
//! Polylines stand either in a file of their own, whose vertices must lie on vertices of the mesh
//! ([`MATCH_TOLERANCE`]), or among the faces of the mesh's own file, whose vertices they then name. Each two vertices
//! that follow each other must be the ends of a side that two pieces share: of an edge of the mesh if its faces are the
//! pieces, of a diagonal between two piece corners of a face in a control mesh. Several polylines may be of one edge
//! each, as some modellers write them.

use std::collections::BTreeSet;

use crate::geometry::Point3;
use crate::geometry::mesh::PolyMesh;
use crate::geometry::read::polylines::Polylines;

use super::faces::Tiling;
use super::{CutError, EdgeSet, sorted};

/// A vertex of a cut file may lie this far from the mesh's vertex that it means, in mean edge lengths of the mesh:
/// far above what rounding in a modeller's files makes, far below the distance of neighbours.
pub const MATCH_TOLERANCE: f64 = 0.01;

/// A cut that the user asks for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CutPath {
    /// Its vertices in the mesh.
    pub vertices: Vec<usize>,
    /// The line of the file that it stands in, counted from 1.
    pub line: usize,
}

/// The cuts that stand in the mesh's own file.
pub fn own_cut_paths(lines: &Polylines) -> Vec<CutPath> {
    lines.lines.iter().map(|line| CutPath { vertices: line.vertices.clone(), line: line.line }).collect()
}

/// The cuts of a file of their own, whose unit is `scale` millimetres. `mesh` is in millimetres; vertices that no
/// face uses do not count.
///
/// # Errors
/// No polyline at all; a vertex that is not at one of the mesh's.
pub fn cut_paths(mesh: &PolyMesh, lines: &Polylines, scale: f64) -> Result<Vec<CutPath>, CutError> {
    if lines.lines.is_empty() {
        return Err(CutError::NoPath);
    }
    let used: BTreeSet<usize> = mesh.faces.iter().flatten().copied().collect();
    let sides =
        || mesh.faces.iter().flat_map(|face| (0..face.len()).map(|i| [face[i], face[(i + 1) % face.len()]]));
    let total: f64 = sides().map(|[a, b]| (mesh.vertices[b] - mesh.vertices[a]).norm()).sum();
    let tolerance = MATCH_TOLERANCE * total / sides().count().max(1) as f64;
    let distance = |v: usize, p: &Point3| (mesh.vertices[v] - p).norm();
    let find = |vertex: usize, line: usize| {
        let at = lines.vertices[vertex] * scale;
        let nearest = used.iter().copied().min_by(|&v, &w| distance(v, &at).total_cmp(&distance(w, &at)));
        match nearest {
            Some(nearest) if distance(nearest, &at) <= tolerance => Ok(nearest),
            _ => {
                let nearest = nearest.unwrap_or_default();
                let distance = distance(nearest, &at);
                Err(CutError::NotAVertex { line, vertex, at, nearest, distance, tolerance })
            }
        }
    };
    lines
        .lines
        .iter()
        .map(|line| {
            let vertices = line.vertices.iter().map(|&v| find(v, line.line)).collect::<Result<_, _>>()?;
            Ok(CutPath { vertices, line: line.line })
        })
        .collect()
}

/// The edges that cuts run along.
pub(super) fn cut_edges(tiling: &Tiling, cuts: &[CutPath]) -> Result<EdgeSet, CutError> {
    let corners: BTreeSet<usize> = tiling.pieces.iter().flatten().copied().collect();
    let sides: BTreeSet<[usize; 2]> = tiling
        .pieces
        .iter()
        .flat_map(|piece| (0..piece.len()).map(|i| [piece[i], piece[(i + 1) % piece.len()]]))
        .collect();
    let mut edges = EdgeSet::new();
    for &CutPath { ref vertices, line } in cuts {
        if vertices.len() < 2 {
            return Err(CutError::TooShort { line });
        }
        if let Some(&vertex) = vertices.iter().find(|vertex| !corners.contains(vertex)) {
            return Err(CutError::NotACorner { line, vertex, centre: tiling.is_centre(vertex) });
        }
        let mut own = EdgeSet::new();
        for pair in vertices.windows(2) {
            let ends @ [a, b] = [pair[0], pair[1]];
            if a == b {
                return Err(CutError::StandsStill { line, vertex: a });
            }
            if !own.insert(sorted(ends)) {
                return Err(CutError::Twice { line, ends });
            }
            match [[a, b], [b, a]].iter().filter(|side| sides.contains(*side)).count() {
                0 => return Err(CutError::NotAnEdge { line, ends }),
                1 => return Err(CutError::Border { line, ends }),
                _ => {}
            }
        }
        edges.extend(own);
    }
    Ok(edges)
}
