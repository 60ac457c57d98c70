//! The main job on real targets, from the job file to checked files, as a user runs it.

mod peers;
mod program;

use std::f64::consts::SQRT_2;
use std::path::Path;

use program::{
    FILES, Listing, Mesh, STEEL, asked, coordinates, design, job, largest_difference, made, number,
    sample_dome,
};
use serde_json::{Value, json};

/// What a job must reach.
struct Limits {
    /// Distance from the target, of the target's diagonal.
    distance: f64,
    /// The mean edge that is asked for, millimetres; `None` to trust the file's.
    edge: Option<f64>,
}

impl Default for Limits {
    fn default() -> Self {
        Self { distance: 1e-3, edge: None }
    }
}

/// Checks a folder of results with what the files say, and again with independent programs. `scale` is the option of
/// `made_folder.py` that gives the target's size.
fn check(folder: &Path, target: &Path, scale: [&str; 2], version: &str, limits: &Limits) {
    let mut names: Vec<_> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, FILES);
    check_report(folder, limits);
    check_recomputed(folder);
    let design_file = folder.join("design.json");
    let hinge_file = folder.join("hinges.json");
    let dxf = folder.join("cut.dxf");
    let sheet: [&str; 3] = ["--sheet", "1000", "1000"];
    let burned =
        asked(peers::oracle("burn.py"), &[&dxf, &hinge_file, &design_file, &sheet[0], &sheet[1], &sheet[2]]);
    if let Some(burned) = burned {
        // The program exits with 1, which `asked` refuses, where any of its checks fails.
        assert_eq!(
            (&burned["ok"], &burned["version"], &burned["bodies"]),
            (&json!(true), &json!(version), &json!(1))
        );
        let design = design(folder);
        assert_eq!(burned["hinges"], design["hinges"].as_array().unwrap().len());
        assert_eq!(burned["cuts"]["RELIEF"], burned["hinges"]);
        assert!(number(&burned, "worst_width_error_mm") <= 0.02);
    }
    if let Some(found) = asked(peers::oracle("made_folder.py"), &[&folder, &target, &scale[0], &scale[1]]) {
        check_against_target(&found, folder, limits);
    }
}

/// What `design.json` says about itself.
fn check_report(folder: &Path, limits: &Limits) {
    let design = design(folder);
    let report = &design["report"];
    let [edge, asked_edge] = ["mean_edge_mm", "asked_edge_mm"].map(|key| number(report, key));
    assert!(number(report, "max_length_error") <= 1e-8);
    assert!(number(report, "planarity") <= 1e-4);
    assert!(number(report, "distance_max_mm") <= limits.distance * number(report, "target_diagonal_mm"));
    // One and a half pieces, by the side of an open cell.
    assert!(number(report, "boundary_max_mm") <= 1.5 * SQRT_2 * edge);
    assert!((edge / asked_edge - 1.0).abs() <= 0.1, "{edge} {asked_edge}");
    if let Some(wanted) = limits.edge {
        assert!((edge / wanted - 1.0).abs() <= 0.1, "{edge} {wanted}");
    }
    let counts = ["pieces", "hinges"].map(|key| design[key].as_array().unwrap().len());
    assert_eq!([&report["pieces"], &report["hinges"]], [&json!(counts[0]), &json!(counts[1])]);
}

/// The same from the coordinates, by numpy.
fn check_recomputed(folder: &Path) {
    let Some(found) = asked(peers::oracle("design_check.py"), &[&folder.join("design.json")]) else { return };
    assert!(number(&found, "max_length_error") <= 1e-8);
    assert!(number(&found, "planarity") <= 1e-4);
    // The file's figures are these, up to the rounding of sums.
    for key in ["e_isom_difference", "length_difference", "planarity_difference", "mean_edge_difference"] {
        assert!(number(&found, key) <= 1e-12, "{key}: {}", found[key]);
    }
    // Hinges hold together, and turn piece on piece as they say: rounding at some hundred millimetres.
    for key in ["apart_mm", "point_mm", "motion_mm", "rotation_difference"] {
        assert!(number(&found, key) <= 1e-9, "{key}: {}", found[key]);
    }
}

/// What `made_folder.py` found by brute force.
fn check_against_target(found: &Value, folder: &Path, limits: &Limits) {
    let design = design(folder);
    let report = &design["report"];
    let diagonal = number(found, "diagonal_mm");
    assert!(number(found, "distance_mm") <= limits.distance * diagonal);
    assert!(number(found, "boundary_mm") <= 1.5 * SQRT_2 * number(report, "mean_edge_mm"));
    // Two ways to the same numbers. Quads that are flat to 1e-7 of their size (some ten millimetres) have a diagonal in
    // our surface and a centre in theirs.
    for (theirs, ours) in [("distance_mm", "distance_max_mm"), ("diagonal_mm", "target_diagonal_mm")] {
        let (theirs, ours) = (number(found, theirs), number(report, ours));
        assert!((theirs - ours).abs() <= 5e-6, "{theirs} {ours}");
    }
    // Pieces lie along the target, the sheet's upper face outside.
    assert!(number(found, "normal") > 0.99, "{}", found["normal"]);
    let hinges = design["hinges"].as_array().unwrap().len();
    assert_eq!([&found["csv_rows"], &found["hinges"]], [hinges; 2]);
    assert_eq!(found["verdicts"].get("fail"), None);
    let svg = "{http://www.w3.org/2000/svg}svg";
    assert_eq!(found["xml"], json!([svg, svg]));
}

/// A job of 30 x 30 pieces and 300 mm on a mesh of the shared data.
fn shared_target(mesh: &str, dxf: &str, version: &str) {
    let Some(target) = peers::shared(&format!("meshes/{mesh}.obj")) else { return };
    let folder = peers::fresh_folder(&format!("main-job-{mesh}-{dxf}"));
    std::fs::copy(&target, folder.join("target.obj")).unwrap();
    let text = job(
        "open = \"target.obj\"\nunits = \"mm\"\nsize_mm = 300.0",
        "pieces = [30, 30]",
        &format!("{STEEL}\ndxf = \"{dxf}\""),
    );
    std::fs::write(folder.join("job.toml"), text).unwrap();
    let out = made(&folder, "job.toml", "results");
    check(&out, &target, ["--size", "300"], version, &Limits::default());
    let mut names: Vec<_> = std::fs::read_dir(&folder).unwrap().map(|e| e.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["job.toml", "results", "target.obj"], "nothing else is left");
}

#[test]
fn makes_a_stretched_grid_of_quads() {
    shared_target("M2_eq_quad2", "r2000", "R2000");
}

#[test]
fn makes_a_subdivided_surface_with_six_sides() {
    shared_target("6-sub-lifted", "r2000", "R2000");
}

#[test]
fn makes_a_pillow() {
    shared_target("pillow_1", "r2000", "R2000");
}

#[test]
fn makes_a_paraboloid() {
    shared_target("choi_paraboloid", "r2000", "R2000");
}

#[test]
fn makes_lines_and_arcs_for_old_laser_software() {
    shared_target("6-sub-lifted", "r12", "R12");
}

#[test]
fn makes_the_sample_into_the_default_folder() {
    let folder = peers::fresh_folder("main-job-sample");
    let samples = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples");
    let run = program::run(&folder, ["make".as_ref(), samples.join("dome.toml").as_os_str()]);
    assert_eq!((run.status, run.stderr.as_str()), (0, ""));
    assert!(run.stdout.starts_with("dome: made\n"), "{}", run.stdout);
    assert!(run.stdout.contains("Files in out/dome:"), "{}", run.stdout);
    let out = folder.join("out/dome");
    check(&out, &samples.join("dome.obj"), ["--scale", "1"], "R2000", &Limits { distance: 2e-4, edge: None });
    assert_eq!(program::listing(&folder).len(), 2 + FILES.len(), "out, out/dome and the files");
    // Again in the same place, quietly: the old files give way to the same ones.
    let before = program::listing(&folder);
    let run = program::run(&folder, ["make".as_ref(), samples.join("dome.toml").as_os_str(), "-q".as_ref()]);
    assert_eq!((run.status, run.stdout.as_str(), run.stderr.as_str()), (0, "", ""));
    assert_eq!(untimed(before), untimed(program::listing(&folder)));
}

/// A listing without the one file that differs between runs.
fn untimed(mut listing: Listing) -> Listing {
    listing.retain(|path, _| !path.ends_with("timings.json"));
    listing
}

#[test]
fn makes_a_rubber_dome_of_large_pieces() {
    let folder = peers::fresh_folder("main-job-rubber");
    std::fs::write(folder.join("dome.obj"), sample_dome()).unwrap();
    let target = "open = \"dome.obj\"\nsize_mm = 500.0";
    let text = job(target, "pieces = [12, 12]", "profile = \"nitrile-rubber-2mm\"");
    std::fs::write(folder.join("rubber.toml"), text).unwrap();
    let out = made(&folder, "rubber.toml", "out");
    // 12 open cells along the flattened side, which is longer than 500 mm and less than 600; closed sides are 1 / sqrt 2
    // of that and half a gap.
    let edge = 550.0 / 12.0 / SQRT_2 + 0.5 * 1.75;
    check(
        &out,
        &folder.join("dome.obj"),
        ["--size", "500"],
        "R2000",
        &Limits { distance: 1e-3, edge: Some(edge) },
    );
}

/// Makes a mesh with pieces of 9 mm and returns its design.
fn bump_design(folder: &Path, name: &str, mesh: &Mesh, units: &str) -> Value {
    std::fs::write(folder.join(format!("{name}.obj")), mesh.obj()).unwrap();
    let target = format!("open = \"{name}.obj\"\nunits = \"{units}\"");
    std::fs::write(folder.join(format!("{name}.toml")), job(&target, "piece_mm = 9.0", STEEL)).unwrap();
    design(&made(folder, &format!("{name}.toml"), name))
}

fn bump() -> Mesh {
    Mesh::bump([220.0, 160.0], 40.0, [24, 18])
}

fn same_figures(a: &Value, b: &Value) {
    for key in ["pieces", "hinges"] {
        assert_eq!(a["report"][key], b["report"][key], "{key}");
    }
    for key in ["mean_edge_mm", "asked_edge_mm", "stretch_ratio", "area_expansion", "target_diagonal_mm"] {
        let [a, b] = [a, b].map(|design| number(&design["report"], key));
        assert!((a / b - 1.0).abs() <= 1e-3, "{key}: {a} {b}");
    }
}

#[test]
fn the_unit_of_the_file_does_not_matter() {
    let folder = peers::fresh_folder("main-job-units");
    let millimetres = bump_design(&folder, "millimetres", &bump(), "mm");
    for (units, size) in [("m", 1000.0), ("cm", 10.0), ("in", 25.4)] {
        let scaled = bump().moved(|v| v.map(|c| c / size));
        let other = bump_design(&folder, units, &scaled, units);
        // A division and a product are off by 1e-14 mm at the start; the stages end where their steps are far smaller.
        let difference = largest_difference(&coordinates(&millimetres), &coordinates(&other));
        assert!(difference <= 1e-6, "{units}: {difference:e} mm");
    }
}

#[test]
fn numbering_place_and_turn_of_the_target_do_not_matter() {
    let folder = peers::fresh_folder("main-job-place");
    let plain = bump_design(&folder, "plain", &bump(), "mm");
    let renumbered = bump_design(&folder, "renumbered", &bump().renumbered(), "mm");
    same_figures(&plain, &renumbered);
    let moved =
        bump_design(&folder, "moved", &bump().moved(|[x, y, z]| [x + 731.0, y - 87.5, z + 12.0]), "mm");
    same_figures(&plain, &moved);
    let turned = bump_design(&folder, "turned", &bump().moved(|[x, y, z]| [40.0 - y, x + 7.0, z]), "mm");
    same_figures(&plain, &turned);
}

#[test]
fn a_bowl_is_the_mirrored_dome() {
    let folder = peers::fresh_folder("main-job-bowl");
    let dome = bump_design(&folder, "dome", &bump(), "mm");
    let bowl = bump_design(&folder, "bowl", &bump().moved(|[x, y, z]| [x, y, -z]), "mm");
    let all = |design: &Value, state: &str, sign: f64| -> Vec<f64> {
        let pieces = design["pieces"].as_array().unwrap().iter();
        let points = pieces.flat_map(|piece| piece[state].as_array().unwrap());
        points
            .flat_map(|p| [0, 1, 2].map(|k| p[k].as_f64().unwrap()).into_iter())
            .enumerate()
            .map(|(i, c)| if i % 3 == 2 { sign * c } else { c })
            .collect()
    };
    for (state, sign) in [("closed", 1.0), ("open", -1.0)] {
        let difference = largest_difference(&all(&dome, state, 1.0), &all(&bowl, state, sign));
        // Every step mirrors; what is left is rounding.
        assert!(difference <= 1e-6, "{state}: {difference:e} mm");
    }
}

#[test]
fn the_upper_face_goes_where_the_normals_point() {
    let folder = peers::fresh_folder("main-job-inside-out");
    let plain = bump_design(&folder, "plain", &bump(), "mm");
    let inside_out = bump_design(&folder, "inside-out", &bump().inside_out(), "mm");
    let open_side = |design: &Value| {
        let pieces = design["pieces"].as_array().unwrap().iter();
        let ways: Vec<[f64; 2]> =
            pieces.map(|p| ["closed", "open"].map(|state| normal_z(&p[state]))).collect();
        assert!(ways.iter().all(|[closed, _]| *closed > 0.0), "the sheet is cut face up");
        assert!(ways.iter().all(|[_, open]| open * ways[0][1] > 0.0), "all pieces show the same face");
        ways[0][1].signum()
    };
    assert_eq!([open_side(&plain), open_side(&inside_out)], [1.0, -1.0]);
    same_figures(&plain, &inside_out);
    // Turned over about the x axis it is a bowl with its normals up: another place of the same target.
    let turned = bump_design(&folder, "turned", &bump().inside_out().moved(|[x, y, z]| [x, -y, -z]), "mm");
    assert_eq!(open_side(&turned), 1.0);
    same_figures(&inside_out, &turned);
}

/// The z component of a quad's area vector.
fn normal_z(points: &Value) -> f64 {
    let at = |i: usize, k: usize| points[i][k].as_f64().unwrap();
    let [[ax, ay], [bx, by]] = [[0, 2], [1, 3]].map(|[i, j]| [at(j, 0) - at(i, 0), at(j, 1) - at(i, 1)]);
    0.5 * (ax * by - ay * bx)
}
