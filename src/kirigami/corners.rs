//! Finds the four corners of an outline that is shaped like a quadrilateral.

use crate::geometry::{Point2, Vector2};
use std::f64::consts::PI;

/// Turning is measured over this share of the perimeter on both sides of a vertex, so that the mesh's own
/// facets do not count as corners.
const WINDOW: f64 = 0.025;
/// On narrow outlines it is measured over this multiple of area / perimeter (half the width of a strip) instead, so that
/// the two corners of a short side are told apart. On a square both measures are the same.
const NARROW_WINDOW: f64 = 0.4;
/// Least turning at a corner.
const CORNER_TURN: f64 = 50.0 * PI / 180.0;
/// Largest turning away from corners.
const SIDE_TURN: f64 = 35.0 * PI / 180.0;
/// Opposite sides may differ by this factor.
pub const SIDE_RATIO: f64 = 1.25;

/// The four sides of a counter-clockwise outline that has exactly four corners, as polylines from corner to
/// corner, counter-clockwise; the first is the one whose direction comes nearest to `axis`. `None` where the
/// outline is not of this kind.
pub fn four_corners(outline: &[Point2], axis: &Vector2) -> Option<[Vec<Point2>; 4]> {
    let n = outline.len();
    let mut lengths = vec![0.0; n + 1];
    for i in 0..n {
        lengths[i + 1] = lengths[i] + (outline[(i + 1) % n] - outline[i]).norm();
    }
    let perimeter = lengths[n];
    let at = |s: f64| {
        let s = s.rem_euclid(perimeter);
        let i = lengths.partition_point(|&l| l <= s).clamp(1, n) - 1;
        let t = (s - lengths[i]) / (lengths[i + 1] - lengths[i]).max(f64::MIN_POSITIVE);
        outline[i] + (outline[(i + 1) % n] - outline[i]) * t
    };
    let doubled: f64 = (0..n).map(|i| outline[i].coords.perp(&outline[(i + 1) % n].coords)).sum();
    let reach = (WINDOW * perimeter).min(NARROW_WINDOW * 0.5 * doubled.abs() / perimeter);
    let turns: Vec<f64> = (0..n)
        .map(|i| {
            let (before, after) = (outline[i] - at(lengths[i] - reach), at(lengths[i] + reach) - outline[i]);
            before.perp(&after).atan2(before.dot(&after))
        })
        .collect();
    let distance = |i: usize, j: usize| {
        let d = (lengths[i] - lengths[j]).abs();
        d.min(perimeter - d)
    };
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&i, &j| turns[j].total_cmp(&turns[i]).then(i.cmp(&j)));
    let mut corners: Vec<usize> = Vec::new();
    for i in order {
        // Within two windows of a corner the turning of that corner is still seen.
        if corners.iter().all(|&corner| distance(corner, i) > 2.0 * reach) {
            if turns[i] >= CORNER_TURN {
                corners.push(i);
            } else if turns[i].abs() > SIDE_TURN {
                return None;
            }
        }
    }
    if corners.len() != 4 {
        return None;
    }
    corners.sort_unstable();
    let side = |k: usize| -> Vec<Point2> {
        let (start, end) = (corners[k % 4], corners[(k + 1) % 4]);
        let count = (end + n - start) % n;
        (0..=count).map(|i| outline[(start + i) % n]).collect()
    };
    let extent = |k: usize| {
        let (start, end) = (lengths[corners[k % 4]], lengths[corners[(k + 1) % 4]]);
        (end - start).rem_euclid(perimeter)
    };
    let similar = |k: usize| (extent(k) / extent(k + 2)).ln().abs() < SIDE_RATIO.ln();
    if !(similar(0) && similar(1)) {
        return None;
    }
    let heading = |k: usize| (outline[corners[(k + 1) % 4]] - outline[corners[k % 4]]).normalize().dot(axis);
    let first = (0..4).max_by(|&k, &l| heading(k).total_cmp(&heading(l)))?;
    Some(std::array::from_fn(|k| side(first + k)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hexagons_and_circles_have_no_four_corners() {
        for corners in [3, 5, 6, 200] {
            let outline: Vec<Point2> = (0..corners * 10)
                .map(|k| {
                    let at = |i: usize| {
                        let t = 2.0 * PI * (i % corners) as f64 / corners as f64;
                        Point2::new(t.cos(), t.sin())
                    };
                    let t = (k % 10) as f64 / 10.0;
                    at(k / 10) + (at(k / 10 + 1) - at(k / 10)) * t
                })
                .collect();
            assert!(four_corners(&outline, &Vector2::x()).is_none(), "{corners} corners");
        }
    }

    #[test]
    fn a_strip_of_any_length_has_four() {
        for length in [1, 8, 10, 40] {
            let along = |from: [f64; 2], to: [f64; 2], steps: usize| {
                (0..steps).map(move |k| {
                    let t = k as f64 / steps as f64;
                    Point2::new(from[0] + (to[0] - from[0]) * t, from[1] + (to[1] - from[1]) * t)
                })
            };
            let (long, l) = (10 * length, length as f64);
            let outline: Vec<Point2> = along([0.0, 0.0], [l, 0.0], long)
                .chain(along([l, 0.0], [l, 1.0], 10))
                .chain(along([l, 1.0], [0.0, 1.0], long))
                .chain(along([0.0, 1.0], [0.0, 0.0], 10))
                .collect();
            let sides = four_corners(&outline, &Vector2::x()).expect("four corners");
            assert_eq!(sides.map(|side| side.len()), [long + 1, 11, long + 1, 11], "{length} : 1");
        }
    }

    #[test]
    fn a_bulging_square_has_four() {
        let outline: Vec<Point2> = (0..80)
            .map(|k| {
                let (side, t) = (k / 20, (k % 20) as f64 / 20.0 * 2.0 - 1.0);
                let (x, y) = (t, -1.0 - 0.12 * (1.0 - t * t));
                let turn = nalgebra::Rotation2::new(PI / 2.0 * side as f64);
                turn * Point2::new(x, y)
            })
            .collect();
        let sides = four_corners(&outline, &Vector2::x()).unwrap();
        assert!((sides[0][0] - Point2::new(-1.0, -1.0)).norm() < 1e-12);
        assert!((sides[1][0] - Point2::new(1.0, -1.0)).norm() < 1e-12);
        assert!(sides.iter().all(|side| side.len() == 21));
    }
}
