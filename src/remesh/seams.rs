//! Coordinates of triangle corners in terms of one pair of unknowns per vertex.
//!
//! Along a cut a vertex has several pairs of coordinates. On a disk the quarter turns across the cuts and the
//! coordinates of the singular vertices determine them all: around a singular vertex a turn keeps its
//! coordinates in place, and around a vertex where cuts join the turns follow each other.

use super::comb::Combed;
use super::links::Links;

/// A sum of unknowns times factors, ordered by unknown.
pub type Sum = Vec<(usize, f64)>;

/// A point of the parameter plane as sums of unknowns.
pub type PointSum = [Sum; 2];

/// A turn by quarters, then a shift that depends on unknowns.
#[derive(Debug, Clone, Default)]
struct Turn {
    quarters: u8,
    shift: PointSum,
}

/// Coordinates of all corners.
pub struct Corners {
    /// #F by 3: each corner's coordinates in the chart of its triangle. Unknowns 2v and 2v + 1 belong to vertex v.
    pub sums: Vec<[PointSum; 3]>,
    /// #F by 3: quarter turns from the first chart of the corner's vertex to the triangle's.
    pub quarters: Vec<[u8; 3]>,
}

/// The coordinates of the corners of a combed field.
pub fn corners(links: &Links, combed: &Combed, faces: &[[usize; 3]]) -> Corners {
    let mut shifts = vec![Turn::default(); combed.parent.len()];
    let mut result =
        Corners { sums: vec![Default::default(); faces.len()], quarters: vec![[0; 3]; faces.len()] };
    let mut on_cut = vec![false; combed.parent.len()];
    for &v in &combed.cut {
        on_cut[v] = true;
        combed.parent[v].iter().for_each(|&parent| on_cut[parent] = true);
    }
    // Children come before their parents: the turns around them are known.
    let rest = (0..combed.parent.len()).filter(|&v| combed.parent[v].is_none());
    for v in combed.cut.iter().copied().chain(rest) {
        let Some(first) = links.first[v] else { continue };
        let parent = combed.parent[v];
        let starts = |&(f, i): &(usize, usize)| parent.is_some_and(|p| faces[f][(i + 1) % 3] == p);
        let start = links.fan(first).find(starts).unwrap_or(first);
        let own: PointSum = [vec![(2 * v, 1.0)], vec![(2 * v + 1, 1.0)]];
        let mut here = Turn::default();
        for (f, i) in links.fan(start) {
            result.sums[f][i] = add(&turn(&own, here.quarters), &here.shift, 1.0);
            result.quarters[f][i] = here.quarters;
            let across = faces[f][(i + 2) % 3];
            if on_cut[v] && combed.parent[across] == Some(v) {
                // Counter-clockwise around v is clockwise around its child: the child's turn backwards.
                let back = (4 - shifts[across].quarters) % 4;
                here.shift = turn(&add(&here.shift, &shifts[across].shift, -1.0), back);
                here.quarters = (here.quarters + back) % 4;
            } else if parent == Some(across) {
                let quarters = combed.jumps[f][(i + 2) % 3];
                let last = add(&turn(&own, here.quarters), &here.shift, 1.0);
                shifts[v] = Turn { quarters, shift: add(&own, &turn(&last, quarters), -1.0) };
            }
        }
    }
    result
}

/// Turned by quarters.
pub fn turn([u, v]: &PointSum, quarters: u8) -> PointSum {
    let negative = |sum: &Sum| sum.iter().map(|&(i, factor)| (i, -factor)).collect();
    match quarters {
        0 => [u.clone(), v.clone()],
        1 => [negative(v), u.clone()],
        2 => [negative(u), negative(v)],
        _ => [v.clone(), negative(u)],
    }
}

fn add(a: &PointSum, b: &PointSum, factor: f64) -> PointSum {
    std::array::from_fn(|k| combine(&a[k], &b[k], factor))
}

/// `a + factor * b`.
pub fn combine(a: &Sum, b: &Sum, factor: f64) -> Sum {
    let mut sum: Sum = a.iter().copied().chain(b.iter().map(|&(i, value)| (i, factor * value))).collect();
    sum.sort_by_key(|&(i, _)| i);
    let mut merged: Sum = Vec::with_capacity(sum.len());
    for (i, value) in sum {
        match merged.last_mut() {
            Some(last) if last.0 == i => last.1 += value,
            _ => merged.push((i, value)),
        }
    }
    merged.retain(|&(_, value)| value != 0.0);
    merged
}

/// The value of a sum.
pub fn value(sum: &Sum, x: &[f64]) -> f64 {
    sum.iter().map(|&(i, factor)| factor * x[i]).sum()
}
