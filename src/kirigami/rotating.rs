//! Rotating pieces on their way from coarse to fine.

use super::control_mesh::{ControlMesh, Goals};
use super::cover::Cover;
use super::design::Design;
use super::hinges;
use super::levels::{Beginning, Displacement, Family, Level, mean_displacement};
use super::pattern::{Opening, Pattern, Unknowns, initial_pattern};
use super::pattern_terms::hard_terms;
use super::phases::hard;
use super::stage2::{self, Cells, stage2};
use super::stage3::{self, Problem, Regime, stage3};
use crate::solver::{Options, Report, Run, System};

/// What Stages 2 and 3 need to know beside the grid.
pub struct Rotating<'a> {
    /// What the states are held to.
    pub goals: Goals<'a>,
    /// How far pieces turn.
    pub opening: Opening,
    /// Weights of Stage 2.
    pub stage2: &'a stage2::Weights,
    /// Weights of Stage 3.
    pub stage3: &'a stage3::Weights,
}

impl Family for Rotating<'_> {
    type Pattern = Pattern;

    fn stage2(&self, level: &Level, start: &ControlMesh, name: &str, run: &mut Run) -> (ControlMesh, Report) {
        let Level { cover, gap } = level;
        let options = Options { iterations: 10, energy_tolerance: 1e-2, ..Default::default() };
        let (cells, weights) = (Cells::Rotating, self.stage2);
        let problem = stage2::Problem { cover, goals: self.goals, gap: *gap, cells, weights };
        stage2(&problem, start, &options, name, run)
    }

    fn start(&self, level: &Level, control: &ControlMesh) -> Pattern {
        initial_pattern(&level.cover, control, level.gap, self.opening)
    }

    fn stage3(
        &self,
        level: &Level,
        start: Pattern,
        border: &Pattern,
        beginning: Beginning,
        name: &str,
        run: &mut Run,
    ) -> (Pattern, Vec<Report>) {
        let Level { cover, gap } = level;
        let problem = Problem { cover, goals: self.goals, gap: *gap, weights: self.stage3 };
        stage3(&problem, start, border, &regime(level, beginning), name, run)
    }

    fn most_steps(&self, level: &Level, beginning: Beginning) -> usize {
        regime(level, beginning).most_steps()
    }

    fn displacement(&self, cover: &Cover, first: &Pattern, pattern: &Pattern) -> Displacement {
        displacement(cover, first, pattern)
    }

    fn space(&self, level: &Level, mut pattern: Pattern, halves: &[f64], run: &mut Run) -> (Pattern, Report) {
        let Level { cover, gap } = level;
        let scale = cover.cell.edge();
        let at = Unknowns::new(&cover.mesh, &self.goals);
        pattern.spread_offsets(&cover.mesh, *gap, halves);
        let mut x = at.pack(&pattern, scale);
        let terms = || hard_terms(&cover.mesh, &at, &pattern, scale);
        let mut system = System::new(at.places(cover));
        let report =
            run.journal.minimize("uneven-gaps", &mut system, terms, &mut x, &hard().options, run.watch);
        at.unpack(&x, scale, &mut pattern);
        (pattern, report)
    }

    fn design(&self, level: &Level, pattern: &Pattern) -> Design {
        hinges::design(&level.cover.mesh, pattern, level.gap, self.goals.sheet_state())
    }
}

fn regime(level: &Level, beginning: Beginning) -> Regime {
    match beginning {
        Beginning::Model => Regime::from_model(),
        Beginning::Coarser => Regime::from_coarser(level.cover.mesh.pieces.len()),
    }
}

/// How far a pattern has moved since `first`.
pub(super) fn displacement(cover: &Cover, first: &Pattern, pattern: &Pattern) -> Displacement {
    Displacement {
        closed: mean_displacement(cover.mesh.pieces.iter(), &first.corners, &pattern.corners),
        open: mean_displacement(cover.mesh.owned.iter(), &first.open, &pattern.open),
    }
}
