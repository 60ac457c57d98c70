//! Stages 2 and 3 of bistable sheets.

use super::clock::Clock;
use super::error::PipelineError;
use super::reached;
use crate::job::Job;
use crate::kirigami::bistable::cell::BistableCell;
use crate::kirigami::bistable::fit::fitted;
use crate::kirigami::bistable::grid::in_millimetres;
use crate::kirigami::bistable::mesh::BistableMesh;
use crate::kirigami::bistable::optimise::{Problem, most_steps, stage3};
use crate::kirigami::control_mesh::{Goals, Layouts, stage1};
use crate::kirigami::design::Design;
use crate::kirigami::levels::Level;
use crate::kirigami::stage2::{self, Cells, stage2};
use crate::solver::{Options, Report, Run, Step};

/// Runs Stages 2 and 3 with cells of these proportions on the finest grid. Returns the design and the reports of both
/// stages.
pub(super) fn optimise(
    job: &Job,
    proportions: &BistableCell,
    levels: &[Level],
    layouts: &Layouts,
    goals: Goals,
    clock: &mut Clock,
) -> Result<(Design, [Vec<Report>; 2]), PipelineError> {
    let Level { cover, gap } = &levels[levels.len() - 1];
    let cell = in_millimetres(proportions, cover, *gap);
    let mesh = BistableMesh::new(&cover.mesh);
    let start = stage1(cover, layouts);
    let cells = Cells::Stretched(cell.stretches());
    let problem = stage2::Problem { cover, goals, gap: *gap, cells, weights: &job.solver.stage2 };
    let options = Options { iterations: 10, energy_tolerance: 1e-2, ..Default::default() };
    let (control, report2) = clock.run("stage-2", |run| {
        let watch = &mut |step: &Step| (run.watch)(&Step { later: most_steps(), ..*step });
        stage2(&problem, &start, &options, "stage-2", &mut Run { journal: run.journal, watch })
    });
    let first = fitted(&cell, &cover.mesh, &mesh, &control.closed_corners, &control.open_corners);
    clock.go_on(|| Some(reached("stage-2", &first.design(&mesh, *gap, goals.sheet_state()), clock)))?;
    let problem = Problem { cover, mesh: &mesh, cell: &cell, goals, weights: &job.solver.bistable };
    let (pattern, reports3) =
        clock.run("stage-3", |run| stage3(&problem, first, &control.closed_corners, "stage-3", run));
    let design = pattern.design(&mesh, *gap, goals.sheet_state());
    clock.go_on(|| Some(reached("stage-3", &design, clock)))?;
    Ok((design, [vec![report2], reports3]))
}
