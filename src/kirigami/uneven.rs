//! Hinge points that stand apart by what each of them needs: the last step of the optimisation.
//!
//! Stages 2 and 3 know one gap for all corners. What a hinge needs depends on its own angle and axis, which are known
//! only then; it differs little from the common gap. So the points are moved there, and the pieces are made congruent
//! again, with nothing else to decide. Angles and axes change by less still: two rounds settle it.

use super::control_mesh::Goals;
use super::cover::Cover;
use super::pattern::{Pattern, Unknowns};
use super::pattern_terms::hard_terms;
use super::stage3::Regime;
use crate::solver::{Report, Run, Step, System, Termination};

/// Rounds in which the hinge points follow the angles and axes that they change.
const ROUNDS: usize = 2;

/// Moves the hinge points of a pattern across the slits that pass them and makes its pieces congruent again.
///
/// `gap`: of all corners, millimetres. `halves`: for a pattern the distance of each hinge point from its corner's
/// midpoint where one slit passes there, millimetres, in the order of the inner edges.
pub fn settle(
    cover: &Cover,
    goals: &Goals,
    (mut pattern, gap): (Pattern, f64),
    halves: impl Fn(&Pattern) -> Vec<f64>,
    run: &mut Run,
) -> (Pattern, Vec<Report>) {
    let mesh = &cover.mesh;
    let scale = cover.cell.edge();
    let at = Unknowns::new(mesh, goals);
    let mut system = System::new(at.places(cover));
    let hard = Regime::from_model().phases.pop().expect("it ends with the hard phase").options;
    let mut reports = Vec::new();
    for round in 0..ROUNDS {
        let halves = halves(&pattern);
        pattern.spread_offsets(mesh, gap, &halves);
        let later = (ROUNDS - 1 - round) * hard.iterations;
        let watch = &mut |step: &Step| (run.watch)(&Step { phase: round, later, ..*step });
        let mut x = at.pack(&pattern, scale);
        let terms = || hard_terms(mesh, &at, &pattern, scale);
        let report = run.journal.minimize("uneven-gaps", &mut system, terms, &mut x, &hard, watch);
        at.unpack(&x, scale, &mut pattern);
        let interrupted = report.termination == Termination::Interrupted;
        reports.push(report);
        if interrupted {
            break;
        }
    }
    (pattern, reports)
}
