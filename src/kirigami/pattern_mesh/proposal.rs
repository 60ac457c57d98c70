//! The cuts that let neighbours alternate: as short as can be.
//!
//! Sides along which the sheet is cut join no neighbours. Which sides must be cut is known from the largest cut of a
//! planar graph (F. Hadlock, *Finding a maximum cut of a planar graph in polynomial time*, 1975): the cut sides must
//! meet every odd place an odd number of times and every even place an even number of times, where each border loop
//! is one place. The shortest such set (a *T-join*) consists of shortest paths that pair the odd places off, the
//! outer border among them where it is odd; a path may run through the border. The pairs are the best of all for up
//! to [`MOST_EXACT`] odd places, beyond that good ones (nearest first, then exchanged while that helps), and beyond
//! [`MOST_PAIRED`] none are sought: such a mesh is not meant to alternate.
//!
//! Such a set has no closed way in it, taking borders as one place each: what would close up is left away, which
//! keeps all parities. A set of sides without closed ways never leaves the sheet in two.
//!
//! Cuts to the border instead put every odd place on the outer border, where nothing needs to be even, along the
//! shortest path of each. Together these paths are a tree that grows from the border.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet, BinaryHeap};

use crate::geometry::Point3;
use crate::geometry::union_find::UnionFind;
use crate::kirigami::piece_mesh::PieceMesh;

pub use super::matching::MOST_EXACT;
use super::matching::matching;

/// Up to this number of odd places pairs are sought: the time is that many searches through the whole mesh.
pub const MOST_PAIRED: usize = 500;

/// Inner corners and border loops as nodes, inner sides as edges.
pub(super) struct Graph {
    /// #corners: first the loops in their order, then the inner corners.
    pub node_of: Vec<usize>,
    node_count: usize,
    /// Index into the mesh's edges, nodes at both ends, length.
    edges: Vec<(usize, [usize; 2], f64)>,
    /// #nodes: indices into `edges`.
    at: Vec<Vec<usize>>,
}

/// Cuts to propose.
pub(super) struct Proposal {
    /// Paths over the sheet's corners.
    pub paths: Vec<Vec<usize>>,
    /// Their length together.
    pub length: f64,
    /// Whether it is certain that no other would be shorter.
    pub shortest: bool,
}

impl Graph {
    pub fn new(mesh: &PieceMesh, corners: &[Point3], loops: &[Vec<usize>]) -> Self {
        let mut node_of = vec![usize::MAX; mesh.corner_count];
        for (node, cycle) in loops.iter().enumerate() {
            cycle.iter().for_each(|&corner| node_of[corner] = node);
        }
        let mut node_count = loops.len();
        for node in node_of.iter_mut().filter(|node| **node == usize::MAX) {
            *node = node_count;
            node_count += 1;
        }
        let inner = mesh.edges.iter().enumerate().filter(|(_, edge)| !edge.is_border());
        let edges: Vec<(usize, [usize; 2], f64)> = inner
            .map(|(e, edge)| {
                let [p, q] = edge.corners;
                (e, [node_of[p], node_of[q]], (corners[q] - corners[p]).norm())
            })
            .collect();
        let mut at = vec![Vec::new(); node_count];
        for (i, (_, ends, _)) in edges.iter().enumerate() {
            ends.iter().for_each(|&node| at[node].push(i));
        }
        Self { node_of, node_count, edges, at }
    }

    /// For each node the number of inner sides that end there.
    pub fn valences(&self) -> Vec<usize> {
        self.at.iter().map(Vec::len).collect()
    }

    /// Distance of every node from `start`, and the edge by which the shortest path arrives there (Dijkstra).
    fn distances(&self, start: usize) -> (Vec<f64>, Vec<usize>) {
        let mut distance = vec![f64::INFINITY; self.node_count];
        let mut arrival = vec![usize::MAX; self.node_count];
        distance[start] = 0.0;
        // The bits of numbers that are not negative order as they do.
        let mut open = BinaryHeap::from([Reverse((0_u64, start))]);
        while let Some(Reverse((bits, node))) = open.pop() {
            if f64::from_bits(bits) > distance[node] {
                continue;
            }
            for &edge in &self.at[node] {
                let (_, ends, length) = self.edges[edge];
                let far = if ends[0] == node { ends[1] } else { ends[0] };
                let through = distance[node] + length;
                if through < distance[far] {
                    distance[far] = through;
                    arrival[far] = edge;
                    open.push(Reverse((through.to_bits(), far)));
                }
            }
        }
        (distance, arrival)
    }

    /// The edges of the shortest path to `end`, given how it arrives at each node.
    fn path_to(&self, end: usize, arrival: &[usize]) -> Vec<usize> {
        let mut path = Vec::new();
        let mut at = end;
        while let Some((_, ends, _)) = self.edges.get(arrival[at]) {
            path.push(arrival[at]);
            at = if ends[0] == at { ends[1] } else { ends[0] };
        }
        path
    }

    /// The part of a set of edges that meets the same nodes an odd number of times and has no closed way in it.
    fn without_cycles(&self, set: &BTreeSet<usize>) -> BTreeSet<usize> {
        let mut odd = vec![false; self.node_count];
        set.iter().flat_map(|&edge| self.edges[edge].1).for_each(|node| odd[node] = !odd[node]);
        let mut order: Vec<usize> = set.iter().copied().collect();
        order.sort_by(|&i, &j| self.edges[i].2.total_cmp(&self.edges[j].2).then(i.cmp(&j)));
        let mut joined = UnionFind::new(self.node_count);
        let mut tree: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
        for edge in order {
            let [p, q] = self.edges[edge].1;
            if !joined.same(p, q) {
                joined.join(p, q);
                tree.entry(p).or_default().insert(edge);
                tree.entry(q).or_default().insert(edge);
            }
        }
        // From the leaves inwards: the one edge of a leaf is needed where the leaf is odd.
        let mut kept = BTreeSet::new();
        let mut leaves: Vec<usize> =
            tree.iter().filter(|(_, e)| e.len() == 1).map(|(&node, _)| node).collect();
        while let Some(leaf) = leaves.pop() {
            let Some(edge) = tree.get_mut(&leaf).and_then(BTreeSet::pop_first) else { continue };
            let ends = self.edges[edge].1;
            let far = if ends[0] == leaf { ends[1] } else { ends[0] };
            if odd[leaf] {
                kept.insert(edge);
                odd[far] = !odd[far];
            }
            let rest = tree.entry(far).or_default();
            rest.remove(&edge);
            if rest.len() == 1 {
                leaves.push(far);
            }
        }
        kept
    }
}

/// The shortest cuts that make all `terminals` even, which must be all odd nodes; for more than [`MOST_PAIRED`] of
/// them those of [`to_border`].
pub(super) fn shortest(graph: &Graph, mesh: &PieceMesh, terminals: &[usize]) -> Proposal {
    if terminals.len() > MOST_PAIRED {
        return to_border(graph, mesh, terminals);
    }
    let to_all = |&t: &usize| {
        let (distance, _) = graph.distances(t);
        terminals.iter().map(|&t| distance[t]).collect()
    };
    let lengths: Vec<Vec<f64>> = terminals.iter().map(to_all).collect();
    let mut set = BTreeSet::new();
    for [i, j] in matching(&lengths) {
        for edge in graph.path_to(terminals[j], &graph.distances(terminals[i]).1) {
            // What two paths have in common cancels.
            if !set.remove(&edge) {
                set.insert(edge);
            }
        }
    }
    proposal(graph, mesh, &graph.without_cycles(&set), terminals.len() <= MOST_EXACT)
}

/// Cuts that join all `terminals` to the outer border, the first node.
pub(super) fn to_border(graph: &Graph, mesh: &PieceMesh, terminals: &[usize]) -> Proposal {
    let (_, arrival) = graph.distances(0);
    let set = terminals.iter().flat_map(|&terminal| graph.path_to(terminal, &arrival)).collect();
    proposal(graph, mesh, &set, false)
}

fn proposal(graph: &Graph, mesh: &PieceMesh, set: &BTreeSet<usize>, shortest: bool) -> Proposal {
    let length = set.iter().map(|&edge| graph.edges[edge].2).sum();
    let edges = set.iter().map(|&edge| mesh.edges[graph.edges[edge].0].corners).collect();
    Proposal { paths: paths(mesh, edges), length, shortest }
}

/// Joins edges to paths over corners, which end at the border and wherever other than two edges meet.
fn paths(mesh: &PieceMesh, edges: Vec<[usize; 2]>) -> Vec<Vec<usize>> {
    let mut at: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
    for [p, q] in edges {
        at.entry(p).or_default().insert(q);
        at.entry(q).or_default().insert(p);
    }
    let ends: BTreeSet<usize> =
        at.iter().filter(|(c, far)| far.len() != 2 || !mesh.fans[**c].closed).map(|(&c, _)| c).collect();
    let mut paths = Vec::new();
    for &start in &ends {
        while let Some(mut next) = at.get(&start).and_then(|far| far.first().copied()) {
            let mut path = vec![start];
            loop {
                let from = path[path.len() - 1];
                at.entry(from).or_default().remove(&next);
                at.entry(next).or_default().remove(&from);
                path.push(next);
                match at.get(&next).and_then(|far| far.first().copied()) {
                    Some(after) if !ends.contains(&next) => next = after,
                    _ => break,
                }
            }
            paths.push(path);
        }
    }
    paths
}
