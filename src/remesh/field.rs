//! A smooth cross field: in each triangle four directions at right angles, as one complex number.
//!
//! A cross is kept as the fourth power `z` of any of its directions, in the frame of its triangle. The field is
//! the least sum of the squared differences of neighbours (a direction passes an edge as if the two triangles
//! were laid flat) and of the squared distances from the directions asked for, each with a weight: one sparse
//! linear system (F. Knöppel et al., *Globally optimal direction fields*, 2013; O. Diamanti et al., *Designing
//! n-PolyVector fields*, 2014). Where nothing is asked for, the field is the smoothest continuation.

use super::links::Links;
use super::map::Principal;
use crate::solver::cholesky::CholeskyPattern;
use nalgebra::Complex;

/// What the field is to follow.
#[derive(Debug, Clone, Copy)]
pub struct Wishes {
    /// Length over which wishes are evened out, millimetres: detail that is much smaller is not followed.
    pub length: f64,
    /// Weight of the boundary's directions, where a direction of the map that means much has 1.
    pub boundary: f64,
}

/// Weight of the boundary where it is not to be followed: it decides only where no direction means anything.
pub const FAINT_BOUNDARY: f64 = 1e-9;

/// Least weight of a triangle, so that the system is definite.
const REST: f64 = 1e-12;

/// How much the crosses of neighbours differ, as a sparse matrix, and what each triangle asks for.
pub struct Smoothness<'a> {
    links: &'a Links,
    principal: &'a [Principal],
    areas: Vec<f64>,
    pattern: CholeskyPattern,
    /// Without wishes.
    values: Vec<f64>,
}

impl<'a> Smoothness<'a> {
    /// Of the triangles of a surface.
    pub fn new(links: &'a Links, principal: &'a [Principal]) -> Self {
        let count = principal.len();
        let areas: Vec<f64> = links.edges.iter().map(|[ab, bc, _]| 0.5 * (ab.conj() * bc).im).collect();
        let edges = (0..count).flat_map(|f| (0..3).map(move |i| (f, i)));
        let couples: Vec<(usize, usize, Complex<f64>, f64)> = edges
            .filter_map(|(f, i)| {
                let (g, _) = links.across[f][i].filter(|&(g, _)| f < g)?;
                // The edge times its dual is two thirds of the two areas: twice the diamond around the edge.
                let weight = 1.5 * links.edges[f][i].norm_sqr() / (areas[f] + areas[g]);
                Some((f, g, links.turn(f, i)?.powu(4), weight))
            })
            .collect();
        let block = |&(f, g, ..): &(usize, usize, Complex<f64>, f64)| {
            [(2 * g, 2 * f), (2 * g, 2 * f + 1), (2 * g + 1, 2 * f), (2 * g + 1, 2 * f + 1)]
        };
        let pattern = CholeskyPattern::new(2 * count, couples.iter().flat_map(block));
        let mut values = vec![0.0; pattern.entries()];
        for couple in &couples {
            let &(f, g, turn, weight) = couple;
            for k in [2 * f, 2 * f + 1, 2 * g, 2 * g + 1] {
                values[pattern.diagonal(k)] += weight;
            }
            // |z_g - turn z_f|^2, the rows of g.
            for ((row, column), value) in block(couple).into_iter().zip([turn.re, -turn.im, turn.im, turn.re])
            {
                values[pattern.slot(row, column)] -= weight * value;
            }
        }
        Self { links, principal, areas, pattern, values }
    }

    /// A direction of the cross of each triangle, a unit complex number in the triangle's frame; `None` where the
    /// system cannot be solved because triangles are too thin.
    pub fn field(&self, wishes: Wishes) -> Option<Vec<Complex<f64>>> {
        let mut values = self.values.clone();
        let mut rhs = vec![0.0; 2 * self.areas.len()];
        for (f, area) in self.areas.iter().enumerate() {
            let (weight, wish) = wished(self.links, f, &self.principal[f], wishes.boundary);
            let scale = area / (wishes.length * wishes.length);
            for (k, part) in [wish.re, wish.im].into_iter().enumerate() {
                values[self.pattern.diagonal(2 * f + k)] += scale * (weight + REST);
                rhs[2 * f + k] = scale * part;
            }
        }
        self.pattern.factor(&values)?.solve_in_place(&mut rhs);
        Some(roots(&rhs))
    }

    /// The smoothest field that there is, turned as a whole to fit the wishes best: the eigenvector of the least
    /// eigenvalue. The last resort where directions turn so evenly that smoothing does not change them.
    pub fn smoothest(&self) -> Option<Vec<Complex<f64>>> {
        let total: f64 = self.areas.iter().sum();
        let mut values = self.values.clone();
        for (f, area) in self.areas.iter().enumerate() {
            (0..2).for_each(|k| values[self.pattern.diagonal(2 * f + k)] += SHIFT * area / total);
        }
        let factor = self.pattern.factor(&values)?;
        // Anything that is not perpendicular to the eigenvector will do for a start: the frames as they come.
        let mut z: Vec<f64> = (0..2 * self.areas.len()).map(|k| if k % 2 == 0 { 1.0 } else { 0.3 }).collect();
        for _ in 0..POWER_STEPS {
            z.chunks_exact_mut(2)
                .zip(&self.areas)
                .for_each(|(z, area)| z.iter_mut().for_each(|z| *z *= area));
            factor.solve_in_place(&mut z);
            let length = z.iter().map(|z| z * z).sum::<f64>().sqrt();
            z.iter_mut().for_each(|z| *z /= length);
        }
        let fit = |boundary: f64| -> Complex<f64> {
            let pull = |f: usize| {
                let (_, wish) = wished(self.links, f, &self.principal[f], boundary);
                wish * Complex::new(z[2 * f], -z[2 * f + 1]) * self.areas[f]
            };
            (0..self.areas.len()).map(pull).sum()
        };
        // Where the directions do not agree on any turn, the boundary decides.
        let weights: f64 = z
            .chunks_exact(2)
            .zip(&self.areas)
            .zip(self.principal)
            .map(|((z, area), p)| z[0].hypot(z[1]) * area * p.weight)
            .sum();
        let turn = if fit(0.0).norm() > AGREED * weights { fit(0.0) } else { fit(1.0) };
        let turned: Vec<f64> =
            z.chunks_exact(2).map(|z| Complex::new(z[0], z[1]) * turn).flat_map(|z| [z.re, z.im]).collect();
        Some(roots(&turned))
    }
}

/// Shift of the eigenvalues, in parts of one over the area: below the least one of curved surfaces, so that few
/// steps suffice, and far above rounding.
const SHIFT: f64 = 1e-3;

/// Steps of inverse iteration.
const POWER_STEPS: usize = 20;

/// Part of the directions that must agree on one turn of the whole field for it to be followed.
const AGREED: f64 = 0.05;

/// Unit fourth roots of complex numbers.
fn roots(z: &[f64]) -> Vec<Complex<f64>> {
    let root = |z: &[f64]| Complex::new(z[0], z[1]).powf(0.25);
    let unit = |z: Complex<f64>| if z.norm() > 0.0 { z / z.norm() } else { Complex::new(1.0, 0.0) };
    z.chunks_exact(2).map(|z| unit(root(z))).collect()
}

/// Total weight of the wishes of a triangle, and the sum of their fourth powers times their weights.
fn wished(links: &Links, f: usize, principal: &Principal, strength: f64) -> (f64, Complex<f64>) {
    let mut weight = principal.weight;
    let mut wish = principal.direction.powu(4) * principal.weight;
    for i in (0..3).filter(|&i| links.across[f][i].is_none()) {
        let edge = links.edges[f][i];
        weight += strength;
        wish += (edge / edge.norm()).powu(4) * strength;
    }
    (weight, wish)
}
