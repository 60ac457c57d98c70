//! A sheet that opens without a target, guided or not, and the samples of unequal stretches and of rubber.

mod peers;
mod program;

use std::f64::consts::PI;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use program::{asked, command, finish, made};
use serde_json::Value;

/// A rectangle's mesh in millimetres, `cells` quads a side, with this height over it.
fn surface([width, depth]: [f64; 2], cells: usize, height: impl Fn(f64, f64) -> f64) -> String {
    let mut text = String::from("# made by tests/form_finding.rs\n");
    for j in 0..=cells {
        for i in 0..=cells {
            let at = |k: usize, side: f64| (k as f64 / cells as f64 - 0.5) * side;
            let (x, y) = (at(i, width), at(j, depth));
            vertex(&mut text, [x, y, height(x, y)]);
        }
    }
    for j in 0..cells {
        for i in 0..cells {
            let a = 1 + j * (cells + 1) + i;
            writeln!(text, "f {} {} {} {}", a, a + 1, a + cells + 2, a + cells + 1).unwrap();
        }
    }
    text
}

/// A polyline of 61 points.
fn polyline(point: impl Fn(f64) -> [f64; 3]) -> String {
    let mut text = String::from("# made by tests/form_finding.rs\n");
    (0..=60).for_each(|i| vertex(&mut text, point(f64::from(i) / 30.0 - 1.0)));
    let numbers: Vec<String> = (1..=61).map(|i: usize| i.to_string()).collect();
    writeln!(text, "l {}", numbers.join(" ")).unwrap();
    text
}

fn vertex(text: &mut String, p: [f64; 3]) {
    // Without minus zeros.
    let [x, y, z] = p.map(|value| (value * 1e6).round() / 1e6 + 0.0);
    writeln!(text, "v {x:.6} {y:.6} {z:.6}").unwrap();
}

fn saddle(x: f64, y: f64) -> f64 {
    (x * x - y * y) / 400.0
}

/// A circle's arc of 255 mm radius, 0.65 radians to either side.
fn arc(s: f64) -> [f64; 3] {
    let (sin, cos) = (0.65 * s).sin_cos();
    [255.0 * sin, 0.0, 255.0 - 255.0 * cos]
}

fn samples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("samples")
}

#[test]
fn the_samples_are_what_their_generators_make() {
    let canopy = |x: f64, y: f64| 36.0 * (1.0 - (x / 130.0).powi(2)) - 14.0 * (1.0 - (y / 100.0).powi(2));
    let mould = |x: f64, y: f64| 60.0 - 30.0 * ((x / 180.0).powi(2) + (y / 180.0).powi(2));
    for (name, text) in [
        ("formfinding.obj", surface([200.0; 2], 24, saddle)),
        ("formfinding-line.obj", polyline(|s| [100.0 * s, 0.0, saddle(100.0 * s, 0.0)])),
        ("formfinding-arch.obj", polyline(arc)),
        ("stretches.obj", surface([260.0, 200.0], 28, canopy)),
        ("rubber.obj", surface([360.0; 2], 28, mould)),
    ] {
        let file = samples().join(name);
        if std::env::var_os("UPDATE_SAMPLES").is_some() {
            fs::write(&file, &text).unwrap();
        }
        assert!(text.len() < 150_000, "{name}");
        assert!(fs::read_to_string(&file).unwrap() == text, "samples/{name}: run with UPDATE_SAMPLES=1");
    }
}

/// Designs a job and reads the result.
fn designed(folder: &Path, job: &Path) -> (PathBuf, Value) {
    let file = folder.join("design.json");
    let run = finish(command(folder).arg("design").arg(job).arg("-o").arg(&file));
    assert_eq!((run.status, run.stderr.as_str()), (0, ""), "{}", run.stdout);
    (file.clone(), serde_json::from_slice(&fs::read(file).unwrap()).unwrap())
}

/// The measures that hold of every sample; lengths in mean edges.
fn sound(design: &Value) {
    let report = &design["report"];
    let figure = |key: &str| report[key].as_f64().unwrap_or_else(|| panic!("{key}: {report}"));
    let edge = figure("mean_edge_mm");
    assert!(figure("max_length_error") < 1e-8 && figure("planarity") < 1e-8, "{report}");
    assert!(figure("distance_max_mm") < 0.1 * edge, "{}", figure("distance_max_mm"));
    assert!(figure("coverage_max_mm") < edge && figure("boundary_max_mm") < edge, "{report}");
    assert!((edge / figure("asked_edge_mm") - 1.0).abs() < 0.05, "{edge}");
}

fn angles(design: &Value) -> Vec<f64> {
    design["hinges"].as_array().unwrap().iter().map(|hinge| hinge["angle_deg"].as_f64().unwrap()).collect()
}

#[test]
fn a_saddle_opens_fully_and_its_line_comes_near_the_arch() {
    let folder = peers::fresh_folder("form-finding");
    let job = samples().join("formfinding.toml");
    let (file, design) = designed(&folder, &job);
    sound(&design);
    let all = angles(&design);
    assert!(all.iter().all(|angle| (55.0..=110.0).contains(angle)), "{all:?}");
    let mean = all.iter().sum::<f64>() / all.len() as f64;
    assert!((mean - 86.0).abs() < 2.0, "{mean}");
    let report = &design["report"];
    let guide = &report["guides"][0];
    assert_eq!(guide["kind"], "curve");
    let reached = guide["mean_distance_mm"].as_f64().unwrap();
    assert!(reached < 1.5, "{guide}");
    // By a program that knows the pieces' motions only.
    let (line, arch) = (samples().join("formfinding-line.obj"), samples().join("formfinding-arch.obj"));
    let program = peers::oracle("guide_check.py");
    if let Some(found) = asked(program, &[&file, &line, &arch]) {
        let figure = |key: &str| found[key].as_f64().unwrap();
        // Places are not the same, and may count to the neighbour of a piece.
        assert!((figure("mean_distance_mm") - reached).abs() < 0.2, "{found} {guide}");
        // The line runs between two rows of pieces: its ends may count to either, and these turn apart.
        let most = guide["distance_mm"].as_f64().unwrap() + 0.6 * report["mean_edge_mm"].as_f64().unwrap();
        assert!(figure("max_distance_mm") < most, "{found} {guide}");
        assert!(figure("box_difference_mm") < 1e-9, "{found}");
        assert!((figure("area_mm2") / report["open_state"]["area_mm2"].as_f64().unwrap() - 1.0).abs() < 1e-3);
        assert!(figure("least_fold_cosine") > 0.5, "{found}");
    }
    if let Some(found) = asked(peers::oracle("design_check.py"), &[&file]) {
        assert!(found["apart_mm"].as_f64().unwrap() < 1e-9, "{found}");
        assert!(found["motion_mm"].as_f64().unwrap() < 1e-9, "{found}");
    }
    // Without the guide the line is much farther away.
    let text = fs::read_to_string(&job).unwrap();
    let (head, tail) = (text.split("[[guide]]").next().unwrap(), text.split("[pattern]").nth(1).unwrap());
    fs::copy(samples().join("formfinding.obj"), folder.join("formfinding.obj")).unwrap();
    fs::write(folder.join("free.toml"), format!("{head}[pattern]{tail}")).unwrap();
    let (file, design) = designed(&folder, &folder.join("free.toml"));
    sound(&design);
    assert_eq!(design["report"]["guides"], serde_json::json!([]));
    if let Some(found) = asked(peers::oracle("guide_check.py"), &[&file, &line, &arch]) {
        assert!(found["mean_distance_mm"].as_f64().unwrap() > 2.0 * reached, "{found}");
    }
}

#[test]
fn a_place_is_held_where_it_is_without_a_cusp() {
    let folder = peers::fresh_folder("form-fixed");
    let bowl = |x: f64, y: f64| 30.0 - (x * x + y * y) / 400.0;
    fs::write(folder.join("bowl.obj"), surface([200.0; 2], 16, bowl)).unwrap();
    let job = |guide: &str| {
        format!(
            "{guide}\n[target]\nclosed = \"bowl.obj\"\nopen = \"free\"\n[pattern]\nkind = \"rotating-rectangles\"\n\
             pieces = [16, 16]\n[fabrication]\nprofile = \"steel-304-0.5mm\"\n"
        )
    };
    fs::write(folder.join("fixed.toml"), job("[[guide]]\nclosed = [0.0, 0.0, 30.0]\nfixed = true")).unwrap();
    let (_, design) = designed(&folder, &folder.join("fixed.toml"));
    sound(&design);
    let reached = design["report"]["guides"][0]["distance_mm"].as_f64().unwrap();
    assert!(reached < 0.1, "{reached}");
    assert!(angles(&design).iter().all(|angle| (80.0..=95.0).contains(angle)));
    fs::write(folder.join("empty.obj"), "v 0 0 0\n").unwrap();
    for (guide, says) in [
        ("closed = [0.0, 0.0, 80.0]\nopen = [0.0, 0.0, 0.0]", "guide 1: (0.00, 0.00, 80.00) mm is"),
        ("closed_curve = \"empty.obj\"\nfixed = true", "no polyline"),
        ("closed_curve = \"none.obj\"\nfixed = true", "guide.closed_curve"),
        ("closed = [0.0, 0.0]\nfixed = true", "2 numbers: allowed are three"),
        ("closed = [0.0, 0.0, 30.0]", "the guide does not say where to"),
        ("open = [0.0, 0.0, 30.0]", "the guide has neither closed nor closed_curve"),
        ("closed = [0.0, 0.0, 30.0]\nfixed = false", "not a guide"),
        ("closed = [0.0, 0.0, 30.0]\nfixed = true\nweight = 0.0", "out of range"),
    ] {
        fs::write(folder.join("bad.toml"), job(&format!("[[guide]]\n{guide}"))).unwrap();
        program::refused(&folder, &["design", "bad.toml"], 1, &[says]);
    }
    let flat = job("[[guide]]\nclosed = [0.0, 0.0, 30.0]\nfixed = true").replace("\"free\"", "\"flat\"");
    fs::write(folder.join("bad.toml"), flat).unwrap();
    program::refused(&folder, &["design", "bad.toml"], 1, &["guides go with open = \"free\" only"]);
}

/// Makes a sample: its design and its hinges.
fn sample(name: &str) -> (Value, Value) {
    let folder = peers::fresh_folder(name);
    let job = samples().join(format!("{name}.toml"));
    let out = made(&folder, job.to_str().unwrap(), "out");
    let read = |file: &str| serde_json::from_slice(&fs::read(out.join(file)).unwrap()).unwrap();
    let (design, hinges): (Value, Value) = (read("design.json"), read("hinges.json"));
    sound(&design);
    let rows = hinges["hinges"].as_array().unwrap();
    assert!(rows.len() > 200 && rows.iter().all(|row| row["verdict"] == "ok"), "{name}");
    if let Some(found) = asked(peers::oracle("design_check.py"), &[&out.join("design.json")]) {
        for figure in ["apart_mm", "point_mm", "motion_mm", "length_difference", "planarity_difference"] {
            assert!(found[figure].as_f64().unwrap() < 1e-9, "{name}: {found}");
        }
    }
    (design, hinges)
}

#[test]
fn pieces_of_unequal_stretches_are_longer_than_wide() {
    let (design, _) = sample("stretches");
    // Corners run counter-clockwise; the sides of a piece along x against those along y.
    let corners: Vec<[f64; 3]> = serde_json::from_value(design["corners"].clone()).unwrap();
    let mut sums = [0.0; 2];
    for piece in design["pieces"].as_array().unwrap() {
        let around: Vec<usize> = serde_json::from_value(piece["corners"].clone()).unwrap();
        for (i, &a) in around.iter().enumerate() {
            let (p, q) = (corners[a], corners[around[(i + 1) % around.len()]]);
            let along = [(q[0] - p[0]).abs(), (q[1] - p[1]).abs()];
            sums[usize::from(along[1] > along[0])] += along[0].hypot(along[1]);
        }
    }
    let ratio = sums[0] / sums[1];
    assert!((ratio.max(1.0 / ratio) - 1.3).abs() < 0.03, "{ratio}");
}

#[test]
fn rubber_opens_over_its_mould() {
    let (design, hinges) = sample("rubber");
    let strains = hinges["hinges"].as_array().unwrap().iter().map(|row| row["strain"].as_f64().unwrap());
    assert!(strains.fold(0.0, f64::max) < 1.0);
    // The mould's area, by its integral: |grad| = 60 r / 180^2.
    let n = 400;
    let at = |i: usize| (i as f64 + 0.5) / n as f64 * 360.0 - 180.0;
    let cell = (360.0 / n as f64).powi(2);
    let slope = |x: f64, y: f64| (60.0 / 180.0_f64.powi(2)).powi(2) * (x * x + y * y);
    let area: f64 = (0..n * n).map(|k| (1.0 + slope(at(k % n), at(k / n))).sqrt() * cell).sum();
    assert!(area > 360.0 * 360.0 && area < 360.0 * 360.0 * PI / 3.0);
    let report = &design["report"];
    let edge = report["mean_edge_mm"].as_f64().unwrap();
    let open = design["pieces"].as_array().unwrap().len() as f64
        * edge.powi(2)
        * report["area_expansion"].as_f64().unwrap();
    assert!((open / area - 1.0).abs() < 0.1, "{open} {area}");
}
