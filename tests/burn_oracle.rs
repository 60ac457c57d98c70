//! The independent burner (`tests/oracle/burn.py`) on sheets whose truth is known: clean ones pass, and each
//! seeded fault is caught by the check that is there for it.

mod peers;

use std::fs::{self, File};
use std::path::Path;

use kirimorph::fabrication::fabricate::{fabricate, ligament_lengths};
use kirimorph::fabrication::layout::{CutKind, CutLayout, CutPath, PathVertex};
use kirimorph::kirigami::bistable::cell::BistableCell;
use kirimorph::kirigami::bistable::pattern::regular;
use kirimorph::kirigami::design::State;
use kirimorph::output::dxf::{self, DxfVersion};
use kirimorph::output::hinge_report;
use kirimorph::profile;
use kurbo::{Point, Vec2};
use serde_json::{Value, json};

const KERF: f64 = 0.05;
const WIDTH: f64 = 0.5;
const LENGTH: f64 = 1.2;
const PITCH: f64 = 8.0;
/// Lower left corner of the pattern on the stock.
const ORIGIN: f64 = 10.0;

/// Square pieces of side `PITCH`, closed, `count` by `count`: at the corner (i, j) the slit along x passes where
/// i + j is even and the slits along y end before it, otherwise the other way round.
struct Sheet {
    layout: CutLayout,
    hinges: Value,
    design: Value,
}

fn sheet(count: usize) -> Sheet {
    let side = PITCH * count as f64;
    let mut paths = Vec::new();
    let mut hinges = Vec::new();
    for line in 1..count {
        for along_y in [true, false] {
            cut_grid_line(line, along_y, count, &mut paths, &mut hinges);
        }
    }
    let quarter = (std::f64::consts::PI / 8.0).tan();
    let border =
        [(0.0, 0.0, 0.0), (side - 1.0, 0.0, quarter), (side, 1.0, 0.0), (side, side, 0.0), (0.0, side, 0.0)];
    let border: Vec<PathVertex> =
        border.iter().map(|&(x, y, bulge)| vertex(Point::new(x, y), bulge)).collect();
    paths.push(CutPath { kind: CutKind::Border, vertices: border, closed: true });
    let pieces: Vec<Value> = (0..count * count)
        .map(|k| {
            let [x, y] = [k % count, k / count].map(|i| ORIGIN + PITCH * i as f64);
            let corners =
                [[x, y, 0.0], [x + PITCH, y, 0.0], [x + PITCH, y + PITCH, 0.0], [x, y + PITCH, 0.0]];
            json!({ "closed": corners, "open": corners })
        })
        .collect();
    let points: Vec<Value> = hinges.iter().map(|h: &Value| json!({ "point": h["point"] })).collect();
    Sheet {
        layout: CutLayout {
            sheet: [side + 2.0 * ORIGIN; 2],
            kerf: KERF,
            engravings: vec![],
            paths,
            notes: vec![],
        },
        hinges: json!({ "version": 1, "profile": "test", "hinges": hinges }),
        design: json!({ "version": 1, "sheet_state": "closed", "pieces": pieces, "hinges": points }),
    }
}

fn vertex(point: Point, bulge: f64) -> PathVertex {
    PathVertex { point: point + Vec2::new(ORIGIN, ORIGIN), bulge }
}

/// The slits, relief bars and hinges of one inner grid line, x = line or y = line in pitches.
fn cut_grid_line(
    line: usize,
    along_y: bool,
    count: usize,
    paths: &mut Vec<CutPath>,
    hinges: &mut Vec<Value>,
) {
    let fixed = PITCH * line as f64;
    // A point at `along` the line and `across` to its side.
    let at = |along: f64, across: f64| match along_y {
        true => Point::new(fixed + across, along),
        false => Point::new(along, fixed + across),
    };
    // Slits along y pass the corners of odd parity, slits along x those of even parity.
    let passes = |corner: usize| ((line + corner) % 2 == 1) == along_y;
    for corner in 0..=count {
        let here = PITCH * corner as f64;
        if passes(corner) {
            let from = if corner == 0 { 0.0 } else { here - PITCH + WIDTH + KERF };
            let to = if corner == count { here } else { here + PITCH - WIDTH - KERF };
            let vertices = [at(from, 0.0), at(to, 0.0)].map(|p| vertex(p, 0.0)).to_vec();
            paths.push(CutPath { kind: CutKind::Slit, vertices, closed: false });
            continue;
        }
        for side in [-1.0, 1.0] {
            if (corner == 0 && side < 0.0) || (corner == count && side > 0.0) {
                continue;
            }
            let hinge = vertex(at(here + side * 0.5 * (WIDTH + KERF), 0.0), 0.0).point;
            let id = hinges.len();
            hinges.push(
                json!({ "id": id, "point": [hinge.x, hinge.y, 0.0], "width_mm": WIDTH, "length_mm": LENGTH }),
            );
            paths.push(relief_bar(
                |away, across| at(here + side * (WIDTH + KERF + away), across),
                along_y == (side > 0.0),
            ));
        }
    }
}

/// A bar across the slit's end whose ends turn away from the ligament by a quarter of a small circle. `at` takes
/// the distance from the bar away from the ligament, and across.
fn relief_bar(at: impl Fn(f64, f64) -> Point, turns_left: bool) -> CutPath {
    let (half, radius) = (0.5 * LENGTH, 0.3);
    let quarter = (std::f64::consts::PI / 8.0).tan() * if turns_left { 1.0 } else { -1.0 };
    let vertices = vec![
        vertex(at(radius, -half - radius), quarter),
        vertex(at(0.0, -half), 0.0),
        vertex(at(0.0, half), quarter),
        vertex(at(radius, half + radius), 0.0),
    ];
    CutPath { kind: CutKind::Relief, vertices, closed: false }
}

/// Writes the three files and burns them; returns whether they pass and the burner's summary.
fn burn(folder: &Path, sheet: &Sheet, version: DxfVersion) -> Option<(bool, Value)> {
    let [cut, hinges, design] = ["cut.dxf", "hinges.json", "design.json"].map(|name| folder.join(name));
    let mut oracle = peers::oracle("burn.py")?;
    dxf::write(&sheet.layout, version, &[], File::create(&cut).unwrap()).unwrap();
    fs::write(&hinges, sheet.hinges.to_string()).unwrap();
    fs::write(&design, sheet.design.to_string()).unwrap();
    let [width, height] = sheet.layout.sheet.map(|size| size.to_string());
    let output = oracle
        .args([&cut, &hinges, &design])
        .args(["--kerf", &KERF.to_string(), "--sheet", &width, &height])
        .output()
        .unwrap();
    let summary = serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|_| panic!("no summary: {}", String::from_utf8_lossy(&output.stderr)));
    Some((output.status.success(), summary))
}

#[test]
fn clean_sheets_pass_with_the_designed_widths() {
    for version in [DxfVersion::R2000, DxfVersion::R12] {
        for count in [3, 6] {
            let folder = peers::fresh_folder(&format!("burn-clean-{count}-{version:?}"));
            let Some((clean, summary)) = burn(&folder, &sheet(count), version) else { return };
            assert!(clean, "{version:?}: {summary}");
            assert_eq!(summary["bodies"], 1);
            assert_eq!(summary["pieces"], count * count);
            // One hinge on every inner edge.
            assert_eq!(summary["hinges"], 2 * count * (count - 1));
            for figure in ["worst_width_error_mm", "worst_centre_offset_mm", "worst_neck_loss_mm"] {
                // Walls are straight: what is left is twelve decimals in the file.
                assert!(summary[figure].as_f64().unwrap() < 2e-6, "{figure}: {summary}");
            }
        }
    }
}

/// A change to a clean sheet, and the check that must notice.
type Fault = (&'static str, &'static str, fn(&mut Sheet));

const FAULTS: [Fault; 17] = [
    ("slit-lengthened-into-the-ligament", "ligament width", |s| {
        // 0.1 mm beyond the bar.
        let slit = first(s, CutKind::Slit);
        let [from, to] = [slit.vertices[0].point, slit.vertices[1].point];
        slit.vertices[1].point = to + 0.1 * (to - from).normalize();
    }),
    ("hinge-off-the-middle", "ligament centre", |s| {
        let x = s.hinges["hinges"][0]["point"][1].as_f64().unwrap();
        s.hinges["hinges"][0]["point"][1] = json!(x + 0.03);
    }),
    ("bar-tilted", "ligament neck", |s| {
        // Turned about its middle: the width there stays.
        let bar = first(s, CutKind::Relief);
        let middle = bar.vertices[1].point.midpoint(bar.vertices[2].point);
        let tilt = Vec2::from_angle(0.15);
        for v in &mut bar.vertices {
            let d = v.point - middle;
            v.point = middle + Vec2::new(d.x * tilt.x - d.y * tilt.y, d.x * tilt.y + d.y * tilt.x);
        }
    }),
    ("bar-missing-and-slit-short", "ligament", |s| {
        // The slits of the line end 3 mm early and no bar stands there.
        s.layout.paths.retain(|path| path.kind != CutKind::Relief);
        for path in s.layout.paths.iter_mut().filter(|path| path.kind == CutKind::Slit) {
            let [from, to] = [path.vertices[0].point, path.vertices[1].point];
            path.vertices[0].point = from.lerp(to, 0.25);
            path.vertices[1].point = from.lerp(to, 0.75);
        }
    }),
    ("ligament-cut-through", "ligament", |s| {
        let slit = first(s, CutKind::Slit);
        let [from, to] = [slit.vertices[0].point, slit.vertices[1].point];
        slit.vertices[1].point = to + (WIDTH + KERF) * (to - from).normalize();
    }),
    ("piece-cut-loose", "bodies", |s| {
        let ring = square(ORIGIN + 1.5 * PITCH, 3.0, CutKind::Slit);
        s.layout.paths.insert(0, ring);
    }),
    ("piece-in-a-window", "piece", |s| {
        let ring = square(ORIGIN + 1.5 * PITCH, 2.0, CutKind::Window);
        s.layout.paths.insert(0, ring);
    }),
    ("cut-twice", "duplicate", |s| {
        let twice = first(s, CutKind::Slit).clone();
        s.layout.paths.insert(0, twice);
    }),
    ("cut-twice-backwards", "duplicate", |s| {
        let mut twice = first(s, CutKind::Relief).clone();
        twice.vertices.reverse();
        let bulges: Vec<f64> = twice.vertices.iter().map(|v| -v.bulge).collect();
        for (i, v) in twice.vertices.iter_mut().enumerate() {
            v.bulge = bulges.get(i + 1).copied().unwrap_or(0.0);
        }
        s.layout.paths.insert(0, twice);
    }),
    ("half-a-slit-again", "overlap", |s| {
        let mut again = first(s, CutKind::Slit).clone();
        let [from, to] = [again.vertices[0].point, again.vertices[1].point];
        again.vertices[1].point = from.lerp(to, 0.4);
        again.vertices[0].point = from.lerp(to, 0.1);
        s.layout.paths.insert(0, again);
    }),
    ("slit-again-a-hair-beside", "overlap", |s| {
        let mut again = first(s, CutKind::Slit).clone();
        for v in &mut again.vertices {
            v.point += Vec2::new(5e-4, 5e-4);
        }
        s.layout.paths.insert(0, again);
    }),
    ("slit-folds-back", "overlap", |s| {
        let slit = first(s, CutKind::Slit);
        let [from, to] = [slit.vertices[0].point, slit.vertices[1].point];
        slit.vertices.push(PathVertex { point: to.lerp(from, 0.1), bulge: 0.0 });
    }),
    ("border-first", "border", |s| s.layout.paths.rotate_right(1)),
    ("border-open", "border", |s| first(s, CutKind::Border).closed = false),
    ("border-missing", "border", |s| s.layout.paths.retain(|path| path.kind != CutKind::Border)),
    ("off-the-sheet", "sheet", |s| {
        for v in s.layout.paths.iter_mut().flat_map(|path| &mut path.vertices) {
            v.point.x += ORIGIN + 0.5;
        }
    }),
    ("hinge-forgotten", "hinges", |s| {
        s.hinges["hinges"].as_array_mut().unwrap().pop();
    }),
];

fn first(sheet: &mut Sheet, kind: CutKind) -> &mut CutPath {
    sheet.layout.paths.iter_mut().find(|path| path.kind == kind).unwrap()
}

/// A closed square cut of half side `half` about (centre, centre).
fn square(centre: f64, half: f64, kind: CutKind) -> CutPath {
    let corners = [(-half, -half), (half, -half), (half, half), (-half, half)];
    let at = |(x, y)| PathVertex { point: Point::new(centre + x, centre + y), bulge: 0.0 };
    CutPath { kind, vertices: corners.map(at).to_vec(), closed: true }
}

#[test]
fn every_seeded_fault_is_caught() {
    for (name, check, spoil) in FAULTS {
        // Paths are put together from LINE and ARC in R12; what does not depend on that is burned once.
        let r12 = ["duplicate", "border", "bodies"].contains(&check).then_some(DxfVersion::R12);
        for version in [DxfVersion::R2000].into_iter().chain(r12) {
            let folder = peers::fresh_folder(&format!("burn-{name}-{version:?}"));
            let mut spoiled = sheet(3);
            spoil(&mut spoiled);
            let Some((clean, summary)) = burn(&folder, &spoiled, version) else { return };
            assert!(!clean && summary["ok"] == false, "{name}, {version:?}: passed");
            assert!(summary["failures"][check].as_u64() > Some(0), "{name}, {version:?}: {summary}");
        }
    }
}

#[test]
fn a_file_in_inches_or_with_a_zero_length_line_is_caught() {
    // Our writer refuses to make them, so the text is changed.
    let cases = [
        (DxfVersion::R2000, "$INSUNITS\r\n 70\r\n     4\r\n", "$INSUNITS\r\n 70\r\n     1\r\n", "file"),
        (DxfVersion::R12, " 11\r\n20.0\r\n 21\r\n10.0\r\n", " 11\r\n10.0\r\n 21\r\n10.0\r\n", "zero length"),
    ];
    for (version, good, bad, check) in cases {
        let folder = peers::fresh_folder(&format!("burn-text-{version:?}"));
        let mut made = sheet(3);
        let at = |x| PathVertex { point: Point::new(x, 10.0), bulge: 0.0 };
        made.layout
            .paths
            .insert(0, CutPath { kind: CutKind::Slit, vertices: vec![at(10.0), at(20.0)], closed: false });
        if burn(&folder, &made, version).is_none() {
            return;
        }
        let file = folder.join("cut.dxf");
        let text = fs::read_to_string(&file).unwrap();
        assert!(text.contains(good), "{version:?}");
        fs::write(&file, text.replacen(good, bad, 1)).unwrap();
        let mut oracle = peers::oracle("burn.py").unwrap();
        let files = ["cut.dxf", "hinges.json", "design.json"].map(|name| folder.join(name));
        let output = oracle.args(files).args(["--kerf", "0.05"]).output().unwrap();
        assert_eq!(output.status.code(), Some(1));
        let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert!(summary["failures"][check].as_u64() > Some(0), "{version:?}: {summary}");
    }
}

#[test]
fn bistable_sheets_are_one_body_with_ligaments_as_designed() {
    for (name, size, rectangle, counts) in [
        ("steel-304-0.5mm", [12.0, 11.0], [4.4, 3.6], [4, 3]),
        ("nylon-6-5mm", [24.0, 24.0], [7.5, 7.0], [3, 4]),
    ] {
        let profile = profile::load(name, Path::new("")).unwrap();
        let gap = profile.hinge_gap();
        let cell = BistableCell { cell: size, rectangle, phi: 18_f64.to_radians(), gap };
        let (mesh, pattern) = regular(&cell, counts);
        let design = pattern.design(&mesh, gap, Some(State::Closed));
        let made = fabricate(&design, &profile, &ligament_lengths(&design, &profile).unwrap()).unwrap();
        let folder = peers::fresh_folder(&format!("burn-bistable-{name}"));
        let files = ["cut.dxf", "hinges.json", "design.json"].map(|name| folder.join(name));
        dxf::write(&made.layout, DxfVersion::R2000, &[], File::create(&files[0]).unwrap()).unwrap();
        hinge_report::write_json(&made.hinges, &profile, None, None, File::create(&files[1]).unwrap())
            .unwrap();
        let pieces: Vec<Value> = made
            .design
            .pieces
            .iter()
            .map(
                |piece| json!({ "closed": piece.closed.iter().map(|p| [p.x, p.y, p.z]).collect::<Vec<_>>() }),
            )
            .collect();
        let points: Vec<Value> = made
            .design
            .hinges
            .iter()
            .map(|hinge| json!({ "point": [hinge.point.x, hinge.point.y, hinge.point.z] }))
            .collect();
        let text = json!({ "version": 1, "sheet_state": "closed", "pieces": pieces, "hinges": points });
        fs::write(&files[2], text.to_string()).unwrap();
        let Some(mut oracle) = peers::oracle("burn.py") else { return };
        let kerf = profile.cut.kerf.to_string();
        let output = oracle.args(&files).args(["--kerf", &kerf, "--sheet", "1000", "1000"]).output().unwrap();
        let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert!(output.status.success(), "{name}: {summary}");
        assert_eq!((&summary["bodies"], &summary["hinges"]), (&json!(1), &json!(made.hinges.len())));
        assert_eq!(summary["pieces"], made.design.pieces.len());
        for figure in ["worst_width_error_mm", "worst_centre_offset_mm", "worst_neck_loss_mm"] {
            // A round end is a polygon within a tenth of a micrometre to the burner.
            assert!(summary[figure].as_f64().unwrap() < 1e-3, "{figure}: {summary}");
        }
    }
}
