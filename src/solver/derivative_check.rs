//! Comparison of a term's Jacobian with central differences.

use super::Term;

/// Largest difference between the Jacobian of `term` at `x` and central differences with step `h`, over all
/// blocks, relative to the block's largest entry (at least 1).
pub fn largest_jacobian_error(term: &dyn Term, x: &[f64], h: f64) -> f64 {
    let mut worst = 0.0_f64;
    let mut moved = x.to_vec();
    for b in 0..term.blocks() {
        let unknowns = term.unknowns(b).to_vec();
        let (rows, columns) = (term.rows(b), unknowns.len());
        let evaluate = |point: &[f64]| {
            let (mut residuals, mut jacobian) = (vec![0.0; rows], vec![0.0; rows * columns]);
            term.evaluate(b, point, &mut residuals, &mut jacobian);
            (residuals, jacobian)
        };
        let (_, jacobian) = evaluate(x);
        let scale = jacobian.iter().fold(1.0_f64, |m, v| m.max(v.abs()));
        for (column, &u) in unknowns.iter().enumerate() {
            moved[u] = x[u] + h;
            let (ahead, _) = evaluate(&moved);
            moved[u] = x[u] - h;
            let (behind, _) = evaluate(&moved);
            moved[u] = x[u];
            for row in 0..rows {
                let difference = (ahead[row] - behind[row]) / (2.0 * h);
                worst = worst.max((difference - jacobian[row * columns + column]).abs() / scale);
            }
        }
    }
    worst
}
