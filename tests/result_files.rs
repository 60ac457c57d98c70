//! `design.json`, `hinges.json` and `hinges.csv`: read back, held against their schemas, and checked by independent
//! programs.

mod dome;
mod solve;
mod peers;

use std::fs::{self, File};
use std::path::Path;
use std::sync::LazyLock;

use dome::{Dome, Made, design_text};
use kirimorph::kirigami::design::{Design, State};
use kirimorph::output::design_json::{self, InvalidDesign, ReadDesignError, parse};
use kirimorph::output::dxf::{self, DxfVersion};
use serde_json::{Value, json};

static DOME: LazyLock<Dome> = LazyLock::new(dome::dome);

static TEXT: LazyLock<String> = LazyLock::new(|| design_text(&DOME.made, Some(0.39)).unwrap());

/// The dome where its sheet will be cut.
fn placed() -> Made {
    Made {
        design: dome::laid_out(&DOME).design,
        quality: DOME.made.quality.clone(),
        stages: DOME.made.stages.clone(),
    }
}

#[test]
fn a_design_reads_back_exactly() {
    let ours = &DOME.made.design;
    let read = parse(TEXT.as_bytes()).unwrap();
    assert_eq!((read.pieces.len(), read.hinges.len()), (36, 60));
    // Bit for bit but for the angles, which are degrees in the file.
    assert_eq!(Design { hinges: vec![], ..read.clone() }, Design { hinges: vec![], ..ours.clone() });
    for (read, ours) in read.hinges.iter().zip(&ours.hinges) {
        assert_eq!(
            (read.pieces, read.vertices, read.point, read.axis),
            (ours.pieces, ours.vertices, ours.point, ours.axis)
        );
        // Two conversions, each rounded once, of a number whose last place may weigh twice as much in degrees.
        assert!((read.angle - ours.angle).abs() <= 2.0 * f64::EPSILON * ours.angle);
    }
    for state in [Some(State::Open), None] {
        let mut other = flat();
        other.design.sheet_state = state;
        assert_eq!(parse(design_text(&other, None).unwrap().as_bytes()).unwrap().sheet_state, state);
    }
}

/// The dome's pieces with the open state equal to the closed one: flat in both.
fn flat() -> Made {
    let mut made = Made {
        design: DOME.made.design.clone(),
        quality: DOME.made.quality.clone(),
        stages: DOME.made.stages.clone(),
    };
    made.design.pieces.iter_mut().for_each(|piece| piece.open = piece.closed.clone());
    made
}

#[test]
fn the_same_design_gives_the_same_lines() {
    assert_eq!(design_text(&DOME.made, Some(0.39)).unwrap(), *TEXT);
    // One line per corner, piece, hinge, and row of the iteration tables.
    let made = &DOME.made;
    let starting = |key: &str| TEXT.lines().filter(|line| line.trim_start().starts_with(key)).count();
    let iterations: usize =
        made.stages.iter().flat_map(|stage| &stage.reports).map(|report| report.iterations.len()).sum();
    assert_eq!(starting("{\"corners\":"), made.design.pieces.len());
    assert_eq!(starting("{\"pieces\":"), made.design.hinges.len());
    assert_eq!(starting("{\"phase\":"), iterations);
    assert!(iterations > 20);
    assert!(TEXT.starts_with(
        "{\n  \"version\": 1,\n  \"units\": \"mm\",\n  \"pattern\": \"rotating-rectangles\",\n"
    ));
    assert!(TEXT.ends_with("\n  }\n}\n"));
}

#[test]
fn the_report_says_what_was_done() {
    let file: Value = serde_json::from_str(&TEXT).unwrap();
    let report = &file["report"];
    assert_eq!((&report["job"], &report["target"]), (&json!("dome.toml"), &json!("dome.obj")));
    assert_eq!(report["hashes"], json!({ "dome.obj": "sha256:00ff" }));
    assert_eq!(
        (&report["pieces"], &report["hinges"], &report["max_strain"]),
        (&json!(36), &json!(60), &json!(0.39))
    );
    let quality = &DOME.made.quality;
    for (key, value) in [
        ("e_isom", quality.e_isom),
        ("max_length_error", quality.max_length_error),
        ("planarity", quality.planarity),
        ("distance_max_mm", quality.distance_max),
        ("coverage_max_mm", quality.coverage_max),
        ("boundary_max_mm", quality.boundary_max),
        ("sagitta_max_mm", quality.sagitta_max),
        ("mean_edge_mm", quality.mean_edge),
        ("asked_edge_mm", quality.asked_edge),
        ("area_expansion", quality.area_expansion),
        ("stretch_ratio", quality.stretch_ratio),
        ("target_diagonal_mm", quality.target_diagonal),
    ] {
        assert_eq!(report[key].as_f64(), Some(value), "{key}");
    }
    for (stage, ours) in report["stages"].as_array().unwrap().iter().zip(&DOME.made.stages) {
        assert_eq!(stage["name"], ours.name);
        let reasons: Vec<&str> = ours.reports.iter().map(|report| report.termination.reason()).collect();
        assert_eq!(stage["phases"], json!(reasons));
        assert_eq!(stage["stopped"], *reasons.last().unwrap_or(&"no iterations recorded"));
        let mut rows = stage["iterations"].as_array().unwrap().iter();
        for (phase, report) in ours.reports.iter().enumerate() {
            for iteration in &report.iterations {
                let row = rows.next().unwrap();
                assert_eq!(
                    (&row["phase"], row["damping"].as_f64()),
                    (&json!(phase), Some(iteration.damping))
                );
                assert_eq!(row["energies"].as_object().unwrap().len(), report.terms.len());
                for (term, energy) in report.terms.iter().zip(&iteration.energies) {
                    assert_eq!(row["energies"][term].as_f64(), Some(*energy));
                }
            }
        }
        assert!(rows.next().is_none());
    }
    assert_eq!(report["stages"].as_array().unwrap().len(), 3);
    assert!(design_text(&DOME.made, None).unwrap().contains("\"max_strain\": null,"));
}

#[test]
fn figures_agree_with_an_independent_program() {
    let placed = placed();
    for (name, made) in [("made", &DOME.made), ("placed", &placed), ("shaken", &DOME.shaken)] {
        let file = peers::fresh_folder(&format!("design-check-{name}")).join("design.json");
        fs::write(&file, design_text(made, None).unwrap()).unwrap();
        let Some(mut oracle) = peers::oracle("design_check.py") else { return };
        let output = oracle.arg(&file).output().unwrap();
        let found: Value = serde_json::from_slice(&output.stdout)
            .unwrap_or_else(|_| panic!("{name}: {}", String::from_utf8_lossy(&output.stderr)));
        let figure = |key: &str| found[key].as_f64().unwrap();
        assert_eq!((figure("pieces"), figure("hinges")), (36.0, 60.0));
        // 6 distances in each of 36 pieces; each squared distance in edges is below 3 and rounded a few times.
        assert!(figure("e_isom_difference") < f64::sqrt(216.0) * 3.0 * 4.0 * f64::EPSILON, "{name}: {found}");
        assert!(figure("length_difference") < 8.0 * f64::EPSILON, "{name}: {found}");
        // Eigenvectors against singular vectors: the former are known to the square root less well.
        assert!(figure("planarity_difference") < 1e-9, "{name}: {found}");
        assert!(figure("mean_edge_difference") < 1e-12, "{name}: {found}");
        // Shared variables, moved alike: the two vertices of a hinge are the same numbers.
        assert_eq!((figure("apart_mm"), figure("point_mm")), (0.0, 0.0));
        // Two singular value decompositions of well-conditioned 3 x 3 matrices, degrees and back.
        assert!(figure("rotation_difference") < 1e-12, "{name}: {found}");
        if name != "shaken" {
            assert!(figure("max_length_error") < 1e-8 && figure("planarity") < 1e-6, "{found}");
            // Rigid pieces: as exact as their lengths and planes, over a piece's size.
            assert!(figure("motion_mm") < 1e-5, "{found}");
            assert!(figure("least_angle_deg") > 60.0 && figure("largest_angle_deg") < 120.0, "{found}");
        } else {
            // Far from rounding, so the formulas are told apart.
            assert!(figure("e_isom") > 1e-3 && figure("planarity") > 1e-3, "{found}");
        }
    }
}

#[test]
fn what_cannot_be_read_back_is_not_written() {
    let refused = |change: &dyn Fn(&mut Made)| {
        let mut made = flat();
        change(&mut made);
        design_text(&made, Some(0.1)).unwrap_err().to_string()
    };
    let nan = f64::NAN;
    let cases: [(&str, String); 8] = [
        ("report.boundary_max_mm is NaN", refused(&|made| made.quality.boundary_max = nan)),
        (
            "stage-3, iteration 2, isom is inf",
            refused(&|made| made.stages[2].reports[0].iterations[2].energies[0] = f64::INFINITY),
        ),
        (
            "stage-2, iteration 1, damping is NaN",
            refused(&|made| made.stages[1].reports[0].iterations[1].damping = nan),
        ),
        ("piece 7, open vertex 2, y: NaN", refused(&|made| made.design.pieces[7].open[2].y = nan)),
        ("hinge 9, axis, z: NaN", refused(&|made| made.design.hinges[9].axis.z = nan)),
        ("hinge 9: its angle is NaN", refused(&|made| made.design.hinges[9].angle = nan)),
        ("corner 3, x: 1.1e10", refused(&|made| made.design.corners[3].x = 1.1e10)),
        ("gap_mm is inf", refused(&|made| made.design.gap = f64::INFINITY)),
    ];
    for (expected, message) in cases {
        assert!(message.contains(expected), "{message}");
    }
    let message = design_text(&DOME.made, Some(nan)).unwrap_err().to_string();
    assert!(message.contains("report.max_strain is NaN"), "{message}");
}

/// The file's text after a change of its values.
fn changed(change: impl Fn(&mut Value)) -> String {
    let mut file: Value = serde_json::from_str(&TEXT).unwrap();
    change(&mut file);
    file.to_string()
}

fn remove(value: &mut Value, key: &str) {
    assert!(value.as_object_mut().unwrap().remove(key).is_some(), "{key}");
}

fn append(list: &mut Value, value: Value) {
    list.as_array_mut().unwrap().push(value);
}

/// A change of the file, the text its refusal must hold, and whether the schema refuses it, too: it cannot see what
/// two values have to do with each other.
type Damage = (fn(&mut Value), &'static str, bool);

const DAMAGES: [Damage; 38] = [
    (|f| f["version"] = json!(2), "version 2 of the design format, this program reads version 1", true),
    (|f| f["version"] = json!("1"), "is version \"1\"", true),
    (|f| remove(f, "version"), "has no \"version\"", true),
    (|f| f["units"] = json!("inch"), "units are \"inch\"; a design holds \"mm\"", true),
    (|f| remove(f, "units"), "missing field `units`", true),
    (|f| f["pattern"] = json!("auxetic"), "pattern \"auxetic\" is not known to this version", true),
    (|f| f["sheet_state"] = json!("half"), "sheet state \"half\" does not exist", true),
    (|f| remove(f, "sheet_state"), "missing field `sheet_state`", true),
    (|f| remove(f, "gap_mm"), "holds no sheet corners (no \"gap_mm\")", true),
    (|f| remove(f, "corners"), "holds no sheet corners (no \"corners\")", true),
    (|f| remove(&mut f["pieces"][4], "corners"), "no \"corners\" in piece 4", true),
    (|f| remove(f, "report"), "missing field `report`", true),
    (|f| f["report"] = json!([1]), "expected an object", true),
    (|f| f["comment"] = json!("mine"), "unknown field `comment`", true),
    (|f| f["pieces"][2]["name"] = json!("a"), "unknown field `name`", true),
    (|f| f["hinges"][2]["angle"] = json!(1), "unknown field `angle`", true),
    (|f| f["pieces"][2] = json!([[0, 1, 6], [[0, 0, 0]], [[0, 0, 0]]]), "expected an object", true),
    (|f| f["gap_mm"] = json!(-0.1), "gap_mm is -0.1", true),
    (|f| f["pieces"] = json!([]), "the design has no pieces", true),
    (|f| f["pieces"][3]["open"][1][2] = json!(null), "invalid type: null, expected f64", true),
    (|f| f["pieces"][3]["open"][1] = json!([1.0, 2.0]), "invalid length 2", true),
    (|f| f["pieces"][3]["open"][1] = json!([1.0, 2.0, 3.0, 4.0]), "at line", true),
    (|f| f["pieces"][3]["open"][1][2] = json!(2e10), "piece 3, open vertex 1, z: 2e10", true),
    (|f| drop(f["pieces"][3]["open"].as_array_mut().unwrap().pop()), "4 corners, 4 closed and 3 open", false),
    (
        |f| {
            ["corners", "closed", "open"]
                .iter()
                .for_each(|&key| f["pieces"][3][key].as_array_mut().unwrap().truncate(2))
        },
        "piece 3 has 2 vertices",
        true,
    ),
    (
        |f| f["pieces"][3]["corners"][1] = json!(49),
        "names corner 49, but the corners run from 0 to 48",
        false,
    ),
    (|f| f["pieces"][3]["corners"][1] = json!(-1), "invalid value: integer `-1`", true),
    (|f| f["pieces"][3]["corners"][1] = f["pieces"][3]["corners"][0].clone(), "twice", true),
    (|f| f["pieces"][3]["closed"][0][2] = json!(0.01), "piece 3, closed vertex 0 lies 1e-2 mm off", false),
    (|f| f["corners"][3][2] = json!(-0.01), "corner 3 lies -1e-2 mm off", false),
    (|f| f["hinges"][5]["pieces"][1] = json!(36), "names piece 36, but the pieces run from 0 to 35", false),
    (|f| f["hinges"][5]["pieces"][1] = f["hinges"][5]["pieces"][0].clone(), "with itself", true),
    (|f| f["hinges"][5]["vertices"][1] = json!(4), "names vertex 4 of piece", false),
    (
        |f| f["hinges"][5]["vertices"][1] = json!((f["hinges"][5]["vertices"][1].as_u64().unwrap() + 1) % 4),
        "its two vertices are",
        false,
    ),
    (|f| f["hinges"][5]["point"][0] = json!(0.0), "hinge 5: its point is", false),
    (|f| f["hinges"][5]["axis"][2] = json!(0.5), "hinge 5: its axis has length", false),
    (|f| f["hinges"][5]["angle_deg"] = json!(-90.0), "hinge 5: its angle is -90", true),
    (|f| append(&mut f["hinges"][5]["pieces"], json!(3)), "at line", true),
];

#[test]
fn damaged_designs_are_refused_with_the_place() {
    assert!(parse(changed(|_| ()).as_bytes()).is_ok());
    for (change, expected, _) in DAMAGES {
        let message = parse(changed(change).as_bytes()).unwrap_err().to_string();
        assert!(message.contains(expected), "{expected}: {message}");
        assert!(message.len() < 300, "{message}");
    }
    // The two states are checked apart: an open vertex off by a hundredth of a millimetre.
    let hinge = &DOME.made.design.hinges[5];
    let ([j, _], [v, _]) = (hinge.pieces, hinge.vertices);
    let shifted = |by: f64| {
        changed(|file| {
            let x = &mut file["pieces"][j]["open"][v][0];
            *x = json!(x.as_f64().unwrap() + by);
        })
    };
    let message = parse(shifted(0.01).as_bytes()).unwrap_err().to_string();
    assert!(message.contains("mm apart in the open state"), "{message}");
    assert!(parse(shifted(0.9e-6).as_bytes()).is_ok() && parse(shifted(1.1e-6).as_bytes()).is_err());
    // Keys in the report are free.
    assert!(parse(changed(|file| file["report"] = json!({ "mine": [1, 2] })).as_bytes()).is_ok());
}

#[test]
fn texts_that_are_no_design_are_refused() {
    let cut = &TEXT[..TEXT.len() / 2];
    let twice = TEXT.replacen("\"units\"", "\"gap_mm\": 1, \"units\"", 1);
    let nan = TEXT.replacen("\"gap_mm\": 0.55", "\"gap_mm\": NaN", 1);
    let huge = TEXT.replacen("\"gap_mm\": 0.55", "\"gap_mm\": 1e999", 1);
    assert!(nan != *TEXT && huge != *TEXT);
    let cases: [(&[u8], &str); 11] = [
        (b"", "the file is empty"),
        (b" \n\t", "the file is empty"),
        (cut.as_bytes(), "it is truncated"),
        (b"{", "it is truncated"),
        (b"[1]", "expected an object"),
        (b"\xff\xfe", "line 1 column 1"),
        (b"{\"version\": 1}", "missing field `units`"),
        (twice.as_bytes(), "duplicate field `gap_mm`"),
        (nan.as_bytes(), "line 6 column"),
        (huge.as_bytes(), "number out of range at line 6"),
        (b"{\"version\": 1} {", "trailing characters"),
    ];
    for (bytes, expected) in cases {
        let message = parse(bytes).unwrap_err().to_string();
        assert!(message.contains(expected), "{expected}: {message}");
    }
    // Deeply nested values overflow no stack.
    let nested = "[".repeat(200_000);
    assert!(parse(format!("{{\"version\": {nested}").as_bytes()).is_err());
    assert!(parse(format!("{{\"report\": {nested}").as_bytes()).is_err());
    assert!(parse(nested.as_bytes()).is_err());
}

#[test]
fn files_are_named_in_errors() {
    let folder = peers::fresh_folder("read-design");
    let message = |path: &Path| design_json::read(path).unwrap_err().to_string();
    assert!(matches!(design_json::read(&folder), Err(ReadDesignError::NotAFile { what: "a folder", .. })));
    assert!(message(&folder.join("none.json")).contains("none.json cannot be read"));
    let file = folder.join("design.json");
    fs::write(&file, "").unwrap();
    assert!(message(&file).contains("design.json: the file is empty"));
    fs::write(&file, &*TEXT).unwrap();
    assert_eq!(design_json::read(&file).unwrap(), parse(TEXT.as_bytes()).unwrap());
}

#[test]
fn designs_keep_the_schema_and_damage_breaks_it() {
    let good = [TEXT.clone(), design_text(&DOME.shaken, None).unwrap()];
    let Some(breaches) = peers::schema_breaches("design-schema-good", "design.schema.json", &good) else {
        return;
    };
    assert_eq!(breaches, [[""; 0]; 2]);
    let damaged: Vec<String> = DAMAGES.iter().map(|(change, ..)| changed(change)).collect();
    let breaches = peers::schema_breaches("design-schema-damaged", "design.schema.json", &damaged).unwrap();
    for ((_, what, seen), found) in DAMAGES.iter().zip(&breaches) {
        assert_eq!(!found.is_empty(), *seen, "{what}: {found:?}");
    }
    type Change = (fn(&mut Value), &'static str);
    let in_report: [Change; 6] = [
        (|f| remove(&mut f["report"], "planarity"), "/report"),
        (|f| f["report"]["e_isom"] = json!(-1e-30), "/report/e_isom"),
        (|f| f["report"]["target"] = json!("/home/somebody/dome.obj"), "/report/target"),
        (|f| f["report"]["stages"][1]["seconds"] = json!(1.5), "/report/stages/1"),
        (
            |f| f["report"]["stages"][1]["iterations"][0]["energies"]["orth"] = json!(null),
            "/report/stages/1/iterations/0/energies/orth",
        ),
        (|f| f["report"]["stages"][2]["name"] = json!("stage-4"), "/report/stages/2/name"),
    ];
    let damaged: Vec<String> = in_report.iter().map(|(change, _)| changed(change)).collect();
    let breaches = peers::schema_breaches("design-schema-report", "design.schema.json", &damaged).unwrap();
    for ((_, place), found) in in_report.iter().zip(&breaches) {
        assert_eq!(found, &[place.to_string()]);
    }
}

#[test]
fn the_burner_finds_in_the_cuts_what_the_files_say() {
    let made = dome::laid_out(&DOME);
    let folder = peers::fresh_folder("result-files-burned");
    let [cut, hinges, design] = ["cut.dxf", "hinges.json", "design.json"].map(|name| folder.join(name));
    dxf::write(&made.layout, DxfVersion::R2000, &[], File::create(&cut).unwrap()).unwrap();
    fs::write(&hinges, dome::hinges_text(&DOME, &made.hinges)).unwrap();
    fs::write(&design, design_text(&placed(), None).unwrap()).unwrap();
    let Some(mut oracle) = peers::oracle("burn.py") else { return };
    let output = oracle.args([&cut, &hinges, &design]).output().unwrap();
    let found: Value = serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)));
    assert_eq!(
        (&found["ok"], &found["pieces"], &found["hinges"]),
        (&json!(true), &json!(36), &json!(60)),
        "{found}"
    );
}

#[test]
fn invariants_name_the_hinge() {
    let mut design = flat().design;
    design.hinges[7].axis *= 1.0 + 1e-8;
    assert!(matches!(design_json::check(&design), Err(InvalidDesign::Axis { hinge: 7, .. })));
    design.hinges[7].axis = design.hinges[7].axis.normalize();
    assert_eq!(design_json::check(&design), Ok(()));
}
