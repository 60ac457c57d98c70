//! A map between two surfaces, triangle by triangle: what it stretches, and where.

use super::RemeshError;
use crate::geometry::Vector3;
use crate::geometry::mesh::{PolyMesh, TriMesh};
use crate::geometry::stretch::{Gradients, PlaneMap, laid_out};
use crate::geometry::topology::check_disk;
use nalgebra::Complex;

/// A map from a closed state to an open one: two meshes with the same triangles, both disks.
#[derive(Debug, Clone)]
pub struct SurfaceMap {
    closed: TriMesh,
    open: TriMesh,
    /// The boundary loop, the surface on its left.
    boundary: Vec<usize>,
}

/// What the map does to one triangle.
#[derive(Debug, Clone, Copy)]
pub struct Principal {
    /// Length in the open state over length in the closed one: largest, smallest.
    pub stretches: [f64; 2],
    /// Unit vector of the largest stretch in the frame of the open triangle (along its first edge, and across it to
    /// the left); any where both stretches are equal.
    pub direction: Complex<f64>,
    /// How much the direction means, 0 (both stretches are equal) to 1.
    pub weight: f64,
    /// From the open triangle's frame to the closed one's.
    pub closing: PlaneMap,
}

/// Logarithm of the ratio of the two stretches at which a direction counts half: a few per cent are what the
/// corners of a mesh know about a smooth map.
const FAINT: f64 = 0.05;

/// Faces are folded onto each other where the cosine between their normals is less.
const FOLDED: f64 = -0.95;

/// Part of its longest edge that a triangle's height must reach: far above rounding.
const THINNEST: f64 = 1e-9;

impl SurfaceMap {
    /// A map between two meshes with the same triangles in the same order.
    ///
    /// # Errors
    /// Where the triangles differ, where they are no disk, and where one has no area or is folded over, by its index.
    pub fn new(closed: TriMesh, open: TriMesh) -> Result<Self, RemeshError> {
        if closed.vertices.len() != open.vertices.len() || closed.faces.len() != open.faces.len() {
            let counts = |mesh: &TriMesh| [mesh.vertices.len(), mesh.faces.len()];
            return Err(RemeshError::Counts { closed: counts(&closed), open: counts(&open) });
        }
        if let Some(face) = (0..open.faces.len()).find(|&f| closed.faces[f] != open.faces[f]) {
            return Err(RemeshError::Differs { face, closed: closed.faces[face], open: open.faces[face] });
        }
        let faces = open.faces.iter().map(|face| face.to_vec()).collect();
        let boundary = check_disk(&PolyMesh { vertices: open.vertices.clone(), faces })?.boundary;
        for (mesh, state) in [(&closed, "closed"), (&open, "open")] {
            check_areas(mesh, state)?;
            check_folds(mesh, state)?;
        }
        Ok(Self { closed, open, boundary })
    }

    /// The closed state.
    pub fn closed(&self) -> &TriMesh {
        &self.closed
    }

    /// The open state.
    pub fn open(&self) -> &TriMesh {
        &self.open
    }

    /// The boundary loop, the surface on its left.
    pub fn boundary(&self) -> &[usize] {
        &self.boundary
    }

    /// Area of the open surface, square millimetres.
    pub fn area(&self) -> f64 {
        self.open.faces.iter().map(|face| 0.5 * normal(&self.open, face).norm()).sum()
    }

    /// Principal stretches of all triangles: the singular values of the differential.
    pub fn principal(&self) -> Vec<Principal> {
        self.open.faces.iter().map(|face| self.principal_of(face)).collect()
    }

    fn principal_of(&self, face: &[usize; 3]) -> Principal {
        let closing = Gradients::new(&self.open, face).map_to(laid_out(&self.closed, face));
        let [shrunk_least, shrunk_most] = closing.singular_values();
        let stretches = [1.0 / shrunk_most, 1.0 / shrunk_least];
        // Closing keeps most of the direction in which its two parts agree; opening stretches most across it.
        let along = (closing.mirroring * closing.turning.conj()).sqrt();
        let length = along.norm();
        let i = Complex::new(0.0, 1.0);
        let direction = if length > 0.0 { i * along / length } else { Complex::new(1.0, 0.0) };
        let ratio = (stretches[0] / stretches[1]).ln();
        Principal { stretches, direction, weight: ratio * ratio / (ratio * ratio + FAINT * FAINT), closing }
    }
}

impl Principal {
    /// Stretch of a direction (any vector of the open triangle's frame).
    pub fn along(&self, direction: Complex<f64>) -> f64 {
        direction.norm() / self.closing.apply(direction).norm()
    }
}

fn normal(mesh: &TriMesh, face: &[usize; 3]) -> Vector3 {
    let [a, b, c] = face.map(|v| mesh.vertices[v]);
    (b - a).cross(&(c - a))
}

fn check_areas(mesh: &TriMesh, state: &'static str) -> Result<(), RemeshError> {
    let thin = |face: &[usize; 3]| {
        let [a, b, c] = face.map(|v| mesh.vertices[v]);
        let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
        let height = normal(mesh, face).norm() / (longest * longest);
        // Not a number, from a longest edge of zero or infinity, counts as thin.
        height.is_nan() || height <= THINNEST
    };
    match mesh.faces.iter().position(thin) {
        Some(face) => Err(RemeshError::NoArea { face, state }),
        None => Ok(()),
    }
}

/// Checks that no two neighbours lie on each other; of a flat mesh, that no triangle is turned over.
fn check_folds(mesh: &TriMesh, state: &'static str) -> Result<(), RemeshError> {
    let normals: Vec<Vector3> = mesh.faces.iter().map(|face| normal(mesh, face).normalize()).collect();
    let neighbours = crate::geometry::topology::edges(&mesh.faces)
        .map_err(|defect| RemeshError::NotADisk(crate::geometry::topology::NotADisk { at: None, defect }))?;
    let fold = neighbours.iter().find_map(|edge| {
        let right = edge.right?;
        (normals[edge.left].dot(&normals[right]) < FOLDED).then_some([edge.left, right])
    });
    let Some([one, other]) = fold else { return Ok(()) };
    // The one that differs from the surface as a whole is the folded one.
    let whole: Vector3 = mesh.faces.iter().map(|face| normal(mesh, face)).sum();
    let face = if normals[one].dot(&whole) < normals[other].dot(&whole) { one } else { other };
    Err(RemeshError::Folded { face, state })
}
