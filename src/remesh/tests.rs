//! Maps whose principal directions are known in closed form.

use super::*;
use crate::geometry::mesh::TriMesh;
use crate::geometry::{Point3, Vector3};
use nalgebra::Rotation3;

/// A grid of triangles over `nx` by `ny` cells of the unit square, inner points moved a little, in both states.
fn sheet(nx: usize, ny: usize, state: impl Fn(f64, f64) -> [Point3; 2]) -> SurfaceMap {
    let (closed, open) = sheet_meshes(nx, ny, state);
    SurfaceMap::new(closed, open).expect("a map")
}

fn sheet_meshes(nx: usize, ny: usize, state: impl Fn(f64, f64) -> [Point3; 2]) -> (TriMesh, TriMesh) {
    let at = |k: usize| {
        let (i, j) = (k % (nx + 1), k / (nx + 1));
        let inner = if i % nx == 0 || j % ny == 0 { 0.0 } else { 0.25 };
        let wobble = |salt: f64| inner * (12.9898 * k as f64 + salt).sin();
        ((i as f64 + wobble(0.3)) / nx as f64, (j as f64 + wobble(1.7)) / ny as f64)
    };
    let states: Vec<[Point3; 2]> = (0..(nx + 1) * (ny + 1)).map(at).map(|(x, y)| state(x, y)).collect();
    let faces: Vec<[usize; 3]> = (0..ny)
        .flat_map(|j| (0..nx).map(move |i| j * (nx + 1) + i))
        .flat_map(|a| {
            let [b, c, d] = [a + 1, a + nx + 2, a + nx + 1];
            if a % 2 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] }
        })
        .collect();
    let mesh = |k: usize| TriMesh { vertices: states.iter().map(|s| s[k]).collect(), faces: faces.clone() };
    (mesh(0), mesh(1))
}

fn flat(x: f64, y: f64) -> Point3 {
    Point3::new(x, y, 0.0)
}

/// A linear map with its largest opening stretch (1.4, the other is 1.1) at 30 degrees on the open sheet.
fn linear(x: f64, y: f64) -> [Point3; 2] {
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), 30_f64.to_radians());
    let open = flat(60.0 * x, 40.0 * y);
    let mut local = turn.inverse() * open;
    local.x /= 1.4;
    local.y /= 1.1;
    [Rotation3::from_axis_angle(&Vector3::z_axis(), 1.1) * local, open]
}

#[test]
fn a_linear_map_gives_a_straight_grid_in_its_directions() {
    let aligned = align(&sheet(12, 8, linear), &Options::square(3.0)).expect("aligned");
    println!("{} {:?} {}", aligned.mesh.faces.len(), aligned.alignment, aligned.covered);
    let direction = Vector3::new(30_f64.to_radians().cos(), 30_f64.to_radians().sin(), 0.0);
    assert!(aligned.mesh.faces.len() > 180);
    for (face, piece) in aligned.mesh.faces.iter().zip(&aligned.pieces) {
        assert_eq!(face.len(), 4);
        for i in 0..4 {
            let [a, b] = [face[i], face[(i + 1) % 4]];
            let side = aligned.mesh.vertices[b] - aligned.mesh.vertices[a];
            let along = side.dot(&direction).abs();
            let across = side.cross(&direction).norm();
            let (zero, closed_side) =
                if piece.sides[i] == Side::Most { (across, 3.0 / 1.4) } else { (along, 3.0 / 1.1) };
            assert!(zero < 1e-6 && (side.norm() - 3.0).abs() < 1e-6, "{side}");
            assert!(((aligned.closed[b] - aligned.closed[a]).norm() - closed_side).abs() < 1e-6);
            let stretch = piece.stretches[i % 2];
            assert!((stretch - 3.0 / closed_side).abs() < 1e-9);
        }
    }
}

/// Checks what every result promises: a disk of pieces wound like the surface, four pieces around every inner
/// corner, and two colours of which neighbours have different ones.
fn check(map: &SurfaceMap, aligned: &Aligned) {
    let mesh = &aligned.mesh;
    let border = crate::geometry::topology::check_disk(mesh).expect("a disk").boundary;
    let mut valence = vec![0; mesh.vertices.len()];
    mesh.faces.iter().flatten().for_each(|&v| valence[v] += 1);
    for (v, count) in valence.iter().enumerate() {
        assert!(*count == 4 || border.contains(&v), "{count} pieces around corner {v}");
    }
    let edges = crate::geometry::topology::edges(&mesh.faces).expect("a manifold");
    let pairs: Vec<[usize; 2]> = edges.iter().filter_map(|e| Some([e.left, e.right?])).collect();
    let mut colours = vec![None; mesh.faces.len()];
    colours[0] = Some(false);
    for _ in 0..mesh.faces.len() {
        for [f, g] in pairs.iter().flat_map(|&[f, g]| [[f, g], [g, f]]) {
            colours[g] = colours[g].or(colours[f].map(|colour| !colour));
        }
    }
    assert!(pairs.iter().all(|&[f, g]| colours[f].is_some() && colours[f] != colours[g]));
    let surface = crate::geometry::closest::ClosestPoints::new(map.open().clone());
    for (face, piece) in mesh.faces.iter().zip(&aligned.pieces) {
        assert_eq!(face.len(), piece.sides.len());
        let corners: Vec<Point3> = face.iter().map(|&v| mesh.vertices[v]).collect();
        let area: Vector3 =
            (2..face.len()).map(|i| (corners[i - 1] - corners[0]).cross(&(corners[i] - corners[0]))).sum();
        assert!(area.dot(&surface.closest(&crate::geometry::centroid(&corners)).normal) > 0.0);
    }
}

/// An annular sector, whose radii (by 0.9) and angles (by 0.75) the closed state shortens.
fn polar(x: f64, y: f64) -> [Point3; 2] {
    let at = |r: f64, t: f64| flat(r * t.cos(), r * t.sin());
    let (r, t) = (40.0 + 40.0 * x, 1.2 * y);
    [at(0.9 * r, 0.75 * t), at(r, t)]
}

#[test]
fn a_polar_map_gives_circles_and_rays() {
    let map = sheet(60, 70, polar);
    let options = Options { outline: Outline::Followed, size_weight: 1e-3, ..Options::square(4.0) };
    let aligned = align(&map, &options).expect("aligned");
    check(&map, &aligned);
    let polar = |v: usize| {
        let p = aligned.mesh.vertices[v];
        (p.x.hypot(p.y), p.y.atan2(p.x))
    };
    for (face, piece) in aligned.mesh.faces.iter().zip(&aligned.pieces) {
        for i in 0..4 {
            let ((r, t), (s, u)) = (polar(face[i]), polar(face[(i + 1) % 4]));
            // Tangents are stretched by 1 / (0.9 * 0.75), radii by 1 / 0.9.
            let (off, stretch) = match piece.sides[i] {
                Side::Most => ((r - s).abs() / (0.5 * (r + s) * (t - u).abs()), 1.0 / 0.675),
                Side::Least => (0.5 * (r + s) * (t - u).abs() / (r - s).abs(), 1.0 / 0.9),
            };
            // A hundredth of a radian: the triangles are 0.7 to 1.4 mm wide, an arc bends by up to 0.02 in one.
            assert!(off < 0.01, "{off}");
            assert!((piece.stretches[i % 2] / stretch - 1.0).abs() < 0.01);
        }
    }
    // The sector is filled, and the border's corners lie on its four sides.
    assert!(aligned.covered > 0.999);
    let border = crate::geometry::topology::check_disk(&aligned.mesh).expect("a disk").boundary;
    for (r, t) in border.into_iter().map(polar) {
        let gap = [r - 40.0, 80.0 - r, 40.0 * t, 40.0 * (1.2 - t)].into_iter().fold(f64::INFINITY, f64::min);
        assert!(gap.abs() < 0.01, "{gap}");
    }
}

#[test]
fn a_surface_of_revolution_gives_meridians_and_parallels() {
    // A catenoid's strip over the rectangle of its parameters: its stretches are cosh along both, then one is halved.
    let state = |x: f64, y: f64| {
        let (s, t) = (1.6 * (x - 0.5), 1.5 * y);
        [flat(60.0 * s, 30.0 * t), Point3::new(s.cosh() * t.cos(), s.cosh() * t.sin(), s) * 60.0]
    };
    let map = sheet(40, 40, state);
    let options = Options { size_weight: 1e-3, ..Options::square(5.0) };
    let aligned = align(&map, &options).expect("aligned");
    check(&map, &aligned);
    let mut checked = 0;
    for (face, piece) in aligned.mesh.faces.iter().zip(&aligned.pieces) {
        assert_eq!(face.len(), 4);
        for i in 0..4 {
            let [p, q] = [face[i], face[(i + 1) % 4]].map(|v| aligned.mesh.vertices[v]);
            let length = (q - p).norm();
            // Parallels, stretched twice as much, have constant height; meridians constant angle.
            let turn = (q.y.atan2(q.x) - p.y.atan2(p.x)) * p.x.hypot(p.y);
            let off = if piece.sides[i] == Side::Most { q.z - p.z } else { turn };
            // Beyond the outline cells go on straight, where the surface bends by 1 / 60 mm.
            assert!(off.abs() < 0.03 * length, "{off} of {length}");
            checked += 1;
        }
    }
    assert!(checked > 400 && aligned.covered > 0.9);
}

/// Half the gradient of |p|^2 and of a cubic, whose second derivatives have an umbilic in the middle: the directions
/// turn by half a turn around it, forwards (lemon) or backwards (star).
fn umbilic(a: f64, b: f64) -> impl Fn(f64, f64) -> [Point3; 2] {
    move |x, y| {
        let (x, y) = (2.0 * x - 0.96, 2.0 * y - 1.05);
        [
            flat(50.0 * (x + 3.0 * a * x * x + b * y * y), 50.0 * (y + 2.0 * b * x * y)),
            flat(50.0 * x, 50.0 * y),
        ]
    }
}

#[test]
fn umbilics_become_pieces_with_three_or_five_corners() {
    for (b, corners, turn) in [(0.05, 3, 1), (-0.15, 5, -1)] {
        let map = sheet(40, 40, umbilic(0.05, b));
        let aligned = align(&map, &Options::square(4.0)).expect("aligned");
        check(&map, &aligned);
        let missing: usize = aligned.singular.iter().map(|&f| aligned.mesh.faces[f].len().abs_diff(4)).sum();
        // Half a turn is two quarters: two such pieces, or one with six corners.
        assert_eq!(missing, 2);
        for &f in &aligned.singular {
            let face = &aligned.mesh.faces[f];
            assert!(face.len() == corners || face.len() == 6 && corners == 5);
            let centre = crate::geometry::centroid(
                &face.iter().map(|&v| aligned.mesh.vertices[v]).collect::<Vec<_>>(),
            );
            assert!((centre - flat(-2.0, 2.5)).norm() < 12.0, "{centre}");
        }
        assert!(aligned.alignment.mean < 0.03, "{:?}", aligned.alignment);
        let refused = align(&map, &Options { singular: Singular::Refused, ..Options::square(4.0) });
        let Err(RemeshError::Singular { places }) = refused else { panic!("{refused:?}") };
        assert!(!places.is_empty() && places.iter().map(|p| p.1).sum::<i32>() == 2 * turn);
        for &(vertex, _) in &places {
            assert!((map.open().vertices[vertex] - flat(-2.0, 2.5)).norm() < 12.0);
        }
        let smoothed = align(&map, &Options { singular: Singular::Smoothed, ..Options::square(4.0) });
        let smoothed = smoothed.expect("aligned");
        check(&map, &smoothed);
        assert!(smoothed.singular.is_empty() && smoothed.alignment.mean > aligned.alignment.mean);
    }
}

/// Every corner of one mesh has its like in the other. Corners beyond the outline lie on quads that a diagonal
/// divides, another one in a mesh that is wound the other way.
fn assert_same(base: &(SurfaceMap, Aligned), other: &Aligned, place: impl Fn(&Point3) -> Point3) {
    let (map, base) = base;
    assert_eq!(base.mesh.faces.len(), other.mesh.faces.len());
    assert_eq!(base.mesh.vertices.len(), other.mesh.vertices.len());
    let surface = crate::geometry::closest::ClosestPoints::new(map.open().clone());
    for p in &base.mesh.vertices {
        let moved = place(p);
        let gap = other.mesh.vertices.iter().map(|q| (moved - q).norm()).fold(f64::INFINITY, f64::min);
        let allowed = if surface.distance(p) < 1e-6 { 1e-6 } else { 0.05 };
        assert!(gap < allowed, "{gap}");
    }
}

#[test]
fn nothing_depends_on_position_numbers_or_sides() {
    let dome = |x: f64, y: f64| {
        let (x, y) = (2.0 * x - 1.0, 2.0 * y - 1.0);
        let shrunk = 0.85 + 0.1 * x * x + 0.06 * x * y;
        let height = 20.0 * (1.0 - x * x) * (1.0 - 0.8 * y * y);
        [flat(50.0 * shrunk * x, 40.0 * shrunk * y), Point3::new(50.0 * x, 45.0 * y, height)]
    };
    for (closed, open) in [sheet_meshes(24, 20, dome), sheet_meshes(24, 20, umbilic(0.05, 0.05))] {
        let options = Options::square(5.0);
        let run = |closed: &TriMesh, open: &TriMesh| {
            let map = SurfaceMap::new(closed.clone(), open.clone()).expect("a map");
            let aligned = align(&map, &options).expect("aligned");
            check(&map, &aligned);
            (map, aligned)
        };
        let base = run(&closed, &open);
        let moved = |mesh: &TriMesh, turn: Rotation3<f64>| TriMesh {
            vertices: mesh.vertices.iter().map(|p| turn * p + Vector3::new(7.0, -90.0, 4.0)).collect(),
            faces: mesh.faces.clone(),
        };
        let turn = Rotation3::from_euler_angles(0.4, -1.0, 2.2);
        let elsewhere =
            run(&moved(&closed, Rotation3::from_euler_angles(0.0, 0.0, 0.7)), &moved(&open, turn));
        assert_same(&base, &elsewhere.1, |p| turn * p + Vector3::new(7.0, -90.0, 4.0));
        let count = open.vertices.len();
        let renumbered = |mesh: &TriMesh| TriMesh {
            vertices: mesh.vertices.iter().rev().copied().collect(),
            faces: mesh.faces.iter().rev().map(|&[a, b, c]| [b, c, a].map(|v| count - 1 - v)).collect(),
        };
        assert_same(&base, &run(&renumbered(&closed), &renumbered(&open)).1, |p| *p);
        let over = |mesh: &TriMesh| TriMesh {
            vertices: mesh.vertices.clone(),
            faces: mesh.faces.iter().map(|&[a, b, c]| [a, c, b]).collect(),
        };
        assert_same(&base, &run(&over(&closed), &over(&open)).1, |p| *p);
    }
}

#[test]
fn unequal_cells_are_long_where_the_map_stretches_most() {
    let options = Options { cell: [4.0, 2.5], ..Options::square(1.0) };
    let map = sheet(12, 8, linear);
    let aligned = align(&map, &options).expect("aligned");
    check(&map, &aligned);
    for (face, piece) in aligned.mesh.faces.iter().zip(&aligned.pieces) {
        for i in 0..4 {
            let length = (aligned.mesh.vertices[face[(i + 1) % 4]] - aligned.mesh.vertices[face[i]]).norm();
            // The sides' weight in the direction is that of the anisotropy, 0.96: nearly the asked ones.
            let asked = if piece.sides[i] == Side::Most { 4.0 } else { 2.5 };
            assert!((length / asked - 1.0).abs() < 0.03, "{length}");
        }
    }
}

#[test]
fn maps_that_are_none_are_refused_by_name() {
    let (closed, open) = sheet_meshes(6, 5, linear);
    let error = |closed: &TriMesh, open: &TriMesh| {
        SurfaceMap::new(closed.clone(), open.clone()).expect_err("refused").to_string()
    };
    let mut folded = closed.clone();
    // The inner vertex 15 is drawn over the triangles on its other side.
    folded.vertices[15] = folded.vertices[13] + (folded.vertices[13] - folded.vertices[15]) * 0.3;
    let message = error(&folded, &open);
    assert!(message.contains("the map folds: triangle") && message.contains("closed"), "{message}");
    let mut other = closed.clone();
    other.faces[7] = [1, 2, 0];
    assert!(error(&other, &open).contains("triangle 8 is [2, 3, 1] in the closed one"));
    other.faces.truncate(3);
    assert!(error(&other, &open).contains("3 triangles"));
    let mut thin = open.clone();
    let [a, b, c] = thin.faces[4];
    thin.vertices[c] = nalgebra::center(&thin.vertices[a], &thin.vertices[b]);
    assert!(error(&closed, &thin).contains("triangle 5 of the open mesh has no area"));
    let mut holed = (closed.clone(), open.clone());
    holed.0.faces.remove(28);
    holed.1.faces.remove(28);
    assert!(matches!(SurfaceMap::new(holed.0, holed.1), Err(RemeshError::NotADisk(_))));

    let map = SurfaceMap::new(closed, open).expect("a map");
    let fails = |options: Options| align(&map, &options).expect_err("refused").to_string();
    assert!(fails(Options { cell: [3.0, 0.0], ..Options::square(3.0) }).contains("must be above 0"));
    assert!(fails(Options { size_weight: 2.0, ..Options::square(3.0) }).contains("at most 1"));
    assert!(fails(Options { smoothing: f64::NAN, ..Options::square(3.0) }).contains("smoothing"));
    assert!(fails(Options { most_pieces: 100, ..Options::square(3.0) }).contains("more than 100"));
    assert!(fails(Options::square(35.0)).contains("at least 4 must fit"));
}

#[test]
fn where_no_direction_means_anything_the_grid_goes_with_the_outline() {
    let map = sheet(10, 8, |x, y| [flat(50.0 * x, 40.0 * y), flat(60.0 * x, 48.0 * y)]);
    let aligned = align(&map, &Options::square(4.0)).expect("aligned");
    check(&map, &aligned);
    assert_eq!(aligned.mesh.faces.len(), 15 * 12);
    assert!(aligned.covered > 0.999 && aligned.alignment.largest == 0.0);
}

#[test]
fn a_full_turn_takes_four_triangles_or_gives_the_directions_up() {
    // Shrunk radially: rays and circles all around the middle, that smoothing alone cannot undo.
    let map = sheet(30, 30, |x, y| {
        let p = flat(2.0 * x - 1.0, 2.0 * y - 1.0);
        let r = p.coords.norm().max(1e-9);
        [flat(50.0 * p.x * r.atan() / r, 50.0 * p.y * r.atan() / r), flat(50.0 * p.x, 50.0 * p.y)]
    });
    let aligned = align(&map, &Options::square(5.0)).expect("aligned");
    check(&map, &aligned);
    assert_eq!(aligned.singular.len(), 4);
    assert!(aligned.singular.iter().all(|&f| aligned.mesh.faces[f].len() == 3));
    assert!(aligned.alignment.mean < 0.05, "{:?}", aligned.alignment);
    for outline in [Outline::Trimmed, Outline::Followed] {
        let options = Options { singular: Singular::Smoothed, outline, ..Options::square(5.0) };
        let even = align(&map, &options).expect("aligned");
        check(&map, &even);
        assert!(even.singular.is_empty() && even.smoothing > 1.0);
        assert!(even.alignment.sizes[0] > 2.5 && even.alignment.sizes[1] < 10.0, "{:?}", even.alignment);
    }
}
