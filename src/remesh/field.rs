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
    /// Whether the field is to follow the boundary.
    pub boundary: bool,
}

/// Weight of the boundary against the inner directions where it is to be followed: a tenth of a degree.
const BOUNDARY: f64 = 1e4;

/// Weight of the boundary otherwise: it decides only where no direction means anything.
const FAINT_BOUNDARY: f64 = 1e-9;

/// Least weight of a triangle, so that the system is definite.
const REST: f64 = 1e-12;

/// A direction of the cross of each triangle, a unit complex number in the triangle's frame; `None` where the
/// system cannot be solved because triangles are too thin.
pub fn cross_field(links: &Links, principal: &[Principal], wishes: Wishes) -> Option<Vec<Complex<f64>>> {
    let count = principal.len();
    let areas: Vec<f64> = links.edges.iter().map(|[ab, bc, _]| 0.5 * (ab.conj() * bc).im).collect();
    let neighbours = (0..count).flat_map(|f| (0..3).map(move |i| (f, i)));
    let neighbours: Vec<(usize, usize, Complex<f64>, f64)> = neighbours
        .filter_map(|(f, i)| {
            let (g, _) = links.across[f][i]?;
            // The edge times its dual is two thirds of the two areas: twice the diamond around the edge.
            let weight = 1.5 * links.edges[f][i].norm_sqr() / (areas[f] + areas[g]);
            (f < g).then_some((f, g, links.turn(f, i)?.powu(4), weight))
        })
        .collect();
    let couples = neighbours.iter().map(|n| (n.0.max(n.1), n.0.min(n.1)));
    let entries = couples
        .flat_map(|(a, b)| [(2 * a, 2 * b), (2 * a, 2 * b + 1), (2 * a + 1, 2 * b), (2 * a + 1, 2 * b + 1)]);
    let pattern = CholeskyPattern::new(2 * count, entries);
    let mut values = vec![0.0; pattern.entries()];
    let mut rhs = vec![0.0; 2 * count];
    for f in 0..count {
        let (weight, wish) = wished(links, f, &principal[f], wishes.boundary);
        let scale = areas[f] / (wishes.length * wishes.length);
        for (k, part) in [wish.re, wish.im].into_iter().enumerate() {
            values[pattern.diagonal(2 * f + k)] += scale * (weight + REST);
            rhs[2 * f + k] += scale * part;
        }
    }
    for &(f, g, turn, weight) in &neighbours {
        for k in [2 * f, 2 * f + 1, 2 * g, 2 * g + 1] {
            values[pattern.diagonal(k)] += weight;
        }
        // |z_g - turn z_f|^2; the lower triangle holds the rows of the later triangle, here g.
        for (row, column, value) in [(0, 0, turn.re), (0, 1, -turn.im), (1, 0, turn.im), (1, 1, turn.re)] {
            values[pattern.slot(2 * g + row, 2 * f + column)] -= weight * value;
        }
    }
    pattern.factor(&values)?.solve_in_place(&mut rhs);
    let root = |z: &[f64]| Complex::new(z[0], z[1]).powf(0.25);
    let unit = |z: Complex<f64>| if z.norm() > 0.0 { z / z.norm() } else { Complex::new(1.0, 0.0) };
    Some(rhs.chunks_exact(2).map(|z| unit(root(z))).collect())
}

/// Total weight of the wishes of a triangle, and the sum of their fourth powers times their weights.
fn wished(links: &Links, f: usize, principal: &Principal, boundary: bool) -> (f64, Complex<f64>) {
    let strength = if boundary { BOUNDARY } else { FAINT_BOUNDARY };
    let mut weight = principal.weight;
    let mut wish = principal.direction.powu(4) * principal.weight;
    for i in (0..3).filter(|&i| links.across[f][i].is_none()) {
        let edge = links.edges[f][i];
        weight += strength;
        wish += (edge / edge.norm()).powu(4) * strength;
    }
    (weight, wish)
}
