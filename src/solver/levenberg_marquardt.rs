//! The Levenberg-Marquardt method on sparse normal equations.
//!
//! Damping follows H. B. Nielsen, *Damping parameter in Marquardt's method* (1999): the damping `mu` is added
//! to the diagonal, and changes with the ratio of actual to predicted decrease. The number of attempts per
//! iteration is bounded, and an energy that is not finite never counts as progress.
//!
//! A [`Report`] and the point it belongs to are the whole state of a minimisation: [`System::go_on`] continues an
//! interrupted one with the very same steps.

use std::ops::ControlFlow;

use super::Weighted;
use super::multifrontal::Factor;
use super::normal_equations::NormalEquations;

/// When to stop and how to damp.
#[derive(Debug, Clone, PartialEq)]
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
    /// Precision of the factorisation.
    pub precision: Precision,
}

/// Precision of the factorisation. Residuals, matrix and gradient are always in double precision.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    /// Half the memory and nearly half the time; steps are right to some four digits.
    Single,
    /// Steps to rounding accuracy.
    Double,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            iterations: 20,
            damping: 1e-4,
            least_damping: 1e-11,
            energy_tolerance: 1e-4,
            energy_floor: 0.0,
            precision: Precision::Double,
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

/// A family of problems of the same structure: pattern, symbolic factorisation and working memory.
///
/// The structure is that of the terms that come first: which unknowns their blocks couple. Weights and constants of
/// those that follow may differ.
pub struct System {
    places: Vec<[f64; 2]>,
    equations: Option<NormalEquations>,
    single: Factor<f32>,
    double: Factor<f64>,
    step: Vec<f64>,
    candidate: Vec<f64>,
}

impl System {
    /// A system over unknowns at these places: one place in a plane for each, such that coupled unknowns lie near
    /// each other (see `solver::dissection`).
    pub fn new(places: Vec<[f64; 2]>) -> Self {
        let n = places.len();
        Self {
            places,
            equations: None,
            single: Factor::default(),
            double: Factor::default(),
            step: vec![0.0; n],
            candidate: vec![0.0; n],
        }
    }

    /// Minimises the weighted sum of squares, starting at and updating `x`.
    pub fn minimize(
        &mut self,
        terms: &mut [Weighted],
        x: &mut [f64],
        options: &Options,
        watch: &mut Watch,
    ) -> Report {
        let report = Report {
            terms: active(terms).map(|weighted| weighted.term.name().to_owned()).collect(),
            iterations: Vec::new(),
            next_damping: options.damping,
            termination: Termination::Interrupted,
        };
        self.go_on(terms, x, report, options, watch)
    }

    /// Goes on from where `report` ended at `x`, as if it had not been interrupted. The problem and the options must
    /// be the same.
    pub fn go_on(
        &mut self,
        terms: &mut [Weighted],
        x: &mut [f64],
        mut report: Report,
        options: &Options,
        watch: &mut Watch,
    ) -> Report {
        let Self { places, equations, single, double, step, candidate } = self;
        let equations = equations.get_or_insert_with(|| NormalEquations::new(places, terms));
        let mut search = Search { equations, single, double, step, candidate };
        refresh(terms, x);
        let mut current = weigh(search.equations.assemble(terms, x), terms);
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
            let found = search.find_step(terms, x, total(&current), report.next_damping, options);
            let Some(found) = found else { break Termination::NoDecrease };
            x.swap_with_slice(search.candidate);
            refresh(terms, x);
            current = weigh(search.equations.assemble(terms, x), terms);
            if !total(&current).is_finite() {
                x.copy_from_slice(search.candidate);
                break Termination::NotFinite;
            }
            report.next_damping = found.next_damping;
            report.iterations.push(Iteration { energies: current.clone(), damping: found.damping });
        };
        report
    }
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
    damping: f64,
    next_damping: f64,
}

/// The parts of a system that look for a step.
struct Search<'a> {
    equations: &'a mut NormalEquations,
    single: &'a mut Factor<f32>,
    double: &'a mut Factor<f64>,
    step: &'a mut [f64],
    candidate: &'a mut [f64],
}

impl Search<'_> {
    /// Raises the damping until a step, left in `candidate`, lowers the energy.
    fn find_step(
        &mut self,
        terms: &[Weighted],
        x: &[f64],
        energy: f64,
        mut mu: f64,
        options: &Options,
    ) -> Option<Found> {
        let diagonal = (0..x.len()).map(|i| self.equations.values[self.equations.pattern.diagonal(i)]);
        let scale = diagonal.fold(0.0, f64::max);
        let mut raise = 2.0;
        for _ in 0..ATTEMPTS {
            let damping = mu.max(options.least_damping);
            if self.solve(damping * scale, options.precision) {
                let gradient = &self.equations.gradient;
                let slopes = self.step.iter().zip(gradient);
                let predicted: f64 = slopes.map(|(s, g)| s * (damping * scale * s - g)).sum();
                let moved = x.iter().zip(&*self.step).map(|(a, b)| a + b);
                self.candidate.iter_mut().zip(moved).for_each(|(to, value)| *to = value);
                let reached = total(&weigh(self.equations.sums_of_squares(terms, self.candidate), terms));
                let gain = (energy - reached) / predicted;
                if reached.is_finite() && reached < energy && gain > 1e-3 {
                    let factor = (1.0 - (2.0 * gain - 1.0).powi(3)).max(1.0 / 10.0);
                    return Some(Found { damping, next_damping: damping * factor });
                }
            }
            mu = damping * raise;
            raise *= 2.0;
        }
        None
    }

    /// Solves for the step with this shift of the diagonal. False where the matrix is not positive definite.
    fn solve(&mut self, shift: f64, precision: Precision) -> bool {
        let NormalEquations { pattern, values, gradient, .. } = &*self.equations;
        self.step.iter_mut().zip(gradient).for_each(|(s, g)| *s = -g);
        match precision {
            Precision::Single => {
                let sound = self.single.factorise(pattern, values, shift);
                if sound {
                    self.single.solve(pattern, self.step);
                }
                sound
            }
            Precision::Double => {
                let sound = self.double.factorise(pattern, values, shift);
                if sound {
                    self.double.solve(pattern, self.step);
                }
                sound
            }
        }
    }
}

fn refresh(terms: &mut [Weighted], x: &[f64]) {
    terms.iter_mut().filter(|weighted| weighted.weight > 0.0).for_each(|weighted| weighted.term.refresh(x));
}

/// The terms that have a weight.
pub(super) fn active<'a, 'b>(terms: &'b [Weighted<'a>]) -> impl Iterator<Item = &'b Weighted<'a>> {
    terms.iter().filter(|weighted| weighted.weight > 0.0)
}

fn weigh(sums: Vec<f64>, terms: &[Weighted]) -> Vec<f64> {
    let weighted = sums.iter().zip(terms).filter(|(_, weighted)| weighted.weight > 0.0);
    weighted.map(|(sum, weighted)| sum * weighted.weight).collect()
}

fn total(energies: &[f64]) -> f64 {
    energies.iter().sum()
}

#[cfg(test)]
mod tests;
