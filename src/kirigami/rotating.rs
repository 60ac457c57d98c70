//! Rotating pieces on their way from coarse to fine.

use super::control_mesh::{ControlMesh, Goals};
use super::cover::Cover;
use super::design::Design;
use super::hinges;
use super::levels::{Beginning, Displacement, Family, Level, mean_displacement};
use super::pattern::{Opening, Pattern, Unknowns, initial_pattern};
use super::pattern_terms::{hard_terms, soft_terms};
use super::phases::{Phase, hard, run_phases};
use super::stage2::{self, Cells, stage2};
use super::stage3::{self, Problem, Regime, stage3};
use crate::geometry::Vector3;
use crate::solver::{Coupling, Options, Report, Run, System};

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
        let (cells, weights) = (Cells::Rotating, self.stage2);
        let problem = stage2::Problem { cover, goals: self.goals, gap: *gap, cells, weights };
        stage2(&problem, start, &stage2::course(cover.mesh.pieces.len()), name, run)
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

    fn space(
        &self,
        level: &Level,
        mut pattern: Pattern,
        halves: &[f64],
        run: &mut Run,
    ) -> (Pattern, Vec<Report>) {
        let Level { cover, gap } = level;
        let mesh = &cover.mesh;
        let scale = cover.cell.edge();
        let at = Unknowns::new(mesh, &self.goals);
        let problem = Problem { cover, goals: self.goals, gap: *gap, weights: self.stage3 };
        let before = pattern.offsets.clone();
        pattern.spread_offsets(mesh, *gap, halves);
        let far = drift(level, &before, &pattern.offsets) > DRIFT;
        let phases = if far { vec![soft_again(), hard()] } else { vec![hard()] };
        let reports = run_phases(&phases, run, |phase, run| {
            pattern.spread_offsets(mesh, *gap, halves);
            let terms = || {
                let mut terms = hard_terms(mesh, &at, &pattern, scale);
                if phase.soft > 0.0 {
                    terms.extend(soft_terms(&problem, [&pattern; 2], &at, phase, Coupling::ByPlace));
                }
                terms
            };
            let mut x = at.pack(&pattern, scale);
            let mut system = System::new(at.places(cover));
            let report =
                run.journal.minimize("uneven-gaps", &mut system, terms, &mut x, &phase.options, run.watch);
            at.unpack(&x, scale, &mut pattern);
            report
        });
        (pattern, reports)
    }

    fn design(&self, level: &Level, pattern: &Pattern) -> Design {
        hinges::design(&level.cover.mesh, pattern, level.gap, self.goals.sheet_state())
    }
}

/// Farther than this, in edges, a sheet is not to slide off its target while its gaps change.
const DRIFT: f64 = 0.02;

/// How far the rim of a sheet is moved, in edges, where hinge points change their distances from their corners (mm) and nothing
/// holds it: it grows or shrinks by what the gaps change on the average.
fn drift(level: &Level, before: &[Vector3], after: &[Vector3]) -> f64 {
    let change: f64 = before.iter().zip(after).map(|(before, after)| after.norm() - before.norm()).sum();
    let across = (level.cover.mesh.pieces.len() as f64).sqrt();
    across * change.abs() / (before.len().max(1) as f64 * level.cover.cell.edge())
}

/// Holds the sheet to its target once more, as at the end of a refined level.
fn soft_again() -> Phase {
    Phase {
        soft: 1.0,
        fair: 2e-3,
        options: Options { iterations: 6, energy_tolerance: 1e-2, ..Options::default() },
    }
}

fn regime(level: &Level, beginning: Beginning) -> Regime {
    let pieces = level.cover.mesh.pieces.len();
    match beginning {
        Beginning::Model => Regime::from_model(pieces),
        Beginning::Coarser => Regime::from_coarser(pieces),
    }
}

/// How far a pattern has moved since `first`.
pub(super) fn displacement(cover: &Cover, first: &Pattern, pattern: &Pattern) -> Displacement {
    Displacement {
        closed: mean_displacement(cover.mesh.pieces.iter(), &first.corners, &pattern.corners),
        open: mean_displacement(cover.mesh.owned.iter(), &first.open, &pattern.open),
    }
}
