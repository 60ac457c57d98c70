//! Connectivity of a mesh: edges, boundary loops, and whether the mesh is a disk.
//!
//! Everything works on faces as slices of vertex indices, so that it serves polygon and triangle meshes alike.
//! Indices in results count from 0; messages count vertices and faces from 1, as OBJ files do.

use super::mesh::PolyMesh;
use super::union_find::UnionFind;

mod defect;
mod orient;

pub use defect::{Defect, NotADisk};
pub use orient::orient;

/// A surface with the topology of a disk.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Disk {
    /// The vertices of the one boundary loop, in the direction of the faces' half-edges: the surface lies on the
    /// left. Begins with the least index.
    pub boundary: Vec<usize>,
}

/// An edge of an oriented manifold mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Edge {
    /// The two vertices, in the direction in which `left` runs through them.
    pub vertices: [usize; 2],
    /// The face on the left, seen from the side that the normals point to.
    pub left: usize,
    /// The face on the right, which runs the other way; `None` at the boundary.
    pub right: Option<usize>,
}

/// Checks that `mesh` is a disk: manifold, consistently wound, connected, one boundary loop, no handles.
///
/// # Errors
/// Says what the mesh is instead, where, and what to do.
pub fn check_disk(mesh: &PolyMesh) -> Result<Disk, NotADisk> {
    disk(&mesh.faces).map_err(|defect| {
        let vertex = match &defect {
            Defect::BranchingEdge { edge, .. }
            | Defect::Winding { edge, .. }
            | Defect::OneSided { edge, .. } => Some(edge[0]),
            Defect::PinchedVertex { vertex, .. } => Some(*vertex),
            _ => None,
        };
        NotADisk { at: vertex.and_then(|vertex| mesh.vertices.get(vertex).copied()), defect }
    })
}

/// Checks that `faces` form a disk; see [`check_disk`].
///
/// # Errors
/// Says what the faces form instead.
pub fn disk<F: AsRef<[usize]>>(faces: &[F]) -> Result<Disk, Defect> {
    if faces.is_empty() {
        return Err(Defect::NoFaces);
    }
    let half_edges = sorted_half_edges(faces);
    let edges = pair_half_edges(&half_edges, faces.len())?;
    check_fans(faces, &half_edges)?;
    check_connected(faces.len(), &edges)?;
    let mut loops = boundary_loops(&edges);
    let sizes = descending(loops.iter().map(Vec::len));
    match (genus(faces, edges.len(), loops.len()), loops.len()) {
        (0, 1) => Ok(Disk { boundary: loops.swap_remove(0) }),
        (genus, 0) => Err(Defect::Closed { genus }),
        (0, _) => Err(Defect::Holes { loops: sizes }),
        (genus, _) => Err(Defect::Handles { genus, loops: sizes }),
    }
}

/// The edges of `faces`, ordered by their lesser and then their greater vertex.
///
/// # Errors
/// [`Defect::BranchingEdge`], [`Defect::Winding`] or [`Defect::OneSided`].
pub fn edges<F: AsRef<[usize]>>(faces: &[F]) -> Result<Vec<Edge>, Defect> {
    pair_half_edges(&sorted_half_edges(faces), faces.len())
}

/// The boundary loops of the `edges` of a manifold mesh, each with the surface on its left and beginning with its
/// least vertex, ordered by that vertex. Empty for a closed surface.
pub fn boundary_loops(edges: &[Edge]) -> Vec<Vec<usize>> {
    let vertex_count = edges.iter().map(|edge| edge.vertices[0].max(edge.vertices[1]) + 1).max().unwrap_or(0);
    let mut next = vec![None; vertex_count];
    for edge in edges.iter().filter(|edge| edge.right.is_none()) {
        next[edge.vertices[0]] = Some(edge.vertices[1]);
    }
    let mut loops = Vec::new();
    for start in 0..vertex_count {
        let mut boundary = Vec::new();
        let mut at = start;
        while let Some(following) = next[at].take() {
            boundary.push(at);
            at = following;
        }
        if !boundary.is_empty() {
            loops.push(boundary);
        }
    }
    loops
}

/// A face's way through an edge.
#[derive(Debug, Clone, Copy)]
struct HalfEdge {
    /// Lesser and greater vertex.
    edge: [usize; 2],
    face: usize,
    /// Whether the face runs from the lesser to the greater vertex.
    ascends: bool,
    /// The corners at the lesser and the greater vertex, counted through all faces.
    corners: [usize; 2],
}

impl HalfEdge {
    /// The two vertices in the direction of the face.
    fn direction(&self) -> [usize; 2] {
        let [lesser, greater] = self.edge;
        if self.ascends { [lesser, greater] } else { [greater, lesser] }
    }
}

/// All half-edges; those of one edge are neighbours, in the order of their faces.
fn sorted_half_edges<F: AsRef<[usize]>>(faces: &[F]) -> Vec<HalfEdge> {
    let mut half_edges = Vec::new();
    let mut first_corner = 0;
    for (face, vertices) in faces.iter().map(AsRef::as_ref).enumerate() {
        for (i, &from) in vertices.iter().enumerate() {
            let j = (i + 1) % vertices.len();
            let to = vertices[j];
            let corners = [first_corner + i, first_corner + j];
            half_edges.push(if from < to {
                HalfEdge { edge: [from, to], face, ascends: true, corners }
            } else {
                HalfEdge { edge: [to, from], face, ascends: false, corners: [corners[1], corners[0]] }
            });
        }
        first_corner += vertices.len();
    }
    half_edges.sort_unstable_by_key(|h| (h.edge, h.face, h.corners));
    half_edges
}

/// The half-edges of one edge after the other.
fn by_edge(half_edges: &[HalfEdge]) -> impl Iterator<Item = &[HalfEdge]> {
    half_edges.chunk_by(|a, b| a.edge == b.edge)
}

/// Checks that at most two faces meet in each edge and run through it in opposite directions.
fn pair_half_edges(half_edges: &[HalfEdge], face_count: usize) -> Result<Vec<Edge>, Defect> {
    if let Some(group) = by_edge(half_edges).find(|group| group.len() > 2) {
        let faces = group.iter().map(|h| h.face).collect();
        return Err(Defect::BranchingEdge { edge: group[0].edge, faces });
    }
    check_winding(half_edges, face_count)?;
    let edges = by_edge(half_edges).map(|group| match *group {
        // The face that runs from the lesser to the greater vertex is taken for the left one.
        [a, b] if b.ascends => Edge { vertices: b.direction(), left: b.face, right: Some(a.face) },
        [a, b] => Edge { vertices: a.direction(), left: a.face, right: Some(b.face) },
        _ => Edge { vertices: group[0].direction(), left: group[0].face, right: None },
    });
    Ok(edges.collect())
}

/// Checks that the two faces of each edge run through it in opposite directions.
fn check_winding(half_edges: &[HalfEdge], face_count: usize) -> Result<(), Defect> {
    let mut wrong =
        by_edge(half_edges).filter(|group| group.len() == 2 && group[0].ascends == group[1].ascends);
    let Some(first) = wrong.next() else { return Ok(()) };
    let more = wrong.count();
    // Nodes 2f and 2f + 1 stand for face f as it is and turned over; joined nodes belong together.
    let mut sides = UnionFind::new(2 * face_count);
    for group in by_edge(half_edges).filter(|group| group.len() == 2) {
        let turned = usize::from(group[0].ascends == group[1].ascends);
        let (a, b) = (2 * group[0].face, 2 * group[1].face);
        sides.join(a, b + turned);
        sides.join(a + 1, b + 1 - turned);
    }
    let faces = [first[0].face, first[1].face];
    let edge = first[0].direction();
    if (0..face_count).any(|face| sides.same(2 * face, 2 * face + 1)) {
        return Err(Defect::OneSided { edge, faces });
    }
    Err(Defect::Winding { edge, faces, more })
}

/// Checks that the corners at each vertex hang together through edges.
fn check_fans<F: AsRef<[usize]>>(faces: &[F], half_edges: &[HalfEdge]) -> Result<(), Defect> {
    let corners: Vec<(usize, usize)> = faces
        .iter()
        .enumerate()
        .flat_map(|(face, vertices)| vertices.as_ref().iter().map(move |&vertex| (vertex, face)))
        .collect();
    let mut fans = UnionFind::new(corners.len());
    for group in by_edge(half_edges).filter(|group| group.len() == 2) {
        fans.join(group[0].corners[0], group[1].corners[0]);
        fans.join(group[0].corners[1], group[1].corners[1]);
    }
    // One face of each fan, in the order of vertices.
    let mut firsts: Vec<(usize, usize)> =
        (0..corners.len()).filter(|&corner| fans.root(corner) == corner).map(|root| corners[root]).collect();
    firsts.sort_unstable();
    for group in firsts.chunk_by(|a, b| a.0 == b.0) {
        if let [(vertex, first), (_, second), ..] = *group {
            return Err(Defect::PinchedVertex { vertex, fans: group.len(), faces: [first, second] });
        }
    }
    Ok(())
}

/// Checks that all faces hang together through edges.
fn check_connected(face_count: usize, edges: &[Edge]) -> Result<(), Defect> {
    let mut components = UnionFind::new(face_count);
    for edge in edges {
        if let Some(right) = edge.right {
            components.join(edge.left, right);
        }
    }
    let mut size = vec![0; face_count];
    for face in 0..face_count {
        size[components.root(face)] += 1;
    }
    let sizes = descending(size.into_iter().filter(|&size| size > 0));
    if sizes.len() > 1 { Err(Defect::Components { sizes }) } else { Ok(()) }
}

/// Number of handles of a connected, oriented manifold: Euler's V - E + F = 2 - 2 genus - loops.
fn genus<F: AsRef<[usize]>>(faces: &[F], edge_count: usize, loop_count: usize) -> usize {
    let mut vertices: Vec<usize> = faces.iter().flat_map(|face| face.as_ref()).copied().collect();
    vertices.sort_unstable();
    vertices.dedup();
    (2 + edge_count).saturating_sub(vertices.len() + faces.len() + loop_count) / 2
}

fn descending(sizes: impl Iterator<Item = usize>) -> Vec<usize> {
    let mut sizes: Vec<usize> = sizes.collect();
    sizes.sort_unstable_by(|a, b| b.cmp(a));
    sizes
}

#[cfg(test)]
mod tests;
