//! Values along a network of lines: given at some nodes, between them in proportion to the length, and where lines meet
//! the mean of what they bring, weighted by the inverse of their lengths.

use kurbo::{Point, Vec2};

/// Relative size of the residual at which the conjugate gradients stop: rounding of slopes times a thick sheet.
const PRECISION: f64 = 1e-12;

/// The values at all nodes. Parts of the network without any given value have 0.
///
/// `ends`: the nodes of every edge; `given`: per node.
pub fn fill(nodes: &[Point], ends: &[[usize; 2]], given: &[Option<Vec2>]) -> Vec<Vec2> {
    let weights: Vec<f64> = ends.iter().map(|&[a, b]| 1.0 / nodes[a].distance(nodes[b]).max(1e-6)).collect();
    let mut diagonal = vec![0.0; nodes.len()];
    for (&[a, b], weight) in ends.iter().zip(&weights) {
        diagonal[a] += weight;
        diagonal[b] += weight;
    }
    let free = |node: usize| given[node].is_none() && diagonal[node] > 0.0;
    // The Laplacian of a field, zero at nodes with given values.
    let laplacian = |field: &[Vec2]| {
        let mut out = vec![Vec2::ZERO; nodes.len()];
        for (&[a, b], &weight) in ends.iter().zip(&weights) {
            let flow = weight * (field[a] - field[b]);
            out[a] += flow;
            out[b] -= flow;
        }
        for (node, value) in out.iter_mut().enumerate() {
            if !free(node) {
                *value = Vec2::ZERO;
            }
        }
        out
    };
    let mut field: Vec<Vec2> = given.iter().map(|value| value.unwrap_or_default()).collect();
    let mut residual: Vec<Vec2> = laplacian(&field).into_iter().map(|value| -value).collect();
    let scaled = |r: &[Vec2]| -> Vec<Vec2> {
        r.iter().zip(&diagonal).map(|(&r, d)| if *d > 0.0 { r / *d } else { r }).collect()
    };
    let dot = |a: &[Vec2], b: &[Vec2]| -> f64 { a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum() };
    let mut z = scaled(&residual);
    let mut direction = z.clone();
    let mut rz = dot(&residual, &z);
    let limit = PRECISION * PRECISION * rz;
    for _ in 0..4 * nodes.len() {
        if rz <= limit || rz == 0.0 {
            break;
        }
        let image = laplacian(&direction);
        let step = rz / dot(&direction, &image);
        field.iter_mut().zip(&direction).for_each(|(f, d)| *f += step * *d);
        residual.iter_mut().zip(&image).for_each(|(r, i)| *r -= step * *i);
        z = scaled(&residual);
        let next = dot(&residual, &z);
        direction.iter_mut().zip(&z).for_each(|(d, z)| *d = *z + next / rz * *d);
        rz = next;
    }
    field
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chain_is_linear_in_its_length_and_a_star_takes_the_weighted_mean() {
        let nodes = [0.0, 1.0, 4.0, 5.0].map(|x| Point::new(x, 0.0));
        let given = [Some(Vec2::new(1.0, 0.0)), None, None, Some(Vec2::new(6.0, -5.0))];
        let found = fill(&nodes, &[[0, 1], [2, 1], [2, 3]], &given);
        for (value, x) in found.iter().zip([0.0, 1.0, 4.0, 5.0]) {
            assert!((*value - Vec2::new(1.0 + x, -x)).hypot() < 1e-12, "{found:?}");
        }
        let star = [(0.0, 0.0), (1.0, 0.0), (0.0, 2.0), (-4.0, 0.0), (9.0, 9.0)].map(Point::from);
        let unit = |x: f64| Some(Vec2::new(x, 2.0 * x));
        let given = [None, unit(1.0), unit(2.0), unit(4.0), None];
        let mean = (1.0 / 1.0 + 2.0 / 2.0 + 4.0 / 4.0) / (1.0 + 0.5 + 0.25);
        let found = fill(&star, &[[0, 1], [0, 2], [0, 3]], &given);
        assert!((found[0] - Vec2::new(mean, 2.0 * mean)).hypot() < 1e-12);
        assert_eq!(found[4], Vec2::ZERO);
    }
}
