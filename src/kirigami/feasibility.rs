//! What the pattern can do, before anything is optimised (section 2.2 of the paper's model).
//!
//! Pieces with sides `a` and `b`, `r = b / a`, that turn by `t` stretch the sheet by `m1 = cos t + r sin t`
//! and `m2 = cos t + sin t / r`. With the full opening, t = 45 degrees, this is `1/m1 + 1/m2 = sqrt 2`. The
//! sheet's size is free, so the stretches of a flattening may all be multiplied by one scale.
//!
//! This is a prediction. Quads that leave the rectangle reach further than the formulas say, and the limits
//! of optimisation, hinges and collisions are not in them: the measured result decides.

use crate::geometry::Point3;
use crate::geometry::mesh::TriMesh;
use crate::geometry::stretch::{Stretch, worst_ratio};
use std::f64::consts::SQRT_2;

/// Targets whose conformal flattening stretches more unevenly than this are refused before optimising:
/// turning pieces stretch a sheet by 1 at least and by less than 3 at most (m1 + m2 < 4, both >= 1).
pub const MOST_STRETCH_RATIO: f64 = 3.0;

/// The flattening's ratio of the largest to the smallest stretch that Stage 1 brings down to: squares that
/// open by different angles stretch by 1 to sqrt 2 in all directions alike. Below, rigidity makes the better
/// patterns (measured on the shared meshes: smaller gaps at the boundary).
pub const EASY_RATIO: f64 = SQRT_2;

/// An easy target has a conformal ratio of at most this: those of 1.13 to 1.29 are reached as they are, those
/// of 1.72 and 2.0 with effort, and of 2.2 and more not yet without cuts.
pub const EASY_CONFORMAL_RATIO: f64 = 1.5;

/// What is to be expected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// Within what turning rectangles do.
    Easy,
    /// Beyond the formulas, yet not out of reach: the optimisation decides.
    Hard,
    /// Out of reach: the target must be cut.
    Beyond,
}

impl Verdict {
    /// One word.
    pub fn word(self) -> &'static str {
        match self {
            Self::Easy => "easy",
            Self::Hard => "hard",
            Self::Beyond => "beyond",
        }
    }
}

/// The triangle that is farthest from what the pattern does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WorstPlace {
    /// Its index.
    pub triangle: usize,
    /// Its centre on the target, millimetres.
    pub at: Point3,
    /// The opening stretches asked for there, largest first.
    pub stretches: [f64; 2],
}

/// The prediction for one flattening.
#[derive(Debug, Clone, PartialEq)]
pub struct Feasibility {
    /// Largest over smallest scale of the conformal flattening with boundary lengths kept.
    pub conformal_ratio: f64,
    /// Largest over smallest stretch of the flattening.
    pub worst_ratio: f64,
    /// Smallest and largest opening stretch asked for.
    pub range: [f64; 2],
    /// Part of the area that turning rectangles reach with an opening that varies, 0 to 1.
    pub reached: f64,
    /// Mean over the area of the distance of [`full_opening`] from 1, at the scale that makes its inverse 1
    /// in the mean: 0 where the full opening fits everywhere.
    pub mean_deviation: f64,
    /// Largest of these distances.
    pub largest_deviation: f64,
    /// Where it is worst.
    pub worst: WorstPlace,
    /// #F: [`full_opening`] of each triangle, the opening asked for in parts of the full one.
    pub openings: Vec<f64>,
    /// #F: whether turning rectangles do not reach the triangle.
    pub beyond: Vec<bool>,
    /// What is to be expected.
    pub verdict: Verdict,
}

/// Predicts how well the pattern fits a flattening, whose size is free. `stretches` has one entry per face, at least one.
pub fn feasibility(mesh: &TriMesh, stretches: &[Stretch], conformal_ratio: f64) -> Feasibility {
    let ratio = worst_ratio(stretches);
    let verdict = match () {
        () if conformal_ratio.is_nan() || conformal_ratio > MOST_STRETCH_RATIO => Verdict::Beyond,
        () if ratio.is_nan() || ratio > MOST_STRETCH_RATIO => Verdict::Beyond,
        () if ratio <= EASY_RATIO && conformal_ratio <= EASY_CONFORMAL_RATIO => Verdict::Easy,
        () => Verdict::Hard,
    };
    Feasibility { verdict, ..measured(mesh, stretches, conformal_ratio, best_scale(stretches)) }
}

/// Predicts how well the pattern fits a map from the closed to the open state, whose stretches are as they are. It is out
/// of reach where turning rectangles reach none of it, or where a place is stretched more than any of them can.
pub fn feasibility_of_map(mesh: &TriMesh, stretches: &[Stretch], conformal_ratio: f64) -> Feasibility {
    let found = measured(mesh, stretches, conformal_ratio, 1.0);
    let within = found.range[1] <= MOST_STRETCH_RATIO && found.reached > 0.0;
    let verdict = match found.reached {
        _ if !within => Verdict::Beyond,
        reached if reached > EASY_PART => Verdict::Easy,
        _ => Verdict::Hard,
    };
    Feasibility { verdict, ..found }
}

/// Turning rectangles reach all of a map but for single triangles.
const EASY_PART: f64 = 0.99;

/// The figures of stretches times a scale; nothing is said of the verdict.
fn measured(mesh: &TriMesh, stretches: &[Stretch], conformal_ratio: f64, scale: f64) -> Feasibility {
    let to_nominal = nominal_scale(stretches) / scale;
    let opened: Vec<[f64; 2]> = stretches.iter().map(|s| s.principal.map(|m| scale * m)).collect();
    let total: f64 = stretches.iter().map(|s| s.area).sum();
    let mean = |value: &dyn Fn(&[f64; 2]) -> f64| {
        opened.iter().zip(stretches).map(|(m, s)| s.area * value(m)).sum::<f64>() / total
    };
    let openings: Vec<f64> = opened.iter().map(|&m| full_opening(m)).collect();
    let badness = |i: usize| [excess(stretches[i].principal, scale), openings[i].ln().abs()];
    let worse = |i: usize, j: usize| {
        let ([a, b], [c, d]) = (badness(i), badness(j));
        if a.total_cmp(&c).then(b.total_cmp(&d)).is_gt() { i } else { j }
    };
    let triangle = (1..opened.len()).fold(0, |worst, i| worse(i, worst));
    let corners = mesh.faces[triangle].map(|v| mesh.vertices[v].coords);
    Feasibility {
        conformal_ratio,
        worst_ratio: worst_ratio(stretches),
        range: opened.iter().fold([f64::INFINITY, 0.0], |[low, high], m| [low.min(m[1]), high.max(m[0])]),
        reached: mean(&|&m| if excess(m, 1.0) <= 1.0 { 1.0 } else { 0.0 }),
        mean_deviation: mean(&|&m| (to_nominal * full_opening(m) - 1.0).abs()),
        largest_deviation: openings.iter().map(|d| (to_nominal * d - 1.0).abs()).fold(0.0, f64::max),
        worst: WorstPlace {
            triangle,
            at: Point3::from((corners[0] + corners[1] + corners[2]) / 3.0),
            stretches: opened[triangle],
        },
        openings,
        beyond: opened.iter().map(|&m| excess(m, 1.0) > 1.0).collect(),
        verdict: Verdict::Hard,
    }
}

/// `sqrt 2 / (1/m1 + 1/m2)`: 1 where the full opening of some rectangle gives these stretches, above where
/// the target asks for more, below where for less.
pub fn full_opening([m1, m2]: [f64; 2]) -> f64 {
    SQRT_2 / (1.0 / m1 + 1.0 / m2)
}

/// The turn `t` of the pieces, radians, and the ratio `r = b / a` of their sides that give opening stretches
/// `m1` and `m2`; `None` where no rectangle does: unless both are >= 1, `4 m1 m2 <= 8 + (m1 - m2)^2` and
/// `m1 + m2 < 4`. Of the two solutions the one that opens less. An unopened sheet has `r = 1`.
pub fn opening_of([m1, m2]: [f64; 2]) -> Option<(f64, f64)> {
    let root = (m1 - m2).powi(2) - 4.0 * m1 * m2 + 8.0;
    if !(m1 >= 1.0 && m2 >= 1.0 && m1 + m2 < 4.0 && root >= 0.0) {
        return None;
    }
    let cosine = (0.25 * (m1 + m2 + root.sqrt())).min(1.0);
    let turn = cosine.acos();
    let sine = turn.sin();
    if sine == 0.0 { Some((0.0, 1.0)) } else { Some((turn, (m1 - cosine) / sine)) }
}

/// The scales for which turning rectangles reach the stretches: least and greatest. The least exceeds the
/// greatest where none does.
fn scales([m1, m2]: [f64; 2]) -> [f64; 2] {
    // 4 m1 m2 - (m1 - m2)^2 <= 8 / scale^2.
    let bent = 4.0 * m1 * m2 - (m1 - m2).powi(2);
    let most = if bent > 0.0 { (8.0 / bent).sqrt() } else { f64::INFINITY };
    [1.0 / m1.min(m2), most.min(4.0 / (m1 + m2))]
}

/// Rounding must not decide about a target that just fits.
const ROUNDING: f64 = 1e-9;

/// By what factor scaled stretches leave the reach of turning rectangles; 1 where they do not.
fn excess(stretches: [f64; 2], scale: f64) -> f64 {
    let [least, most] = scales(stretches);
    let over = (least / scale).max(scale / most);
    if over <= 1.0 + ROUNDING { 1.0 } else { over }
}

/// The scale at which 1/m1 + 1/m2 is sqrt 2 in the mean over the area.
fn nominal_scale(stretches: &[Stretch]) -> f64 {
    let total: f64 = stretches.iter().map(|s| s.area).sum();
    let inverse: f64 =
        stretches.iter().map(|s| s.area * s.principal.iter().map(|m| 1.0 / m).sum::<f64>()).sum();
    inverse / total / SQRT_2
}

/// The scale with which turning rectangles reach the largest part of the area; of several the nearest to the
/// full opening in the mean.
fn best_scale(stretches: &[Stretch]) -> f64 {
    let total: f64 = stretches.iter().map(|s| s.area).sum();
    let nominal = nominal_scale(stretches);
    // Where the reached area begins to count (in) and to be lost (out).
    let slack = 1.0 + 0.5 * ROUNDING;
    let mut ends: Vec<(f64, bool, f64)> = Vec::with_capacity(2 * stretches.len());
    for stretch in stretches {
        let [least, most] = scales(stretch.principal);
        if least <= most * slack && least > 0.0 {
            ends.extend([(least, false, stretch.area), (most * slack, true, stretch.area)]);
        }
    }
    ends.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)).then(a.2.total_cmp(&b.2)));
    let (mut area, mut best) = (0.0, (0.0, nominal));
    for pair in ends.windows(2) {
        area += if pair[0].1 { -pair[0].2 } else { pair[0].2 };
        let scale = nominal.clamp(pair[0].0, pair[1].0);
        let nearer = (scale / nominal).ln().abs() < (best.1 / nominal).ln().abs();
        // More area by more than rounding, or as much nearer to the nominal scale.
        if area > best.0 + 1e-9 * total || (area > best.0 - 1e-9 * total && nearer) {
            best = (area, scale);
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Vector2;
    use std::f64::consts::FRAC_PI_4;

    /// The stretches `m1`, `m2` of pieces with side ratio `r` that turn by `t` radians: the inverse of
    /// [`opening_of`].
    fn stretches_of(t: f64, r: f64) -> [f64; 2] {
        [t.cos() + r * t.sin(), t.cos() + t.sin() / r]
    }

    #[test]
    fn openings_and_stretches_are_inverse() {
        for i in 1..=9 {
            for j in -4..=4 {
                let (t, r) = (0.08 * f64::from(i), f64::exp(0.1 * f64::from(j)));
                let m = stretches_of(t, r);
                // The other root, cos t < (m1 + m2) / 4, is over-opened, and short sides shrink one
                // direction.
                if t.cos() < 0.25 * (m[0] + m[1]) || m.iter().any(|&m| m < 1.0) {
                    continue;
                }
                let (turn, ratio) = opening_of(m).unwrap();
                assert!((turn - t).abs() < 1e-9 && (ratio - r).abs() < 1e-9, "{t} {r}: {turn} {ratio}");
                assert_eq!(excess(m, 1.0), 1.0);
            }
        }
        assert_eq!(opening_of([1.0, 1.0]), Some((0.0, 1.0)));
        for beyond in [[1.5, 1.5], [0.99, 1.1], [3.0, 1.1]] {
            assert!(opening_of(beyond).is_none() && excess(beyond, 1.0) > 1.0, "{beyond:?}");
        }
    }

    #[test]
    fn full_opening_is_45_degrees() {
        for r in [0.5, 1.0, 1.7, 2.4] {
            let m = stretches_of(FRAC_PI_4, r);
            assert!((full_opening(m) - 1.0).abs() < 1e-12, "{m:?}");
        }
    }

    fn even(m: &[f64]) -> Vec<Stretch> {
        m.iter().map(|&m| Stretch { principal: [m, m], direction: Vector2::x(), area: 1.0 }).collect()
    }

    #[test]
    fn the_scale_reaches_as_much_as_can_be() {
        // All within a factor of sqrt 2: all is reached, and only one scale does it.
        let stretches = even(&[0.7, 0.8, 0.7 * SQRT_2]);
        let scale = best_scale(&stretches);
        assert!((scale * 0.7 - 1.0).abs() < 1e-9, "{scale}");
        assert!(stretches.iter().all(|s| excess(s.principal, scale) == 1.0));
        // A developable target: full opening.
        assert!((best_scale(&even(&[3.0; 4])) * 3.0 - SQRT_2).abs() < 1e-12);
        // One outlier is given up, the other two are reached.
        let scale = best_scale(&even(&[1.0, 1.2, 5.0]));
        assert!((1.0..=SQRT_2 / 1.2 + 1e-12).contains(&scale), "{scale}");
    }

    #[test]
    fn the_stretches_of_a_map_are_taken_as_they_are() {
        let vertices = (0..4).map(|i| Point3::new(f64::from(i), f64::from(i % 2), 0.0)).collect();
        let mesh = TriMesh { vertices, faces: vec![[0, 1, 2], [1, 3, 2]] };
        let verdict = |m: &[f64]| feasibility_of_map(&mesh, &even(m), 1.0).verdict;
        assert_eq!([verdict(&[1.1, 1.3]), verdict(&[1.1, 1.5])], [Verdict::Easy, Verdict::Hard]);
        // Too small, though even: its size is not free.
        assert_eq!([verdict(&[0.7, 0.7]), verdict(&[1.1, 3.2])], [Verdict::Beyond; 2]);
        assert_eq!(feasibility_of_map(&mesh, &even(&[1.1, 1.3]), 1.0).range, [1.1, 1.3]);
    }

    #[test]
    fn numbers_of_a_target_with_one_bad_triangle() {
        let vertices = (0..6).map(|i| Point3::new(f64::from(i), f64::from(i % 2), 0.0)).collect();
        let mesh = TriMesh { vertices, faces: vec![[0, 1, 2], [1, 3, 2], [2, 3, 4], [3, 5, 4]] };
        let found = feasibility(&mesh, &even(&[1.0, 1.1, 2.0, 1.05]), 2.0);
        assert_eq!((found.worst.triangle, found.verdict), (2, Verdict::Hard));
        assert!((found.reached - 0.75).abs() < 1e-12 && (found.worst_ratio - 2.0).abs() < 1e-12);
        assert!((found.worst.at.x - 3.0).abs() < 1e-12);
        assert_eq!(feasibility(&mesh, &even(&[1.0, 1.1, 1.3, 1.05]), 1.3).verdict, Verdict::Easy);
        assert_eq!(feasibility(&mesh, &even(&[1.0, 1.1, 3.2, 1.05]), 2.9).verdict, Verdict::Beyond);
    }
}
