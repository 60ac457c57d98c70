use super::*;
use crate::machine::examples::{header, machine, machines, slots, slots_for, with_decimals};
use crate::machine::{MachineError, post, read};

fn text(machine: &Machine) -> String {
    post(&slots_for(machine), machine, &header()).unwrap().files[0].1.clone()
}

#[test]
fn numbers_have_no_exponent_and_no_negative_zero() {
    let cases = [
        (0.0, "0.0"),
        (-0.0, "0.0"),
        (-0.000_001, "0.0"),
        (12.5, "12.5"),
        (-3.000_04, "-3.0"),
        (1e-9, "0.0"),
        (123_456.789_06, "123456.7891"),
        (-0.000_1, "-0.0001"),
        (100.0, "100.0"),
    ];
    for (value, expected) in cases {
        assert_eq!(number(value, 4), expected);
    }
}

#[test]
fn no_name_becomes_a_word() {
    for machine in machines() {
        let text = text(&machine);
        assert!(text.is_ascii() && !text.contains("M2 % of"), "{}", machine.name);
        let named = text.lines().find(|line| line.contains("job: ")).unwrap();
        assert!(named.contains("a _strange_ name_ M2 _ of_its own _"), "{named}");
        for line in text.lines() {
            assert!(line.len() < 250);
            let code = match machine.dialect {
                Dialect::LinuxCnc | Dialect::FanucAngles | Dialect::FanucVectors | Dialect::Haas => {
                    assert!(line.matches('(').count() <= 1 && line.matches(['(', ')']).count() != 1);
                    line.split('(').next().unwrap()
                }
                _ => line.split(';').next().unwrap(),
            };
            assert!(
                !code.contains("strange") && !code.contains("-0.0 ") && !code.ends_with("-0.0"),
                "{line}"
            );
        }
    }
}

#[test]
fn the_same_path_gives_the_same_bytes() {
    for machine in machines() {
        assert_eq!(text(&machine), text(&machine));
    }
}

/// Words that each controller needs, in their order.
#[test]
fn each_dialect_has_its_words_in_order() {
    let cases: [(&str, &[&str]); 7] = [
        (
            "linuxcnc-xyzbc-trt",
            &[
                "G21 ",
                "M68 E3 Q0",
                "M66",
                "G53 G0 Z",
                "M6",
                "G43 H1",
                "S12000 M3",
                "G4 P3",
                "M68 E3 Q1",
                "M66",
                "N1 (",
                "M68 E3 Q0",
                "M66",
                "G53 G0 Z",
                "G0 B0.0 C0.0",
                "M5",
                "M2",
            ],
        ),
        ("linuxcnc-xyzbc-trt-no-tcp", &["G43 H1", "G93", "N1 (", "G94", "G53 G0 Z", "M2"]),
        ("linuxcnc-xyz", &["G43 H1", "N1 (", "G53 G0 Z", "M2"]),
        (
            "fanuc-30i-ac",
            &["%", "O0001", "G21", "S12000 M3", "G43.4 H1 Z25.0", "N1 (", "G49", "G53", "M30", "%"],
        ),
        ("haas-umc-bc", &["%", "O0001", "S12000 M3", "G234 H1 Z25.0", "N1 (", "G49", "G53", "M30", "%"]),
        (
            "heidenhain-bc",
            &[
                "0 BEGIN PGM MILL MM",
                "BLK FORM 0.1",
                "M127",
                "M91",
                "TOOL CALL 1 Z S12000",
                "Q339=+1",
                "M3",
                "FMAX",
                "FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS",
                "FUNCTION RESET TCPM",
                "M91",
                "M30",
                "END PGM MILL MM",
            ],
        ),
        (
            "siemens-840d-ac",
            &[
                "G710",
                "SUPA G0 Z0.0 D0",
                "A=0.0 C=0.0",
                "M6",
                "D1",
                "TRAORI",
                "G54",
                "ORIMKS ORIAXES",
                "N1 ;",
                " A=",
                "TRAFOOF",
                "SUPA G0 Z0.0 D0",
                "M30",
            ],
        ),
    ];
    for (name, words) in cases {
        let text = text(&machine(name));
        let mut rest = text.as_str();
        for word in words {
            let at = rest.find(word).unwrap_or_else(|| panic!("{name}: no {word} in\n{rest}"));
            rest = &rest[at + word.len()..];
        }
        assert_eq!(rest, "\n", "{name} goes on");
    }
}

#[test]
fn vectors_and_m128_are_the_same_path_in_other_words() {
    let cases = [
        ("fanuc-30i-ac", Dialect::FanucVectors, "G43.5 H1 Q0.0 Z", " I"),
        ("siemens-840d-ac", Dialect::SiemensVectors, "ORIWKS ORIVECT", " A3="),
        ("heidenhain-bc", Dialect::HeidenhainM128, "M128", " B-"),
    ];
    for (name, dialect, on, word) in cases {
        let first = with_decimals(&machine(name), 7, 8);
        let mut second = first.clone();
        second.dialect = dialect;
        let [a, b] = [&first, &second].map(|machine| read(&text(machine), machine).unwrap());
        assert!(text(&second).contains(on) && text(&second).contains(word));
        // A turn of C alone moves no vector: those blocks are not there.
        let mut others = b.iter();
        let mut shared = 0;
        for motion in &a {
            let same = |other: &&crate::machine::Motion| {
                let axis = (other.pose.axis.as_ref() - motion.pose.axis.as_ref()).norm();
                (other.pose.tip - motion.pose.tip).norm() < 1e-6 && axis < 1e-7
            };
            shared += usize::from(others.clone().take(3).any(|other| same(&other)));
            if others.clone().next().is_some_and(|other| same(&other)) {
                others.next();
            }
        }
        assert!(shared * 100 > a.len() * 95, "{name}: {shared} of {}", a.len());
    }
}

#[test]
fn small_memories_get_whole_programs_in_order() {
    for name in ["linuxcnc-xyzbc-trt", "heidenhain-bc"] {
        let mut machine = machine(name);
        let whole = post(&slots(), &machine, &header()).unwrap();
        machine.output.max_bytes = Some(20_000);
        let split = post(&slots(), &machine, &header()).unwrap();
        assert!(split.files.len() > 1);
        let ending = ending(machine.dialect);
        assert_eq!(split.files[1].0, format!("mill-02.{ending}"));
        let low = |program: &crate::machine::Program| -> usize {
            let count = |text: &str| {
                read(text, &machine).unwrap().iter().filter(|motion| motion.pose.tip.z < 0.0).count()
            };
            program.files.iter().map(|(_, text)| count(text)).sum()
        };
        assert_eq!(low(&split), low(&whole));
        assert!(split.files.iter().all(|(_, text)| text.len() <= 20_000));
        let runs: Vec<usize> = split.stats.restarts.iter().map(|restart| restart.run).collect();
        assert_eq!(runs, (0..slots().runs.len()).collect::<Vec<_>>());
    }
}

#[test]
fn a_program_can_begin_at_any_run() {
    for name in ["linuxcnc-xyzbc-trt", "siemens-840d-ac"] {
        let machine = machine(name);
        let whole = post(&slots(), &machine, &header()).unwrap();
        for restart in &whole.stats.restarts {
            let line = whole.files[restart.file].1.lines().nth(restart.line - 1).unwrap();
            assert!(line.contains(&format!("run {} of ", restart.run + 1)), "{line}");
        }
        let late = post(&slots(), &machine, &Header { first_run: 9, ..header() }).unwrap();
        assert_eq!(late.stats.runs, slots().runs.len() - 9);
        let tips = |text: &str, from: f64| -> Vec<crate::geometry::Point3> {
            let motions = read(text, &machine).unwrap();
            motions.iter().map(|motion| motion.pose.tip).filter(|tip| tip.z < 0.0 && tip.x > from).collect()
        };
        let (a, b) = (tips(&whole.files[0].1, 125.0), tips(&late.files[0].1, 125.0));
        assert!(!b.is_empty() && a.len() >= b.len());
    }
    let none = Header { first_run: 99, ..header() };
    let error = post(&slots(), &machine("linuxcnc-xyzbc-trt"), &none).unwrap_err();
    assert!(matches!(error, MachineError::NoRun { first: 100, count: 17 }), "{error}");
}

#[test]
fn what_the_machine_does_not_have_is_refused() {
    let machine = machine("linuxcnc-xyzbc-trt");
    let fast = Header { spindle_rpm: 90_000.0, ..header() };
    assert!(matches!(post(&slots(), &machine, &fast), Err(MachineError::Spindle { .. })));
    let mut short = machine.clone();
    short.travel[0] = [-100.0, 100.0];
    let error = post(&slots(), &short, &header()).unwrap_err();
    assert!(matches!(error, MachineError::Travel { axis: 'X', .. }), "{error}");
    assert!(error.to_string().contains("travels from -100 to 100 mm"), "{error}");
}

/// Time by hand: 10 mm at 300 mm/min and 5.2 + 0.8 mm down at 100.
#[test]
fn time_is_length_over_feed() {
    use crate::machine::examples::{path, pose, run};
    let machine = machine("linuxcnc-xyz");
    let job = path(vec![run(&[pose(10.0, 20.0, -5.2, 0.0, 0.0), pose(20.0, 20.0, -5.2, 0.0, 0.0)])]);
    let stats = post(&job, &machine, &header()).unwrap().stats;
    let up = 60.0 * 6.0 / 800.0;
    assert!((stats.cut_seconds - (2.0 + 3.6 + up)).abs() < 1e-9, "{}", stats.cut_seconds);
    // Down from the safe height and up again, 24.2 mm each, and the spindle's start.
    let air = 60.0 * 2.0 * 24.2 / 3000.0 + 3.0;
    assert!((stats.air_seconds - air).abs() < 1e-9, "{} {air}", stats.air_seconds);
    assert!((stats.cut_length - 22.0).abs() < 1e-9);
}
