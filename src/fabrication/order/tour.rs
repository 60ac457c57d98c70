//! The shortest way through stops that have two ends: in at one, out at the other, whichever way round.
//!
//! The way begins as chains of the shortest links (greedy matching, as nearest neighbours that nobody else needs more),
//! joined by nearest neighbour. It is then improved by turning stretches round (2-opt) and by moving up to three stops
//! elsewhere (Or-opt), along lists of near ends. Last it is shaken: two short stretches change places somewhere, the
//! neighbourhood is improved again, and what came out longer is taken back. All in a fixed order with a fixed seed.

use kurbo::Point;

use super::nearest::{Grid, neighbours};
use crate::geometry::union_find::UnionFind;

/// Near ends that are tried per end.
const LISTED: usize = 8;
/// Most stops that are turned round at once, at first and after a shake: longer turns cost more time than they are worth
/// on large sheets.
const LONGEST_TURN: [usize; 2] = [30_000, 1000];
/// Most stops that are moved together.
const LONGEST_MOVE: usize = 3;
/// Shakes per stop, and at most.
const SHAKES: [usize; 2] = [20, 8000];
/// Longest stretch that a shake moves, stops.
const LONGEST_SHAKE: u64 = 30;
/// Gains below this are rounding, millimetres.
const GAIN: f64 = 1e-9;

/// Where the way begins and ends.
pub struct Frame<'a> {
    /// The place before the first stop.
    pub home: Point,
    /// Way from a place to what follows the last stop, millimetres.
    pub onwards: &'a (dyn Fn(Point) -> f64 + Sync),
}

/// The order of the stops: index, and whether it is run through from its second end to its first.
pub fn tour(stops: &[[Point; 2]], frame: &Frame) -> Vec<(usize, bool)> {
    if stops.is_empty() {
        return Vec::new();
    }
    let ends: Vec<Point> = stops.iter().flatten().copied().collect();
    let near = neighbours(&ends, LISTED, |i, j| i / 2 == j / 2);
    let mut search = Search::new(&ends, &near, frame);
    let mut all: Vec<u32> = (0..stops.len() as u32).rev().collect();
    search.improve(&mut all);
    search.shake();
    search.tour.iter().map(|&entry| (entry as usize / 2, entry % 2 == 1)).collect()
}

/// A pseudo-random sequence (splitmix64).
struct Dice(u64);

impl Dice {
    fn below(&mut self, limit: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) % limit.max(1)
    }
}

/// A change of the way.
#[derive(Clone, Copy)]
enum Move {
    /// Turns round the stops from the first to the last place.
    Turn(usize, usize),
    /// Moves the stops of the two places before the third, turned round or not.
    Shift(usize, usize, usize, bool),
}

/// Ends are numbered by stop, 2 s and 2 s + 1; a visit is known by the end where it begins.
struct Search<'a> {
    ends: &'a [Point],
    near: &'a [Vec<(f64, u32)>],
    home: Point,
    onwards: Vec<f64>,
    /// The end at which every visit begins, in order.
    tour: Vec<u32>,
    /// The place of every stop in the tour.
    place: Vec<u32>,
    /// Most stops that are turned round at once.
    longest_turn: usize,
    /// The turns since the last shake.
    journal: Vec<(usize, usize)>,
}

impl<'a> Search<'a> {
    fn new(ends: &'a [Point], near: &'a [Vec<(f64, u32)>], frame: &Frame) -> Self {
        use rayon::prelude::*;
        let onwards = ends.par_iter().map(|&end| (frame.onwards)(end)).collect();
        let tour = chained(ends, near, frame.home);
        let mut place = vec![0; tour.len()];
        tour.iter().enumerate().for_each(|(at, &entry)| place[entry as usize / 2] = at as u32);
        Self {
            ends,
            near,
            home: frame.home,
            onwards,
            tour,
            place,
            longest_turn: LONGEST_TURN[0],
            journal: Vec::new(),
        }
    }

    fn entry(&self, place: usize) -> Option<u32> {
        self.tour.get(place).copied()
    }

    /// The end where the visit before a place ends.
    fn exit_before(&self, place: usize) -> Option<u32> {
        place.checked_sub(1).map(|before| self.tour[before] ^ 1)
    }

    fn way(&self, from: Option<u32>, to: Option<u32>) -> f64 {
        match (from, to) {
            (Some(from), Some(to)) => self.ends[from as usize].distance(self.ends[to as usize]),
            (None, Some(to)) => self.home.distance(self.ends[to as usize]),
            (Some(from), None) => self.onwards[from as usize],
            (None, None) => 0.0,
        }
    }

    /// The way to the visit at a place from the one before.
    fn link(&self, place: usize) -> f64 {
        self.way(self.exit_before(place), self.entry(place))
    }

    fn turn(&mut self, mut from: usize, mut to: usize) {
        self.journal.push((from, to));
        while from < to {
            self.tour.swap(from, to);
            self.settle(from);
            self.settle(to);
            from += 1;
            to -= 1;
        }
        if from == to {
            self.settle(from);
        }
    }

    /// Turns round the visit at a place and takes note of it.
    fn settle(&mut self, at: usize) {
        self.tour[at] ^= 1;
        self.place[self.tour[at] as usize / 2] = at as u32;
    }

    fn apply(&mut self, change: Move) {
        match change {
            Move::Turn(from, to) => self.turn(from, to),
            Move::Shift(from, to, before, turned) => {
                let count = to - from;
                let (low, high, at) = match before > to {
                    true => (from, before - 1, before - 1 - count),
                    false => (before, to, before),
                };
                self.turn(low, high);
                match before > to {
                    true => self.turn(low, high - count - 1),
                    false => self.turn(low + count + 1, high),
                }
                if !turned {
                    self.turn(at, at + count);
                }
            }
        }
    }

    /// The places whose links a change has touched.
    fn touched(&self, change: Move) -> Vec<usize> {
        let last = self.tour.len() - 1;
        let around = |place: usize| [place.saturating_sub(1), place.min(last)];
        match change {
            Move::Turn(from, to) => [around(from), around(to + 1)].concat(),
            Move::Shift(from, to, before, _) => {
                let count = to - from + 1;
                let inner = if before > to { before - count } else { before + count };
                [around(from), around(to + 1), around(before), around(inner)].concat()
            }
        }
    }

    /// Improves the way about the stops in the queue; returns what was gained.
    fn improve(&mut self, queue: &mut Vec<u32>) -> f64 {
        let mut waiting = vec![false; 0];
        if queue.len() > 64 {
            waiting = vec![false; self.tour.len()];
            queue.iter().for_each(|&stop| waiting[stop as usize] = true);
        }
        let mut total = 0.0;
        while let Some(stop) = queue.pop() {
            if let Some(flag) = waiting.get_mut(stop as usize) {
                *flag = false;
            }
            while let Some((gain, change)) = self.best_about(stop) {
                total += gain;
                self.apply(change);
                for place in self.touched(change) {
                    let stop = self.tour[place] / 2;
                    let queued = match waiting.get_mut(stop as usize) {
                        Some(flag) => std::mem::replace(flag, true),
                        None => queue.contains(&stop),
                    };
                    if !queued {
                        queue.push(stop);
                    }
                }
            }
        }
        total
    }

    fn best_about(&self, stop: u32) -> Option<(f64, Move)> {
        let mut best: Option<(f64, Move)> = None;
        let mut offer = |gain: f64, change: Move| {
            if gain > GAIN && best.is_none_or(|(most, _)| gain > most) {
                best = Some((gain, change));
            }
        };
        for end in [2 * stop, 2 * stop + 1] {
            self.turns_at(end, &mut offer);
            self.shifts_at(end, &mut offer);
        }
        best
    }

    /// Turns that bring a near end next to this one.
    fn turns_at(&self, end: u32, offer: &mut impl FnMut(f64, Move)) {
        let at = self.place[end as usize / 2] as usize;
        let leaves = self.tour[at] != end;
        let old = if leaves { self.link(at + 1) } else { self.link(at) };
        for &(distance, other) in self.near[end as usize].iter().take_while(|near| near.0 < old) {
            let to = self.place[other as usize / 2] as usize;
            if leaves != (self.tour[to] != other) {
                continue;
            }
            let (from, last) = match leaves {
                true => (at.min(to) + 1, at.max(to)),
                false => (at.min(to), at.max(to) - 1),
            };
            if last - from >= self.longest_turn {
                continue;
            }
            let opposite = match leaves {
                true => self.way(self.entry(from), self.entry(last + 1)),
                false => self.way(self.exit_before(from), self.exit_before(last + 1)),
            };
            let before = self.link(from) + self.link(last + 1);
            offer(before - distance - opposite, Move::Turn(from, last));
        }
        // The first and the last visit have no near end on their outer side, but home and goal.
        let (from, to) = if leaves { (0, at) } else { (at, self.tour.len() - 1) };
        if to - from < self.longest_turn {
            let after = self.way(self.exit_before(from), Some(self.tour[to] ^ 1))
                + self.way(Some(self.tour[from]), self.entry(to + 1));
            offer(self.link(from) + self.link(to + 1) - after, Move::Turn(from, to));
        }
    }

    /// Moves of short stretches that begin or end at this end, next to a near one.
    fn shifts_at(&self, end: u32, offer: &mut impl FnMut(f64, Move)) {
        let at = self.place[end as usize / 2] as usize;
        let leaves = self.tour[at] != end;
        for count in 0..LONGEST_MOVE {
            let stretch = match leaves {
                true => at.checked_sub(count).map(|from| (from, at)),
                false => Some((at, at + count)).filter(|&(_, to)| to < self.tour.len()),
            };
            let Some((from, to)) = stretch else { break };
            let far = if leaves { self.tour[from] } else { self.tour[to] ^ 1 };
            let closed = self.way(self.exit_before(from), self.entry(to + 1));
            let saved = self.link(from) + self.link(to + 1) - closed;
            for &(distance, other) in self.near[end as usize].iter().take_while(|near| near.0 < saved) {
                let next_to = self.place[other as usize / 2] as usize;
                if (from..=to).contains(&next_to) {
                    continue;
                }
                // The stretch goes before this place.
                let after_other = self.tour[next_to] != other;
                let before = if after_other { next_to + 1 } else { next_to };
                if before == from || before == to + 1 {
                    continue;
                }
                let span = if before > to { before - from } else { to + 1 - before };
                if span > self.longest_turn {
                    continue;
                }
                let outer = match after_other {
                    true => self.way(Some(far), self.entry(before)),
                    false => self.way(self.exit_before(before), Some(far)),
                };
                // As it lies the stretch is entered at its first visit's entry.
                let turned = after_other == leaves;
                let change = Move::Shift(from, to, before, turned);
                offer(saved + self.link(before) - distance - outer, change);
            }
        }
    }

    /// Lets two short stretches change places and improves about them, many times; keeps what is shorter.
    fn shake(&mut self) {
        let count = self.tour.len();
        if count < 3 {
            return;
        }
        self.longest_turn = LONGEST_TURN[1];
        let mut dice = Dice(0x6b69_7269_6d6f_7270);
        let mut queue = Vec::new();
        for _ in 0..(SHAKES[0] * count).min(SHAKES[1]) {
            let longest = LONGEST_SHAKE.min(count as u64 / 3);
            let [first, second] = [0; 2].map(|_| 1 + dice.below(longest) as usize);
            let from = dice.below((count - first - second + 1) as u64) as usize;
            let (middle, to) = (from + first, from + first + second);
            let before = self.link(from) + self.link(middle) + self.link(to);
            self.journal.clear();
            self.turn(from, to - 1);
            self.turn(from, from + second - 1);
            self.turn(from + second, to - 1);
            let after = self.link(from) + self.link(from + second) + self.link(to);
            queue.clear();
            let last = count - 1;
            for place in [from, from + second, to] {
                queue.extend([place.saturating_sub(1), place.min(last)].map(|at| self.tour[at] / 2));
            }
            let gain = before - after + self.improve(&mut queue);
            if gain < -GAIN {
                for (from, to) in std::mem::take(&mut self.journal).into_iter().rev() {
                    self.turn(from, to);
                }
            }
        }
    }
}

/// A first way: the shortest links between near ends that leave every end with one at most and close no ring, then from
/// the home the chain that begins or ends nearest, and so on.
fn chained(ends: &[Point], near: &[Vec<(f64, u32)>], home: Point) -> Vec<u32> {
    let mut links: Vec<(f64, u32, u32)> = Vec::new();
    for (i, list) in near.iter().enumerate() {
        links.extend(list.iter().map(|&(distance, j)| (distance, (i as u32).min(j), (i as u32).max(j))));
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
    let places: Vec<Point> = loose.iter().map(|&end| ends[end as usize]).collect();
    let grid = Grid::new(&places);
    let mut used = vec![false; ends.len() / 2];
    let mut tour = Vec::with_capacity(used.len());
    let mut at = home;
    while let Some(&(_, next)) = grid.nearest(at, 1, |i| !used[loose[i as usize] as usize / 2]).first() {
        let mut end = loose[next as usize];
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
