//! The stations at which there is something to choose, and how the tool comes from one to the next.

use std::ops::Range;

use super::bends::distances;
use super::{Measure, Station};
use crate::machine::kinematics::Angles;

/// What a retreat costs, minutes: more than any turn within a cut.
const RETREAT: f64 = 0.2;

/// A station with two pairs of angles.
pub(super) struct Knot {
    pub run: usize,
    pub station: usize,
    pub branches: [Angles; 2],
    /// How the tool comes from the knot before.
    pub hop: Hop,
    /// What a retreat costs here; `None` where there must be none.
    pub retreat: Option<f64>,
}

/// The way from the knot before.
pub(super) enum Hop {
    /// From another run, or from home.
    Link,
    /// In one block.
    Block,
    /// Along upright stations of the same run; the best one for a retreat and its cost.
    Upright(Range<usize>, Option<(usize, f64)>),
}

/// The knots of all runs, in order.
pub(super) fn knots(runs: &[Vec<Station>], measure: &Measure) -> Vec<Knot> {
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
                Some(last) if last + 1 == station => Hop::Block,
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
