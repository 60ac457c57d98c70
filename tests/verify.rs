//! `verify` on the samples' machine files: unharmed ones pass with the designed figures, and each seeded fault is caught
//! by the check that is there for it.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use kirimorph::fabrication::fabricate::Fabrication;
use kirimorph::fabrication::layout::{CutKind, CutLayout, CutPath, PathVertex};
use kirimorph::fabrication::product::Product;
use kirimorph::job::read_job;
use kirimorph::output::dxf::{self, DxfVersion};
use kirimorph::output::svg;
use kirimorph::pipeline::{self, Clock, Progress};
use kirimorph::profile::Profile;
use kirimorph::verify::{Check, Fault, Files, ONE_PART, Verified, Wanted, hash_comment, verify};
use kurbo::{Point, Vec2};

const HASH: &str = "fnv1a64:0123456789abcdef";

/// A sample's sheet, as `make` lays it out.
struct Sample {
    sheet: Fabrication,
    profile: Profile,
}

fn sample_file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("samples").join(format!("{name}.toml"))
}

fn sample(name: &str) -> Sample {
    let job = read_job(&sample_file(name)).unwrap();
    let mut watch = |_: &Progress| ControlFlow::Continue(());
    match pipeline::make(&job, &mut Clock::new(&mut watch)).unwrap().product {
        Product::Sheet(sheet) => Sample { sheet, profile: job.fabrication.profile },
        Product::Assembly(_) => panic!("{name} has no sheet"),
    }
}

static CLOSED: LazyLock<Sample> = LazyLock::new(|| sample("dome"));
static OPEN: LazyLock<Sample> = LazyLock::new(|| sample("closing"));

impl Sample {
    fn dxf(&self, layout: &CutLayout, version: DxfVersion, hash: &str) -> Vec<u8> {
        let mut bytes = Vec::new();
        dxf::write(layout, version, &[hash_comment(hash)], &mut bytes).unwrap();
        bytes
    }

    fn svg(&self, layout: &CutLayout, hash: &str) -> Vec<u8> {
        let mut bytes = Vec::new();
        svg::write(layout, &[hash_comment(hash)], &mut bytes).unwrap();
        bytes
    }

    fn verify(&self, dxf: &[u8], svg: &[u8]) -> Verified {
        let wanted = Wanted {
            design: &self.sheet.design,
            profile: &self.profile,
            hash: HASH,
            copies: &ONE_PART,
            tabs: None,
        };
        verify(Files { dxf, svg }, wanted).unwrap()
    }

    /// The faults of both files written from a layout.
    fn faults_of(&self, layout: &CutLayout, version: DxfVersion) -> Vec<Fault> {
        self.verify(&self.dxf(layout, version, HASH), &self.svg(layout, HASH)).faults
    }
}

#[test]
fn unharmed_sheets_pass_with_the_designed_figures() {
    for sample in [&*CLOSED, &*OPEN] {
        let layout = &sample.sheet.layout;
        for version in [DxfVersion::R2000, DxfVersion::R12] {
            let verified = sample.verify(&sample.dxf(layout, version, HASH), &sample.svg(layout, HASH));
            assert_eq!(verified.faults, [], "{version:?}");
            let figures = verified.figures.unwrap();
            assert_eq!((figures.bodies, figures.pieces_held), (1, sample.sheet.design.pieces.len()));
            let [least, most, neck] = figures.ligament_widths;
            // What the layout's own measuring says, to the twelve decimals of the file and the flattening of arcs.
            let widths = sample.sheet.hinges.iter().map(|row| row.width);
            let [low, high] = widths.fold([f64::INFINITY, 0.0], |[l, h], w| [l.min(w), h.max(w)]);
            assert!((neck - low).abs() < 6e-4 && least >= neck && most <= high + 6e-4, "{figures:?}");
            let off = sample.sheet.hinges.iter().map(|row| row.centre_offset).fold(0.0, f64::max);
            assert!((figures.ligament_centre[0] - off).abs() < 6e-4, "{figures:?}");
            // The SVG has six decimals.
            assert!(figures.files_apart > 0.0 && figures.files_apart < 1e-6);
            assert!((figures.stock_distance - sample.profile.sheet.margin).abs() < 1e-6);
        }
    }
}

/// The name of a seeded fault, the checks of which one must notice, and the change.
type Seed = (&'static str, &'static [Check], fn(&mut CutLayout, &Sample));

const CLOSED_SEEDS: [Seed; 21] = [
    // One of its ends is at the border.
    ("first slit longer at its end", &[Check::Ligament, Check::End], |layout, _| {
        lengthen(layout, 0, 0.1, true);
    }),
    ("first slit longer at its start", &[Check::Ligament, Check::End], |layout, _| {
        lengthen(layout, 0, 0.1, false);
    }),
    ("inner slit longer at its end", &[Check::Ligament], |layout, _| {
        lengthen(layout, inner_slit(layout), 0.1, true)
    }),
    ("inner slit longer at its start", &[Check::Ligament], |layout, _| {
        lengthen(layout, inner_slit(layout), 0.1, false)
    }),
    ("slit missing", &[Check::Piece], |layout, _| _ = layout.paths.remove(nth(layout, CutKind::Slit, 100))),
    ("bar missing", &[Check::Ligament], |layout, _| {
        _ = layout.paths.remove(nth(layout, CutKind::Relief, 100))
    }),
    ("bar moved along itself", &[Check::Ligament], |layout, _| {
        let bar = nth(layout, CutKind::Relief, 100);
        let vertices = &layout.paths[bar].vertices;
        let along = (vertices[1].point - vertices[0].point).normalize();
        moved(&mut layout.paths[bar], |p| p + 0.1 * along);
    }),
    ("slit cut twice", &[Check::Duplicate], |layout, _| again(layout, CutKind::Slit, |path| path)),
    ("bar cut twice", &[Check::Duplicate], |layout, _| again(layout, CutKind::Relief, |path| path)),
    ("slit cut twice, the second time backwards", &[Check::Duplicate], |layout, _| {
        again(layout, CutKind::Slit, backwards);
    }),
    ("half a slit again", &[Check::Overlap], |layout, _| {
        again(layout, CutKind::Slit, |mut path| {
            let to = path.vertices[0].point.midpoint(path.vertices[1].point);
            path.vertices.truncate(2);
            path.vertices[1].point = to;
            path
        });
    }),
    ("border in inches", &[Check::Body], |layout, _| {
        let border = nth(layout, CutKind::Border, 0);
        moved(&mut layout.paths[border], |p| (p.to_vec2() / 25.4).to_point());
    }),
    ("border not last", &[Check::Border], |layout, _| layout.paths.rotate_right(1)),
    ("border open", &[Check::Border], |layout, _| {
        let border = nth(layout, CutKind::Border, 0);
        layout.paths[border].closed = false;
        let last = layout.paths[border].vertices.last_mut().unwrap();
        last.bulge = 0.0;
    }),
    ("border missing", &[Check::Border], |layout, _| _ = layout.paths.pop()),
    ("ligament cut through by its slit", &[Check::Ligament], |layout, _| lengthen(layout, 300, 0.6, true)),
    ("layer of bars moved", &[Check::Ligament], |layout, _| {
        for path in layout.paths.iter_mut().filter(|path| path.kind == CutKind::Relief) {
            moved(path, |p| p + Vec2::new(0.1, 0.0));
        }
    }),
    ("bars on the layer of windows", &[Check::Border], |layout, _| {
        layout.paths.iter_mut().filter(|p| p.kind == CutKind::Relief).for_each(|p| p.kind = CutKind::Window);
    }),
    ("piece cut loose", &[Check::Body], |layout, sample| {
        // A square whose last point comes back to its first.
        let piece = &sample.sheet.design.pieces[200].closed;
        let middle = Point::new(0.5 * (piece[0].x + piece[2].x), 0.5 * (piece[0].y + piece[2].y));
        let corners = [(-2.0, -2.0), (2.0, -2.0), (2.0, 2.0), (-2.0, 2.0), (-2.0, -1.98)];
        let points = corners.map(|(x, y)| middle + Vec2::new(x, y));
        layout.paths.insert(0, CutPath { kind: CutKind::Slit, vertices: straight(&points), closed: false });
    }),
    ("all of it off the stock", &[Check::Stock], |layout, _| {
        layout.paths.iter_mut().for_each(|path| moved(path, |p| p - Vec2::new(5.5, 0.0)));
    }),
    ("a segment of a micrometre", &[Check::Segment], |layout, _| {
        let slit = &mut layout.paths[0];
        let [from, to] = [slit.vertices[0].point, slit.vertices[1].point];
        let at = from + 2e-3 * (to - from).normalize();
        slit.vertices.insert(1, PathVertex { point: at, bulge: 0.0 });
    }),
];

const OPEN_SEEDS: [Seed; 9] = [
    ("window missing", &[Check::Piece], |layout, _| {
        _ = layout.paths.remove(nth(layout, CutKind::Window, 100));
    }),
    ("window cut twice, the second time backwards", &[Check::Duplicate], |layout, _| {
        again(layout, CutKind::Window, backwards);
    }),
    ("window on the wrong side of its offset, outside", &[Check::Piece], |layout, sample| {
        offset_window(layout, sample.profile.cut.kerf);
    }),
    ("window on the wrong side of its offset, inside", &[Check::Piece], |layout, sample| {
        offset_window(layout, -sample.profile.cut.kerf);
    }),
    ("ligament cut through between two windows", &[Check::Ligament], |layout, sample| {
        let hinge = &sample.sheet.design.hinges[100];
        let at = Point::new(hinge.point.x, hinge.point.y);
        let reach = 1.2 * (sample.profile.ligament.width + sample.profile.cut.kerf);
        let ends = [at - Vec2::new(reach, 0.0), at + Vec2::new(reach, 0.0)];
        layout.paths.insert(0, CutPath { kind: CutKind::Slit, vertices: straight(&ends), closed: false });
    }),
    ("border in inches", &[Check::Body], |layout, _| {
        let border = nth(layout, CutKind::Border, 0);
        moved(&mut layout.paths[border], |p| (p.to_vec2() / 25.4).to_point());
    }),
    ("border not last", &[Check::Border], |layout, _| layout.paths.rotate_right(1)),
    ("layer of windows moved", &[Check::Piece], |layout, _| {
        for path in layout.paths.iter_mut().filter(|path| path.kind == CutKind::Window) {
            moved(path, |p| p + Vec2::new(0.0, 0.1));
        }
    }),
    ("window around a piece", &[Check::Body], |layout, sample| {
        let piece = &sample.sheet.design.pieces[200].open;
        let points: Vec<Point> = piece.iter().map(|p| Point::new(p.x, p.y)).collect();
        layout.paths.insert(0, CutPath { kind: CutKind::Window, vertices: straight(&points), closed: true });
    }),
];

/// The index of the n-th cut of a kind.
fn nth(layout: &CutLayout, kind: CutKind, n: usize) -> usize {
    let of_kind = layout.paths.iter().enumerate().filter(|(_, path)| path.kind == kind);
    of_kind.map(|(index, _)| index).nth(n).unwrap()
}

/// Number of a slit that has a relief bar at both ends.
fn inner_slit(layout: &CutLayout) -> usize {
    let of = |kind: CutKind| layout.paths.iter().filter(move |path| path.kind == kind);
    let ends = |path: &CutPath| [path.vertices[0].point, path.vertices[path.vertices.len() - 1].point];
    let middles: Vec<Point> = of(CutKind::Relief).map(ends).map(|[a, b]| a.midpoint(b)).collect();
    let has_bars = |path: &CutPath| {
        ends(path).iter().all(|end| middles.iter().any(|middle| middle.distance(*end) < 1e-6))
    };
    of(CutKind::Slit).position(has_bars).unwrap()
}

/// Lengthens the n-th slit at one end.
fn lengthen(layout: &mut CutLayout, n: usize, by: f64, at_end: bool) {
    let slit = nth(layout, CutKind::Slit, n);
    let vertices = &mut layout.paths[slit].vertices;
    let last = vertices.len() - 1;
    let (end, before) = if at_end { (last, last - 1) } else { (0, 1) };
    let along = (vertices[end].point - vertices[before].point).normalize();
    vertices[end].point += by * along;
}

/// Puts a changed copy of the 50th cut of a kind before all others.
fn again(layout: &mut CutLayout, kind: CutKind, change: fn(CutPath) -> CutPath) {
    let path = layout.paths[nth(layout, kind, 50)].clone();
    layout.paths.insert(0, change(path));
}

/// The same cut in the other direction.
fn backwards(mut path: CutPath) -> CutPath {
    let count = path.vertices.len();
    let bulges: Vec<f64> = path.vertices.iter().map(|vertex| -vertex.bulge).collect();
    path.vertices.reverse();
    for (i, vertex) in path.vertices.iter_mut().enumerate() {
        // The segment that left vertex k now leaves the vertex after it.
        vertex.bulge = bulges[(2 * count - 2 - i) % count];
    }
    path
}

fn moved(path: &mut CutPath, by: impl Fn(Point) -> Point) {
    path.vertices.iter_mut().for_each(|vertex| vertex.point = by(vertex.point));
}

fn straight(points: &[Point]) -> Vec<PathVertex> {
    points.iter().map(|&point| PathVertex { point, bulge: 0.0 }).collect()
}

/// Moves the sides of the hundredth window outwards by about so much.
fn offset_window(layout: &mut CutLayout, by: f64) {
    let window = nth(layout, CutKind::Window, 100);
    let path = &mut layout.paths[window];
    let points: Vec<Point> = path.vertices.iter().map(|vertex| vertex.point).collect();
    let sum = points.iter().fold(Vec2::ZERO, |sum, point| sum + point.to_vec2());
    let middle = (sum / points.len() as f64).to_point();
    // Half the radius of a square is a little less than the distance of its sides, times the root of two.
    let radius = points.iter().map(|point| point.distance(middle)).fold(0.0, f64::max);
    moved(path, |point| middle + (1.0 + by * 1.5 / radius) * (point - middle));
}

#[test]
fn every_seeded_fault_is_caught_in_both_kinds_of_sheet() {
    let mut missed = Vec::new();
    for (sample, seeds) in [(&*CLOSED, &CLOSED_SEEDS[..]), (&*OPEN, &OPEN_SEEDS[..])] {
        let unharmed = sample.dxf(&sample.sheet.layout, DxfVersion::R2000, HASH);
        for (name, checks, spoil) in seeds {
            let mut layout = sample.sheet.layout.clone();
            spoil(&mut layout, sample);
            let both = sample.faults_of(&layout, DxfVersion::R2000);
            // In the SVG alone it is caught as well.
            let one = sample.verify(&unharmed, &sample.svg(&layout, HASH)).faults;
            for (faults, file) in [(&both, "cut.dxf"), (&one, "cut.svg")] {
                if !faults.iter().any(|fault| checks.contains(&fault.check) && fault.file == file) {
                    missed.push(format!("{name}, {file}: {:#?}", &faults[..faults.len().min(3)]));
                }
            }
            assert!(one.iter().any(|fault| fault.check == Check::Agreement), "{name}: {one:#?}");
        }
    }
    assert!(missed.is_empty(), "{}", missed.join("\n"));
}

#[test]
fn a_fault_names_its_cut_or_hinge_its_place_and_its_value() {
    let mut layout = CLOSED.sheet.layout.clone();
    lengthen(&mut layout, 300, 0.1, true);
    let faults = CLOSED.faults_of(&layout, DxfVersion::R2000);
    let ligaments: Vec<&Fault> = faults.iter().filter(|fault| fault.check == Check::Ligament).collect();
    // Its width and its centre, and that the slit goes on where nothing should be cut; nothing else is wrong.
    assert_eq!((faults.len(), ligaments.len()), (3, 2), "{faults:#?}");
    let stray = faults.iter().find(|fault| fault.check == Check::Piece).unwrap().to_string();
    assert!(stray.contains("runs 0.100 mm from where the nearest cut should be"), "{stray}");
    let slit = &layout.paths[nth(&layout, CutKind::Slit, 300)].vertices;
    let at = ligaments[0].at.unwrap();
    assert!(at.distance(slit[slit.len() - 1].point) < 0.3);
    let text = ligaments[0].to_string();
    for part in ["cut.dxf: hinge ", " is 0.400 mm wide, the limit is 0.5 +- 0.01 mm"] {
        assert!(text.contains(part), "{text}");
    }
    assert!(ligaments[1].to_string().contains(" is 0.050 mm off the hinge point"), "{}", ligaments[1]);
}

/// The sample with a changed text in one file.
fn changed(file: &[u8], from: &str, to: &str) -> Vec<u8> {
    let text = std::str::from_utf8(file).unwrap();
    assert!(text.contains(from), "{from:?}");
    text.replacen(from, to, 1).into_bytes()
}

#[test]
fn wrong_units_layers_numbers_and_hashes_are_caught() {
    let layout = &CLOSED.sheet.layout;
    let dxf = CLOSED.dxf(layout, DxfVersion::R2000, HASH);
    let svg = CLOSED.svg(layout, HASH);
    let text = std::str::from_utf8(&dxf).unwrap();
    let entities = text.find("ENTITIES").unwrap();
    let x = text[entities..].find("\r\n 10\r\n").unwrap() + entities + 7;
    let number = text[x..].lines().next().unwrap();
    let in_dxf = [
        (
            Check::Units,
            "$INSUNITS\r\n 70\r\n     4\r\n",
            "$INSUNITS\r\n 70\r\n     1\r\n".to_owned(),
            "inches",
        ),
        (
            Check::Layer,
            "100\r\nAcDbEntity\r\n  8\r\nSLIT\r\n",
            "100\r\nAcDbEntity\r\n  8\r\n0\r\n".to_owned(),
            "layer 0",
        ),
        (Check::Layer, "  0\r\nLWPOLYLINE\r\n", "  0\r\nSPLINE\r\n".to_owned(), "SPLINE"),
        (Check::Numbers, number, "NaN".to_owned(), "NaN"),
        (Check::Numbers, number, "inf".to_owned(), "inf"),
        (Check::Design, HASH, "fnv1a64:fedcba9876543210".to_owned(), "fedcba9876543210"),
    ];
    for (check, from, to, says) in in_dxf {
        let faults = CLOSED.verify(&changed(&dxf, from, &to), &svg).faults;
        let caught = faults.iter().find(|fault| fault.check == check && fault.file == "cut.dxf");
        let caught = caught.unwrap_or_else(|| panic!("{to}: {faults:#?}")).to_string();
        assert!(caught.contains(says), "{caught}");
    }
    let in_svg = [
        (Check::Units, "width=\"1000mm\"", "width=\"1000\"", "width"),
        (Check::Units, "viewBox=\"0 0 1000 1000\"", "viewBox=\"0 0 39.37 39.37\"", "viewBox"),
        (Check::Layer, "class=\"slit\"", "class=\"engraving\"", "engraving"),
        (Check::Layer, "stroke=\"#ff0000\"", "stroke=\"#000000\"", "#000000"),
        (Check::Layer, "class=\"slit\"", "class=\"slit\" transform=\"scale(2)\"", "scale(2)"),
        (Check::Numbers, "d=\"M", "d=\"MNaN,NaN L", "NaN"),
        (Check::Design, HASH, "fnv1a64:fedcba9876543210", "fedcba9876543210"),
    ];
    for (check, from, to, says) in in_svg {
        let faults = CLOSED.verify(&dxf, &changed(&svg, from, to)).faults;
        let caught = faults.iter().find(|fault| fault.check == check && fault.file == "cut.svg");
        let caught = caught.unwrap_or_else(|| panic!("{to}: {faults:#?}")).to_string();
        assert!(caught.contains(says), "{caught}");
    }
}

#[test]
fn what_is_no_drawing_cannot_be_read() {
    let layout = &CLOSED.sheet.layout;
    let dxf = CLOSED.dxf(layout, DxfVersion::R2000, HASH);
    let svg = CLOSED.svg(layout, HASH);
    let wanted = Wanted {
        design: &CLOSED.sheet.design,
        profile: &CLOSED.profile,
        hash: HASH,
        copies: &ONE_PART,
        tabs: None,
    };
    let reason = |dxf: &[u8], svg: &[u8]| verify(Files { dxf, svg }, wanted).unwrap_err().to_string();
    for bad in [&dxf[..dxf.len() / 2], b"", b"\x89PNG\r\n\x1a\n", b"solid x\nendsolid x\n"] {
        assert!(reason(bad, &svg).starts_with("cut.dxf"), "{}", reason(bad, &svg));
    }
    for bad in [&svg[..svg.len() / 2], b"", b"\x89PNG", b"<svg><path d=\"M0 0 C 1 1 2 2 3 3\"/></svg>"] {
        assert!(reason(&dxf, bad).starts_with("cut.svg"), "{}", reason(&dxf, bad));
    }
}
