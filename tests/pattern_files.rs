//! Patterns whose pieces come from a mesh file, with cuts, or are aligned with the map between the two states.

mod peers;
mod program;

use std::fs;
use std::path::{Path, PathBuf};

use program::{Mesh, STEEL, job, number, refused, run};
use serde_json::Value;

/// A fresh folder with these files.
fn folder(name: &str, files: &[(&str, &str)]) -> PathBuf {
    let folder = peers::fresh_folder(&format!("pattern-{name}"));
    for (file, text) in files {
        fs::write(folder.join(file), text).unwrap();
    }
    folder
}

/// Designs job.toml; returns the design file.
fn designed(folder: &Path) -> Value {
    let run = run(folder, ["design", "job.toml", "-o", "design.json"]);
    assert_eq!((run.status, run.stderr.as_str()), (0, ""), "{run:?}");
    serde_json::from_slice(&fs::read(folder.join("design.json")).unwrap()).unwrap()
}

/// What every design must keep, `distance` in mean edges.
fn check(design: &Value, distance: f64, gap: f64) {
    let report = &design["report"];
    let figure = |key| number(report, key);
    let edge = figure("mean_edge_mm");
    assert!(figure("max_length_error") < 1e-12 && figure("planarity") < 1e-12);
    assert!(figure("distance_max_mm") < distance * edge, "{} of {edge}", figure("distance_max_mm"));
    let [covered, boundary] = ["coverage_max_mm", "boundary_max_mm"].map(figure);
    assert!(covered.max(boundary) < gap * edge, "{covered} {boundary} of {edge}");
    // Triangles along the border are not the halves of cells that they began as.
    assert!((edge / figure("asked_edge_mm") - 1.0).abs() < 0.08, "{edge} of {}", figure("asked_edge_mm"));
    let expansion = figure("area_expansion");
    assert!((1.5..2.05).contains(&expansion), "{expansion}");
}

fn bump() -> Mesh {
    Mesh::bump([200.0, 160.0], 25.0, [14, 11])
}

#[test]
fn the_quads_of_a_target_become_its_pieces() {
    let text = job("open = \"bump.obj\"", "piece_mesh = \"bump.obj\"", STEEL);
    let folder = folder("pieces", &[("bump.obj", &bump().obj()), ("job.toml", &text)]);
    let design = designed(&folder);
    check(&design, 0.02, 1.0);
    let pieces = design["pieces"].as_array().unwrap();
    assert_eq!((pieces.len(), design["hinges"].as_array().unwrap().len()), (154, 2 * 154 - 14 - 11));
    // A piece lies where its quad is: the middles of the open pieces are near those of the faces, in their order.
    let mesh = bump();
    for (piece, face) in pieces.iter().zip(&mesh.faces) {
        let middle = |axis: usize| {
            let vertices = piece["open"].as_array().unwrap().iter();
            vertices.map(|p| p[axis].as_f64().unwrap()).sum::<f64>() / 4.0
        };
        let quad = |axis: usize| face.iter().map(|&v| mesh.vertices[v][axis]).sum::<f64>() / 4.0;
        let off: f64 = (0..3).map(|axis| (middle(axis) - quad(axis)).powi(2)).sum();
        assert!(off.sqrt() < 3.0, "{off}");
    }
}

#[test]
fn a_control_mesh_has_a_hinge_for_every_inner_face() {
    // Black vertices, the pieces' centres, are every second one; the border cuts pieces in half.
    let text = job("open = \"bump.obj\"", "control_mesh = \"bump.obj\"", STEEL);
    let folder = folder("control", &[("bump.obj", &bump().obj()), ("job.toml", &text)]);
    let design = designed(&folder);
    check(&design, 0.05, 2.0);
    let corners = |piece: &Value| piece["open"].as_array().unwrap().len();
    let count = |n: usize| design["pieces"].as_array().unwrap().iter().filter(|p| corners(p) == n).count();
    // 13 x 10 inner vertices, half of them black; along the border the black ones that are no corner are triangles.
    assert_eq!(count(4), 65);
    assert_eq!(count(3) + count(4), design["pieces"].as_array().unwrap().len());
    let hinges = design["hinges"].as_array().unwrap().len();
    let dropped = 14 * 11 - hinges;
    assert!(dropped <= 2, "only at black corners of the mesh is a face without a hinge: {dropped}");
}

#[test]
fn a_mesh_that_others_made_goes_through_both_readings() {
    let Some(file) = peers::shared("meshes/6-sub-lifted.obj") else { return };
    let mesh = fs::read_to_string(file).unwrap();
    for (name, key, cuts, pieces) in [
        ("six-control", "control_mesh", "", 105),
        ("six-pieces", "piece_mesh", "\ncuts = \"automatic\"", 188),
    ] {
        let target = format!("open = \"six.obj\"\nsize_mm = 300.0{cuts}");
        let text = job(&target, &format!("{key} = \"six.obj\""), STEEL);
        let folder = folder(name, &[("six.obj", &mesh), ("job.toml", &text)]);
        let design = designed(&folder);
        check(&design, 0.1, 2.0);
        assert_eq!(design["pieces"].as_array().unwrap().len(), pieces);
    }
}

/// Five patches around one corner.
fn five() -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("samples/five.obj")).unwrap()
}

#[test]
fn odd_corners_are_named_with_the_cut_that_mends_them() {
    let text = job("open = \"five.obj\"", "piece_mesh = \"five.obj\"", STEEL);
    let folder = folder("odd", &[("five.obj", &five()), ("job.toml", &text)]);
    let says = [
        "five.obj: neighbouring pieces cannot all turn in opposite senses: 5 pieces meet at vertex 1, ",
        "An even number is needed. Cut the sheet along vertices 1-",
        "cuts = \"automatic\"",
    ];
    refused(&folder, &["design", "job.toml"], 2, &says);
    refused(&folder, &["make", "job.toml"], 2, &says);
}

#[test]
fn meshes_and_cuts_that_are_no_pattern_are_bad_input() {
    let mesh = bump();
    let obj = mesh.obj();
    let mut twice = mesh.clone();
    twice.faces[7][2] = twice.faces[7][0];
    let mut apart = mesh.clone();
    let second = mesh.vertices.iter().map(|[x, y, z]| [x + 500.0, *y, *z]);
    apart.vertices.extend(second);
    let shifted = mesh.faces.iter().map(|face| face.iter().map(|v| v + mesh.vertices.len()).collect());
    apart.faces.extend(shifted.collect::<Vec<Vec<usize>>>());
    let [left, right] = [5 * 15, 5 * 15 + 14].map(|v| mesh.vertices[v]);
    let line = |points: &[[f64; 3]]| -> String {
        let vertices: String = points.iter().map(|[x, y, z]| format!("v {x:?} {y:?} {z:?}\n")).collect();
        let numbers: Vec<String> = (1..=points.len()).map(|i| i.to_string()).collect();
        format!("{vertices}l {}\n", numbers.join(" "))
    };
    let across: Vec<[f64; 3]> = (0..15).map(|i| mesh.vertices[5 * 15 + i]).collect();
    let off = [left, [right[0], right[1] + 30.0, right[2]]];
    let own =
        format!("{obj}l {}\n", (0..15).map(|i| (5 * 15 + i + 1).to_string()).collect::<Vec<_>>().join(" "));
    for (name, pieces, cuts, says) in [
        ("twice", twice.obj(), "", vec!["pieces.obj: line 188: the face names vertex", "twice"]),
        ("apart", apart.obj(), "", vec!["pieces.obj", "2 components, with 154 and 154 faces"]),
        ("parts", obj.clone(), line(&across).as_str(), vec!["cuts.obj", "84", "70"]),
        ("own", own, "", vec!["pieces.obj", "84", "70"]),
        (
            "off",
            obj.clone(),
            line(&off).as_str(),
            vec!["cuts.obj", "line 3", "not a vertex of the mesh", "mm away"],
        ),
        ("no-edge", obj.clone(), line(&[across[1], across[3]]).as_str(), vec!["cuts.obj", "line 3"]),
    ] {
        let cut = if cuts.is_empty() { "" } else { "\ncuts = \"cuts.obj\"" };
        let text = job(&format!("open = \"bump.obj\"{cut}"), "piece_mesh = \"pieces.obj\"", STEEL);
        let files =
            [("bump.obj", obj.as_str()), ("pieces.obj", &pieces), ("cuts.obj", cuts), ("job.toml", &text)];
        let folder = folder(&format!("bad-{name}"), &files);
        refused(&folder, &["make", "job.toml"], 1, &says);
    }
}

#[test]
fn unequal_stretches_need_directions_that_agree() {
    let Some(file) = peers::shared("meshes/6-sub-lifted.obj") else { return };
    let pattern = "control_mesh = \"six.obj\"\nstretches = [1.3, 1.5504]";
    let text = job("open = \"six.obj\"\nsize_mm = 300.0", pattern, STEEL);
    let folder = folder("unequal", &[("six.obj", &fs::read_to_string(file).unwrap()), ("job.toml", &text)]);
    refused(
        &folder,
        &["design", "job.toml"],
        1,
        &["six.obj", "irregular vertices", "leave [pattern] stretches out"],
    );
}

#[test]
fn an_aligned_grid_is_a_pattern_too() {
    let text = job("open = \"bump.obj\"", "pieces = [16, 13]\nalignment = \"principal\"", STEEL);
    let folder = folder("aligned", &[("bump.obj", &bump().obj()), ("job.toml", &text)]);
    let design = designed(&folder);
    check(&design, 0.1, 2.0);
    let pieces = design["pieces"].as_array().unwrap().len();
    assert!((150..280).contains(&pieces), "{pieces}");
}

#[test]
fn an_aligned_grid_follows_the_stretch_of_a_map() {
    // The closed sheet is the plane; the map stretches by 1.35 along a direction turned by 25 degrees and by 1.2 across.
    let closed = Mesh::bump([200.0, 160.0], 0.0, [12, 10]);
    let (s, c) = 25_f64.to_radians().sin_cos();
    let stretched = |[x, y, _]: &[f64; 3]| {
        let (u, v) = (1.35 * (c * x + s * y), 1.2 * (-s * x + c * y));
        [c * u - s * v, s * u + c * v, 0.0]
    };
    let open = Mesh { vertices: closed.vertices.iter().map(stretched).collect(), ..closed.clone() };
    let pattern = "piece_mm = 9.0\ngap_mm = 0.0\nopening = \"variable\"\nalignment = \"principal\"\nboundary = \"trimmed\"";
    let text = job("open = \"open.obj\"", pattern, STEEL).replace("\"flat\"", "\"closed.obj\"");
    let files = [("closed.obj", closed.obj()), ("open.obj", open.obj()), ("job.toml", text)];
    let folder = folder("map", &files.each_ref().map(|(name, text)| (*name, text.as_str())));
    let design = designed(&folder);
    let report = &design["report"];
    assert!(number(report, "max_length_error") < 1e-12);
    // Corners that reach beyond the outline are off the mesh in its own plane.
    assert!(number(report, "distance_max_mm") < 0.1, "{}", number(report, "distance_max_mm"));
    // Section 2.2: cos t and r from the two stretches; every hinge turns by 2 t.
    let (m1, m2) = (1.35_f64, 1.2_f64);
    let turn = (((m1 + m2) + ((m1 - m2).powi(2) - 4.0 * m1 * m2 + 8.0).sqrt()) / 4.0).acos();
    let mut angles: Vec<f64> =
        design["hinges"].as_array().unwrap().iter().map(|hinge| number(hinge, "angle_deg")).collect();
    // Cells that reach beyond the outline are drawn in, which turns all hinges a little further: with squares instead of
    // the rectangles that the stretches ask for it would be 6.5 degrees.
    angles.sort_by(f64::total_cmp);
    let median = angles[angles.len() / 2];
    assert!(
        (median - 2.0 * turn.to_degrees()).abs() < 3.5,
        "{median} instead of {}",
        2.0 * turn.to_degrees()
    );
    // Closed sides run along and across the stretched direction.
    let side = |piece: &Value| {
        let at = |i: usize, axis: usize| piece["closed"][i][axis].as_f64().unwrap();
        (at(1, 1) - at(0, 1)).atan2(at(1, 0) - at(0, 0)).to_degrees()
    };
    let off = |angle: f64| {
        let quarter = (angle - 25.0).rem_euclid(90.0);
        quarter.min(90.0 - quarter)
    };
    let pieces = design["pieces"].as_array().unwrap();
    let mean = pieces.iter().map(|piece| off(side(piece))).sum::<f64>() / pieces.len() as f64;
    assert!(mean < 3.0, "{mean} degrees");
}
