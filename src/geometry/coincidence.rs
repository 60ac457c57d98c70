//! Points that are meant to be one: clusters of near points, of which each owner has one at most.

use std::collections::HashMap;

use super::Point3;
use super::union_find::UnionFind;

/// A pair of points and how near they are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Near {
    /// The two points, ascending.
    pub points: [usize; 2],
    /// Their distance.
    pub distance: f64,
}

/// All pairs of points at most `tolerance` (> 0) apart, in the order of their indices.
pub fn near_pairs(points: &[Point3], tolerance: f64) -> Vec<Near> {
    let cell = |p: &Point3| p.coords.map(|c| (c / tolerance).floor() as i64);
    let mut grid: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
    for (i, p) in points.iter().enumerate() {
        grid.entry(cell(p).into()).or_default().push(i);
    }
    let mut pairs = Vec::new();
    for (i, p) in points.iter().enumerate() {
        let at = cell(p);
        for step in 0..27 {
            let [x, y, z] = [step % 3 - 1, step / 3 % 3 - 1, step / 9 - 1];
            let Some(others) = grid.get(&[at.x + x, at.y + y, at.z + z]) else { continue };
            for &j in others.iter().filter(|&&j| j > i) {
                let distance = (points[j] - p).norm();
                if distance <= tolerance {
                    pairs.push(Near { points: [i, j], distance });
                }
            }
        }
    }
    pairs.sort_unstable_by_key(|near| near.points);
    pairs
}

/// Joins pairs, the nearest first, unless a cluster would then hold two points of one owner. Returns the cluster of
/// each point; clusters are numbered in the order of their first points.
pub fn clusters(mut pairs: Vec<Near>, owners: &[usize]) -> Vec<usize> {
    pairs.sort_by(|a, b| a.distance.total_cmp(&b.distance).then(a.points.cmp(&b.points)));
    let mut sets = UnionFind::new(owners.len());
    let mut held: Vec<Vec<usize>> = owners.iter().map(|&owner| vec![owner]).collect();
    for Near { points: [i, j], .. } in pairs {
        let (a, b) = (sets.root(i), sets.root(j));
        if a == b || held[a].iter().any(|owner| held[b].contains(owner)) {
            continue;
        }
        sets.join(a, b);
        let (kept, gone) = (a.min(b), a.max(b));
        let more = std::mem::take(&mut held[gone]);
        held[kept].extend(more);
    }
    numbered((0..owners.len()).map(|i| sets.root(i)))
}

/// Labels replaced by numbers in the order in which they come first.
fn numbered(labels: impl Iterator<Item = usize>) -> Vec<usize> {
    let mut numbers = HashMap::new();
    labels
        .map(|label| {
            let next = numbers.len();
            *numbers.entry(label).or_insert(next)
        })
        .collect()
}

/// The members of each cluster, ascending.
pub fn members(cluster_of: &[usize]) -> Vec<Vec<usize>> {
    let count = cluster_of.iter().max().map_or(0, |last| last + 1);
    let mut members = vec![Vec::new(); count];
    for (point, &cluster) in cluster_of.iter().enumerate() {
        members[cluster].push(point);
    }
    members
}

/// The mean of points; of equal points exactly that point.
pub fn mean(points: impl IntoIterator<Item = Point3>) -> Point3 {
    let mut points = points.into_iter();
    let Some(first) = points.next() else { return Point3::origin() };
    let (sum, count) =
        points.fold((super::Vector3::zeros(), 1.0), |(sum, count), p| (sum + (p - first), count + 1.0));
    first + sum / count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_are_those_of_a_search_through_all() {
        let points: Vec<Point3> = (0..120)
            .map(|i| {
                let c = |k: f64| ((i as f64 * k).sin() * 43758.5453).fract() * 0.4;
                Point3::new(c(12.9898), c(78.233), c(37.719))
            })
            .collect();
        let found: Vec<[usize; 2]> = near_pairs(&points, 0.1).iter().map(|near| near.points).collect();
        let all = (0..points.len()).flat_map(|i| (i + 1..points.len()).map(move |j| [i, j]));
        let expected: Vec<_> = all.filter(|&[i, j]| (points[i] - points[j]).norm() <= 0.1).collect();
        assert!(expected.len() > 50);
        assert_eq!(found, expected);
    }

    #[test]
    fn two_points_of_one_owner_stay_apart_and_the_nearest_pair_wins() {
        let points = [0.0, 0.4, 0.5, 9.0].map(|x| Point3::new(x, 0.0, 0.0));
        // Points 0 and 1 belong to one owner: 2 is nearer to 1.
        assert_eq!(clusters(near_pairs(&points, 1.0), &[7, 7, 8, 9]), [0, 1, 1, 2]);
        assert_eq!(clusters(near_pairs(&points, 1.0), &[6, 7, 8, 9]), [0, 0, 0, 1]);
        assert_eq!(members(&[0, 1, 1, 2]), [vec![0], vec![1, 2], vec![3]]);
    }

    #[test]
    fn the_mean_of_equal_points_is_that_point() {
        let p = Point3::new(0.1, -0.7, 1.0 / 3.0);
        assert_eq!(mean([p; 3]), p);
        assert_eq!(mean([Point3::origin(), Point3::new(2.0, 4.0, 0.0)]), Point3::new(1.0, 2.0, 0.0));
    }
}
