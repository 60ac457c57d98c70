//! Designs for other programs: pairs of OBJ files, PyKirigami's text files, and one STL solid per piece.
//!
//! Coordinates are millimetres. Text formats hold the shortest digits that read back exactly.

use std::collections::HashMap;
use std::io::{self, Write};

use stl_io::{Normal, Triangle, Vertex};

use crate::geometry::Point3;
use crate::geometry::mesh::{PolyMesh, TriMesh};
use crate::geometry::plane::doubled_area;
use crate::geometry::triangulate::{TriangulateError, triangulate};
use crate::kirigami::design::{Design, Piece, State};

fn polygon(piece: &Piece, state: State) -> &[Point3] {
    match state {
        State::Closed => &piece.closed,
        State::Open => &piece.open,
    }
}

/// Writes one state as OBJ: a face per piece, in the design's order. The vertices of a hinge are one vertex, in both
/// states alike, where they are the same to the last bit.
///
/// # Errors
/// The error of `out`.
pub fn write_obj<W: Write>(design: &Design, state: State, mut out: W) -> io::Result<()> {
    let (vertices, faces) = shared_vertices(design);
    let name = if state == State::Closed { "closed" } else { "open" };
    writeln!(
        out,
        "# {} pieces in the {name} state, millimetres; gap {:?} mm",
        design.pieces.len(),
        design.gap
    )?;
    for [piece, vertex] in vertices {
        let p = polygon(&design.pieces[piece], state)[vertex];
        writeln!(out, "v {:?} {:?} {:?}", p.x, p.y, p.z)?;
    }
    for face in faces {
        let corners: Vec<String> = face.iter().map(|v| (v + 1).to_string()).collect();
        writeln!(out, "f {}", corners.join(" "))?;
    }
    out.flush()
}

/// The first piece and vertex of each shared vertex, and the faces over them.
fn shared_vertices(design: &Design) -> (Vec<[usize; 2]>, Vec<Vec<usize>>) {
    let mut same: HashMap<[usize; 2], [usize; 2]> = HashMap::new();
    for hinge in &design.hinges {
        let [j, k] = [0, 1].map(|end| [hinge.pieces[end], hinge.vertices[end]]);
        let points = |[piece, vertex]: [usize; 2]| {
            let piece = &design.pieces[piece];
            (piece.closed[vertex], piece.open[vertex])
        };
        let (earlier, later) = (j.min(k), j.max(k));
        if points(j) == points(k) {
            let first = same.get(&earlier).copied().unwrap_or(earlier);
            same.insert(later, first);
        }
    }
    let mut numbers: HashMap<[usize; 2], usize> = HashMap::new();
    let mut vertices = Vec::new();
    let mut faces = Vec::new();
    for (piece, polygon) in design.pieces.iter().enumerate() {
        let mut number = |vertex| {
            let own = [piece, vertex];
            let first = same.get(&own).copied().unwrap_or(own);
            *numbers.entry(first).or_insert_with(|| {
                vertices.push(own);
                vertices.len() - 1
            })
        };
        faces.push((0..polygon.closed.len()).map(&mut number).collect());
    }
    (vertices, faces)
}

/// Writes one state as PyKirigami's `vertices.txt` or `target.txt`: a piece per line.
///
/// # Errors
/// The error of `out`.
pub fn write_pykirigami_state<W: Write>(design: &Design, state: State, mut out: W) -> io::Result<()> {
    for piece in &design.pieces {
        let numbers: Vec<String> =
            polygon(piece, state).iter().flat_map(|p| p.iter()).map(|c| format!("{c:?}")).collect();
        writeln!(out, "{}", numbers.join(" "))?;
    }
    out.flush()
}

/// Writes the hinges as PyKirigami's `constraints.txt`: piece, corner, piece, corner, and 1 for a joint in a point.
///
/// # Errors
/// The error of `out`.
pub fn write_pykirigami_constraints<W: Write>(design: &Design, mut out: W) -> io::Result<()> {
    for hinge in &design.hinges {
        let ([j, k], [a, b]) = (hinge.pieces, hinge.vertices);
        writeln!(out, "{j} {a} {k} {b} 1")?;
    }
    out.flush()
}

/// The solid of a piece: its hinge polygon, thickened by half of `thickness` (mm) to either side along its normal. The
/// faces of warped polygons are split from their centres.
///
/// # Errors
/// A polygon that cannot be split into triangles.
pub fn piece_solid(
    piece: &Piece,
    state: State,
    thickness: f64,
) -> Result<Vec<[Point3; 3]>, TriangulateError> {
    let points = polygon(piece, state);
    let face = PolyMesh { vertices: points.to_vec(), faces: vec![(0..points.len()).collect()] };
    let surface = triangulate(&face, 1.0)?.mesh;
    let half = doubled_area(points).normalize() * (0.5 * thickness);
    let mut triangles = Vec::new();
    for face in &surface.faces {
        let [a, b, c] = face.map(|v| surface.vertices[v]);
        triangles.push([a + half, b + half, c + half]);
        triangles.push([c - half, b - half, a - half]);
    }
    for (i, &p) in points.iter().enumerate() {
        let q = points[(i + 1) % points.len()];
        triangles.push([p - half, q - half, q + half]);
        triangles.push([p - half, q + half, p + half]);
    }
    Ok(triangles)
}

/// The same as a mesh, whose triangles share their vertices.
///
/// # Errors
/// A polygon that cannot be split into triangles.
pub fn piece_mesh(piece: &Piece, state: State, thickness: f64) -> Result<TriMesh, TriangulateError> {
    let mut numbers: HashMap<[u64; 3], usize> = HashMap::new();
    let mut mesh = TriMesh::default();
    for triangle in piece_solid(piece, state, thickness)? {
        let number = |point: Point3| {
            *numbers.entry(<[f64; 3]>::from(point).map(f64::to_bits)).or_insert_with(|| {
                mesh.vertices.push(point);
                mesh.vertices.len() - 1
            })
        };
        let face = triangle.map(number);
        mesh.faces.push(face);
    }
    Ok(mesh)
}

/// The solids of all pieces of a design in one list, in the design's order; see [`piece_solid`].
///
/// # Errors
/// The first piece that cannot be split into triangles, and why.
pub fn solids(
    design: &Design,
    state: State,
    thickness: f64,
) -> Result<Vec<[Point3; 3]>, (usize, TriangulateError)> {
    let mut triangles = Vec::new();
    for (index, piece) in design.pieces.iter().enumerate() {
        triangles.extend(piece_solid(piece, state, thickness).map_err(|error| (index, error))?);
    }
    Ok(triangles)
}

/// Writes triangles as binary STL, which holds single precision.
///
/// # Errors
/// The error of `out`.
pub fn write_stl<W: Write>(
    triangles: impl ExactSizeIterator<Item = [Point3; 3]>,
    mut out: W,
) -> io::Result<()> {
    let facet = |[a, b, c]: [Point3; 3]| {
        let normal = (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_default();
        Triangle {
            normal: Normal::new(normal.map(|c| c as f32).into()),
            vertices: [a, b, c].map(|p| Vertex::new(p.coords.map(|c| c as f32).into())),
        }
    };
    stl_io::write_stl(&mut out, triangles.map(facet))?;
    out.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bent pentagon that is not convex: a wedge of it is missing.
    fn piece() -> Piece {
        let closed: Vec<Point3> = [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [2.0, 1.0], [0.0, 3.0]]
            .map(|[x, y]| Point3::new(x, y, 0.0))
            .to_vec();
        let open = closed.iter().map(|p| Point3::new(p.x, p.y, 0.1 * p.x * p.y)).collect();
        Piece { corners: (0..5).collect(), closed, open }
    }

    fn volume(triangles: &[[Point3; 3]]) -> f64 {
        triangles.iter().map(|[a, b, c]| a.coords.dot(&b.coords.cross(&c.coords)) / 6.0).sum()
    }

    #[test]
    fn solids_are_closed_and_have_their_volume() {
        for state in [State::Closed, State::Open] {
            let solid = piece_solid(&piece(), state, 0.5).unwrap();
            let mut sides: Vec<[[u64; 3]; 2]> = Vec::new();
            for triangle in &solid {
                for i in 0..3 {
                    sides.push([i, (i + 1) % 3].map(|k| <[f64; 3]>::from(triangle[k]).map(f64::to_bits)));
                }
            }
            for [p, q] in &sides {
                let back = sides.iter().filter(|side| **side == [*q, *p]).count();
                assert_eq!(back, 1, "{state:?}: a side without its counterpart");
            }
            if state == State::Closed {
                // 12 less the wedge of 4, times half a millimetre.
                assert!((volume(&solid) - 4.0).abs() < 1e-12, "{}", volume(&solid));
            } else {
                assert!(volume(&solid) > 4.0);
            }
        }
    }
}
