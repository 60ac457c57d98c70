//! Turns on the spot as stations of their own, and joint coordinates close enough to each other.

use super::{Measure, Station};

/// Most blocks that one becomes.
const MOST: usize = 1 << 16;

/// The stations with what is turned on the spot written out: afterwards angles of arrival and departure differ for a retreat
/// alone. For a machine without tool centre point control blocks are divided until the tip stays on its line.
pub(super) fn spread(stations: &[Station], measure: &Measure) -> Vec<Station> {
    let mut all: Vec<Station> = Vec::with_capacity(stations.len());
    for station in stations {
        let on_the_spot = station.arrive != station.leave
            && station.arrive.tilt == station.leave.tilt
            && (station.leave.turn - station.arrive.turn).abs() <= measure.rotary.max_swing;
        if on_the_spot {
            divide(Station { leave: station.arrive, ..*station }, measure, &mut all);
            divide(Station { arrive: station.leave, ..*station }, measure, &mut all);
        } else {
            divide(*station, measure, &mut all);
        }
    }
    all
}

/// Appends a station, and on the way to it as many as joint coordinates need.
fn divide(to: Station, measure: &Measure, all: &mut Vec<Station>) {
    let Some(from) = all.last().copied().filter(|_| !measure.machine.tcp) else { return all.push(to) };
    let station = |t: f64| {
        let angles = from.leave.between(to.arrive, t);
        let mut at = Station { arrive: angles, leave: angles, ..to };
        at.pose.tip = from.pose.tip + (to.pose.tip - from.pose.tip) * t;
        at.pose.axis = measure.machine.tool_axis(angles);
        at
    };
    let mut parts = 1;
    while parts < MOST {
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
