//! Thick sheets against closed forms, read back and sliced by code of its own.

use std::collections::HashMap;
use std::f64::consts::FRAC_PI_2;

use nalgebra::{Rotation3, Unit};

use super::error::SolidError;
use super::loft::loft;
use super::outline::plate;
use super::rulings::Rulings;
use super::strokes::Strokes;
use super::{ThickSheet, Walls, placed, thicken};
use crate::fabrication::fabricate::{Fabrication, fabricate, ligament_lengths};
use crate::fabrication::hinge_table::HingeRow;
use crate::fabrication::outline::burned_bodies;
use crate::fabrication::test_sheet::{TestSheet, cut_open, profile, sheets};
use crate::geometry::mesh::TriMesh;
use crate::geometry::{Point3, Vector3};
use crate::kirigami::design::Design;
use crate::profile::{Beam, Profile, Shape};

/// Half a grid of coordinates below 256 mm, moved by up to a turn: rounding of the outlines.
const GRID: f64 = 2e-5;

fn made(design: &Design, profile: &Profile) -> Fabrication {
    fabricate(design, profile, &ligament_lengths(design, profile).unwrap()).unwrap()
}

/// 5 mm nylon and a tool of 1 mm.
fn milled() -> Profile {
    let mut profile = profile();
    profile.sheet.thickness = 5.0;
    profile.cut.kerf = 1.0;
    profile.ligament.shape = Shape::Beam(Beam { min_length: 1.5, max_length: 2.0, root_compliance: 1.2 });
    profile
}

/// Every side of a triangle has exactly one counterpart, the other way round.
fn assert_closed(mesh: &TriMesh) {
    let mut sides: HashMap<[usize; 2], u8> = HashMap::new();
    for face in &mesh.faces {
        for k in 0..3 {
            let [a, b] = [face[k], face[(k + 1) % 3]];
            assert_ne!(a, b);
            // A bit for either direction: twice the same way does not pass for there and back.
            let (key, way) = if a < b { ([a, b], 1) } else { ([b, a], 2) };
            let uses = sides.entry(key).or_insert(0);
            assert!(*uses & way == 0, "side {key:?} is used twice the same way");
            *uses |= way;
        }
    }
    assert!(sides.values().all(|&uses| uses == 3), "a side is open");
    let mut used = vec![false; mesh.vertices.len()];
    mesh.faces.iter().flatten().for_each(|&v| used[v] = true);
    assert!(used.into_iter().all(|used| used));
}

/// The file that is written, read again.
fn read_back(mesh: &TriMesh) -> TriMesh {
    let mut bytes = Vec::new();
    crate::output::exchange::write_stl(mesh.triangles(), &mut bytes).unwrap();
    let read = stl_io::read_stl(&mut std::io::Cursor::new(bytes)).unwrap();
    let point = |v: &stl_io::Vertex| Point3::from(v.0.map(f64::from));
    TriMesh {
        vertices: read.vertices.iter().map(point).collect(),
        faces: read.faces.iter().map(|face| face.vertices).collect(),
    }
}

fn volume(mesh: &TriMesh) -> f64 {
    mesh.triangles().map(|[a, b, c]| a.coords.dot(&b.coords.cross(&c.coords)) / 6.0).sum()
}

/// Number of connected parts.
fn shells(mesh: &TriMesh) -> usize {
    let mut root: Vec<usize> = (0..mesh.vertices.len()).collect();
    fn find(root: &mut [usize], mut v: usize) -> usize {
        while root[v] != v {
            root[v] = root[root[v]];
            v = root[v];
        }
        v
    }
    for face in &mesh.faces {
        for k in 1..3 {
            let (a, b) = (find(&mut root, face[0]), find(&mut root, face[k]));
            root[a] = b;
        }
    }
    (0..root.len()).filter(|&v| root[v] == v).count()
}

/// The line segments in which a mesh meets the plane at a height where it has no vertex.
fn slice(mesh: &TriMesh, z: f64) -> Vec<[[f64; 2]; 2]> {
    let cut = |[p, q]: [Point3; 2]| {
        let part = (z - p.z) / (q.z - p.z);
        [p.x + part * (q.x - p.x), p.y + part * (q.y - p.y)]
    };
    let crossing = |triangle: [Point3; 3]| {
        let sides = [0, 1, 2].map(|k| [triangle[k], triangle[(k + 1) % 3]]);
        let cuts: Vec<[f64; 2]> =
            sides.into_iter().filter(|[p, q]| (p.z < z) != (q.z < z)).map(cut).collect();
        (cuts.len() == 2).then(|| [cuts[0], cuts[1]])
    };
    mesh.triangles().filter_map(crossing).collect()
}

/// How far a slice is from a point along a unit direction.
fn free_way(slice: &[[[f64; 2]; 2]], from: [f64; 2], along: [f64; 2]) -> f64 {
    let side = |p: [f64; 2]| along[0] * (p[1] - from[1]) - along[1] * (p[0] - from[0]);
    let ahead = |p: [f64; 2]| along[0] * (p[0] - from[0]) + along[1] * (p[1] - from[1]);
    let ways = slice.iter().filter_map(|&[p, q]| {
        let (a, b) = (side(p), side(q));
        ((a < 0.0) != (b < 0.0)).then(|| ahead(p) + a / (a - b) * (ahead(q) - ahead(p)))
    });
    ways.filter(|way| *way > 0.0).fold(f64::INFINITY, f64::min)
}

/// Largest distance between the middles of the necks and their axes at a height, over all hinges and along
/// the inner third of each ligament, which a tool of 1 mm leaves straight; and the largest deviation of the
/// necks' widths.
fn neck_errors(mesh: &TriMesh, rows: &[HingeRow], z: f64) -> [f64; 2] {
    let slice = slice(mesh, z);
    let mut worst = [0.0_f64; 2];
    for row in rows {
        let centre = [row.point.x + z * row.axis.x / row.axis.z, row.point.y + z * row.axis.y / row.axis.z];
        // Ligaments of lattices lie along x or along y: across is the nearer way out.
        let ways = [[1.0, 0.0], [0.0, 1.0]]
            .map(|[x, y]| [free_way(&slice, centre, [x, y]), free_way(&slice, centre, [-x, -y])]);
        let across = usize::from(ways[1][0] + ways[1][1] < ways[0][0] + ways[0][1]);
        for part in [-0.15, 0.0, 0.15] {
            let mut at = centre;
            at[1 - across] += part * row.length;
            let direction = if across == 0 { [1.0, 0.0] } else { [0.0, 1.0] };
            let [there, back] =
                [1.0, -1.0].map(|sign| free_way(&slice, at, direction.map(|c: f64| sign * c)));
            worst[0] = worst[0].max(0.5 * (there - back).abs());
            worst[1] = worst[1].max((there + back - row.width).abs());
        }
    }
    worst
}

/// Two pieces side by side, one of which turns about an axis that tilts by these slopes (dx/dz, dy/dz).
fn two_pieces(lean: [f64; 2], angle: f64) -> Design {
    let sheet = TestSheet::rectangle([2, 1], [14.0, 11.0], 0.0);
    let mut design = sheet.design(0.5 * angle);
    let hinge = &mut design.hinges[0];
    let up = Vector3::new(lean[0], lean[1], 1.0) * hinge.axis.z.signum();
    hinge.axis = up.normalize();
    let turn = Rotation3::from_axis_angle(&Unit::new_normalize(up), angle);
    let [still, turned] = hinge.pieces;
    design.pieces[still].open = design.pieces[still].closed.clone();
    let point = hinge.point;
    let piece = &mut design.pieces[turned];
    piece.open = piece.closed.iter().map(|p| point + turn * (p - point)).collect();
    design
}

#[test]
fn a_lasered_part_is_closed_and_holds_its_area_times_its_thickness() {
    for (sheet, phi) in sheets() {
        let closed = sheet.design(phi);
        for design in [cut_open(closed.clone()), closed] {
            let profile =
                Profile { sheet: crate::profile::Sheet { thickness: 0.7, ..profile().sheet }, ..profile() };
            let Ok(lengths) = ligament_lengths(&design, &profile) else { continue };
            let Ok(sheet) = fabricate(&design, &profile, &lengths) else { continue };
            let ThickSheet { part, volume: told, moved, axis_error, clash } =
                thicken(&sheet, 0.7, Walls::Vertical).unwrap();
            assert_closed(&part);
            assert_closed(&moved);
            assert_eq!([shells(&part), shells(&moved)], [1, design.pieces.len()]);
            let part = read_back(&part);
            // Vertices that were apart are still apart, and faces where they were but for the height in
            // single precision.
            assert_closed(&part);
            assert!(axis_error < 1e-12 && clash.is_none_or(|clash| clash.depth < 1e-3), "{clash:?}");
            let burned: f64 = crate::fabrication::outline::burned_bodies(&sheet.layout.paths, 0.05)
                .iter()
                .flatten()
                .map(|contour| crate::fabrication::outline::area(contour))
                .sum();
            // Outlines may be off by the tolerance, to the inside at one bend and to the outside at the next.
            let cuts: f64 = sheet
                .layout
                .paths
                .iter()
                .flat_map(|path| path.segments(1e-3))
                .map(|[a, b]| a.distance(b))
                .sum();
            assert!((told / 0.7 - burned).abs() < 2.0 * cuts * super::outline::TOLERANCE, "{told} {burned}");
            assert!((volume(&part) / told - 1.0).abs() < 1e-6, "{} {told}", volume(&part));
        }
    }
}

#[test]
fn pieces_are_congruent_in_both_states() {
    let sheet = made(&sheets()[0].0.design(0.5), &profile());
    let thick = thicken(&sheet, 0.5, Walls::Vertical).unwrap();
    let pieces = placed(&sheet, |plate| plate).unwrap();
    let mut start = 0;
    for (piece, outline) in pieces.iter().zip(&sheet.outlines) {
        let points = &piece.plate.outlines[0].points;
        let vertices = &thick.moved.vertices[start..start + 2 * points.len()];
        start += vertices.len();
        let n = points.len();
        for i in 0..n {
            let j = (i + n / 3) % n;
            let wide = (points[i][0] - points[j][0]).hypot(points[i][1] - points[j][1]);
            // Rounding of coordinates of some 100 mm.
            assert!(((vertices[i] - vertices[j]).norm() - wide).abs() < 1e-11);
            assert!(((vertices[i] - vertices[n + j]).norm() - wide.hypot(0.5)).abs() < 1e-11);
        }
        let area = crate::fabrication::outline::area(outline);
        assert!((piece.plate.area(0.0) / area - 1.0).abs() < 1e-3);
    }
    assert_eq!(start, thick.moved.vertices.len());
}

#[test]
fn a_ruled_neck_is_centred_on_its_tilted_axis_at_every_depth() {
    // Seven degrees along the ligament, four across it.
    let (lean, angle) = ([0.12, -0.07], FRAC_PI_2);
    let (design, profile) = (two_pieces(lean, angle), milled());
    let sheet = made(&design, &profile);
    let ruled = thicken(&sheet, 5.0, Walls::Ruled).unwrap();
    assert_closed(&ruled.part);
    assert_closed(&ruled.moved);
    assert_eq!((shells(&ruled.part), ruled.axis_error), (1, 0.0));
    let part = read_back(&ruled.part);
    // Simpson's rule against the triangles: less than 5e-3 mm on some 300 mm2 of walls, of 1,400 mm3.
    assert!((volume(&part) / ruled.volume - 1.0).abs() < 1e-3, "{} {}", volume(&part), ruled.volume);
    for [a, b, c] in part.triangles() {
        // No face folds over, however far its corners moved.
        if a.z == 2.5 && b.z == 2.5 && c.z == 2.5 {
            assert!((b - a).cross(&(c - a)).z > 0.0);
        }
    }
    let vertical = thicken(&sheet, 5.0, Walls::Vertical);
    for z in [-2.499, -1.7, -0.6, 0.01, 1.1, 2.0, 2.499] {
        let [centre, width] = neck_errors(&part, &sheet.hinges, z);
        // Both faces of the neck are moved alike; the burned round and the grid remain.
        assert!(centre < 2e-3 && width < 4e-3, "{z}: {centre} {width}");
    }
    // The same sheet straight down: the neck is off by z times the slope across it, and pieces run into each
    // other.
    match vertical {
        Ok(vertical) => {
            let [centre, _] = neck_errors(&read_back(&vertical.part), &sheet.hinges, 2.4);
            // More at the ends, where the neck is no longer straight.
            assert!((2.4 * 0.07 - 3e-3..2.4 * 0.12).contains(&centre), "{centre}");
            assert!((vertical.axis_error - 2.5 * lean[0].hypot(lean[1])).abs() < 1e-9);
        }
        Err(error) => panic!("{error}"),
    }
}

/// A lattice whose hinges tilt by up to `lean`, more towards one side, both hinges of a corner alike.
fn tilted_lattice(lean: f64) -> Fabrication {
    let mut sheet = made(&TestSheet::rectangle([4, 3], [14.0, 14.0], 1.5).design(0.6), &milled());
    for (i, row) in sheet.hinges.iter_mut().enumerate() {
        let corner = sheet.design.pieces[row.pieces[0]].corners[sheet.design.hinges[i].vertices[0]];
        let at = sheet.design.corners[corner];
        let up = Vector3::new(lean * (at.x / 31.0 - 1.0), 0.6 * lean * (1.0 - at.y / 24.0), 1.0).normalize();
        row.axis = if i % 2 == 0 { up } else { -up };
        row.tilt = up.z.acos();
    }
    sheet
}

#[test]
fn walls_follow_the_hinges_that_they_pass() {
    let sheet = tilted_lattice(0.15);
    let thick = thicken(&sheet, 5.0, Walls::Ruled).unwrap();
    assert_closed(&thick.part);
    let part = read_back(&thick.part);
    assert_closed(&part);
    for z in [-2.45, -1.2, 0.3, 2.45] {
        let [centre, width] = neck_errors(&part, &sheet.hinges, z);
        // A tool that leans by 0.15 across its groove is wider by 0.006 mm to either side.
        assert!(centre < 2e-3 && width < 0.012 + 4e-3, "{z}: {centre} {width}");
    }
}

/// A lattice whose two hinges of every corner lean by `apart` to opposite sides of the slit between them.
fn parted_lattice(apart: f64) -> Fabrication {
    let mut design = TestSheet::rectangle([4, 3], [14.0, 14.0], 1.5 + 2.5 * apart).design(0.6);
    for hinge in &mut design.hinges {
        let corner = design.corners[design.pieces[hinge.pieces[0]].corners[hinge.vertices[0]]];
        let away = (hinge.point - corner).try_normalize(1e-6).unwrap_or_default() * (0.5 * apart);
        hinge.axis = hinge.axis.z.signum() * (Vector3::new(0.02, -0.01, 1.0) + away).normalize();
    }
    let mut profile = milled();
    profile.cut.ruled = true;
    made(&design, &profile)
}

#[test]
fn both_walls_of_a_slit_follow_their_own_hinges() {
    let sheet = parted_lattice(0.1);
    let thick = thicken(&sheet, 5.0, Walls::Ruled).unwrap();
    assert_closed(&thick.part);
    let part = read_back(&thick.part);
    for z in [-2.45, -1.2, 0.3, 2.45] {
        let [centre, width] = neck_errors(&part, &sheet.hinges, z);
        assert!(centre < 3e-3 && width < 6e-3, "{z}: {centre} {width}");
    }
    // The slit between the two hinges of a corner is as wide as the tool at its narrow face, and tapers by what the
    // walls lean apart.
    let pair = sheet.hinges.iter().find_map(|a| {
        let near = |b: &&HingeRow| b.id > a.id && (b.point - a.point).norm() < 1.8;
        sheet.hinges.iter().find(near).map(|b| [a.clone(), b.clone()])
    });
    let [a, b] = pair.expect("a corner with two hinges");
    let away = (b.point - a.point).normalize();
    let lean = |row: &HingeRow| row.axis / row.axis.z;
    for z in [-2.49, -1.0, 2.49] {
        let middle = nalgebra::center(&a.point, &b.point) + 0.5 * z * (lean(&a) + lean(&b));
        let slice = slice(&part, z);
        let ways = [1.0, -1.0].map(|s| free_way(&slice, [middle.x, middle.y], [s * away.x, s * away.y]));
        let expected = 1.25 + z * (lean(&b) - lean(&a)).dot(&away);
        assert!((ways[0] + ways[1] - expected).abs() < 6e-3, "{z}: {ways:?} {expected}");
        assert!(expected > 1.0 - 1e-3);
    }
}

#[test]
fn walls_that_meet_or_lie_flat_are_refused_with_place_and_value() {
    let folded = thicken(&tilted_lattice(7.0), 5.0, Walls::Ruled);
    assert!(matches!(folded, Err(SolidError::FlatAxis { tilt_deg, .. }) if tilt_deg > 45.0), "{folded:?}");
    // Two hinges of one slit that lean by 0.9 against each other, 12 mm apart.
    let mut sheet = tilted_lattice(0.0);
    for (i, row) in sheet.hinges.iter_mut().enumerate() {
        row.axis = Vector3::new(if i % 3 == 0 { 0.9 } else { -0.9 }, 0.3, 1.0).normalize();
    }
    let strokes = Strokes::new(&sheet.layout.paths, &sheet.hinges, 0.5);
    let rulings = Rulings::new(&strokes, &sheet.hinges, 5.0).unwrap();
    let body = &burned_bodies(&sheet.layout.paths, 1.0)[0];
    match loft(&rulings.rule(&plate(body).unwrap()), 5.0) {
        Err(SolidError::WallsMeet { depth, .. } | SolidError::WallFolds { depth, .. }) => {
            assert_eq!(depth.abs(), 2.5);
        }
        other => panic!("{:?}", other.map(|shell| shell.volume)),
    }
}

#[test]
fn plates_keep_their_place_on_the_grid() {
    let sheet = tilted_lattice(0.05);
    let thick = thicken(&sheet, 5.0, Walls::Ruled).unwrap();
    for vertex in &thick.part.vertices {
        assert_eq!([vertex.x, vertex.y].map(|c| f64::from(c as f32)), [vertex.x, vertex.y]);
    }
    let moved = placed(&sheet, |plate| plate).unwrap();
    let worst = moved.iter().map(|piece| piece.misfit).fold(0.0, f64::max);
    assert!(worst < GRID, "{worst}");
}
