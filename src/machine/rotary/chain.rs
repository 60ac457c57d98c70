//! Dynamic programming over branches and whole turns, along all runs at once.
//!
//! *Knots* are the stations that are not upright: each has two pairs of angles, and whole turns beyond. Between knots lie *hops*: a
//! block, an upright stretch, or the way above the stock from run to run. The cost is the time of both rotary axes, one
//! after the other, and a fixed time for each retreat.

use std::f64::consts::TAU;
use std::ops::Range;

use super::bends::distances;
use super::{Measure, Station, nearest};
use crate::machine::error::MachineError;
use crate::machine::kinematics::Angles;

/// What a retreat costs, minutes: more than any turn within a cut.
const RETREAT: f64 = 0.2;

/// States that are kept at each knot: the cheapest ones.
const KEPT: usize = 24;

/// A station with two pairs of angles.
struct Knot {
    run: usize,
    station: usize,
    branches: [Angles; 2],
    /// How the tool comes from the knot before.
    hop: Hop,
    /// What a retreat costs here; `None` where there must be none.
    retreat: Option<f64>,
}

enum Hop {
    /// From another run, or from home.
    Link,
    /// In one block: the change of the turn for each pair of branches.
    Block([[Option<f64>; 2]; 2]),
    /// Along upright stations of the same run; the best one for a retreat and its cost.
    Upright(Range<usize>, Option<(usize, f64)>),
}

/// One way to stand at a knot.
#[derive(Debug, Clone, Copy)]
struct State {
    branch: usize,
    turns: i32,
    cost: f64,
    back: Back,
}

/// Where a state comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Back {
    /// Home.
    Home,
    /// A state of the knot before.
    Knot(usize),
    /// Another state of the same knot, by a retreat.
    Retreat(usize),
}

impl Knot {
    fn angles(&self, state: &State) -> Angles {
        let base = self.branches[state.branch];
        Angles { turn: base.turn + TAU * f64::from(state.turns), ..base }
    }
}

/// Writes the angles of least rotary time into the stations.
pub(super) fn choose(runs: &mut [Vec<Station>], measure: &Measure) -> Result<(), MachineError> {
    let knots = knots(runs, measure);
    let steps = match walk(&knots, runs, measure, false) {
        Ok(steps) => steps,
        // Some run winds an axis beyond its limits: allow retreats everywhere.
        Err(_) => walk(&knots, runs, measure, true)?,
    };
    write(runs, &knots, &backwards(&knots, &steps, measure), measure);
    Ok(())
}

fn knots(runs: &[Vec<Station>], measure: &Measure) -> Vec<Knot> {
    let mut knots: Vec<Knot> = Vec::new();
    for (run, stations) in runs.iter().enumerate() {
        let clear = distances(stations, measure.diameter);
        let cost = |station: usize| {
            let distance = clear[station];
            // Outside the stock nothing is near. The farther from a bend, the better.
            (distance >= measure.diameter)
                .then(|| RETREAT * (1.0 + measure.diameter / (measure.diameter + distance)))
        };
        let mut before: Option<usize> = None;
        for (station, at) in stations.iter().enumerate() {
            if measure.is_upright(&at.pose) {
                continue;
            }
            let branches = measure.rotary.branches(&measure.on_table(&at.pose));
            let hop = match before {
                None => Hop::Link,
                Some(last) if last + 1 == station => {
                    let poses = [&stations[last].pose, &at.pose];
                    Hop::Block(measure.ways(poses, [knots[knots.len() - 1].branches, branches]))
                }
                Some(last) => {
                    let best = (last + 1..station).filter_map(|i| cost(i).map(|cost| (i, cost)));
                    Hop::Upright(last + 1..station, best.min_by(|a, b| a.1.total_cmp(&b.1)))
                }
            };
            knots.push(Knot { run, station, branches, hop, retreat: cost(station) });
            before = Some(station);
        }
    }
    knots
}

/// The states of every knot, cheapest first.
fn walk(
    knots: &[Knot],
    runs: &[Vec<Station>],
    measure: &Measure,
    retreats: bool,
) -> Result<Vec<Vec<State>>, MachineError> {
    let mut all: Vec<Vec<State>> = Vec::with_capacity(knots.len());
    for (index, knot) in knots.iter().enumerate() {
        let mut states = Vec::new();
        match all.last() {
            None => {
                for angles in everywhere(knot, measure, 0.0) {
                    let cost = time(measure, Angles::default(), angles.1);
                    keep(&mut states, State { cost, back: Back::Home, ..angles.0 });
                }
            }
            Some(before) => {
                for (from, state) in before.iter().enumerate() {
                    hop(&knots[index - 1], knot, (from, state), measure, &mut states);
                }
            }
        }
        if retreats && let Some(cost) = knot.retreat {
            for (from, state) in states.clone().iter().enumerate() {
                let angles = knot.angles(state);
                for (other, to) in everywhere(knot, measure, angles.turn) {
                    let cost = state.cost + cost + time(measure, angles, to);
                    // A state's place in the list must not move while others point at it: only better ones change.
                    if states.iter().all(|known| !same(known, &other)) {
                        states.push(State { cost, back: Back::Retreat(from), ..other });
                    }
                }
            }
        }
        if states.is_empty() {
            let tip = runs[knot.run][knot.station].pose.tip;
            return Err(MachineError::Limits { run: knot.run + 1, tip });
        }
        all.push(prune(states));
    }
    Ok(all)
}

/// Appends what one state before leads to.
fn hop(
    before: &Knot,
    knot: &Knot,
    (from, state): (usize, &State),
    measure: &Measure,
    states: &mut Vec<State>,
) {
    let start = before.angles(state);
    let mut reach = |branch: usize, turn: f64, extra: f64| {
        let end = Angles { turn, ..knot.branches[branch] };
        if within(measure, end) {
            let turns = ((turn - knot.branches[branch].turn) / TAU).round() as i32;
            let cost = state.cost + extra + time(measure, start, end);
            keep(states, State { branch, turns, cost, back: Back::Knot(from) });
        }
    };
    match &knot.hop {
        Hop::Link => {
            for (other, end) in everywhere(knot, measure, start.turn) {
                reach(other.branch, end.turn, 0.0);
            }
        }
        Hop::Block(ways) => {
            for (branch, way) in ways[state.branch].iter().enumerate() {
                if let Some(change) = way {
                    reach(branch, start.turn + change, 0.0);
                }
            }
        }
        Hop::Upright(_, retreat) => {
            for (other, end) in everywhere(knot, measure, start.turn) {
                if (end.turn - start.turn).abs() <= measure.rotary.max_swing {
                    reach(other.branch, end.turn, 0.0);
                } else if let Some((_, cost)) = retreat {
                    reach(other.branch, end.turn, *cost);
                }
            }
        }
    }
}

/// All pairs of angles of a knot within the limits and two turns of `turn`.
fn everywhere(knot: &Knot, measure: &Measure, turn: f64) -> Vec<(State, Angles)> {
    let mut all = Vec::with_capacity(10);
    for branch in [0, 1] {
        let middle = ((turn - knot.branches[branch].turn) / TAU).round() as i32;
        for turns in middle - 2..=middle + 2 {
            let state = State { branch, turns, cost: 0.0, back: Back::Home };
            let angles = knot.angles(&state);
            if within(measure, angles) {
                all.push((state, angles));
            }
        }
    }
    all
}

fn within(measure: &Measure, angles: Angles) -> bool {
    let [tilt, turn] = measure.rotary.limits;
    (tilt[0]..=tilt[1]).contains(&angles.tilt) && (turn[0]..=turn[1]).contains(&angles.turn)
}

/// Minutes that both axes take, one after the other.
fn time(measure: &Measure, from: Angles, to: Angles) -> f64 {
    ((to.tilt - from.tilt).abs() + (to.turn - from.turn).abs()) / measure.rotary.rapid
}

fn same(a: &State, b: &State) -> bool {
    a.branch == b.branch && a.turns == b.turns
}

/// Keeps the cheaper of two ways to stand alike.
fn keep(states: &mut Vec<State>, state: State) {
    match states.iter_mut().find(|known| same(known, &state)) {
        Some(known) if state.cost < known.cost => *known = state,
        Some(_) => {}
        None => states.push(state),
    }
}

/// The cheapest states, in the order they came in: retreats point at places in the list, and theirs stay.
fn prune(mut states: Vec<State>) -> Vec<State> {
    if states.len() <= KEPT {
        return states;
    }
    let reached = states.iter().take_while(|state| !matches!(state.back, Back::Retreat(_))).count();
    if reached < states.len() {
        states.truncate(reached.max(KEPT));
        return states;
    }
    states
        .sort_by(|a, b| a.cost.total_cmp(&b.cost).then(a.branch.cmp(&b.branch)).then(a.turns.cmp(&b.turns)));
    states.truncate(KEPT);
    states
}

/// Angles of arrival and departure at each knot on the cheapest way, the unwinding at the end included.
fn backwards(knots: &[Knot], steps: &[Vec<State>], measure: &Measure) -> Vec<[Angles; 2]> {
    let mut chosen = vec![[Angles::default(); 2]; knots.len()];
    let Some((knot, states)) = knots.last().zip(steps.last()) else { return chosen };
    let total = |state: &State| state.cost + time(measure, knot.angles(state), Angles::default());
    let best = (0..states.len()).min_by(|&a, &b| total(&states[a]).total_cmp(&total(&states[b])));
    let mut state = best.unwrap_or(0);
    for index in (0..knots.len()).rev() {
        let leave = knots[index].angles(&steps[index][state]);
        if let Back::Retreat(from) = steps[index][state].back {
            state = from;
        }
        chosen[index] = [knots[index].angles(&steps[index][state]), leave];
        if let Back::Knot(from) = steps[index][state].back {
            state = from;
        }
    }
    chosen
}

fn write(runs: &mut [Vec<Station>], knots: &[Knot], chosen: &[[Angles; 2]], measure: &Measure) {
    for (knot, [arrive, leave]) in knots.iter().zip(chosen) {
        let station = &mut runs[knot.run][knot.station];
        (station.arrive, station.leave) = (*arrive, *leave);
    }
    let mut next = 0;
    let mut held = 0.0;
    for (run, stations) in runs.iter_mut().enumerate() {
        let first = knots[next..].first().filter(|knot| knot.run == run);
        // Upright before the first knot: what the first knot has, turned above the stock.
        let mut hold = first.map_or(held, |_| chosen[next][0].turn);
        let mut at = 0;
        while knots.get(next).is_some_and(|knot| knot.run == run) {
            let knot = &knots[next];
            if let Hop::Upright(stretch, retreat) = &knot.hop {
                let turns = [hold, chosen[next][0].turn];
                stand(
                    &mut stations[stretch.clone()],
                    turns,
                    retreat.map(|(i, _)| i - stretch.start),
                    measure,
                );
            } else {
                upright(&mut stations[at..knot.station], hold);
            }
            hold = chosen[next][1].turn;
            at = knot.station + 1;
            next += 1;
        }
        upright(&mut stations[at..], hold);
        held = hold;
    }
}

fn upright(stations: &mut [Station], turn: f64) {
    for station in stations {
        station.arrive = Angles { tilt: 0.0, turn };
        station.leave = station.arrive;
    }
}

/// Turns from one angle to the other along an upright stretch, at once by a retreat where it is too much for a cut.
fn stand(stations: &mut [Station], [from, to]: [f64; 2], retreat: Option<usize>, measure: &Measure) {
    let change = to - from;
    upright(stations, from);
    if change.abs() > measure.rotary.max_swing {
        let at = retreat.unwrap_or(0);
        upright(&mut stations[at..], to);
        stations[at].arrive.turn = from;
        return;
    }
    let mut lengths = vec![0.0; stations.len()];
    for i in 1..stations.len() {
        lengths[i] = lengths[i - 1] + (stations[i].pose.tip - stations[i - 1].pose.tip).norm();
    }
    let whole = lengths[lengths.len() - 1];
    for (station, length) in stations.iter_mut().zip(lengths) {
        let part = if whole > 0.0 { length / whole } else { 0.0 };
        station.arrive.turn = from + change * part;
        station.leave = station.arrive;
    }
    // On the spot where there is no stretch; below a billionth of a degree nothing is left to turn.
    if let Some(last) = stations.last_mut().filter(|last| nearest(last.arrive.turn - to).abs() > 1e-11) {
        last.leave.turn = to;
    }
}
