//! `kirimorph snap` as a user runs it.

mod peers;
mod program;
mod squares;

use std::path::Path;

use kirimorph::kirigami::bistable::cell::BistableCell;
use kirimorph::kirigami::bistable::pattern::regular;
use kirimorph::kirigami::design::{Design, State};
use program::{refused, run};
use serde_json::{Value, json};
use squares::{PAIR, squares, write_pair};

/// A regular bistable sheet of 6 x 6 cells of 40 mm.
fn bistable() -> Design {
    let cell = BistableCell { cell: [40.0; 2], rectangle: [16.8; 2], phi: 18_f64.to_radians(), gap: 0.55 };
    let (mesh, pattern) = regular(&cell, [6, 6]);
    pattern.design(&mesh, cell.gap, Some(State::Closed))
}

fn write_design(file: &Path, design: &Design) {
    let piece = |p: &kirimorph::kirigami::design::Piece| {
        let points = |points: &[kirimorph::geometry::Point3]| -> Vec<[f64; 3]> {
            points.iter().map(|p| [p.x, p.y, p.z]).collect()
        };
        json!({ "corners": p.corners, "closed": points(&p.closed), "open": points(&p.open) })
    };
    let hinge = |h: &kirimorph::kirigami::design::Hinge| {
        let (point, axis) = ([h.point.x, h.point.y, h.point.z], [h.axis.x, h.axis.y, h.axis.z]);
        json!({ "pieces": h.pieces, "vertices": h.vertices, "point": point, "axis": axis, "angle_deg": h.angle.to_degrees() })
    };
    let text = json!({
        "version": 1, "units": "mm", "pattern": "bistable", "sheet_state": "closed", "gap_mm": design.gap,
        "corners": design.corners.iter().map(|p| [p.x, p.y, p.z]).collect::<Vec<_>>(),
        "pieces": design.pieces.iter().map(piece).collect::<Vec<_>>(),
        "hinges": design.hinges.iter().map(hinge).collect::<Vec<_>>(), "report": {},
    });
    std::fs::write(file, text.to_string()).unwrap();
}

#[test]
fn a_bistable_sheet_and_a_mechanism() {
    let folder = peers::fresh_folder("snap-made");
    let folder = folder.as_path();
    write_design(&folder.join("b.json"), &bistable());
    let arguments = ["snap", "b.json", "-p", "steel-304-0.5mm", "-o", "snap.json", "--plot", "snap.svg"];
    let made = run(folder, arguments);
    assert_eq!((made.status, made.stderr.as_str()), (0, ""));
    assert!(
        made.stdout.contains("of 36 rectangles snap") && made.stdout.contains("barrier"),
        "{}",
        made.stdout
    );
    let snap: Value = serde_json::from_slice(&std::fs::read(folder.join("snap.json")).unwrap()).unwrap();
    let number = |key: &str| snap[key].as_f64().unwrap();
    assert_eq!(snap["bistable"], json!(true));
    assert!(number("barrier_mj") > number("back_barrier_mj") && number("back_barrier_mj") > 0.0);
    assert_eq!(snap["path"].as_array().unwrap().len(), snap["back"].as_array().unwrap().len());
    let energies = snap["path"].as_array().unwrap().iter().map(|s| s["energy_mj"].as_f64().unwrap());
    assert!(energies.fold(0.0, f64::max) >= number("barrier_mj") * (1.0 - 1e-9));
    assert!(number("largest_strain") > 0.1);
    let plot = std::fs::read_to_string(folder.join("snap.svg")).unwrap();
    assert!(plot.contains("<path") && plot.contains("degrees of the rectangle"));
    // The same again, byte for byte.
    let before = std::fs::read(folder.join("snap.json")).unwrap();
    assert_eq!(run(folder, arguments).status, 0);
    assert_eq!(std::fs::read(folder.join("snap.json")).unwrap(), before);

    write_pair(folder, &squares());
    assert_eq!(run(folder, PAIR).status, 0);
    let made = run(folder, ["snap", "d.json", "-p", "steel-304-0.5mm", "-o", "snap.csv"]);
    assert_eq!(made.status, 0, "{}", made.stderr);
    assert!(made.stdout.contains("no, goes back") && !made.stdout.contains("rectangles"), "{}", made.stdout);
    let csv = std::fs::read_to_string(folder.join("snap.csv")).unwrap();
    let last: Vec<f64> = csv
        .lines()
        .filter(|line| line.starts_with("out,"))
        .map(|line| line.split(',').nth(2).unwrap().parse().unwrap())
        .collect();
    assert!(last.len() > 10 && last.windows(2).all(|pair| pair[1] > pair[0]), "uphill all the way");
}

#[test]
fn bad_input_is_refused() {
    let folder = peers::fresh_folder("snap-refused");
    let folder = folder.as_path();
    write_design(&folder.join("b.json"), &bistable());
    let bare = ["snap", "b.json", "-p", "steel-304-0.5mm"];
    refused(folder, &[&bare[..], &["-o", "snap.txt"]].concat(), 1, &["snap.txt", ".json or .csv"]);
    refused(folder, &[&bare[..], &["--plot", "snap.png"]].concat(), 1, &["snap.png", ".svg"]);
    refused(folder, &["snap", "c.json", "-p", "steel-304-0.5mm"], 1, &["c.json"]);
    let mut design = bistable();
    design.hinges.clear();
    write_design(&folder.join("e.json"), &design);
    refused(folder, &["snap", "e.json", "-p", "steel-304-0.5mm"], 1, &["e.json"]);
}
