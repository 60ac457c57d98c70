//! Assembly of the normal equations `J^T W J` and `J^T W r` into a fixed pattern.
//!
//! Blocks are dealt out to the tasks of the factorisation: a block belongs to the subtree that eliminates its
//! first unknown, so that tasks write to columns of their own and can run at the same time. What falls on
//! columns above the subtrees is kept apart and added in the order of the tasks.

use super::dissection::Cliques;
use super::multifrontal::Pattern;
use super::{Coupling, Weighted};
use rayon::prelude::*;
use std::ops::Range;

/// The fixed pattern of a problem's normal equations with the current values.
pub struct NormalEquations {
    /// Pattern and symbolic factorisation.
    pub pattern: Pattern,
    /// Values of the lower triangle of `J^T W J`, in the pattern's order.
    pub values: Vec<f64>,
    /// The gradient `J^T W r` (half the derivative of the energy), by unknowns.
    pub gradient: Vec<f64>,
    shares: Vec<Share>,
    by_position: Vec<f64>,
}

/// The blocks of one task with the places that their products go to.
#[derive(Default)]
struct Share {
    /// Term and block, in the order of the terms.
    blocks: Vec<(u32, u32)>,
    /// Where each block's products go, block after block: into the task's own entries, or beyond them into
    /// `above`.
    slots: Vec<u32>,
    /// Likewise for the gradient, by unknowns of the block.
    rows: Vec<u32>,
    /// For each block that is coupled by place: how many runs of unknowns, and where each ends.
    run_counts: Vec<u32>,
    runs: Vec<u32>,
    own_entries: Range<usize>,
    own_rows: Range<usize>,
    above: Above,
    residuals: Vec<f64>,
    jacobian: Vec<f64>,
    products: Vec<f64>,
    sums: Vec<f64>,
}

/// Sums for entries that belong to no single task.
#[derive(Default)]
struct Above {
    slots: Vec<u32>,
    values: Vec<f64>,
    rows: Vec<u32>,
    gradient: Vec<f64>,
}

impl NormalEquations {
    /// Analyses the pattern of `terms` over the unknowns at these places (see [`super::dissection`]).
    pub fn new(places: &[[f64; 2]], terms: &[Weighted]) -> Self {
        let mut cliques = Cliques::default();
        for Weighted { term, coupling, .. } in terms {
            for unknowns in (0..term.blocks()).map(|b| term.unknowns(b)) {
                match coupling {
                    Coupling::Full => cliques.push(unknowns.iter().map(|&u| u as u32)),
                    Coupling::ByPlace => runs(places, unknowns)
                        .for_each(|run| cliques.push(unknowns[run].iter().map(|&u| u as u32))),
                }
            }
        }
        let pattern = Pattern::new(places, &cliques);
        drop(cliques);
        let shares = deal(&pattern, places, terms);
        let n = places.len();
        let values = vec![0.0; pattern.entries()];
        Self { pattern, values, gradient: vec![0.0; n], shares, by_position: vec![0.0; n] }
    }

    /// Evaluates all terms at `x`: fills the matrix and the gradient, and returns each term's sum of squares
    /// (without its weight).
    pub fn assemble(&mut self, terms: &[Weighted], x: &[f64]) -> Vec<f64> {
        self.values.par_chunks_mut(1 << 16).for_each(|chunk| chunk.fill(0.0));
        self.by_position.fill(0.0);
        let (mut entries, mut rows) = (&mut self.values[..], &mut self.by_position[..]);
        let jobs: Vec<_> = self
            .shares
            .iter_mut()
            .map(|share| {
                let own = entries.split_off_mut(..share.own_entries.len()).expect("entries of the task");
                let own_rows = rows.split_off_mut(..share.own_rows.len()).expect("rows of the task");
                (share, own, own_rows)
            })
            .collect();
        jobs.into_par_iter().for_each(|(share, entries, rows)| share.assemble(terms, x, entries, rows));
        for Share { above, .. } in &self.shares {
            above.slots.iter().zip(&above.values).for_each(|(&s, v)| self.values[s as usize] += v);
            above.rows.iter().zip(&above.gradient).for_each(|(&r, g)| self.by_position[r as usize] += g);
        }
        for (&unknown, value) in self.pattern.fronts.order.iter().zip(&self.by_position) {
            self.gradient[unknown as usize] = *value;
        }
        self.sums(terms.len())
    }

    /// Each term's sum of squares at `x`, without its weight.
    pub fn sums_of_squares(&mut self, terms: &[Weighted], x: &[f64]) -> Vec<f64> {
        self.shares.par_iter_mut().for_each(|share| share.measure(terms, x));
        self.sums(terms.len())
    }

    /// The sums of all tasks, added in their order.
    fn sums(&self, terms: usize) -> Vec<f64> {
        (0..terms).map(|term| self.shares.iter().map(|share| share.sums[term]).sum()).collect()
    }
}

/// Runs of consecutive unknowns of the same place.
fn runs<'a>(places: &'a [[f64; 2]], unknowns: &'a [usize]) -> impl Iterator<Item = Range<usize>> + 'a {
    let mut start = 0;
    std::iter::from_fn(move || {
        let first = places[*unknowns.get(start)?];
        let length = unknowns[start..].iter().take_while(|&&u| places[u] == first).count();
        start += length;
        Some(start - length..start)
    })
}

/// Deals the blocks out to the tasks.
fn deal(pattern: &Pattern, places: &[[f64; 2]], terms: &[Weighted]) -> Vec<Share> {
    let tasks = &pattern.fronts.tasks;
    let mut shares: Vec<Share> = tasks
        .iter()
        .map(|task| Share {
            own_entries: pattern.diagonal(task.columns.start)..pattern.diagonal(task.columns.end),
            own_rows: task.columns.clone(),
            sums: vec![0.0; terms.len()],
            ..Share::default()
        })
        .collect();
    let position = |&unknown: &usize| pattern.fronts.position[unknown];
    for (t, term) in terms.iter().map(|weighted| &weighted.term).enumerate() {
        for b in 0..term.blocks() {
            let first = term.unknowns(b).iter().map(position).min().unwrap_or(0) as usize;
            let task = tasks.partition_point(|task| task.columns.end <= first);
            shares[task].blocks.push((t as u32, b as u32));
        }
    }
    shares.par_iter_mut().for_each(|share| share.find_slots(pattern, places, terms));
    shares
}

impl Share {
    fn find_slots(&mut self, pattern: &Pattern, places: &[[f64; 2]], terms: &[Weighted]) {
        let (mut slots, mut rows) = (Vec::new(), Vec::new());
        let (mut most_rows, mut most_columns, mut most_entries) = (0, 0, 0);
        for &(t, b) in &self.blocks {
            let Weighted { term, coupling, .. } = &terms[t as usize];
            let unknowns = term.unknowns(b as usize);
            most_rows = most_rows.max(term.rows(b as usize));
            most_columns = most_columns.max(unknowns.len());
            most_entries = most_entries.max(term.rows(b as usize) * unknowns.len());
            let position = |u: &usize| pattern.fronts.position[*u];
            rows.extend(unknowns.iter().map(position).map(|u| u as usize));
            let whole = std::iter::once(0..unknowns.len());
            let couple = |run: Range<usize>| {
                for i in run.clone() {
                    let u = position(&unknowns[i]);
                    let earlier = unknowns[run.start..=i].iter().map(position);
                    slots.extend(earlier.map(|v| pattern.slot(u.max(v), u.min(v))));
                }
            };
            match coupling {
                Coupling::Full => whole.for_each(couple),
                Coupling::ByPlace => {
                    let count = runs(places, unknowns).map(|run| self.runs.push(run.end as u32)).count();
                    self.run_counts.push(count as u32);
                    runs(places, unknowns).for_each(couple);
                }
            }
        }
        self.residuals = vec![0.0; most_rows];
        self.jacobian = vec![0.0; most_entries];
        self.products = vec![0.0; most_columns * (most_columns + 1) / 2];
        (self.slots, self.above.slots) = keep_apart(&slots, &self.own_entries);
        (self.rows, self.above.rows) = keep_apart(&rows, &self.own_rows);
        self.above.values = vec![0.0; self.above.slots.len()];
        self.above.gradient = vec![0.0; self.above.rows.len()];
    }

    fn assemble(&mut self, terms: &[Weighted], x: &[f64], entries: &mut [f64], rows: &mut [f64]) {
        self.sums.fill(0.0);
        self.above.values.fill(0.0);
        self.above.gradient.fill(0.0);
        let (mut slots, mut places) = (&self.slots[..], &self.rows[..]);
        let (mut run_counts, mut runs) = (self.run_counts.iter(), self.runs.iter());
        for &(t, b) in &self.blocks {
            let Weighted { term, weight, coupling } = &terms[t as usize];
            let b = b as usize;
            let (count, columns) = (term.rows(b), term.unknowns(b).len());
            let residuals = &mut self.residuals[..count];
            let jacobian = &mut self.jacobian[..count * columns];
            if *weight > 0.0 {
                jacobian.fill(0.0);
                term.evaluate(b, x, residuals, jacobian);
                self.sums[t as usize] += residuals.iter().map(|r| r * r).sum::<f64>();
                for (i, place) in places[..columns].iter().enumerate() {
                    let slope: f64 = (0..count).map(|row| jacobian[row * columns + i] * residuals[row]).sum();
                    add(rows, &mut self.above.gradient, *place, weight * slope);
                }
            }
            places = &places[columns..];
            let mut couple = |run: Range<usize>, weight: f64| {
                let (mine, rest) = slots.split_at(run.len() * (run.len() + 1) / 2);
                slots = rest;
                if weight > 0.0 {
                    let products = &mut self.products[..mine.len()];
                    let rows = jacobian.chunks_exact(columns).map(|row| &row[run.clone()]);
                    multiply(rows, products);
                    for (slot, product) in mine.iter().zip(products) {
                        add(entries, &mut self.above.values, *slot, weight * *product);
                    }
                }
            };
            match coupling {
                Coupling::Full => couple(0..columns, *weight),
                Coupling::ByPlace => {
                    let count = *run_counts.next().expect("one count per block");
                    let mut start = 0;
                    for _ in 0..count {
                        let end = *runs.next().expect("one end per run") as usize;
                        couple(start..end, weight * f64::from(count));
                        start = end;
                    }
                }
            }
        }
    }

    fn measure(&mut self, terms: &[Weighted], x: &[f64]) {
        self.sums.fill(0.0);
        for &(t, b) in &self.blocks {
            let Weighted { term, weight, .. } = &terms[t as usize];
            if *weight == 0.0 {
                continue;
            }
            let b = b as usize;
            let (count, columns) = (term.rows(b), term.unknowns(b).len());
            let residuals = &mut self.residuals[..count];
            let jacobian = &mut self.jacobian[..count * columns];
            jacobian.fill(0.0);
            term.evaluate(b, x, residuals, jacobian);
            self.sums[t as usize] += residuals.iter().map(|r| r * r).sum::<f64>();
        }
    }
}

/// The lower triangle of the products of a block's columns, row after row: sums over the rows of its Jacobian.
fn multiply<'a>(rows: impl Iterator<Item = &'a [f64]>, products: &mut [f64]) {
    products.fill(0.0);
    for row in rows {
        let mut rest = &mut *products;
        for (i, &value) in row.iter().enumerate() {
            let (line, after) = rest.split_at_mut(i + 1);
            line.iter_mut().zip(row).for_each(|(product, other)| *product += value * other);
            rest = after;
        }
    }
}

fn add(own: &mut [f64], above: &mut [f64], place: u32, value: f64) {
    let place = place as usize;
    match own.get_mut(place) {
        Some(entry) => *entry += value,
        None => above[place - own.len()] += value,
    }
}

/// Numbers places: those inside `own` from its start, the others after them in ascending order. Returns also
/// the others.
fn keep_apart(places: &[usize], own: &Range<usize>) -> (Vec<u32>, Vec<u32>) {
    let mut others: Vec<u32> =
        places.iter().filter(|place| !own.contains(place)).map(|&p| p as u32).collect();
    others.sort_unstable();
    others.dedup();
    let number = |&place: &usize| {
        if own.contains(&place) {
            return (place - own.start) as u32;
        }
        (own.len() + others.binary_search(&(place as u32)).expect("listed")) as u32
    };
    (places.iter().map(number).collect(), others)
}

#[cfg(test)]
mod tests;
