//! Outlines of solids: burned contours without needless points, on a grid that single precision holds
//! exactly.

use kurbo::Point;

use crate::fabrication::outline::{Contour, area};
use crate::fabrication::web::nearest_on_segment;

/// Largest distance between a solid's outline and the burned one, millimetres: a fiftieth of the finest kerf,
/// yet a round of 0.3 mm takes only five chords to the quarter.
pub const TOLERANCE: f64 = 1e-3;

/// Bits of a single-precision number: coordinates are whole multiples, below two to this power, of the grid.
const BITS: i32 = 24;

/// One closed line of a plate at the mid-plane; the material lies to its left.
#[derive(Debug, Clone, PartialEq)]
pub struct Outline {
    /// x, y in millimetres.
    pub points: Vec<[f64; 2]>,
    /// How the wall runs through the sheet at each point, (dx/dz, dy/dz); `None` for vertical walls.
    pub lean: Option<Vec<[f64; 2]>>,
}

/// A flat body: an outer outline, counter-clockwise, and its holes, clockwise.
#[derive(Debug, Clone, PartialEq)]
pub struct Plate {
    /// The outer one first.
    pub outlines: Vec<Outline>,
    /// Step of its coordinates, millimetres: a power of two.
    pub grid: f64,
}

impl Outline {
    /// Its points at a height above the mid-plane, on no grid.
    pub fn at(&self, height: f64) -> Vec<[f64; 2]> {
        match &self.lean {
            None => self.points.clone(),
            Some(lean) => self.points.iter().zip(lean).map(|(&p, &l)| shifted(p, l, height)).collect(),
        }
    }
}

impl Plate {
    /// Whether its walls are other than vertical.
    pub fn leans(&self) -> bool {
        self.outlines.iter().any(|outline| outline.lean.is_some())
    }

    /// Its outlines at a height above the mid-plane, on the grid.
    pub fn at(&self, height: f64) -> Vec<Contour> {
        let face =
            |outline: &Outline| outline.at(height).into_iter().map(|p| snapped(p, self.grid)).collect();
        self.outlines.iter().map(face).collect()
    }

    /// The same with fewer points: within `tolerance` (mm) of it at the mid-plane.
    pub fn coarser(&self, tolerance: f64) -> Self {
        let outline = |Outline { points, lean }: &Outline| {
            let kept = needed(points, tolerance);
            let lean = lean.as_ref().map(|lean| kept.iter().map(|&i| lean[i]).collect());
            Outline { points: kept.iter().map(|&i| points[i]).collect(), lean }
        };
        Self { outlines: self.outlines.iter().map(outline).collect(), grid: self.grid }
    }

    /// Area at a height above the mid-plane, square millimetres.
    pub fn area(&self, height: f64) -> f64 {
        self.at(height).iter().map(|contour| area(contour)).sum()
    }
}

/// Where a wall stands at a height above the mid-plane.
pub fn shifted([x, y]: [f64; 2], [u, v]: [f64; 2], height: f64) -> [f64; 2] {
    [x + height * u, y + height * v]
}

/// The plate inside burned contours, the outer one first, within [`TOLERANCE`]. Holes that vanish are left out;
/// `None` where the outer contour does.
pub fn plate(shape: &[Contour]) -> Option<Plate> {
    let extent = shape.iter().flatten().flatten().fold(0.0_f64, |most, c| most.max(c.abs()));
    // One bit to spare for walls that lean outwards.
    let grid = 2.0_f64.powi(extent.max(1.0).log2().ceil() as i32 + 1 - BITS);
    let outline = |contour: &Contour| {
        let kept = needed(contour, TOLERANCE).into_iter();
        let mut points: Vec<[f64; 2]> = kept.map(|i| snapped(contour[i], grid)).collect();
        points.dedup();
        if points.len() > 1 && points.first() == points.last() {
            points.pop();
        }
        (points.len() > 2).then_some(Outline { points, lean: None })
    };
    let (outer, holes) = shape.split_first()?;
    let outlines = std::iter::once(outline(outer)?).chain(holes.iter().filter_map(outline)).collect();
    Some(Plate { outlines, grid })
}

fn snapped([x, y]: [f64; 2], grid: f64) -> [f64; 2] {
    [x, y].map(|c| (c / grid).round() * grid)
}

/// The points of a closed contour that are needed to stay within `tolerance` of it: the farthest that each
/// chord can reach, from the leftmost point on.
fn needed(contour: &[[f64; 2]], tolerance: f64) -> Vec<usize> {
    let n = contour.len();
    let Some(start) = (0..n).min_by(|&i, &j| {
        let ([a, b], [c, d]) = (contour[i], contour[j]);
        a.total_cmp(&c).then(b.total_cmp(&d))
    }) else {
        return Vec::new();
    };
    let point = |i: usize| Point::from((contour[(start + i) % n][0], contour[(start + i) % n][1]));
    let mut kept = Vec::new();
    let mut from = 0;
    while from < n {
        kept.push((start + from) % n);
        let follows = |to: usize| {
            (from + 1..to).all(|i| {
                point(i).distance(nearest_on_segment(point(i), [point(from), point(to)])) <= tolerance
            })
        };
        let mut to = from + 1;
        while to < n && follows(to + 1) {
            to += 1;
        }
        from = to;
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_keep_few_points_and_corners_stay() {
        let radius = 0.3;
        let circle: Contour = (0..2000)
            .map(|i| (f64::from(i) * std::f64::consts::TAU / 2000.0).sin_cos())
            .map(|(sin, cos)| [5.0 + radius * cos, 5.0 + radius * sin])
            .collect();
        let round = plate(&[circle]).unwrap();
        let points = &round.outlines[0].points;
        // A chord with the sagitta s spans 2 acos(1 - s/r).
        let step = 2.0 * (1.0 - TOLERANCE / radius).acos();
        let least = (std::f64::consts::TAU / step).ceil() as usize;
        assert!((least..=least + 2).contains(&points.len()), "{} {least}", points.len());
        for [x, y] in points {
            // On the circle but for half a grid's diagonal.
            assert!(((x - 5.0).hypot(y - 5.0) - radius).abs() < round.grid);
        }
        let square = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 2.0], [0.0, 2.0], [0.0, 1.0]];
        let square = plate(&[square.to_vec()]).unwrap();
        assert_eq!(square.outlines[0].points, [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]);
        assert_eq!(square.area(0.3), 4.0);
        let sliver = vec![[0.0, 0.0], [3.0, 0.0], [3.0, 5e-4], [0.0, 5e-4]];
        assert_eq!(plate(&[sliver]), None);
    }

    #[test]
    fn a_coarser_plate_stays_near_and_keeps_its_leans() {
        let corner = |i: i32| f64::from(i) * std::f64::consts::TAU / 400.0;
        let circle: Contour = (0..400).map(|i| [3.0 + corner(i).cos(), 4.0 + corner(i).sin()]).collect();
        let mut fine = plate(&[circle]).unwrap();
        fine.outlines[0].lean =
            Some(fine.outlines[0].points.iter().map(|[x, y]| [x - 3.0, y - 4.0]).collect());
        let coarse = fine.coarser(0.02);
        assert!(4 * coarse.outlines[0].points.len() < fine.outlines[0].points.len());
        for (height, radius) in [(0.0, 1.0), (0.5, 1.5)] {
            for [x, y] in coarse.outlines[0].at(height) {
                assert!(((x - 3.0).hypot(y - 4.0) - radius).abs() < 1e-5);
            }
        }
        // A polygon whose sides stay within 0.02 of the circle and 0.001 of the finer one.
        let area = std::f64::consts::PI;
        assert!(coarse.area(0.0) < area && coarse.area(0.0) > area * (1.0 - 0.021_f64).powi(2));
    }

    #[test]
    fn coordinates_are_exact_in_single_precision() {
        let contour = vec![[999.123456789, 3.3], [999.9, 3.3], [999.9, 4.7]];
        for [x, y] in &plate(&[contour]).unwrap().at(0.25)[0] {
            assert_eq!([f64::from(*x as f32), f64::from(*y as f32)], [*x, *y]);
        }
    }
}
