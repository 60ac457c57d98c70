//! Every case of two states from its sample: closing onto a surface, from surface to surface, openings that vary, and the
//! user's map. Each is made as a user makes it and measured again by independent programs.

mod peers;
mod program;

use std::f64::consts::SQRT_2;
use std::path::{Path, PathBuf};

use program::{
    ASSEMBLY_FILES, FILES, OPEN_SHEET_FILES, STEEL, asked, design, made, number, refused, run, sample,
};
use serde_json::{Value, json};

/// Makes a sample, which must not have a failing hinge; its folder.
fn made_sample(name: &str, files: &[&str]) -> PathBuf {
    let folder = peers::fresh_folder(&format!("case-{name}"));
    let job = sample(&format!("{name}.toml"));
    let out = made(&folder, job.to_str().unwrap(), "out");
    let mut names: Vec<_> = std::fs::read_dir(&out).unwrap().map(|e| e.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, files);
    let hinges: Value = serde_json::from_slice(&std::fs::read(out.join("hinges.json")).unwrap()).unwrap();
    assert!(hinges["hinges"].as_array().unwrap().iter().all(|hinge| hinge["verdict"] != "fail"));
    out
}

/// Smallest and largest hinge angle, degrees.
fn angles(design: &Value) -> [f64; 2] {
    let angles = design["hinges"].as_array().unwrap().iter().map(|hinge| number(hinge, "angle_deg"));
    angles.fold([f64::INFINITY, 0.0], |[low, high], angle| [low.min(angle), high.max(angle)])
}

/// The measures of the main job, for these states; `edge` is whether the pieces have a wanted size.
fn check_report(folder: &Path, states: &[&str], edge: bool) -> Value {
    let design = design(folder);
    let report = &design["report"];
    assert!(number(report, "max_length_error") <= 1e-8);
    assert!(number(report, "planarity") <= 1e-4);
    let side = number(report, "mean_edge_mm");
    if edge {
        assert!((side / number(report, "asked_edge_mm") - 1.0).abs() <= 0.1);
    }
    for state in ["closed", "open"] {
        let fit = &report[state];
        assert_eq!(!fit.is_null(), states.contains(&state), "{state}: {fit}");
        if fit.is_null() {
            continue;
        }
        assert!(number(fit, "distance_max_mm") <= 2e-3 * number(fit, "target_diagonal_mm"), "{state}: {fit}");
        if fit["boundary_held"] == json!(true) {
            for key in ["boundary_max_mm", "coverage_max_mm"] {
                assert!(number(fit, key) <= 1.5 * SQRT_2 * side, "{state}, {key}: {fit}");
                assert!(number(fit, key) <= number(report, key), "{state}, {key}: {fit}");
            }
        }
    }
    if let Some(found) = asked(peers::oracle("design_check.py"), &[&folder.join("design.json")]) {
        assert!(number(&found, "max_length_error") <= 1e-8);
        assert!(number(&found, "planarity") <= 1e-4);
        for key in ["e_isom_difference", "length_difference", "planarity_difference", "mean_edge_difference"]
        {
            assert!(number(&found, key) <= 1e-12, "{key}: {}", found[key]);
        }
        for key in ["apart_mm", "point_mm", "motion_mm", "rotation_difference"] {
            assert!(number(&found, key) <= 1e-9, "{key}: {}", found[key]);
        }
    }
    design
}

/// Burns the cut file on paper: one body, every ligament where its hinge is.
fn check_burned(folder: &Path) {
    let files = ["cut.dxf", "hinges.json", "design.json"].map(|name| folder.join(name));
    let burned =
        asked(peers::oracle("burn.py"), &[&files[0], &files[1], &files[2], &"--sheet", &"1000", &"1000"]);
    if let Some(burned) = burned {
        assert_eq!((&burned["ok"], &burned["bodies"]), (&json!(true), &json!(1)), "{burned}");
        assert!(number(&burned, "worst_width_error_mm") <= 0.02, "{burned}");
    }
}

/// Brute force against the target of the open state.
fn check_open_target(folder: &Path, target: &str) {
    let found = asked(peers::oracle("made_folder.py"), &[&folder, &sample(target), &"--scale", &"1"]);
    let Some(found) = found else { return };
    let fit = &design(folder)["report"]["open"];
    let pairs = [("distance_mm", "distance_max_mm"), ("diagonal_mm", "target_diagonal_mm")];
    for (theirs, ours) in pairs {
        let difference = number(&found, theirs) - number(fit, ours);
        assert!(difference.abs() <= 5e-6, "{theirs}: {found} {fit}");
    }
    assert!(number(&found, "normal") > 0.99, "{found}");
}

#[test]
fn an_open_sheet_closes_to_a_vault_with_room_for_its_ligaments() {
    let out = made_sample("closing", &OPEN_SHEET_FILES);
    let design = check_report(&out, &["closed"], true);
    assert_eq!(design["sheet_state"], "open");
    let pieces = design["pieces"].as_array().unwrap();
    assert!((400..=600).contains(&pieces.len()));
    check_burned(&out);
    let files = ["cut.dxf", "hinges.json", "design.json"].map(|name| out.join(name));
    let closed = asked(
        peers::oracle("closed_state.py"),
        &[&files[0], &files[1], &files[2], &"--kerf", &"0.05", &"--curved"],
    );
    if let Some(closed) = closed {
        assert_eq!(closed["ok"], json!(true), "{closed}");
        assert!(number(&closed, "least_gap_mm") > 0.0 && number(&closed, "worst_motion_miss_mm") < 1e-9);
    }
    // The closed sheet steps across its slits, by a part of a piece; the steps are in the summary.
    let step = number(&design["report"], "closed_step_max_mm");
    assert!(step > 0.1 && step < 0.15 * number(&design["report"], "mean_edge_mm"), "{step}");
    assert!((step - largest_step(&design)).abs() < 1e-9, "{step} {}", largest_step(&design));
}

/// The largest step between the two closed hinge points of a corner along the mean normal of the pieces around it.
fn largest_step(design: &Value) -> f64 {
    let point = |p: &Value| [0, 1, 2].map(|k| p[k].as_f64().unwrap());
    let minus = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|k| a[k] - b[k]);
    let dot = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let pieces = design["pieces"].as_array().unwrap();
    let mut normals = vec![[0.0; 3]; design["corners"].as_array().unwrap().len()];
    for piece in pieces {
        let [p, q, r, s] = [0, 1, 2, 3].map(|i| point(&piece["closed"][i]));
        // A quad's area vector: half the product of its diagonals.
        let (a, b) = (minus(r, p), minus(s, q));
        let area = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
        for corner in piece["corners"].as_array().unwrap() {
            let normal = &mut normals[corner.as_u64().unwrap() as usize];
            *normal = [0, 1, 2].map(|k| normal[k] + area[k]);
        }
    }
    let mut hinges = vec![Vec::new(); normals.len()];
    for hinge in design["hinges"].as_array().unwrap() {
        let [piece, vertex] =
            [&hinge["pieces"][0], &hinge["vertices"][0]].map(|i| i.as_u64().unwrap() as usize);
        let corner = pieces[piece]["corners"][vertex].as_u64().unwrap() as usize;
        hinges[corner].push(point(&pieces[piece]["closed"][vertex]));
    }
    let step = |(points, normal): (&Vec<[f64; 3]>, &[f64; 3])| match points[..] {
        [p, q] => dot(minus(p, q), *normal).abs() / dot(*normal, *normal).sqrt(),
        _ => 0.0,
    };
    hinges.iter().zip(&normals).map(step).fold(0.0, f64::max)
}

#[test]
fn one_surface_opens_to_another_and_there_is_no_cut_file() {
    let out = made_sample("roof", &ASSEMBLY_FILES);
    let design = check_report(&out, &["closed", "open"], true);
    assert_eq!(design["sheet_state"], Value::Null);
    // The closed sheet covers a part of its paraboloid, and the report says how large a part.
    let [closed, open] = ["closed", "open"].map(|state| &design["report"][state]);
    assert_eq!([&closed["boundary_held"], &open["boundary_held"]], [&json!(false), &json!(true)]);
    let covered = number(closed, "covered");
    assert!(covered > 0.5 && covered < 0.9, "{covered}");
    // A target that is covered in part has places far from the sheet.
    assert!(number(closed, "coverage_max_mm") > 10.0);
    assert_eq!(number(&design["report"], "coverage_max_mm"), number(open, "coverage_max_mm"));
    // Per piece twelve triangles in both states: top, bottom and four sides.
    let pieces = design["pieces"].as_array().unwrap().len();
    for name in ["pieces-closed.stl", "pieces-open.stl"] {
        let bytes = std::fs::read(out.join(name)).unwrap();
        let count = u32::from_le_bytes(bytes[80..84].try_into().unwrap()) as usize;
        assert_eq!((count, bytes.len()), (12 * pieces, 84 + 50 * count), "{name}");
    }
    assert!(
        (volume(&out.join("pieces-closed.stl")) / volume(&out.join("pieces-open.stl")) - 1.0).abs() < 1e-4
    );
    let page = std::fs::read_to_string(out.join("preview.svg")).unwrap();
    assert!(
        page.contains("No flat state, no cut file") && page.contains("1  Closed") && page.contains("2  Open")
    );
}

/// Volume of the solids of a binary STL, mm3.
fn volume(file: &Path) -> f64 {
    let bytes = std::fs::read(file).unwrap();
    let number = |at: usize| f64::from(f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()));
    let facet = |start: usize| {
        let [a, b, c] = [0, 1, 2].map(|i| [0, 1, 2].map(|k| number(start + 12 + 12 * i + 4 * k)));
        (a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0]))
            / 6.0
    };
    (84..bytes.len()).step_by(50).map(facet).sum()
}

#[test]
fn a_missing_cut_file_is_told_on_the_terminal_and_to_machines() {
    let folder = peers::fresh_folder("case-no-cut-file");
    let job = sample("roof.toml");
    let told = run(&folder, ["make".as_ref(), job.as_os_str(), "-o".as_ref(), "roof".as_ref()]);
    assert_eq!((told.status, told.stderr.as_str()), (0, ""));
    assert!(told.stdout.starts_with("roof: made\n"), "{}", told.stdout);
    for part in [
        "no flat cut file, though the profile steel-304-0.5mm is for cutting sheets",
        "off the target",
        "closed ",
    ] {
        assert!(told.stdout.contains(part), "{part:?} is not in {}", told.stdout);
    }
    let told =
        run(&folder, ["make".as_ref(), job.as_os_str(), "-o".as_ref(), "roof".as_ref(), "--json".as_ref()]);
    let event: Value = serde_json::from_str(told.stdout.lines().last().unwrap()).unwrap();
    assert_eq!((&event["status"], &event["cut_file"]), (&json!(0), &json!(false)), "{event}");
    assert!(event["remark"].as_str().unwrap().contains("no flat cut file"), "{event}");
    let mut files: Vec<&str> =
        event["files"].as_array().unwrap().iter().map(|f| f.as_str().unwrap()).collect();
    files.sort_unstable();
    assert_eq!(files, ASSEMBLY_FILES);
    assert!(number(&event["closed"], "covered") < 1.0);
    // The design alone is the same, unplaced.
    let told = run(&folder, ["design".as_ref(), job.as_os_str(), "-o".as_ref(), "roof.json".as_ref()]);
    assert_eq!((told.status, told.stderr.as_str()), (0, ""));
    let alone: Value = serde_json::from_slice(&std::fs::read(folder.join("roof.json")).unwrap()).unwrap();
    let made = design(&folder.join("roof"));
    assert_eq!([&alone["pieces"], &alone["hinges"]], [&made["pieces"], &made["hinges"]]);
}

#[test]
fn too_small_a_closed_target_is_refused_with_a_size_that_works() {
    let folder = peers::fresh_folder("case-too-small");
    for name in ["roof.obj", "roof-closed.obj"] {
        std::fs::copy(sample(name), folder.join(name)).unwrap();
    }
    let write = |size: f64| {
        let target = format!("open = \"roof.obj\"\nclosed = \"roof-closed.obj\"\nclosed_size_mm = {size}");
        let text = format!(
            "[target]\n{target}\n[pattern]\nkind = \"rotating-rectangles\"\npieces = [16, 13]\n[fabrication]\n{STEEL}\n"
        );
        std::fs::write(folder.join("job.toml"), text).unwrap();
    };
    write(120.0);
    let message = run(&folder, ["make", "job.toml", "-o", "out"]).stderr;
    refused(
        &folder,
        &["make", "job.toml", "-o", "out"],
        2,
        &["the closed sheet does not fit", "scale it up by about"],
    );
    let factor: f64 = message
        .split("scale it up by about ")
        .nth(1)
        .and_then(|rest| rest.split(' ').next())
        .and_then(|word| word.parse().ok())
        .unwrap_or_else(|| panic!("no factor in {message}"));
    assert!(factor > 1.5 && factor < 2.5, "{factor}");
    write(120.0 * factor);
    made(&folder, "job.toml", "out");
}

#[test]
fn the_opening_varies_over_the_steel_sample() {
    let out = made_sample("variable", &FILES);
    let design = check_report(&out, &["open"], false);
    assert_eq!(design["sheet_state"], "closed");
    let [low, high] = angles(&design);
    assert!(low > 35.0 && low < 50.0 && high > 85.0 && high < 95.0, "{low} {high}");
    check_burned(&out);
    check_open_target(&out, "variable.obj");
}

#[test]
fn the_users_map_decides_where_the_sheet_opens() {
    let out = made_sample("map", &FILES);
    let design = check_report(&out, &["open"], false);
    check_burned(&out);
    check_open_target(&out, "map.obj");
    // The map makes areas 1.38 x 1.24 times as large, and the vault adds to that; borders zigzag.
    let expansion = number(&design["report"], "area_expansion");
    assert!((expansion / 1.71 - 1.0).abs() < 0.05, "{expansion}");
    // Hinges turn by different amounts, as the map's stretches say.
    let [low, high] = angles(&design);
    assert!(high - low > 30.0, "{low} {high}");
}

/// The samples that other tests do not make already, with what tells them apart.
#[test]
fn every_sample_is_made_without_a_failing_hinge() {
    let mut names: Vec<String> = std::fs::read_dir(sample("."))
        .unwrap()
        .filter_map(|entry| Some(entry.unwrap().file_name().to_str()?.strip_suffix(".toml")?.to_owned()))
        .collect();
    names.sort();
    assert!(names.len() >= 11, "{names:?}");
    for name in names {
        let folder = peers::fresh_folder(&format!("every-{name}"));
        let out = made(&folder, sample(&format!("{name}.toml")).to_str().unwrap(), "out");
        let design = design(&out);
        let report = &design["report"];
        assert!(number(report, "max_length_error") < 1e-12 && number(report, "planarity") < 1e-12, "{name}");
        let edge = number(report, "mean_edge_mm");
        assert!(number(report, "distance_max_mm") < 0.1 * edge, "{name}");
        let [covered, boundary] = ["coverage_max_mm", "boundary_max_mm"].map(|key| number(report, key));
        assert!(covered.max(boundary) < 2.0 * SQRT_2 * edge, "{name}: {covered} {boundary}");
    }
}

#[test]
fn a_sheet_with_an_automatic_cut_burns_to_one_body() {
    let out = made_sample("three", &FILES);
    let design = design(&out);
    assert_eq!(design["pieces"].as_array().unwrap().len(), 192);
    // 3 x 7 x 8 sides between pieces within the patches and 3 x 8 between them, less the 8 of the cut.
    assert_eq!(design["hinges"].as_array().unwrap().len(), 3 * 2 * 7 * 8 + 3 * 8 - 8);
}
