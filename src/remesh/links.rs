//! How the triangles of a surface hang together, and how directions pass from one to the next.

use crate::geometry::mesh::TriMesh;
use crate::geometry::stretch::laid_out;
use nalgebra::Complex;
use std::collections::BTreeMap;

/// Neighbours and edges of each triangle. Edge `i` runs from corner `i` to corner `i + 1`.
#[derive(Debug, Clone)]
pub struct Links {
    /// #F: the triangle across each edge, with the edge's number there; `None` at the boundary.
    pub across: Vec<[Option<(usize, usize)>; 3]>,
    /// #F: each edge as a vector of the triangle's frame, which begins along its first edge.
    pub edges: Vec<[Complex<f64>; 3]>,
    /// #V: a triangle at the vertex and the number of its corner there; at the boundary the first one
    /// counter-clockwise; `None` for a vertex without triangles.
    pub first: Vec<Option<(usize, usize)>>,
}

impl Links {
    /// Of an oriented manifold.
    pub fn new(mesh: &TriMesh) -> Self {
        let mut half_edges = BTreeMap::new();
        for (f, face) in mesh.faces.iter().enumerate() {
            half_edges.extend((0..3).map(|i| ((face[i], face[(i + 1) % 3]), (f, i))));
        }
        let mut first = vec![None; mesh.vertices.len()];
        let mut across = Vec::with_capacity(mesh.faces.len());
        for (f, face) in mesh.faces.iter().enumerate() {
            let row: [_; 3] = std::array::from_fn(|i| half_edges.get(&(face[(i + 1) % 3], face[i])).copied());
            for i in 0..3 {
                if first[face[i]].is_none() || row[i].is_none() {
                    first[face[i]] = Some((f, i));
                }
            }
            across.push(row);
        }
        let edges = mesh.faces.iter().map(|face| {
            let p = laid_out(mesh, face).map(|p| Complex::new(p.x, p.y));
            std::array::from_fn(|i| p[(i + 1) % 3] - p[i])
        });
        Self { edges: edges.collect(), across, first }
    }

    /// The factor that takes a direction of triangle `f` to its neighbour across edge `i`; `None` at the boundary.
    pub fn turn(&self, f: usize, i: usize) -> Option<Complex<f64>> {
        let (g, j) = self.across[f][i]?;
        let (here, there) = (self.edges[f][i], -self.edges[g][j]);
        let turn = there * here.conj();
        Some(turn / turn.norm())
    }

    /// The next triangle counter-clockwise around corner `i` of triangle `f`, with its corner.
    pub fn next_around(&self, (f, i): (usize, usize)) -> Option<(usize, usize)> {
        self.across[f][(i + 2) % 3]
    }

    /// The triangles around a vertex from `start` on counter-clockwise, each with its corner there.
    pub fn fan(&self, start: (usize, usize)) -> impl Iterator<Item = (usize, usize)> + '_ {
        let follow = move |&at: &(usize, usize)| self.next_around(at).filter(|&next| next != start);
        std::iter::successors(Some(start), follow)
    }
}
