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
