//! The symbolic factorisation: which unknowns meet in which front, and which subtrees are independent.

use super::dissection::{Cliques, Dissection, dissect};
use std::ops::Range;

/// A dense matrix in which a few unknowns are eliminated.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Front {
    /// Own columns: positions in the order of elimination.
    pub columns: Range<usize>,
    /// Positions of the rows below them, ascending.
    pub rows: Vec<u32>,
    /// Fronts whose updates come here.
    pub children: Vec<usize>,
    /// For each row its place in the parent's front.
    pub into_parent: Vec<u32>,
    /// The rows in runs whose places follow each other: where each ends.
    pub runs: Vec<u32>,
    /// Where its panel starts in the factor.
    pub panel: usize,
    /// Which of its task's two stacks holds its update: the other one than its children's, so that they do not overlap.
    pub stack: usize,
    /// Where its update starts there.
    pub update: usize,
}

impl Front {
    /// Rows of the front: own columns and rows below.
    pub fn size(&self) -> usize {
        self.columns.len() + self.rows.len()
    }

    /// Multiplications and additions of its elimination.
    fn work(&self) -> f64 {
        let (own, below) = (self.columns.len() as f64, self.rows.len() as f64);
        own * (own * own / 3.0 + own * below + below * below)
    }
}

/// A run of fronts whose subtrees depend on nothing else, or the run of all fronts above.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Task {
    /// Fronts.
    pub fronts: Range<usize>,
    /// Columns of these fronts.
    pub columns: Range<usize>,
    /// Part of the factor that holds their panels.
    pub panels: Range<usize>,
    /// Largest sizes of the two stacks of updates.
    pub stacks: [usize; 2],
}

/// The tree of fronts.
#[derive(Debug, Clone, PartialEq)]
pub struct Fronts {
    /// The unknown at each position of the order of elimination.
    pub order: Vec<u32>,
    /// The position of each unknown.
    pub position: Vec<u32>,
    /// All fronts: children before parents.
    pub fronts: Vec<Front>,
    /// Independent subtrees, then the fronts above them as the last task.
    pub tasks: Vec<Task>,
    /// Numbers in the factor.
    pub factor_size: usize,
    /// Multiplications and additions of a factorisation.
    pub work: f64,
}

/// Subtrees are split until none holds more than this share of the work. Smaller shares would keep more threads busy,
/// but leave more fronts above the subtrees, which come one after the other: 1/32 took up to twice the time of 1/4 on
/// two threads.
const TASK_SHARE: f64 = 1.0 / 4.0;

impl Fronts {
    /// Analyses the couplings of unknowns at these places (see [`dissect`]).
    pub fn new(places: &[[f64; 2]], cliques: &Cliques) -> Self {
        let Dissection { order, parts } = dissect(places, cliques);
        let starts = starts(parts.iter().map(|part| part.size));
        let parents: Vec<Option<usize>> = parts.iter().map(|part| part.parent).collect();
        let columns: Vec<Range<usize>> = starts.windows(2).map(|w| w[0]..w[1]).collect();
        let rows = rows(&order, &columns, &parents, cliques);
        let task_of = tasks(&columns, &rows, &parents);
        // Renumber: task after task, then the rest.
        let mut sequence: Vec<usize> = (0..parts.len()).collect();
        sequence.sort_by_key(|&part| (task_of[part], part));
        Self::assemble(&order, &columns, &rows, &parents, &task_of, &sequence)
    }

    fn assemble(
        order: &[u32],
        columns: &[Range<usize>],
        rows: &[Vec<u32>],
        parents: &[Option<usize>],
        task_of: &[usize],
        sequence: &[usize],
    ) -> Self {
        let n = order.len();
        let mut moved = vec![0_u32; n];
        let mut new_order = Vec::with_capacity(n);
        let mut number = vec![0; sequence.len()];
        for (new, &part) in sequence.iter().enumerate() {
            number[part] = new;
            for old in columns[part].clone() {
                moved[old] = new_order.len() as u32;
                new_order.push(order[old]);
            }
        }
        let mut position = vec![0; n];
        new_order.iter().enumerate().for_each(|(at, &unknown)| position[unknown as usize] = at as u32);
        let mut fronts: Vec<Front> = Vec::with_capacity(sequence.len());
        let (mut first, mut panel, mut work) = (0, 0, 0.0);
        for &part in sequence {
            let mut below: Vec<u32> = rows[part].iter().map(|&row| moved[row as usize]).collect();
            below.sort_unstable();
            let own = first..first + columns[part].len();
            first = own.end;
            let front = Front {
                columns: own,
                rows: below,
                children: Vec::new(),
                into_parent: Vec::new(),
                runs: Vec::new(),
                panel,
                stack: 0,
                update: 0,
            };
            panel += front.size() * front.columns.len();
            work += front.work();
            fronts.push(front);
        }
        for (new, &part) in sequence.iter().enumerate() {
            if let Some(parent) = parents[part].map(|parent| number[parent]) {
                fronts[parent].children.push(new);
                fronts[new].into_parent = places_in(&fronts[parent], &fronts[new].rows);
                fronts[new].runs = runs(&fronts[new].into_parent);
            }
        }
        let task_numbers: Vec<usize> = sequence.iter().map(|&part| task_of[part]).collect();
        let tasks = lay_stacks(&mut fronts, &task_numbers, panel);
        Self { order: new_order, position, fronts, tasks, factor_size: panel, work }
    }

    /// The place of a position in a front.
    pub fn place_in(front: &Front, position: usize) -> usize {
        if front.columns.contains(&position) {
            return position - front.columns.start;
        }
        let below = front.rows.binary_search(&(position as u32)).expect("the position meets the front");
        front.columns.len() + below
    }
}

fn starts(sizes: impl Iterator<Item = usize>) -> Vec<usize> {
    let mut starts = vec![0];
    for size in sizes {
        starts.push(starts[starts.len() - 1] + size);
    }
    starts
}

fn places_in(front: &Front, positions: &[u32]) -> Vec<u32> {
    positions.iter().map(|&position| Fronts::place_in(front, position as usize) as u32).collect()
}

/// Where runs of consecutive numbers end.
fn runs(places: &[u32]) -> Vec<u32> {
    let ends = places.chunk_by(|a, b| a + 1 == *b).scan(0, |end, run| {
        *end += run.len() as u32;
        Some(*end)
    });
    ends.collect()
}

/// The rows below each part: what its blocks and its children couple to it. A part's parent may hold none of
/// its rows only if it has none at all.
fn rows(
    order: &[u32],
    columns: &[Range<usize>],
    parents: &[Option<usize>],
    cliques: &Cliques,
) -> Vec<Vec<u32>> {
    let mut position = vec![0_u32; order.len()];
    order.iter().enumerate().for_each(|(at, &unknown)| position[unknown as usize] = at as u32);
    let mut part_of = vec![0_u32; order.len()];
    for (part, range) in columns.iter().enumerate() {
        part_of[range.clone()].fill(part as u32);
    }
    let mut rows: Vec<Vec<u32>> = vec![Vec::new(); columns.len()];
    for clique in cliques.iter() {
        let at = |&unknown: &u32| position[unknown as usize];
        let Some(first) = clique.iter().map(at).min() else { continue };
        let part = part_of[first as usize] as usize;
        let end = columns[part].end as u32;
        rows[part].extend(clique.iter().map(at).filter(|&row| row >= end));
        if rows[part].len() > 4096 {
            rows[part].sort_unstable();
            rows[part].dedup();
        }
    }
    for part in 0..columns.len() {
        rows[part].sort_unstable();
        rows[part].dedup();
        if let Some(parent) = parents[part] {
            let end = columns[parent].end as u32;
            let passed: Vec<u32> = rows[part].iter().copied().filter(|&row| row >= end).collect();
            rows[parent].extend(passed);
        }
    }
    rows
}

/// The task of each part; the number of tasks for the parts above all tasks.
fn tasks(columns: &[Range<usize>], rows: &[Vec<u32>], parents: &[Option<usize>]) -> Vec<usize> {
    let count = columns.len();
    let mut work: Vec<f64> = (0..count)
        .map(|part| {
            let (own, below) = (columns[part].len() as f64, rows[part].len() as f64);
            own * (own * own / 3.0 + own * below + below * below)
        })
        .collect();
    for part in 0..count {
        if let Some(parent) = parents[part] {
            work[parent] += work[part];
        }
    }
    let total: f64 = (0..count).filter(|&part| parents[part].is_none()).map(|part| work[part]).sum();
    let small = |part: usize| work[part] <= TASK_SHARE * total;
    let mut task_of = vec![usize::MAX; count];
    let mut tasks = 0;
    for part in (0..count).rev() {
        let above = parents[part].map(|parent| task_of[parent]);
        task_of[part] = match above {
            Some(task) if task != usize::MAX => task,
            _ if small(part) => {
                tasks += 1;
                tasks - 1
            }
            _ => usize::MAX,
        };
    }
    task_of.iter_mut().filter(|task| **task == usize::MAX).for_each(|task| *task = tasks);
    task_of
}

/// Lays the updates of each task on its two stacks, in turn by the depth in the tree.
fn lay_stacks(fronts: &mut [Front], task_of: &[usize], factor_size: usize) -> Vec<Task> {
    for front in (0..fronts.len()).rev() {
        let below = 1 - fronts[front].stack;
        for child in fronts[front].children.clone() {
            fronts[child].stack = below;
        }
    }
    let count = task_of.last().map_or(0, |&last| last + 1);
    let mut tasks = Vec::with_capacity(count);
    let mut first = 0;
    for task in 0..count {
        let end = first + task_of[first..].iter().take_while(|&&t| t == task).count();
        let (mut tops, mut stacks) = ([0; 2], [0; 2]);
        for front in first..end {
            let own = fronts[front].stack;
            // The children's updates are used up.
            if let Some(&child) = fronts[front].children.iter().find(|&&child| child >= first) {
                tops[1 - own] = fronts[child].update;
            }
            fronts[front].update = tops[own];
            tops[own] += fronts[front].rows.len().pow(2);
            stacks[own] = stacks[own].max(tops[own]);
        }
        let at = |front: usize| fronts.get(front).map_or(factor_size, |front| front.panel);
        let columns =
            if first == end { 0..0 } else { fronts[first].columns.start..fronts[end - 1].columns.end };
        tasks.push(Task { fronts: first..end, columns, panels: at(first)..at(end), stacks });
        first = end;
    }
    tasks
}
