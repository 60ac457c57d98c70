//! A bound of the way between cuts that is better than the spanning tree: M. Held, R. M. Karp, *The traveling-salesman
//! problem and minimum spanning trees: part II* (1971), for cuts with two ends.
//!
//! A way through all cuts is a tree over them that meets every end of every cut exactly once, with one link from the home and
//! one to what follows. Put a price on every end, to be paid by each link that meets it: all ways get dearer by the sum of the
//! prices, trees by more or less. So the cheapest tree less that sum is a bound, whatever the prices are. They are raised where the tree meets an
//! end too often, and lowered where it does not meet it.

use kurbo::Point;

/// How often prices are changed.
const ROUNDS: usize = 200;
/// Changes without a better bound after which steps get shorter, and by how much.
const PATIENCE: usize = 10;
const SHORTER: f64 = 0.7;

/// The bound, millimetres. `ends`: the two ends of each cut, one after the other; `onwards`: the way from each end to what
/// follows all cuts; `found`: length of a known way, which sets the size of the steps.
pub(super) fn ascent(ends: &[Point], home: Point, onwards: &[f64], found: f64) -> f64 {
    let mut prices = vec![0.0; ends.len()];
    let (mut best, mut stride, mut idle) = (0.0_f64, 1.0, 0);
    for _ in 0..ROUNDS {
        let Tree { length, met } = tree(ends, home, onwards, &prices);
        let bound = length - prices.iter().sum::<f64>();
        idle = if bound > best { 0 } else { idle + 1 };
        best = best.max(bound);
        if idle > PATIENCE {
            (stride, idle) = (SHORTER * stride, 0);
        }
        let excess: f64 = met.iter().map(|&met| (f64::from(met) - 1.0).powi(2)).sum();
        if excess == 0.0 || found <= bound {
            break; // the tree is a way
        }
        let step = stride * (found - bound) / excess;
        prices.iter_mut().zip(&met).for_each(|(price, &met)| *price += step * (f64::from(met) - 1.0));
    }
    best
}

/// The cheapest tree over the cuts with a link from the home and one onwards: its length with prices, and how often it meets
/// each end.
struct Tree {
    length: f64,
    met: Vec<u32>,
}

/// Prim's rule on all pairs of ends.
fn tree(ends: &[Point], home: Point, onwards: &[f64], prices: &[f64]) -> Tree {
    let mut met = vec![0; ends.len()];
    let mut length = 0.0;
    // Ends of cuts that are not in the tree, with the cheapest link to each.
    let mut outside: Vec<(u32, u32, f64)> =
        (2..ends.len() as u32).map(|end| (end, 0, f64::INFINITY)).collect();
    let mut joined = 0;
    while !outside.is_empty() {
        let (mut nearest, mut least) = (0, f64::INFINITY);
        for (place, (end, from, way)) in outside.iter_mut().enumerate() {
            for with in [joined, joined + 1] {
                let new = ends[*end as usize].distance(ends[with as usize]) + prices[with as usize];
                if new < *way {
                    (*from, *way) = (with, new);
                }
            }
            let cost = *way + prices[*end as usize];
            if cost < least {
                (nearest, least) = (place, cost);
            }
        }
        let (end, from, _) = outside[nearest];
        length += least;
        met[end as usize] += 1;
        met[from as usize] += 1;
        joined = end & !1;
        // The two ends of a cut stay next to each other.
        let place = nearest & !1;
        let last = outside.len() - 2;
        outside.swap(place, last);
        outside.swap(place + 1, last + 1);
        outside.truncate(last);
    }
    let mut link = |way: &dyn Fn(usize) -> f64| {
        let cost = |end: usize| way(end) + prices[end];
        if let Some(end) = (0..ends.len()).min_by(|&a, &b| cost(a).total_cmp(&cost(b))) {
            length += cost(end);
            met[end] += 1;
        }
    };
    link(&|end| home.distance(ends[end]));
    link(&|end| onwards[end]);
    Tree { length, met }
}
