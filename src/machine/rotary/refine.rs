//! Halving blocks until a controller that turns angles cuts the wall that the path means.

use rayon::prelude::*;

use super::{Measure, Station, between};
use crate::machine::kinematics::Angles;
use crate::milling::toolpath::{Kind, Pose, Rate, Toolpath};

/// Deepest halving of a block: a millionth of it.
const DEEPEST: usize = 20;

/// The runs' stations, not yet with angles: blocks halved until either branch leads on.
pub(super) fn refine(toolpath: &Toolpath, measure: &Measure) -> Vec<Vec<Station>> {
    let refined = |run: &crate::milling::toolpath::Run| {
        let mut stations = vec![station(run.start, Rate::Rapid, Kind::Approach)];
        let mut from = run.start;
        for block in &run.blocks {
            halve(measure, [from, block.to], block.rate, block.kind, DEEPEST, &mut stations);
            from = block.to;
        }
        for station in &mut stations {
            if measure.is_upright(&station.pose) {
                station.pose.axis = measure.machine.tool_axis(Angles::default());
            }
        }
        stations
    };
    toolpath.runs.par_iter().map(refined).collect()
}

fn station(pose: Pose, rate: Rate, kind: Kind) -> Station {
    Station { pose, rate, kind, arrive: Angles::default(), leave: Angles::default(), retreat: false }
}

/// Appends the stations after the first of `poses`.
fn halve(
    measure: &Measure,
    poses: [Pose; 2],
    rate: Rate,
    kind: Kind,
    depth: usize,
    stations: &mut Vec<Station>,
) {
    let [from, to] = poses;
    if depth == 0 || fits(measure, [&from, &to]) {
        stations.push(station(to, rate, kind));
        return;
    }
    let middle = Pose { tip: nalgebra::center(&from.tip, &to.tip), axis: between(&from.axis, &to.axis, 0.5) };
    halve(measure, [from, middle], rate, kind, depth - 1, stations);
    halve(measure, [middle, to], rate, kind, depth - 1, stations);
}

/// Whether the block can be cut within the tolerances from either branch. An upright end takes on the turn of
/// the other.
fn fits(measure: &Measure, poses: [&Pose; 2]) -> bool {
    let branches = poses.map(|pose| measure.rotary.branches(&measure.on_table(pose)));
    let held = |turn| Angles { tilt: 0.0, turn };
    match poses.map(|pose| measure.is_upright(pose)) {
        [true, true] => measure.error(poses, [held(0.0); 2]) <= 1.0,
        [true, false] => measure.error(poses, [held(branches[1][0].turn), branches[1][0]]) <= 1.0,
        [false, true] => measure.error(poses, [branches[0][0], held(branches[0][0].turn)]) <= 1.0,
        // From either branch: in joint coordinates they are not alike, and the path may have come by any.
        [false, false] => measure.ways(poses, branches).iter().all(|ways| ways.iter().any(Option::is_some)),
    }
}
