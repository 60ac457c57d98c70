//! The main job, stage by stage: the table of contents in code.

mod aims;

mod bistable;

mod clock;

mod error;

mod guides;

mod meshed;

pub mod mill;

mod predict;

mod stage1;

mod surfaces;

use std::collections::BTreeMap;
use std::path::Path;

use crate::fabrication::fabricate::ligament_lengths;
use crate::fabrication::gaps::{half_gaps, is_even};
use crate::fabrication::placement::place_on_sheet;
use crate::fabrication::product::{Product, produce};
use crate::geometry::Point3;
use crate::geometry::closest::ClosestPoints;
use crate::job::{Cuts, Grid, Job, Kind, Opening};
use crate::kirigami::bistable::family::Snapping;
use crate::kirigami::bistable::reach::most_twisted;
use crate::kirigami::control_mesh::{ControlMesh, Goal, Goals, stage1};
use crate::kirigami::design::{Design, PatternKind, State};
use crate::kirigami::guides::measure_open;
use crate::kirigami::levels::{Climb, Family, Level, Reached};
use crate::kirigami::piece_mesh::PieceMesh;
use crate::kirigami::quality::{Limits, Quality, measure};
use crate::kirigami::rotating::Rotating;
use crate::kirigami::validity;
use crate::memory;
use crate::output::design_json::Stage;
use crate::output::whole_file::read_regular;
use crate::profile::Profile;
use crate::solver::Report;
use aims::Aims;
use guides::read_guides;
use stage1::{Begun, begin};
use surfaces::read_targets;

pub use clock::{Clock, Event, Progress, Timings, Watch};
pub use error::{Partial, PipelineError};
pub use guides::GuideError;
pub use predict::{Prediction, predict};

/// Piece polygons must be at least this many hinge gaps wide, so that ligaments and slits find room.
const LEAST_WIDTH_IN_GAPS: f64 = 2.0;

/// Those of bistable sheets, whose necks and border pieces bear no hinges on both sides: what slits on either side leave
/// of them is as wide as a ligament.
const LEAST_NECK_IN_GAPS: f64 = 1.0;

/// A design with all that is needed to measure it again.
pub struct Designed {
    /// The design; its sheet state is not yet placed on the stock.
    pub design: Design,
    /// What was reached.
    pub quality: Quality,
    /// What the solver did.
    pub stages: Vec<Stage>,
    aims: Aims,
}

/// A finished job.
pub struct Made {
    /// The checked sheet, or the pieces where neither state is flat.
    pub product: Product,
    /// Measures of the design as it is made.
    pub quality: Quality,
    /// What the solver did.
    pub stages: Vec<Stage>,
    /// The surfaces, with the states that are to become them.
    pub targets: Vec<(State, ClosestPoints)>,
}

/// Does the whole job in memory.
///
/// # Errors
/// The first stage that fails; nothing has been written.
pub fn make(job: &Job, clock: &mut Clock) -> Result<Made, PipelineError> {
    let designed = design(job, clock)?;
    let product = clock.run("fabrication", |_| produce(&designed.design, &job.fabrication.profile))?;
    clock.go_on(|| Some(reached("fabrication", &designed.design, clock)))?;
    let Quality { asked_edge, stretch_ratio, .. } = designed.quality;
    let goals = designed.aims.goals();
    let measured = measure(product.design(), &goals, asked_edge, stretch_ratio);
    let quality = Quality { open_state: designed.quality.open_state, ..measured };
    Ok(Made { product, quality, stages: designed.stages, targets: designed.aims.surfaces() })
}

/// Reads the targets and runs Stages 1 to 3, then measures and validates the result.
///
/// # Errors
/// A mesh that cannot be used, a target that cannot be reached.
pub fn design(job: &Job, clock: &mut Clock) -> Result<Designed, PipelineError> {
    let targets = clock.run("read", |_| read_targets(&job.target))?;
    let closed_scale = targets.closed.as_ref().map(|closed| closed.scale);
    clock.go_on(|| None)?;
    let Begun { mut levels, layouts, aims, ratio, reports: reports1 } =
        clock.run("stage-1", |_| begin(job, targets))?;
    clock.go_on(|| None)?;
    if let Some(free) = clock.memory {
        let kind = match job.pattern.kind {
            Kind::Bistable(_) => PatternKind::Bistable,
            Kind::RotatingRectangles => PatternKind::RotatingRectangles,
        };
        memory::check(kind, levels[levels.len() - 1].cover.mesh.pieces.len(), free)?;
    }
    let goals = aims.goals();
    let guides = match (closed_scale, goals.closed.target()) {
        (Some(scale), Some(closed)) => {
            let [a, b] = levels[levels.len() - 1].cover.cell.closed;
            read_guides(&job.guides, scale, closed, a.max(b))?
        }
        _ => Vec::new(),
    };
    let goals = Goals { guides: &guides, ..goals };
    let profile = &job.fabrication.profile;
    let (design, [reports2, reports3]) = match &job.pattern.kind {
        Kind::Bistable(proportions) => {
            bistable::check_reach(job, proportions, &levels[levels.len() - 1], &layouts)?;
            let (stage2, stage3) = (&job.solver.stage2, &job.solver.bistable);
            let family = Snapping { goals, proportions, stage2, stage3 };
            optimise(&Climb { levels: &levels, layouts: &layouts, family }, profile, clock)?
        }
        Kind::RotatingRectangles => {
            let (stage2, stage3) = (&job.solver.stage2, &job.solver.stage3);
            let family = Rotating { goals, opening: job.pattern.opening, stage2, stage3 };
            optimise(&Climb { levels: &levels, layouts: &layouts, family }, profile, clock)?
        }
    };
    let Level { cover, .. } = levels.pop().expect("at least one level");
    let mut quality = measure(&design, &goals, cover.asked_edge, ratio);
    if matches!(goals.open, Goal::Free) {
        quality.open_state = Some(measure_open(&design, &guides));
    }
    check_quality(job, &quality, &design, &goals, || stage1(&cover, &layouts), &cover.mesh)?;
    let gaps = match job.pattern.kind {
        Kind::RotatingRectangles => LEAST_WIDTH_IN_GAPS,
        Kind::Bistable(_) => LEAST_NECK_IN_GAPS,
    };
    let least_width = gaps * job.fabrication.profile.hinge_gap();
    validity::check(&design, &goals, least_width)?;
    let stages = vec![
        Stage { name: "stage-1", reports: reports1 },
        Stage { name: "stage-2", reports: reports2 },
        Stage { name: "stage-3", reports: reports3 },
    ];
    Ok(Designed { design, quality, stages, aims })
}

/// Refuses a design that falls short of what it must keep; `start` gives the control meshes of Stage 1.
fn check_quality(
    job: &Job,
    quality: &Quality,
    design: &Design,
    goals: &Goals,
    start: impl Fn() -> ControlMesh,
    grid: &PieceMesh,
) -> Result<(), PipelineError> {
    let shortfalls = quality.shortfalls(&limits(job));
    if shortfalls.is_empty() {
        return Ok(());
    }
    let bistable = design.pattern == PatternKind::Bistable;
    let twist = bistable.then(|| most_twisted(grid, &start().open_corners)).flatten();
    Err(PipelineError::Shortfall { shortfalls, at: farthest(design, goals), twist })
}

/// What a design must keep. Where the opening varies or the grid is aligned the size of the pieces follows from the map, not
/// from a wish.
pub fn limits(job: &Job) -> Limits {
    let limits = Limits::default();
    match (job.pattern.opening, &job.pattern.grid) {
        (Opening::Full, Grid::Regular(_) | Grid::Mesh(_)) => limits,
        (Opening::Variable, _) | (_, Grid::Aligned(_)) => Limits { edge_deviation: f64::INFINITY, ..limits },
    }
}

/// Runs Stages 2 and 3 from coarse to fine, and gives every hinge the gap that it needs. Returns the design and the reports
/// of both stages.
fn optimise<F: Family>(
    climb: &Climb<F>,
    profile: &Profile,
    clock: &mut Clock,
) -> Result<(Design, [Vec<Report>; 2]), PipelineError> {
    let design = |level: usize, pattern: &F::Pattern| climb.family.design(&climb.levels[level], pattern);
    let (control, report) = clock.run("stage-2", |run| climb.stage2(run));
    let start = climb.family.start(&climb.levels[0], &control);
    clock.go_on(|| Some(reached("stage-2", &design(0, &start), clock)))?;
    let Reached { level, mut pattern, mut reports } = clock.run("stage-3", |run| climb.stage3(control, run));
    // Another gap than the profile's is the user's wish.
    if climb.levels[level].gap == profile.hinge_gap() && !is_even(profile) {
        clock.go_on(|| Some(reached("stage-3", &design(level, &pattern), clock)))?;
        let halves = |design: &Design| half_gaps(design, profile);
        let (spaced, more) = clock.run("gaps", |run| climb.space(level, pattern, &halves, run));
        pattern = spaced;
        reports.extend(more);
    }
    let design = design(level, &pattern);
    clock.go_on(|| Some(reached("stage-3", &design, clock)))?;
    Ok((design, [vec![report], reports]))
}

fn reached(stage: &'static str, design: &Design, clock: &Clock) -> Partial {
    Partial { stage, pieces: design.pieces.clone(), journal: clock.journal.entries().to_vec() }
}

/// The vertex of the pattern that is farthest from its target.
fn farthest(design: &Design, goals: &Goals) -> Point3 {
    let states = [State::Open, State::Closed].into_iter();
    let far =
        states.filter_map(|state| Some((state, goals.of(state).target()?))).flat_map(|(state, target)| {
            let vertices = design.pieces.iter().flat_map(move |piece| piece.vertices(state));
            vertices.map(|p| (target.surface.distance(p), *p))
        });
    far.max_by(|a, b| a.0.total_cmp(&b.0)).map_or(Point3::origin(), |(_, p)| p)
}

/// A design in the coordinates in which it will be cut, without the checks of its cuts. Where neither state is flat it
/// stays where its targets are.
///
/// # Errors
/// Those of [`design()`], hinges without room for their ligaments, or a part larger than the stock.
pub fn placed_design(job: &Job, clock: &mut Clock) -> Result<Designed, PipelineError> {
    let mut designed = design(job, clock)?;
    if designed.design.sheet_state.is_none() {
        return Ok(designed);
    }
    let profile = &job.fabrication.profile;
    let lengths = ligament_lengths(&designed.design, profile)?;
    designed.design = place_on_sheet(&designed.design, profile, &lengths)?;
    Ok(designed)
}

/// A hash of bytes, as text: FNV-1a, 64 bits.
pub fn fingerprint(bytes: &[u8]) -> String {
    let hash = bytes.iter().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3)
    });
    format!("fnv1a64:{hash:016x}")
}

/// Hashes by name of the bytes of files.
pub fn fingerprints(files: &[(&str, &Path)]) -> BTreeMap<String, String> {
    files
        .iter()
        .filter_map(|(name, path)| Some(((*name).to_owned(), fingerprint(&read_regular(path).ok()?))))
        .collect()
}

/// Those of the job file and its meshes, to tell files of one design from others'.
pub fn source_hashes(job: &Job, job_file: &Path) -> BTreeMap<String, String> {
    let files = std::iter::once(job_file).chain(job.target.meshes());
    let mut named: Vec<(&str, &Path)> = ["job", "target", "closed-target"].into_iter().zip(files).collect();
    if let Grid::Mesh(file) = &job.pattern.grid {
        named.push(("pieces", &file.path));
        if let Cuts::File(cuts) = &file.cuts {
            named.push(("cuts", cuts));
        }
    }
    let guides = job.guides.iter().flat_map(|guide| guide.files());
    let names: Vec<(String, &Path)> =
        guides.enumerate().map(|(i, file)| (format!("guide-curve-{}", i + 1), file)).collect();
    named.extend(names.iter().map(|(name, file)| (name.as_str(), *file)));
    fingerprints(&named)
}
