use super::*;
use crate::machine::examples::{header, machine, machines, slots_for, with_decimals};
use crate::machine::{Program, post};
use crate::milling::toolpath::Toolpath;

fn program(machine: &Machine) -> Program {
    post(&slots_for(machine), machine, &header()).unwrap()
}

fn text(machine: &Machine) -> String {
    program(machine).files[0].1.clone()
}

/// Whether the path's poses come in order among the motions, and how far the worst is off.
fn worst_match(path: &Toolpath, motions: &[Motion], close: f64) -> f64 {
    let mut rest = motions.iter();
    let mut worst: f64 = 0.0;
    for run in &path.runs {
        for pose in std::iter::once(run.start).chain(run.blocks.iter().map(|block| block.to)) {
            let far = |motion: &Motion| {
                let axis = (motion.pose.axis.as_ref() - pose.axis.as_ref()).norm() * 5.0;
                (motion.pose.tip - pose.tip).norm().max(axis)
            };
            let found = rest.by_ref().map(far).find(|&far| far < close);
            let mut best = found.unwrap_or_else(|| panic!("no motion to {pose:?}"));
            // Blocks may be shorter than what counts as close.
            while let Some(next) = rest.clone().next().map(far).filter(|&next| next < best) {
                (best, _) = (next, rest.next());
            }
            worst = worst.max(best);
        }
    }
    worst
}

#[test]
fn every_dialect_gives_the_same_poses_back() {
    for machine in machines() {
        let mut machine = with_decimals(&machine, 8, 9);
        if let Some(rotary) = &mut machine.rotary {
            rotary.upright = 0.0;
        }
        let motions = read(&text(&machine), &machine).unwrap();
        let worst = worst_match(&slots_for(&machine), &motions, 1e-3);
        assert!(worst < 1e-6, "{}: {worst:e}", machine.name);
    }
}

#[test]
fn shipped_digits_and_uprights_cost_micrometres() {
    for machine in machines() {
        let motions = read(&text(&machine), &machine).unwrap();
        let worst = worst_match(&slots_for(&machine), &motions, 0.02);
        assert!(worst < 0.0051, "{}: {worst:e}", machine.name);
    }
}

/// The tool's line between the path's poses, sampled within every motion as the controller interpolates.
#[test]
fn between_poses_the_wall_stays_within_tolerance() {
    for machine in machines() {
        let path = slots_for(&machine);
        let motions = read(&text(&machine), &machine).unwrap();
        let mut at = 0;
        for run in &path.runs {
            let mut from = run.start;
            for block in &run.blocks {
                let length = (block.to.tip - from.tip).norm();
                let mut done = 0.0;
                // Motions from this pose to the next; links never begin or end within a millimetre of the
                // stock.
                while (motions[at].from.tip - from.tip).norm() > 2e-3 {
                    at += 1;
                }
                while length - done > 2e-3 {
                    let base = motions[at].from.tip;
                    if (motions[at].pose.tip.z - base.z) > 1.0 && block.to.tip.z <= from.tip.z {
                        // A retreat comes back to where it left.
                        at += 1;
                        while (motions[at - 1].pose.tip - base).norm() > 1e-3 {
                            at += 1;
                        }
                        continue;
                    }
                    for t in [0.0, 0.3, 0.6, 1.0] {
                        let pose = pose_at(&motions[at], &machine, t);
                        let part = ((pose.tip - from.tip).norm() / length).min(1.0);
                        let wanted = between(&from.axis, &block.to.axis, part);
                        let tip = from.tip + (block.to.tip - from.tip) * part;
                        assert!((pose.tip - tip).norm() < 0.0025, "{} {}", machine.name, pose.tip);
                        let off = (pose.axis.as_ref() - wanted.as_ref()).norm() * 5.0;
                        assert!(off < 0.0051, "{}: {off} at {}", machine.name, pose.tip);
                    }
                    done = (motions[at].pose.tip - from.tip).norm();
                    at += 1;
                }
                from = block.to;
            }
        }
    }
}

#[test]
fn rapids_stay_above_the_stock() {
    for machine in machines() {
        let motions = read(&text(&machine), &machine).unwrap();
        for motion in motions.iter().filter(|motion| motion.rapid) {
            let low = motion.from.tip.z.min(motion.pose.tip.z);
            let way = motion.pose.tip - motion.from.tip;
            let along = way.cross(motion.from.axis.as_ref()).norm() < 1e-3 * way.norm().max(1.0);
            assert!(
                low >= machine.setup.safe_height - 1e-3 || along,
                "{} line {}",
                machine.name,
                motion.line
            );
            // The path itself begins and ends 0.7 mm above the stock.
            assert!(low > 0.7, "{} line {}", machine.name, motion.line);
        }
        let turns = |motion: &&Motion| motion.angles.is_some_and(|[from, to]| from != to);
        for motion in motions.iter().filter(turns).filter(|motion| motion.rapid) {
            assert!(motion.from.tip.z > 100.0, "{} line {}: a rapid turn", machine.name, motion.line);
        }
        for motion in motions.iter().filter(|motion| motion.pose.tip.z < 0.0) {
            assert_eq!(motion.spindle, 12_000.0);
            assert_eq!(motion.tcp, machine.tcp);
        }
    }
}

#[test]
fn feeds_are_those_of_the_path_unless_an_axis_is_slow() {
    let machine = machine("linuxcnc-xyz");
    let motions = read(&text(&machine), &machine).unwrap();
    let feeds: Vec<f64> = motions.iter().filter(|m| m.pose.tip.z < 0.0).map(|m| m.feed).collect();
    assert!(!feeds.is_empty() && feeds.iter().all(|f| [100.0, 300.0].contains(f)));
    for machine in machines() {
        let Some(rotary) = &machine.rotary else { continue };
        for motion in read(&text(&machine), &machine).unwrap() {
            let Some([from, to]) = motion.angles else { continue };
            let turn = (to.tilt - from.tilt).abs().max((to.turn - from.turn).abs());
            let speed = turn / (motion.seconds / 60.0).max(1e-12);
            // Beside digits a block loses a little of its length to rounding.
            let most = if motion.pose.tip.z < 0.0 { rotary.cutting } else { rotary.rapid };
            assert!(
                turn == 0.0 || speed < 1.02 * most + 1e-3,
                "{} line {}: {speed} {most}\n{motion:?}",
                machine.name,
                motion.line
            );
            if motion.pose.tip.z < 0.0 {
                assert!(turn <= rotary.max_swing + 1e-6, "{} line {}", machine.name, motion.line);
                assert!(
                    motion.feed <= 300.1
                        || motion.pose.tip.z > motion.from.tip.z
                        || motion.from.tip == motion.pose.tip
                );
            }
        }
    }
}

#[test]
fn faults_in_the_text_reach_the_motions() {
    let bc = machine("linuxcnc-xyzbc-trt");
    let good = read(&text(&bc), &bc).unwrap();
    let inch = read(&text(&bc).replacen("G21", "G20", 1), &bc).unwrap();
    let deepest = |motions: &[Motion]| motions.iter().map(|m| m.pose.tip.z).fold(0.0, f64::min);
    assert!((deepest(&inch) / deepest(&good) - 25.4).abs() < 1e-6);
    let still = read(&text(&bc).replacen(" M3", " M5", 1), &bc).unwrap();
    assert!(still.iter().all(|motion| motion.spindle == 0.0));
    let negated = text(&bc).replace("B-", "B+").replace(" B", " B-").replace("B-+", "B");
    let other = read(&negated, &bc).unwrap();
    assert!(good.iter().zip(&other).any(|(a, b)| (a.pose.axis.as_ref() - b.pose.axis.as_ref()).norm() > 0.1));
}

#[test]
fn what_is_not_known_is_refused_with_its_line() {
    let cases = [
        ("linuxcnc-xyzbc-trt", "G64 P0.005 Q0", "G2 X1 Y1 I3", "G2 is not known"),
        ("linuxcnc-xyzbc-trt", "M5\n", "M428\n", "M428 is not known"),
        ("linuxcnc-xyzbc-trt", "M68 E3 Q1", "M68 E3 Q2", "switches nothing"),
        ("linuxcnc-xyzbc-trt", "G43 H1", "G43 H2", "not the length of tool 1"),
        ("linuxcnc-xyzbc-trt", "G43 H1\n", "", "Z without the tool's length"),
        ("linuxcnc-xyzbc-trt", "\nM2\n", "\n", "does not end"),
        ("linuxcnc-xyzbc-trt", "\nM2\n", "\nM2\nG0 X1\n", "after the program's end"),
        ("linuxcnc-xyzbc-trt", "G4 P3.0", "G4 P3.0 A7.0", "A7 is not known here"),
        ("linuxcnc-xyzbc-trt", "G4 P3.0", "G4 P3e1", "E1 is not known here"),
        ("linuxcnc-xyzbc-trt", "G4 P3.0", "G4 P-", "not a number"),
        ("linuxcnc-xyzbc-trt", "G4 P3.0", "(open", "does not end"),
        ("linuxcnc-xyzbc-trt", "G4 P3.0", "#1=2", "no word"),
        ("linuxcnc-xyzbc-trt-no-tcp", "G93", "G93\nG1 X1.0", "without its own F"),
        ("fanuc-30i-ac", "G43.4", "G43.5", "G43.5 is not known"),
        ("haas-umc-bc", "G234", "G254", "G254 is not known"),
        ("siemens-840d-ac", "ORIAXES", "ORIVECT", "ORIVECT"),
        ("siemens-840d-ac", "TRAORI", "TRANSMIT", "not a number"),
        ("heidenhain-bc", "FUNCTION TCPM", "FUNCTION TCPX", "not known"),
        ("heidenhain-bc", "L X+", "L X", "no sign"),
        ("heidenhain-bc", "\n5 ", "\n7 ", "should have the number 5"),
    ];
    for (name, from, to, expected) in cases {
        let machine = machine(name);
        let good = text(&machine);
        assert!(good.contains(from), "{name} has no {from:?}");
        let error = read(&good.replacen(from, to, 1), &machine).unwrap_err().to_string();
        assert!(error.contains(expected) && error.starts_with("line "), "{from} -> {to}: {error}");
    }
}

#[test]
fn random_corruption_never_panics() {
    use crate::toml_source::corruption::corrupt;
    for machine in machines() {
        let text: String = text(&machine).lines().take(60).map(|line| format!("{line}\n")).collect();
        for seed in 0..200 {
            let _ = read(&corrupt(&text, seed), &machine);
        }
    }
}
