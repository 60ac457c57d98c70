//! Stages 2 and 3 of bistable sheets.

use super::clock::Clock;
use super::error::PipelineError;
use super::{LEAST_NECK_IN_GAPS, reached};
use crate::job::Job;
use crate::kirigami::bistable::cell::BistableCell;
use crate::kirigami::bistable::fit::{asked, fitted, local_models};
use crate::kirigami::bistable::grid::in_millimetres;
use crate::kirigami::bistable::mesh::BistableMesh;
use crate::kirigami::bistable::optimise::{Problem, most_steps, stage3};
use crate::kirigami::bistable::reach::check;
use crate::kirigami::control_mesh::{Goals, Layouts, stage1};
use crate::kirigami::design::Design;
use crate::kirigami::levels::Level;
use crate::kirigami::stage2::{self, Cells, stage2};
use crate::solver::{Options, Report, Run, Step};

/// The number of cells for which the job's weight of fairness is meant; with more it grows in proportion.
const FAIR_CELLS: f64 = 144.0;

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
    // Pieces become narrower than the map asks: half as much again.
    let neck = 1.5 * LEAST_NECK_IN_GAPS * job.fabrication.profile.hinge_gap();
    check(&cell, &asked(&cover.mesh, &start.closed_corners, &start.open_corners), neck)?;
    let cells = Cells::Stretched(cell.stretches());
    // Second differences fall with the square of the cells' size: fairness is to resist the whole sheet alike.
    let fair = job.solver.stage2.fair * cover.mesh.pieces.len() as f64 / FAIR_CELLS;
    let weights = stage2::Weights { fair, ..job.solver.stage2.clone() };
    let problem = stage2::Problem { cover, goals, gap: *gap, cells, weights: &weights };
    let options = Options { iterations: 10, energy_tolerance: 1e-2, ..Default::default() };
    let (control, report2) = clock.run("stage-2", |run| {
        let watch = &mut |step: &Step| (run.watch)(&Step { later: most_steps(), ..*step });
        stage2(&problem, &start, &options, "stage-2", &mut Run { journal: run.journal, watch })
    });
    let corners = [&control.closed_corners, &control.open_corners];
    let models = local_models(&cell, &cover.mesh, corners[0], corners[1]);
    let first = fitted(&models, &cover.mesh, &mesh, corners[0], corners[1]);
    clock.go_on(|| Some(reached("stage-2", &first.design(&mesh, *gap, goals.sheet_state()), clock)))?;
    let problem =
        Problem { cover, mesh: &mesh, models: &models, gap: *gap, goals, weights: &job.solver.bistable };
    let (pattern, reports3) = clock.run("stage-3", |run| stage3(&problem, first, corners[0], "stage-3", run));
    let design = pattern.design(&mesh, *gap, goals.sheet_state());
    clock.go_on(|| Some(reached("stage-3", &design, clock)))?;
    Ok((design, [vec![report2], reports3]))
}
