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
    let states: Vec<[Point3; 2]> =
        (0..(nx + 1) * (ny + 1)).map(|k| at(k)).map(|(x, y)| state(x, y)).collect();
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
