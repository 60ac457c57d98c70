//! Bistable cells on their way from coarse to fine.

use super::cell::BistableCell;
use super::fit::{fitted, local_models};
use super::grid::in_millimetres;
use super::mesh::BistableMesh;
use super::optimise::{self, Problem, phases, space, stage3};
use super::pattern::BistablePattern;
use crate::geometry::Point3;
use crate::kirigami::control_mesh::{ControlMesh, Goals};
use crate::kirigami::cover::Cover;
use crate::kirigami::design::Design;
use crate::kirigami::levels::{Beginning, Displacement, Family, Level, mean_displacement};
use crate::kirigami::phases::most_steps;
use crate::kirigami::stage2::{self, Cells, stage2};
use crate::solver::{Report, Run};

/// What Stages 2 and 3 need to know beside the grid.
pub struct Snapping<'a> {
    /// What the states are held to.
    pub goals: Goals<'a>,
    /// The cell, in any unit.
    pub proportions: &'a BistableCell,
    /// Weights of Stage 2.
    pub stage2: &'a stage2::Weights,
    /// Weights of Stage 3.
    pub stage3: &'a optimise::Weights,
}

/// A pattern over a grid, with what it was begun from.
#[derive(Clone)]
pub struct Fitted {
    /// What the grid's cells become.
    pub mesh: BistableMesh,
    /// The model of each cell, in millimetres.
    pub models: Vec<BistableCell>,
    /// Corners of the grid in the unexpanded state.
    pub corners: Vec<Point3>,
    /// The pattern.
    pub pattern: BistablePattern,
}

/// The number of cells for which the job's weight of fairness is meant; with more it grows in proportion.
const FAIR_CELLS: f64 = 144.0;

impl Snapping<'_> {
    fn problem<'a>(
        &'a self,
        level: &'a Level,
        fitted: &'a Fitted,
        border: &'a BistablePattern,
    ) -> Problem<'a> {
        let Level { cover, gap } = level;
        let Fitted { mesh, models, .. } = fitted;
        let (goals, weights) = (self.goals, self.stage3);
        Problem { cover, mesh, models, gap: *gap, goals, weights, border }
    }
}

impl Family for Snapping<'_> {
    type Pattern = Fitted;

    fn stage2(&self, level: &Level, start: &ControlMesh, name: &str, run: &mut Run) -> (ControlMesh, Report) {
        let Level { cover, gap } = level;
        // Second differences fall with the square of the cells' size: fairness is to resist the whole sheet alike.
        let fair = self.stage2.fair * cover.mesh.pieces.len() as f64 / FAIR_CELLS;
        let weights = &stage2::Weights { fair, ..self.stage2.clone() };
        let cells = Cells::Stretched(in_millimetres(self.proportions, cover, *gap).stretches());
        let problem = stage2::Problem { cover, goals: self.goals, gap: *gap, cells, weights };
        stage2(&problem, start, &stage2::course(cover.mesh.pieces.len()), name, run)
    }

    fn start(&self, level: &Level, control: &ControlMesh) -> Fitted {
        let Level { cover, gap } = level;
        let grid = &cover.mesh;
        let mesh = BistableMesh::new(grid);
        let [closed, open] = [&control.closed_corners, &control.open_corners];
        let models = local_models(&in_millimetres(self.proportions, cover, *gap), grid, closed, open);
        let pattern = fitted(&models, grid, &mesh, closed, open);
        Fitted { mesh, models, corners: closed.clone(), pattern }
    }

    fn stage3(
        &self,
        level: &Level,
        start: Fitted,
        border: &Fitted,
        beginning: Beginning,
        name: &str,
        run: &mut Run,
    ) -> (Fitted, Vec<Report>) {
        let problem = self.problem(level, &start, &border.pattern);
        let (pattern, reports) =
            stage3(&problem, start.pattern.clone(), &start.corners, &phases(beginning), name, run);
        (Fitted { pattern, ..start }, reports)
    }

    fn most_steps(&self, _: &Level, beginning: Beginning) -> usize {
        most_steps(&phases(beginning))
    }

    fn displacement(&self, _: &Cover, first: &Fitted, done: &Fitted) -> Displacement {
        let rectangles: Vec<Vec<usize>> =
            (0..done.mesh.cells).map(|cell| (4 * cell..4 * cell + 4).collect()).collect();
        let mean = |before: &[Point3], after: &[Point3]| mean_displacement(rectangles.iter(), before, after);
        Displacement {
            closed: mean(&first.pattern.corners, &done.pattern.corners),
            open: mean(&first.pattern.open, &done.pattern.open),
        }
    }

    fn space(&self, level: &Level, done: Fitted, halves: &[f64], run: &mut Run) -> (Fitted, Vec<Report>) {
        let problem = self.problem(level, &done, &done.pattern);
        let (pattern, report) = space(&problem, done.pattern.clone(), &done.corners, halves, run);
        (Fitted { pattern, ..done }, vec![report])
    }

    fn design(&self, level: &Level, done: &Fitted) -> Design {
        done.pattern.design(&done.mesh, level.gap, self.goals.sheet_state())
    }
}
