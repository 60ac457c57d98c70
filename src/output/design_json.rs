//! `design.json`, version 1: a design with all that fabrication needs, and the report of how it came about.
//!
//! Millimetres and unit vectors; one corner, piece, hinge and iteration per line; indices count from 0. The format is
//! described in `docs/design.schema.json`. Coordinates are written with as many digits as read back exactly; angles are
//! degrees in the file and radians inside, equal to a unit or two in the last place. The same values give the same
//! bytes: no dates, no seconds, no folders. What [`write()`] accepts, [`read()`] gives back; both refuse a design that
//! breaks an invariant of [`InvalidDesign`].

mod invariants;
mod read;
mod read_report;
mod report;

use std::collections::BTreeMap;
use std::io::{self, BufWriter, Write};

use serde::Serialize;

use super::json_rows::write_rows;
use crate::geometry::Point3;
use crate::kirigami::design::{Design, Hinge, PatternKind, Piece, State};
use crate::kirigami::quality::Quality;
use crate::solver::Report;

pub use invariants::{InvalidDesign, MAX_COORDINATE, SAME_POINT, UNIT_LENGTH, check};
pub use read::{InvalidDesignFile, MAX_FILE_BYTES, ReadDesignError, parse, read, read_bytes};
pub use read_report::{Origin, parse_report};
pub use report::{figures, fit_object};

/// The version of the format that is written and read.
pub const VERSION: u64 = 1;

const UNITS: &str = "mm";

/// Everything that goes into the file.
#[derive(Debug, Clone, Copy)]
pub struct DesignFile<'a> {
    /// The design; with hinges and pieces in the coordinates that are cut.
    pub design: &'a Design,
    /// What was reached.
    pub quality: &'a Quality,
    /// What the solver did, stage by stage.
    pub stages: &'a [Stage],
    /// Largest nominal strain of all hinges, dimensionless; `None` where no profile was applied.
    pub max_strain: Option<f64>,
    /// Where the design comes from.
    pub provenance: Provenance<'a>,
}

/// One stage of the optimisation.
#[derive(Debug, Clone)]
pub struct Stage {
    /// "stage-1", "stage-2" or "stage-3".
    pub name: &'static str,
    /// One report per phase, in order; empty where the stage keeps no record.
    pub reports: Vec<Report>,
}

/// Where a design comes from.
#[derive(Debug, Clone, Copy)]
pub struct Provenance<'a> {
    /// Name or path of the job; only the last part of a path is written.
    pub job: &'a str,
    /// Name or path of the target; likewise.
    pub target: &'a str,
    /// Hashes of input files by name, as text; may be empty.
    pub hashes: &'a BTreeMap<String, String>,
}

/// Why no design file was written.
#[derive(Debug, thiserror::Error)]
pub enum WriteDesignError {
    /// The design contradicts itself.
    #[error("cannot write the design: {0}")]
    Design(#[from] InvalidDesign),
    /// A figure or energy is NaN or infinite.
    #[error("cannot write the design: {place} is {value}, not a finite number")]
    NotFinite {
        /// Key in the file, or stage, iteration and term.
        place: String,
        /// Its value.
        value: f64,
    },
    /// The output refused the bytes.
    #[error("cannot write the design: {0}")]
    Io(#[from] io::Error),
}

/// Writes a design file.
///
/// # Errors
/// A design that is invalid or a number that is not finite, before anything is written, or the error of `out`.
pub fn write<W: Write>(file: &DesignFile, out: W) -> Result<(), WriteDesignError> {
    let design = file.design;
    check(design)?;
    report::check(file)?;
    let mut out = BufWriter::new(out);
    let state = serde_json::to_string(&design.sheet_state.map(state_name)).map_err(io::Error::from)?;
    writeln!(out, "{{\n  \"version\": {VERSION},\n  \"units\": \"{UNITS}\",")?;
    writeln!(out, "  \"pattern\": \"{}\",", pattern_name(design.pattern))?;
    writeln!(out, "  \"sheet_state\": {state},\n  \"gap_mm\": {:?},", design.gap)?;
    write_rows(&mut out, "  ", "corners", design.corners.iter().map(coordinates))?;
    writeln!(out, ",")?;
    write_rows(&mut out, "  ", "pieces", design.pieces.iter().map(PieceRow::new))?;
    writeln!(out, ",")?;
    write_rows(&mut out, "  ", "hinges", design.hinges.iter().map(HingeRow::new))?;
    writeln!(out, ",")?;
    report::write(file, &mut out)?;
    writeln!(out, "\n}}")?;
    Ok(out.flush()?)
}

fn pattern_name(pattern: PatternKind) -> &'static str {
    match pattern {
        PatternKind::RotatingRectangles => "rotating-rectangles",
        PatternKind::Bistable => "bistable",
        PatternKind::Imported => "imported",
    }
}

/// The name of a state in files.
pub fn state_name(state: State) -> &'static str {
    match state {
        State::Closed => "closed",
        State::Open => "open",
    }
}

fn coordinates(point: &Point3) -> [f64; 3] {
    (*point).into()
}

#[derive(Serialize)]
struct PieceRow<'a> {
    corners: &'a [usize],
    closed: Vec<[f64; 3]>,
    open: Vec<[f64; 3]>,
}

impl<'a> PieceRow<'a> {
    fn new(piece: &'a Piece) -> Self {
        let [closed, open] =
            [&piece.closed, &piece.open].map(|points| points.iter().map(coordinates).collect());
        Self { corners: &piece.corners, closed, open }
    }
}

#[derive(Serialize)]
struct HingeRow {
    pieces: [usize; 2],
    vertices: [usize; 2],
    point: [f64; 3],
    axis: [f64; 3],
    angle_deg: f64,
}

impl HingeRow {
    fn new(hinge: &Hinge) -> Self {
        Self {
            pieces: hinge.pieces,
            vertices: hinge.vertices,
            point: coordinates(&hinge.point),
            axis: hinge.axis.into(),
            angle_deg: hinge.angle.to_degrees(),
        }
    }
}
