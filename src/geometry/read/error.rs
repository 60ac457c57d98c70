//! What can be wrong with a mesh file, and where.

use std::fmt;
use std::path::PathBuf;

/// Largest absolute coordinate that is accepted, in the file's units. Beyond it `f64` no longer resolves the
/// thousandths of a millimetre that the later stages work with.
pub const MAX_COORDINATE: f64 = 1e9;

/// Largest mesh file that is read, bytes. It bounds the memory that a wrong file can take; a mesh of several
/// million faces still fits.
pub const MAX_FILE_BYTES: u64 = 256 << 20;

/// Why a mesh file was not read.
#[derive(Debug, thiserror::Error)]
pub enum ReadMeshError {
    /// The file name's ending names no format that is read.
    #[error("{}: the ending is none of .obj, .stl, .ply: export the mesh in one of these formats", .path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// A folder or a device stands where the file should be.
    #[error("{}: is {what}, not a mesh file", .path.display())]
    NotAFile {
        /// The file.
        path: PathBuf,
        /// What it is instead.
        what: &'static str,
    },
    /// The file is larger than [`MAX_FILE_BYTES`].
    #[error("{}: has more than the limit of {MAX_FILE_BYTES} bytes: reduce the mesh", .path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
    },
    /// The operating system refused.
    #[error("{}: cannot be read: {source}", .path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The content is not a mesh that can be used.
    #[error("{}: {invalid}", .path.display())]
    Invalid {
        /// The file.
        path: PathBuf,
        /// Place and reason.
        invalid: InvalidMeshFile,
    },
}

/// A fault in the content of a mesh file.
#[derive(Debug, Clone, PartialEq)]
pub struct InvalidMeshFile {
    /// Where it is.
    pub place: Place,
    /// What it is.
    pub problem: Problem,
}

impl fmt::Display for InvalidMeshFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.place {
            Place::File => write!(f, "{}", self.problem),
            place => write!(f, "{place}: {}", self.problem),
        }
    }
}

impl std::error::Error for InvalidMeshFile {}

/// A place in a mesh file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Place {
    /// The file as a whole.
    File,
    /// A line of a text file, counted from 1.
    Line(usize),
    /// A triangle of a binary STL file, counted from 1.
    Triangle(usize),
    /// A record of a binary PLY file, counted from 0 as the format does.
    Record {
        /// Name of the PLY element.
        element: String,
        /// Number of the record.
        index: u64,
    },
}

impl Place {
    /// The fault `problem` at this place.
    pub(super) fn error(&self, problem: Problem) -> InvalidMeshFile {
        InvalidMeshFile { place: self.clone(), problem }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::File => write!(f, "file"),
            Place::Line(line) => write!(f, "line {line}"),
            Place::Triangle(triangle) => write!(f, "triangle {triangle}"),
            Place::Record { element, index } => write!(f, "{element} {index} (counted from 0)"),
        }
    }
}

/// What is wrong in a mesh file. Indices are written as the file counts them.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Problem {
    /// No bytes, or only white space.
    #[error("the file is empty: export the mesh again")]
    Empty,
    /// A token that should be a number.
    #[error("`{token}` is not a number (decimals take a point, not a comma)")]
    NotANumber {
        /// The token, shortened.
        token: String,
    },
    /// NaN or infinity.
    #[error("the coordinate `{token}` is not finite: repair the mesh before exporting it")]
    NotFinite {
        /// The token or value.
        token: String,
    },
    /// A coordinate beyond [`MAX_COORDINATE`].
    #[error(
        "the coordinate {value:e} is beyond the limit of {MAX_COORDINATE:e}: move the mesh to the origin"
    )]
    TooFar {
        /// The coordinate.
        value: f64,
    },
    /// A vertex with too few or too many numbers.
    #[error("a vertex has three coordinates, this one has {found} numbers")]
    CoordinateCount {
        /// Count of numbers.
        found: usize,
    },
    /// A token that should be the index of a vertex.
    #[error("`{token}` is not the index of a vertex")]
    NotAnIndex {
        /// The token, shortened.
        token: String,
    },
    /// A face or polyline names a vertex that the file does not have.
    #[error("vertex {index} is named, but the vertices run from {first} to {last}")]
    IndexOutOfRange {
        /// The index as written.
        index: i64,
        /// First index in use by the format.
        first: i64,
        /// Last index in use; less than `first` if there are no vertices.
        last: i64,
    },
    /// An OBJ face counts back further than there are vertices.
    #[error("the face counts back to vertex {index}, but only {preceding} vertices precede it")]
    BeforeFirst {
        /// The negative index as written.
        index: i64,
        /// Number of vertices before the face.
        preceding: usize,
    },
    /// Fewer than three corners.
    #[error("the face has {corners} corners, it needs at least 3")]
    FaceTooSmall {
        /// Count of corners.
        corners: usize,
    },
    /// A face that passes the same vertex twice.
    #[error("the face names vertex {vertex} twice: remove degenerate faces in the modeller")]
    RepeatedVertex {
        /// The vertex as the file counts it.
        vertex: usize,
    },
    /// An OBJ polyline of fewer than two vertices.
    #[error("the polyline has {vertices} vertex, it needs at least 2")]
    LineTooShort {
        /// Count of vertices.
        vertices: usize,
    },
    /// No vertices at all.
    #[error("the file has no vertices: is it a mesh?")]
    NoVertices,
    /// Vertices, but no faces.
    #[error("the file has no faces: export a polygon mesh, not points, curves, strips or NURBS")]
    NoFaces,
    /// Something else stands where the format asks for `expected`.
    #[error("expected {expected}, found `{found}`")]
    Unexpected {
        /// What the format asks for.
        expected: String,
        /// What stands there, shortened.
        found: String,
    },
    /// The file ends early.
    #[error("the file ends where {expected} should follow: it is truncated, export it again")]
    Truncated {
        /// What is missing.
        expected: String,
    },
    /// Fewer bytes than the stated count of records needs.
    #[error("the file states {count} {what} but ends too early for them: it is truncated or damaged")]
    CountTooLarge {
        /// The stated count.
        count: u64,
        /// Records of what.
        what: String,
    },
    /// More bytes than the stated counts need.
    #[error(
        "{bytes} bytes follow after the last of the stated {what}: the count is wrong or the file damaged"
    )]
    TrailingBytes {
        /// Count of surplus bytes.
        bytes: usize,
        /// Records of what.
        what: &'static str,
    },
}
