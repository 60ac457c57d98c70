//! Why a job ends without a result.

use std::path::PathBuf;

use super::guides::GuideError;
use crate::fabrication::error::FabricationError;
use crate::geometry::flatten::FlattenError;
use crate::geometry::read::ReadMeshError;
use crate::geometry::topology::{Defect, NotADisk};
use crate::geometry::triangulate::TriangulateError;
use crate::geometry::{Point2, Point3};
use crate::kirigami::bistable::reach::OutOfReach;
use crate::kirigami::bistable::reach::Twist;
use crate::kirigami::cover::CoverError;
use crate::kirigami::design::Piece;
use crate::kirigami::feasibility::MOST_STRETCH_RATIO;
use crate::kirigami::pattern_mesh::PatternMeshError;
use crate::kirigami::quality::Shortfall;
use crate::kirigami::validity::Invalid;
use crate::memory;
use crate::remesh::RemeshError;
use crate::solver;

/// Where the user finds out more about a target that asks for too much.
const MAP_HINT: &str =
    "See where it asks for how much: kirimorph design JOB --feasibility-only --map map.svg";

/// Why a job ends without a result.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs)] // Each variant carries the error of the stage that its name says.
pub enum PipelineError {
    #[error(transparent)]
    Read(#[from] ReadMeshError),
    #[error("{}: {source}", path.display())]
    Topology { path: PathBuf, source: NotADisk },
    #[error("{}: {source}", path.display())]
    Triangulate { path: PathBuf, source: TriangulateError },
    #[error("{}: {source}", path.display())]
    Flatten { path: PathBuf, source: FlattenError },
    /// The target cannot be laid flat without folding.
    #[error(
        "{}: laid flat, the target folds over at face {face} near ({:.2}, {:.2}, {:.2}) mm (its stretch ratio is \
         {ratio:.3}): it curves too much, or overlaps itself when flat; cut it into parts. {MAP_HINT}",
        path.display(), at.x, at.y, at.z
    )]
    Folded { path: PathBuf, face: usize, at: Point3, ratio: f64 },
    /// A mesh of a map folds over.
    #[error(
        "{}: the map between the two meshes folds over at face {face} near ({:.2}, {:.2}, {:.2}) mm: there the face is turned \
         over against those around it; move its vertices apart, so that every face lies beside its neighbours",
        path.display(), at.x, at.y, at.z
    )]
    FoldedMap { path: PathBuf, face: usize, at: Point3 },
    /// The target curves too much.
    #[error(
        "{}: flattening the target stretches some places {ratio:.3} times as much as others; a pattern of turning pieces \
         reaches less than {MOST_STRETCH_RATIO}; it is worst near ({:.2}, {:.2}, {:.2}) mm: cut the target into parts \
         that curve less. {MAP_HINT}",
        path.display(), at.x, at.y, at.z
    )]
    Stretch { path: PathBuf, ratio: f64, at: Point3 },
    #[error(transparent)]
    Cover(#[from] CoverError),
    /// A closed target that is smaller than the closed sheet.
    #[error(
        "{}: the closed sheet does not fit on this target: at ({:.2}, {:.2}) of its flattening it reaches {beyond:.1} mm \
         beyond the edge. The closed sheet has {sheet:.0} mm2 (the open target's area over the stretches), this target \
         {target:.0} mm2: scale it up by about {factor:.2} (closed_size_mm), or give both meshes the same faces, so \
         that their vertices correspond",
        path.display(), at.x, at.y
    )]
    TooSmall { path: PathBuf, at: Point2, beyond: f64, sheet: f64, target: f64, factor: f64 },
    /// The mesh of pieces, or its cuts.
    #[error("{}: {source}", path.display())]
    PatternMesh { path: PathBuf, source: Box<PatternMeshError> },
    /// Unequal stretches without directions.
    #[error(
        "{}: around its irregular vertices the pieces' sides have no first and second direction that agree, so the two \
         stretches must be equal: leave [pattern] stretches out",
        path.display()
    )]
    NoDirections { path: PathBuf },
    /// The aligned grid.
    #[error("{}: {source}", path.display())]
    Remesh { path: PathBuf, source: RemeshError },
    /// No map between two meshes.
    #[error(
        "{}: alignment = \"principal\" needs a map between the two targets: give both meshes the same faces in the same \
         order, or make one of the states flat",
        path.display()
    )]
    NoMap { path: PathBuf },
    /// Bistable cells that cannot have the stretches asked for.
    #[error(transparent)]
    OutOfReach(#[from] Box<OutOfReach>),
    /// The optimisation did not reach the limits.
    #[error(
        "the pattern does not reach the target: {}; it is farthest off near ({:.2}, {:.2}, {:.2}) mm. {}{MAP_HINT}",
        list(.shortfalls), .at.x, .at.y, .at.z, .twist.map_or(String::new(), twist_hint)
    )]
    Shortfall { shortfalls: Vec<Shortfall>, at: Point3, twist: Option<Twist> },
    #[error(transparent)]
    Guide(#[from] GuideError),
    #[error(transparent)]
    Invalid(#[from] Invalid),
    #[error(transparent)]
    Fabrication(#[from] FabricationError),
    #[error(transparent)]
    Memory(#[from] memory::NotEnough),
    /// Somebody asked to stop.
    #[error("interrupted in {stage}")]
    Interrupted { stage: &'static str, reached: Option<Box<Partial>> },
    /// The state to go on from belongs to other work.
    #[error("{0}")]
    Journal(String),
}

fn list(shortfalls: &[Shortfall]) -> String {
    shortfalls.iter().map(Shortfall::to_string).collect::<Vec<_>>().join("; ")
}

/// Bistable cells that are twisted by more than this part of their side may be why a target is not reached: at half of it all
/// tried targets were.
const MUCH_TWIST: f64 = 0.01;

fn twist_hint(Twist { by, share, at }: Twist) -> String {
    if share < MUCH_TWIST {
        return String::new();
    }
    format!(
        "Bistable cells do not twist, and the target twists against the grid by {by:.2} mm, {:.1} % of a cell, near \
         ({:.2}, {:.2}, {:.2}) mm: take smaller cells, or turn the mesh so that it bends along the x axis and across it. ",
        100.0 * share,
        at.x,
        at.y,
        at.z
    )
}

impl PipelineError {
    /// Whether the input is faulty (exit status 1), rather than sound but not makeable (2).
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::Read(_)
            | Self::Guide(_)
            | Self::Triangulate { .. }
            | Self::FoldedMap { .. }
            | Self::Journal(_)
            | Self::NoDirections { .. }
            | Self::NoMap { .. } => true,
            Self::PatternMesh { source, .. } => source.is_bad_input(),
            Self::Remesh { source, .. } => !matches!(
                source,
                RemeshError::Singular { .. }
                    | RemeshError::GridFolds { .. }
                    | RemeshError::TooFew { .. }
                    | RemeshError::Degenerate
                    | RemeshError::PiecesNotADisk(_)
            ),
            Self::Topology { source, .. } => !matches!(
                source.defect,
                Defect::Closed { .. }
                    | Defect::Holes { .. }
                    | Defect::Handles { .. }
                    | Defect::OneSided { .. }
            ),
            Self::Flatten { source, .. } => matches!(source, FlattenError::Degenerate),
            Self::Cover(source) => {
                !matches!(source, CoverError::GapTooWide { .. } | CoverError::CellTooSmall { .. })
            }
            Self::Stretch { .. }
            | Self::TooSmall { .. }
            | Self::Folded { .. }
            | Self::OutOfReach(_)
            | Self::Shortfall { .. }
            | Self::Invalid(_)
            | Self::Fabrication(_)
            | Self::Memory(_)
            | Self::Interrupted { .. } => false,
        }
    }
}

/// What an interrupted job had reached.
#[derive(Debug, Clone)]
pub struct Partial {
    /// The stage that was broken off: "stage-2" or later.
    pub stage: &'static str,
    /// The pieces, not yet or not quite congruent in their two states.
    pub pieces: Vec<Piece>,
    /// The minimisations so far.
    pub journal: Vec<solver::journal::Entry>,
}
