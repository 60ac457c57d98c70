//! Dynamic programming over branches and whole turns, along all runs at once.
//!
//! [`Knot`]s are the stations that are not upright: each has two pairs of angles, and whole turns beyond.
//! Between knots lie *hops*: a block, an upright stretch, or the way above the stock from run to run. The
//! cost is the time of both rotary axes, one after the other, and a fixed time for each retreat.

use std::f64::consts::TAU;

use super::knots::{Hop, Knot, knots};
use super::{Measure, Station};
use crate::machine::error::MachineError;
use crate::machine::kinematics::Angles;

/// What a turn beyond the largest swing costs where a retreat would mark a ligament, minutes: more than any
/// retreat.
const SLOW_TURN: f64 = 0.8;

/// States that are kept at each knot: the cheapest ones.
const KEPT: usize = 12;

/// States that are kept for the few turns they have made.
const UNWOUND: usize = 4;

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

/// What is left of a state once the next knot is reached: small, since there are millions.
#[derive(Debug, Clone, Copy)]
struct Trace {
    branch: u8,
    retreat: bool,
    turns: i16,
    back: u16,
}

/// The states of all knots, those of knot i from `starts[i]` on.
#[derive(Default)]
struct Steps {
    traces: Vec<Trace>,
    starts: Vec<usize>,
    /// Those of the last knot, with their costs.
    last: Vec<State>,
}

impl Steps {
    fn push(&mut self, states: Vec<State>) {
        self.starts.push(self.traces.len());
        self.traces.extend(states.iter().map(|state| {
            let (retreat, back) = match state.back {
                Back::Home => (false, 0),
                Back::Knot(from) => (false, from),
                Back::Retreat(from) => (true, from),
            };
            // Limits of 1e5 degrees are 278 turns, and states some dozens.
            Trace { branch: state.branch as u8, retreat, turns: state.turns as i16, back: back as u16 }
        }));
        self.last = states;
    }
}

impl Knot {
    fn angles(&self, branch: usize, turns: i32) -> Angles {
        let base = self.branches[branch];
        Angles { turn: base.turn + TAU * f64::from(turns), ..base }
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

/// The states of every knot.
fn walk(
    knots: &[Knot],
    runs: &[Vec<Station>],
    measure: &Measure,
    retreats: bool,
) -> Result<Steps, MachineError> {
    let mut steps = Steps::default();
    for (index, knot) in knots.iter().enumerate() {
        let mut states = Vec::new();
        if index == 0 {
            for (state, angles) in everywhere(knot, measure, 0.0) {
                let cost = time(measure, Angles::default(), angles);
                keep(&mut states, State { cost, back: Back::Home, ..state });
            }
        } else {
            let before = &knots[index - 1];
            let poses = [before, knot].map(|knot| &runs[knot.run][knot.station].pose);
            let ways = match knot.hop {
                Hop::Block => measure.ways(poses, [before.branches, knot.branches]),
                _ => [[None; 2]; 2],
            };
            for (from, state) in steps.last.iter().enumerate() {
                hop([before, knot], &ways, (from, state), measure, &mut states);
            }
        }
        prune(&mut states);
        if retreats && let Some(cost) = knot.retreat {
            retreat(knot, cost, measure, &mut states);
        }
        if states.is_empty() {
            let tip = runs[knot.run][knot.station].pose.tip;
            return Err(MachineError::Limits { run: knot.run + 1, tip });
        }
        steps.push(states);
    }
    Ok(steps)
}

/// Adds what a retreat leads to that is not reached without one: states keep their places, since retreats
/// point at these.
fn retreat(knot: &Knot, cost: f64, measure: &Measure, states: &mut Vec<State>) {
    for (from, state) in states.clone().iter().enumerate() {
        let angles = knot.angles(state.branch, state.turns);
        for (other, to) in everywhere(knot, measure, angles.turn) {
            if states.iter().all(|known| !same(known, &other)) {
                let cost = state.cost + cost + time(measure, angles, to);
                states.push(State { cost, back: Back::Retreat(from), ..other });
            }
        }
    }
}

/// Appends what one state before leads to.
fn hop(
    [before, knot]: [&Knot; 2],
    ways: &[[Option<f64>; 2]; 2],
    (from, state): (usize, &State),
    measure: &Measure,
    states: &mut Vec<State>,
) {
    let start = before.angles(state.branch, state.turns);
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
        Hop::Block => {
            for (branch, way) in ways[state.branch].iter().enumerate() {
                if let Some(change) = way {
                    reach(branch, start.turn + change, 0.0);
                }
            }
        }
        Hop::Upright(_, retreat) => {
            for (other, end) in everywhere(knot, measure, start.turn) {
                let slow = (end.turn - start.turn).abs() > measure.rotary.max_swing;
                let extra = if slow { retreat.map_or(SLOW_TURN, |(_, cost)| cost) } else { 0.0 };
                reach(other.branch, end.turn, extra);
            }
        }
    }
}

/// All pairs of angles of a knot within the limits and two turns of `turn`, or unwound.
fn everywhere(knot: &Knot, measure: &Measure, turn: f64) -> Vec<(State, Angles)> {
    let mut all = Vec::with_capacity(10);
    for branch in [0, 1] {
        let middle = ((turn - knot.branches[branch].turn) / TAU).round() as i32;
        let near = middle - 2..=middle + 2;
        for turns in near.clone().chain((-1..=1).filter(|turns| !near.contains(turns))) {
            let state = State { branch, turns, cost: 0.0, back: Back::Home };
            let angles = knot.angles(branch, turns);
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

/// The cheapest states, and those with the least whole turns, in case the cheap ones run into the limits.
fn prune(states: &mut Vec<State>) {
    if states.len() <= KEPT + UNWOUND {
        return;
    }
    let name = |state: &State| (state.branch, state.turns);
    states.sort_by(|a, b| a.cost.total_cmp(&b.cost).then(name(a).cmp(&name(b))));
    states[KEPT..].sort_by_key(|state| (state.turns.abs(), name(state)));
    states.truncate(KEPT + UNWOUND);
}

/// Angles of arrival and departure at each knot on the cheapest way, the unwinding at the end included.
fn backwards(knots: &[Knot], steps: &Steps, measure: &Measure) -> Vec<[Angles; 2]> {
    let mut chosen = vec![[Angles::default(); 2]; knots.len()];
    let Some(knot) = knots.last() else { return chosen };
    let total =
        |state: &State| state.cost + time(measure, knot.angles(state.branch, state.turns), Angles::default());
    let states = &steps.last;
    let best = (0..states.len()).min_by(|&a, &b| total(&states[a]).total_cmp(&total(&states[b])));
    let mut state = best.unwrap_or(0);
    for (index, knot) in knots.iter().enumerate().rev() {
        let trace = |state: usize| steps.traces[steps.starts[index] + state];
        let angles = |trace: Trace| knot.angles(usize::from(trace.branch), i32::from(trace.turns));
        let leave = angles(trace(state));
        if trace(state).retreat {
            state = usize::from(trace(state).back);
        }
        chosen[index] = [angles(trace(state)), leave];
        state = usize::from(trace(state).back);
    }
    chosen
}

fn write(runs: &mut [Vec<Station>], knots: &[Knot], chosen: &[[Angles; 2]], measure: &Measure) {
    for (knot, [arrive, leave]) in knots.iter().zip(chosen) {
        let station = &mut runs[knot.run][knot.station];
        (station.arrive, station.leave, station.retreat) = (*arrive, *leave, arrive != leave);
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

/// Turns from one angle to the other along an upright stretch; what is too much for a cut by a retreat, if
/// there may be one.
fn stand(stations: &mut [Station], [from, to]: [f64; 2], retreat: Option<usize>, measure: &Measure) {
    let change = to - from;
    upright(stations, from);
    if let Some(at) = retreat.filter(|_| change.abs() > measure.rotary.max_swing) {
        upright(&mut stations[at..], to);
        stations[at].arrive.turn = from;
        stations[at].retreat = true;
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
    if let Some(last) = stations.last_mut().filter(|last| (last.arrive.turn - to).abs() > 1e-11) {
        last.leave.turn = to;
    }
}
