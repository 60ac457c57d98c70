//! Stage 3: pieces that are congruent in both states (section 3.3).
//!
//! The unknowns are those of [`super::pattern`]. The normals along which the two hinges of a corner stand apart
//! are taken from the closed sheet before each phase and stay fixed while it runs.

use super::control_mesh::Goals;
use super::cover::Cover;
use super::guides::settle;
use super::pattern::{Pattern, Unknowns};
use super::pattern_terms::{hard_terms, soft_terms};
use super::phases::{MANY, Phase, hard, most_steps, run_phases, soft_precision};
use crate::solver::{Coupling, Options, Precision, Report, Run, System};

/// Weights of the soft phase, for a mean edge of 1. Isometry and planarity have weight 1.
#[derive(Debug, Clone, PartialEq)]
pub struct Weights {
    /// Closeness to the target.
    pub prox: f64,
    /// Distance to the target's boundary.
    pub boundary: f64,
    /// Fairness, Eqs. (6) and (9), in the first phase.
    pub fair: f64,
    /// Fully open hinges.
    pub opening: f64,
    /// Right angles of closed pieces.
    pub rectangles: f64,
    /// Lengths of the closed sides that touch the border, where fairness does not reach.
    pub sides: f64,
    /// Distance of fixed corners from the outline's.
    pub corners: f64,
    /// Widths that pieces lack; pieces that are wide enough do not feel it.
    pub widths: f64,
}

impl Default for Weights {
    /// Found on eight targets with 12 to 40 pieces a side. The three shape terms are a thousandth or less of
    /// the hard ones: they decide only what the hard ones leave free. Without them pieces at the border
    /// become slivers and hinges turn by up to 180 degrees.
    fn default() -> Self {
        Self {
            prox: 0.6,
            boundary: 0.05,
            fair: 1e-3,
            opening: 1e-3,
            rectangles: 1e-3,
            sides: 1e-4,
            corners: 0.6,
            widths: 0.1,
        }
    }
}

/// The course of Stage 3.
#[derive(Debug, Clone, PartialEq)]
pub struct Regime {
    /// Its phases.
    pub phases: Vec<Phase>,
    /// Coupling of fairness, the term that reaches farthest.
    pub coupling: Coupling,
}

impl Regime {
    /// From the model cells of Stage 2. Closeness first gains and then phases out, so that the hard phase has little
    /// left to correct; fairness phases out throughout.
    pub fn from_model(pieces: usize) -> Self {
        // Factors of closeness and of fairness, most iterations, and the relative decrease below which a phase ends.
        const SOFT: [(f64, f64, usize, f64); 5] = [
            (1.0, 1.0, 12, 1e-2),
            (2.0, 0.2, 12, 1e-3),
            (2.0, 0.04, 12, 1e-3),
            (0.2, 4e-3, 10, 1e-3),
            (0.02, 4e-4, 10, 1e-3),
        ];
        Self { phases: phases(&SOFT, soft_precision(pieces)), coupling: Coupling::Full }
    }

    /// From an optimised pattern of larger pieces: only details remain to be found. Where there are many, the curvature of
    /// fairness is bounded place by place: that makes the factor six times cheaper, and long waves have been settled
    /// on coarser grids.
    pub fn from_coarser(pieces: usize) -> Self {
        const SOFT: [(f64, f64, usize, f64); 3] =
            [(1.0, 1.0, 4, 3e-2), (2.0, 0.04, 6, 1e-2), (0.1, 2e-3, 3, 1e-2)];
        let coupling = if pieces > MANY { Coupling::ByPlace } else { Coupling::Full };
        Self { phases: phases(&SOFT, soft_precision(pieces)), coupling }
    }

    /// Most steps of all phases together.
    pub fn most_steps(&self) -> usize {
        most_steps(&self.phases)
    }
}

/// These soft phases, and the hard one.
fn phases(soft: &[(f64, f64, usize, f64)], precision: Precision) -> Vec<Phase> {
    let soft = soft.iter().map(|&(soft, fair, iterations, energy_tolerance)| Phase {
        soft,
        fair,
        options: Options { iterations, energy_tolerance, precision, ..Options::default() },
    });
    soft.chain([hard()]).collect()
}

/// What Stage 3 works on.
#[derive(Clone, Copy)]
pub struct Problem<'a> {
    /// The grid.
    pub cover: &'a Cover,
    /// What the states are held to.
    pub goals: Goals<'a>,
    /// Distance between the two hinge points of a corner, millimetres.
    pub gap: f64,
    /// Weights.
    pub weights: &'a Weights,
}

/// Optimises the pattern: soft phases with closeness and fairness, and a hard phase of isometry and planarity
/// alone.
///
/// Border points are held to where they are in `border`. Returns the pattern and one report per phase; `name` is
/// that of the minimisations in the journal. Where they are interrupted, the phases that follow are left out.
pub fn stage3(
    problem: &Problem,
    start: Pattern,
    border: &Pattern,
    regime: &Regime,
    name: &str,
    run: &mut Run,
) -> (Pattern, Vec<Report>) {
    let &Problem { cover, goals, gap, .. } = problem;
    let mesh = &cover.mesh;
    let scale = cover.cell.edge();
    let at = Unknowns::new(mesh, &goals);
    let mut systems = [(); 2].map(|()| System::new(at.places(cover)));
    let mut pattern = start;
    let reports = run_phases(&regime.phases, run, |phase, run| {
        pattern.turn_offsets(mesh, gap);
        if phase.soft > 0.0 {
            settle(goals.guides, mesh, &mut pattern);
        }
        // Fully coupled soft terms make the factor several times as costly: do without where they have no weight.
        let alone = phase.soft == 0.0 && regime.coupling == Coupling::Full;
        let terms = || {
            let mut terms = hard_terms(mesh, &at, &pattern, scale);
            if !alone {
                terms.extend(soft_terms(problem, [border, &pattern], &at, phase, regime.coupling));
            }
            terms
        };
        let mut x = at.pack(&pattern, scale);
        let system = &mut systems[usize::from(alone)];
        let report = run.journal.minimize(name, system, terms, &mut x, &phase.options, run.watch);
        at.unpack(&x, scale, &mut pattern);
        report
    });
    (pattern, reports)
}
