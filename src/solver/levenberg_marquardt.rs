//! The Levenberg-Marquardt method on sparse normal equations.
//!
//! Damping follows H. B. Nielsen, *Damping parameter in Marquardt's method* (1999): the damping `mu` is added
//! to the diagonal, and changes with the ratio of actual to predicted decrease. The number of attempts per
//! iteration is bounded, and an energy that is not finite never counts as progress.
//!
//! A [`Report`] and the point it belongs to are the whole state of a minimisation: [`go_on`] continues an
//! interrupted one with the very same steps.

use std::ops::ControlFlow;

use super::Weighted;
use super::normal_equations::NormalEquations;

/// When to stop and how to damp.
#[derive(Debug, Clone)]
pub struct Options {
    /// Most accepted steps.
    pub iterations: usize,
    /// First damping, relative to the largest diagonal entry of `J^T W J`.
    pub damping: f64,
    /// Least damping, relative likewise. It makes the system definite where the problem leaves freedom.
    pub least_damping: f64,
    /// Stop when a step lowers the energy by less than this fraction.
    pub energy_tolerance: f64,
    /// Stop when the energy is at most this.
    pub energy_floor: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            iterations: 20,
            damping: 1e-4,
            least_damping: 1e-11,
            energy_tolerance: 1e-4,
            energy_floor: 0.0,
        }
    }
}

/// Why the method stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Termination {
    /// The asked number of steps was made.
    IterationLimit,
    /// The energy no longer falls by more than the tolerance.
    Stagnation,
    /// The energy fell to the floor.
    EnergyFloor,
    /// No damping gave a lower energy: a minimum to rounding accuracy.
    NoDecrease,
    /// The energy is not finite at the start, or where terms are refreshed; the point is the last good one.
    NotFinite,
    /// The watch asked to stop. The point is the best one so far.
    Interrupted,
}

impl Termination {
    /// All reasons.
    pub const ALL: [Self; 6] = [
        Self::IterationLimit,
        Self::Stagnation,
        Self::EnergyFloor,
        Self::NoDecrease,
        Self::NotFinite,
        Self::Interrupted,
    ];

    /// The reason in words.
    pub fn reason(self) -> &'static str {
        match self {
            Self::IterationLimit => "iteration limit",
            Self::Stagnation => "stagnation",
            Self::EnergyFloor => "energy floor reached",
            Self::NoDecrease => "no further decrease",
            Self::NotFinite => "energy not finite",
            Self::Interrupted => "interrupted",
        }
    }
}

/// One line of the iteration table.
#[derive(Debug, Clone, PartialEq)]
pub struct Iteration {
    /// Sum of squared residuals of each term, times the term's weight.
    pub energies: Vec<f64>,
    /// Damping with which the step to this point was made.
    pub damping: f64,
}

impl Iteration {
    /// The total energy.
    pub fn total(&self) -> f64 {
        self.energies.iter().sum()
    }
}

/// What the method did.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Names of the terms, in order.
    pub terms: Vec<String>,
    /// Energies at the start and after each accepted step.
    pub iterations: Vec<Iteration>,
    /// Damping that the next step would begin with.
    pub next_damping: f64,
    /// Why it stopped.
    pub termination: Termination,
}

/// Most attempts to find a decrease by raising the damping; 2^(1+2+..) grows past any scale by then.
const ATTEMPTS: usize = 12;

/// Where a minimisation stands: what its watch is told at the start and after each accepted step.
#[derive(Debug, Clone, Copy)]
pub struct Step<'a> {
    /// Which of several minimisations in a row it is, from 0; set by those who run them.
    pub phase: usize,
    /// Accepted steps so far.
    pub iteration: usize,
    /// Most accepted steps.
    pub limit: usize,
    /// Most steps of the minimisations that follow; set by those who run them.
    pub later: usize,
    /// Names of the terms.
    pub terms: &'a [String],
    /// Energy of each term, with its weight.
    pub energies: &'a [f64],
}

/// Follows a minimisation, and may break it off between two steps.
pub type Watch<'a> = dyn FnMut(&Step) -> ControlFlow<()> + 'a;

/// Minimises the weighted sum of squares, starting at and updating `x`.
pub fn minimize(terms: &mut [Weighted], x: &mut [f64], options: &Options, watch: &mut Watch) -> Report {
    let report = Report {
        terms: terms.iter().map(|weighted| weighted.term.name().to_owned()).collect(),
        iterations: Vec::new(),
        next_damping: options.damping,
        termination: Termination::Interrupted,
    };
    go_on(terms, x, report, options, watch)
}

/// Goes on from where `report` ended at `x`, as if it had not been interrupted. The problem and the options must
/// be the same.
pub fn go_on(
    terms: &mut [Weighted],
    x: &mut [f64],
    mut report: Report,
    options: &Options,
    watch: &mut Watch,
) -> Report {
    terms.iter_mut().for_each(|weighted| weighted.term.refresh(x));
    let mut equations = NormalEquations::new(x.len(), terms);
    let mut current = weigh(equations.assemble(terms, x), terms);
    if report.iterations.is_empty() {
        report.iterations.push(Iteration { energies: current.clone(), damping: 0.0 });
    }
    report.termination = loop {
        let step = Step {
            phase: 0,
            iteration: report.iterations.len() - 1,
            limit: options.iterations,
            later: 0,
            terms: &report.terms,
            energies: &current,
        };
        if watch(&step).is_break() {
            break Termination::Interrupted;
        }
        if let Some(reason) = reason_to_stop(&report.iterations, options) {
            break reason;
        }
        let found = find_step(&mut equations, terms, x, total(&current), report.next_damping, options);
        let Some(mut step) = found else { break Termination::NoDecrease };
        x.swap_with_slice(&mut step.x);
        terms.iter_mut().for_each(|weighted| weighted.term.refresh(x));
        current = weigh(equations.assemble(terms, x), terms);
        if !total(&current).is_finite() {
            x.copy_from_slice(&step.x);
            break Termination::NotFinite;
        }
        report.next_damping = step.next_damping;
        report.iterations.push(Iteration { energies: current.clone(), damping: step.damping });
    };
    report
}

/// Whether the steps so far are enough. It depends on nothing else, so that a continued minimisation ends where
/// an uninterrupted one does.
fn reason_to_stop(iterations: &[Iteration], options: &Options) -> Option<Termination> {
    let (last, steps) = (iterations.last()?.total(), iterations.len() - 1);
    let before = (steps > 0).then(|| iterations[steps - 1].total());
    if !last.is_finite() {
        Some(Termination::NotFinite)
    } else if before.is_some_and(|before| before - last < options.energy_tolerance * before) {
        Some(Termination::Stagnation)
    } else if steps >= options.iterations {
        Some(Termination::IterationLimit)
    } else if last <= options.energy_floor {
        Some(Termination::EnergyFloor)
    } else {
        None
    }
}

struct Found {
    x: Vec<f64>,
    damping: f64,
    next_damping: f64,
}

/// Raises the damping until a step lowers the energy.
fn find_step(
    equations: &mut NormalEquations,
    terms: &[Weighted],
    x: &[f64],
    energy: f64,
    mut mu: f64,
    options: &Options,
) -> Option<Found> {
    let n = x.len();
    let scale = (0..n).map(|i| equations.values[equations.pattern.diagonal(i)]).fold(0.0, f64::max);
    let mut raise = 2.0;
    for _ in 0..ATTEMPTS {
        let damping = mu.max(options.least_damping);
        let mut damped = equations.values.clone();
        (0..n).for_each(|i| damped[equations.pattern.diagonal(i)] += damping * scale);
        if let Some(factor) = equations.pattern.factor(&damped) {
            let mut step: Vec<f64> = equations.gradient.iter().map(|g| -g).collect();
            factor.solve_in_place(&mut step);
            let predicted: f64 =
                step.iter().zip(&equations.gradient).map(|(s, g)| s * (damping * scale * s - g)).sum();
            let candidate: Vec<f64> = x.iter().zip(&step).map(|(a, b)| a + b).collect();
            let reached = total(&weigh(equations.sums_of_squares(terms, &candidate), terms));
            let gain = (energy - reached) / predicted;
            if reached.is_finite() && reached < energy && gain > 1e-3 {
                let factor = (1.0 - (2.0 * gain - 1.0).powi(3)).max(1.0 / 10.0);
                return Some(Found { x: candidate, damping, next_damping: damping * factor });
            }
        }
        mu = damping * raise;
        raise *= 2.0;
    }
    None
}

fn weigh(sums: Vec<f64>, terms: &[Weighted]) -> Vec<f64> {
    sums.iter().zip(terms).map(|(sum, weighted)| sum * weighted.weight).collect()
}

fn total(energies: &[f64]) -> f64 {
    energies.iter().sum()
}

#[cfg(test)]
mod tests {
    use super::super::Term;
    use super::*;

    /// Rosenbrock's valley as residuals (Moré, Garbow, Hillstrom 1981, problem 1), one block per pair.
    struct Rosenbrock(Vec<[usize; 2]>);

    impl Term for Rosenbrock {
        fn name(&self) -> &'static str {
            "rosenbrock"
        }
        fn blocks(&self) -> usize {
            self.0.len()
        }
        fn rows(&self, _: usize) -> usize {
            2
        }
        fn unknowns(&self, b: usize) -> &[usize] {
            &self.0[b]
        }
        fn evaluate(&self, b: usize, x: &[f64], residuals: &mut [f64], jacobian: &mut [f64]) {
            let [i, j] = self.0[b];
            residuals.copy_from_slice(&[10.0 * (x[j] - x[i] * x[i]), 1.0 - x[i]]);
            jacobian.copy_from_slice(&[-20.0 * x[i], 10.0, -1.0, 0.0]);
        }
    }

    #[test]
    fn finds_rosenbrocks_minimum() {
        let term = Rosenbrock((0..20).map(|i| [2 * i, 2 * i + 1]).collect());
        let mut x: Vec<f64> = (0..20).flat_map(|_| [-1.2, 1.0]).collect();
        let options = Options { iterations: 100, energy_floor: 1e-24, ..Options::default() };
        let mut terms = [Weighted { term: Box::new(term), weight: 1.0 }];
        let report = minimize(&mut terms, &mut x, &options, &mut |_: &Step| ControlFlow::Continue(()));
        assert_eq!(report.termination, Termination::EnergyFloor);
        // The start's energy is 24.2 per pair (the published value).
        assert!((report.iterations[0].total() - 20.0 * 24.2).abs() < 1e-9);
        assert!(x.iter().all(|value| (value - 1.0).abs() < 1e-10));
        assert!(report.iterations.windows(2).all(|pair| pair[1].total() < pair[0].total()));
    }

    #[test]
    fn not_finite_is_no_progress() {
        let mut x = vec![f64::NAN, 1.0];
        let mut terms = [Weighted { term: Box::new(Rosenbrock(vec![[0, 1]])), weight: 1.0 }];
        let report =
            minimize(&mut terms, &mut x, &Options::default(), &mut |_: &Step| ControlFlow::Continue(()));
        assert_eq!(report.termination, Termination::NotFinite);
        assert_eq!(report.iterations.len(), 1);
    }

    /// One unknown that only positive numbers suit: the logarithm's square, least at 1.
    struct Logarithm;

    impl Term for Logarithm {
        fn name(&self) -> &'static str {
            "logarithm"
        }
        fn blocks(&self) -> usize {
            1
        }
        fn rows(&self, _: usize) -> usize {
            1
        }
        fn unknowns(&self, _: usize) -> &[usize] {
            &[0]
        }
        fn evaluate(&self, _: usize, x: &[f64], residuals: &mut [f64], jacobian: &mut [f64]) {
            residuals[0] = x[0].ln();
            jacobian[0] = 1.0 / x[0];
        }
    }

    #[test]
    fn a_step_into_not_finite_is_refused_and_damped() {
        // The undamped step from 5 leads to 5 - 5 ln 5 < 0, where there is no logarithm.
        let mut x = vec![5.0];
        let mut terms = [Weighted { term: Box::new(Logarithm), weight: 1.0 }];
        let options = Options { energy_floor: 1e-24, ..Options::default() };
        let report = minimize(&mut terms, &mut x, &options, &mut |_: &Step| ControlFlow::Continue(()));
        assert_eq!(report.termination, Termination::EnergyFloor);
        assert!((x[0] - 1.0).abs() < 1e-11, "{}", x[0]);
        assert!(report.iterations.iter().all(|iteration| iteration.total().is_finite()));
        assert!(report.iterations[1].damping > Options::default().damping, "no step was refused");
    }

    /// Finite at one place only, or until it is refreshed a second time.
    struct Trap {
        place: Option<f64>,
        refreshed: usize,
        evaluated: std::rc::Rc<std::cell::Cell<usize>>,
    }

    impl Term for Trap {
        fn name(&self) -> &'static str {
            "trap"
        }
        fn blocks(&self) -> usize {
            1
        }
        fn rows(&self, _: usize) -> usize {
            1
        }
        fn unknowns(&self, _: usize) -> &[usize] {
            &[0]
        }
        fn evaluate(&self, _: usize, x: &[f64], residuals: &mut [f64], jacobian: &mut [f64]) {
            self.evaluated.set(self.evaluated.get() + 1);
            let good = self.place.map_or(self.refreshed < 2, |place| x[0] == place);
            residuals[0] = if good { x[0] } else { f64::NAN };
            jacobian[0] = 1.0;
        }
        fn refresh(&mut self, _: &[f64]) {
            self.refreshed += 1;
        }
    }

    #[test]
    fn damping_ends_and_not_finite_is_taken_back() {
        for (place, reason) in [(Some(3.0), Termination::NoDecrease), (None, Termination::NotFinite)] {
            let evaluated = std::rc::Rc::default();
            let term = Trap { place, refreshed: 0, evaluated: std::rc::Rc::clone(&evaluated) };
            let mut terms = [Weighted { term: Box::new(term), weight: 1.0 }];
            let mut x = vec![3.0];
            let report =
                minimize(&mut terms, &mut x, &Options::default(), &mut |_: &Step| ControlFlow::Continue(()));
            assert_eq!((report.termination, x[0], report.iterations.len()), (reason, 3.0, 1));
            assert!(evaluated.get() <= 1 + ATTEMPTS);
        }
    }
}
