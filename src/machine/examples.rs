//! Paths for the tests of this folder: slots along which the axis turns, beside the pole, through it and far
//! from it.

use nalgebra::{Unit, Vector3};

use super::profile::{Machine, Output, load, names};
use super::program::Header;
use crate::geometry::Point3;
use crate::milling::toolpath::{Block, Contour, Kind, Pose, Rate, Run, Toolpath};

/// Every shipped machine.
pub(super) fn machines() -> Vec<Machine> {
    names().iter().map(|name| machine(name)).collect()
}

pub(super) fn machine(name: &str) -> Machine {
    load(name, std::path::Path::new(".")).unwrap()
}

pub(super) fn header() -> Header {
    Header {
        job: "a (strange) name; M2 % of\nits own ä".into(),
        hash: "0123456789abcdef".into(),
        spindle_rpm: 12_000.0,
        ..Header::default()
    }
}

pub(super) fn pose(x: f64, y: f64, z: f64, i: f64, j: f64) -> Pose {
    Pose { tip: Point3::new(x, y, z), axis: Unit::new_normalize(Vector3::new(i, j, 1.0)) }
}

/// A run along poses in the stock: down along the first axis, through all, up along the last.
pub(super) fn run(poses: &[Pose]) -> Run {
    let up = |pose: &Pose| pose.lifted(6.0);
    let block = |to, rate, kind| Block { to, rate, kind };
    let mut blocks = vec![block(poses[0], Rate::Feed(100.0), Kind::Ramp)];
    blocks.extend(poses[1..].iter().map(|&to| block(to, Rate::Feed(300.0), Kind::Finish)));
    blocks.push(block(up(&poses[poses.len() - 1]), Rate::Feed(800.0), Kind::Retract));
    Run { contour: Contour::Opening, start: up(&poses[0]), blocks }
}

pub(super) fn path(runs: Vec<Run>) -> Toolpath {
    Toolpath { radius: 0.5, thickness: 5.0, runs }
}

/// Ruled slots: between random axes of a few degrees, one straight through the upright, one beside it, one
/// upright in its middle, one closed and one upright throughout.
fn tilted_slots(tilt: f64) -> Toolpath {
    let pose = |x: f64, y: f64, z: f64, i: f64, j: f64| pose(x, y, z, tilt * i, tilt * j);
    let mut state = 7u64;
    let mut random = |size: f64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        size * ((state >> 11) as f64 / (1u64 << 52) as f64 - 1.0)
    };
    let mut runs = Vec::new();
    for slot in 0..12 {
        let at = Point3::new(20.0 + 12.0 * f64::from(slot), 30.0 + 5.0 * random(1.0), -5.2);
        let poses: Vec<Pose> = (0..5)
            .map(|i| pose(at.x + random(0.5), at.y + 4.0 * f64::from(i), at.z, random(0.08), random(0.08)))
            .collect();
        runs.push(run(&poses));
    }
    runs.push(run(&[pose(20.0, 90.0, -5.2, 0.06, 0.03), pose(30.0, 90.0, -5.2, -0.06, -0.03)]));
    runs.push(run(&[pose(40.0, 90.0, -5.2, 0.06, 0.01), pose(50.0, 90.0, -5.2, -0.06, 0.01)]));
    runs.push(run(&[
        pose(60.0, 90.0, -5.2, 0.06, 0.0),
        pose(65.0, 90.0, -5.2, 0.0, 0.0),
        pose(75.0, 90.0, -5.2, 0.0, 0.0),
        pose(80.0, 90.0, -5.2, 0.01, 0.06),
    ]));
    let around: Vec<Pose> = (0..=36)
        .map(|i| {
            let (s, c) = (f64::from(i) * 10f64.to_radians()).sin_cos();
            pose(100.0 + 8.0 * c, 90.0 + 8.0 * s, -5.2, 0.07 * c, 0.07 * s)
        })
        .collect();
    runs.push(run(&around));
    runs.push(run(&[pose(120.0, 90.0, -5.2, 0.0, 0.0), pose(130.0, 92.0, -5.2, 0.0, 0.0)]));
    path(runs)
}

/// Slots that tilt by some degrees.
pub(super) fn slots() -> Toolpath {
    tilted_slots(1.0)
}

/// What a machine can take of these.
pub(super) fn slots_for(machine: &Machine) -> Toolpath {
    if machine.rotary.is_some() { slots() } else { tilted_slots(0.0) }
}

/// A copy with other digits and no split: the test of what rounding costs.
pub(super) fn with_decimals(machine: &Machine, decimals: usize, angle_decimals: usize) -> Machine {
    Machine { output: Output { decimals, angle_decimals, ..machine.output.clone() }, ..machine.clone() }
}
