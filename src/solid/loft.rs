//! From a plate's outlines to a closed shell: both faces, and walls between them.

use super::caps::triangles;
use super::crossing::check_walls;
use super::error::SolidError;
use super::outline::Plate;
use crate::geometry::Point3;
use crate::geometry::mesh::TriMesh;

/// A closed surface, oriented outwards.
#[derive(Debug, Clone, PartialEq)]
pub struct Shell {
    /// Points of the lower face, outline after outline, then those of the upper face in the same order.
    pub mesh: TriMesh,
    /// Volume inside, cubic millimetres, by the areas at the faces and the mid-plane (Simpson's rule, which
    /// is exact for ruled walls; the two triangles that stand for a piece of ruled wall may differ from it by
    /// a few thousandths of a millimetre).
    pub volume: f64,
}

/// The shell of a plate, from half of `thickness` (mm) below the mid-plane to half of it above.
///
/// The faces are triangulated each for itself, from the very points where the walls end: so nothing can gape,
/// and nothing in a face can fold over, however the walls lean.
///
/// # Errors
/// Outlines that touch or cross themselves, at the mid-plane or on the way to a face.
pub fn loft(plate: &Plate, thickness: f64) -> Result<Shell, SolidError> {
    let half = 0.5 * thickness;
    if plate.leans() {
        check_walls(plate, half)?;
    }
    let lower = plate.at(-half);
    let bottom = triangles(&lower, plate.grid)?;
    let upper = plate.at(half);
    let count: usize = lower.iter().map(Vec::len).sum();
    let mut faces: Vec<[usize; 3]> = bottom.iter().map(|&[a, b, c]| [a, c, b]).collect();
    let top = if plate.leans() { triangles(&upper, plate.grid)? } else { bottom };
    faces.extend(top.iter().map(|t| t.map(|v| v + count)));
    drop(top);
    let mut start = 0;
    for outline in &lower {
        let n = outline.len();
        for i in 0..n {
            let [a, b] = [start + i, start + (i + 1) % n];
            faces.extend([[a, b, b + count], [a, b + count, a + count]]);
        }
        start += n;
    }
    let height = |z: f64| move |&[x, y]: &[f64; 2]| Point3::new(x, y, z);
    let vertices: Vec<Point3> =
        lower.iter().flatten().map(height(-half)).chain(upper.iter().flatten().map(height(half))).collect();
    let [low, middle, high] = [-half, 0.0, half].map(|z| plate.area(z));
    Ok(Shell { mesh: TriMesh { vertices, faces }, volume: thickness * (low + 4.0 * middle + high) / 6.0 })
}

/// Meshes one after the other in one.
pub fn joined(shells: impl IntoIterator<Item = TriMesh>) -> TriMesh {
    let mut all = TriMesh::default();
    for mut shell in shells {
        if all.vertices.is_empty() {
            all = shell;
            continue;
        }
        let start = all.vertices.len();
        all.vertices.append(&mut shell.vertices);
        all.faces.extend(shell.faces.iter().map(|face| face.map(|v| v + start)));
    }
    all
}
