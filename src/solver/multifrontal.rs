//! Sparse Cholesky factorisation by the multifrontal method (I. Duff, J. Reid 1983; J. Liu 1992).
//!
//! Each part of the [`super::dissection`] is eliminated in a dense *front*: its own columns and all rows coupled
//! to them so far. What remains of the front, the *update*, is added to the parent's front. Disjoint subtrees are
//! factorised at the same time, and the large fronts above them in fixed tiles, so that every number is
//! computed by the same operations in the same order whatever the number of threads.

use super::dense::{Real, eliminate, solve_lower, solve_upper};
use super::dissection::Cliques;
use super::fronts::{Front, Fronts, Task};
use faer::MatMut;
use rayon::prelude::*;

/// The pattern of a symmetric positive definite matrix with its symbolic factorisation.
///
/// Rows and columns are *positions* in the order of elimination; [`Fronts::position`] gives them. Of the
/// symmetric matrix the lower triangle is stored, column after column.
pub struct Pattern {
    /// The tree of fronts.
    pub fronts: Fronts,
    /// Where the entries of each column start; the diagonal comes first.
    starts: Vec<usize>,
    rows: Vec<u32>,
    /// For each entry its row in the front of its column.
    places: Vec<u32>,
}

/// A numeric factorisation; its memory is used again by each new one.
#[derive(Default)]
pub struct Factor<T> {
    /// Panels of all fronts: rows by own columns, column after column.
    panels: Vec<T>,
    /// Updates that wait for their parents: two stacks per task.
    stacks: Vec<Stacks<T>>,
    /// The right-hand side in the order of elimination.
    solution: Vec<T>,
}

type Stacks<T> = [Vec<T>; 2];

impl Pattern {
    /// Analyses the pattern that these sets of coupled unknowns make. Every unknown has a place (see
    /// [`super::dissection`]).
    pub fn new(places: &[[f64; 2]], cliques: &Cliques) -> Self {
        let fronts = Fronts::new(places, cliques);
        let (starts, rows) = lower_triangle(&fronts.position, cliques);
        let mut places = Vec::with_capacity(rows.len());
        for front in &fronts.fronts {
            let entries = &rows[starts[front.columns.start]..starts[front.columns.end]];
            places.extend(entries.iter().map(|&row| Fronts::place_in(front, row as usize) as u32));
        }
        Self { fronts, starts, rows, places }
    }

    /// Number of unknowns.
    pub fn size(&self) -> usize {
        self.starts.len() - 1
    }

    /// Number of stored entries of the lower triangle.
    pub fn entries(&self) -> usize {
        self.rows.len()
    }

    /// Where entry `(row, column)` of the lower triangle is stored.
    ///
    /// # Panics
    /// If the entry is not in the pattern.
    pub fn slot(&self, row: u32, column: u32) -> usize {
        let (start, end) = (self.starts[column as usize], self.starts[column as usize + 1]);
        start + self.rows[start..end].binary_search(&row).expect("the entry is in the pattern")
    }

    /// The rows of a column's entries in the lower triangle, ascending: for tests and measurements that hand the
    /// matrix to other solvers.
    pub fn column(&self, column: usize) -> &[u32] {
        &self.rows[self.starts[column]..self.starts[column + 1]]
    }

    /// Where the entries of a column start; the diagonal entry is the first.
    pub fn diagonal(&self, column: usize) -> usize {
        self.starts[column]
    }
}

/// Where each column starts among the rows of its entries, and these rows, ascending.
fn lower_triangle(position: &[u32], cliques: &Cliques) -> (Vec<usize>, Vec<u32>) {
    let n = position.len();
    let pairs = || {
        cliques.iter().flat_map(|clique| {
            let at = |&unknown: &u32| position[unknown as usize];
            clique
                .iter()
                .enumerate()
                .flat_map(move |(i, u)| clique[..i].iter().map(move |v| [at(u).min(at(v)), at(u).max(at(v))]))
        })
    };
    // All pairs first, each as often as blocks couple it.
    let mut ends = vec![1_usize; n];
    pairs().for_each(|[column, _]| ends[column as usize] += 1);
    let mut all = vec![0_u32; ends.iter().sum()];
    let mut columns = Vec::with_capacity(n);
    let (mut rest, mut filled) = (&mut all[..], vec![1_usize; n]);
    for (i, &count) in ends.iter().enumerate() {
        let column = rest.split_off_mut(..count).expect("room for every pair");
        column[0] = i as u32;
        columns.push(column);
    }
    for [column, row] in pairs() {
        let at = &mut filled[column as usize];
        columns[column as usize][*at] = row;
        *at += 1;
    }
    columns.par_iter_mut().for_each(|column| {
        column.sort_unstable();
        let kept = without_repetition(column);
        *column = &mut std::mem::take(column)[..kept];
    });
    let mut starts = Vec::with_capacity(n + 1);
    starts.push(0);
    columns.iter().for_each(|rows| starts.push(starts[starts.len() - 1] + rows.len()));
    (starts, columns.concat())
}

/// Moves the different ones of ascending numbers to the front, and counts them.
fn without_repetition(sorted: &mut [u32]) -> usize {
    let mut kept = 1;
    for i in 1..sorted.len() {
        if sorted[i] != sorted[kept - 1] {
            sorted[kept] = sorted[i];
            kept += 1;
        }
    }
    kept
}

impl<T: Real> Factor<T> {
    /// Factorises the matrix with these values, `shift` added to its diagonal. False where it is not positive
    /// definite (or not finite).
    pub fn factorise(&mut self, pattern: &Pattern, values: &[f64], shift: f64) -> bool {
        let fronts = &pattern.fronts;
        let Some((top, tasks)) = fronts.tasks.split_last() else { return true };
        self.panels.resize(fronts.factor_size, T::default());
        self.stacks.resize_with(fronts.tasks.len(), Stacks::default);
        let (own_stacks, stacks) = self.stacks.split_last_mut().expect("one stack per task");
        let mut rest = &mut self.panels[..];
        let jobs: Vec<(&Task, &mut [T], &mut Stacks<T>)> = tasks
            .iter()
            .zip(stacks.iter_mut())
            .map(|(task, stacks)| {
                let panels = rest.split_off_mut(..task.panels.len()).expect("room for the task's panels");
                (task, panels, stacks)
            })
            .collect();
        let matrix = Matrix { pattern, values, shift };
        let sound = jobs
            .into_par_iter()
            .map(|(task, panels, stacks)| matrix.run(task, panels, stacks, &[], false))
            .collect::<Vec<bool>>();
        sound.into_iter().all(|sound| sound) && matrix.run(top, rest, own_stacks, stacks, true)
    }

    /// Solves for one right-hand side, in place.
    pub fn solve(&mut self, pattern: &Pattern, rhs: &mut [f64]) {
        let Fronts { order, fronts, tasks, .. } = &pattern.fronts;
        let Some((top, tasks)) = tasks.split_last() else { return };
        self.solution.clear();
        self.solution.extend(order.iter().map(|&unknown| T::of(rhs[unknown as usize])));
        let (own, tail) = self.solution.split_at_mut(top.columns.start);
        let panels = &self.panels;
        let carried: Vec<Vec<T>> = split(own, tasks)
            .into_par_iter()
            .map(|(task, own)| {
                let mut carried = vec![T::default(); tail.len()];
                for front in &fronts[task.fronts.clone()] {
                    forward(front, panels, task.columns.start, own, top.columns.start, &mut carried);
                }
                carried
            })
            .collect();
        for carried in &carried {
            tail.iter_mut().zip(carried).for_each(|(value, part)| *value += *part);
        }
        for front in &fronts[top.fronts.clone()] {
            forward(front, panels, top.columns.start, tail, usize::MAX, &mut []);
        }
        for front in fronts[top.fronts.clone()].iter().rev() {
            backward(front, panels, top.columns.start, tail, usize::MAX, &[]);
        }
        let tail = &*tail;
        split(own, tasks).into_par_iter().for_each(|(task, own)| {
            for front in fronts[task.fronts.clone()].iter().rev() {
                backward(front, panels, task.columns.start, own, top.columns.start, tail);
            }
        });
        order.iter().zip(&self.solution).for_each(|(&unknown, value)| rhs[unknown as usize] = value.f64());
    }
}

/// Cuts a vector over the tasks' columns into the tasks' own parts.
fn split<'a, 'b, T>(mut rest: &'a mut [T], tasks: &'b [Task]) -> Vec<(&'b Task, &'a mut [T])> {
    tasks
        .iter()
        .map(|task| (task, rest.split_off_mut(..task.columns.len()).expect("columns of the task")))
        .collect()
}

/// Forward substitution in one front. Positions from `first` are in `own`, those from `beyond` in `carried`,
/// which collects their changes.
fn forward<T: Real>(
    front: &Front,
    panels: &[T],
    first: usize,
    own: &mut [T],
    beyond: usize,
    carried: &mut [T],
) {
    let columns = front.columns.len();
    let mut entries = vec![T::default(); front.size()];
    let start = front.columns.start - first;
    entries[..columns].copy_from_slice(&own[start..start + columns]);
    solve_lower(&panels[front.panel..][..front.size() * columns], columns, &mut entries);
    own[start..start + columns].copy_from_slice(&entries[..columns]);
    for (&row, entry) in front.rows.iter().zip(&entries[columns..]) {
        let row = row as usize;
        if row < beyond { own[row - first] += *entry } else { carried[row - beyond] += *entry }
    }
}

/// Back substitution in one front, with positions as in [`forward`].
fn backward<T: Real>(front: &Front, panels: &[T], first: usize, own: &mut [T], beyond: usize, known: &[T]) {
    let columns = front.columns.len();
    let start = front.columns.start - first;
    let mut entries = Vec::with_capacity(front.size());
    entries.extend_from_slice(&own[start..start + columns]);
    entries.extend(front.rows.iter().map(|&row| {
        let row = row as usize;
        if row < beyond { own[row - first] } else { known[row - beyond] }
    }));
    solve_upper(&panels[front.panel..][..front.size() * columns], columns, &mut entries);
    own[start..start + columns].copy_from_slice(&entries[..columns]);
}

/// The matrix that is factorised.
#[derive(Clone, Copy)]
struct Matrix<'a> {
    pattern: &'a Pattern,
    values: &'a [f64],
    shift: f64,
}

impl Matrix<'_> {
    /// Eliminates the fronts of a task. `below` holds the stacks of the tasks before, for the fronts above them.
    fn run<T: Real>(
        self,
        task: &Task,
        panels: &mut [T],
        stacks: &mut Stacks<T>,
        below: &[Stacks<T>],
        in_tiles: bool,
    ) -> bool {
        let all = &self.pattern.fronts;
        stacks.iter_mut().zip(task.stacks).for_each(|(stack, size)| stack.resize(size, T::default()));
        for front in &all.fronts[task.fronts.clone()] {
            let (size, columns, rows) = (front.size(), front.columns.len(), front.rows.len());
            let start = front.panel - task.panels.start;
            let panel = &mut panels[start..start + size * columns];
            let [first, second] = &mut *stacks;
            let (own, others) = if front.stack == 0 { (first, &*second) } else { (second, &*first) };
            let update = &mut own[front.update..front.update + rows * rows];
            let updates = || {
                front.children.iter().map(|&child| {
                    let stack = if child >= task.fronts.start {
                        others
                    } else {
                        let home = all.tasks.partition_point(|task| task.fronts.end <= child);
                        &below[home][1 - front.stack]
                    };
                    let child = &all.fronts[child];
                    (child, &stack[child.update..])
                })
            };
            self.scatter(front, panel);
            updates().for_each(|(child, source)| add_to_panel(child, source, panel, front));
            let sound = eliminate(
                MatMut::from_column_major_slice_mut(panel, size, columns),
                MatMut::from_column_major_slice_mut(update, rows, rows),
                in_tiles,
            );
            if !sound {
                return false;
            }
            updates().for_each(|(child, source)| add_to_update(child, source, update, front));
        }
        true
    }

    /// Writes the matrix's own entries into the panel of a front.
    fn scatter<T: Real>(self, front: &Front, panel: &mut [T]) {
        let size = front.size();
        panel.fill(T::default());
        for (position, column) in front.columns.clone().zip(panel.chunks_exact_mut(size)) {
            let entries = self.pattern.starts[position]..self.pattern.starts[position + 1];
            let places = &self.pattern.places[entries.clone()];
            for (&place, value) in places.iter().zip(&self.values[entries]) {
                column[place as usize] = T::of(*value);
            }
            column[places[0] as usize] += T::of(self.shift);
        }
    }
}

/// Adds the update of a child to the columns that its parent eliminates.
fn add_to_panel<T: Real>(child: &Front, source: &[T], panel: &mut [T], parent: &Front) {
    let places = &child.into_parent;
    let (rows, size) = (places.len(), parent.size());
    let own = places.partition_point(|&place| (place as usize) < parent.columns.len());
    for (j, &column) in places[..own].iter().enumerate() {
        let target = &mut panel[column as usize * size..][..size];
        add_column(child, j, &source[j * rows..][..rows], 0, target);
    }
}

/// Adds the update of a child to the rows below the columns that its parent eliminates.
fn add_to_update<T: Real>(child: &Front, source: &[T], update: &mut [T], parent: &Front) {
    let places = &child.into_parent;
    let (rows, columns, below) = (places.len(), parent.columns.len(), parent.rows.len());
    let own = places.partition_point(|&place| (place as usize) < columns);
    for (j, &column) in places.iter().enumerate().skip(own) {
        let target = &mut update[(column as usize - columns) * below..][..below];
        add_column(child, j, &source[j * rows..][..rows], columns, target);
    }
}

/// Adds column `j` of a child's update, from the diagonal on, to one of its parent's that begins at place `first`.
fn add_column<T: Real>(child: &Front, j: usize, source: &[T], first: usize, target: &mut [T]) {
    let mut from = j;
    let next = child.runs.partition_point(|&end| end as usize <= j);
    for &end in &child.runs[next..] {
        let end = end as usize;
        let at = child.into_parent[from] as usize - first;
        let values = &source[from..end];
        target[at..at + values.len()].iter_mut().zip(values).for_each(|(sum, value)| *sum += *value);
        from = end;
    }
}

#[cfg(test)]
mod tests;
