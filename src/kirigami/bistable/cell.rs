//! The model cell of a bistable sheet (section 2.2, Fig. 5): a rectangle a x b, turned by phi, in a cell A x B.
//!
//! From each corner of the rectangle one side is prolonged, pinwheel-wise, to the cell's boundary: the top side to the
//! right edge, the right side to the bottom edge, and so on. When the sheet snaps the rectangle turns from +phi to
//! -phi and the rest only moves apart.
//!
//! a x b are the sides of the rectangle of hinge points. With a gap g, the prolonged side of a hinge passes the next one
//! at the distance g/2: it is tangent to a circle around that hinge. With g = 0 it is the rectangle's side.

use crate::geometry::{Point2, Vector2};

/// Dimensions of a model cell, millimetres and radians; also used for proportions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BistableCell {
    /// Sides A and B of the cell in the unexpanded state, along the grid's first and second direction.
    pub cell: [f64; 2],
    /// Sides a and b of the rectangle of hinge points.
    pub rectangle: [f64; 2],
    /// Half the angle by which the rectangle turns, phi.
    pub phi: f64,
    /// Twice the distance of a hinge point from the centre line of the slit that passes it.
    pub gap: f64,
}

/// A prolonged side that misses the edge of the cell that it must meet, inequality (3).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Miss {
    /// Which sides: 0 for those of length a, which must meet the cell's left and right edges, 1 for those of length b.
    pub side: usize,
    /// The bound that inequality (3) sets to the *other* side of the rectangle.
    pub bound: f64,
    /// By how much the side passes beyond the edge's end, along the edge.
    pub beyond: f64,
}

impl BistableCell {
    /// The same cell `factor` times as large, with a gap of its own.
    pub fn scaled(&self, factor: f64, gap: f64) -> Self {
        let scale = |sides: [f64; 2]| sides.map(|side| side * factor);
        Self { cell: scale(self.cell), rectangle: scale(self.rectangle), phi: self.phi, gap }
    }

    /// The principal stretches lambda_1 and lambda_2 of the snap, Eq. (2).
    pub fn stretches(&self) -> [f64; 2] {
        let [a, b] = self.rectangle;
        let sin = self.phi.sin();
        [1.0 + 2.0 * b * sin / self.cell[0], 1.0 + 2.0 * a * sin / self.cell[1]]
    }

    /// Sides A' and B' of the expanded cell.
    pub fn expanded(&self) -> [f64; 2] {
        let stretches = self.stretches();
        [self.cell[0] * stretches[0], self.cell[1] * stretches[1]]
    }

    /// The angle between a side of the rectangle and the slit that begins at one of its hinges and passes the other.
    fn slant(&self, side: usize) -> f64 {
        (0.5 * self.gap / self.rectangle[side]).asin()
    }

    /// Hinge point `i` of the rectangle about the cell's centre, the rectangle turned by `angle`; 0 to 3 stand for lower
    /// left, lower right, upper right, upper left.
    pub fn hinge(&self, i: usize, angle: f64) -> Point2 {
        const SIGNS: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let [x, y] = [0, 1].map(|axis| 0.5 * SIGNS[i][axis] * self.rectangle[axis]);
        let (sin, cos) = angle.sin_cos();
        Point2::new(cos * x - sin * y, sin * x + cos * y)
    }

    /// Where the slit that passes hinge `i` is nearest to it in the unexpanded cell.
    pub fn passing(&self, i: usize) -> Point2 {
        // The slit that passes hinge 2 runs along the upper side; that of hinge 1 a quarter turn clockwise, and so on.
        let quarters = i as f64 - 2.0;
        let angle = self.phi + self.slant(i % 2) + std::f64::consts::FRAC_PI_2 * quarters;
        self.hinge(i, self.phi) + Vector2::new(-angle.sin(), angle.cos()) * (0.5 * self.gap)
    }

    /// Where the slit that passes hinge `i` meets the cell's edge, along that edge from its middle, counter-clockwise around
    /// the cell; the edge is the right one for hinge 2.
    pub fn crossing(&self, i: usize) -> f64 {
        let side = i % 2;
        let (half, angle) = (0.5 * self.cell[side], self.phi + self.slant(side));
        // As if the edge were the right one: the hinge where the slit begins, turned by full quarters.
        let origin = self.hinge((i + 1) % 4, self.phi).coords;
        let (along, across) = match i {
            2 => (origin.x, origin.y),
            1 => (-origin.y, origin.x),
            0 => (-origin.x, -origin.y),
            _ => (origin.y, -origin.x),
        };
        across + (half - along) * angle.tan()
    }

    /// The model of a cell with other sides A and B and other stretches, the rectangle in proportion: what Eq. (2) leaves
    /// free is chosen so that the rectangle keeps its part of the cell's area, or is as near to that as necks of
    /// three gaps allow.
    pub fn restretched(&self, cell: [f64; 2], stretches: [f64; 2]) -> Self {
        // Half of Eq. (2): b sin(phi) and a sin(phi). A cell that hardly opens keeps a small angle.
        let stretches = stretches.map(|m| m.max(1.0 + LEAST_OPENING));
        let half = [0, 1].map(|i| 0.5 * (stretches[i] - 1.0) * cell[i]);
        let share = self.rectangle[0] * self.rectangle[1] / (self.cell[0] * self.cell[1]);
        let sin = (half[0] * half[1] / (share * cell[0] * cell[1])).sqrt().min(MOST_SINE);
        let at = |phi: f64| Self {
            cell,
            rectangle: [half[1], half[0]].map(|h| h / phi.sin()),
            phi,
            gap: self.gap,
        };
        let (mut near, least) = (sin.asin(), LEAST_NECK_IN_GAPS * self.gap);
        if at(near).neck() >= least {
            return at(near);
        }
        let Some(Self { phi: mut wide, .. }) =
            Self::with_stretches(cell, stretches, self.gap, f64::NEG_INFINITY)
        else {
            return at(near);
        };
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (near + wide);
            *(if at(middle).neck() < least { &mut near } else { &mut wide }) = middle;
        }
        at(wide)
    }

    /// Checks inequalities (3), with the gap: every prolonged side meets its edge of the cell, not the next one.
    pub fn misses(&self) -> Vec<Miss> {
        let miss = |side: usize| {
            // The slit along the side of length a meets the right edge, of length B.
            let half = 0.5 * self.cell[1 - side];
            let beyond = self.crossing(2 - side) - half;
            let (sin, cos) = self.phi.sin_cos();
            let bound = self.cell[1 - side] * cos - self.cell[side] * sin;
            // A figure that is not a number is a miss.
            (beyond.is_nan() || beyond >= 0.0).then_some(Miss { side, bound, beyond })
        };
        [0, 1].into_iter().filter_map(miss).collect()
    }

    /// The width of the necks that pieces have where slits meet their cell's edge: the distance from there to the edge's
    /// end. Negative where inequality (3) does not hold.
    pub fn neck(&self) -> f64 {
        let neck = |side: usize| 0.5 * self.cell[1 - side] - self.crossing(2 - side);
        neck(0).min(neck(1))
    }

    /// Whether a cell of these sides A and B can have these stretches at all with necks of this width and this gap, and with
    /// which a, b and phi it has the widest. Stretches must be more than 1.
    pub fn with_stretches(cell: [f64; 2], stretches: [f64; 2], gap: f64, neck: f64) -> Option<Self> {
        // Eq. (2) gives a and b for every phi; the neck that is left decides.
        let at = |phi: f64| {
            let sin = phi.sin();
            let b = 0.5 * (stretches[0] - 1.0) * cell[0] / sin;
            let a = 0.5 * (stretches[1] - 1.0) * cell[1] / sin;
            Self { cell, rectangle: [a, b], phi, gap }
        };
        // Rectangles smaller than the gap have no slits that pass their hinges.
        let width = |phi: f64| Some(at(phi).neck()).filter(|w| !w.is_nan()).unwrap_or(f64::NEG_INFINITY);
        const STEPS: usize = 90;
        let angles = (1..STEPS).map(|i| i as f64 * std::f64::consts::FRAC_PI_4 / STEPS as f64);
        let best = angles.max_by(|p, q| width(*p).total_cmp(&width(*q)))?;
        (stretches.iter().all(|&m| m > 1.0) && width(best) > neck).then(|| at(best))
    }
}

/// Cells are taken to open by at least this much.
const LEAST_OPENING: f64 = 0.02;

/// Necks that models keep where they can: pieces become narrower than their models.
const LEAST_NECK_IN_GAPS: f64 = 3.0;

/// Halvings of an angle until it no longer changes a neck by more than rounding does.
const BISECTIONS: usize = 40;

/// The sine of 22.5 degrees, at which square cells can grow most.
const MOST_SINE: f64 = 0.382_683;

#[cfg(test)]
mod tests {
    use super::*;

    /// The cell of DESIGN: a = b = 0.42, A = B = 1, phi = 18 degrees.
    fn square(gap: f64) -> BistableCell {
        BistableCell { cell: [1.0; 2], rectangle: [0.42; 2], phi: 18_f64.to_radians(), gap }
    }

    #[test]
    fn stretches_follow_eq_2() {
        let sin = 18_f64.to_radians().sin();
        assert!((square(0.0).stretches()[0] - (1.0 + 0.84 * sin)).abs() < 1e-15);
        let cell = BistableCell { cell: [3.0, 2.0], rectangle: [1.1, 0.7], phi: 0.2, gap: 0.0 };
        let sin = 0.2_f64.sin();
        assert!((cell.expanded()[0] - (3.0 + 1.4 * sin)).abs() < 1e-14);
        assert!((cell.expanded()[1] - (2.0 + 2.2 * sin)).abs() < 1e-14);
    }

    #[test]
    fn a_prolonged_side_misses_its_edge_exactly_where_inequality_3_says() {
        for (cell, phi) in [([1.0, 1.0], 0.3_f64), ([1.4, 1.0], 0.25), ([1.0, 1.3], 0.2)] {
            let (sin, cos) = phi.sin_cos();
            let bounds = [cell[0] * cos - cell[1] * sin, cell[1] * cos - cell[0] * sin];
            for factors in [[0.999, 0.999], [0.999, 1.001], [1.001, 0.999]] {
                let rectangle = [bounds[0] * factors[0], bounds[1] * factors[1]];
                let misses = BistableCell { cell, rectangle, phi, gap: 0.0 }.misses();
                // A side of the rectangle that is too long pushes the *other* pair of prolonged sides off.
                let sides: Vec<usize> = misses.iter().map(|miss| miss.side).collect();
                let expected: Vec<usize> = [0, 1].into_iter().filter(|&s| factors[1 - s] > 1.0).collect();
                assert_eq!(sides, expected, "{cell:?} {factors:?}");
                assert!(misses.iter().all(|miss| (miss.bound - bounds[1 - miss.side]).abs() < 1e-14));
            }
        }
    }

    #[test]
    fn slits_pass_hinges_at_half_the_gap_and_begin_at_hinges() {
        let cell = BistableCell { cell: [10.0, 9.0], rectangle: [4.0, 3.5], phi: 0.3, gap: 0.6 };
        for i in 0..4 {
            let (m, h) = (cell.passing(i), cell.hinge(i, cell.phi));
            let origin = cell.hinge((i + 1) % 4, cell.phi);
            assert!(((m - h).norm() - 0.3).abs() < 1e-14);
            assert!((m - h).dot(&(m - origin)).abs() < 1e-13, "tangent from the hinge where the slit begins");
            // The crossing lies on the same line.
            let half = [0.5 * cell.cell[0], 0.5 * cell.cell[1]];
            let c = cell.crossing(i);
            let edge = match i {
                2 => Point2::new(half[0], c),
                1 => Point2::new(c, -half[1]),
                0 => Point2::new(-half[0], -c),
                _ => Point2::new(-c, half[1]),
            };
            let (along, to) = (m - origin, edge - origin);
            assert!(along.perp(&to).abs() < 1e-13 * to.norm() * 10.0, "{i}");
            assert!(to.norm() > along.norm());
        }
    }

    #[test]
    fn necks_are_what_inequalities_3_leave() {
        let cell = square(0.0);
        let (sin, cos) = cell.phi.sin_cos();
        assert!((cell.neck() - 0.5 * (cos - sin - 0.42) / cos).abs() < 1e-14);
        assert!(square(0.05).neck() < cell.neck());
        let wide = BistableCell::with_stretches([10.0; 2], [1.3; 2], 0.3, 0.4).unwrap();
        assert!(wide.neck() > 0.4 && (wide.stretches()[0] - 1.3).abs() < 1e-12);
        assert!(BistableCell::with_stretches([10.0; 2], [1.3; 2], 0.3, 0.6).is_none());
    }

    #[test]
    fn restretched_cells_have_the_stretches_asked_for() {
        let same = square(0.01).restretched([1.0; 2], square(0.01).stretches());
        assert!((same.phi - square(0.01).phi).abs() < 1e-12 && (same.rectangle[1] - 0.42).abs() < 1e-12);
        let other = square(0.01).restretched([1.1, 0.9], [1.2, 1.3]);
        assert!(other.stretches().iter().zip([1.2, 1.3]).all(|(m, asked)| (m - asked).abs() < 1e-12));
        assert!((other.rectangle[0] * other.rectangle[1] - 0.42 * 0.42 * 0.99).abs() < 1e-12);
        // A large rectangle that hardly turns has narrow necks: a smaller one that turns more has the same stretches.
        let large = BistableCell { rectangle: [0.6; 2], gap: 0.045, ..square(0.0) };
        let wide = large.restretched([1.0; 2], [1.15; 2]);
        assert!((wide.neck() - 0.135).abs() < 1e-9 && wide.rectangle[0] < 0.6, "{wide:?} {}", wide.neck());
        assert!((wide.stretches()[0] - 1.15).abs() < 1e-12);
    }

    #[test]
    fn cells_are_found_for_stretches_within_reach_only() {
        let found = BistableCell::with_stretches([1.0; 2], [1.26; 2], 0.0, 0.0).unwrap();
        assert!(found.misses().is_empty());
        assert!(found.stretches().iter().all(|m| (m - 1.26).abs() < 1e-12));
        // For squares the largest stretch is sqrt 2, at 22.5 degrees and with pieces that touch the bound.
        assert!(BistableCell::with_stretches([1.0; 2], [1.41; 2], 0.0, 0.0).is_some());
        assert!(BistableCell::with_stretches([1.0; 2], [1.415; 2], 0.0, 0.0).is_none());
        assert!(BistableCell::with_stretches([1.0; 2], [0.99, 1.2], 0.0, 0.0).is_none());
    }
}
