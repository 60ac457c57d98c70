//! Ruled walls: the direction in which each point of an outline runs through the sheet.
//!
//! Around a ligament every wall follows the hinge's axis, so that its neck is centred on the axis at every
//! height; between two ligaments a wall's direction changes evenly along its length. The two walls of a slit
//! pass different hinges and so are ruled each for itself.

use kurbo::{Point, Vec2};
use rstar::primitives::GeomWithData;
use rstar::{AABB, RTree};

use super::error::SolidError;
use super::outline::{Outline, Plate, TOLERANCE};
use crate::fabrication::hinge_table::HingeRow;
use crate::fabrication::web::nearest_on_segment;

/// Largest tilt that a wall can follow: beyond, a plate is no longer thin beside the shift of its faces.
const MAX_TILT: f64 = 45.0 * std::f64::consts::PI / 180.0;

/// Largest distance between a ruled wall and its triangles, millimetres: far below what a mill holds. Beside
/// ligaments, where all rulings are parallel, there is none.
const WALL_TOLERANCE: f64 = 5e-3;

/// Points nearer to each other than this are one, millimetres.
const LEAST_STEP: f64 = 0.1 * TOLERANCE;

/// The hinges' axes, searchable by place.
#[derive(Debug, Clone)]
pub struct Rulings {
    tree: RTree<GeomWithData<[f64; 2], Ruling>>,
    /// The largest reach of all.
    reach: f64,
    /// Largest change of direction along one side of an outline.
    step: f64,
}

/// What a hinge asks of the walls around it.
#[derive(Debug, Clone, Copy)]
struct Ruling {
    /// Its axis: (dx/dz, dy/dz).
    lean: [f64; 2],
    /// Radius within which walls follow it: the ligament's farthest corner.
    reach: f64,
}

impl Rulings {
    /// From the hinge table. `thickness`: of the sheet, millimetres.
    ///
    /// # Errors
    /// An axis that tilts by more than 45 degrees.
    pub fn new(rows: &[HingeRow], thickness: f64) -> Result<Self, SolidError> {
        let mut hinges = Vec::with_capacity(rows.len());
        for row in rows {
            if row.tilt > MAX_TILT {
                return Err(SolidError::FlatAxis {
                    hinge: row.id,
                    x: row.point.x,
                    y: row.point.y,
                    tilt_deg: row.tilt.to_degrees(),
                    limit_deg: MAX_TILT.to_degrees(),
                });
            }
            let lean = [row.axis.x / row.axis.z, row.axis.y / row.axis.z];
            // Outlines are off by up to the tolerance.
            let reach = 0.5 * row.length.hypot(row.width)
                + row.pole_offset.abs()
                + row.centre_offset
                + 2.0 * TOLERANCE;
            hinges.push(GeomWithData::new([row.point.x, row.point.y], Ruling { lean, reach }));
        }
        let reach = hinges.iter().map(|hinge| hinge.data.reach).fold(0.0, f64::max);
        // The middle of a side's two triangles leaves the ruled wall by a quarter of the thickness times the
        // change.
        Ok(Self { tree: RTree::bulk_load(hinges), reach, step: 4.0 * WALL_TOLERANCE / thickness })
    }

    /// The same plate with ruled walls: its outlines get further points where walls begin and end to follow a
    /// hinge, and as many between as keep the wall's triangles within 0.005 mm of the ruled surface. An
    /// outline that passes no hinge stays vertical.
    pub fn rule(&self, plate: &Plate) -> Plate {
        let outlines = plate.outlines.iter().map(|outline| self.ruled(&outline.points)).collect();
        Plate { outlines, grid: plate.grid }
    }

    fn ruled(&self, contour: &[[f64; 2]]) -> Outline {
        let points = self.with_ends(contour);
        let held: Vec<Option<[f64; 2]>> = points.iter().map(|&p| self.nearest(p)).collect();
        let lean = interpolated(&points, &held);
        let (mut fine, mut leans) = (Vec::new(), Vec::new());
        for (i, (&p, &l)) in points.iter().zip(&lean).enumerate() {
            let j = (i + 1) % points.len();
            let (q, m) = (points[j], lean[j]);
            let change = (m[0] - l[0]).hypot(m[1] - l[1]);
            let length = (q[0] - p[0]).hypot(q[1] - p[1]);
            let count = (change / self.step).ceil().min(length / LEAST_STEP).max(1.0) as usize;
            for k in 0..count {
                let part = k as f64 / count as f64;
                fine.push(mixed(p, q, part));
                leans.push(mixed(l, m, part));
            }
        }
        Outline { points: fine, lean: Some(leans) }
    }

    /// The direction of the nearest hinge that reaches a point.
    fn nearest(&self, point: [f64; 2]) -> Option<[f64; 2]> {
        self.tree
            .nearest_neighbor_iter_with_distance_2(&point)
            .take_while(|(_, distance2)| *distance2 <= self.reach * self.reach)
            .find(|(hinge, distance2)| *distance2 <= hinge.data.reach * hinge.data.reach)
            .map(|(hinge, _)| hinge.data.lean)
    }

    /// A contour with further points where it enters and leaves the reach of hinges, and nearest to them.
    fn with_ends(&self, contour: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let mut points = Vec::with_capacity(contour.len());
        for (i, &from) in contour.iter().enumerate() {
            let to = contour[(i + 1) % contour.len()];
            points.push(from);
            let length = (to[0] - from[0]).hypot(to[1] - from[1]);
            let mut last = 0.0;
            for part in self.ends(from, to, length) {
                if (part - last) * length > LEAST_STEP && (1.0 - part) * length > LEAST_STEP {
                    points.push(mixed(from, to, part));
                    last = part;
                }
            }
        }
        points
    }

    /// Parts of a straight side at which hinges begin and cease to hold it, in order.
    fn ends(&self, from: [f64; 2], to: [f64; 2], length: f64) -> Vec<f64> {
        let low = [0, 1].map(|k| from[k].min(to[k]) - self.reach);
        let high = [0, 1].map(|k| from[k].max(to[k]) + self.reach);
        let [a, b] = [from, to].map(|p| Point::new(p[0], p[1]));
        let mut parts = Vec::new();
        for hinge in self.tree.locate_in_envelope(&AABB::from_corners(low, high)) {
            let centre = Point::new(hinge.geom()[0], hinge.geom()[1]);
            if centre.distance(nearest_on_segment(centre, [a, b])) > hinge.data.reach {
                continue;
            }
            let along: Vec2 = (b - a) / length;
            let foot = (centre - a).dot(along);
            let aside = (centre - a).cross(along);
            // A hair inside, so that the end itself is held.
            let half = ((hinge.data.reach - 0.5 * TOLERANCE).powi(2) - aside * aside).max(0.0).sqrt();
            parts.extend([foot - half, foot, foot + half].map(|at| at / length));
        }
        parts.retain(|part| (0.0..1.0).contains(part));
        parts.sort_by(f64::total_cmp);
        parts
    }
}

fn mixed(a: [f64; 2], b: [f64; 2], part: f64) -> [f64; 2] {
    [0, 1].map(|k| a[k] + part * (b[k] - a[k]))
}

/// Directions of all points of a closed contour: those that are held, and between them in proportion to the
/// length.
fn interpolated(points: &[[f64; 2]], held: &[Option<[f64; 2]>]) -> Vec<[f64; 2]> {
    let n = points.len();
    let Some(first) = held.iter().position(Option::is_some) else {
        return vec![[0.0; 2]; n];
    };
    let mut leans = vec![[0.0; 2]; n];
    let mut last = (first, held[first].unwrap_or_default());
    // Length from the last held point to each of the points since.
    let mut lengths = vec![0.0];
    for k in first + 1..=first + n {
        let ([ax, ay], [bx, by]) = (points[(k - 1) % n], points[k % n]);
        lengths.push(lengths[lengths.len() - 1] + (bx - ax).hypot(by - ay));
        if let Some(lean) = held[k % n] {
            let whole = lengths[lengths.len() - 1].max(f64::MIN_POSITIVE);
            for (i, length) in lengths.iter().enumerate() {
                leans[(last.0 + i) % n] = mixed(last.1, lean, length / whole);
            }
            leans[k % n] = lean;
            last = (k, lean);
            lengths = vec![0.0];
        }
    }
    leans
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn between_hinges_directions_follow_the_length() {
        // A square of side 4, held at two opposite corners.
        let points = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [1.0, 4.0], [0.0, 4.0]];
        let held = [Some([0.0, 0.0]), None, Some([0.8, 0.4]), None, None];
        let leans = interpolated(&points, &held);
        let expected = [[0.0, 0.0], [0.4, 0.2], [0.8, 0.4], [0.5, 0.25], [0.4, 0.2]];
        for (found, wanted) in leans.iter().zip(expected) {
            assert!((found[0] - wanted[0]).hypot(found[1] - wanted[1]) < 1e-15, "{leans:?}");
        }
        assert_eq!(interpolated(&points, &[None; 5]), [[0.0; 2]; 5]);
        let one = [None, None, Some([0.3, 0.1]), None, None];
        assert_eq!(interpolated(&points, &one), [[0.3, 0.1]; 5]);
    }
}
