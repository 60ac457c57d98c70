//! Turns on the spot as stations of their own, and joint coordinates close enough to each other.

use super::{Measure, Station};

/// Most blocks that one becomes.
const MOST: usize = 1 << 16;

/// The stations with what is turned on the spot written out: afterwards angles of arrival and departure
/// differ for a retreat alone, and no block turns further than the largest swing. For a machine without tool
/// centre point control blocks are divided until the tip stays on its line.
pub(super) fn spread(stations: &[Station], measure: &Measure) -> Vec<Station> {
    let mut all: Vec<Station> = Vec::with_capacity(stations.len());
    for station in stations {
        if station.arrive != station.leave && !station.retreat {
            divide(Station { leave: station.arrive, ..*station }, measure, &mut all);
            divide(Station { arrive: station.leave, ..*station }, measure, &mut all);
        } else {
            divide(*station, measure, &mut all);
        }
    }
    all
}

/// Appends a station, and on the way to it as many as swing and joint coordinates need.
fn divide(to: Station, measure: &Measure, all: &mut Vec<Station>) {
    let Some(from) = all.last().copied() else { return all.push(to) };
    let station = |t: f64| {
        let angles = from.leave.between(to.arrive, t);
        let mut at = Station { arrive: angles, leave: angles, retreat: false, ..to };
        at.pose.tip = from.pose.tip + (to.pose.tip - from.pose.tip) * t;
        at.pose.axis = measure.machine.tool_axis(angles);
        at
    };
    let swings = (to.arrive.turn - from.leave.turn).abs() / measure.rotary.max_swing;
    // A rounding error beyond a whole number of swings needs no block of its own.
    let mut parts = ((swings - 1e-9).ceil() as usize).clamp(1, MOST);
    while parts < MOST && !measure.machine.tcp {
        let ends = [station(0.0), station(1.0 / parts as f64)];
        let poses = [&ends[0].pose, &ends[1].pose];
        if measure.error(poses, [ends[0].arrive, ends[1].arrive]) <= 1.0 {
            break;
        }
        parts *= 2;
    }
    all.extend((1..parts).map(|part| station(part as f64 / parts as f64)));
    all.push(to);
}
