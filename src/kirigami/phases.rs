//! Stage 3 as a sequence of minimisations with other weights.

use crate::solver::{Options, Precision, Report, Run, Step, Termination};

/// A run of steps with the same weights.
#[derive(Debug, Clone, PartialEq)]
pub struct Phase {
    /// Factor of closeness, boundary and shape; 0 where pieces alone count.
    pub soft: f64,
    /// Factor of fairness.
    pub fair: f64,
    /// When to stop.
    pub options: Options,
}

/// Beyond this number of pieces steps are made cheaper than they could be.
pub(super) const MANY: usize = 5_000;

/// Precision of the factors of soft steps. Single halves time and memory and converges as well, since residuals and
/// gradient stay double; but rounding of the target's coordinates then shows in the fourth digit of what isometry leaves
/// free, which few pieces are spared.
pub fn soft_precision(pieces: usize) -> Precision {
    if pieces > MANY { Precision::Single } else { Precision::Double }
}

/// The hard phase stops at this sum of squared residuals: relative length errors near 1e-15 for a few
/// thousand pieces.
const HARD_FLOOR: f64 = 1e-28;

/// The last phase: what pieces must keep, alone.
pub fn hard() -> Phase {
    let options = Options {
        iterations: 20,
        energy_tolerance: 0.5,
        energy_floor: HARD_FLOOR,
        damping: 1e-6,
        ..Options::default()
    };
    Phase { soft: 0.0, fair: 0.0, options }
}

/// Most steps of all phases together.
pub fn most_steps(phases: &[Phase]) -> usize {
    phases.iter().map(|phase| phase.options.iterations).sum()
}

/// Runs phases one after the other and returns their reports. Where one is interrupted those that follow are left out.
pub fn run_phases(
    phases: &[Phase],
    run: &mut Run,
    mut minimise: impl FnMut(&Phase, &mut Run) -> Report,
) -> Vec<Report> {
    let mut reports = Vec::new();
    for (number, phase) in phases.iter().enumerate() {
        let later = most_steps(&phases[number + 1..]);
        let watch = &mut |step: &Step| (run.watch)(&Step { phase: number, later, ..*step });
        let report = minimise(phase, &mut Run { journal: run.journal, watch });
        let interrupted = report.termination == Termination::Interrupted;
        reports.push(report);
        if interrupted {
            break;
        }
    }
    reports
}
