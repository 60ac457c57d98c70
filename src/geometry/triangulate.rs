//! From the polygons of a file to triangles in millimetres.

use super::mesh::{PolyMesh, TriMesh};
use super::{Point3, Vector3};

/// Most corners of a face that is split; the time grows with up to their cube.
pub const MAX_CORNERS: usize = 1000;

/// Largest absolute coordinate after scaling, millimetres: a thousand kilometres.
pub const MAX_SCALED_COORDINATE: f64 = 1e9;

/// A triangle mesh that remembers the mesh it came from.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    /// The triangles, in millimetres. Every vertex is used.
    pub mesh: TriMesh,
    /// #F: the face of the source that each triangle is part of.
    pub face_of: Vec<usize>,
    /// The vertex of the source that each vertex was. Vertices beyond are the centres of warped faces.
    pub vertex_of: Vec<usize>,
}

/// Why a mesh was not split into triangles. Indices count from 0, the messages from 1, as OBJ files do.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TriangulateError {
    /// The scale is not a positive number.
    #[error("the scale of the mesh is {scale}, it must be a positive number")]
    Scale {
        /// The factor.
        scale: f64,
    },
    /// A coordinate that grows too large.
    #[error(
        "vertex {} has a coordinate of {value:e} mm after scaling, beyond the limit of \
         {MAX_SCALED_COORDINATE:e} mm: check the units", .vertex + 1
    )]
    TooLarge {
        /// The vertex.
        vertex: usize,
        /// The scaled coordinate.
        value: f64,
    },
    /// A face with too many corners.
    #[error("face {} has {corners} corners, more than the limit of {MAX_CORNERS}: triangulate it in the modeller", .face + 1)]
    TooManyCorners {
        /// The face.
        face: usize,
        /// Its number of corners.
        corners: usize,
    },
    /// A face without area.
    #[error(
        "face {} at x {:.6}, y {:.6}, z {:.6} mm has no area: its corners lie on a line; remove degenerate faces",
        .face + 1, .at.x, .at.y, .at.z
    )]
    ZeroArea {
        /// The face.
        face: usize,
        /// Its first corner, millimetres.
        at: Point3,
    },
    /// A polygon that crosses or touches itself, or is too warped to be seen as a polygon from any side.
    #[error(
        "face {} at x {:.6}, y {:.6}, z {:.6} mm crosses or touches itself: split it into triangles in the modeller",
        .face + 1, .at.x, .at.y, .at.z
    )]
    SelfCrossing {
        /// The face.
        face: usize,
        /// Its first corner, millimetres.
        at: Point3,
    },
}

/// Splits the faces of `mesh` into triangles, scales them by `scale` to millimetres, and drops unused vertices.
///
/// Triangles keep the direction of their face. A flat polygon is split along its shortest diagonals, as seen along its
/// mean normal; a quad along the shorter one, if both parts then face the same way. A warped face is split from its
/// centre: no diagonal is then preferred, and a surface is the same whichever corner a face starts with.
///
/// # Errors
/// Names the face or vertex, counted as in the file.
///
/// # Panics
/// If a face has no corner or an index is out of range, which the readers exclude.
pub fn triangulate(mesh: &PolyMesh, scale: f64) -> Result<Surface, TriangulateError> {
    if !(scale.is_finite() && scale > 0.0) {
        return Err(TriangulateError::Scale { scale });
    }
    let mut surface = used_vertices(mesh, scale)?;
    let mut number = vec![usize::MAX; mesh.vertices.len()];
    for (new, &old) in surface.vertex_of.iter().enumerate() {
        number[old] = new;
    }
    let rounding = rounding_error(&surface.mesh.vertices);
    for (face, polygon) in mesh.faces.iter().enumerate() {
        if polygon.len() > MAX_CORNERS {
            return Err(TriangulateError::TooManyCorners { face, corners: polygon.len() });
        }
        let corners: Vec<usize> = polygon.iter().map(|&old| number[old]).collect();
        let points: Vec<Point3> = corners.iter().map(|&new| surface.mesh.vertices[new]).collect();
        let at = points[0];
        let triangles = split(&points, rounding).map_err(|fault| match fault {
            Fault::ZeroArea => TriangulateError::ZeroArea { face, at },
            Fault::SelfCrossing => TriangulateError::SelfCrossing { face, at },
        })?;
        let centre = fan_centre(&points).map(|centre| {
            surface.mesh.vertices.push(centre);
            surface.mesh.vertices.len() - 1
        });
        let n = corners.len();
        let triangles: Vec<[usize; 3]> = match centre {
            Some(centre) => (0..n).map(|i| [corners[i], corners[(i + 1) % n], centre]).collect(),
            None => triangles.iter().map(|triangle| triangle.map(|i| corners[i])).collect(),
        };
        surface.face_of.extend(triangles.iter().map(|_| face));
        surface.mesh.faces.extend(triangles);
    }
    Ok(surface)
}

/// Splits every face of more than three corners from the mean of its corners, however flat it is: meshes that have the
/// same faces then have the same triangles.
///
/// # Errors
/// Those of [`triangulate`].
pub fn triangulate_from_centres(mesh: &PolyMesh, scale: f64) -> Result<Surface, TriangulateError> {
    // For its checks.
    triangulate(mesh, scale)?;
    let mut surface = used_vertices(mesh, scale)?;
    for (face, polygon) in mesh.faces.iter().enumerate() {
        let number = |old: &usize| surface.vertex_of.binary_search(old).expect("used");
        let polygon: Vec<usize> = polygon.iter().map(number).collect();
        let n = polygon.len();
        if n == 3 {
            surface.mesh.faces.push([polygon[0], polygon[1], polygon[2]]);
        } else {
            let centre = polygon.iter().map(|&v| surface.mesh.vertices[v].coords).sum::<Vector3>() / n as f64;
            let middle = surface.mesh.vertices.len();
            surface.mesh.vertices.push(Point3::from(centre));
            surface.mesh.faces.extend((0..n).map(|i| [polygon[i], polygon[(i + 1) % n], middle]));
        }
        surface.face_of.resize(surface.mesh.faces.len(), face);
    }
    Ok(surface)
}

/// Faces whose corners lie further off their mean plane than this part of their size are warped: about the rounding of a
/// file with seven digits, far below what can be seen.
const WARPED: f64 = 1e-7;

/// The mean of a warped polygon's corners, if all triangles from there face the polygon's way; `None` for flat ones.
fn fan_centre(points: &[Point3]) -> Option<Point3> {
    let n = points.len();
    let centre = Point3::from(points.iter().map(|p| p.coords).sum::<Vector3>() / n as f64);
    let spoke = |i: usize| points[i % n] - centre;
    let normal: Vector3 = (0..n).map(|i| spoke(i).cross(&spoke(i + 1))).sum();
    let size = (0..n).map(|i| spoke(i).norm()).fold(0.0, f64::max);
    let normal = normal.try_normalize(0.0)?;
    let warp = (0..n).map(|i| spoke(i).dot(&normal).abs()).fold(0.0, f64::max);
    // Each triangle must keep a hundredth of its share of the area: no slivers.
    let least = 0.01 * size * size / n as f64;
    let faces_along = (0..n).all(|i| spoke(i).cross(&spoke(i + 1)).dot(&normal) > least);
    (n > 3 && warp > WARPED * size && faces_along).then_some(centre)
}

/// A surface without faces that has the vertices of the faces of `mesh`, in their order.
fn used_vertices(mesh: &PolyMesh, scale: f64) -> Result<Surface, TriangulateError> {
    let mut used = vec![false; mesh.vertices.len()];
    for &vertex in mesh.faces.iter().flatten() {
        used[vertex] = true;
    }
    let vertex_of: Vec<usize> = (0..used.len()).filter(|&vertex| used[vertex]).collect();
    let mut vertices = Vec::with_capacity(vertex_of.len());
    for &vertex in &vertex_of {
        let point = mesh.vertices[vertex] * scale;
        if let Some(&value) = point.iter().find(|x| x.is_nan() || x.abs() > MAX_SCALED_COORDINATE) {
            return Err(TriangulateError::TooLarge { vertex, value });
        }
        vertices.push(point);
    }
    Ok(Surface { mesh: TriMesh { vertices, faces: Vec::new() }, face_of: Vec::new(), vertex_of })
}

/// Error of a coordinate difference: a few units in the last place of the largest coordinate.
fn rounding_error(vertices: &[Point3]) -> f64 {
    let largest = vertices.iter().flat_map(|v| v.iter()).fold(0.0_f64, |max, x| max.max(x.abs()));
    8.0 * f64::EPSILON * largest
}

enum Fault {
    ZeroArea,
    SelfCrossing,
}

/// Splits a polygon into triangles of indices into `points`.
fn split(points: &[Point3], rounding: f64) -> Result<Vec<[usize; 3]>, Fault> {
    let longest = (0..points.len())
        .map(|i| (points[(i + 1) % points.len()] - points[i]).norm())
        .fold(0.0_f64, f64::max);
    // A triangle is flat if its height is below rounding or a billionth of the longest edge: cotangents and
    // normals of anything flatter are noise. Twice the area is the height times the base.
    let least_area = longest * rounding.max(1e-9 * longest);
    let normal = area_vector(points);
    if normal.norm() <= least_area {
        return Err(Fault::ZeroArea);
    }
    if points.len() == 3 {
        return Ok(vec![[0, 1, 2]]);
    }
    let polygon = project(points, &normal.normalize());
    if crosses_itself(&polygon) {
        return Err(Fault::SelfCrossing);
    }
    clip_ears(points, &polygon, least_area).ok_or(Fault::SelfCrossing)
}

/// Twice the area of a polygon times its mean unit normal (Newell).
fn area_vector(points: &[Point3]) -> Vector3 {
    // From the first corner, which keeps differences small.
    points.windows(2).map(|pair| (pair[0] - points[0]).cross(&(pair[1] - points[0]))).sum()
}

/// Points seen along the unit vector `normal`: a polygon about it becomes counter-clockwise.
fn project(points: &[Point3], normal: &Vector3) -> Vec<[f64; 2]> {
    let across = normal.cross(&Vector3::ith(normal.iamin(), 1.0)).normalize();
    let up = normal.cross(&across);
    points
        .iter()
        .map(|point| {
            let from_first = point - points[0];
            [from_first.dot(&across), from_first.dot(&up)]
        })
        .collect()
}

/// Twice the signed area of a triangle, positive counter-clockwise.
fn doubled_area([a, b, c]: [[f64; 2]; 3]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Cuts off ears, that of the shortest diagonal first, until a triangle remains. `None` if none is left to cut.
fn clip_ears(points: &[Point3], polygon: &[[f64; 2]], least_area: f64) -> Option<Vec<[usize; 3]>> {
    let mut left: Vec<usize> = (0..polygon.len()).collect();
    let mut triangles = Vec::with_capacity(polygon.len() - 2);
    while left.len() > 3 {
        let n = left.len();
        let corner = |i: usize| [left[(i + n - 1) % n], left[i], left[(i + 1) % n]];
        let area = |i: usize| doubled_area(corner(i).map(|k| polygon[k]));
        let blunt: Vec<usize> = (0..n).filter(|&i| area(i) <= least_area).map(|i| left[i]).collect();
        let is_ear = |i: usize| {
            let ear = corner(i);
            let covers =
                |k: &usize| !ear.contains(k) && contains(ear.map(|k| polygon[k]), polygon[*k], least_area);
            area(i) > least_area && !blunt.iter().any(covers)
        };
        let diagonal = |i: usize| (points[corner(i)[2]] - points[corner(i)[0]]).norm_squared();
        // Corner 1 first: equal diagonals of a quad then split it from corner 0 to 2.
        let best = (1..=n)
            .map(|i| i % n)
            .filter(|&i| is_ear(i))
            .min_by(|&i, &j| diagonal(i).total_cmp(&diagonal(j)))?;
        triangles.push(corner(best));
        left.remove(best);
    }
    let last = [left[0], left[1], left[2]];
    triangles.push(last);
    (doubled_area(last.map(|k| polygon[k])) > least_area).then_some(triangles)
}

/// Whether a counter-clockwise triangle contains `point`, or nearly so: its border is included.
fn contains([a, b, c]: [[f64; 2]; 3], point: [f64; 2], least_area: f64) -> bool {
    [[a, b, point], [b, c, point], [c, a, point]].into_iter().all(|side| doubled_area(side) >= -least_area)
}

/// Whether two sides of a polygon cross in their interiors.
fn crosses_itself(polygon: &[[f64; 2]]) -> bool {
    let n = polygon.len();
    let side = |i: usize| (polygon[i], polygon[(i + 1) % n]);
    let separated = |(a, b), p, q| doubled_area([a, b, p]) * doubled_area([a, b, q]) < 0.0;
    let cross = |i: usize, j: usize| {
        let ((a, b), (p, q)) = (side(i), side(j));
        separated((a, b), p, q) && separated((p, q), a, b)
    };
    (0..n).any(|i| (i + 2..n).any(|j| cross(i, j)))
}

#[cfg(test)]
mod tests;
