//! The nearest neighbours of all points of a set, on buckets of a square grid.

use kurbo::Point;
use rayon::prelude::*;

/// Points in buckets of about two.
pub(super) struct Grid<'a> {
    points: &'a [Point],
    origin: Point,
    cell: f64,
    columns: usize,
    rows: usize,
    /// Points by bucket: those of bucket b are `items[starts[b]..starts[b + 1]]`.
    starts: Vec<u32>,
    items: Vec<u32>,
}

impl<'a> Grid<'a> {
    pub fn new(points: &'a [Point]) -> Self {
        let first = points.first().copied().unwrap_or_default();
        let place =
            points.iter().fold(kurbo::Rect::from_points(first, first), |place, point| place.union_pt(*point));
        let area = (place.width() * place.height()).max(1e-6 * place.width().max(place.height()).powi(2));
        let cell = (2.0 * area / points.len().max(1) as f64).sqrt().max(1e-9);
        let [columns, rows] = [place.width(), place.height()].map(|side| (side / cell) as usize + 1);
        let mut grid = Grid {
            points,
            origin: place.origin(),
            cell,
            columns,
            rows,
            starts: vec![0; columns * rows + 1],
            items: vec![0; points.len()],
        };
        let buckets: Vec<usize> = points.iter().map(|&point| grid.bucket(grid.place(point))).collect();
        buckets.iter().for_each(|&bucket| grid.starts[bucket + 1] += 1);
        for bucket in 0..columns * rows {
            grid.starts[bucket + 1] += grid.starts[bucket];
        }
        let mut next = grid.starts.clone();
        for (item, &bucket) in buckets.iter().enumerate() {
            grid.items[next[bucket] as usize] = item as u32;
            next[bucket] += 1;
        }
        grid
    }

    fn place(&self, point: Point) -> [usize; 2] {
        let at = (point - self.origin) / self.cell;
        [(at.x.max(0.0) as usize).min(self.columns - 1), (at.y.max(0.0) as usize).min(self.rows - 1)]
    }

    fn bucket(&self, [column, row]: [usize; 2]) -> usize {
        row * self.columns + column
    }

    /// The `count` nearest points to `at` that are `wanted`, nearest first, ties by index: distance and index.
    pub fn nearest(&self, at: Point, count: usize, wanted: impl Fn(u32) -> bool) -> Vec<(f64, u32)> {
        let mut found: Vec<(f64, u32)> = Vec::with_capacity(count + 1);
        let [column, row] = self.place(at);
        for ring in 0..self.columns.max(self.rows) {
            // Whatever lies in this ring is at least so far from a point of the bucket; farther from others.
            let reach = (ring as f64 - 1.0).max(0.0) * self.cell;
            if found.len() == count && found[count - 1].0 < reach {
                break;
            }
            for bucket in self.ring([column, row], ring) {
                for &item in &self.items[self.starts[bucket] as usize..self.starts[bucket + 1] as usize] {
                    let next = (self.points[item as usize].distance(at), item);
                    let order =
                        |other: &(f64, u32)| other.0.total_cmp(&next.0).then(other.1.cmp(&next.1)).is_lt();
                    let rank = found.partition_point(order);
                    if rank < count && wanted(item) {
                        found.insert(rank, next);
                        found.truncate(count);
                    }
                }
            }
        }
        found
    }

    /// The buckets `ring` steps from a place, in rows and columns.
    fn ring(&self, [column, row]: [usize; 2], ring: usize) -> impl Iterator<Item = usize> + '_ {
        let [low, high] = [row.saturating_sub(ring), (row + ring).min(self.rows - 1)];
        (low..=high).flat_map(move |y| {
            let full = y.abs_diff(row) == ring;
            let [from, to] = [column.wrapping_sub(ring), column + ring];
            let inner = full.then(|| column.saturating_sub(ring)..(column + ring + 1).min(self.columns));
            let ends = (!full).then(|| [from, to].into_iter().filter(|&x| x < self.columns));
            inner.into_iter().flatten().chain(ends.into_iter().flatten()).map(move |x| self.bucket([x, y]))
        })
    }
}

/// For every point its `count` nearest others that are no `kin` of it.
pub(super) fn neighbours(
    points: &[Point],
    count: usize,
    kin: impl Fn(u32, u32) -> bool + Sync,
) -> Vec<Vec<(f64, u32)>> {
    let grid = Grid::new(points);
    let of = |i: usize| grid.nearest(points[i], count, |j| !kin(i as u32, j));
    (0..points.len()).into_par_iter().map(of).collect()
}
