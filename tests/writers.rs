//! The writers of machine files, read back by independent programs.

mod peers;

use std::f64::consts::PI;
use std::process::Command;

use kirimorph::fabrication::layout::{CutKind, CutLayout, CutPath, Note, PathVertex};
use kirimorph::output::dxf::{self, DxfVersion, WriteDxfError};
use kirimorph::output::layout_fault::LayoutFault;
use kirimorph::output::svg;
use kurbo::Point;
use serde_json::Value;

const VERSIONS: [DxfVersion; 2] = [DxfVersion::R2000, DxfVersion::R12];

fn path(kind: CutKind, closed: bool, vertices: &[(f64, f64, f64)]) -> CutPath {
    let vertices = vertices.iter().map(|&(x, y, bulge)| PathVertex { point: Point::new(x, y), bulge });
    CutPath { kind, vertices: vertices.collect(), closed }
}

/// Every kind of cut, arcs of both senses and of a quarter, a half and nearly a whole turn, no symmetry.
fn layout() -> CutLayout {
    let quarter = (PI / 8.0).tan();
    CutLayout {
        sheet: [120.0, 80.5],
        kerf: 0.05,
        engravings: vec![],
        paths: vec![
            path(CutKind::Slit, false, &[(10.0, 10.0, 0.0), (20.123456789012, 14.0, 0.0)]),
            path(
                CutKind::Relief,
                false,
                &[(31.0, 10.0, -quarter), (32.0, 11.0, 0.0), (34.0, 11.0, -quarter), (35.0, 10.0, 0.0)],
            ),
            path(CutKind::Relief, false, &[(50.0, 20.0, 1.0), (54.0, 20.0, -2.5), (57.0, 24.0, 0.0)]),
            path(CutKind::Window, true, &[(60.0, 40.0, 1.0), (66.0, 40.0, 1.0)]),
            path(
                CutKind::Slit,
                false,
                &[(70.0, 10.0, 0.01), (75.0, 60.0, 0.0), (78.0, 61.0, -0.3), (79.0, 50.0, 0.0)],
            ),
            path(
                CutKind::Border,
                true,
                &[
                    (5.0, 5.0, 0.0),
                    (112.0, 5.0, quarter),
                    (115.0, 8.0, 0.0),
                    (115.0, 75.0, 0.0),
                    (5.0, 70.0, 0.0),
                ],
            ),
        ],
        notes: vec![Note { position: Point::new(6.0, 76.0), height: 2.5, text: "dome Ü 1/1 & <up>".into() }],
    }
}

/// The perimeter of the paths of one kind, by the definition of the bulge: b = tan(sweep/4), and the half chord
/// over the radius is sin(sweep/2).
fn length(layout: &CutLayout, kind: CutKind) -> f64 {
    let segment = |from: &PathVertex, to: &PathVertex| {
        let (chord, sweep) = (from.point.distance(to.point), 4.0 * from.bulge.abs().atan());
        if sweep == 0.0 { chord } else { 0.5 * chord / (0.5 * sweep).sin() * sweep }
    };
    let of_path = |path: &CutPath| {
        let pairs: f64 = path.vertices.windows(2).map(|pair| segment(&pair[0], &pair[1])).sum();
        let closing =
            path.closed.then(|| segment(&path.vertices[path.vertices.len() - 1], &path.vertices[0]));
        pairs + closing.unwrap_or(0.0)
    };
    layout.paths.iter().filter(|path| path.kind == kind).map(of_path).sum()
}

fn dxf_bytes(layout: &CutLayout, version: DxfVersion, comments: &[String]) -> Vec<u8> {
    let mut bytes = Vec::new();
    dxf::write(layout, version, comments, &mut bytes).unwrap();
    bytes
}

fn svg_bytes(layout: &CutLayout, comments: &[String]) -> Vec<u8> {
    let mut bytes = Vec::new();
    svg::write(layout, comments, &mut bytes).unwrap();
    bytes
}

/// What the independent reader finds in a file, and whether it is clean.
fn summary(test: &str, file: &str, bytes: &[u8]) -> Option<(bool, Value)> {
    let mut oracle = peers::oracle("cut_summary.py")?;
    let name = peers::fresh_folder(test).join(file);
    std::fs::write(&name, bytes).unwrap();
    let output = oracle.arg(&name).output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout);
    let value = serde_json::from_str(&text)
        .unwrap_or_else(|_| panic!("{file}: no summary: {}", String::from_utf8_lossy(&output.stderr)));
    Some((output.status.success(), value))
}

/// Vertices, layers and order as read equal ours within `eps`.
fn assert_same_paths(read: &Value, layout: &CutLayout, eps: f64) {
    let paths = read["paths"].as_array().unwrap();
    assert_eq!(paths.len(), layout.paths.len());
    for (path, ours) in paths.iter().zip(&layout.paths) {
        assert_eq!(path["layer"].as_str().unwrap(), format!("{:?}", ours.kind).to_uppercase());
        assert_eq!(path["closed"], ours.closed);
        let vertices: Vec<[f64; 3]> = serde_json::from_value(path["vertices"].clone()).unwrap();
        assert_eq!(vertices.len(), ours.vertices.len());
        for (read, ours) in vertices.iter().zip(&ours.vertices) {
            let ours = [ours.point.x, ours.point.y, ours.bulge];
            assert!(read.iter().zip(ours).all(|(r, o)| (r - o).abs() < eps), "{read:?} for {ours:?}");
        }
    }
}

#[test]
fn dxf_is_clean_and_in_millimetres() {
    for version in VERSIONS {
        let bytes = dxf_bytes(&layout(), version, &["kerf 0.05 mm already applied: cut on the line".into()]);
        assert!(bytes.starts_with(b"999\r\nkerf 0.05 mm already applied"));
        let Some((clean, read)) = summary(&format!("clean-{version:?}"), "cut.dxf", &bytes) else { return };
        assert!(clean, "{version:?}: {}", read["reasons"]);
        assert_eq!((&read["errors"], &read["fixes"]), (&0.into(), &0.into()));
        for (name, color) in [("SLIT", 1), ("RELIEF", 5), ("WINDOW", 3), ("BORDER", 6), ("NOTE", 8)] {
            assert_eq!(read["layers"][name]["color"], color);
        }
        assert_eq!(read["entities"]["TEXT NOTE"], 1);
        if version == DxfVersion::R2000 {
            assert_eq!((&read["version"], &read["insunits"]), (&"AC1015".into(), &4.into()));
            assert_eq!(read["measurement"], 1);
            let plotted =
                ["SLIT", "RELIEF", "WINDOW", "BORDER", "NOTE"].map(|l| read["layers"][l]["plot"].clone());
            assert_eq!(plotted, [1, 1, 1, 1, 0].map(Value::from));
        } else {
            assert_eq!(read["version"], "AC1009");
            let kinds =
                read["entities"].as_object().unwrap().keys().map(|key| key.split(' ').next().unwrap());
            assert!(kinds.into_iter().all(|kind| ["LINE", "ARC", "TEXT"].contains(&kind)));
        }
        // Twelve printed decimals, of an angle in degrees about a centre 1256 mm away at the worst.
        assert_same_paths(&read, &layout(), 1e-10);
    }
}

#[test]
fn r12_has_no_subclass_markers() {
    let text = String::from_utf8(dxf_bytes(&layout(), DxfVersion::R12, &[])).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    assert!(lines.chunks(2).all(|pair| pair.len() == 2 && pair[0].trim() != "100"));
}

#[test]
fn bulges_stand_where_arcs_begin_and_nowhere_else() {
    let text = String::from_utf8(dxf_bytes(&layout(), DxfVersion::R2000, &[])).unwrap();
    let polylines: Vec<&str> = text.split("\r\nLWPOLYLINE\r\n").skip(1).collect();
    assert_eq!(polylines.len(), layout().paths.len());
    for (polyline, path) in polylines.iter().zip(&layout().paths) {
        let entity = polyline.split("\r\n  0\r\n").next().unwrap();
        let lines: Vec<&str> = entity.lines().collect();
        let bulges = lines.chunks(2).filter(|pair| pair[0].trim() == "42").count();
        // FreeCAD drops paths with bulges of 0.
        assert_eq!(bulges, path.vertices.iter().filter(|v| v.bulge != 0.0).count());
    }
}

#[test]
fn the_dxf_crate_reads_its_own_files_with_comments() {
    for version in VERSIONS {
        let bytes = dxf_bytes(&layout(), version, &["one".into(), "two".into()]);
        let drawing = ::dxf::Drawing::load(&mut bytes.as_slice()).unwrap();
        // 6 cuts of 16 segments in all, and a note.
        assert_eq!(drawing.entities().count(), if version == DxfVersion::R2000 { 6 + 1 } else { 16 + 1 });
    }
}

#[test]
fn dxf_lengths_equal_ours() {
    let ours = layout();
    for version in VERSIONS {
        let bytes = dxf_bytes(&ours, version, &[]);
        let Some((_, read)) = summary(&format!("lengths-{version:?}"), "cut.dxf", &bytes) else { return };
        for kind in [CutKind::Slit, CutKind::Relief, CutKind::Window, CutKind::Border] {
            let expected = length(&ours, kind);
            let found = read["lengths"][format!("{kind:?}").to_uppercase()].as_f64().unwrap();
            // Printed to twelve decimals, summed over tens of millimetres.
            assert!(
                (found - expected).abs() <= 1e-9 * expected,
                "{version:?} {kind:?}: {found}, ours {expected}"
            );
        }
    }
}

#[test]
fn quarter_and_full_circles_have_their_length() {
    let quarter = path(CutKind::Slit, false, &[(3.0, 1.0, (PI / 8.0).tan()), (1.0, 3.0, 0.0)]);
    let circle = path(CutKind::Window, true, &[(20.0, 20.0, 1.0), (26.0, 20.0, 1.0)]);
    let ours = CutLayout {
        sheet: [50.0, 50.0],
        kerf: 0.05,
        engravings: vec![],
        paths: vec![quarter, circle],
        notes: vec![],
    };
    let files = [
        ("R2000.dxf", dxf_bytes(&ours, DxfVersion::R2000, &[])),
        ("R12.dxf", dxf_bytes(&ours, DxfVersion::R12, &[])),
        ("cut.svg", svg_bytes(&ours, &[])),
    ];
    for (file, bytes) in files {
        let Some((_, read)) = summary(&format!("circles-{file}"), file, &bytes) else { return };
        let found = ["SLIT", "WINDOW"].map(|layer| read["lengths"][layer].as_f64().unwrap());
        // pi r / 2 with r = 2; 2 pi r with r = 3. Six decimals in the SVG, and a few roundings of them.
        let eps = if file.ends_with("svg") { 5e-6 } else { 1e-10 };
        assert!((found[0] - PI).abs() < eps && (found[1] - 6.0 * PI).abs() < eps, "{file}: {found:?}");
        assert_eq!(read["paths"][1]["closed"], true, "{file}");
    }
}

#[test]
fn svg_shows_the_sheet_unmirrored() {
    let ours = layout();
    let Some((_, read)) = summary("svg", "cut.svg", &svg_bytes(&ours, &["a -- b".into()])) else { return };
    assert_eq!(read["size"], serde_json::json!([120.0, 80.5]));
    assert_eq!(read["texts"], serde_json::json!(["dome Ü 1/1 & <up>"]));
    // 9 arcs of ours; the half turn counts 2, the sweep 4 atan 2.5 = 273 degrees 4, the circle's halves 2 each.
    assert_eq!(read["arcs"], 15);
    for kind in [CutKind::Slit, CutKind::Relief, CutKind::Window, CutKind::Border] {
        let expected = length(&ours, kind);
        let found = read["lengths"][format!("{kind:?}").to_uppercase()].as_f64().unwrap();
        // Six decimals; the radius of the flattest arc is 1256 mm for a chord of 50 mm.
        assert!((found - expected).abs() < 2e-5, "{kind:?}: {found}, ours {expected}");
    }
    // Paths whose arcs are not split come back vertex by vertex, with y up and the senses of their arcs; a bulge
    // of 0.01 on a chord of 50 mm is known to 1e-8 from six decimals of the radius.
    let whole: Vec<usize> = vec![0, 1, 4, 5];
    let kept = CutLayout { paths: whole.iter().map(|&i| ours.paths[i].clone()).collect(), ..ours };
    let read = serde_json::json!({ "paths": whole.iter().map(|&i| &read["paths"][i]).collect::<Vec<_>>() });
    assert_same_paths(&read, &kept, 2e-6);
}

#[test]
fn text_cannot_inject_structure() {
    let mut ours = layout();
    let evil =
        "a\r\n  0\r\nLINE\r\n  8\r\nSLIT\n 10\n0\u{2028}b\u{85}c</text><path d=\"M0,0 L9,9\"/>--><rect/>";
    ours.notes[0].text = evil.into();
    let comments = [evil.to_string()];
    let files = [
        ("R2000.dxf", dxf_bytes(&ours, DxfVersion::R2000, &comments)),
        ("R12.dxf", dxf_bytes(&ours, DxfVersion::R12, &comments)),
        ("cut.svg", svg_bytes(&ours, &comments)),
    ];
    for (file, bytes) in files {
        let Some((clean, read)) = summary(&format!("inject-{file}"), file, &bytes) else { return };
        assert!(clean, "{file}: {}", read["reasons"]);
        let total: f64 = read["lengths"].as_object().unwrap().values().map(|v| v.as_f64().unwrap()).sum();
        let kinds = [CutKind::Slit, CutKind::Relief, CutKind::Window, CutKind::Border];
        let expected: f64 = kinds.iter().map(|&kind| length(&ours, kind)).sum();
        assert!((total - expected).abs() < 1e-4, "{file}: cuts were added"); // Six decimals in the SVG.
        assert_eq!(read["texts"].as_array().unwrap().len(), 1);
        assert!(read["texts"][0].as_str().unwrap().starts_with("a    0  LINE"), "{file}: {}", read["texts"]);
    }
}

#[test]
fn faults_leave_nothing_written() {
    let mut ours = layout();
    ours.paths[3].vertices[1].point.y = f64::NAN;
    for version in VERSIONS {
        let mut bytes = Vec::new();
        let error = dxf::write(&ours, version, &["head".into()], &mut bytes).unwrap_err();
        assert!(matches!(error, WriteDxfError::Layout(LayoutFault::NotFinite { path: 3, vertex: 1, .. })));
        assert!(bytes.is_empty());
    }
    let mut bytes = Vec::new();
    assert!(svg::write(&ours, &["head".into()], &mut bytes).is_err());
    assert!(bytes.is_empty());
}

/// All three files in one string of bytes.
fn all_bytes() -> Vec<u8> {
    let comments = ["one".to_string(), "two".to_string()];
    let [r2000, r12] = VERSIONS.map(|version| dxf_bytes(&layout(), version, &comments));
    [r2000, r12, svg_bytes(&layout(), &comments)].concat()
}

const BYTES_FILE: &str = "KIRIMORPH_TEST_BYTES_FILE";

/// Not a test: the other process of the test below.
#[test]
#[ignore = "run by same_bytes_in_every_process_and_time_zone"]
fn write_bytes_for_another_process() {
    if let Some(file) = std::env::var_os(BYTES_FILE) {
        std::fs::write(file, all_bytes()).unwrap();
    }
}

#[test]
fn same_bytes_in_every_process_and_time_zone() {
    let here = all_bytes();
    let folder = peers::fresh_folder("time-zones");
    // Amsterdam's offset in 1900, from which the dxf crate counts dates, was not today's.
    for (index, zone) in ["UTC0", "XYZ-13", "Europe/Amsterdam", "America/New_York"].iter().enumerate() {
        let file = folder.join(format!("{index}.bytes"));
        let status = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "write_bytes_for_another_process", "--ignored", "--quiet"])
            .env("TZ", zone)
            .env(BYTES_FILE, &file)
            .status()
            .unwrap();
        assert!(status.success());
        assert!(std::fs::read(&file).unwrap() == here, "other bytes with TZ={zone}");
    }
}
