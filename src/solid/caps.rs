//! Triangles for the faces of plates, holes and all, by a sweep over whole-number coordinates (the crate
//! i_triangle), checked by count and area.

use i_triangle::i_overlay::core::fill_rule::FillRule;
use i_triangle::i_overlay::core::overlay::IntOverlayOptions;
use i_triangle::i_overlay::core::solver::Solver;
use i_triangle::i_overlay::i_float::int::point::IntPoint;
use i_triangle::int::triangulator::IntTriangulator;
use i_triangle::int::validation::Validation;

use super::error::SolidError;
use crate::fabrication::outline::Contour;

/// Triangles, counter-clockwise, of the region between an outer contour (counter-clockwise) and its holes
/// (clockwise): indices into all points, contour after contour. Every side of the contours is a side of one
/// triangle, and no other points are used.
///
/// `grid`: step of the coordinates, millimetres; fewer than two to the power of 29 of them in each direction.
///
/// # Errors
/// Contours that touch or cross, themselves or each other.
pub fn triangles(contours: &[Contour], grid: f64) -> Result<Vec<[usize; 3]>, SolidError> {
    let whole = |&[x, y]: &[f64; 2]| IntPoint::new((x / grid).round() as i32, (y / grid).round() as i32);
    let shape: Vec<Vec<IntPoint<i32>>> =
        contours.iter().map(|contour| contour.iter().map(whole).collect()).collect();
    let mut numbers: Vec<(IntPoint<i32>, usize)> =
        shape.iter().flatten().enumerate().map(|(i, &p)| (p, i)).collect();
    numbers.sort_unstable_by_key(|(p, i)| (p.x, p.y, *i));
    let place = |p: IntPoint<i32>| SolidError::Touches { x: f64::from(p.x) * grid, y: f64::from(p.y) * grid };
    if let Some(pair) = numbers.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        return Err(place(pair[0].0));
    }
    // Points on straight sides are ends of walls.
    let validation =
        Validation { fill_rule: FillRule::NonZero, options: IntOverlayOptions::keep_all_points() };
    let mut triangulator = IntTriangulator::<i32, u32>::new(numbers.len(), validation, Solver::default());
    triangulator.delaunay = true;
    // Not the variant without validation: on contours that cross it reads memory that is not its own.
    let found = triangulator.triangulate_shape(&shape);
    let number = |p: &IntPoint<i32>| {
        numbers.binary_search_by_key(&(p.x, p.y), |(q, _)| (q.x, q.y)).ok().map(|at| numbers[at].1)
    };
    let first = place(numbers.first().map_or(IntPoint::new(0, 0), |(p, _)| *p));
    let Some(names) = found.points.iter().map(number).collect::<Option<Vec<usize>>>() else {
        return Err(first);
    };
    check(&shape, &found.points, &found.indices).map_err(|at| at.map_or(first, place))?;
    Ok(found.indices.chunks_exact(3).map(|t| [0, 1, 2].map(|k| names[t[k] as usize])).collect())
}

/// That triangles fill a region exactly: as many as its points and holes need, none turned over, with its
/// area. That area is counted in whole numbers, so nothing is left to rounding. Otherwise a triangle that is
/// turned over, or `None`.
fn check(
    shape: &[Vec<IntPoint<i32>>],
    points: &[IntPoint<i32>],
    indices: &[u32],
) -> Result<(), Option<IntPoint<i32>>> {
    let count: usize = shape.iter().map(Vec::len).sum();
    let wanted: i128 = shape.iter().map(|contour| doubled(contour)).sum();
    let mut sum = 0;
    for triangle in indices.chunks_exact(3) {
        let corners = [0, 1, 2].map(|k| points[triangle[k] as usize]);
        let part = doubled(&corners);
        if part < 0 {
            return Err(Some(corners[0]));
        }
        sum += part;
    }
    match sum == wanted && indices.len() == 3 * (count + 2 * shape.len() - 4) {
        true => Ok(()),
        false => Err(None),
    }
}

/// Twice the area inside a closed contour, in grid squares.
fn doubled(contour: &[IntPoint<i32>]) -> i128 {
    let cross = |a: IntPoint<i32>, b: IntPoint<i32>| {
        i128::from(a.x) * i128::from(b.y) - i128::from(b.x) * i128::from(a.y)
    };
    (0..contour.len()).map(|i| cross(contour[i], contour[(i + 1) % contour.len()])).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(x: f64, y: f64, side: f64) -> Contour {
        vec![[x, y], [x + side, y], [x + side, y + side], [x, y + side]]
    }

    fn hole(x: f64, y: f64, side: f64) -> Contour {
        square(x, y, side).into_iter().rev().collect()
    }

    #[test]
    fn holes_stay_empty_and_sides_stay_whole() {
        // A row of holes in line with each other, with points on straight sides.
        let mut shape = vec![vec![[0.0, 0.0], [3.0, 0.0], [9.0, 0.0], [9.0, 4.0], [0.0, 4.0]]];
        shape.extend((0..4).map(|i| hole(1.0 + 2.0 * f64::from(i), 1.0, 1.0)));
        let found = triangles(&shape, 0.125).unwrap();
        let points = shape.concat();
        let area = |t: &[usize; 3]| {
            let [a, b, c] = t.map(|i| points[i]);
            0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]))
        };
        assert!(found.iter().all(|t| area(t) > 0.0));
        assert_eq!(found.iter().map(area).sum::<f64>(), 36.0 - 4.0);
        let mut start = 0;
        for contour in &shape {
            for i in 0..contour.len() {
                let side = [start + i, start + (i + 1) % contour.len()];
                let holds = |t: &&[usize; 3]| (0..3).any(|k| [t[k], t[(k + 1) % 3]] == side);
                assert_eq!(found.iter().filter(holds).count(), 1, "{side:?}");
            }
            start += contour.len();
        }
    }

    #[test]
    fn tangled_contours_are_refused_and_untangled_ones_are_not() {
        // Stars whose corners are shifted at random (a fixed linear congruence), from none to beyond the next
        // ones.
        let mut state = 12345_u64;
        let mut random = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 40) as f64 / f64::from(1 << 24)
        };
        let (mut good, mut bad) = (0, 0);
        for shift in 0..200 {
            let star: Contour = (0..40)
                .map(|i| {
                    let angle = (f64::from(i) + 0.05 * f64::from(shift) * (random() - 0.5)) * 0.157;
                    let radius = 1e4 * (0.3 + 0.7 * random());
                    [(radius * angle.cos()).round(), (radius * angle.sin()).round()]
                })
                .collect();
            // Angles that stay in order make a star-shaped polygon, which is simple.
            let ordered = (0..40).all(|i| {
                let ([a, b], [c, d]) = (star[i], star[(i + 1) % 40]);
                a * d - b * c > 0.0
            });
            let hole: Contour = (0..9)
                .map(|i| f64::from(-i) * 0.69)
                .map(|a| [(900.0 * a.cos()).round(), (900.0 * a.sin()).round()])
                .collect();
            match triangles(&[star, hole], 1.0) {
                Ok(found) => {
                    good += 1;
                    assert_eq!(found.len(), 40 + 9);
                }
                Err(_) => {
                    bad += 1;
                    assert!(!ordered, "refused a simple polygon");
                }
            }
        }
        assert!(good > 20 && bad > 20, "{good} {bad}");
    }

    #[test]
    fn what_touches_or_crosses_is_refused() {
        let touching = [square(0.0, 0.0, 4.0), hole(1.0, 1.0, 1.0), hole(2.0, 2.0, 1.0)];
        assert_eq!(triangles(&touching, 0.5), Err(SolidError::Touches { x: 2.0, y: 2.0 }));
        let outside = [square(0.0, 0.0, 4.0), hole(3.0, 1.0, 2.0)];
        assert!(matches!(triangles(&outside, 0.5), Err(SolidError::Touches { .. })));
        let eight = [vec![[0.0, 0.0], [4.0, 4.0], [4.0, 0.0], [0.0, 2.0]]];
        assert!(matches!(triangles(&eight, 0.5), Err(SolidError::Touches { .. })));
    }
}
