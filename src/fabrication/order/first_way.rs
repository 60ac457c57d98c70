//! A first way through stops with two ends, from the shortest links between near ones.

use kurbo::Point;

use super::nearest::{Grid, neighbours};
use crate::geometry::union_find::UnionFind;

/// Near ends that are tried per end.
const LISTED: usize = 8;
/// By how much links are taken for longer than they are for first ways other than the first, relative.
const DIFFERENCE: f64 = 0.3;

/// The places where a stop may be entered and left at one of its ends; one place twice where there is no choice.
pub(super) type End = [Point; 2];

/// The shortest way from any place of one end to any of another, millimetres.
pub(super) fn gap(from: End, to: End) -> f64 {
    from.iter().flat_map(|a| to.map(|b| a.distance(b))).fold(f64::INFINITY, f64::min)
}

/// Of every end the nearest ones of other stops, nearest first.
pub(super) fn near_ends(ends: &[End]) -> Vec<Vec<(f64, u32)>> {
    let places: Vec<Point> = ends.iter().flatten().copied().collect();
    // An end may be found by either of its places, from either.
    let lists = neighbours(&places, 2 * LISTED, |i, j| i / 4 == j / 4);
    let of = |(end, lists): (usize, &[Vec<(f64, u32)>])| {
        let mut others: Vec<u32> = lists.iter().flatten().map(|&(_, place)| place / 2).collect();
        others.sort_unstable();
        others.dedup();
        let mut near: Vec<(f64, u32)> =
            others.into_iter().map(|other| (gap(ends[end], ends[other as usize]), other)).collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        near.truncate(LISTED);
        near
    };
    lists.chunks_exact(2).enumerate().map(of).collect()
}

/// A pseudo-random sequence (splitmix64).
pub(super) struct Dice(pub u64);

impl Dice {
    /// A number from 0 to `limit` - 1.
    pub fn below(&mut self, limit: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) % limit.max(1)
    }
}

/// A first way: the shortest links between near ends that leave every end with one at most and close no ring, then from
/// the home the chain that begins or ends nearest, and so on. `start`: another way for each number, that of true lengths for 0.
pub(super) fn chained(ends: &[End], near: &[Vec<(f64, u32)>], home: Point, start: u64) -> Vec<u32> {
    let mut links: Vec<(f64, u32, u32)> = Vec::new();
    for (i, list) in near.iter().enumerate() {
        links.extend(list.iter().map(|&(distance, j)| (distance, (i as u32).min(j), (i as u32).max(j))));
    }
    if start > 0 {
        let mut dice = Dice(start);
        let mut longer = || 1.0 + DIFFERENCE * dice.below(1 << 20) as f64 / (1 << 20) as f64;
        links.iter_mut().for_each(|link| link.0 *= longer());
    }
    links.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut partner: Vec<Option<u32>> = vec![None; ends.len()];
    let mut sets = UnionFind::new(ends.len() / 2);
    for (_, i, j) in links {
        let free = partner[i as usize].is_none() && partner[j as usize].is_none();
        if free && !sets.same(i as usize / 2, j as usize / 2) {
            sets.join(i as usize / 2, j as usize / 2);
            (partner[i as usize], partner[j as usize]) = (Some(j), Some(i));
        }
    }
    // The ends of the chains; a stop alone has two.
    let loose: Vec<u32> = (0..ends.len() as u32).filter(|&end| partner[end as usize].is_none()).collect();
    let places: Vec<Point> = loose.iter().flat_map(|&end| ends[end as usize]).collect();
    let grid = Grid::new(&places);
    let mut used = vec![false; ends.len() / 2];
    let mut tour = Vec::with_capacity(used.len());
    let mut at = [home; 2];
    let next = |at: End, used: &[bool]| {
        let from = |at: Point| grid.nearest(at, 1, |i| !used[loose[i as usize / 2] as usize / 2]);
        let found = at.iter().flat_map(|&at| from(at)).min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        found.map(|(_, place)| loose[place as usize / 2])
    };
    while let Some(mut end) = next(at, &used) {
        loop {
            tour.push(end);
            used[end as usize / 2] = true;
            at = ends[end as usize ^ 1];
            match partner[end as usize ^ 1] {
                Some(next) => end = next,
                None => break,
            }
        }
    }
    tour
}
