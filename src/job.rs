//! The job file: what the user asks for.
//!
//! [`read_job`] reads it, loads the profile that it names, applies the job's overrides to that profile and checks
//! everything that can be checked without the mesh. Paths are relative to the job file. What the file may hold but
//! this version does not make is refused in
//! words, not as an unknown key.

use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::fabrication::plan::CutOptions;
use crate::kirigami::bistable::cell::BistableCell;
use crate::kirigami::cover::{Boundary, PieceSize};
pub use crate::kirigami::pattern::Opening;
pub use crate::kirigami::pattern_mesh::Reading;
use crate::machine::Machine;
use crate::output::dxf::DxfVersion;
use crate::profile::Profile;
use crate::toml_source::{ShelfError, TomlError, read_text};

mod bistable;

mod cut;

mod fabrication;

mod guide;

mod machine;

mod pattern;

mod read;

mod solver;

pub use cut::cut_keys;
pub use guide::{Guide, GuideWay};
pub use solver::Solver;

/// A checked job: paths are as the user named them, numbers finite and in range.
#[derive(Debug, Clone, PartialEq)]
pub struct Job {
    /// The job file's folder, as the user named it.
    pub folder: PathBuf,
    /// The surfaces.
    pub target: Target,
    /// What a free open state is to come near.
    pub guides: Vec<Guide>,
    /// The cut pattern.
    pub pattern: Pattern,
    /// How the sheet is made.
    pub fabrication: Fabrication,
    /// Weights of the optimisation.
    pub solver: Solver,
}

/// The surfaces of the two states.
#[derive(Debug, Clone, PartialEq)]
pub struct Target {
    /// What the open sheet takes on.
    pub open: Shape,
    /// What the closed sheet takes on: flat or a mesh. At least one of both is a mesh.
    pub closed: Shape,
    /// Unit of the mesh files' coordinates.
    pub units: Units,
    /// Largest extent in millimetres, after scaling, of the open target, or of the closed one where that is the only
    /// mesh; `None` leaves the mesh's own size. Both meshes are scaled alike.
    pub size: Option<f64>,
    /// Largest extent of the closed target, where that is to be scaled by itself.
    pub closed_size: Option<f64>,
}

impl Target {
    /// The mesh files, the one that [`Target::size`] is meant for first.
    pub fn meshes(&self) -> Vec<&Path> {
        [&self.open, &self.closed].into_iter().filter_map(Shape::path).collect()
    }
}

/// A surface that a state takes on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Shape {
    /// The plane.
    Flat,
    /// Whatever the pieces make of it.
    Free,
    /// The surface in a mesh file, from the working folder.
    Mesh(PathBuf),
}

impl Shape {
    /// The mesh file.
    pub fn path(&self) -> Option<&Path> {
        match self {
            Self::Mesh(path) => Some(path),
            Self::Flat | Self::Free => None,
        }
    }
}

/// A unit of length of a mesh file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Units {
    /// `mm`
    Millimetres,
    /// `cm`
    Centimetres,
    /// `m`
    Metres,
    /// `in`
    Inches,
}

impl Units {
    /// Millimetres per unit.
    pub fn millimetres(self) -> f64 {
        match self {
            Self::Millimetres => 1.0,
            Self::Centimetres => 10.0,
            Self::Metres => 1000.0,
            Self::Inches => 25.4,
        }
    }
}

/// The cut pattern.
#[derive(Debug, Clone, PartialEq)]
pub struct Pattern {
    /// The family.
    pub kind: Kind,
    /// Which pieces there are.
    pub grid: Grid,
    /// Open-state stretches m1 and m2 along the grid's first and second direction (the paper's principal stretches,
    /// Eq. (1)). They satisfy 1/m1 + 1/m2 = sqrt 2 exactly: what the file gives within 0.1 % is scaled onto it. Those of
    /// bistable cells follow from their dimensions, Eq. (2).
    pub stretches: [f64; 2],
    /// How far the pieces turn.
    pub opening: Opening,
    /// How the pattern meets the target's outline; `None` for what fits it.
    pub boundary: Option<Boundary>,
    /// Distance between the two hinge points of an inner corner, millimetres; 0 is the paper's model.
    pub gap: f64,
}

/// The family of a cut pattern.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    /// Rectangles that turn by about 45 degrees.
    RotatingRectangles,
    /// Rectangles that snap between two states, with the proportions of their cells (no gap).
    Bistable(BistableCell),
}

/// Where the pieces come from.
#[derive(Debug, Clone, PartialEq)]
pub enum Grid {
    /// A regular grid that covers the flattened target.
    Regular(PieceSize),
    /// A grid along the principal directions of the map between the two states.
    Aligned(PieceSize),
    /// A mesh file, in the target's units and coordinates.
    Mesh(PatternFile),
}

/// A mesh file whose faces give the combinatorics of the pattern.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PatternFile {
    /// From the working folder.
    pub path: PathBuf,
    /// What its faces stand for.
    pub reading: Reading,
    /// The cuts that are made besides those that the file itself holds.
    pub cuts: Cuts,
}

/// Cuts in the sheet.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Cuts {
    /// None.
    None,
    /// The shortest ones that let neighbouring pieces turn in opposite senses.
    Automatic,
    /// Those in a file, from the working folder.
    File(PathBuf),
}

/// How the sheet is made.
#[derive(Debug, Clone, PartialEq)]
pub struct Fabrication {
    /// The profile, with the job's `sheet_mm` and `kerf_mm` in place of its own where given.
    pub profile: Profile,
    /// The DXF flavour.
    pub dxf: DxfVersion,
    /// How the sheet is cut.
    pub cut: CutOptions,
    /// The machine that mills it; `None` for a laser.
    pub machine: Option<Machine>,
}

/// The machine for milled sheets of jobs that name none.
pub const DEFAULT_MACHINE: &str = "linuxcnc-xyzbc-trt";

/// The keys that a job file may leave out, and what then holds.
pub const DEFAULTS: [(&str, &str); 28] = [
    ("target.units", "\"mm\""),
    ("target.size_mm", "the mesh's own size"),
    ("target.closed_size_mm", "scaled as the open target is"),
    ("guide.weight", "1.0"),
    ("pattern.stretches", "[1.41421356, 1.41421356]"),
    ("pattern.boundary", "\"glide\" where the outline has four corners, else \"trimmed\""),
    ("pattern.gap_mm", "the profile's ligament width plus kerf"),
    ("pattern.opening", "\"full\""),
    ("fabrication.sheet_mm", "the profile's sheet"),
    ("fabrication.kerf_mm", "the profile's kerf"),
    ("fabrication.process", "the profile's process"),
    ("fabrication.machine", "\"linuxcnc-xyzbc-trt\" for milling"),
    ("fabrication.dxf", "\"r2000\""),
    ("fabrication.copies", "1"),
    ("fabrication.spacing_mm", "5.0"),
    ("fabrication.passes", "1"),
    ("fabrication.pierce", "\"slit-end\""),
    ("fabrication.order", "\"travel\""),
    ("fabrication.cool_s", "10.0; of order = \"heat\""),
    ("fabrication.cool_mm", "as near as the cuts beside the hinge; of order = \"heat\""),
    ("fabrication.leads", "\"none\"; with pierce = \"scrap\" \"line\""),
    ("fabrication.lead_mm", "2.0"),
    ("fabrication.tabs", "none"),
    ("fabrication.tab_mm", "the profile's min_web_mm"),
    ("fabrication.engrave", "false"),
    ("fabrication.sheet_state", "the state that is \"flat\""),
    ("solver.stage-2", "{ orth = 1.0, geom = 1.0, prox = 0.1, boundary = 0.1, corners = 0.6, fair = 0.001 }"),
    (
        "solver.stage-3",
        "{ prox = 0.6, boundary = 0.05, corners = 0.6, fair = 0.001, opening = 0.001, rectangles = 0.001, \
         sides = 0.0001, widths = 0.1 }",
    ),
];

/// Those of bistable patterns that differ or come on top. Fairness is meant for 144 cells, and grows with their number.
pub const BISTABLE_DEFAULTS: [(&str, &str); 7] = [
    ("pattern.A", "1.0"),
    ("pattern.B", "1.0"),
    ("pattern.a", "0.42"),
    ("pattern.b", "0.42"),
    ("pattern.phi_deg", "18.0"),
    ("solver.stage-2", "{ orth = 1.0, geom = 0.01, prox = 0.1, boundary = 0.1, corners = 0.6, fair = 0.01 }"),
    ("solver.stage-3", "{ prox = 0.3, boundary = 0.1, corners = 0.3, shape = 1.0 }"),
];

/// A job file could not be used.
#[derive(Debug, Error)]
pub enum JobError {
    /// The job file cannot be read or breaks a rule.
    #[error(transparent)]
    Job(#[from] TomlError),
    /// The machine that it names cannot be read or breaks a rule.
    #[error("{file}: the machine that it names cannot be used\n{source}")]
    Machine {
        /// The job file.
        file: String,
        /// What is wrong with the machine.
        source: ShelfError,
    },
    /// The profile that it names cannot be read or breaks a rule.
    #[error("{file}: the profile that it names cannot be used\n{source}")]
    Profile {
        /// The job file.
        file: String,
        /// What is wrong with the profile.
        source: ShelfError,
    },
}

/// Reads and checks a job file, and the profile that it names.
///
/// # Errors
/// An unreadable file; syntax, unknown, missing or mistyped keys; numbers out of range or in contradiction; a mesh
/// file that does not exist; a profile that does not exist or is faulty; what this version does not make.
pub fn read_job(path: &Path) -> Result<Job, JobError> {
    let text = read_text(path)?;
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    read::parse(&text, &path.display().to_string(), folder)
}

#[cfg(test)]
mod tests;
