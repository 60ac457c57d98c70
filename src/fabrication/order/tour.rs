//! The shortest way through stops that have two ends: in at one, out at the other, whichever way round.
//!
//! An end may be a bar across a slit: the way comes to one of the bar's ends, and goes on from either when it leaves. So an end is
//! two places, and from end to end the way is the shortest between any of them.
//!
//! The way begins as chains of the shortest links (greedy matching, as nearest neighbours that nobody else needs more),
//! joined by nearest neighbour. It is then improved by turning stretches round (2-opt) and by moving up to three stops
//! elsewhere (Or-opt), along lists of near ends. Last it is shaken: two short stretches change places somewhere, the
//! neighbourhood is improved again, and what came out longer is taken back. All in a fixed order with a fixed seed.

use kurbo::Point;
use rayon::prelude::*;

use super::first_way::{Dice, End, chained, gap, near_ends};

/// Most stops that are turned round at once, at first and after a shake: longer turns cost more time than they are worth
/// on large sheets.
const LONGEST_TURN: [usize; 2] = [30_000, 1000];
/// Most stops that are moved together.
const LONGEST_MOVE: usize = 3;
/// Searches from different first ways, of which the shortest result is taken, and the most stops for which that is done: a way
/// that goes round a hole the wrong way is not mended by small changes.
const STARTS: u64 = 6;
const MOST_RESTARTED: usize = 1500;
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
pub fn tour(stops: &[[End; 2]], frame: &Frame) -> Vec<(usize, bool)> {
    if stops.is_empty() {
        return Vec::new();
    }
    let ends: Vec<End> = stops.iter().flatten().copied().collect();
    let near = near_ends(&ends);
    let onwards = |&[a, b]: &End| (frame.onwards)(a).min((frame.onwards)(b));
    let onwards: Vec<f64> = ends.par_iter().map(onwards).collect();
    let searched = |start: u64| {
        let mut search = Search::new(&ends, &near, frame.home, &onwards, start);
        search.improve(&mut (0..stops.len() as u32).rev().collect());
        search.shake();
        (search.length(), start, search.tour)
    };
    let starts = if stops.len() <= MOST_RESTARTED { STARTS } else { 1 };
    let found: Vec<_> = (0..starts).into_par_iter().map(searched).collect();
    let shortest = found.into_iter().min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    shortest
        .map_or_else(Vec::new, |(_, _, tour)| tour)
        .iter()
        .map(|&entry| (entry as usize / 2, entry % 2 == 1))
        .collect()
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
    ends: &'a [End],
    near: &'a [Vec<(f64, u32)>],
    home: Point,
    onwards: &'a [f64],
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
    fn new(
        ends: &'a [End],
        near: &'a [Vec<(f64, u32)>],
        home: Point,
        onwards: &'a [f64],
        start: u64,
    ) -> Self {
        let tour = chained(ends, near, home, start);
        let mut place = vec![0; tour.len()];
        tour.iter().enumerate().for_each(|(at, &entry)| place[entry as usize / 2] = at as u32);
        let longest_turn = LONGEST_TURN[0];
        Self { ends, near, home, onwards, tour, place, longest_turn, journal: Vec::new() }
    }

    /// The whole way.
    fn length(&self) -> f64 {
        (0..=self.tour.len()).map(|place| self.link(place)).sum()
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
            (Some(from), Some(to)) => gap(self.ends[from as usize], self.ends[to as usize]),
            (None, Some(to)) => gap([self.home; 2], self.ends[to as usize]),
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
