//! Polygon and triangle meshes as plain index arrays.

use super::Point3;

/// A polygon mesh as read from a file: faces are vertex indices, three or more each, in the file's order.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PolyMesh {
    /// Vertex positions, in the file's units.
    pub vertices: Vec<Point3>,
    /// Faces, counter-clockwise seen from outside.
    pub faces: Vec<Vec<usize>>,
}

/// A triangle mesh. Faces are counter-clockwise seen from the side that the normals point to.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TriMesh {
    /// #V positions, millimetres.
    pub vertices: Vec<Point3>,
    /// #F triangles, indices into `vertices`.
    pub faces: Vec<[usize; 3]>,
}

impl TriMesh {
    /// The corners of its triangles, in order.
    pub fn triangles(&self) -> impl ExactSizeIterator<Item = [Point3; 3]> {
        self.faces.iter().map(|face| face.map(|v| self.vertices[v]))
    }

    /// Sum of the areas of its triangles.
    pub fn area(&self) -> f64 {
        let triangle = |face: &[usize; 3]| {
            let [a, b, c] = face.map(|v| self.vertices[v]);
            0.5 * (b - a).cross(&(c - a)).norm()
        };
        self.faces.iter().map(triangle).sum()
    }
}
