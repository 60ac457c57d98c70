//! Circular arcs of cut paths, from their bulge.

use kurbo::{Point, Vec2};

/// An arc between two vertices of a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BulgeArc {
    /// Centre, millimetres.
    pub center: Point,
    /// Radius, millimetres.
    pub radius: f64,
    /// Direction from the centre to the first vertex, radians from +x, counter-clockwise.
    pub start: f64,
    /// Turning angle to the second vertex, radians, positive counter-clockwise; at most one full turn.
    pub sweep: f64,
}

impl BulgeArc {
    /// The arc from `from` to `to` with bulge tan(sweep/4), or `None` where it leaves the chord by less than
    /// `flat` millimetres and is a straight line.
    pub fn new(from: Point, to: Point, bulge: f64, flat: f64) -> Option<Self> {
        let chord = to - from;
        // The rise of an arc over its chord c is |bulge| c/2 (definition of the bulge).
        if 0.5 * bulge.abs() * chord.hypot() < flat || bulge == 0.0 {
            return None;
        }
        let left = Vec2::new(-chord.y, chord.x);
        let center = from.midpoint(to) + left * ((1.0 - bulge * bulge) / (4.0 * bulge));
        let radius = chord.hypot() * (1.0 + bulge * bulge) / (4.0 * bulge.abs());
        Some(Self { center, radius, start: (from - center).atan2(), sweep: 4.0 * bulge.atan() })
    }

    /// The point at a fraction of the sweep.
    pub fn point(&self, fraction: f64) -> Point {
        self.center + self.radius * Vec2::from_angle(self.start + fraction * self.sweep)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    // Coordinates of order 10 with 1e-16 relative rounding, a few operations.
    const EPS: f64 = 1e-12;

    #[test]
    fn positive_bulge_turns_counter_clockwise() {
        // A quarter of the circle of radius 2 about (5, 7), from the east to the north.
        let bulge = (FRAC_PI_2 / 4.0).tan();
        let arc = BulgeArc::new(Point::new(7.0, 7.0), Point::new(5.0, 9.0), bulge, 1e-6).unwrap();
        assert!((arc.center - Point::new(5.0, 7.0)).hypot() < EPS);
        assert!((arc.radius - 2.0).abs() < EPS);
        assert!((arc.sweep - FRAC_PI_2).abs() < EPS);
        let middle = Point::new(5.0, 7.0) + 2.0 * Vec2::from_angle(PI / 4.0);
        assert!((arc.point(0.5) - middle).hypot() < EPS);
    }

    #[test]
    fn ends_meet_the_vertices_for_every_sign_and_size() {
        let (from, to) = (Point::new(-3.0, 1.0), Point::new(2.5, -4.0));
        for bulge in [-900.0, -3.0, -1.0, -0.2, 0.01, 0.7, 1.0, 1.5, 40.0] {
            let arc = BulgeArc::new(from, to, bulge, 1e-6).unwrap();
            // The radius grows to 1700 times the chord: the error grows with it.
            let eps = EPS * arc.radius.max(1.0);
            assert!((arc.point(0.0) - from).hypot() < eps, "bulge {bulge}");
            assert!((arc.point(1.0) - to).hypot() < eps, "bulge {bulge}");
            assert_eq!(arc.sweep > 0.0, bulge > 0.0);
        }
    }

    #[test]
    fn flat_arcs_are_lines() {
        let (from, to) = (Point::new(0.0, 0.0), Point::new(10.0, 0.0));
        // Rise 5 b: 0.9e-6 mm is flat at 1e-6 mm, 1.1e-6 mm is not.
        assert_eq!(BulgeArc::new(from, to, 0.18e-6, 1e-6), None);
        assert!(BulgeArc::new(from, to, 0.22e-6, 1e-6).is_some());
        assert_eq!(BulgeArc::new(from, to, 0.0, 0.0), None);
    }
}
