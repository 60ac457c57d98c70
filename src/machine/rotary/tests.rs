use std::f64::consts::{PI, TAU};

use super::*;
use crate::machine::examples::{machine, path, pose, run, slots};
use crate::milling::toolpath::Run;

fn solved(machine: &Machine, runs: Vec<Run>) -> Vec<Vec<Station>> {
    solve(&path(runs), machine).unwrap()
}

/// Turn of each axis along a run, and the largest in one block.
fn turned(stations: &[Station]) -> ([f64; 2], f64) {
    let mut sums = [0.0; 2];
    let mut largest: f64 = 0.0;
    for pair in stations.windows(2) {
        let [from, to] = [pair[0].leave, pair[1].arrive];
        for (sum, turn) in sums.iter_mut().zip([to.tilt - from.tilt, to.turn - from.turn]) {
            *sum += turn.abs();
            largest = largest.max(turn.abs());
        }
    }
    (sums, largest)
}

fn retreats(stations: &[Station]) -> Vec<&Station> {
    stations.iter().filter(|station| station.arrive != station.leave).collect()
}

/// A ring whose axis leans outwards all along: once round the pole.
fn ring(turns: i32, lean: f64) -> Run {
    let poses: Vec<Pose> = (0..=36 * turns)
        .map(|i| {
            let (s, c) = (f64::from(i) * TAU / 36.0).sin_cos();
            pose(100.0 + 20.0 * c, 90.0 + 20.0 * s, -5.2, lean * c, lean * s)
        })
        .collect();
    run(&poses)
}

#[test]
fn angles_point_the_tool_along_its_axis() {
    for name in ["linuxcnc-xyzac-trt", "linuxcnc-xyzbc-trt", "linuxcnc-xyzab-tdr", "haas-umc-bc"] {
        let mut machine = machine(name);
        machine.setup.fixture = nalgebra::Rotation3::from_axis_angle(&Vector3::y_axis(), 0.1);
        for stations in solve(&slots(), &machine).unwrap() {
            for station in stations {
                for angles in [station.arrive, station.leave] {
                    let error =
                        (machine.tool_axis(angles).into_inner() - station.pose.axis.into_inner()).norm();
                    assert!(error < 1e-12, "{name}: {error:e} at {}", station.pose.tip);
                }
            }
        }
    }
}

#[test]
fn a_path_through_the_pole_changes_the_sign_and_holds_c() {
    for name in ["linuxcnc-xyzac-trt", "linuxcnc-xyzbc-trt"] {
        let through = run(&[pose(0.0, 0.0, -5.2, 0.06, 0.03), pose(9.0, 0.0, -5.2, -0.06, -0.03)]);
        let stations = solved(&machine(name), vec![through]).remove(0);
        let (turned, _) = turned(&stations);
        let lean = 0.06f64.hypot(0.03).atan();
        assert!((turned[0] - 2.0 * lean).abs() < 1e-9 && turned[1] < 1e-9, "{name}: {turned:?}");
    }
}

#[test]
fn a_path_beside_the_pole_turns_in_small_blocks() {
    let machine = machine("linuxcnc-xyzbc-trt");
    let beside = run(&[pose(0.0, 0.0, -5.2, 0.06, 0.002), pose(9.0, 0.0, -5.2, -0.06, 0.002)]);
    let stations = solved(&machine, vec![beside]).remove(0);
    let (turned, largest) = turned(&stations);
    assert!(turned[1] > 0.9 * PI, "{turned:?}");
    assert!(largest <= machine.rotary.as_ref().unwrap().max_swing);
    assert!(retreats(&stations).is_empty());
}

#[test]
fn a_table_of_a_and_b_has_no_pole_there() {
    let machine = machine("linuxcnc-xyzab-tdr");
    let beside = run(&[pose(0.0, 0.0, -5.2, 0.06, 0.002), pose(9.0, 0.0, -5.2, -0.06, 0.002)]);
    let stations = solved(&machine, vec![beside]).remove(0);
    let (turned, _) = turned(&stations);
    assert!(turned[0] + turned[1] < 0.14, "{turned:?}");
    assert!(stations.len() < 12, "{}", stations.len());
}

#[test]
fn a_wedge_takes_the_job_off_the_pole() {
    let flat = machine("linuxcnc-xyzbc-trt");
    let mut wedged = flat.clone();
    wedged.setup.fixture = nalgebra::Rotation3::from_axis_angle(&Vector3::y_axis(), 0.2);
    let turns = |machine: &Machine| {
        let stations = solve(&slots(), machine).unwrap();
        stations.iter().map(|run| turned(run).0[1]).sum::<f64>()
    };
    assert!(turns(&wedged) < 0.3 * turns(&flat), "{} {}", turns(&wedged), turns(&flat));
}

#[test]
fn nearly_upright_is_upright_and_c_is_held() {
    let machine = machine("linuxcnc-xyzac-trt");
    let lean = 0.0006;
    let poses: Vec<Pose> = (0..20)
        .map(|i| {
            let (s, c) = (f64::from(i) * 2.0).sin_cos();
            pose(f64::from(i), 0.0, -5.2, lean * c, lean * s)
        })
        .collect();
    let stations = solved(&machine, vec![run(&poses)]).remove(0);
    assert!(stations.iter().all(|station| station.arrive == Angles::default()));
    // More than the tolerance over the thickness is not taken for upright.
    let leaning = run(&[pose(0.0, 0.0, -5.2, 0.0012, 0.0), pose(5.0, 0.0, -5.2, 0.0012, 0.0)]);
    let stations = solved(&machine, vec![leaning]).remove(0);
    assert!((stations[1].arrive.tilt.abs() - 0.0012).abs() < 1e-6);
}

#[test]
fn what_c_must_turn_by_it_turns_where_the_tool_is_upright() {
    let machine = machine("linuxcnc-xyzac-trt");
    let swing = machine.rotary.as_ref().unwrap().max_swing;
    let bent = |angle: f64| {
        let (s, c) = angle.sin_cos();
        let upright = [pose(5.0, 0.0, -5.2, 0.0, 0.0), pose(15.0, 0.0, -5.2, 0.0, 0.0)];
        run(&[
            pose(0.0, 0.0, -5.2, 0.06, 0.0),
            upright[0],
            upright[1],
            pose(20.0, 0.0, -5.2, -0.06 * c, -0.06 * s),
        ])
    };
    let stations = solved(&machine, vec![bent(0.8 * swing)]).remove(0);
    assert!(retreats(&stations).is_empty());
    for pair in stations.windows(2).filter(|pair| pair[0].leave.turn != pair[1].arrive.turn) {
        assert!(pair.iter().all(|station| station.arrive.tilt == 0.0));
    }
    let stations = solved(&machine, vec![bent(1.2 * swing)]).remove(0);
    let back = retreats(&stations);
    assert_eq!(back.len(), 1);
    assert_eq!((back[0].arrive.tilt, back[0].leave.tilt), (0.0, 0.0));
    assert!(((back[0].leave.turn - back[0].arrive.turn).abs() - 1.2 * swing).abs() < 1e-9);
}

#[test]
fn in_a_bend_c_turns_slowly_and_the_tool_stays() {
    let machine = machine("linuxcnc-xyzac-trt");
    let swing = machine.rotary.as_ref().unwrap().max_swing;
    // Upright only in the round end of a slit, with the axis square to what it was on the way out.
    let mut poses: Vec<Pose> = (0..=10).map(|i| pose(f64::from(i), 0.0, -5.2, 0.06, 0.0)).collect();
    poses.extend((0..=10).map(|i| {
        let (s, c) = (f64::from(i) * PI / 10.0).sin_cos();
        pose(11.0 + 0.5 * s, 0.5 - 0.5 * c, -5.2, 0.0, 0.0)
    }));
    poses.extend((1..=10).map(|i| pose(11.0 - f64::from(i), 1.0, -5.2, 0.0, 0.06)));
    let stations = solved(&machine, vec![run(&poses)]).remove(0);
    assert!(retreats(&stations).is_empty());
    let (turned, largest) = turned(&stations);
    assert!((turned[1] - PI / 2.0).abs() < 1e-9 && largest <= swing * (1.0 + 1e-12), "{turned:?} {largest}");
}

#[test]
fn limits_make_the_tool_retreat_away_from_bends() {
    let mut machine = machine("linuxcnc-xyzbc-trt");
    let rotary = machine.rotary.as_mut().unwrap();
    rotary.limits = [[-1.0, 1.0], [-200f64.to_radians(), 200f64.to_radians()]];
    let stations = solved(&machine, vec![ring(3, 0.07)]).remove(0);
    let back = retreats(&stations);
    assert!(!back.is_empty() && back.len() <= 4, "{}", back.len());
    let limits = machine.rotary.as_ref().unwrap().limits;
    for station in &stations {
        for angles in [station.arrive, station.leave] {
            assert!((limits[0][0]..=limits[0][1]).contains(&angles.tilt));
            assert!((limits[1][0]..=limits[1][1]).contains(&angles.turn));
        }
    }
    // The same ring without limits needs none.
    machine.rotary.as_mut().unwrap().limits[1] = [-100.0, 100.0];
    assert!(retreats(&solved(&machine, vec![ring(3, 0.07)])[0]).is_empty());
}

/// Joint coordinates stray by other amounts from either branch: none may be cut off by a block that suits the
/// other alone.
#[test]
fn without_tip_control_both_branches_go_on() {
    let mut machine = machine("linuxcnc-xyzbc-trt-no-tcp");
    machine.setup.fixture = nalgebra::Rotation3::from_axis_angle(&Vector3::y_axis(), 0.14);
    let rings = (1..6).map(|i| ring(2, 0.03 * f64::from(i))).collect();
    assert!(solved(&machine, rings).iter().all(|stations| retreats(stations).is_empty()));
}

/// Runs that each wind the same way are unwound above the stock before the limits are reached.
#[test]
fn windings_are_undone_between_runs() {
    let mut machine = machine("linuxcnc-xyzbc-trt");
    machine.rotary.as_mut().unwrap().limits[1] = [-40.0 * TAU, 40.0 * TAU];
    let runs = solved(&machine, (0..12).map(|_| ring(11, 0.07)).collect());
    assert!(runs.iter().all(|stations| retreats(stations).is_empty()));
}

#[test]
fn no_way_is_refused_with_its_place() {
    let mut machine = machine("linuxcnc-xyzbc-trt");
    machine.rotary.as_mut().unwrap().limits = [[-0.03, 0.03], [-100.0, 100.0]];
    let error = solve(&path(vec![ring(1, 0.01), ring(1, 0.07)]), &machine).unwrap_err();
    assert!(matches!(error, MachineError::Limits { run: 2, .. }), "{error}");
    assert!(error.to_string().contains("run 2, at (") && error.to_string().contains("wedge"), "{error}");
}

#[test]
fn bends_are_found_at_the_ends_of_slits() {
    let straight: Vec<Pose> = (0..=40).map(|i| pose(f64::from(i) * 0.5, 0.0, -5.2, 0.03, 0.0)).collect();
    let around = (1..12).map(|i| {
        let (s, c) = (f64::from(i) * PI / 12.0).sin_cos();
        pose(20.0 + 0.5 * s, 0.5 - 0.5 * c, -5.2, 0.03, 0.0)
    });
    let back = (0..=40).map(|i| pose(20.0 - f64::from(i) * 0.5, 1.0, -5.2, 0.03, 0.0));
    let poses: Vec<Pose> = straight.into_iter().chain(around).chain(back).collect();
    let machine = machine("linuxcnc-xyzbc-trt");
    let stations = solved(&machine, vec![run(&poses)]).remove(0);
    let clear = bends::distances(&stations, 1.0);
    for (station, clear) in stations.iter().zip(clear) {
        let to_end = 20.0 - station.pose.tip.x;
        assert!((clear - to_end).abs() < 1.01, "{to_end} {clear}");
    }
}

#[test]
fn wild_poses_are_refused() {
    let machine = machine("linuxcnc-xyzbc-trt");
    let mut nan = run(&[pose(0.0, 0.0, -5.2, 0.0, 0.0)]);
    nan.blocks[0].to.tip.x = f64::NAN;
    let mut sideways = run(&[pose(0.0, 0.0, -5.2, 0.0, 0.0)]);
    sideways.blocks[0].to.axis = Vector3::x_axis();
    let mut still = run(&[pose(0.0, 0.0, -5.2, 0.0, 0.0)]);
    still.blocks[0].rate = Rate::Feed(0.0);
    for (bad, what) in [(nan, "finite"), (sideways, "point up"), (still, "feed")] {
        let error = solve(&path(vec![bad]), &machine).unwrap_err().to_string();
        assert!(error.contains("run 1, block 1") && error.contains(what), "{error}");
    }
    let tilted = solve(&slots(), &super::super::examples::machine("linuxcnc-xyz")).unwrap_err();
    assert!(matches!(tilted, MachineError::Tilted { run: 1, .. }));
}
