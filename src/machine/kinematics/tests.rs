use super::*;
use crate::machine::profile::{load, names};

/// A small generator of reproducible numbers in 0..1.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn within(&mut self, least: f64, largest: f64) -> f64 {
        least + (largest - least) * self.next()
    }

    fn direction(&mut self) -> Vector3<f64> {
        loop {
            let v = Vector3::from_fn(|_, _| self.within(-1.0, 1.0));
            if (0.1..1.0).contains(&v.norm()) {
                return v.normalize();
            }
        }
    }
}

fn machines() -> Vec<Machine> {
    let shipped = names().into_iter().map(|name| load(&name, std::path::Path::new(".")).unwrap());
    let turning: Vec<Machine> = shipped.filter(|machine| machine.rotary.is_some()).collect();
    let reversed = turning.iter().map(|machine| {
        let mut machine = machine.clone();
        if let Some(rotary) = &mut machine.rotary {
            rotary.sign = -rotary.sign;
        }
        machine.setup.fixture = Rotation3::from_axis_angle(&Vector3::y_axis(), 0.2);
        machine
    });
    turning.iter().cloned().chain(reversed).collect()
}

#[test]
fn both_branches_point_along_the_axis() {
    let mut numbers = Numbers(1);
    let mut worst: f64 = 0.0;
    for machine in machines() {
        let rotary = machine.rotary.as_ref().unwrap();
        for _ in 0..4000 {
            let axis = numbers.direction();
            for angles in rotary.branches(&axis) {
                worst = worst.max((rotary.axis(angles) - axis).norm());
                assert!(angles.tilt.abs() <= 1.5 * PI && angles.turn.abs() <= PI);
            }
        }
    }
    assert!(worst < 4e-15, "{worst:e}");
}

#[test]
fn tilt_is_exact_beside_the_pole() {
    for machine in machines() {
        let rotary = machine.rotary.as_ref().unwrap();
        let axis = Vector3::new(3e-9, -4e-9, 1.0);
        for angles in rotary.branches(&axis) {
            assert!((rotary.axis(angles) - axis).norm() < 1e-15);
        }
    }
}

/// The vectors of the published formulas, each typed from its own description.
#[test]
fn axes_follow_the_published_formulas() {
    let mut numbers = Numbers(2);
    for machine in machines() {
        let rotary = machine.rotary.as_ref().unwrap();
        let con = rotary.sign;
        for _ in 0..500 {
            let [a, c] = [numbers.within(-3.0, 3.0), numbers.within(-9.0, 9.0)];
            let ((sa, ca), (sc, cc)) = (a.sin_cos(), c.sin_cos());
            let expected = match rotary.table {
                Table::TiltAC => Vector3::new(sc * sa, -con * cc * sa, ca),
                Table::TiltBC => Vector3::new(con * cc * sa, sc * sa, ca),
                Table::TiltBA => Vector3::new(con * sa, -con * ca * sc, cc * ca),
            };
            assert!((rotary.axis(Angles { tilt: a, turn: c }) - expected).norm() < 1e-14);
        }
    }
}

#[test]
fn places_come_back() {
    let mut numbers = Numbers(3);
    for machine in machines() {
        for _ in 0..2000 {
            let tip = Point3::from(numbers.direction() * numbers.within(0.0, 300.0));
            let angles = Angles { tilt: numbers.within(-2.0, 2.0), turn: numbers.within(-20.0, 20.0) };
            let pose = machine.pose(&machine.joints(&tip, angles), angles);
            assert!((pose.tip - tip).norm() < 1e-12, "{}", machine.name);
        }
    }
}

/// `trtfuncs.c`, xyzac and xyzbc forward, and `xyzab_tdr_kins.comp`, term by term: rot-point (xr, yr, zr),
/// offsets d.
#[test]
fn places_follow_linuxcnc() {
    let mut numbers = Numbers(4);
    for name in ["linuxcnc-xyzac-trt", "linuxcnc-xyzbc-trt", "linuxcnc-xyzab-tdr"] {
        let mut machine = load(name, std::path::Path::new(".")).unwrap();
        machine.setup.zero = Point3::origin();
        let rotary = machine.rotary.as_mut().unwrap();
        let rot = Vector3::new(11.0, -7.0, 5.0);
        let d = match rotary.table {
            Table::TiltAC => Vector3::new(0.0, 20.0, -15.0),
            Table::TiltBC => Vector3::new(-20.0, 0.0, -15.0),
            Table::TiltBA => Vector3::new(0.0, 0.0, 35.0),
        };
        let (tilt_centre, turn_centre) =
            if rotary.table == Table::TiltBA { (rot, rot + d) } else { (rot + d, rot) };
        rotary.tilt_centre = Point3::from(tilt_centre);
        rotary.turn_centre = Point3::from(turn_centre);
        let table = rotary.table;
        for _ in 0..500 {
            let j = Vector3::from_fn(|_, _| numbers.within(-200.0, 200.0));
            let [tilt, turn] = [numbers.within(-2.0, 2.0), numbers.within(-7.0, 7.0)];
            let ((st, ct), (sc, cc)) = (tilt.sin_cos(), turn.sin_cos());
            let q = if table == Table::TiltBA { j - rot } else { j - rot - d };
            let p = match table {
                Table::TiltAC => Vector3::new(
                    cc * q.x + sc * ct * q.y + sc * st * q.z + sc * d.y,
                    -sc * q.x + cc * ct * q.y + cc * st * q.z + cc * d.y,
                    -st * q.y + ct * q.z + d.z,
                ),
                Table::TiltBC => Vector3::new(
                    cc * ct * q.x + sc * q.y - cc * st * q.z + cc * d.x,
                    -sc * ct * q.x + cc * q.y + sc * st * q.z - sc * d.x,
                    st * q.x + ct * q.z + d.z,
                ),
                Table::TiltBA => Vector3::new(
                    ct * q.x + st * q.z,
                    sc * st * q.x + cc * q.y - ct * sc * q.z + sc * d.z,
                    -cc * st * q.x + sc * q.y + cc * ct * q.z - cc * d.z + d.z,
                ),
            };
            let pose = machine.pose(&Point3::from(j), Angles { tilt, turn });
            assert!((pose.tip.coords - (p + rot)).norm() < 1e-11, "{name}: {} {}", pose.tip, p + rot);
        }
    }
}

#[test]
fn a_tool_lifted_along_its_axis_lifts_the_spindle_alone() {
    let mut numbers = Numbers(5);
    for machine in machines() {
        for _ in 0..200 {
            let angles = Angles { tilt: numbers.within(-0.5, 0.5), turn: numbers.within(-7.0, 7.0) };
            let tip = Point3::from(numbers.direction() * 100.0);
            let pose = Pose { tip, axis: machine.tool_axis(angles) };
            let change = machine.joints(&pose.lifted(30.0).tip, angles) - machine.joints(&tip, angles);
            assert!((change - Vector3::new(0.0, 0.0, 30.0)).norm() < 1e-11);
        }
    }
}
