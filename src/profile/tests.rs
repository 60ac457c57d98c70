use std::path::{Path, PathBuf};

use super::load::{EMBEDDED, load_with, names_with};
use super::*;
use crate::toml_source::{Diagnostic, ShelfError, TomlError, corruption};

const NOWHERE: &str = "no-such-folder";

fn embedded(name: &str) -> String {
    EMBEDDED.iter().find(|(known, _)| *known == name).unwrap().1.to_owned()
}

fn steel() -> String {
    embedded("steel-304-0.5mm")
}

fn nylon() -> String {
    embedded("nylon-6-5mm")
}

fn read(text: &str) -> Result<Profile, TomlError> {
    parse(text, "steel", "steel.toml")
}

fn diagnostic(text: &str) -> Diagnostic {
    match read(text) {
        Err(TomlError::Invalid(diagnostic)) => *diagnostic,
        other => panic!("{other:?} for\n{text}"),
    }
}

/// The text with another value at a dotted key; a comment after the value goes.
fn with(text: &str, key: &str, value: &str) -> String {
    let (table, name) = key.rsplit_once('.').unwrap_or(("", key));
    let mut here = "";
    let mut replaced = 0;
    let mut lines = Vec::new();
    for line in text.lines() {
        if let Some(header) = line.strip_prefix('[') {
            here = header.trim_end_matches(']');
        }
        let is_it = here == table && line.split('=').next().unwrap().trim() == name;
        replaced += usize::from(is_it);
        lines.push(if is_it { format!("{name} = {value}") } else { line.to_owned() });
    }
    assert_eq!(replaced, 1, "{key}");
    lines.join("\n")
}

/// Every dotted key of a text that has a value of its own.
fn keys(text: &str) -> Vec<String> {
    let root: toml::Table = text.parse().unwrap();
    let mut keys = Vec::new();
    for (name, value) in &root {
        match value.as_table() {
            Some(table) => keys.extend(table.keys().map(|key| format!("{name}.{key}"))),
            None => keys.push(name.clone()),
        }
    }
    keys
}

#[test]
fn every_embedded_profile_loads_and_equals_its_file() {
    for (name, text) in EMBEDDED {
        let embedded = load_with(name, Path::new(""), Path::new(NOWHERE)).unwrap();
        let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("profiles").join(format!("{name}.toml"));
        assert_eq!(std::fs::read_to_string(&path).unwrap(), text);
        assert_eq!(load(path.to_str().unwrap(), Path::new(NOWHERE)).unwrap(), embedded);
        assert_eq!(embedded.name, name);
        assert!(embedded.sheet.width >= 600.0 && embedded.sheet.height >= 600.0);
    }
    assert_eq!(names_with(Path::new(NOWHERE)), EMBEDDED.map(|(name, _)| name));
}

#[test]
fn every_file_of_the_folder_is_embedded() {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("profiles");
    assert_eq!(names_with(&folder), EMBEDDED.map(|(name, _)| name));
}

#[test]
fn the_steel_profile_has_the_numbers_of_its_file() {
    let steel = read(&steel()).unwrap();
    assert_eq!([steel.sheet.width, steel.sheet.height, steel.sheet.margin], [1000.0, 1000.0, 5.0]);
    assert_eq!([steel.sheet.thickness, steel.cut.kerf, steel.cut.min_web], [0.5, 0.05, 0.35]);
    // Rp0.2 / E, which the file rounds to three digits.
    assert!((steel.material.yield_strain - 310.0 / 193_000.0).abs() < 5e-6);
    assert_eq!(steel.material.coffin_manson, Some([0.25, -0.5]));
    assert_eq!((steel.ligament.width, steel.ligament_lengths()), (0.5, [0.5, 2.0]));
    assert_eq!(steel.hinge_gap(), 0.55);
    assert_eq!((steel.process, steel.cut.speed), (Process::Laser, 2.0));
    let beam = Beam { min_length: 0.5, max_length: 2.0, root_compliance: 1.25 };
    assert_eq!(steel.ligament.shape, Shape::Beam(beam));
}

#[test]
fn a_milled_groove_is_as_wide_as_its_tool_and_ends_in_the_notch() {
    let profile = read(&nylon()).unwrap();
    assert_eq!(profile.process, Process::Milling);
    // 300 mm/min in ten passes of 0.5 mm and one more at full depth, each there and back.
    assert_eq!(
        profile.cut,
        Cut { kerf: 1.0, min_web: 0.5, speed: 5.0 / 22.0, ruled: true, heat_affected: None }
    );
    assert_eq!((profile.hinge_gap(), profile.ligament_lengths()), (1.5, [1.0, 1.0]));
    assert_eq!(profile.material.conditioned_modulus, Some(1500.0));
    let longer = read(&with(&nylon(), "ligament.extra_length_mm", "1.0")).unwrap();
    assert_eq!(longer.ligament_lengths(), [2.0, 2.0]);
    assert_eq!(longer.hinge_gap(), 1.5);
}

#[test]
fn the_pole_of_a_ligament_is_a_part_of_its_length_or_that_of_an_arc() {
    let with = |value: &str| steel().replace("[ligament]\n", &format!("[ligament]\npole_offset = {value}\n"));
    assert_eq!(read(&steel()).unwrap().ligament.pole, Pole::Part(0.0));
    for (value, pole) in
        [("0.1", Pole::Part(0.1)), ("-0.2", Pole::Part(-0.2)), ("\"ideal-arc\"", Pole::IdealArc)]
    {
        assert_eq!(read(&with(value)).unwrap().ligament.pole, pole);
    }
    for (value, says) in [("0.6", "allowed is"), ("\"arc\"", "\"ideal-arc\""), ("true", "\"ideal-arc\"")] {
        let found = diagnostic(&with(value));
        assert_eq!(found.key, "ligament.pole_offset");
        assert!(found.to_string().contains(says), "{found}");
    }
}

#[test]
fn each_process_has_its_own_table_and_each_shape_its_own_keys() {
    for (text, process) in [(steel(), "milling"), (nylon(), "laser")] {
        let found = diagnostic(&with(&text, "process", &format!("\"{process}\"")));
        assert_eq!(found.key, "process");
        assert!(found.message.contains("has a table ["), "{found}");
    }
    let both = format!("{}\n[laser]\nkerf_mm = 1\nmin_web_mm = 1\ncutting_speed_mm_per_s = 1\n", nylon());
    assert_eq!(diagnostic(&both).key, "process");
    let found = diagnostic(&with(&steel(), "ligament.shape", "\"notch\""));
    assert_eq!(found.key, "ligament.min_length_mm");
    let found = diagnostic(&steel().replace("[ligament]\n", "[ligament]\nextra_length_mm = 1.0\n"));
    assert_eq!(found.key, "ligament.extra_length_mm");
    let found = diagnostic(&with(&nylon(), "ligament.shape", "\"round\""));
    assert!(found.message.contains("allowed is \"beam\", \"notch\", \"rounded\""), "{found}");
}

#[test]
fn each_value_has_its_source_or_calibrate_beside_it() {
    let mut numbers = 0;
    for (name, text) in EMBEDDED {
        let lines = text.lines().filter(|line| line.contains(" = ") && !line.starts_with('#'));
        for line in lines.filter(|line| !line.contains('"') || line.contains('#')) {
            if line != "version = 1" {
                numbers += 1;
                let comment = line.split_once('#').map_or("", |(_, comment)| comment.trim());
                assert!(comment.len() > 5, "{name}: {line}");
            }
        }
    }
    assert!(numbers >= 2 * 15, "{numbers}");
}

#[test]
fn each_key_refuses_impossible_values_by_name() {
    let mut tried = 0;
    for (_, text) in EMBEDDED {
        for key in keys(text) {
            for value in ["nan", "-nan", "inf", "-inf", "-1", "1e300", "-1e300", "\"\"", "[]"] {
                let found = diagnostic(&with(text, &key, value));
                assert_eq!(found.key, key, "{found}");
                let line = found.to_string().lines().nth(3).unwrap().to_owned();
                let name = key.rsplit('.').next().unwrap();
                assert!(line.contains(&format!("{name} = {value}")), "{found}");
                tried += 1;
            }
        }
    }
    assert!(tried > 9 * 35, "{tried}");
}

#[test]
fn each_key_is_required_or_optional_as_meant() {
    let text = steel();
    let mut optional = Vec::new();
    for key in keys(&text) {
        let name = key.rsplit('.').next().unwrap();
        let marked = with(&text, &key, "0");
        let removed: Vec<&str> = marked.lines().filter(|line| *line != format!("{name} = 0")).collect();
        match read(&removed.join("\n")) {
            Ok(_) => optional.push(key),
            Err(error) => assert!(error.to_string().contains(name), "{error}"),
        }
    }
    assert_eq!(optional, ["ligament.shape", "machine.engrave_speed_mm_per_s", "material.endurance_strain"]);
    let without =
        text.lines().filter(|line| !line.starts_with("coffin_manson")).collect::<Vec<_>>().join("\n");
    assert_eq!(read(&without).unwrap().material.coffin_manson, None);
}

#[test]
fn a_range_error_shows_the_place_the_value_the_range_and_the_reason() {
    let found = diagnostic(&with(&steel(), "laser.kerf_mm", "-0.05"));
    let line = 1 + steel().lines().position(|line| line.starts_with("kerf_mm")).unwrap();
    let expected = format!(
        "laser.kerf_mm = -0.05 is out of range: allowed is 0.005 to 2 mm
  --> steel.toml:{line}:11
   |
{line} | kerf_mm = -0.05
   |           ^^^^^
   |
   = help: a focused beam burns a groove of at least 0.005 mm; above 2 mm it is no laser's"
    );
    assert_eq!(found.to_string(), expected);
}

#[test]
fn numbers_that_contradict_each_other_are_refused() {
    let rules = [
        ("sheet.margin_mm", "500", "half of the sheet's shorter side, 500 mm"),
        ("material.strain_limit", "0.61", "material.elongation = 0.6"),
        ("material.yield_strain", "0.7", "material.elongation = 0.6"),
        ("material.endurance_strain", "0.0017", "material.yield_strain = 0.00161"),
        ("laser.kerf_mm", "0.36", "laser.min_web_mm = 0.35"),
        ("laser.min_web_mm", "0.51", "ligament.width_mm = 0.5"),
        ("ligament.min_length_mm", "2.01", "ligament.max_length_mm = 2"),
    ];
    for (key, value, limit) in rules {
        let found = diagnostic(&with(&steel(), key, value));
        assert_eq!(found.key, key);
        assert!(found.message.contains(limit), "{found}");
    }
    // The equal values are allowed, but for the margin.
    for (key, value) in
        [("sheet.margin_mm", "499.9"), ("material.strain_limit", "0.6"), ("laser.kerf_mm", "0.35")]
    {
        read(&with(&steel(), key, value)).unwrap();
    }
    let half =
        steel().lines().filter(|line| !line.starts_with("coffin_manson_e")).collect::<Vec<_>>().join("\n");
    assert_eq!(diagnostic(&half).key, "material.coffin_manson_coefficient");
}

#[test]
fn another_version_or_process_is_refused_before_unknown_keys() {
    let newer = with(&steel(), "version", "2").replace("[sheet]", "[sheet]\ncurvature = 1");
    assert!(diagnostic(&newer).message.contains("version = 2 is not a version"));
    let found = diagnostic(&with(&steel(), "process", "\"waterjet\""));
    assert_eq!(found.key, "process");
    assert!(found.message.contains("allowed is \"laser\", \"milling\""));
    let found = diagnostic(&steel().replace("[sheet]", "[sheet]\ncurvature = 1"));
    assert_eq!(found.key, "sheet.curvature");
}

#[test]
fn names_are_found_in_the_users_folder_first_and_paths_beside_the_base() {
    let folder = std::env::temp_dir().join(format!("kirimorph-profiles-{}", std::process::id()));
    let user = folder.join("profiles");
    std::fs::create_dir_all(&user).unwrap();
    let changed = with(&steel(), "laser.kerf_mm", "0.12");
    std::fs::write(user.join("steel-304-0.5mm.toml"), &changed).unwrap();
    std::fs::write(folder.join("mine.toml"), &changed).unwrap();
    std::fs::write(user.join("bad.toml"), "version = 1\n").unwrap();

    let by_name = load_with("steel-304-0.5mm", Path::new(NOWHERE), &user).unwrap();
    assert_eq!(by_name.cut.kerf, 0.12);
    let by_path = load_with("mine.toml", &folder, &user).unwrap();
    assert_eq!((by_path.cut.kerf, by_path.name.as_str()), (0.12, "mine"));
    assert!(load_with("profiles/bad.toml", &folder, &user).unwrap_err().to_string().contains("bad.toml:1"));
    assert!(matches!(
        load_with("absent.toml", &folder, &user),
        Err(ShelfError::Toml(TomlError::Read { .. }))
    ));
    let message = load_with("steel", &folder, &user).unwrap_err().to_string();
    assert!(
        message.contains("\"steel\"; there are bad, nitrile-rubber-2mm, nylon-6-5mm, nylon-6-conditioned-5mm, steel-304-0.5mm;"),
        "{message}"
    );
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn random_corruption_never_panics() {
    let mut refused = 0;
    for seed in 0..3000 {
        refused += usize::from(read(&corruption::corrupt(&steel(), seed)).is_err());
    }
    // Changes inside comments do no harm, most others do.
    assert!(refused > 1000, "{refused}");
}
