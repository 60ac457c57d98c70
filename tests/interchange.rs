//! Designs made elsewhere, and designs for others: `import`, `export` and `fabricate` as a user runs them.

mod peers;
mod program;
mod recomputed;
mod squares;

use std::collections::BTreeMap;
use std::path::Path;

use kirimorph::kirigami::improve::Slits;
use program::{
    FILES, Mesh, STEEL, asked, coordinates, job, json_file, listing, number, refused, run, succeeds,
};
use recomputed::check_recomputed;
use serde_json::{Value, json};
use squares::{GRID, PAIR, Squares, moved, squares, write_pair};

fn import_pair(folder: &Path, more: &[&str]) -> Value {
    succeeds(folder, &[&PAIR, more].concat());
    json_file(&folder.join("d.json"))
}

/// The hinges by pieces and vertices, in one order whatever the file's.
fn hinges(design: &Value) -> BTreeMap<String, (Vec<f64>, Vec<f64>, f64)> {
    let numbers = |value: &Value| -> Vec<f64> {
        value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
    };
    let all = design["hinges"].as_array().unwrap();
    let entry = |hinge: &Value| {
        let ends = [0, 1].map(|end| (hinge["pieces"][end].as_u64(), hinge["vertices"][end].as_u64()));
        let turned = ends[0] > ends[1];
        let [a, b] = if turned { [ends[1], ends[0]] } else { ends };
        (
            format!("{a:?} {b:?}"),
            (numbers(&hinge["point"]), numbers(&hinge["axis"]), number(hinge, "angle_deg")),
        )
    };
    let found: BTreeMap<_, _> = all.iter().map(entry).collect();
    assert_eq!(found.len(), all.len(), "a hinge twice");
    found
}

#[test]
fn rotating_squares_are_taken_over_in_any_pose_and_unit() {
    let folder = peers::fresh_folder("import-squares");
    let squares = squares();
    let turn = turn();
    let poses: [(&str, Squares, &[&str]); 3] = [
        ("as they are", squares.clone(), &[]),
        (
            "closed tilted and in centimetres",
            Squares {
                closed: moved(&squares.closed, |p| turn(p.map(|c| 0.1 * c))),
                open: moved(&squares.open, |p| p.map(|c| 0.1 * c)),
            },
            &["--units", "cm"],
        ),
        (
            "listed clockwise, sized",
            {
                let reversed = |state: &squares::State| {
                    state.iter().map(|piece| piece.iter().rev().copied().collect()).collect()
                };
                Squares { closed: reversed(&squares.closed), open: moved(&reversed(&squares.open), &turn) }
            },
            &["--size-mm", "48"],
        ),
    ];
    for (name, pose, options) in poses {
        write_pair(&folder, &pose);
        let design = import_pair(&folder, options);
        assert_eq!(
            (&design["pattern"], &design["sheet_state"]),
            (&json!("imported"), &json!("closed")),
            "{name}"
        );
        assert_eq!(design["pieces"].as_array().unwrap().len(), 12);
        assert_eq!(design["corners"].as_array().unwrap().len(), 20, "{name}: slits are closed");
        let hinges = hinges(&design);
        assert_eq!(hinges.len(), Squares::hinges(GRID), "{name}");
        for (_, axis, angle) in hinges.values() {
            assert!((angle - 80.0).abs() < 1e-9, "{name}: {angle}");
            assert!((axis[2].abs() - 1.0).abs() < 1e-12, "{name}: {axis:?}");
        }
        // Rounding of a turn.
        assert!(number(&design["report"], "rigid_residual") < 1e-14, "{name}");
        assert!((number(&design["report"], "mean_edge_mm") - 12.0).abs() < 1e-12, "{name}");
        for piece in design["pieces"].as_array().unwrap() {
            let p: Vec<[f64; 3]> = serde_json::from_value(piece["closed"].clone()).unwrap();
            let area: f64 = (0..4).map(|i| p[i][0] * p[(i + 1) % 4][1] - p[i][1] * p[(i + 1) % 4][0]).sum();
            assert!((0.5 * area - 144.0).abs() < 1e-9, "{name}: not counter-clockwise");
        }
        check_recomputed(&folder.join("d.json"));
    }
}

/// A turn and shift that leave no axis alone.
fn turn() -> impl Fn([f64; 3]) -> [f64; 3] {
    let ((sa, ca), (sb, cb)) = (0.7_f64.sin_cos(), 1.1_f64.sin_cos());
    move |[x, y, z]| {
        let (x, y) = (ca * x - sa * y, sa * x + ca * y);
        let (y, z) = (cb * y - sb * z, sb * y + cb * z);
        [x + 3.0, y - 2.0, z + 0.5]
    }
}

#[test]
fn an_imported_sheet_is_cut_and_the_report_is_honest_about_its_hinges() {
    let folder = peers::fresh_folder("import-cut");
    write_pair(&folder, &squares());
    import_pair(&folder, &[]);
    succeeds(&folder, &["check", "d.json", "-p", "steel-304-0.5mm"]);
    succeeds(&folder, &["fabricate", "d.json", "-p", "steel-304-0.5mm", "-o", "cut"]);
    let mut names: Vec<_> =
        std::fs::read_dir(folder.join("cut")).unwrap().map(|e| e.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, FILES);
    let offsets = |folder: &str| -> Vec<f64> {
        let report = json_file(Path::new(folder));
        report["hinges"].as_array().unwrap().iter().map(|row| number(row, "centre_offset_mm")).collect()
    };
    let inner = |offsets: &[f64]| offsets.iter().copied().fold(0.0, f64::max);
    // Both hinges of a corner in one point: the ligament stands half of 0.5 + 0.05 mm beside it.
    let file = folder.join("cut/hinges.json").display().to_string();
    assert!((inner(&offsets(&file)) - 0.275).abs() < 1e-6, "{}", inner(&offsets(&file)));
    // With the profile's gap hinges stand where ligaments are.
    let text = succeeds(&folder, &[&PAIR[..], &["--improve", "-p", "steel-304-0.5mm"]].concat());
    assert!(text.contains("improved"), "{text}");
    succeeds(&folder, &["fabricate", "d.json", "-p", "steel-304-0.5mm", "-o", "cut"]);
    assert!(inner(&offsets(&file)) < 1e-3, "{}", inner(&offsets(&file)));
    let report = &json_file(&folder.join("cut/design.json"))["report"];
    assert!(number(report, "max_length_error") < 1e-12);
    check_recomputed(&folder.join("cut/design.json"));
    let [dxf, hinges, design] =
        ["cut.dxf", "hinges.json", "design.json"].map(|name| folder.join("cut").join(name));
    let arguments: [&dyn AsRef<std::ffi::OsStr>; 6] = [&dxf, &hinges, &design, &"--sheet", &"1000", &"1000"];
    if let Some(burned) = asked(peers::oracle("burn.py"), &arguments) {
        assert_eq!((&burned["ok"], &burned["bodies"]), (&json!(true), &json!(1)));
        assert_eq!(burned["hinges"], Squares::hinges(GRID));
    }
}

/// A small design of our own: a bump of 8 by 8 pieces.
fn own_design(folder: &Path) -> Value {
    let mesh = Mesh::bump([100.0, 90.0], 14.0, [10, 9]);
    std::fs::write(folder.join("bump.obj"), mesh.obj()).unwrap();
    std::fs::write(folder.join("job.toml"), job("open = \"bump.obj\"", "pieces = [8, 8]", STEEL)).unwrap();
    succeeds(folder, &["design", "job.toml", "-o", "own.json"]);
    json_file(&folder.join("own.json"))
}

#[test]
fn exported_designs_come_back_the_same() {
    let folder = peers::fresh_folder("round-trip");
    let own = own_design(&folder);
    let gap = number(&own, "gap_mm").to_string();
    succeeds(&folder, &["export", "own.json", "--obj-pair", "obj", "--pykirigami", "py"]);
    let sources: [&[&str]; 2] =
        [&["--closed", "obj/closed.obj", "--open", "obj/open.obj"], &["--pykirigami", "py"]];
    for source in sources {
        let arguments = [&["import"], source, &["-o", "back.json", "--gap-mm", &gap]].concat();
        succeeds(&folder, &arguments);
        let back = json_file(&folder.join("back.json"));
        for (piece, other) in own["pieces"].as_array().unwrap().iter().zip(back["pieces"].as_array().unwrap())
        {
            // To the last bit: the same numbers in the same digits.
            assert_eq!((&piece["closed"], &piece["open"]), (&other["closed"], &other["open"]));
        }
        let (own_hinges, back_hinges) = (hinges(&own), hinges(&back));
        assert_eq!(
            own_hinges.keys().collect::<Vec<_>>(),
            back_hinges.keys().collect::<Vec<_>>(),
            "{source:?}"
        );
        for (key, (point, _, angle)) in &own_hinges {
            assert_eq!(*point, back_hinges[key].0);
            assert!((angle - back_hinges[key].2).abs() < 1e-9);
        }
        assert_eq!(coordinates(&own).len(), coordinates(&back).len(), "corners");
        assert!(
            (number(&own["report"], "mean_edge_mm") - number(&back["report"], "mean_edge_mm")).abs() < 1e-6
        );
        // What comes back is cut as what went out.
        succeeds(&folder, &["fabricate", "back.json", "-p", "steel-304-0.5mm", "-o", "cut"]);
        let text = succeeds(&folder, &["check", "cut", "-p", "steel-304-0.5mm"]);
        assert!(text.contains(" 0 fail"), "{text}");
    }
    // Fabricating our own design keeps what was said about its target.
    succeeds(&folder, &["fabricate", "own.json", "-p", "steel-304-0.5mm", "-o", "cut"]);
    let cut = json_file(&folder.join("cut/design.json"));
    for key in ["distance_max_mm", "coverage_max_mm", "asked_edge_mm", "stages", "job", "target"] {
        assert_eq!(own["report"][key], cut["report"][key], "{key}");
    }
    check_recomputed(&folder.join("cut/design.json"));
}

#[test]
fn room_for_ligaments_is_made_as_in_our_own_designs() {
    let folder = peers::fresh_folder("import-gap");
    own_design(&folder);
    let design = kirimorph::output::design_json::read(&folder.join("own.json")).unwrap();
    let slits = Slits::new(&design);
    assert_eq!(slits.unclosed(&design), None);
    let offsets = slits.offsets(&design, &design.corners);
    let mut moved = 0;
    for (piece, offsets) in design.pieces.iter().zip(offsets) {
        for ((closed, &corner), offset) in piece.closed.iter().zip(&piece.corners).zip(offsets) {
            let own = closed - design.corners[corner];
            // Ours were found before the last phase of the optimisation, which still turns slits by this much.
            assert!((own - offset * (0.5 * design.gap)).norm() < 1e-3 * design.gap, "{own:?} {offset:?}");
            moved += usize::from(own.norm() > 0.4 * design.gap);
        }
    }
    assert!(moved > 200, "{moved}");
}

#[test]
fn solids_are_written_for_each_piece() {
    let folder = peers::fresh_folder("export-stl");
    write_pair(&folder, &squares());
    import_pair(&folder, &[]);
    succeeds(&folder, &["export", "d.json", "--stl", "solids", "--thickness-mm", "0.5", "--state", "open"]);
    for piece in 0..12 {
        let path = folder.join(format!("solids/piece-{piece:04}.stl"));
        let mesh = kirimorph::geometry::read::read_mesh(&path).unwrap();
        assert_eq!((mesh.vertices.len(), mesh.faces.len()), (8, 12));
        let volume: f64 = mesh
            .faces
            .iter()
            .map(|face| {
                let [a, b, c] = [face[0], face[1], face[2]].map(|v| mesh.vertices[v].coords);
                a.dot(&b.cross(&c)) / 6.0
            })
            .sum();
        // 12 x 12 x 0.5; the file holds single precision.
        assert!((volume - 72.0).abs() < 1e-3, "piece {piece}: {volume}");
    }
    // A folder with files of others' is left alone.
    std::fs::write(folder.join("solids/notes.txt"), "mine").unwrap();
    let before = listing(&folder);
    let run = run(&folder, ["export", "d.json", "--stl", "solids", "--thickness-mm", "1"]);
    assert_eq!(run.status, 1);
    assert!(run.stderr.contains("notes.txt"), "{}", run.stderr);
    assert!(listing(&folder) == before);
}

/// The pieces file of squares that turn in the plane; every other piece's rotation as a matrix.
fn pieces_json(design: &Squares, turn: f64) -> Value {
    let piece = |(index, polygon): (usize, &Vec<[f64; 3]>)| {
        let (i, j) = (index % GRID[0], index / GRID[0]);
        let turn = if (i + j).is_multiple_of(2) { turn } else { -turn };
        let (s, c) = turn.sin_cos();
        // The first corner tells the shift.
        let ([x, y, _], [u, v, _]) = (polygon[0], design.open[index][0]);
        let rotation = if index.is_multiple_of(2) {
            json!([(0.5 * turn).cos(), 0.0, 0.0, (0.5 * turn).sin()])
        } else {
            json!([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        };
        json!({
            "polygon": polygon, "rotation": rotation,
            "translation": [u - (c * x - s * y), v - (s * x + c * y), 0.0],
        })
    };
    let pieces: Vec<Value> = design.closed.iter().enumerate().map(piece).collect();
    json!({ "version": 1, "state": "closed", "pieces": pieces })
}

#[test]
fn pieces_and_motions_are_taken_over() {
    let folder = peers::fresh_folder("import-pieces");
    let turn = 40_f64.to_radians();
    let design = Squares::new(GRID, 12.0, turn);
    std::fs::write(folder.join("p.json"), pieces_json(&design, turn).to_string()).unwrap();
    if let Some(faults) = asked(
        peers::oracle("schema_check.py"),
        &[&Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/pieces.schema.json"), &folder.join("p.json")],
    ) {
        assert_eq!(faults, json!([[]]));
    }
    succeeds(&folder, &["import", "--pieces", "p.json", "-o", "d.json"]);
    write_pair(&folder, &design);
    let by_pieces = json_file(&folder.join("d.json"));
    let by_pair = import_pair(&folder, &[]);
    let (a, b) = (coordinates(&by_pieces), coordinates(&by_pair));
    assert!(program::largest_difference(&a, &b) < 1e-12);
    assert_eq!(hinges(&by_pieces).keys().collect::<Vec<_>>(), hinges(&by_pair).keys().collect::<Vec<_>>());
    let mut mirrored = pieces_json(&design, turn);
    mirrored["pieces"][3]["rotation"] = json!([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]]);
    let mut long = pieces_json(&design, turn);
    long["pieces"][4]["rotation"] = json!([1.0, 0.1, 0.0, 0.0]);
    for (file, says) in
        [(mirrored, "piece 3: its matrix mirrors"), (long, "piece 4: its quaternion has length 1.00")]
    {
        std::fs::write(folder.join("p.json"), file.to_string()).unwrap();
        refused(&folder, &["import", "--pieces", "p.json", "-o", "new.json"], 1, &[says]);
    }
}

#[test]
fn slits_that_are_not_closed_are_said_so_when_cuts_are_asked_for() {
    let folder = peers::fresh_folder("import-unclosed");
    let [closed, open] = [10_f64, 40.0].map(|turn| Squares::new(GRID, 12.0, turn.to_radians()).open);
    write_pair(&folder, &Squares { closed, open });
    let design = import_pair(&folder, &[]);
    assert!(hinges(&design).values().all(|(_, _, angle)| (angle - 60.0).abs() < 1e-9));
    assert_eq!(design["sheet_state"], "closed");
    let profile = ["-p", "steel-304-0.5mm"];
    let says = ["do not lie on each other", "not closed", "pieces 0 and 1"];
    refused(&folder, &[&["fabricate", "d.json", "-o", "cut"][..], &profile].concat(), 2, &says);
    refused(&folder, &[&PAIR[..], &["--improve"], &profile].concat(), 2, &["--profile", "not closed"]);
    let run = run(&folder, ["check", "d.json", profile[0], profile[1]]);
    assert_eq!(run.status, 2, "{}", run.stderr);
    assert!(run.stdout.contains("17 hinges"), "{}", run.stdout);
}

#[test]
fn a_piece_listed_the_other_way_round_is_turned() {
    let folder = peers::fresh_folder("import-reversed");
    let mut design = squares();
    design.closed[5].reverse();
    design.open[5].reverse();
    write_pair(&folder, &design);
    let text = succeeds(&folder, &PAIR);
    assert!(text.contains("warning: piece 5: listed the other way round"), "{text}");
    assert_eq!(json_file(&folder.join("d.json"))["hinges"].as_array().unwrap().len(), Squares::hinges(GRID));
    succeeds(&folder, &["check", "d.json", "-p", "steel-304-0.5mm"]);
    check_recomputed(&folder.join("d.json"));
}
