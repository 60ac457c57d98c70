//! Programs for LinuxCNC, run by its own stand-alone interpreter: what comes out, put through kinematics of
//! another hand, is the path that went in.

mod peers;

use std::path::Path;

use kirimorph::geometry::Point3;
use kirimorph::machine::{Header, Machine, Motion, Program, load, post, read};
use kirimorph::milling::toolpath::{Block, Contour, Kind, Pose, Rate, Run, Toolpath};
use nalgebra::{Unit, Vector3};

/// Slots with axes of up to some degrees, along straight and bent lines, open and closed.
fn slots(tilt: f64) -> Toolpath {
    let pose = |x: f64, y: f64, angle: f64, lean: f64| Pose {
        tip: Point3::new(x, y, -5.3),
        axis: Unit::new_normalize(Vector3::new(tilt * lean * angle.cos(), tilt * lean * angle.sin(), 1.0)),
    };
    let mut runs = Vec::new();
    for slot in 0..20 {
        let s = f64::from(slot);
        let poses: Vec<Pose> = (0..8)
            .map(|i| {
                let t = f64::from(i);
                let lean = 0.6 + 0.4 * (1.7 * s + t).sin();
                pose(20.0 + 10.0 * s + (s + t).sin(), 30.0 + 3.0 * t + s, 2.0 * s + 0.9 * t, lean)
            })
            .collect();
        runs.push(run(&poses));
    }
    let around = |i: i32| f64::from(i) * 12f64.to_radians();
    let ring: Vec<Pose> = (0..=60)
        .map(|i| pose(120.0 + 15.0 * around(i).cos(), 100.0 + 15.0 * around(i).sin(), around(i), 1.0))
        .collect();
    runs.push(run(&ring));
    // Straight through the upright, beside it, and upright for a while.
    runs.push(run(&[pose(20.0, 90.0, 0.4, 0.9), pose(30.0, 90.0, 0.4, -0.9)]));
    runs.push(run(&[pose(40.0, 90.0, 0.2, 0.9), pose(50.0, 90.0, 2.9, 0.9)]));
    let ends = [pose(60.0, 90.0, 0.0, 1.0), pose(80.0, 90.0, 1.4, 1.0)];
    runs.push(run(&[ends[0], pose(65.0, 90.0, 0.0, 0.0), pose(75.0, 90.0, 0.0, 0.0), ends[1]]));
    Toolpath { radius: 0.5, thickness: 5.0, runs }
}

fn run(poses: &[Pose]) -> Run {
    let last = poses[poses.len() - 1].lifted(7.0);
    let block = |to, rate, kind| Block { to, rate, kind };
    let mut blocks = vec![block(poses[0], Rate::Feed(120.0), Kind::Ramp)];
    blocks.extend(poses[1..].iter().map(|&to| block(to, Rate::Feed(300.0), Kind::Finish)));
    blocks.push(block(last, Rate::Rapid, Kind::Retract));
    Run { contour: Contour::Opening, start: poses[0].lifted(7.0), blocks }
}

/// A pose of the oracle: tip, axis, rapid, spindle speed.
struct Heard {
    tip: Point3,
    axis: Vector3<f64>,
    rapid: bool,
    spindle: f64,
}

fn machine(name: &str) -> Machine {
    load(name, Path::new(".")).unwrap()
}

/// What the interpreter makes of a program, as poses on the part; `None` without interpreter or Python.
fn heard(name: &str, machine: &Machine, text: &str) -> Option<Vec<Heard>> {
    let mut oracle = peers::oracle("rs274_poses.py")?;
    let folder = peers::fresh_folder(&format!("machine-{name}"));
    std::fs::write(folder.join("mill.ngc"), text).unwrap();
    let canonical = peers::rs274(&folder, "mill.ngc")?;
    assert!(canonical.contains("PROGRAM_END"), "{name} ended early:\n{canonical}");
    std::fs::write(folder.join("canonical"), canonical.as_bytes()).unwrap();
    let kind = name.trim_start_matches("linuxcnc-").trim_end_matches("-no-tcp");
    let place = |p: Point3| format!("{},{},{}", p.x, p.y, p.z);
    let centres = machine.rotary.as_ref().map(|rotary| [rotary.turn_centre, rotary.tilt_centre]);
    let [turn, tilt] = centres.unwrap_or_default().map(place);
    let output = oracle
        .arg(kind)
        .arg(if machine.tcp { "1" } else { "never" })
        .args([place(machine.setup.zero), turn, tilt])
        .stdin(std::fs::File::open(folder.join("canonical")).unwrap())
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    Some(text.lines().map(heard_line).collect())
}

fn heard_line(line: &str) -> Heard {
    let words: Vec<&str> = line.split(' ').collect();
    let number = |i: usize| words[i].parse::<f64>().unwrap();
    Heard {
        tip: Point3::new(number(0), number(1), number(2)),
        axis: Vector3::new(number(3), number(4), number(5)),
        rapid: words[6] == "r",
        spindle: number(7),
    }
}

fn is(motion: &Heard, pose: &Pose) -> bool {
    (motion.tip - pose.tip).norm() < 1e-3 && (motion.axis - pose.axis.as_ref()).norm() < 1e-4
}

/// The path's poses in order among what was heard.
fn assert_path(name: &str, path: &Toolpath, heard: &[Heard]) {
    let mut rest = heard.iter();
    for (index, run) in path.runs.iter().enumerate() {
        for pose in std::iter::once(run.start).chain(run.blocks.iter().map(|block| block.to)) {
            assert!(rest.any(|motion| is(motion, &pose)), "{name}: run {index} never comes to {pose:?}");
        }
    }
}

/// Every motion as our own reader has it.
fn assert_motions(name: &str, motions: &[Motion], heard: &[Heard]) {
    for (motion, heard) in motions.iter().zip(heard) {
        assert!(is(heard, &motion.pose), "{name} line {}: {} {}", motion.line, heard.tip, motion.pose.tip);
        assert_eq!(
            (heard.rapid, heard.spindle),
            (motion.rapid, motion.spindle),
            "{name} line {}",
            motion.line
        );
    }
}

#[test]
fn linuxcnc_hears_the_path() {
    let names = [
        "linuxcnc-xyzac-trt",
        "linuxcnc-xyzbc-trt",
        "linuxcnc-xyzbc-trt-no-tcp",
        "linuxcnc-xyzab-tdr",
        "linuxcnc-xyz",
    ];
    for name in names {
        let machine = machine(name);
        let turning = machine.rotary.is_some();
        let path = slots(if turning { 0.09 } else { 0.0 });
        let header = Header { spindle_rpm: 20_000.0, ..Header::default() };
        let Program { files, stats } = post(&path, &machine, &header).unwrap();
        let motions = read(&files[0].1, &machine).unwrap();
        let Some(heard) = heard(name, &machine, &files[0].1) else { return };
        // Up, upright, over, down; in the end up and upright again.
        let [head, foot] = if turning { [4, 2] } else { [3, 1] };
        assert_eq!(heard.len(), stats.motions + head + foot, "{name}");
        // Ours begin where all coordinates are known: coming down. Of home the interpreter has no offsets.
        assert_eq!(motions.len(), stats.motions + 1 + foot, "{name}");
        assert_motions(name, &motions[..motions.len() - foot], &heard[head - 1..]);
        assert_path(name, &path, &heard);
    }
}

/// The interpreter alone would let it pass: what a peer cannot see, the count does.
#[test]
fn a_program_that_ends_early_is_short() {
    let name = "linuxcnc-xyzbc-trt";
    let machine = machine(name);
    let header = Header { spindle_rpm: 20_000.0, ..Header::default() };
    let Program { files, stats } = post(&slots(0.09), &machine, &header).unwrap();
    let half = files[0].1.replacen("N12 (", "M2\nN12 (", 1);
    assert!(read(&half, &machine).is_err());
    let Some(heard) = heard("early", &machine, &half) else { return };
    assert!(heard.len() < stats.motions);
}
