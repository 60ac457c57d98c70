//! The main job, stage by stage: the table of contents in code.

mod clock;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::fabrication::error::FabricationError;
use crate::fabrication::fabricate::{Fabrication, fabricate, ligament_lengths};
use crate::geometry::flatten::{ConformalScale, FlattenError, Flattening, flatten};
use crate::geometry::mesh::{PolyMesh, TriMesh};
use crate::geometry::read::{ReadMeshError, read_mesh};
use crate::geometry::topology::{Defect, NotADisk, check_disk};
use crate::geometry::triangulate::{Surface, TriangulateError, triangulate};
use crate::geometry::{Point3, Vector2, bounds};
use crate::job::{Job, Shape};
use crate::kirigami::control_mesh::{ControlMesh, Target, stage1};
use crate::kirigami::cover::{Cover, CoverError, cover};
use crate::kirigami::design::{Design, Piece};
use crate::kirigami::filled::filled_surface;
use crate::kirigami::quality::{Limits, Quality, Shortfall, measure};
use crate::kirigami::stage2::stage2;
use crate::kirigami::stage3::{Pattern, initial_pattern, stage3};
use crate::kirigami::validity::{self, Invalid};
use crate::kirigami::{hinges, stage2, stage3};
use crate::memory;
use crate::output::design_json::Stage;
use crate::solver::{self, Report, Run, Step, Termination};

pub use clock::{Clock, Event, Progress, Timings, Watch};

/// Targets whose conformal flattening stretches more unevenly than this are refused before optimising:
/// turning pieces stretch a sheet by 1 at least and by less than 3 at most (section 2.2 of the paper's model:
/// m1 + m2 < 4, both >= 1).
pub const MOST_STRETCH_RATIO: f64 = 3.0;

/// Piece polygons must be at least this many hinge gaps wide, so that ligaments and slits find room.
const LEAST_WIDTH_IN_GAPS: f64 = 2.0;

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
         {ratio:.3}): it curves too much, or overlaps itself when flat; cut it into parts",
        path.display(), at.x, at.y, at.z
    )]
    Folded { path: PathBuf, face: usize, at: Point3, ratio: f64 },
    /// The target curves too much.
    #[error(
        "{}: flattening the target stretches some places {ratio:.3} times as much as others; a pattern of turning pieces reaches less than {MOST_STRETCH_RATIO}: cut the target into parts that curve less",
        path.display()
    )]
    Stretch { path: PathBuf, ratio: f64 },
    #[error(transparent)]
    Cover(#[from] CoverError),
    /// The optimisation did not reach the limits.
    #[error("the pattern does not reach the target: {}", list(.0))]
    Shortfall(Vec<Shortfall>),
    #[error(transparent)]
    Invalid(#[from] Invalid),
    #[error(transparent)]
    Fabrication(#[from] FabricationError),
    #[error(transparent)]
    Memory(#[from] memory::NotEnough),
    /// Somebody asked to stop.
    #[error("interrupted in {stage}")]
    Interrupted { stage: &'static str, reached: Option<Box<Reached>> },
    /// The state to go on from belongs to other work.
    #[error("{0}")]
    Journal(String),
}

fn list(shortfalls: &[Shortfall]) -> String {
    shortfalls.iter().map(Shortfall::to_string).collect::<Vec<_>>().join("; ")
}

impl PipelineError {
    /// Whether the input is faulty (exit status 1), rather than sound but not makeable (2).
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::Read(_) | Self::Triangulate { .. } | Self::Journal(_) => true,
            Self::Topology { source, .. } => !matches!(
                source.defect,
                Defect::Closed { .. }
                    | Defect::Holes { .. }
                    | Defect::Handles { .. }
                    | Defect::OneSided { .. }
            ),
            Self::Flatten { source, .. } => matches!(source, FlattenError::Degenerate),
            Self::Cover(source) => !matches!(source, CoverError::GapTooWide { .. }),
            Self::Stretch { .. }
            | Self::Folded { .. }
            | Self::Shortfall(_)
            | Self::Invalid(_)
            | Self::Fabrication(_)
            | Self::Memory(_)
            | Self::Interrupted { .. } => false,
        }
    }
}

/// What an interrupted job had reached.
#[derive(Debug, Clone)]
pub struct Reached {
    /// The stage that was broken off: "stage-2" or later.
    pub stage: &'static str,
    /// The pieces, not yet or not quite congruent in their two states.
    pub pieces: Vec<Piece>,
    /// The minimisations so far.
    pub journal: Vec<solver::journal::Entry>,
}

/// A design with all that is needed to measure it again.
pub struct Designed {
    /// The design; its sheet state is not yet placed on the stock.
    pub design: Design,
    /// What was reached.
    pub quality: Quality,
    /// What the solver did.
    pub stages: Vec<Stage>,
    filled: PolyMesh,
    target: Target,
}

/// A finished job.
pub struct Made {
    /// The checked sheet.
    pub fabrication: Fabrication,
    /// Measures of the design as it will be cut.
    pub quality: Quality,
    /// What the solver did.
    pub stages: Vec<Stage>,
}

/// Does the whole job in memory.
///
/// # Errors
/// The first stage that fails; nothing has been written.
pub fn make(job: &Job, clock: &mut Clock) -> Result<Made, PipelineError> {
    let designed = design(job, clock)?;
    let fabrication = clock.run("fabrication", |_| {
        let lengths = ligament_lengths(&designed.design, &job.fabrication.profile)?;
        fabricate(&designed.design, &job.fabrication.profile, &lengths)
    })?;
    clock.go_on(|| Some(reached("fabrication", &designed.design, clock)))?;
    let quality = measure(
        &fabrication.design,
        &designed.filled,
        &designed.target,
        designed.quality.asked_edge,
        designed.quality.stretch_ratio,
    );
    Ok(Made { fabrication, quality, stages: designed.stages })
}

/// Reads the target and runs Stages 1 to 3, then measures and validates the result.
///
/// # Errors
/// A mesh that cannot be used, a target that cannot be reached.
pub fn design(job: &Job, clock: &mut Clock) -> Result<Designed, PipelineError> {
    let path = target_path(job);
    let (Surface { mesh, face_of, .. }, cycle) = clock.run("read", |_| read_target(job, path))?;
    let flatten_error = |source| match source {
        // Faces are counted from 1, as OBJ files do.
        FlattenError::Folded { triangle, ratio } => PipelineError::Folded {
            path: path.to_owned(),
            face: face_of[triangle] + 1,
            at: mesh.vertices[mesh.faces[triangle][0]],
            ratio,
        },
        source => PipelineError::Flatten { path: path.to_owned(), source },
    };
    clock.go_on(|| None)?;
    let gap = job.pattern.gap;
    let (cover, control, report1, ratio) = clock.run("stage-1", |_| {
        let scale = ConformalScale::solve(&mesh, &cycle).map_err(flatten_error)?;
        let ratio = scale.ratio();
        if ratio.is_nan() || ratio > MOST_STRETCH_RATIO {
            return Err(PipelineError::Stretch { path: path.to_owned(), ratio });
        }
        let flat = flatten(&mesh, &scale).map_err(flatten_error)?;
        let outline: Vec<_> = cycle.iter().map(|&v| flat.points[v]).collect();
        let first = first_axis(&mesh, &flat.points);
        let cover = cover(&outline, &first, job.pattern.pieces, job.pattern.stretches, gap)?;
        let control = stage1(&cover, &mesh, &flat.points);
        Ok((cover, control, flattening_report(&flat), ratio))
    })?;
    clock.go_on(|| None)?;
    if let Some(free) = clock.memory {
        memory::check(cover.mesh.pieces.len(), free)?;
    }
    let target = Target::new(mesh, &cycle);
    let (pattern, [report2, reports3]) = optimise(&cover, &control, &target, gap, clock)?;
    let design = hinges::design(&cover.mesh, &pattern, gap);
    let filled = filled_surface(&cover.mesh, &pattern.open);
    let quality = measure(&design, &filled, &target, cover.cell.edge(), ratio);
    let shortfalls = quality.shortfalls(&Limits::default());
    if !shortfalls.is_empty() {
        return Err(PipelineError::Shortfall(shortfalls));
    }
    let fans = cover.mesh.fans.iter().enumerate();
    let inner: Vec<usize> = fans.filter(|(_, fan)| fan.closed).map(|(corner, _)| corner).collect();
    let least_width = LEAST_WIDTH_IN_GAPS * job.fabrication.profile.hinge_gap();
    validity::check(&design, &filled, &inner, &target, least_width)?;
    let stages = vec![
        Stage { name: "stage-1", reports: vec![report1] },
        Stage { name: "stage-2", reports: report2 },
        Stage { name: "stage-3", reports: reports3 },
    ];
    Ok(Designed { design, quality, stages, filled, target })
}

/// Runs Stages 2 and 3. Returns the pattern and the reports of both stages.
fn optimise(
    cover: &Cover,
    control: &ControlMesh,
    target: &Target,
    gap: f64,
    clock: &mut Clock,
) -> Result<(Pattern, [Vec<Report>; 2]), PipelineError> {
    let pieces = |pattern: &Pattern| hinges::design(&cover.mesh, pattern, gap);
    let (control, report) = clock.run("stage-2", |run| {
        let watch = &mut |step: &Step| (run.watch)(&Step { later: stage3::most_steps(), ..*step });
        let mut run = Run { journal: run.journal, watch };
        let options = solver::Options { iterations: 10, energy_tolerance: 1e-2, ..Default::default() };
        stage2(cover, control, target, gap, &stage2::Weights::default(), &options, &mut run)
    });
    let start = initial_pattern(cover, &control, gap);
    clock.go_on(|| Some(reached("stage-2", &pieces(&start), clock)))?;
    let (pattern, reports) =
        clock.run("stage-3", |run| stage3(cover, start, target, gap, &stage3::Weights::default(), run));
    clock.go_on(|| Some(reached("stage-3", &pieces(&pattern), clock)))?;
    Ok((pattern, [vec![report], reports]))
}

fn reached(stage: &'static str, design: &Design, clock: &Clock) -> Reached {
    Reached { stage, pieces: design.pieces.clone(), journal: clock.journal.entries().to_vec() }
}

/// The rounds of the flattening in the form of the other stages' reports.
fn flattening_report(flat: &Flattening) -> Report {
    let iteration = |energy: &f64| solver::Iteration { energies: vec![*energy], damping: 0.0 };
    Report {
        terms: vec!["arap".to_owned()],
        iterations: flat.energies.iter().map(iteration).collect(),
        next_damping: 0.0,
        termination: if flat.settled { Termination::Stagnation } else { Termination::IterationLimit },
    }
}

/// The mesh that the open state takes on. The job's reader accepts nothing else.
fn target_path(job: &Job) -> &Path {
    match &job.target.open {
        Shape::Mesh(path) => path,
        Shape::Flat => unreachable!("the job reader refuses a flat open state"),
    }
}

/// Reads the target, checks that it is a disk, and scales it to millimetres. Returns also its boundary loop, the
/// surface on the left.
fn read_target(job: &Job, path: &Path) -> Result<(Surface, Vec<usize>), PipelineError> {
    let mesh = read_mesh(path)?;
    let disk =
        check_disk(&mesh).map_err(|source| PipelineError::Topology { path: path.to_owned(), source })?;
    let (low, high) = bounds(mesh.faces.iter().flatten().map(|&v| &mesh.vertices[v]));
    let scale = match job.target.size {
        Some(size) => size / (high - low).max(),
        None => job.target.units.millimetres(),
    };
    let surface = triangulate(&mesh, scale)
        .map_err(|source| PipelineError::Triangulate { path: path.to_owned(), source })?;
    // Splitting faces leaves the boundary as it is; only the numbers of its vertices change, and these ascend.
    let number =
        |vertex: &usize| surface.vertex_of.binary_search(vertex).expect("boundary vertices are used");
    let cycle = disk.boundary.iter().map(number).collect();
    Ok((surface, cycle))
}

/// The direction in the flattening that comes nearest to the target's x axis (y, where the target has no
/// extent in x): the mean gradient of that coordinate.
fn first_axis(mesh: &TriMesh, flat: &[crate::geometry::Point2]) -> Vector2 {
    let mut sums = [Vector2::zeros(), Vector2::zeros()];
    let mut total = 0.0;
    for face in &mesh.faces {
        let [a, b, c] = face.map(|v| flat[v]);
        let (ab, ac) = (b - a, c - a);
        total += ab.perp(&ac);
        for (axis, sum) in sums.iter_mut().enumerate() {
            let [fa, fb, fc] = face.map(|v| mesh.vertices[v][axis]);
            // Twice the area times the gradient of the linear function through the three values.
            *sum += Vector2::new(ac.y, -ac.x) * (fb - fa) + Vector2::new(-ab.y, ab.x) * (fc - fa);
        }
    }
    // A tenth: below it x says little about directions on the surface.
    if sums[0].norm() > 0.1 * total.abs() {
        sums[0].normalize()
    } else {
        sums[1].try_normalize(0.0).unwrap_or(Vector2::x())
    }
}

/// A hash of bytes, as text: FNV-1a, 64 bits.
pub fn fingerprint(bytes: &[u8]) -> String {
    let hash = bytes.iter().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3)
    });
    format!("fnv1a64:{hash:016x}")
}

/// Hashes by name of the bytes of the job file and the target, to tell files of one design from others'.
pub fn fingerprints(files: &[(&str, &Path)]) -> BTreeMap<String, String> {
    files
        .iter()
        .filter_map(|(name, path)| Some(((*name).to_owned(), fingerprint(&std::fs::read(path).ok()?))))
        .collect()
}
