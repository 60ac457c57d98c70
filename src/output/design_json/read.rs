//! Reading `design.json` back.

use std::fmt;
use std::fs::{self, File};
use std::io::{self, Read};
use std::marker::PhantomData;
use std::path::{Path, PathBuf};

use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserialize, Deserializer, IgnoredAny, MapAccess, Visitor};
use serde_json::Value;
use serde_json::error::Category;

use super::invariants::{InvalidDesign, check};
use super::{UNITS, VERSION, pattern_name, state_name};
use crate::geometry::{Point3, Vector3};
use crate::kirigami::design::{Design, Hinge, PatternKind, Piece, State};

/// Largest design file that is read, bytes. A million pieces, the most that the program designs, take half of it.
pub const MAX_FILE_BYTES: u64 = 2 << 30;

/// Why a design file was not read.
#[derive(Debug, thiserror::Error)]
pub enum ReadDesignError {
    /// A folder or a device stands where the file should be.
    #[error("{} is {what}, not a design file", .path.display())]
    NotAFile {
        /// The file.
        path: PathBuf,
        /// What it is instead.
        what: &'static str,
    },
    /// The file is larger than [`MAX_FILE_BYTES`].
    #[error("{} has more than the limit of {MAX_FILE_BYTES} bytes", .path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
    },
    /// The operating system refused.
    #[error("{} cannot be read: {source}", .path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// The content is not a design that can be used.
    #[error("{}: {source}", .path.display())]
    Invalid {
        /// The file.
        path: PathBuf,
        /// Place and reason.
        source: InvalidDesignFile,
    },
}

/// Why the content of a file is no design.
#[derive(Debug, thiserror::Error)]
pub enum InvalidDesignFile {
    /// No bytes, or only white space.
    #[error("the file is empty: write it again with `kirimorph make`")]
    Empty,
    /// The text ends inside of a value.
    #[error("the file ends early, at line {line}, column {column}: it is truncated, write it again")]
    Truncated {
        /// Line of the end, from 1.
        line: usize,
        /// Column of the end, from 1.
        column: usize,
    },
    /// Not JSON, or another structure than the format's. The text names line and column.
    #[error("{0} (the format is described in docs/design.schema.json)")]
    Json(serde_json::Error),
    /// There is no version key.
    #[error("the file has no \"version\": it is not a design.json of kirimorph")]
    NoVersion,
    /// A version that this program does not know.
    #[error(
        "the file is version {found} of the design format, this program reads version {VERSION}: use the kirimorph that wrote it"
    )]
    Version {
        /// The version as written, shortened.
        found: String,
    },
    /// Another unit.
    #[error("the units are \"{found}\"; a design holds \"{UNITS}\"")]
    Units {
        /// The units as written, shortened.
        found: String,
    },
    /// A pattern that this program does not know.
    #[error(
        "the pattern \"{found}\" is not known to this version, which reads \"rotating-rectangles\", \"bistable\" and \
         \"imported\""
    )]
    Pattern {
        /// The pattern as written, shortened.
        found: String,
    },
    /// A state that does not exist.
    #[error("the sheet state \"{found}\" does not exist; it is \"closed\", \"open\" or null")]
    SheetState {
        /// The state as written, shortened.
        found: String,
    },
    /// A file with pieces alone, as other programs may write it.
    #[error(
        "the file holds no sheet corners (no {missing}), from which slits are laid out: this version reads designs that \
         kirimorph itself has written"
    )]
    NoCorners {
        /// What is missing.
        missing: String,
    },
    /// The values contradict each other.
    #[error(transparent)]
    Design(#[from] InvalidDesign),
}

/// Reads the design in the file at `path`.
///
/// # Errors
/// See [`ReadDesignError`]; every message names the file.
pub fn read(path: &Path) -> Result<Design, ReadDesignError> {
    parse(&read_bytes(path)?).map_err(|source| ReadDesignError::Invalid { path: path.into(), source })
}

/// Reads the content of a design file, of at most [`MAX_FILE_BYTES`].
///
/// # Errors
/// The file cannot be read, or is no file.
pub fn read_bytes(path: &Path) -> Result<Vec<u8>, ReadDesignError> {
    let io = |source| ReadDesignError::Io { path: path.into(), source };
    let metadata = fs::metadata(path).map_err(io)?;
    if !metadata.is_file() {
        let what = if metadata.is_dir() { "a folder" } else { "a device or pipe" };
        return Err(ReadDesignError::NotAFile { path: path.into(), what });
    }
    let mut bytes = Vec::new();
    // One byte more than the limit tells whether the file is larger.
    File::open(path).map_err(io)?.take(MAX_FILE_BYTES + 1).read_to_end(&mut bytes).map_err(io)?;
    if bytes.len() as u64 > MAX_FILE_BYTES {
        return Err(ReadDesignError::TooLarge { path: path.into() });
    }
    Ok(bytes)
}

/// Reads a design from the content of a file. The report inside is not looked at.
///
/// # Errors
/// Says what is wrong with the content and where.
pub fn parse(bytes: &[u8]) -> Result<Design, InvalidDesignFile> {
    if bytes.trim_ascii().is_empty() {
        return Err(InvalidDesignFile::Empty);
    }
    // The version first: another version's keys are no errors of this one's.
    let Object(head) =
        serde_json::from_slice::<Object<Head>>(bytes).map_err(|error| json_error(error, bytes))?;
    match head.version {
        None => return Err(InvalidDesignFile::NoVersion),
        Some(version) if version.as_u64() != Some(VERSION) => {
            return Err(InvalidDesignFile::Version { found: shortened(&version.to_string()) });
        }
        Some(_) => {}
    }
    let Object(file) =
        serde_json::from_slice::<Object<FileText>>(bytes).map_err(|error| json_error(error, bytes))?;
    let design = file.design()?;
    check(&design)?;
    Ok(design)
}

fn json_error(error: serde_json::Error, bytes: &[u8]) -> InvalidDesignFile {
    // A number cut off behind its sign or point counts as a wrong one, not as an early end.
    let cut_number = error.line() == bytes.split(|&byte| byte == b'\n').count()
        && matches!(bytes.last(), Some(b'-' | b'+' | b'.' | b'e' | b'E'));
    match error.classify() {
        Category::Syntax if !cut_number => InvalidDesignFile::Json(error),
        Category::Eof | Category::Syntax => {
            InvalidDesignFile::Truncated { line: error.line(), column: error.column() }
        }
        _ => InvalidDesignFile::Json(error),
    }
}

/// The beginning of a value of the file, for messages.
fn shortened(text: &str) -> String {
    const LONGEST: usize = 40;
    let plain: String = text.chars().take(LONGEST).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if text.chars().nth(LONGEST).is_some() { plain + "..." } else { plain }
}

/// A JSON object: serde alone would take an array of the values for a structure, too.
struct Object<T>(T);

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Object<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ObjectVisitor<T>(PhantomData<T>);
        impl<'de, T: Deserialize<'de>> Visitor<'de> for ObjectVisitor<T> {
            type Value = Object<T>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an object")
            }
            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Object<T>, A::Error> {
                T::deserialize(MapAccessDeserializer::new(map)).map(Object)
            }
        }
        deserializer.deserialize_map(ObjectVisitor(PhantomData))
    }
}

#[derive(serde::Deserialize)]
struct Head {
    version: Option<Value>,
}

/// The file's keys. What other programs may leave out is optional here and refused in words of its own.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct FileText {
    #[serde(rename = "version")]
    _version: IgnoredAny,
    units: String,
    pattern: String,
    // Without a function of its own serde would take an absent key for null.
    #[serde(deserialize_with = "Option::deserialize")]
    sheet_state: Option<String>,
    gap_mm: Option<f64>,
    corners: Option<Vec<[f64; 3]>>,
    pieces: Vec<Object<PieceText>>,
    hinges: Vec<Object<HingeText>>,
    #[serde(rename = "report")]
    _report: Object<IgnoredAny>,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct PieceText {
    corners: Option<Vec<usize>>,
    closed: Vec<[f64; 3]>,
    open: Vec<[f64; 3]>,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct HingeText {
    pieces: [usize; 2],
    vertices: [usize; 2],
    point: [f64; 3],
    axis: [f64; 3],
    angle_deg: f64,
}

impl FileText {
    fn design(self) -> Result<Design, InvalidDesignFile> {
        if self.units != UNITS {
            return Err(InvalidDesignFile::Units { found: shortened(&self.units) });
        }
        let kinds = [PatternKind::RotatingRectangles, PatternKind::Bistable, PatternKind::Imported];
        let Some(pattern) = kinds.into_iter().find(|&kind| pattern_name(kind) == self.pattern) else {
            return Err(InvalidDesignFile::Pattern { found: shortened(&self.pattern) });
        };
        let sheet_state = match self.sheet_state {
            None => None,
            Some(name) => {
                match [State::Closed, State::Open].into_iter().find(|&state| state_name(state) == name) {
                    Some(state) => Some(state),
                    None => return Err(InvalidDesignFile::SheetState { found: shortened(&name) }),
                }
            }
        };
        let no_corners = |missing: &str| InvalidDesignFile::NoCorners { missing: missing.into() };
        let gap = self.gap_mm.ok_or_else(|| no_corners("\"gap_mm\""))?;
        let corners = self.corners.ok_or_else(|| no_corners("\"corners\""))?;
        let piece = |(id, Object(text)): (usize, Object<PieceText>)| {
            let corners = text.corners.ok_or_else(|| no_corners(&format!("\"corners\" in piece {id}")))?;
            Ok(Piece { corners, closed: points(text.closed), open: points(text.open) })
        };
        let hinge = |Object(text): Object<HingeText>| Hinge {
            pieces: text.pieces,
            vertices: text.vertices,
            point: Point3::from(text.point),
            axis: Vector3::from(text.axis),
            angle: text.angle_deg.to_radians(),
        };
        Ok(Design {
            pattern,
            sheet_state,
            gap,
            corners: points(corners),
            pieces: self
                .pieces
                .into_iter()
                .enumerate()
                .map(piece)
                .collect::<Result<_, InvalidDesignFile>>()?,
            hinges: self.hinges.into_iter().map(hinge).collect(),
        })
    }
}

fn points(rows: Vec<[f64; 3]>) -> Vec<Point3> {
    rows.into_iter().map(Point3::from).collect()
}
