//! Tests of the factorisation: planted solutions, and another solver's.

use super::super::cholesky::CholeskyPattern;
use super::super::examples::{Random, Structure, clique, grid, structures};
use super::*;

/// A random positive definite matrix of a structure: a sum of `G^T G` over its couplings, and a diagonal.
struct Example {
    structure: Structure,
    /// Entries `(row, column, value)` of the lower triangle, by unknowns; several may share a place.
    entries: Vec<(usize, usize, f64)>,
}

impl Example {
    fn new(structure: Structure) -> Self {
        let mut random = Random(7);
        let n = structure.places.len();
        let mut entries: Vec<_> = (0..n).map(|i| (i, i, 1.0 + random.number().abs())).collect();
        for coupling in &structure.couplings {
            let rows: Vec<Vec<f64>> =
                (0..2).map(|_| coupling.iter().map(|_| random.number()).collect()).collect();
            for (i, &u) in coupling.iter().enumerate() {
                for (j, &v) in coupling[..=i].iter().enumerate() {
                    let product = rows.iter().map(|row| row[i] * row[j]).sum();
                    entries.push((u.max(v) as usize, u.min(v) as usize, product));
                }
            }
        }
        Self { structure, entries }
    }

    fn analysed(&self) -> (Pattern, Vec<f64>) {
        let pattern = Pattern::new(&self.structure.places, &self.structure.cliques());
        let mut values = vec![0.0; pattern.entries()];
        for &(u, v, value) in &self.entries {
            let [u, v] = [u, v].map(|w| pattern.fronts.position[w]);
            values[pattern.slot(u.max(v), u.min(v))] += value;
        }
        (pattern, values)
    }

    /// The matrix plus `shift` on its diagonal, times a vector.
    fn product(&self, shift: f64, x: &[f64]) -> Vec<f64> {
        let mut product: Vec<f64> = x.iter().map(|value| shift * value).collect();
        for &(u, v, value) in &self.entries {
            product[u] += value * x[v];
            if u != v {
                product[v] += value * x[u];
            }
        }
        product
    }

    /// The solution of another solver.
    fn peer(&self, shift: f64, rhs: &[f64]) -> Vec<f64> {
        let pattern = CholeskyPattern::new(rhs.len(), self.entries.iter().map(|&(u, v, _)| (u, v)));
        let mut values = vec![0.0; pattern.entries()];
        self.entries.iter().for_each(|&(u, v, value)| values[pattern.slot(u, v)] += value);
        (0..rhs.len()).for_each(|i| values[pattern.diagonal(i)] += shift);
        let mut solution = rhs.to_vec();
        pattern.factor(&values).expect("positive definite").solve_in_place(&mut solution);
        solution
    }

    fn planted(&self) -> Vec<f64> {
        let mut random = Random(11);
        self.structure.places.iter().map(|_| random.number()).collect()
    }
}

fn difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn finds_planted_solutions_and_those_of_another_solver() {
    for (structure, shift) in structures().into_iter().zip([0.0, 0.3].into_iter().cycle()) {
        let example = Example::new(structure);
        let (pattern, values) = example.analysed();
        let planted = example.planted();
        let rhs = example.product(shift, &planted);
        let mut factor = Factor::<f64>::default();
        // Twice: memory that was used before must not matter.
        for _ in 0..2 {
            let mut found = rhs.clone();
            assert!(factor.factorise(&pattern, &values, shift), "{}", example.structure.name);
            factor.solve(&pattern, &mut found);
            // Eigenvalues lie between 1 and a few hundred: three digits of room.
            assert!(difference(&found, &planted) < 1e-11, "{}", example.structure.name);
            if !rhs.is_empty() {
                let peer = example.peer(shift, &rhs);
                assert!(difference(&found, &peer) < 1e-11, "{}", example.structure.name);
            }
        }
    }
}

#[test]
fn single_precision_is_right_to_its_digits() {
    for structure in structures().into_iter().filter(|structure| structure.places.len() > 1) {
        let example = Example::new(structure);
        let (pattern, values) = example.analysed();
        let planted = example.planted();
        let mut found = example.product(0.0, &planted);
        let mut factor = Factor::<f32>::default();
        assert!(factor.factorise(&pattern, &values, 0.0));
        factor.solve(&pattern, &mut found);
        let error = difference(&found, &planted);
        assert!((1e-9..1e-4).contains(&error), "{}: {error}", example.structure.name);
    }
}

#[test]
fn refuses_indefinite_and_not_finite() {
    let example = Example::new(grid(20, 2));
    let (pattern, values) = example.analysed();
    let sound = |values: &[f64], shift| {
        let double = Factor::<f64>::default().factorise(&pattern, values, shift);
        let single = Factor::<f32>::default().factorise(&pattern, values, shift);
        assert_eq!(double, single);
        double
    };
    let n = pattern.size();
    // In a subtree and in the fronts above, on the diagonal and beside it.
    assert!(pattern.fronts.tasks.len() > 2);
    let last = pattern.entries() - 1;
    for slot in [0, 1, pattern.diagonal(n / 2), pattern.diagonal(n / 2) + 1, last] {
        for value in [f64::NAN, f64::INFINITY, 1e300] {
            let mut spoilt = values.clone();
            spoilt[slot] = value;
            // Double precision may well hold a matrix with so large a number on its diagonal.
            let refused = !Factor::<f32>::default().factorise(&pattern, &spoilt, 0.0);
            assert!(refused, "{value} at {slot} in single precision");
            let refused = !Factor::<f64>::default().factorise(&pattern, &spoilt, 0.0);
            assert!(refused || value == 1e300, "{value} at {slot} in double precision");
        }
    }
    for column in [0, n / 2, n - 1] {
        let mut indefinite = values.clone();
        indefinite[pattern.diagonal(column)] = -1.0;
        assert!(!sound(&indefinite, 0.0), "{column}");
        assert!(sound(&indefinite, 100.0), "{column}");
    }
}

#[test]
fn numbers_do_not_depend_on_the_number_of_threads() {
    // Many tasks; and one front of several tiles.
    for example in [Example::new(grid(40, 2)), Example::new(clique(700))] {
        let (pattern, values) = example.analysed();
        let solutions = [1, 2, 3, 8].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut found = example.planted();
            pool.install(|| {
                let mut factor = Factor::<f64>::default();
                assert!(factor.factorise(&pattern, &values, 0.0));
                factor.solve(&pattern, &mut found);
            });
            found.iter().map(|value| value.to_bits()).collect::<Vec<u64>>()
        });
        assert!(solutions.iter().all(|solution| *solution == solutions[0]), "{}", example.structure.name);
    }
}
