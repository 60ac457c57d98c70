//! Sheets that are cut open: exact flat patterns of turning parallelograms, laid out, written, burned on paper and
//! closed again by independent programs.

mod peers;

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::Command;

use kirimorph::fabrication::fabricate::{Fabrication, fabricate, ligament_lengths};
use kirimorph::fabrication::hinge_table::Verdict;
use kirimorph::geometry::{Point3, Vector2, Vector3};
use kirimorph::kirigami::design::{Design, Hinge, PatternKind, Piece, State};
use kirimorph::output::dxf::{self, DxfVersion};
use kirimorph::output::preview::{self, Preview};
use kirimorph::output::{Heading, hinge_report, svg};
use kirimorph::profile::Profile;
use serde_json::{Value, json};

/// Cells a x b of a lattice, closed; each piece turns by `turn` to open. At even corners the slits along b pass, and
/// the hinge points stand half a gap to either side of them; at odd corners those along a.
struct Lattice {
    cells: [i32; 2],
    a: Vector2,
    b: Vector2,
    turn: f64,
    gap: f64,
    present: fn(i32, i32) -> bool,
}

impl Lattice {
    fn even(i: i32, j: i32) -> bool {
        (i + j).rem_euclid(2) == 0
    }

    /// The closed vertex near corner (i, j) of the piece in the cell (p, q).
    fn closed(&self, [i, j]: [i32; 2], [p, q]: [i32; 2]) -> Vector2 {
        let across = |v: Vector2| 0.5 * self.gap * Vector2::new(v.y, -v.x).normalize();
        // To the right of the slits along b, above those along a.
        let shift = match Self::even(i, j) {
            true => {
                if p == i {
                    across(self.b)
                } else {
                    -across(self.b)
                }
            }
            false => {
                if q == j {
                    -across(self.a)
                } else {
                    across(self.a)
                }
            }
        };
        self.a * f64::from(i) + self.b * f64::from(j) + shift
    }

    fn corners([p, q]: [i32; 2]) -> [[i32; 2]; 4] {
        [[p, q], [p + 1, q], [p + 1, q + 1], [p, q + 1]]
    }

    /// The vertex with which a piece hangs on the neighbour in direction (1, 0), (0, 1), (-1, 0) or (0, -1): at the
    /// start of the side for those that turn counter-clockwise.
    fn hinge([p, q]: [i32; 2], [dx, dy]: [i32; 2]) -> usize {
        let side = match [dx, dy] {
            [0, -1] => 0,
            [1, 0] => 1,
            [0, 1] => 2,
            _ => 3,
        };
        if Self::even(p, q) { side } else { (side + 1) % 4 }
    }

    fn turned(&self, cell: [i32; 2], v: Vector2) -> Vector2 {
        let angle = if Self::even(cell[0], cell[1]) { self.turn } else { -self.turn };
        let (sin, cos) = angle.sin_cos();
        Vector2::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y)
    }

    /// What a piece's turned closed vertices are moved by, walking from the first cell along a, then along b.
    fn shift(&self, [p, q]: [i32; 2]) -> Vector2 {
        let mut shift = Vector2::zeros();
        let mut at = [0, 0];
        while at != [p, q] {
            let step = if at[0] < p { [1, 0] } else { [0, 1] };
            let next = [at[0] + step[0], at[1] + step[1]];
            let from = self.closed(Self::corners(at)[Self::hinge(at, step)], at);
            let back = [-step[0], -step[1]];
            let to = self.closed(Self::corners(next)[Self::hinge(next, back)], next);
            shift += self.turned(at, from) - self.turned(next, to);
            at = next;
        }
        shift
    }

    fn design(&self) -> Design {
        let [nx, ny] = self.cells;
        let cells: Vec<[i32; 2]> = (0..ny)
            .flat_map(|q| (0..nx).map(move |p| [p, q]))
            .filter(|&[p, q]| (self.present)(p, q))
            .collect();
        let id: BTreeMap<[i32; 2], usize> = cells.iter().enumerate().map(|(id, &cell)| (cell, id)).collect();
        let mut corner_ids = BTreeMap::new();
        let mut corners = Vec::new();
        let lift = |v: Vector2| Point3::new(v.x, v.y, 0.0);
        let mut pieces = Vec::new();
        for &cell in &cells {
            let around = Self::corners(cell);
            let closed = around.map(|corner| self.closed(corner, cell));
            let open = closed.map(|v| self.turned(cell, v) + self.shift(cell));
            let ids = around.map(|[i, j]| {
                *corner_ids.entry([i, j]).or_insert_with(|| {
                    corners.push(lift(self.a * f64::from(i) + self.b * f64::from(j)));
                    corners.len() - 1
                })
            });
            pieces.push(Piece {
                corners: ids.into(),
                closed: closed.map(lift).into(),
                open: open.map(lift).into(),
            });
        }
        let mut hinges = Vec::new();
        for &cell in &cells {
            for step in [[1, 0], [0, 1]] {
                let next = [cell[0] + step[0], cell[1] + step[1]];
                let Some(&k) = id.get(&next) else { continue };
                let vertices = [Self::hinge(cell, step), Self::hinge(next, [-step[0], -step[1]])];
                let point = pieces[id[&cell]].open[vertices[0]];
                // Closing turns k by twice the angle as j sees it: counter-clockwise where j has turned so to open.
                let axis = if Self::even(cell[0], cell[1]) { Vector3::z() } else { -Vector3::z() };
                hinges.push(Hinge { pieces: [id[&cell], k], vertices, point, axis, angle: 2.0 * self.turn });
            }
        }
        let (pattern, sheet_state) = (PatternKind::RotatingRectangles, Some(State::Open));
        Design { pattern, sheet_state, gap: self.gap, corners, pieces, hinges }
    }
}

fn profile(name: &str) -> Profile {
    kirimorph::profile::load(name, Path::new(".")).unwrap()
}

/// Name, profile and pattern.
fn sheets() -> Vec<(&'static str, Profile, Lattice)> {
    let steel = || profile("steel-304-0.5mm");
    let rubber = || profile("nitrile-rubber-2mm");
    let lattice = |cells, a: [f64; 2], b: [f64; 2], degrees: f64, gap, present| Lattice {
        cells,
        a: a.into(),
        b: b.into(),
        turn: degrees.to_radians(),
        gap,
        present,
    };
    let gap = steel().hinge_gap();
    vec![
        ("square", steel(), lattice([4, 4], [10.0, 0.0], [0.0, 10.0], 45.0, gap, |_, _| true)),
        ("oblong", steel(), lattice([5, 4], [12.0, 0.0], [0.0, 8.0], 43.0, gap, |_, _| true)),
        ("sheared", steel(), lattice([5, 5], [10.0, 0.7], [-0.5, 9.0], 42.0, gap, |_, _| true)),
        (
            "steps",
            steel(),
            lattice([6, 6], [8.0, 0.0], [0.3, 8.0], 44.0, gap, |i, j| {
                i + j >= 2 && i + j < 9 && !(i >= 4 && j == 0)
            }),
        ),
        (
            "hole",
            steel(),
            lattice([7, 6], [9.0, 0.0], [0.0, 8.0], 43.0, gap, |i, j| {
                !((2..5).contains(&i) && (2..4).contains(&j))
            }),
        ),
        ("half", steel(), lattice([4, 4], [10.0, 0.0], [0.0, 10.0], 22.0, gap, |_, _| true)),
        (
            "rubber",
            rubber(),
            lattice([4, 3], [20.0, 0.0], [0.0, 24.0], 42.0, rubber().hinge_gap(), |_, _| true),
        ),
    ]
}

fn made(profile: &Profile, design: &Design) -> Fabrication {
    let lengths = ligament_lengths(design, profile).unwrap();
    fabricate(design, profile, &lengths).unwrap()
}

fn design_json(design: &Design) -> Value {
    let points = |points: &[Point3]| points.iter().map(|p| json!([p.x, p.y, p.z])).collect::<Vec<_>>();
    let pieces = design.pieces.iter().map(|piece| {
        json!({ "corners": piece.corners, "closed": points(&piece.closed), "open": points(&piece.open) })
    });
    let hinges = design.hinges.iter().map(|hinge| {
        json!({ "pieces": hinge.pieces, "vertices": hinge.vertices, "point": points(&[hinge.point])[0],
            "axis": [hinge.axis.x, hinge.axis.y, hinge.axis.z], "angle_deg": hinge.angle.to_degrees() })
    });
    json!({
        "version": 1, "units": "mm", "pattern": "rotating-rectangles", "sheet_state": "open", "gap_mm": design.gap,
        "corners": points(&design.corners), "pieces": pieces.collect::<Vec<_>>(),
        "hinges": hinges.collect::<Vec<_>>(), "report": {},
    })
}

/// Writes the files that the oracles read.
fn write(folder: &Path, made: &Fabrication, profile: &Profile, version: DxfVersion) -> [PathBuf; 3] {
    let files = ["cut.dxf", "hinges.json", "design.json"].map(|name| folder.join(name));
    dxf::write(&made.layout, version, &[], File::create(&files[0]).unwrap()).unwrap();
    hinge_report::write_json(&made.hinges, profile, None, None, File::create(&files[1]).unwrap()).unwrap();
    fs::write(&files[2], design_json(&made.design).to_string()).unwrap();
    files
}

fn summary(command: &mut Command) -> (bool, Value) {
    let output = command.output().unwrap();
    let summary = serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|_| panic!("no summary: {}", String::from_utf8_lossy(&output.stderr)));
    (output.status.success(), summary)
}

#[test]
fn burned_sheets_are_one_body_with_true_ligaments_and_close_without_overlap() {
    for (name, profile, lattice) in sheets() {
        let made = made(&profile, &lattice.design());
        assert!(made.hinges.iter().all(|row| row.verdict == Verdict::Ok), "{name}");
        let kerf = profile.cut.kerf.to_string();
        for version in [DxfVersion::R2000, DxfVersion::R12] {
            let folder = peers::fresh_folder(&format!("open-{name}-{version:?}"));
            let files = write(&folder, &made, &profile, version);
            let Some(mut burn) = peers::oracle("burn.py") else { return };
            let (clean, burned) =
                summary(burn.args(&files).args(["--kerf", &kerf, "--sheet", "1000", "1000"]));
            assert!(clean, "{name}, {version:?}: {burned}");
            assert_eq!((&burned["bodies"], &burned["hinges"]), (&json!(1), &json!(made.hinges.len())));
            for figure in ["worst_width_error_mm", "worst_centre_offset_mm", "worst_neck_loss_mm"] {
                // Walls are straight: what is left is twelve decimals in the file.
                assert!(burned[figure].as_f64().unwrap() < 2e-6, "{name}, {figure}: {burned}");
            }
            let Some(mut close) = peers::oracle("closed_state.py") else { return };
            let (room, closed) = summary(close.args(&files).args(["--kerf", &kerf]));
            assert!(room, "{name}, {version:?}: {closed}");
            assert!(closed["worst_motion_miss_mm"].as_f64().unwrap() < 1e-9, "{name}: {closed}");
            // The sides lie a kerf apart where the gap's wedge begins. Where a flat meets a side without a foot, as on
            // rubber, the root's rounding stands out of the side by 0.08 radii.
            assert!(closed["least_gap_mm"].as_f64().unwrap() > 0.8 * profile.cut.kerf, "{name}: {closed}");
        }
    }
}

#[test]
fn a_piece_that_closes_onto_its_neighbour_is_seen_by_the_oracle_and_refused_by_the_program() {
    let (_, profile, lattice) = sheets().swap_remove(0);
    let mut design = lattice.design();
    let made = made(&profile, &design);
    let folder = peers::fresh_folder("open-overlap");
    let mut spoiled = made.clone();
    let push = |design: &mut Design| {
        design.pieces[5].closed.iter_mut().for_each(|p| *p += Vector3::new(0.2, 0.1, 0.0));
    };
    push(&mut spoiled.design);
    push(&mut design);
    let files = write(&folder, &spoiled, &profile, DxfVersion::R2000);
    let Some(mut close) = peers::oracle("closed_state.py") else { return };
    let (room, closed) = summary(close.args(&files).args(["--kerf", "0.05"]));
    assert!(!room && closed["worst_overlap_mm2"].as_f64().unwrap() > 0.05, "{closed}");
    let lengths = ligament_lengths(&design, &profile).unwrap();
    let error = fabricate(&design, &profile, &lengths).unwrap_err().to_string();
    assert!(error.contains("closed"), "{error}");
}

#[test]
fn check_reads_an_open_design_and_prints_its_hinges() {
    let (_, profile, lattice) = sheets().swap_remove(2);
    let folder = peers::fresh_folder("open-check");
    let mut design = lattice.design();
    // Corners lie on the closed target, here lifted off the sheet.
    design.corners.iter_mut().for_each(|p| p.z += 3.0);
    design.pieces.iter_mut().flat_map(|piece| &mut piece.closed).for_each(|p| p.z += 3.0);
    let check = |value: &Value| {
        let file = folder.join("design.json");
        fs::write(&file, value.to_string()).unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_kirimorph"));
        let output = command.arg("check").arg(&file).args(["--profile", &profile.name]).output().unwrap();
        let text = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
        (output.status.code(), text.concat())
    };
    let good = design_json(&design);
    let (code, text) = check(&good);
    assert_eq!(code, Some(0), "{text}");
    assert!(text.contains("84.0"), "the turning angle: {text}");
    let mut off_sheet = good.clone();
    off_sheet["pieces"][3]["open"][1][2] = json!(0.5);
    let (code, text) = check(&off_sheet);
    assert!(code == Some(1) && text.contains("piece 3, open vertex 1"), "{text}");
    let mut neither = good;
    neither["sheet_state"] = Value::Null;
    // Then the closed state is the frame of reference.
    for (hinge, row) in design.hinges.iter().enumerate() {
        let closed = design.pieces[row.pieces[0]].closed[row.vertices[0]];
        neither["hinges"][hinge]["point"] = json!([closed.x, closed.y, closed.z]);
    }
    let (code, text) = check(&neither);
    assert!(code == Some(2) && text.contains("neither state is flat"), "{text}");
}

#[test]
fn an_open_sheet_has_its_preview_and_drawing() {
    let (_, profile, lattice) = sheets().swap_remove(3);
    let made = made(&profile, &lattice.design());
    let folder = peers::fresh_folder("open-preview");
    let figures = vec![("pieces".to_string(), made.design.pieces.len().to_string())];
    let heading = Heading { name: "steps", target: "flat", profile: &profile, figures: &figures };
    let page = Preview { fabrication: &made, heading, made_from: "cut cut.dxf", groove: "kerf" };
    let mut bytes = Vec::new();
    preview::write(&page, &mut bytes).unwrap();
    fs::write(folder.join("preview.svg"), &bytes).unwrap();
    svg::write(&made.layout, &[], File::create(folder.join("cut.svg")).unwrap()).unwrap();
    let text = String::from_utf8(bytes).unwrap();
    assert!(!text.contains("NaN") && !text.contains("inf"));
    for words in [
        "2  Closed: the upper side",
        "as the sheet closes, turn",
        "Closed, from above",
        "layer WINDOW",
        "It stays nearly flat",
    ] {
        assert!(text.contains(words), "{words}");
    }
    assert!(!text.contains("Opened"));
    let pieces = made.design.pieces.len();
    assert!(text.contains(&format!("hinges: {} ok, 0 warn, 0 fail", made.hinges.len())) && pieces > 20);
}
