use super::*;
use crate::toml_source::corruption;

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

fn text_of(name: &str) -> String {
    std::fs::read_to_string(format!("{}/profiles/machines/{name}.toml", ROOT)).unwrap()
}

/// What the reader says of a shipped file with one piece of text exchanged.
fn complaint(name: &str, from: &str, to: &str) -> String {
    let text = text_of(name);
    assert!(text.contains(from), "{name} has no {from:?}");
    parse(&text.replacen(from, to, 1), name, "m.toml").unwrap_err().to_string()
}

#[test]
fn every_shipped_machine_is_read_and_known_by_name() {
    let folder = format!("{}/profiles/machines", ROOT);
    let mut files: Vec<String> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap().replace(".toml", ""))
        .collect();
    files.sort();
    assert_eq!(files, names());
    for name in files {
        let machine = parse(&text_of(&name), &name, "m.toml").unwrap();
        assert_eq!(machine, load(&name, std::path::Path::new(".")).unwrap());
        assert_eq!(machine.rotary.is_none(), name == "linuxcnc-xyz");
    }
}

#[test]
fn wrong_files_are_refused_with_key_value_and_limit() {
    let bc = "linuxcnc-xyzbc-trt";
    let cases = [
        (bc, "version = 1", "version = 2", "allowed is 1"),
        (bc, "kind = \"xyzbc-trt\"", "kind = \"hexapod\"", "allowed is \"xyz\""),
        (bc, "kind = \"xyzbc-trt\"", "kind = \"xyzac-trt\"", "not for a machine without an axis B"),
        (bc, "kind = \"xyzbc-trt\"", "kind = \"xyz\"", "three axes turn nothing"),
        (bc, "dialect = \"linuxcnc\"", "dialect = \"grbl\"", "\"heidenhain-tcpm\""),
        (bc, "b_deg = [-100.0, 50.0]", "b_deg = [50.0, -100.0]", "not below the other end"),
        (bc, "b_deg = [-100.0, 50.0]", "b_deg = [10.0, 50.0]", "without zero"),
        (bc, "b_deg = [-100.0, 50.0]", "", "without the limits b_deg"),
        (bc, "sign = -1", "sign = 0", "allowed is 1 or -1"),
        (bc, "rapid_deg_per_min = 1800.0", "rapid_deg_per_min = nan", "not a finite number"),
        (bc, "max_swing_deg = 30.0", "max_swing_deg = 400.0", "0.1 to 180 degrees"),
        (bc, "clearance_mm = 2.0", "clearance_mm = 26.0", "at most setup.safe_height_mm = 25"),
        (bc, "home_z_mm = 0.0", "home_z_mm = 5.0", "linear.z_mm = -400 to 0"),
        (bc, "work_offset = 54", "work_offset = 60", "54 to 59"),
        (bc, "tool_number = 1", "tool_number = 0", "1 to 999"),
        (bc, "coolant = \"off\"", "coolant = \"oil\"", "\"flood\""),
        (bc, "axis = \"y\"", "axis = \"z\"", "allowed is \"x\", \"y\""),
        (bc, "decimals = 5", "decimals = 2", "3 to 9"),
        (bc, "tcp_on = 1", "tcp_on = 7", "0 to 2"),
        (bc, "tool_number = 1", "tool_nmber = 1", "unknown key"),
        ("linuxcnc-xyz", "tcp = false", "tcp = true", "write `tcp = false`"),
        ("haas-umc-bc", "tcp = true", "tcp = false", "not for this dialect"),
    ];
    for (name, from, to, expected) in cases {
        let text = complaint(name, from, to);
        assert!(text.contains(expected) && text.contains("m.toml:"), "{from} -> {to}:\n{text}");
    }
}

#[test]
fn no_corruption_of_the_text_panics() {
    let text = text_of("linuxcnc-xyzbc-trt");
    let refused = (0..500).filter(|&seed| parse(&corruption::corrupt(&text, seed), "m", "m.toml").is_err());
    assert!(refused.count() > 100);
}

#[test]
fn an_unknown_name_lists_the_known_ones() {
    let error = load("linuxcnc-xyzzy", std::path::Path::new(".")).unwrap_err().to_string();
    assert!(error.contains("linuxcnc-xyzzy") && error.contains("siemens-840d-ac"), "{error}");
}
