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
    /// Updates that wait for their parents: one stack per task.
    stacks: Vec<Stack<T>>,
    /// The right-hand side in the order of elimination.
    solution: Vec<T>,
}

#[derive(Default)]
struct Stack<T> {
    memory: Vec<T>,
    scratch: Vec<T>,
}

impl Pattern {
    /// Analyses the pattern that these sets of coupled unknowns make. Every unknown has a place (see
    /// [`super::dissection`]).
    pub fn new(places: &[[f64; 2]], cliques: &Cliques) -> Self {
        let fronts = Fronts::new(places, cliques);
        let n = places.len();
        let mut columns: Vec<Vec<u32>> = (0..n as u32).map(|i| vec![i]).collect();
        for clique in cliques.iter() {
            for (i, u) in clique.iter().enumerate() {
                for v in &clique[..i] {
                    let [u, v] = [u, v].map(|&w| fronts.position[w as usize]);
                    columns[u.min(v) as usize].push(u.max(v));
                }
            }
        }
        columns.par_iter_mut().for_each(|rows| {
            rows.sort_unstable();
            rows.dedup();
        });
        let mut starts = Vec::with_capacity(n + 1);
        starts.push(0);
        columns.iter().for_each(|rows| starts.push(starts[starts.len() - 1] + rows.len()));
        let rows = columns.concat();
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

impl<T: Real> Factor<T> {
    /// Factorises the matrix with these values, `shift` added to its diagonal. False where it is not positive
    /// definite (or not finite).
    pub fn factorise(&mut self, pattern: &Pattern, values: &[f64], shift: f64) -> bool {
        let fronts = &pattern.fronts;
        let Some((top, tasks)) = fronts.tasks.split_last() else { return true };
        self.panels.resize(fronts.factor_size, T::default());
        self.stacks.resize_with(fronts.tasks.len(), Stack::default);
        let (own_stack, stacks) = self.stacks.split_last_mut().expect("one stack per task");
        let mut rest = &mut self.panels[..];
        let jobs: Vec<(&Task, &mut [T], &mut Stack<T>)> = tasks
            .iter()
            .zip(stacks.iter_mut())
            .map(|(task, stack)| {
                let panels = rest.split_off_mut(..task.panels.len()).expect("room for the task's panels");
                (task, panels, stack)
            })
            .collect();
        let matrix = Matrix { pattern, values, shift };
        let sound = jobs
            .into_par_iter()
            .map(|(task, panels, stack)| matrix.run(task, panels, stack, &[], false))
            .collect::<Vec<bool>>();
        sound.into_iter().all(|sound| sound) && matrix.run(top, rest, own_stack, stacks, true)
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
        stack: &mut Stack<T>,
        below: &[Stack<T>],
        in_tiles: bool,
    ) -> bool {
        let all = &self.pattern.fronts;
        stack.memory.resize(task.stack, T::default());
        stack.scratch.resize(task.scratch, T::default());
        for front in &all.fronts[task.fronts.clone()] {
            let (size, columns) = (front.size(), front.columns.len());
            let start = front.panel - task.panels.start;
            let panel = &mut panels[start..start + size * columns];
            let update = &mut stack.scratch[..front.rows.len().pow(2)];
            update.fill(T::default());
            self.scatter(front, panel);
            for &child in &front.children {
                let source = if child >= task.fronts.start {
                    &stack.memory
                } else {
                    let home = all.tasks.partition_point(|task| task.fronts.end <= child);
                    &below[home].memory
                };
                let child = &all.fronts[child];
                add_update(child, &source[child.update..], panel, columns, size, update);
            }
            let below = front.rows.len();
            let sound = eliminate(
                MatMut::from_column_major_slice_mut(panel, size, columns),
                MatMut::from_column_major_slice_mut(update, below, below),
                in_tiles,
            );
            if !sound {
                return false;
            }
            stack.memory[front.update..front.update + below * below].copy_from_slice(update);
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

/// Adds the update of a child to its parent's front.
fn add_update<T: Real>(
    child: &Front,
    source: &[T],
    panel: &mut [T],
    columns: usize,
    size: usize,
    update: &mut [T],
) {
    let places = &child.into_parent;
    let rows = places.len();
    let below = size - columns;
    for (j, &column) in places.iter().enumerate() {
        let column = column as usize;
        let entries = source[j * rows + j..(j + 1) * rows].iter().zip(&places[j..]);
        if column < columns {
            let target = &mut panel[column * size..(column + 1) * size];
            entries.for_each(|(value, &place)| target[place as usize] += *value);
        } else {
            let target = &mut update[(column - columns) * below..][..below];
            entries.for_each(|(value, &place)| target[place as usize - columns] += *value);
        }
    }
}

#[cfg(test)]
mod tests;
