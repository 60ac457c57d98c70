//! Pieces in two states, as a file gives them.

use std::path::Path;

use super::error::ImportError;
use crate::geometry::Point3;
use crate::geometry::mesh::PolyMesh;
use crate::geometry::read::{ReadMeshError, read_mesh};

/// Two corners that a file says are one hinge.
#[derive(Debug, Clone, PartialEq)]
pub struct Constraint {
    /// The two pieces.
    pub pieces: [usize; 2],
    /// The corner of each.
    pub corners: [usize; 2],
    /// Where it stands, for messages.
    pub place: String,
}

/// Pieces in two states, in the source's units.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Source {
    /// The corners of each piece, closed.
    pub closed: Vec<Vec<Point3>>,
    /// The same corners, open; lists of the same lengths.
    pub open: Vec<Vec<Point3>>,
    /// The hinges, where the source names them.
    pub constraints: Option<Vec<Constraint>>,
}

/// Reads a pair of meshes (OBJ or PLY) that hold the same faces in the same order.
///
/// # Errors
/// A file that cannot be read, or the first face that differs.
pub fn read_mesh_pair(closed_path: &Path, open_path: &Path) -> Result<Source, ImportError> {
    let (closed, open) = (read_faces(closed_path)?, read_faces(open_path)?);
    let paths = || (closed_path.to_owned(), open_path.to_owned());
    if closed.faces.len() != open.faces.len() {
        let ((closed_path, open_path), [closed, open]) = (paths(), [closed, open].map(|m| m.faces.len()));
        return Err(ImportError::FaceCount { closed_path, open_path, closed, open });
    }
    let lengths = closed.faces.iter().zip(&open.faces).map(|(a, b)| (a.len(), b.len()));
    if let Some((face, (closed, open))) = lengths.enumerate().find(|(_, (a, b))| a != b) {
        let (closed_path, open_path) = paths();
        return Err(ImportError::CornerCount { closed_path, open_path, face: face + 1, closed, open });
    }
    Ok(Source { closed: polygons(&closed), open: polygons(&open), constraints: None })
}

fn read_faces(path: &Path) -> Result<PolyMesh, ImportError> {
    if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("stl")) {
        // Its triangles are no pieces, and readers merge its points.
        return Err(ReadMeshError::UnknownFormat { path: path.to_owned() }.into());
    }
    Ok(read_mesh(path)?)
}

fn polygons(mesh: &PolyMesh) -> Vec<Vec<Point3>> {
    mesh.faces.iter().map(|face| face.iter().map(|&v| mesh.vertices[v]).collect()).collect()
}
