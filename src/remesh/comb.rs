//! From crosses to one direction per triangle: singular vertices, cuts to the boundary, and the quarter turns
//! that remain across the cuts.

use super::links::Links;
use crate::geometry::mesh::TriMesh;
use nalgebra::Complex;
use std::cmp::Ordering;
use std::collections::{BinaryHeap, VecDeque};
use std::f64::consts::{FRAC_PI_2, PI};

/// A combed field on a disk that is cut open from its singular vertices to its boundary.
#[derive(Debug, Clone)]
pub struct Combed {
    /// #F: the chosen direction of the cross, a unit complex number in the triangle's frame.
    pub directions: Vec<Complex<f64>>,
    /// #F: quarter turns that take coordinates of this triangle to those of its neighbour across each edge, 0 to 3;
    /// 0 where no cut runs.
    pub jumps: Vec<[u8; 3]>,
    /// Singular vertices, each with four times its index: 1 where a piece has three corners, -1 where it has five. Those
    /// farthest from the boundary first.
    pub singular: Vec<(usize, i32)>,
    /// #V: the next vertex of the cut towards the boundary; `None` off the cut and at its end.
    pub parent: Vec<Option<usize>>,
    /// The vertices that have a parent, those farthest from the boundary first.
    pub cut: Vec<usize>,
}

/// Combs a field. `boundary` is the boundary loop.
pub fn comb(mesh: &TriMesh, links: &Links, crosses: &[Complex<f64>], boundary: &[usize]) -> Combed {
    let mut singular = singular_vertices(mesh, links, crosses, boundary);
    let (towards, distance) = ways_out(mesh, links, boundary, !singular.is_empty());
    // An order that does not depend on the vertices' numbers.
    singular.sort_by(|a, b| distance[b.0].total_cmp(&distance[a.0]));
    let mut parent = vec![None; mesh.vertices.len()];
    let mut cut = Vec::new();
    for &(vertex, _) in &singular {
        let mut at = vertex;
        while let (Some(next), None) = (towards[at], parent[at]) {
            parent[at] = Some(next);
            cut.push(at);
            at = next;
        }
    }
    cut.sort_by(|&a, &b| distance[b].total_cmp(&distance[a]).then(a.cmp(&b)));
    let is_cut = |f: usize, i: usize| {
        let (a, b) = (mesh.faces[f][i], mesh.faces[f][(i + 1) % 3]);
        parent[a] == Some(b) || parent[b] == Some(a)
    };
    let mut directions = crosses.to_vec();
    let mut seen = vec![false; crosses.len()];
    let mut queue = VecDeque::from([0]);
    seen[0] = true;
    while let Some(f) = queue.pop_front() {
        for i in 0..3 {
            let (Some((g, _)), Some(turn)) = (links.across[f][i], links.turn(f, i)) else { continue };
            if !seen[g] && !is_cut(f, i) {
                directions[g] = turned(directions[g], quarters(directions[g], directions[f] * turn));
                seen[g] = true;
                queue.push_back(g);
            }
        }
    }
    let jump = |f: usize, i: usize| match (links.across[f][i], links.turn(f, i)) {
        // The neighbour's direction is ahead by so many quarters, so coordinates there turn back by them.
        (Some((g, _)), Some(turn)) => (4 - quarters(directions[f] * turn, directions[g])) % 4,
        _ => 0,
    };
    let jumps = (0..crosses.len()).map(|f| std::array::from_fn(|i| jump(f, i))).collect();
    Combed { directions, jumps, singular, parent, cut }
}

/// How many quarter turns bring `from` nearest to `to`, 0 to 3.
fn quarters(from: Complex<f64>, to: Complex<f64>) -> u8 {
    ((to * from.conj()).arg() / FRAC_PI_2).round().rem_euclid(4.0) as u8 % 4
}

/// A direction after quarter turns.
pub fn turned(direction: Complex<f64>, quarters: u8) -> Complex<f64> {
    match quarters {
        0 => direction,
        1 => Complex::new(-direction.im, direction.re),
        2 => -direction,
        _ => Complex::new(direction.im, -direction.re),
    }
}

/// Inner vertices around which the field turns by a part of a circle that the surface does not explain.
fn singular_vertices(
    mesh: &TriMesh,
    links: &Links,
    crosses: &[Complex<f64>],
    boundary: &[usize],
) -> Vec<(usize, i32)> {
    let mut inner = vec![true; mesh.vertices.len()];
    boundary.iter().for_each(|&v| inner[v] = false);
    let index = |v: usize| {
        let mut total = 2.0 * PI;
        for (f, i) in links.fan(links.first[v]?) {
            let [before, after] = [-links.edges[f][(i + 2) % 3], links.edges[f][i]];
            total -= (before * after.conj()).arg().abs();
            let (g, _) = links.next_around((f, i))?;
            let carried = crosses[f] * links.turn(f, (i + 2) % 3)?;
            let rest = turned(carried, quarters(carried, crosses[g]));
            total += (crosses[g] * rest.conj()).arg();
        }
        let index = (total / FRAC_PI_2).round() as i32;
        (index != 0).then_some((v, index))
    };
    (0..mesh.vertices.len()).filter(|&v| inner[v]).filter_map(index).collect()
}

/// A vertex on the way from the boundary, nearest first.
struct Reached {
    distance: f64,
    vertex: usize,
}

impl Ord for Reached {
    fn cmp(&self, other: &Self) -> Ordering {
        other.distance.total_cmp(&self.distance).then(other.vertex.cmp(&self.vertex))
    }
}

impl PartialOrd for Reached {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Reached {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Reached {}

/// The next vertex on the shortest way along edges to the boundary, and the way's length.
fn ways_out(
    mesh: &TriMesh,
    links: &Links,
    boundary: &[usize],
    wanted: bool,
) -> (Vec<Option<usize>>, Vec<f64>) {
    let mut towards = vec![None; mesh.vertices.len()];
    let mut distance = vec![f64::INFINITY; mesh.vertices.len()];
    if !wanted {
        return (towards, distance);
    }
    let mut heap = BinaryHeap::new();
    for &vertex in boundary {
        distance[vertex] = 0.0;
        heap.push(Reached { distance: 0.0, vertex });
    }
    while let Some(Reached { distance: reached, vertex }) = heap.pop() {
        let Some(start) = links.first[vertex].filter(|_| reached <= distance[vertex]) else { continue };
        for (f, i) in links.fan(start) {
            for (end, edge) in [((i + 1) % 3, i), ((i + 2) % 3, (i + 2) % 3)] {
                let (next, length) = (mesh.faces[f][end], reached + links.edges[f][edge].norm());
                if length < distance[next] {
                    distance[next] = length;
                    towards[next] = Some(vertex);
                    heap.push(Reached { distance: length, vertex: next });
                }
            }
        }
    }
    (towards, distance)
}
