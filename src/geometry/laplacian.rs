//! The cotangent Laplacian of a mesh with some vertices held, factorised.

use super::cotangent::half_cotangents;
use super::mesh::TriMesh;
use crate::solver::cholesky::{CholeskyFactor, CholeskyPattern};

/// The cotangent Laplacian of a mesh, factorised over the vertices that are not fixed.
pub struct Laplacian {
    edges: Vec<(usize, usize, f64)>,
    /// Position of each free vertex among the unknowns; `None` for fixed ones.
    unknown: Vec<Option<usize>>,
    factor: CholeskyFactor,
    free: usize,
}

impl Laplacian {
    /// Factorises the Laplacian over the vertices that are not fixed; `None` where triangles are too thin.
    pub fn new(mesh: &TriMesh, fixed: &[bool]) -> Option<Self> {
        let mut edges = Vec::with_capacity(3 * mesh.faces.len());
        for (face, halves) in mesh.faces.iter().zip(half_cotangents(mesh)) {
            for i in 0..3 {
                edges.push((face[(i + 1) % 3], face[(i + 2) % 3], halves[i]));
            }
        }
        let mut free = 0;
        let unknown: Vec<Option<usize>> = fixed
            .iter()
            .map(|&held| {
                (!held).then(|| {
                    free += 1;
                    free - 1
                })
            })
            .collect();
        let inner = edges.iter().filter_map(|&(i, j, _)| Some((unknown[i]?, unknown[j]?)));
        let pattern = CholeskyPattern::new(free, inner.map(|(i, j)| (i.max(j), i.min(j))));
        let mut values = vec![0.0; pattern.entries()];
        for &(i, j, w) in &edges {
            for end in [unknown[i], unknown[j]].into_iter().flatten() {
                values[pattern.diagonal(end)] += w;
            }
            if let (Some(i), Some(j)) = (unknown[i], unknown[j]) {
                values[pattern.slot(i.max(j), i.min(j))] -= w;
            }
        }
        let factor = pattern.factor(&values)?;
        Some(Self { edges, unknown, factor, free })
    }

    /// `L u = rhs` at free vertices, `u = held` at fixed ones. All slices are #V.
    pub fn solve(&self, rhs: &[f64], held: &[f64]) -> Vec<f64> {
        let mut reduced = vec![0.0; self.free];
        for (value, unknown) in rhs.iter().zip(&self.unknown) {
            if let Some(i) = unknown {
                reduced[*i] = *value;
            }
        }
        for &(i, j, w) in &self.edges {
            match (self.unknown[i], self.unknown[j]) {
                (Some(free), None) => reduced[free] += w * held[j],
                (None, Some(free)) => reduced[free] += w * held[i],
                _ => (),
            }
        }
        self.factor.solve_in_place(&mut reduced);
        self.unknown.iter().zip(held).map(|(unknown, value)| unknown.map_or(*value, |i| reduced[i])).collect()
    }

    /// `L u` at all vertices.
    pub fn apply(&self, u: &[f64]) -> Vec<f64> {
        let mut result = vec![0.0; u.len()];
        for &(i, j, w) in &self.edges {
            result[i] += w * (u[i] - u[j]);
            result[j] += w * (u[j] - u[i]);
        }
        result
    }
}
