//! The Levenberg-Marquardt method on sparse normal equations.
//!
//! Damping follows H. B. Nielsen, *Damping parameter in Marquardt's method* (1999): the damping `mu` is added
//! to the diagonal, and changes with the ratio of actual to predicted decrease. The number of attempts per
//! iteration is bounded, and an energy that is not finite never counts as progress.

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
    /// The energy at the start is not finite.
    NotFinite,
}

impl Termination {
    /// The reason in words.
    pub fn reason(self) -> &'static str {
        match self {
            Self::IterationLimit => "iteration limit",
            Self::Stagnation => "stagnation",
            Self::EnergyFloor => "energy floor reached",
            Self::NoDecrease => "no further decrease",
            Self::NotFinite => "energy not finite",
        }
    }
}

/// One line of the iteration table.
#[derive(Debug, Clone)]
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
#[derive(Debug, Clone)]
pub struct Report {
    /// Names of the terms, in order.
    pub terms: Vec<&'static str>,
    /// Energies at the start and after each accepted step.
    pub iterations: Vec<Iteration>,
    /// Why it stopped.
    pub termination: Termination,
}

/// Most attempts to find a decrease by raising the damping; 2^(1+2+..) grows past any scale by then.
const ATTEMPTS: usize = 12;

/// Minimises the weighted sum of squares, starting at and updating `x`.
///
/// `progress` is called with the iteration's number and total energy.
pub fn minimize(
    terms: &mut [Weighted],
    x: &mut [f64],
    options: &Options,
    progress: &mut dyn FnMut(usize, f64),
) -> Report {
    let names = terms.iter().map(|weighted| weighted.term.name()).collect();
    terms.iter_mut().for_each(|weighted| weighted.term.refresh(x));
    let mut equations = NormalEquations::new(x.len(), terms);
    let mut current = weigh(equations.assemble(terms, x), terms);
    let mut iterations = vec![Iteration { energies: current.clone(), damping: 0.0 }];
    if !total(&current).is_finite() {
        return Report { terms: names, iterations, termination: Termination::NotFinite };
    }
    let mut mu = options.damping;
    let mut termination = Termination::IterationLimit;
    while iterations.len() <= options.iterations {
        if total(&current) <= options.energy_floor {
            termination = Termination::EnergyFloor;
            break;
        }
        let Some(step) = find_step(&mut equations, terms, x, total(&current), mu, options) else {
            termination = Termination::NoDecrease;
            break;
        };
        x.copy_from_slice(&step.x);
        mu = step.next_damping;
        terms.iter_mut().for_each(|weighted| weighted.term.refresh(x));
        let before = total(&current);
        current = weigh(equations.assemble(terms, x), terms);
        progress(iterations.len(), total(&current));
        iterations.push(Iteration { energies: current.clone(), damping: step.damping });
        if before - total(&current) < options.energy_tolerance * before {
            termination = Termination::Stagnation;
            break;
        }
    }
    Report { terms: names, iterations, termination }
}

struct Step {
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
) -> Option<Step> {
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
                return Some(Step { x: candidate, damping, next_damping: damping * factor });
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
        let report = minimize(&mut terms, &mut x, &options, &mut |_, _| ());
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
        let report = minimize(&mut terms, &mut x, &Options::default(), &mut |_, _| ());
        assert_eq!(report.termination, Termination::NotFinite);
        assert_eq!(report.iterations.len(), 1);
    }
}
