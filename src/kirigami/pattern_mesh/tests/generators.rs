//! Meshes to test with, and the two samples with singularities.

use crate::geometry::mesh::PolyMesh;
use crate::geometry::{Point2, Point3};
use nalgebra::{Complex, Vector2};
use std::f64::consts::PI;

/// Unit cells of the plane, given by (column, row), as quads; vertices in the order in which the cells name them.
pub fn cells(cells: &[[i32; 2]]) -> PolyMesh {
    let mut mesh = PolyMesh::default();
    let mut positions: Vec<[i32; 2]> = Vec::new();
    for &[i, j] in cells {
        let face = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]].map(|p| {
            positions.iter().position(|q| *q == p).unwrap_or_else(|| {
                positions.push(p);
                positions.len() - 1
            })
        });
        mesh.faces.push(face.to_vec());
    }
    mesh.vertices = positions.iter().map(|&[i, j]| Point3::new(f64::from(i), f64::from(j), 0.0)).collect();
    mesh
}

/// All cells of a block.
pub fn block(columns: i32, rows: i32) -> Vec<[i32; 2]> {
    (0..rows).flat_map(|j| (0..columns).map(move |i| [i, j])).collect()
}

/// `k` patches of `n` x `n` quads around vertex 0: the ray between two patches is a side of both. Quads are as square
/// and as equal as the patches allow in the plane, of side `edge`, and then lifted to a paraboloid, `height` at vertex
/// 0 and 0 where the outline is farthest away from it.
pub fn patches(k: usize, n: usize, edge: f64, height: f64) -> PolyMesh {
    let number = |patch: usize, i: usize, j: usize| match (i, j) {
        (0, 0) => 0,
        (0, j) => 1 + (patch + 1) % k * n * (n + 1) + (j - 1) * (n + 1),
        (i, j) => 1 + patch * n * (n + 1) + (i - 1) * (n + 1) + j,
    };
    let mut flat = vec![Point2::origin(); 1 + k * n * (n + 1)];
    let mut faces = Vec::new();
    for patch in 0..k {
        for (i, j) in (0..=n).flat_map(|i| (0..=n).map(move |j| (i, j))) {
            let z = Complex::new(i as f64, j as f64);
            let turn = (4.0 * z.arg() + 2.0 * PI * patch as f64) / k as f64;
            flat[number(patch, i, j)] = Point2::new(turn.cos(), turn.sin()) * z.norm();
            if i < n && j < n {
                let around = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
                faces.push(around.map(|(i, j)| number(patch, i, j)).to_vec());
            }
        }
    }
    square_up(&mut flat, &faces);
    let far = flat.iter().map(|p| p.coords.norm()).fold(0.0, f64::max);
    let lift = |p: &Point2| {
        let z = height * (1.0 - p.coords.norm_squared() / (far * far));
        Point3::new(edge * p.x, edge * p.y, z)
    };
    PolyMesh { vertices: flat.iter().map(lift).collect(), faces }
}

/// Moves every vertex to the mean of where the unit squares that fit its quads best would have it, many times.
fn square_up(points: &mut [Point2], faces: &[Vec<usize>]) {
    const ROUNDS: usize = 400;
    let square = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]].map(|[x, y]| Complex::new(x, y));
    for _ in 0..ROUNDS {
        let mut sums = vec![(Vector2::zeros(), 0.0); points.len()];
        for face in faces {
            let corners: Vec<Complex<f64>> =
                face.iter().map(|&v| Complex::new(points[v].x, points[v].y)).collect();
            let centre = corners.iter().sum::<Complex<f64>>() / 4.0;
            let fit: Complex<f64> = corners.iter().zip(&square).map(|(z, s)| (z - centre) * s.conj()).sum();
            let turn = fit / fit.norm();
            for (&v, s) in face.iter().zip(&square) {
                let wished = centre + turn * s;
                sums[v].0 += Vector2::new(wished.re, wished.im);
                sums[v].1 += 1.0;
            }
        }
        for (p, (sum, count)) in points.iter_mut().zip(sums) {
            *p = Point2::from(sum / count);
        }
    }
    let centre = points[0].coords;
    points.iter_mut().for_each(|p| *p -= centre);
}

/// The sample without cuts: six patches, 294 pieces of about 8 mm, a dome 25 mm high.
pub fn star() -> PolyMesh {
    rounded(patches(6, 7, 8.0, 25.0))
}

/// The sample that is made with a cut: three patches, 192 pieces of about 8 mm, a dome 60 mm high. Closed, three quarters
/// of a square.
pub fn three() -> PolyMesh {
    rounded(patches(3, 8, 8.0, 60.0))
}

/// One that its cut does not mend, because it has too much angle around the corner: five patches, 245 pieces of about 8 mm, a dome 30 mm high.
pub fn five() -> PolyMesh {
    rounded(patches(5, 7, 8.0, 30.0))
}

/// The mesh as the sample's file gives it.
fn rounded(mut mesh: PolyMesh) -> PolyMesh {
    // The sum turns -0 into 0.
    mesh.vertices.iter_mut().for_each(|p| *p = p.map(|c| (c * 1e4).round() / 1e4 + 0.0));
    mesh
}

/// A mesh as an OBJ file that begins with a comment.
pub fn obj(mesh: &PolyMesh, comment: &str) -> String {
    let mut text = format!("# {comment}\n");
    for p in &mesh.vertices {
        text.push_str(&format!("v {} {} {}\n", p.x, p.y, p.z));
    }
    for face in &mesh.faces {
        let numbers: Vec<String> = face.iter().map(|v| (v + 1).to_string()).collect();
        text.push_str(&format!("f {}\n", numbers.join(" ")));
    }
    text
}
