//! A target for the page: its mesh, thinned where it is fine.

use std::collections::HashMap;

use serde_json::{Value, json};

use super::encode::{base64, counts, rounded};
use crate::geometry::mesh::TriMesh;
use crate::geometry::rotation::RigidMotion;
use crate::geometry::{Point3, Vector3};
use crate::kirigami::design::State;

/// Finer meshes are thinned to about as many triangles: 60 kB.
const MOST_TRIANGLES: usize = 6000;

/// Vertices and triangles of a target on the page.
pub fn object(state: State, mesh: &TriMesh, page: &RigidMotion) -> Value {
    let mesh = if mesh.faces.len() > MOST_TRIANGLES { &thinned(mesh) } else { mesh };
    let moved: Vec<Point3> = mesh.vertices.iter().map(|p| page.apply(p)).collect();
    let largest = moved.iter().map(|p| p.coords.amax()).fold(1e-6, f64::max);
    let unit = largest / f64::from(i16::MAX);
    json!({
        "state": match state {
            State::Closed => "closed",
            State::Open => "open",
        },
        "unit": unit,
        "points": base64(rounded(moved.iter().flat_map(|p| [p.x, p.y, p.z]), unit)),
        "faces": base64(counts(mesh.faces.iter().flatten().copied())),
    })
}

/// Vertices in one cell of a grid become their mean; triangles that lose a corner go. Enough to look at: a vertex moves by
/// less than a cell's diagonal, and on a smooth surface nearly within it.
fn thinned(mesh: &TriMesh) -> TriMesh {
    // As many squares of the cell's side as half the triangles cover the surface.
    let mut side = (mesh.area() / (0.5 * MOST_TRIANGLES as f64)).sqrt();
    loop {
        let found = clustered(mesh, side);
        if found.faces.len() <= MOST_TRIANGLES {
            return found;
        }
        side *= 1.3;
    }
}

fn clustered(mesh: &TriMesh, side: f64) -> TriMesh {
    let mut cells: HashMap<[i64; 3], usize> = HashMap::new();
    let mut sums: Vec<(Vector3, f64)> = Vec::new();
    let mut cell_of = |p: &Point3| {
        let key = [p.x, p.y, p.z].map(|c| (c / side).floor() as i64);
        let cell = *cells.entry(key).or_insert(sums.len());
        if cell == sums.len() {
            sums.push((Vector3::zeros(), 0.0));
        }
        sums[cell].0 += p.coords;
        sums[cell].1 += 1.0;
        cell
    };
    let of: Vec<usize> = mesh.vertices.iter().map(&mut cell_of).collect();
    let mut faces: Vec<[usize; 3]> = mesh
        .faces
        .iter()
        .map(|face| face.map(|v| of[v]))
        .filter(|[a, b, c]| a != b && b != c && c != a)
        .collect();
    // The same three cells twice: one triangle is enough.
    let key = |face: &[usize; 3]| {
        let mut key = *face;
        key.sort_unstable();
        key
    };
    faces.sort_by_key(|face| (key(face), *face));
    faces.dedup_by_key(|face| key(face));
    TriMesh { vertices: sums.iter().map(|(sum, count)| Point3::from(sum / *count)).collect(), faces }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bowl of `n` by `n` squares over one of side 2.
    fn bowl(n: usize) -> TriMesh {
        let at = |i: usize| 2.0 * i as f64 / n as f64 - 1.0;
        let vertex = |x: f64, y: f64| Point3::new(x, y, 0.3 * (x * x + y * y));
        let vertices = (0..=n).flat_map(|j| (0..=n).map(move |i| vertex(at(i), at(j)))).collect();
        let faces = (0..n)
            .flat_map(|j| (0..n).map(move |i| j * (n + 1) + i))
            .flat_map(|a| [[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]])
            .collect();
        TriMesh { vertices, faces }
    }

    #[test]
    fn fine_meshes_are_thinned_and_stay_where_they_are() {
        let fine = bowl(200);
        let thin = thinned(&fine);
        assert!((MOST_TRIANGLES / 4..=MOST_TRIANGLES).contains(&thin.faces.len()), "{}", thin.faces.len());
        for p in &thin.vertices {
            assert!((p.z - 0.3 * (p.x * p.x + p.y * p.y)).abs() < 2e-3, "{p}");
        }
        // Of a surface without folds nothing is lost but a rim of less than a cell.
        assert!((thin.area() / fine.area() - 1.0).abs() < 0.05, "{} {}", thin.area(), fine.area());
    }
}
