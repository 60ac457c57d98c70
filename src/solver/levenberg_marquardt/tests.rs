//! Tests of the method.

use super::super::{Coupling, Term};
use super::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Minimises a term alone, unwatched.
fn minimize(term: impl Term + 'static, x: &mut [f64], options: &Options) -> Report {
    let mut terms = [Weighted { term: Box::new(term), weight: 1.0, coupling: Coupling::Full }];
    let places = (0..x.len()).map(|i| [(i / 2) as f64, 0.0]).collect();
    System::new(places).minimize(&mut terms, x, options, &mut |_: &Step| ControlFlow::Continue(()))
}

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
    let report = minimize(term, &mut x, &options);
    assert_eq!(report.termination, Termination::EnergyFloor);
    // The start's energy is 24.2 per pair (the published value).
    assert!((report.iterations[0].total() - 20.0 * 24.2).abs() < 1e-9);
    assert!(x.iter().all(|value| (value - 1.0).abs() < 1e-10));
    assert!(report.iterations.windows(2).all(|pair| pair[1].total() < pair[0].total()));
}

#[test]
fn not_finite_is_no_progress() {
    let mut x = vec![f64::NAN, 1.0];
    let report = minimize(Rosenbrock(vec![[0, 1]]), &mut x, &Options::default());
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
    let options = Options { energy_floor: 1e-24, ..Options::default() };
    let report = minimize(Logarithm, &mut x, &options);
    assert_eq!(report.termination, Termination::EnergyFloor);
    assert!((x[0] - 1.0).abs() < 1e-11, "{}", x[0]);
    assert!(report.iterations.iter().all(|iteration| iteration.total().is_finite()));
    assert!(report.iterations[1].damping > Options::default().damping, "no step was refused");
}

/// Finite at one place only, or until it is refreshed a second time.
struct Trap {
    place: Option<f64>,
    refreshed: usize,
    evaluated: Arc<AtomicUsize>,
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
        self.evaluated.fetch_add(1, Ordering::Relaxed);
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
        let evaluated = Arc::default();
        let term = Trap { place, refreshed: 0, evaluated: Arc::clone(&evaluated) };
        let mut x = vec![3.0];
        let report = minimize(term, &mut x, &Options::default());
        assert_eq!((report.termination, x[0], report.iterations.len()), (reason, 3.0, 1));
        assert!(evaluated.load(Ordering::Relaxed) <= 1 + ATTEMPTS);
    }
}

/// A term that must be left alone.
struct Untouchable;

impl Term for Untouchable {
    fn name(&self) -> &'static str {
        "untouchable"
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
    fn evaluate(&self, _: usize, _: &[f64], _: &mut [f64], _: &mut [f64]) {
        panic!("a term of weight 0 is evaluated");
    }
    fn refresh(&mut self, _: &[f64]) {
        panic!("a term of weight 0 is refreshed");
    }
}

#[test]
fn terms_of_weight_zero_are_skipped_and_not_reported() {
    for coupling in [Coupling::Full, Coupling::ByPlace] {
        let rosenbrock = || Weighted { term: Box::new(Rosenbrock(vec![[0, 1]])), weight: 2.0, coupling };
        let idle = || Weighted { term: Box::new(Untouchable), weight: 0.0, coupling };
        let options = Options { iterations: 100, energy_floor: 1e-24, ..Options::default() };
        let [alone, before, after] =
            [vec![rosenbrock()], vec![idle(), rosenbrock()], vec![rosenbrock(), idle()]].map(|mut terms| {
                let mut x = vec![-1.2, 1.0];
                let watch = &mut |step: &Step| {
                    assert_eq!((step.terms.len(), step.energies.len()), (1, 1));
                    ControlFlow::Continue(())
                };
                let mut system = System::new(vec![[0.0; 2]; 2]);
                (system.minimize(&mut terms, &mut x, &options, watch), x)
            });
        assert_eq!(alone.0.terms, ["rosenbrock"]);
        assert_eq!(alone.0.termination, Termination::EnergyFloor);
        assert!(before == alone && after == alone);
    }
}
