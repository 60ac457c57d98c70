//! The main job, stage by stage: the table of contents in code.

mod clock;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::fabrication::error::FabricationError;
use crate::fabrication::fabricate::{Fabrication, fabricate, ligament_lengths};
use crate::fabrication::placement::place_on_sheet;
use crate::geometry::flatten::{ConformalScale, FlattenError, Flattening, conformal_points, flatten};
use crate::geometry::mesh::{PolyMesh, TriMesh};
use crate::geometry::read::{ReadMeshError, read_mesh};
use crate::geometry::stretch::stretches;
use crate::geometry::topology::{Defect, NotADisk, check_disk};
use crate::geometry::triangulate::{Surface, TriangulateError, triangulate};
use crate::geometry::{Point2, Point3, Vector2, bounds};
use crate::job::{Job, Shape};
use crate::kirigami::control_mesh::{LinearMap, Target};
use crate::kirigami::cover::{CoverError, cover};
use crate::kirigami::design::{Design, Piece};
use crate::kirigami::feasibility::{EASY_RATIO, Feasibility, MOST_STRETCH_RATIO, Verdict, feasibility};
use crate::kirigami::filled::filled_surface;
use crate::kirigami::hinges;
use crate::kirigami::levels::{COARSEST, Climb, Level, Reached};
use crate::kirigami::pattern::{Pattern, initial_pattern};
use crate::kirigami::quality::{Limits, Quality, Shortfall, measure};
use crate::kirigami::validity::{self, Invalid};
use crate::memory;
use crate::output::design_json::Stage;
use crate::solver::{self, Report};

pub use clock::{Clock, Event, Progress, Timings, Watch};

/// Piece polygons must be at least this many hinge gaps wide, so that ligaments and slits find room.
const LEAST_WIDTH_IN_GAPS: f64 = 2.0;

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
    /// The optimisation did not reach the limits.
    #[error(
        "the pattern does not reach the target: {}; it is farthest off near ({:.2}, {:.2}, {:.2}) mm. {MAP_HINT}",
        list(.shortfalls), .at.x, .at.y, .at.z
    )]
    Shortfall { shortfalls: Vec<Shortfall>, at: Point3 },
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
    let (mut levels, lift, reports1, ratio) = clock.run("stage-1", |_| {
        let scale = ConformalScale::solve(&mesh, &cycle).map_err(flatten_error)?;
        let ratio = scale.ratio();
        if ratio.is_nan() || ratio > MOST_STRETCH_RATIO {
            let at = mesh.vertices[scale.most_scaled()];
            return Err(PipelineError::Stretch { path: path.to_owned(), ratio, at });
        }
        let flat = flatten(&mesh, &scale, EASY_RATIO).map_err(flatten_error)?;
        let outline: Vec<_> = cycle.iter().map(|&v| flat.points[v]).collect();
        let first = first_axis(&mesh, &flat.points);
        let levels = lay_grids(job, &outline, &first)?;
        Ok((levels, LinearMap::new(mesh.clone(), &flat.points), flattening_reports(&flat), ratio))
    })?;
    clock.go_on(|| None)?;
    if let Some(free) = clock.memory {
        memory::check(levels[levels.len() - 1].cover.mesh.pieces.len(), free)?;
    }
    let target = Target::new(mesh, &cycle);
    let climb = Climb {
        levels: &levels,
        lift: &lift,
        target: &target,
        stage2: &job.solver.stage2,
        stage3: &job.solver.stage3,
    };
    let (pattern, [reports2, reports3]) = optimise(&climb, clock)?;
    let Level { cover, gap } = levels.pop().expect("at least one level");
    let design = hinges::design(&cover.mesh, &pattern, gap);
    let filled = filled_surface(&cover.mesh, &pattern.open);
    let quality = measure(&design, &filled, &target, cover.cell.edge(), ratio);
    let shortfalls = quality.shortfalls(&Limits::default());
    if !shortfalls.is_empty() {
        let at = farthest(&filled, &target);
        return Err(PipelineError::Shortfall { shortfalls, at });
    }
    let fans = cover.mesh.fans.iter().enumerate();
    let inner: Vec<usize> = fans.filter(|(_, fan)| fan.closed).map(|(corner, _)| corner).collect();
    let least_width = LEAST_WIDTH_IN_GAPS * job.fabrication.profile.hinge_gap();
    validity::check(&design, &filled, &inner, &target, least_width)?;
    let stages = vec![
        Stage { name: "stage-1", reports: reports1 },
        Stage { name: "stage-2", reports: reports2 },
        Stage { name: "stage-3", reports: reports3 },
    ];
    Ok(Designed { design, quality, stages, filled, target })
}

/// Lays the grid that the job asks for, and coarser ones to begin with: the coarsest first.
fn lay_grids(job: &Job, outline: &[Point2], first: &Vector2) -> Result<Vec<Level>, CoverError> {
    let (mut size, mut gap) = (job.pattern.pieces, job.pattern.gap);
    let lay = |size, gap| cover(outline, first, size, job.pattern.stretches, gap, job.pattern.boundary);
    let mut levels = vec![Level { cover: lay(size, gap)?, gap }];
    while levels[levels.len() - 1].cover.mesh.pieces.len() > COARSEST {
        (size, gap) = (size.coarser(), 2.0 * gap);
        // Large pieces may not fit a narrow target.
        let Ok(cover) = lay(size, gap) else { break };
        levels.push(Level { cover, gap });
    }
    levels.reverse();
    Ok(levels)
}

/// Runs Stages 2 and 3. Returns the pattern and the reports of both stages.
fn optimise(climb: &Climb, clock: &mut Clock) -> Result<(Pattern, [Vec<Report>; 2]), PipelineError> {
    let pieces = |level: usize, pattern: &Pattern| {
        let Level { cover, gap } = &climb.levels[level];
        hinges::design(&cover.mesh, pattern, *gap)
    };
    let (control, report) = clock.run("stage-2", |run| climb.stage2(run));
    let start = initial_pattern(&climb.levels[0].cover, &control, climb.levels[0].gap);
    clock.go_on(|| Some(reached("stage-2", &pieces(0, &start), clock)))?;
    let Reached { level, pattern, reports } = clock.run("stage-3", |run| climb.stage3(control, run));
    clock.go_on(|| Some(reached("stage-3", &pieces(level, &pattern), clock)))?;
    Ok((pattern, [vec![report], reports]))
}

fn reached(stage: &'static str, design: &Design, clock: &Clock) -> Partial {
    Partial { stage, pieces: design.pieces.clone(), journal: clock.journal.entries().to_vec() }
}

/// The vertex of the pattern's open state that is farthest from the target.
fn farthest(filled: &PolyMesh, target: &Target) -> Point3 {
    let far = filled.vertices.iter().map(|p| (target.surface.distance(p), *p));
    far.max_by(|a, b| a.0.total_cmp(&b.0)).map_or(Point3::origin(), |(_, p)| p)
}

/// What a target asks for, and what is needed to draw it.
pub struct Prediction {
    /// The numbers.
    pub feasibility: Feasibility,
    /// The target, millimetres.
    pub mesh: TriMesh,
    /// #V points of its flattening; the conformal one where the map of Stage 1 folds over.
    pub flat: Vec<Point2>,
    /// The face of the file, counted from 1, that the worst triangle is part of.
    pub worst_face: usize,
}

/// Reads the target, lays it flat as Stage 1 does and says what the pattern can do with it; nothing is optimised.
///
/// # Errors
/// A mesh that cannot be used.
pub fn predict(job: &Job, clock: &mut Clock) -> Result<Prediction, PipelineError> {
    let path = target_path(job);
    let (Surface { mesh, face_of, .. }, cycle) = clock.run("read", |_| read_target(job, path))?;
    let flatten_error = |source| PipelineError::Flatten { path: path.to_owned(), source };
    clock.run("feasibility", |_| {
        let scale = ConformalScale::solve(&mesh, &cycle).map_err(flatten_error)?;
        let (flat, stretched, folded) = match flatten(&mesh, &scale, EASY_RATIO) {
            Ok(flat) => {
                let stretched = stretches(&mesh, &flat.points);
                (flat.points, stretched, false)
            }
            Err(FlattenError::Folded { .. }) => {
                (conformal_points(&mesh, &scale), scale.stretches(&mesh), true)
            }
            Err(error) => return Err(flatten_error(error)),
        };
        let mut feasibility = feasibility(&mesh, &stretched, scale.ratio());
        if folded {
            feasibility.verdict = Verdict::Beyond;
        }
        let worst_face = face_of[feasibility.worst.triangle] + 1;
        Ok(Prediction { feasibility, mesh, flat, worst_face })
    })
}

/// A design in the coordinates in which it will be cut, without the checks of its cuts.
///
/// # Errors
/// Those of [`design()`], hinges without room for their ligaments, or a part larger than the stock.
pub fn placed_design(job: &Job, clock: &mut Clock) -> Result<Designed, PipelineError> {
    let mut designed = design(job, clock)?;
    let profile = &job.fabrication.profile;
    let lengths = ligament_lengths(&designed.design, profile)?;
    designed.design = place_on_sheet(&designed.design, profile, &lengths)?;
    Ok(designed)
}

/// The rounds of the flattening in the form of the other stages' reports: first those that make it rigid, with the
/// energy, then those that lower the worst stretch, with its ratio.
fn flattening_reports(flat: &Flattening) -> Vec<solver::Report> {
    let report = |term, values: &[f64], settled| solver::Report {
        terms: vec![String::from(term)],
        iterations: values
            .iter()
            .filter(|value| value.is_finite())
            .map(|value| solver::Iteration { energies: vec![*value], damping: 0.0 })
            .collect(),
        next_damping: 0.0,
        termination: if settled {
            solver::Termination::Stagnation
        } else {
            solver::Termination::IterationLimit
        },
    };
    let mut reports = vec![report("arap", &flat.energies, flat.settled)];
    if flat.ratios.len() > 1 {
        reports.push(report("worst-stretch-ratio", &flat.ratios, true));
    }
    reports
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
