//! Tests of the assembly against dense matrices.

use super::super::Term;
use super::super::examples::{Random, grid};
use super::*;
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// Random linear residuals `J x + c` over blocks of unknowns.
struct Linear {
    blocks: Vec<Vec<usize>>,
    rows: usize,
    /// Per block its Jacobian, row after row, and its constants.
    numbers: Vec<(Vec<f64>, Vec<f64>)>,
}

impl Linear {
    fn new(blocks: Vec<Vec<usize>>, rows: usize, random: &mut Random) -> Self {
        let mut draw = |count: usize| (0..count).map(|_| random.number()).collect();
        let numbers = blocks.iter().map(|block| (draw(rows * block.len()), draw(rows))).collect();
        Self { blocks, rows, numbers }
    }

    /// The whole Jacobian and the residuals at `x`.
    fn dense(&self, x: &DVector<f64>) -> (DMatrix<f64>, DVector<f64>) {
        let mut jacobian = DMatrix::zeros(self.rows * self.blocks.len(), x.len());
        let mut constants = DVector::zeros(jacobian.nrows());
        for (b, (block, (slopes, offsets))) in self.blocks.iter().zip(&self.numbers).enumerate() {
            for row in 0..self.rows {
                constants[b * self.rows + row] = offsets[row];
                for (i, &unknown) in block.iter().enumerate() {
                    jacobian[(b * self.rows + row, unknown)] = slopes[row * block.len() + i];
                }
            }
        }
        let residuals = &jacobian * x + constants;
        (jacobian, residuals)
    }
}

impl Term for &Linear {
    fn name(&self) -> &'static str {
        "linear"
    }
    fn blocks(&self) -> usize {
        self.blocks.len()
    }
    fn rows(&self, _: usize) -> usize {
        self.rows
    }
    fn unknowns(&self, b: usize) -> &[usize] {
        &self.blocks[b]
    }
    fn evaluate(&self, b: usize, x: &[f64], residuals: &mut [f64], jacobian: &mut [f64]) {
        let (slopes, offsets) = &self.numbers[b];
        jacobian.copy_from_slice(slopes);
        for (row, residual) in residuals.iter_mut().enumerate() {
            let slopes = slopes[row * self.blocks[b].len()..].iter();
            *residual = offsets[row] + slopes.zip(&self.blocks[b]).map(|(s, &u)| s * x[u]).sum::<f64>();
        }
    }
}

/// The assembled matrix by unknowns.
fn dense(equations: &NormalEquations) -> DMatrix<f64> {
    let pattern = &equations.pattern;
    let n = pattern.size();
    let mut matrix = DMatrix::zeros(n, n);
    for column in 0..n {
        let values = &equations.values[pattern.diagonal(column)..];
        for (&row, value) in pattern.column(column).iter().zip(values) {
            let [u, v] = [row as usize, column].map(|position| pattern.fronts.order[position] as usize);
            matrix[(u, v)] = *value;
            matrix[(v, u)] = *value;
        }
    }
    matrix
}

/// A grid with terms of small and large blocks on it; several unknowns to a point.
fn problem(points: usize) -> (Vec<[f64; 2]>, Linear, Linear) {
    let mut random = Random(17);
    let structure = grid(points, 3);
    let cells = structure.couplings.iter().map(|c| c.iter().map(|&u| u as usize).collect()).collect();
    // Parts of two points, and a block that is all at one point.
    let point = |p: usize| 3 * p..3 * p + 3;
    let pairs = (1..points * points).map(|p| point(p - 1).skip(1).chain(point(p)).collect());
    let pairs = pairs.chain([point(0).collect()]).collect();
    let cells = Linear::new(cells, 2, &mut random);
    let pairs = Linear::new(pairs, 4, &mut random);
    (structure.places, cells, pairs)
}

fn weighted(term: &Linear, weight: f64, coupling: Coupling) -> Weighted<'_> {
    Weighted { term: Box::new(term), weight, coupling }
}

#[test]
fn assembles_the_dense_products() {
    let (places, cells, pairs) = problem(9);
    let terms = [weighted(&cells, 0.7, Coupling::Full), weighted(&pairs, 3.0, Coupling::Full)];
    let mut equations = NormalEquations::new(&places, &terms);
    let mut random = Random(23);
    for _ in 0..2 {
        let x = DVector::from_fn(places.len(), |_, _| random.number());
        let sums = equations.assemble(&terms, x.as_slice());
        let [(j, r), (k, s)] = [&cells, &pairs].map(|term| term.dense(&x));
        let matrix = 0.7 * j.transpose() * &j + 3.0 * k.transpose() * &k;
        let gradient = 0.7 * j.transpose() * &r + 3.0 * k.transpose() * &s;
        assert!((dense(&equations) - &matrix).amax() < 1e-13 * matrix.amax());
        let found = DVector::from_column_slice(&equations.gradient);
        assert!((found - &gradient).amax() < 1e-13 * gradient.amax());
        let exact = [r.norm_squared(), s.norm_squared()];
        assert!(sums.iter().zip(exact).all(|(sum, exact)| (sum - exact).abs() < 1e-12 * exact));
        assert_eq!(equations.sums_of_squares(&terms, x.as_slice()), sums);
    }
}

#[test]
fn coupling_by_place_bounds_the_full_matrix_and_keeps_the_gradient() {
    let (places, cells, pairs) = problem(6);
    let n = places.len();
    let mut random = Random(29);
    let x: Vec<f64> = (0..n).map(|_| random.number()).collect();
    let [full, by_place] = [Coupling::Full, Coupling::ByPlace].map(|coupling| {
        let terms = [weighted(&cells, 0.7, coupling), weighted(&pairs, 3.0, coupling)];
        let mut equations = NormalEquations::new(&places, &terms);
        let sums = equations.assemble(&terms, &x);
        (dense(&equations), equations.gradient, sums, equations.pattern.entries())
    });
    let gradient = by_place.1.iter().zip(&full.1).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(gradient < 1e-13 * full.1.iter().fold(0.0, |most: f64, g| most.max(g.abs())));
    let sums = by_place.2.iter().zip(&full.2).all(|(a, b)| (a - b).abs() < 1e-13 * b);
    assert!(sums, "{:?} {:?}", by_place.2, full.2);
    let eigenvalues = SymmetricEigen::new(&by_place.0 - &full.0).eigenvalues;
    assert!(eigenvalues.min() > -1e-12 * eigenvalues.max(), "{eigenvalues}");
    // The bound is one: where a block is all at one place nothing is added, elsewhere something is.
    assert!(eigenvalues.max() > 0.1 * full.0.amax());
    // Points are coupled with themselves alone.
    assert_eq!(by_place.3, n / 3 * 6);
    assert!(full.3 > 3 * by_place.3);
    for u in 0..n {
        for v in (0..n).filter(|v| u / 3 != v / 3) {
            assert_eq!(by_place.0[(u, v)], 0.0);
        }
    }
}

#[test]
fn terms_without_weight_leave_their_entries_zero() {
    let (places, cells, pairs) = problem(5);
    let both = [weighted(&cells, 0.0, Coupling::Full), weighted(&pairs, 3.0, Coupling::Full)];
    let alone = [weighted(&pairs, 3.0, Coupling::Full)];
    let x = vec![0.3; places.len()];
    let [(with, with_sums), (without, without_sums)] = [&both[..], &alone[..]].map(|terms| {
        let mut equations = NormalEquations::new(&places, terms);
        let sums = equations.assemble(terms, &x);
        assert_eq!(equations.sums_of_squares(terms, &x), sums);
        (equations, sums)
    });
    assert_eq!((with_sums[0], with_sums.len(), without_sums.len()), (0.0, 2, 1));
    assert!((with_sums[1] - without_sums[0]).abs() < 1e-13 * without_sums[0]);
    let difference = dense(&with) - dense(&without);
    assert!(difference.amax() < 1e-13 * dense(&without).amax());
    assert!(with.pattern.entries() > without.pattern.entries());
}

#[test]
fn sums_do_not_depend_on_the_number_of_threads() {
    let (places, cells, pairs) = problem(30);
    let x: Vec<f64> = (0..places.len()).map(|i| (i as f64).sin()).collect();
    for coupling in [Coupling::Full, Coupling::ByPlace] {
        let terms = [weighted(&cells, 0.7, coupling), weighted(&pairs, 3.0, Coupling::Full)];
        let mut equations = NormalEquations::new(&places, &terms);
        assert!(equations.pattern.fronts.tasks.len() > 3);
        let [one, two, three] = [1, 2, 3].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let sums = pool.install(|| equations.assemble(&terms, &x));
            let numbers = equations.values.iter().chain(&equations.gradient).chain(&sums);
            numbers.map(|number| number.to_bits()).collect::<Vec<u64>>()
        });
        assert!(two == one && three == one, "{coupling:?}");
    }
}
