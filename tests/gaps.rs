//! Hinges where they belong: gaps that carry the pole of bent ligaments and the tilt of milled walls, on designs as a user
//! makes them, and every ligament of every sample at its place.

mod peers;
mod program;

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use program::{design, made, number, run, sample_dome};
use serde_json::Value;

/// A shipped profile with further lines in its sections.
fn profile(name: &str, lines: &[(&str, &str)]) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("profiles").join(format!("{name}.toml"));
    let mut text = fs::read_to_string(path).unwrap();
    for (section, line) in lines {
        let at = text.find(&format!("[{section}]\n")).unwrap() + section.len() + 3;
        text.insert_str(at, &format!("{line}\n"));
    }
    text
}

fn hinges(folder: &Path) -> Vec<Value> {
    let file: Value = serde_json::from_slice(&fs::read(folder.join("hinges.json")).unwrap()).unwrap();
    file["hinges"].as_array().unwrap().clone()
}

/// A folder with the sample's dome, a profile and a job for it.
fn job_folder(name: &str, profile: &str, pieces: usize, keys: &str) -> std::path::PathBuf {
    let folder = peers::fresh_folder(name);
    fs::write(folder.join("dome.obj"), sample_dome()).unwrap();
    fs::write(folder.join("own.toml"), profile).unwrap();
    let pattern = format!("pieces = [{pieces}, {pieces}]\n{keys}");
    let job = program::job("open = \"dome.obj\"", &pattern, "profile = \"own.toml\"");
    fs::write(folder.join("job.toml"), job).unwrap();
    folder
}

fn point(value: &Value) -> [f64; 3] {
    serde_json::from_value(value.clone()).unwrap()
}

/// Corner of a hinge, and how far its point stands from the corner's midpoint.
fn arm(design: &Value, hinge: &Value) -> (usize, [f64; 3]) {
    let index = |key: &str| hinge[key][0].as_u64().unwrap() as usize;
    let corner = design["pieces"][index("pieces")]["corners"][index("vertices")].as_u64().unwrap() as usize;
    let (from, to) = (point(&design["corners"][corner]), point(&hinge["point"]));
    (corner, [0, 1, 2].map(|i| to[i] - from[i]))
}

#[test]
fn ligaments_stand_off_their_hinges_by_their_poles_and_turn_about_them() {
    let own = profile(
        "steel-304-0.5mm",
        &[("ligament", "pole_offset = \"ideal-arc\""), ("laser", "heat_affected_mm = 0.1")],
    );
    let folder = job_folder("gaps-pole", &own, 12, "");
    let out = made(&folder, "job.toml", "out");
    let design = design(&out);
    let mut inner = 0;
    for (row, hinge) in hinges(&out).iter().zip(design["hinges"].as_array().unwrap()) {
        let (angle, length) = (number(row, "angle_deg").to_radians(), number(row, "length_mm"));
        // The ideal arc's pole; the cut files hold it to within the rounding of lengths, and two rounds of optimisation.
        let pole = length * (1.0 / angle - 0.5 / (0.5 * angle).tan());
        assert!((number(row, "pole_offset_mm") - pole).abs() < 1e-9 && pole > 0.09, "{row}");
        assert!(number(row, "centre_offset_mm") < 2e-3, "{row}");
        assert!((number(row, "width_mm") - 0.5).abs() < 1e-3, "{row}");
        assert!((number(row, "heat_margin_mm") - 0.3).abs() < 1e-9, "{row}");
        let across = arm(&design, hinge).1.iter().map(|x| x * x).sum::<f64>().sqrt();
        if across > 1e-6 {
            inner += 1;
            // h + k = 0.55 mm.
            assert!((across - (0.275 - pole)).abs() < 2e-3, "{across} {pole}");
        }
    }
    assert!(inner > 200);
    let verified = run(&folder, ["verify", "out", "--profile", "own.toml"]);
    assert_eq!(verified.status, 0, "{}", verified.stderr);
    // Without the key the same ligaments would be off their poles, and the files are not those of that profile.
    let verified = run(&folder, ["verify", "out", "--profile", "steel-304-0.5mm"]);
    assert_eq!(verified.status, 2);
    assert!(verified.stderr.contains("off the hinge point"), "{}", verified.stderr);
}

#[test]
fn sheets_that_are_cut_open_carry_their_poles_away_from_the_windows_that_close() {
    let own = profile("steel-304-0.5mm", &[("ligament", "pole_offset = \"ideal-arc\"")]);
    let folder = peers::fresh_folder("gaps-open-pole");
    let samples = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples");
    let job =
        fs::read_to_string(samples.join("closing.toml")).unwrap().replace("steel-304-0.5mm", "own.toml");
    fs::copy(samples.join("closing.obj"), folder.join("closing.obj")).unwrap();
    fs::write(folder.join("own.toml"), own).unwrap();
    fs::write(folder.join("job.toml"), job).unwrap();
    let out = made(&folder, "job.toml", "out");
    // The two hinge points of every closed corner stand apart by a ligament, a groove and both poles.
    let design = design(&out);
    let rows = hinges(&out);
    let mut corners: BTreeMap<usize, Vec<([f64; 3], f64)>> = BTreeMap::new();
    for (row, hinge) in rows.iter().zip(design["hinges"].as_array().unwrap()) {
        let pole = number(row, "pole_offset_mm");
        assert!(pole > 0.09 && number(row, "centre_offset_mm") < 1e-3, "{row}");
        let index = |key: &str| hinge[key][0].as_u64().unwrap() as usize;
        let piece = &design["pieces"][index("pieces")];
        let corner = piece["corners"][index("vertices")].as_u64().unwrap() as usize;
        corners.entry(corner).or_default().push((point(&piece["closed"][index("vertices")]), pole));
    }
    let pairs: Vec<_> = corners.values().filter(|hinges| hinges.len() == 2).collect();
    assert!(pairs.len() > 400, "{}", pairs.len());
    // A lift out of the sheet, which a closed sheet in space needs at some corners, parts them further.
    let mut exact = 0;
    for pair in &pairs {
        let apart = (0..3).map(|i| (pair[0].0[i] - pair[1].0[i]).powi(2)).sum::<f64>().sqrt();
        let needed = 0.55 + pair[0].1 + pair[1].1;
        assert!(apart > needed - 2e-3, "{apart} {needed}");
        exact += usize::from(apart < needed + 0.05);
    }
    assert!(2 * exact > pairs.len(), "{exact} of {}", pairs.len());
    let verified = run(&folder, ["verify", "out", "--profile", "own.toml"]);
    assert_eq!(verified.status, 0, "{}", verified.stderr);
    let verified = run(&folder, ["verify", "out", "--profile", "steel-304-0.5mm"]);
    assert!(verified.status == 2 && verified.stderr.contains("off the hinge point"), "{}", verified.stderr);
}

#[test]
fn milled_gaps_have_room_for_two_axes_that_tilt_apart() {
    let own = profile("nylon-6-5mm", &[]).replace("strain_limit = 0.37", "strain_limit = 0.49");
    let own = own.replace("extra_length_mm = 0.0", "extra_length_mm = 1.5");
    let folder = job_folder("gaps-milled", &own, 18, "");
    let done = run(&folder, ["design", "job.toml", "-o", "design.json"]);
    assert_eq!(done.status, 0, "{}", done.stderr);
    let design: Value = serde_json::from_slice(&fs::read(folder.join("design.json")).unwrap()).unwrap();
    type Arm = ([f64; 3], [f64; 3]);
    let mut corners: BTreeMap<usize, Vec<Arm>> = BTreeMap::new();
    for hinge in design["hinges"].as_array().unwrap() {
        let (corner, arm) = arm(&design, hinge);
        corners.entry(corner).or_default().push((arm, point(&hinge["axis"])));
    }
    let mut grown = 0.0_f64;
    for pair in corners.values().filter(|hinges| hinges.len() == 2) {
        let across = [0, 1].map(|i| pair[0].0[i] - pair[1].0[i]);
        let gap = across[0].hypot(across[1]);
        let lean = |axis: [f64; 3]| (axis[0] * across[0] + axis[1] * across[1]) / gap / axis[2];
        // h + k + t/2 |l1 - l2|: 0.5, 1 and 5 mm.
        let needed = 1.5 + 2.5 * (lean(pair[0].1) - lean(pair[1].1)).abs();
        assert!((gap - needed).abs() < 2e-3, "{gap} {needed}");
        grown = grown.max(gap - 1.5);
    }
    assert!(grown > 0.1, "{grown}");
}

#[test]
fn the_papers_model_without_a_gap_stays_available_and_its_error_is_told() {
    let folder = job_folder("gaps-none", &profile("steel-304-0.5mm", &[]), 12, "gap_mm = 0.0");
    let out = made(&folder, "job.toml", "out");
    let rows = hinges(&out);
    // Two hinges of an inner corner stand in one point, their ligaments half of h + k beside it.
    let off = rows.iter().filter(|row| number(row, "centre_offset_mm") > 0.2);
    assert!(off.clone().count() > 200);
    for row in off {
        assert!((number(row, "centre_offset_mm") - 0.275).abs() < 0.01, "{row}");
        assert!(row["verdict"] == "warn" && row["reason"].as_str().unwrap().contains("from the hinge point"));
    }
}

/// Every ligament of every sample that is cut: its width, and its centre at its place.
#[test]
fn every_ligament_of_every_sample_is_at_its_place() {
    let samples = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples");
    let mut names: Vec<_> = fs::read_dir(&samples).unwrap().map(|entry| entry.unwrap().path()).collect();
    names.retain(|path| path.extension().is_some_and(|end| end == "toml"));
    names.sort();
    let folder = peers::fresh_folder("gaps-samples");
    let mut wrong = Vec::new();
    for job in &names {
        let name = job.file_stem().unwrap().to_str().unwrap();
        let out = made(&folder, job.to_str().unwrap(), name);
        let file: Value = serde_json::from_slice(&fs::read(out.join("hinges.json")).unwrap()).unwrap();
        if file["cut"].is_null() {
            continue;
        }
        let wanted = number(&file, "ligament_width_mm");
        let rows = file["hinges"].as_array().unwrap();
        let width = rows.iter().map(|row| (number(row, "width_mm") - wanted).abs()).fold(0.0, f64::max);
        let centre = rows.iter().map(|row| number(row, "centre_offset_mm")).fold(0.0, f64::max);
        println!("{name}: {} hinges, width within {width:.4} mm, centre within {centre:.4} mm", rows.len());
        if width > 0.01 || centre > 0.01 {
            wrong.push(format!("{name}: width {width:.4} mm, centre {centre:.4} mm"));
        }
    }
    assert!(names.len() > 12);
    assert_eq!(wrong, Vec::<String>::new());
}
