//! Which way round pieces run: listed the other way round in both states, or turned over in one of them.

use crate::geometry::plane::doubled_area;
use crate::geometry::union_find::UnionFind;
use crate::geometry::{Point3, Vector3};
use crate::kirigami::hinges::Joint;

/// Two normals this far from a right angle (cosine) tell whether neighbours show the same side.
const TELLING: f64 = 0.2;

/// What is wrong with the order of corners.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Sides {
    /// Pieces that run the other way round than most, in both states.
    pub reversed: Vec<usize>,
    /// Pieces that show one side among their neighbours in one state and the other side in the other.
    pub mirrored: Vec<usize>,
}

/// How two hinged neighbours lie to each other.
struct Relation {
    pieces: [usize; 2],
    /// How certain it is.
    strength: f64,
    /// Whether the normals are opposite in the closed state.
    opposite: bool,
    /// Whether that differs between the two states.
    turned: bool,
}

/// Compares neighbours along the tree of joints whose normals tell most. Pieces must have areas.
pub fn sides(closed: &[Vec<Point3>], open: &[Vec<Point3>], joints: &[Joint]) -> Sides {
    let [closed, open] = [closed, open]
        .map(|state| state.iter().map(|p| doubled_area(p).normalize()).collect::<Vec<Vector3>>());
    let mut relations: Vec<Relation> = joints
        .iter()
        .map(|joint| {
            let [j, k] = joint.pieces;
            let [c, o] = [closed[j].dot(&closed[k]), open[j].dot(&open[k])];
            let strength = c.abs().min(o.abs());
            Relation {
                pieces: [j, k],
                strength,
                opposite: c < 0.0,
                turned: strength > TELLING && c * o < 0.0,
            }
        })
        .collect();
    // A stable sort: joints of one strength stay in their order.
    relations.sort_by(|a, b| b.strength.total_cmp(&a.strength));
    let count = closed.len();
    let mut neighbours = vec![Vec::new(); count];
    let mut tree = UnionFind::new(count);
    for Relation { pieces: [j, k], opposite, turned, .. } in relations {
        if !tree.same(j, k) {
            tree.join(j, k);
            neighbours[j].push((k, opposite, turned));
            neighbours[k].push((j, opposite, turned));
        }
    }
    let (mut seen, mut reversed, mut mirrored) = (vec![false; count], vec![false; count], vec![false; count]);
    let mut waiting = vec![0];
    seen[0] = true;
    while let Some(j) = waiting.pop() {
        for &(k, opposite, turned) in &neighbours[j] {
            if !std::mem::replace(&mut seen[k], true) {
                reversed[k] = reversed[j] != opposite;
                mirrored[k] = mirrored[j] != turned;
                waiting.push(k);
            }
        }
    }
    Sides { reversed: minority(&reversed), mirrored: minority(&mirrored) }
}

/// The indices of the value that is rarer; of `true` where both are as frequent.
fn minority(values: &[bool]) -> Vec<usize> {
    let count = values.iter().filter(|value| **value).count();
    let rarer = 2 * count <= values.len();
    (0..values.len()).filter(|&i| values[i] == rarer).collect()
}
