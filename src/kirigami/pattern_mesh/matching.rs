//! Pairing an even number of things off so that the pairs' distances sum up to little.

/// Up to this number of things the best pairs of all are found (the time grows as n 2^n: 16 take milliseconds).
pub const MOST_EXACT: usize = 16;

/// Pairs `n` things off, `n` even; `lengths` holds `n` rows of `n` distances, symmetric.
pub(super) fn matching(lengths: &[Vec<f64>]) -> Vec<[usize; 2]> {
    if lengths.len() <= MOST_EXACT { best(lengths) } else { exchanged(lengths) }
}

/// The least sum of all, by dynamic programming over the sets of things that are paired off.
fn best(lengths: &[Vec<f64>]) -> Vec<[usize; 2]> {
    let n = lengths.len();
    let all = (1_usize << n) - 1;
    let mut least = vec![f64::INFINITY; all + 1];
    let mut last = vec![[0; 2]; all + 1];
    least[0] = 0.0;
    for set in 0..all {
        if least[set].is_infinite() {
            continue;
        }
        // The first thing left over must go with one of the others.
        let i = (!set).trailing_zeros() as usize;
        for j in (i + 1..n).filter(|j| set >> j & 1 == 0) {
            let with = set | 1 << i | 1 << j;
            let sum = least[set] + lengths[i][j];
            if sum < least[with] {
                least[with] = sum;
                last[with] = [i, j];
            }
        }
    }
    let mut pairs = Vec::new();
    let mut set = all;
    while set != 0 && last[set] != [0; 2] {
        let [i, j] = last[set];
        pairs.push([i, j]);
        set &= !(1 << i | 1 << j);
    }
    pairs.reverse();
    pairs
}

/// Nearest pairs first; then two pairs exchange partners while that shortens the sum.
fn exchanged(lengths: &[Vec<f64>]) -> Vec<[usize; 2]> {
    let n = lengths.len();
    let mut candidates: Vec<[usize; 2]> = (0..n).flat_map(|i| (i + 1..n).map(move |j| [i, j])).collect();
    candidates.sort_by(|[i, j], [k, l]| lengths[*i][*j].total_cmp(&lengths[*k][*l]));
    let mut free = vec![true; n];
    let mut pairs = Vec::new();
    for [i, j] in candidates {
        if free[i] && free[j] {
            (free[i], free[j]) = (false, false);
            pairs.push([i, j]);
        }
    }
    let length = |[i, j]: [usize; 2]| lengths[i][j];
    loop {
        let mut better = false;
        for p in 0..pairs.len() {
            for q in p + 1..pairs.len() {
                let ([a, b], [c, d]) = (pairs[p], pairs[q]);
                for [one, other] in [[[a, c], [b, d]], [[a, d], [b, c]]] {
                    // More than rounding, so that this ends.
                    let now = length(pairs[p]) + length(pairs[q]);
                    if length(one) + length(other) < now * (1.0 - 1e-12) {
                        (pairs[p], pairs[q]) = (one, other);
                        better = true;
                    }
                }
            }
        }
        if !better {
            return pairs;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Distances of points that a linear congruence scatters over a square.
    fn scattered(n: usize, seed: u64) -> Vec<Vec<f64>> {
        let mut state = seed;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let points: Vec<[f64; 2]> = (0..n).map(|_| [next(), next()]).collect();
        let row = |p: &[f64; 2]| points.iter().map(|q| (p[0] - q[0]).hypot(p[1] - q[1])).collect();
        points.iter().map(row).collect()
    }

    fn sum(lengths: &[Vec<f64>], pairs: &[[usize; 2]]) -> f64 {
        let mut all: Vec<usize> = pairs.iter().flatten().copied().collect();
        all.sort_unstable();
        assert_eq!(all, (0..lengths.len()).collect::<Vec<_>>());
        pairs.iter().map(|&[i, j]| lengths[i][j]).sum()
    }

    /// The least sum, by trying all.
    fn tried(lengths: &[Vec<f64>], left: &[usize]) -> f64 {
        let Some((&i, rest)) = left.split_first() else { return 0.0 };
        let without = |k: usize| [&rest[..k], &rest[k + 1..]].concat();
        (0..rest.len())
            .map(|k| lengths[i][rest[k]] + tried(lengths, &without(k)))
            .fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn the_best_pairs_are_found() {
        for (n, seed) in [(2, 1), (4, 2), (6, 3), (8, 4), (8, 5), (8, 6)] {
            let lengths = scattered(n, seed);
            let expected = tried(&lengths, &(0..n).collect::<Vec<_>>());
            assert!((sum(&lengths, &matching(&lengths)) - expected).abs() < 1e-12);
        }
        assert_eq!(matching(&[]), [[0; 2]; 0]);
    }

    #[test]
    fn exchanged_pairs_are_nearly_the_best() {
        for seed in 0..20 {
            let lengths = scattered(14, seed);
            let (good, least) = (sum(&lengths, &exchanged(&lengths)), sum(&lengths, &best(&lengths)));
            assert!(good >= least - 1e-12 && good < 1.5 * least, "{seed}: {good} {least}");
        }
        // A chain on which nearest first is far off, and exchanging helps.
        let at = [0.0_f64, 1.0, 1.9, 2.9];
        let lengths: Vec<Vec<f64>> = at.map(|p| at.map(|q| (p - q).abs()).to_vec()).to_vec();
        assert!((sum(&lengths, &exchanged(&lengths)) - 2.0).abs() < 1e-12);
    }
}
