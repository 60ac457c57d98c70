//! Meshes as their readers promise them.

use kirimorph::geometry::mesh::PolyMesh;

/// What the readers promise of every mesh.
pub fn assert_sound(mesh: &PolyMesh) {
    assert!(!mesh.faces.is_empty());
    assert!(mesh.vertices.iter().all(|v| v.iter().all(|x| x.abs() <= 1e9)));
    for face in &mesh.faces {
        let mut vertices = face.clone();
        vertices.sort_unstable();
        vertices.dedup();
        assert_eq!(vertices.len(), face.len());
        assert!(face.len() >= 3 && face.iter().all(|&v| v < mesh.vertices.len()));
    }
}
