//! Which cells become pieces: whole ones, well connected.

use crate::geometry::topology::{Edge, edges};
use std::collections::{BTreeMap, BTreeSet};

/// The cells to keep of `faces` (corner indices, counter-clockwise), ascending. With `blocks` every cell that is kept
/// belongs to a block of cells around a whole one, three by three on a regular grid: narrower tips would hang on few
/// hinges. Each cell has two neighbours at least, no two touch in a corner only, and all connect.
pub fn tidy(faces: &[Vec<usize>], whole: &[bool], blocks: bool) -> Vec<usize> {
    let all: Vec<Edge> = edges(faces).unwrap_or_default();
    let mut kept: BTreeSet<usize> = (0..faces.len()).filter(|&f| whole[f]).collect();
    if blocks {
        kept = opened(faces, &all, &kept);
    }
    loop {
        let mut neighbours: BTreeMap<usize, usize> = kept.iter().map(|&f| (f, 0)).collect();
        for edge in &all {
            if let Some(right) = edge.right.filter(|right| kept.contains(right) && kept.contains(&edge.left))
            {
                [edge.left, right].iter().for_each(|f| *neighbours.entry(*f).or_default() += 1);
            }
        }
        let loose: BTreeSet<usize> =
            neighbours.iter().filter(|&(_, &count)| count < 2).map(|(&f, _)| f).collect();
        if !loose.is_empty() {
            kept.retain(|cell| !loose.contains(cell));
            continue;
        }
        let Some(pinch) = pinched(faces, &all, &kept) else { break };
        let Some(&cell) = pinch.iter().min_by_key(|f| neighbours[f]) else { break };
        kept.remove(&cell);
    }
    largest(&all, &kept)
}

/// The cells around each corner.
fn around(faces: &[Vec<usize>], kept: &BTreeSet<usize>) -> BTreeMap<usize, Vec<usize>> {
    let mut around: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    kept.iter().for_each(|&f| faces[f].iter().for_each(|&c| around.entry(c).or_default().push(f)));
    around
}

/// The cells that share a corner with a cell whose own corners are all inner ones, and those cells.
fn opened(faces: &[Vec<usize>], all: &[Edge], kept: &BTreeSet<usize>) -> BTreeSet<usize> {
    let mut rim = BTreeSet::new();
    for edge in all {
        let sides = [Some(edge.left), edge.right].into_iter().flatten().filter(|f| kept.contains(f)).count();
        if sides == 1 {
            rim.extend(edge.vertices);
        }
    }
    let around = around(faces, kept);
    let centres = kept.iter().filter(|&&f| faces[f].iter().all(|c| !rim.contains(c)));
    centres.flat_map(|&f| &faces[f]).flat_map(|c| &around[c]).copied().collect()
}

/// The cells at a corner around which they do not all hang together.
fn pinched(faces: &[Vec<usize>], all: &[Edge], kept: &BTreeSet<usize>) -> Option<Vec<usize>> {
    // Around a corner cells and shared edges form a chain (one edge less) or a ring (as many).
    let mut shared: BTreeMap<usize, usize> = BTreeMap::new();
    for edge in all {
        if edge.right.is_some_and(|right| kept.contains(&right) && kept.contains(&edge.left)) {
            edge.vertices.iter().for_each(|&c| *shared.entry(c).or_default() += 1);
        }
    }
    let fans = around(faces, kept).into_iter();
    fans.filter(|(c, cells)| shared.get(c).copied().unwrap_or(0) + 1 < cells.len())
        .map(|(_, cells)| cells)
        .next()
}

/// The largest connected part.
fn largest(all: &[Edge], kept: &BTreeSet<usize>) -> Vec<usize> {
    let mut next: BTreeMap<usize, Vec<usize>> = kept.iter().map(|&f| (f, Vec::new())).collect();
    for edge in all {
        if let Some(right) = edge.right.filter(|right| kept.contains(right) && kept.contains(&edge.left)) {
            next.entry(edge.left).or_default().push(right);
            next.entry(right).or_default().push(edge.left);
        }
    }
    let mut rest = kept.clone();
    let mut best = Vec::new();
    while let Some(start) = rest.pop_first() {
        let mut part = vec![start];
        let mut at = 0;
        while let Some(&f) = part.get(at) {
            next[&f].iter().for_each(|&g| part.extend(rest.take(&g)));
            at += 1;
        }
        if part.len() > best.len() {
            best = part;
        }
    }
    best.sort_unstable();
    best
}
