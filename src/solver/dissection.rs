//! Nested dissection: an order of elimination with little fill.
//!
//! Unknowns that are coupled by a block form a clique. Every unknown has a place in a plane, such that coupled
//! unknowns lie near each other; a straight cut through the places then meets few cliques. The unknowns of one
//! side that are coupled to the other side separate the rest; they are eliminated last, and both sides are
//! dissected likewise (A. George, *Nested dissection of a regular finite element mesh*, 1973).

/// A set of consecutively eliminated unknowns, a node of the elimination tree.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Part {
    /// How many unknowns it holds.
    pub size: usize,
    /// The part that separates it from others; always a later one.
    pub parent: Option<usize>,
}

/// An order of elimination with its tree.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Dissection {
    /// The unknowns, in order of elimination.
    pub order: Vec<u32>,
    /// The tree's nodes in order of elimination: children come before their parents.
    pub parts: Vec<Part>,
}

/// Sets of indices, one after the other.
#[derive(Debug, Clone)]
pub struct Cliques {
    starts: Vec<u32>,
    members: Vec<u32>,
}

impl Default for Cliques {
    fn default() -> Self {
        Self { starts: vec![0], members: Vec::new() }
    }
}

impl Cliques {
    /// Adds a set. Sets of fewer than two members couple nothing and are left out.
    pub fn push(&mut self, members: impl IntoIterator<Item = u32>) {
        let before = self.members.len();
        self.members.extend(members);
        if self.members.len() < before + 2 {
            self.members.truncate(before);
        } else {
            self.starts.push(self.members.len() as u32);
        }
    }

    /// The sets.
    pub fn iter(&self) -> impl Iterator<Item = &[u32]> {
        self.starts.windows(2).map(|w| &self.members[w[0] as usize..w[1] as usize])
    }
}

/// Sets of at most this many unknowns are not cut further: below, the bookkeeping costs more than fill.
const LEAF: usize = 48;

/// Each side of a cut must hold this share of the unknowns at least.
const LEAST_SHARE: f64 = 0.3;

/// Orders the unknowns of coupled sets. `places` holds one place per unknown; consecutive unknowns of the same
/// place (the coordinates of a point) stay together.
pub fn dissect(places: &[[f64; 2]], cliques: &Cliques) -> Dissection {
    let mut node_of = Vec::with_capacity(places.len());
    let mut nodes: Vec<Node> = Vec::new();
    for (unknown, &place) in places.iter().enumerate() {
        match nodes.last_mut().filter(|node| node.place == place) {
            Some(node) => node.size += 1,
            None => nodes.push(Node { place, first: unknown as u32, size: 1, rank: 0, reach: 0 }),
        }
        node_of.push((nodes.len() - 1) as u32);
    }
    let mut of_nodes = Cliques::default();
    for clique in cliques.iter() {
        let mut members: Vec<u32> = clique.iter().map(|&u| node_of[u as usize]).collect();
        members.sort_unstable();
        members.dedup();
        of_nodes.push(members);
    }
    let all = (0..nodes.len() as u32).collect();
    let mut work = Work { nodes, order: Vec::with_capacity(places.len()), parts: Vec::new() };
    work.cut(all, of_nodes);
    Dissection { order: work.order, parts: work.parts }
}

struct Node {
    place: [f64; 2],
    first: u32,
    size: u32,
    /// Rank of the coordinate along the axis under trial, and the highest rank coupled to the node.
    rank: u32,
    reach: u32,
}

struct Work {
    nodes: Vec<Node>,
    order: Vec<u32>,
    parts: Vec<Part>,
}

/// A straight cut: nodes up to a rank of one coordinate are left.
struct Cut {
    axis: usize,
    rank: u32,
    cost: f64,
}

impl Work {
    /// Orders a set of nodes with its cliques; returns the parts at the top of the set's tree.
    fn cut(&mut self, set: Vec<u32>, cliques: Cliques) -> Vec<usize> {
        let size: u32 = set.iter().map(|&i| self.nodes[i as usize].size).sum();
        if size as usize <= LEAF {
            return self.emit(&set, Vec::new());
        }
        let [along, across] = [0, 1].map(|axis| self.best_cut(&set, &cliques, axis, size));
        let best = match (along, across) {
            (Some(a), Some(b)) => Some(if b.cost < a.cost { b } else { a }),
            (a, b) => a.or(b),
        };
        let Some(cut) = best else { return self.emit(&set, Vec::new()) };
        self.rank(&set, &cliques, cut.axis);
        let is_right = |node: &Node| node.rank > cut.rank;
        let separates = |node: &Node| node.rank <= cut.rank && node.reach > cut.rank;
        let mut sides = [Vec::new(), Vec::new()];
        let mut separator = Vec::new();
        for &i in &set {
            let node = &self.nodes[i as usize];
            if separates(node) { separator.push(i) } else { sides[usize::from(is_right(node))].push(i) }
        }
        drop(set);
        let mut side_cliques = [Cliques::default(), Cliques::default()];
        for clique in cliques.iter() {
            for (right, kept) in side_cliques.iter_mut().enumerate() {
                let inside = |&&i: &&u32| {
                    let node = &self.nodes[i as usize];
                    !separates(node) && is_right(node) == (right == 1)
                };
                kept.push(clique.iter().filter(inside).copied());
            }
        }
        drop(cliques);
        let [left, right] = sides;
        let [left_cliques, right_cliques] = side_cliques;
        let mut tops = self.cut(left, left_cliques);
        tops.extend(self.cut(right, right_cliques));
        if separator.is_empty() { tops } else { self.emit(&separator, tops) }
    }

    /// Appends a part with these children.
    fn emit(&mut self, set: &[u32], children: Vec<usize>) -> Vec<usize> {
        if set.is_empty() {
            return children;
        }
        let before = self.order.len();
        for &i in set {
            let node = &self.nodes[i as usize];
            self.order.extend(node.first..node.first + node.size);
        }
        let part = self.parts.len();
        children.into_iter().for_each(|child| self.parts[child].parent = Some(part));
        self.parts.push(Part { size: self.order.len() - before, parent: None });
        vec![part]
    }

    /// Ranks the nodes of a set along an axis and finds how far each is coupled. Returns the number of ranks.
    fn rank(&mut self, set: &[u32], cliques: &Cliques, axis: usize) -> u32 {
        let mut sorted: Vec<(f64, u32)> =
            set.iter().map(|&i| (self.nodes[i as usize].place[axis], i)).collect();
        sorted.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut rank = 0;
        let mut last = sorted.first().map_or(0.0, |first| first.0);
        for (coordinate, i) in sorted {
            if coordinate > last {
                rank += 1;
                last = coordinate;
            }
            let node = &mut self.nodes[i as usize];
            node.rank = rank;
            node.reach = rank;
        }
        for clique in cliques.iter() {
            let far = clique.iter().map(|&i| self.nodes[i as usize].rank).max().unwrap_or(0);
            for &i in clique {
                let node = &mut self.nodes[i as usize];
                node.reach = node.reach.max(far);
            }
        }
        rank + 1
    }

    /// The cut across an axis whose separator is smallest, among those that leave enough on both sides.
    fn best_cut(&mut self, set: &[u32], cliques: &Cliques, axis: usize, size: u32) -> Option<Cut> {
        let ranks = self.rank(set, cliques, axis) as usize;
        let (mut at, mut opened) = (vec![0_i64; ranks + 1], vec![0_i64; ranks + 1]);
        for node in set.iter().map(|&i| &self.nodes[i as usize]) {
            at[node.rank as usize] += i64::from(node.size);
            opened[node.rank as usize] += i64::from(node.size);
            opened[node.reach as usize] -= i64::from(node.size);
        }
        let total = f64::from(size);
        let (mut left, mut separator) = (0, 0);
        let mut best: Option<Cut> = None;
        for rank in 0..ranks - 1 {
            left += at[rank];
            separator += opened[rank];
            let share = (left as f64 / total).min(1.0 - left as f64 / total);
            // Work grows with the cube of the separator; an uneven cut makes the larger side cost more.
            let cost = (separator as f64).powi(3) / (share * total);
            if share >= LEAST_SHARE && best.as_ref().is_none_or(|best| cost < best.cost) {
                best = Some(Cut { axis, rank: rank as u32, cost });
            }
        }
        best
    }
}

#[cfg(test)]
mod tests;
