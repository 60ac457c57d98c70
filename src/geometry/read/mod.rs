//! Reading target meshes: OBJ, STL and PLY.
//!
//! Readers take bytes and give a [`PolyMesh`] whose indices are in range, whose faces have three or more
//! different vertices, and whose coordinates are finite. Whether it is a surface that can be used is the matter
//! of [`super::topology`]. Memory stays proportional to the file's size, whatever counts the file states.

use std::fs::{self, File};
use std::io::Read;
use std::path::Path;

use super::mesh::PolyMesh;

mod error;
pub mod obj;
pub mod ply;
pub mod polylines;
pub mod stl;
pub(crate) mod text;

pub use error::{InvalidMeshFile, MAX_COORDINATE, MAX_FILE_BYTES, Place, Problem, ReadMeshError};

/// The mesh formats that are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MeshFormat {
    /// Wavefront OBJ.
    Obj,
    /// STL, binary or ASCII.
    Stl,
    /// Stanford PLY, binary or ASCII.
    Ply,
}

impl MeshFormat {
    /// The format that the ending of a file name stands for, in upper or lower case.
    pub fn from_path(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "obj" => Some(Self::Obj),
            "stl" => Some(Self::Stl),
            "ply" => Some(Self::Ply),
            _ => None,
        }
    }
}

/// Reads the mesh file at `path`; the ending of its name tells the format. Coordinates stay in the file's units.
///
/// # Errors
/// See [`ReadMeshError`]; every message names the file.
pub fn read_mesh(path: &Path) -> Result<PolyMesh, ReadMeshError> {
    require_regular_file(path)?;
    let format =
        MeshFormat::from_path(path).ok_or_else(|| ReadMeshError::UnknownFormat { path: path.into() })?;
    let bytes = read_file(path)?;
    parse_mesh(&bytes, format).map_err(|invalid| ReadMeshError::Invalid { path: path.into(), invalid })
}

/// Reads a mesh from the content of a file.
///
/// # Errors
/// Says what is wrong with the content and where.
pub fn parse_mesh(bytes: &[u8], format: MeshFormat) -> Result<PolyMesh, InvalidMeshFile> {
    if bytes.trim_ascii().is_empty() {
        return Err(Place::File.error(Problem::Empty));
    }
    match format {
        MeshFormat::Obj => obj::parse(bytes),
        MeshFormat::Stl => stl::parse(bytes),
        MeshFormat::Ply => ply::parse(bytes),
    }
}

/// Refuses folders, pipes and devices, which may never end.
fn require_regular_file(path: &Path) -> Result<(), ReadMeshError> {
    let metadata = fs::metadata(path).map_err(|source| ReadMeshError::Io { path: path.into(), source })?;
    if metadata.is_file() {
        return Ok(());
    }
    let what = if metadata.is_dir() { "a folder" } else { "a device or pipe" };
    Err(ReadMeshError::NotAFile { path: path.into(), what })
}

/// The content of a file of at most [`MAX_FILE_BYTES`].
pub(crate) fn read_file(path: &Path) -> Result<Vec<u8>, ReadMeshError> {
    require_regular_file(path)?;
    let io = |source| ReadMeshError::Io { path: path.into(), source };
    let mut bytes = Vec::new();
    // One byte more than the limit tells whether the file is larger.
    File::open(path).map_err(io)?.take(MAX_FILE_BYTES + 1).read_to_end(&mut bytes).map_err(io)?;
    if bytes.len() as u64 > MAX_FILE_BYTES {
        return Err(ReadMeshError::TooLarge { path: path.into() });
    }
    Ok(bytes)
}
