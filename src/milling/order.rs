//! The order of openings that takes the least time between them, whatever a machine's axes need for each way.

use rayon::prelude::*;

/// Near places that are tried from each.
const LISTED: usize = 12;

/// Most places that are moved together.
const LONGEST_MOVE: usize = 3;

/// Beyond so many places the order stays as it is: all ways between them are looked at.
const MOST: usize = 6000;

/// Gains below this are rounding.
const GAIN: f64 = 1e-9;

/// An order of `count` places, beginning with the first of the order given (their numbers), in which the ways between
/// successive ones are short: by turning stretches round (2-opt) and moving up to three places (Or-opt), until neither
/// helps. `way`: time between two places, the same both ways.
pub fn shortened(count: usize, way: &(dyn Fn(usize, usize) -> f64 + Sync)) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    if !(4..=MOST).contains(&count) {
        return order;
    }
    let near: Vec<Vec<usize>> = (0..count).into_par_iter().map(|from| nearest(from, count, way)).collect();
    let mut search = Search { place: order.clone(), order: &mut order, near: &near, way };
    while search.pass() {}
    order
}

fn nearest(from: usize, count: usize, way: &(dyn Fn(usize, usize) -> f64 + Sync)) -> Vec<usize> {
    let mut ways: Vec<(f64, usize)> =
        (0..count).filter(|&to| to != from).map(|to| (way(from, to), to)).collect();
    let listed = LISTED.min(ways.len());
    let by_way = |a: &(f64, usize), b: &(f64, usize)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
    if ways.len() > listed {
        ways.select_nth_unstable_by(listed, by_way);
        ways.truncate(listed);
    }
    ways.sort_by(by_way);
    ways.into_iter().map(|(_, to)| to).collect()
}

struct Search<'a> {
    order: &'a mut Vec<usize>,
    /// Where in the order each stands.
    place: Vec<usize>,
    near: &'a [Vec<usize>],
    way: &'a (dyn Fn(usize, usize) -> f64 + Sync),
}

impl Search<'_> {
    /// Tries every place once; whether anything was gained.
    fn pass(&mut self) -> bool {
        let mut gained = false;
        for place in 0..self.order.len() {
            let near = self.near;
            for &other in &near[place] {
                gained |= self.turn(place, other) || self.shift(place, other);
            }
        }
        gained
    }

    /// The way between the places at two positions of the order; nothing before its beginning and after its end.
    fn step(&self, a: isize, b: isize) -> f64 {
        let at = |i: isize| usize::try_from(i).ok().and_then(|i| self.order.get(i)).copied();
        at(a).zip(at(b)).map_or(0.0, |(a, b)| (self.way)(a, b))
    }

    /// Makes `b` follow `a`, or `a` precede `b`, by turning round what is between; the first place stays.
    fn turn(&mut self, a: usize, b: usize) -> bool {
        let (i, j) = (self.place[a].min(self.place[b]), self.place[a].max(self.place[b]));
        let ways = [(i + 1, j), (i, j.wrapping_sub(1))];
        for (from, to) in ways {
            if from == 0 || from >= to || to == usize::MAX {
                continue;
            }
            let (f, t) = (from as isize, to as isize);
            let before = self.step(f - 1, f) + self.step(t, t + 1);
            let after =
                self.step(f - 1, t) + if to + 1 < self.order.len() { self.step(f, t + 1) } else { 0.0 };
            if after < before - GAIN {
                self.order[from..=to].reverse();
                self.place(from, to);
                return true;
            }
        }
        false
    }

    /// Moves `a` and up to two that follow it to behind `b`, turned round or not.
    fn shift(&mut self, a: usize, b: usize) -> bool {
        for length in 1..=LONGEST_MOVE {
            let (from, to, behind) = (self.place[a], self.place[a] + length - 1, self.place[b]);
            if from == 0 || to >= self.order.len() || (from..=to).contains(&behind) || behind + 1 == from {
                continue;
            }
            let (f, t, g) = (from as isize, to as isize, behind as isize);
            let closes = if to + 1 < self.order.len() { self.step(f - 1, t + 1) } else { 0.0 };
            let saved = self.step(f - 1, f) + self.step(t, t + 1) + self.step(g, g + 1) - closes;
            let last = behind + 1 == self.order.len();
            let costs = [(f, t), (t, f)]
                .map(|(first, end)| self.step(g, first) + if last { 0.0 } else { self.step(end, g + 1) });
            let back = costs[1] < costs[0];
            if costs[usize::from(back)] < saved - GAIN {
                let mut moved: Vec<usize> = self.order.drain(from..=to).collect();
                if back {
                    moved.reverse();
                }
                let at = if behind > to { behind + 1 - length } else { behind + 1 };
                self.order.splice(at..at, moved);
                self.place(from.min(at), to.max(behind));
                return true;
            }
        }
        false
    }

    fn place(&mut self, from: usize, to: usize) {
        for at in from..=to.min(self.order.len() - 1) {
            self.place[self.order[at]] = at;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scrambled_grid_is_walked_with_hardly_a_detour() {
        // 12 x 12 places of a grid in a scrambled order: no way is shorter than 143 steps.
        let count = 144;
        let at = |i: usize| {
            let scrambled = (i * 89 + 40) % count;
            [(scrambled % 12) as f64, (scrambled / 12) as f64]
        };
        let way = |a: usize, b: usize| (at(a)[0] - at(b)[0]).hypot(at(a)[1] - at(b)[1]);
        let order = shortened(count, &way);
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert_eq!(sorted, (0..count).collect::<Vec<_>>());
        assert_eq!(order[0], 0);
        let length: f64 = order.windows(2).map(|pair| way(pair[0], pair[1])).sum();
        assert!(length < 1.12 * 143.0, "{length}");
        assert_eq!(shortened(3, &way), [0, 1, 2]);
    }
}
