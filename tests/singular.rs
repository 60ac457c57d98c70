//! Patterns with singular corners and cuts (Fig. 12), from the job file to burned paper: the samples, and meshes that
//! others made.

mod peers;
mod program;

use std::f64::consts::SQRT_2;
use std::path::{Path, PathBuf};

use program::{FILES, STEEL, asked, design, job, number, run};
use serde_json::{Value, json};

fn sample(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("samples").join(name)
}

/// Makes a job; the folder of its results.
fn made(test: &str, job: &Path) -> PathBuf {
    let folder = peers::fresh_folder(test);
    let out = run(&folder, ["make".as_ref(), job.as_os_str(), "-o".as_ref(), "out".as_ref()]);
    assert_eq!((out.status, out.stderr.as_str()), (0, ""), "{}", out.stdout);
    folder.join("out")
}

/// The measures of the main job, and independent programs' word on the cuts. Returns the cuts by layer.
fn check(out: &Path, distance: f64) -> Option<Value> {
    let mut names: Vec<_> = std::fs::read_dir(out).unwrap().map(|e| e.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, FILES);
    let found = design(out);
    let report = &found["report"];
    assert!(number(report, "max_length_error") <= 1e-8);
    assert!(number(report, "planarity") <= 1e-4);
    assert!(number(report, "distance_max_mm") <= distance * number(report, "target_diagonal_mm"));
    let [edge, asked_edge] = ["mean_edge_mm", "asked_edge_mm"].map(|key| number(report, key));
    assert!(number(report, "boundary_max_mm") <= 1.5 * SQRT_2 * edge);
    assert!((edge / asked_edge - 1.0).abs() <= 0.1, "{edge} {asked_edge}");
    if let Some(again) = asked(peers::oracle("design_check.py"), &[&out.join("design.json")]) {
        assert!(number(&again, "max_length_error") <= 1e-8);
        assert!(number(&again, "planarity") <= 1e-4);
    }
    let [dxf, hinges, file] = ["cut.dxf", "hinges.json", "design.json"].map(|name| out.join(name));
    let burned = asked(peers::oracle("burn.py"), &[&dxf, &hinges, &file, &"--sheet", &"1000", &"1000"])?;
    assert_eq!((&burned["ok"], &burned["bodies"]), (&json!(true), &json!(1)));
    assert!(number(&burned, "worst_width_error_mm") <= 0.02);
    Some(burned["cuts"].clone())
}

/// All hinges of a report; none may fail.
fn hinges(out: &Path) -> Vec<Value> {
    let text = std::fs::read_to_string(out.join("hinges.json")).unwrap();
    let report: Value = serde_json::from_str(&text).unwrap();
    let hinges = report["hinges"].as_array().unwrap().clone();
    assert!(hinges.iter().all(|hinge| hinge["verdict"] != "fail"));
    hinges
}

/// The largest of a figure over all hinges.
fn largest(hinges: &[Value], key: &str) -> f64 {
    hinges.iter().map(|hinge| number(hinge, key)).fold(0.0, f64::max)
}

#[test]
fn three_slits_meet_in_the_middle_of_the_star() {
    let out = made("singular-star", &sample("star.toml"));
    let cuts = check(&out, 1e-3);
    let hinges = hinges(&out);
    // The three hinges of the middle stand on their ligaments' centres as all others do.
    assert!(largest(&hinges, "centre_offset_mm") < 0.02, "{}", largest(&hinges, "centre_offset_mm"));
    assert!(hinges.iter().all(|hinge| (number(hinge, "width_mm") - 0.5).abs() < 0.01));
    if let Some(cuts) = cuts {
        assert_eq!((&cuts["WINDOW"], &cuts["BORDER"]), (&json!(1), &json!(1)));
        assert_eq!(cuts["RELIEF"], json!(hinges.len()));
    }
    // They stand 120 degrees apart on a circle about the corner: g/2 and the radius of the triangle, whose sides reach
    // three halves of g to either side of their middles.
    let found = design(&out);
    let gap = number(&found, "gap_mm");
    let pieces = found["pieces"].as_array().unwrap();
    let mut uses = vec![0; found["corners"].as_array().unwrap().len()];
    let corners_of = |piece: &Value| -> Vec<usize> {
        piece["corners"].as_array().unwrap().iter().map(|c| c.as_u64().unwrap() as usize).collect()
    };
    pieces.iter().flat_map(&corners_of).for_each(|corner| uses[corner] += 1);
    let middle = uses.iter().position(|&count| count == 6).unwrap();
    let radius = gap * (0.5 + 1.5 / 3.0_f64.sqrt());
    for piece in pieces.iter().filter(|piece| corners_of(piece).contains(&middle)) {
        let vertex = corners_of(piece).iter().position(|&c| c == middle).unwrap();
        let away = |k: usize| {
            piece["closed"][vertex][k].as_f64().unwrap() - found["corners"][middle][k].as_f64().unwrap()
        };
        assert!((away(0).hypot(away(1)) - radius).abs() < 1e-3, "{} {radius}", away(0).hypot(away(1)));
    }
}

#[test]
fn a_cut_whose_sides_overlap_is_refused_with_its_place() {
    // Laid flat, the five patches take more than a full turn around the end of their cut.
    let samples = [sample("five.obj"), sample("five-cuts.obj")].map(|file| file.display().to_string());
    for cuts in [samples[1].as_str(), "automatic"] {
        let folder = peers::fresh_folder("singular-five");
        let target = format!("open = \"{}\"\nsize_mm = 300.0\ncuts = \"{cuts}\"", samples[0]);
        let pattern = format!("piece_mesh = \"{}\"", samples[0]);
        std::fs::write(folder.join("job.toml"), job(&target, &pattern, STEEL)).unwrap();
        let says = ["corner 0 at (", "more than a full turn", "overlap"];
        program::refused(&folder, &["make", "job.toml", "-o", "out"], 2, &says);
    }
}

/// Makes a job on meshes of the shared data, or says why not: the job's folder and what was printed.
fn shared_job(test: &str, mesh: &str, target: &str, pattern: &str) -> Option<(PathBuf, program::Run)> {
    let source = peers::shared(&format!("meshes/{mesh}.obj"))?;
    let folder = peers::fresh_folder(test);
    std::fs::copy(source, folder.join("mesh.obj")).unwrap();
    let text = job(&format!("open = \"mesh.obj\"\n{target}"), pattern, STEEL);
    std::fs::write(folder.join("job.toml"), text).unwrap();
    let out = run(&folder, ["make", "job.toml", "-o", "out"]);
    Some((folder.join("out"), out))
}

#[test]
fn a_control_mesh_of_others_is_made() {
    let pattern = "control_mesh = \"mesh.obj\"";
    let Some((out, run)) = shared_job("singular-six", "6-sub-lifted", "size_mm = 200.0", pattern) else {
        return;
    };
    assert_eq!((run.status, run.stderr.as_str()), (0, ""));
    check(&out, 1e-2);
    hinges(&out);
}

#[test]
fn an_aligned_grid_is_made() {
    let pattern = "pieces = [20, 20]\nalignment = \"principal\"";
    let Some((out, run)) = shared_job("singular-aligned", "choi_paraboloid", "size_mm = 200.0", pattern)
    else {
        return;
    };
    assert_eq!((run.status, run.stderr.as_str()), (0, ""));
    check(&out, 1e-2);
    hinges(&out);
}

#[test]
fn pieces_that_turn_into_each_other_are_refused_with_their_place() {
    let target = "size_mm = 200.0\ncuts = \"automatic\"";
    let pattern = "piece_mesh = \"mesh.obj\"";
    let Some((out, run)) = shared_job("singular-sixp", "6-sub-lifted", target, pattern) else { return };
    assert_eq!(run.status, 2);
    assert!(run.stderr.contains("corner") && run.stderr.contains(") mm"), "{}", run.stderr);
    assert!(!out.exists());
}
