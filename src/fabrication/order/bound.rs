//! A lower bound of the way between cuts: the minimum spanning tree over the cuts, two of which are as far apart as
//! their nearest ends.
//!
//! Every order of the cuts is a tree over them, so none travels less, whatever it begins with and ends with. The tree is
//! grown by Borůvka's rule: every part takes the shortest link that leaves it. What a point's list of neighbours does not
//! hold is looked for beyond it, so that the tree is exact.

use kurbo::Point;

use super::nearest::{Grid, neighbours};
use crate::geometry::union_find::UnionFind;

/// Neighbours that are listed per point. Most links are among the first few.
const LISTED: usize = 8;

/// Length of the minimum spanning tree, millimetres. `groups`: where each cut may begin or end; ways within a group are
/// free.
pub fn spanning_tree(groups: &[Vec<Point>]) -> f64 {
    let points: Vec<Point> = groups.iter().flatten().copied().collect();
    let group: Vec<u32> =
        groups.iter().enumerate().flat_map(|(i, group)| group.iter().map(move |_| i as u32)).collect();
    let lists = neighbours(&points, LISTED, |i, j| group[i as usize] == group[j as usize]);
    let grid = Grid::new(&points);
    let filled = groups.iter().filter(|group| !group.is_empty()).count();
    let mut sets = UnionFind::new(groups.len());
    let mut links = 0;
    let mut length = 0.0;
    while links + 1 < filled {
        let roots: Vec<usize> = (0..groups.len()).map(|i| sets.root(i)).collect();
        let mut best: Vec<Option<(f64, u32, u32)>> = vec![None; groups.len()];
        let foreign = |root: usize, j: u32| roots[group[j as usize] as usize] != root;
        for (i, list) in lists.iter().enumerate() {
            let root = roots[group[i] as usize];
            let limit = best[root].map_or(f64::INFINITY, |(distance, ..)| distance);
            let listed = list.iter().copied().find(|&(_, j)| foreign(root, j));
            let beyond = || match list.last() {
                Some(&(farthest, _)) if list.len() == LISTED && farthest >= limit => None,
                _ => grid.nearest(points[i], 1, |j| foreign(root, j)).first().copied(),
            };
            if let Some((distance, j)) = listed.or_else(beyond) {
                // Ties by index on both sides alike, or parts could join in a ring.
                let link = (distance, (i as u32).min(j), (i as u32).max(j));
                let better = best[root].is_none_or(|old| {
                    link.0.total_cmp(&old.0).then(link.1.cmp(&old.1)).then(link.2.cmp(&old.2)).is_lt()
                });
                if better {
                    best[root] = Some(link);
                }
            }
        }
        let before = links;
        for (distance, i, j) in best.into_iter().flatten() {
            let [a, b] = [i, j].map(|point| group[point as usize] as usize);
            if !sets.same(a, b) {
                sets.join(a, b);
                links += 1;
                length += distance;
            }
        }
        if links == before {
            break; // nothing to link: coordinates that are not finite
        }
    }
    length
}
