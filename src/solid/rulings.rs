//! Ruled walls: the direction in which each point of an outline runs through the sheet, and how far a tilted tool takes
//! it.
//!
//! A wall is what a cylinder leaves whose axis stands on a groove's centre line: it runs as that axis does at the nearest
//! point of the line. Where the walls of two grooves meet, their edge runs as both walls do. The section of a tilted
//! cylinder is an ellipse: beside a tool that leans by s across the wall the groove is wider by R (sqrt(1 + s^2) - 1).

use kurbo::{Point, Vec2};

use super::error::SolidError;
use super::outline::{Outline, Plate, TOLERANCE};
use super::strokes::Strokes;
use crate::fabrication::hinge_table::HingeRow;

/// Largest tilt that a wall can follow: beyond, a plate is no longer thin beside the shift of its faces.
const MAX_TILT: f64 = 45.0 * std::f64::consts::PI / 180.0;

/// Largest distance between a ruled wall and its triangles, millimetres: far below what a mill holds. Beside
/// ligaments, where all rulings are parallel, there is none.
const WALL_TOLERANCE: f64 = 4e-3;

/// Sides shorter than this are not divided, millimetres.
const LEAST_STEP: f64 = 0.02;

/// How far inside a side its ends are looked at, so that the neighbour's groove is not the nearest, millimetres.
const INSIDE: f64 = 0.02;

/// Walls that meet at less than this (sine of the angle) are one smooth wall.
const SMOOTH: f64 = 0.1;

/// The directions of all walls of a sheet.
#[derive(Debug, Clone)]
pub struct Rulings<'a> {
    strokes: &'a Strokes,
    /// Half the sheet's thickness, millimetres.
    half: f64,
}

impl<'a> Rulings<'a> {
    /// From the centre lines of all grooves. `thickness`: of the sheet, millimetres.
    ///
    /// # Errors
    /// An axis that tilts by more than 45 degrees.
    pub fn new(strokes: &'a Strokes, rows: &[HingeRow], thickness: f64) -> Result<Self, SolidError> {
        match rows.iter().find(|row| row.tilt > MAX_TILT) {
            Some(row) => Err(SolidError::FlatAxis {
                hinge: row.id,
                x: row.point.x,
                y: row.point.y,
                tilt_deg: row.tilt.to_degrees(),
                limit_deg: MAX_TILT.to_degrees(),
            }),
            None => Ok(Self { strokes, half: 0.5 * thickness }),
        }
    }

    /// The same plate with ruled walls: its outlines get as many further points as keep the wall's triangles within
    /// 0.004 mm of the ruled surface.
    pub fn rule(&self, plate: &Plate) -> Plate {
        let outlines = plate.outlines.iter().map(|outline| self.ruled(&outline.points)).collect();
        Plate { outlines, grid: plate.grid }
    }

    fn ruled(&self, contour: &[[f64; 2]]) -> Outline {
        let n = contour.len();
        let corner = |i: usize| Point::new(contour[i % n][0], contour[i % n][1]);
        let mut sides: Vec<Side> = Vec::new();
        for i in 0..n {
            let whole = self.side([corner(i), corner(i + 1)], 1.0);
            self.divide(whole, &mut sides);
        }
        let count = sides.len();
        let met: Vec<(Point, Vec2)> =
            (0..count).map(|i| met(&sides[(i + count - 1) % count], &sides[i])).collect();
        self.fine(&met)
    }

    /// A side with what its grooves make of it. `part` of its nudge inside at the ends: 0 where the wall goes straight on.
    fn side(&self, ends: [Point; 2], part: f64) -> Side {
        let along = ends[1] - ends[0];
        let inside = (part * INSIDE).min(0.25 * along.hypot()) * along.normalize();
        let normal = -along.normalize().turn_90();
        let [from, to] = [ends[0] + inside, ends[1] - inside].map(|at| self.wall(at, normal));
        Side { ends, normal, walls: [from, to] }
    }

    fn wall(&self, at: Point, normal: Vec2) -> Wall {
        let Some(foot) = self.strokes.foot(at) else { return Wall { lean: Vec2::ZERO, wider: 0.0 } };
        let radius = self.strokes.radius;
        // The middle of a ligament, where a piece's outline ends, is no wall.
        let beside = (foot.distance - radius).abs() < 20.0 * TOLERANCE;
        let wider = if beside { radius * (1.0_f64.hypot(foot.lean.dot(normal)) - 1.0) } else { 0.0 };
        Wall { lean: foot.lean, wider }
    }

    /// Divides a side until its walls are straight between their ends.
    fn divide(&self, side: Side, out: &mut Vec<Side>) {
        let [a, b] = side.ends;
        let straight = [0.25, 0.5, 0.75].iter().all(|&part| {
            let found = self.wall(a.lerp(b, part), side.normal);
            let [from, to] = side.walls.map(|wall| wall.lean);
            self.half * (found.lean - from.lerp(to, part)).hypot() <= TOLERANCE
        });
        if straight || a.distance(b) <= LEAST_STEP {
            out.push(side);
            return;
        }
        let middle = a.midpoint(b);
        let split = self.wall(middle, side.normal);
        let [from, to] = side.walls;
        self.divide(Side { ends: [a, middle], normal: side.normal, walls: [from, split] }, out);
        self.divide(Side { ends: [middle, b], normal: side.normal, walls: [split, to] }, out);
    }

    /// Further points where the wall turns.
    fn fine(&self, met: &[(Point, Vec2)]) -> Outline {
        // The middle of a side's two triangles leaves the ruled wall by a quarter of the thickness times the change.
        let step = 2.0 * WALL_TOLERANCE / self.half;
        let (mut points, mut leans) = (Vec::new(), Vec::new());
        for (i, &(p, l)) in met.iter().enumerate() {
            let (q, m) = met[(i + 1) % met.len()];
            let most = (p.distance(q) / LEAST_STEP).max(1.0);
            let count = ((m - l).hypot() / step).ceil().clamp(1.0, most) as usize;
            for k in 0..count {
                let part = k as f64 / count as f64;
                let (point, lean) = (p.lerp(q, part), l.lerp(m, part));
                points.push([point.x, point.y]);
                leans.push([lean.x, lean.y]);
            }
        }
        Outline { points, lean: Some(leans) }
    }
}

/// What a groove makes of a wall at one point.
#[derive(Debug, Clone, Copy)]
struct Wall {
    lean: Vec2,
    /// By how much the tool's tilt widens the groove.
    wider: f64,
}

/// A straight side of an outline; the material lies to its left, the normal points away from it.
#[derive(Debug, Clone, Copy)]
struct Side {
    ends: [Point; 2],
    normal: Vec2,
    walls: [Wall; 2],
}

/// Where two sides meet once the tool's tilt has widened the grooves, and how their common edge runs.
fn met(before: &Side, after: &Side) -> (Point, Vec2) {
    let ([m, n], [a, b]) = ([before.normal, after.normal], [before.walls[1], after.walls[0]]);
    let mean = 0.5 * (a.lean + b.lean);
    let area = m.cross(n);
    if area.abs() < SMOOTH {
        let both = (m + n) / (1.0 + m.dot(n));
        return (after.ends[0] - 0.5 * (a.wider + b.wider) * both, mean);
    }
    // The vector whose parts along both normals are given.
    let with = |along_m: f64, along_n: f64| (along_n * m.turn_90() - along_m * n.turn_90()) / area;
    let lean = with(a.lean.dot(m), b.lean.dot(n));
    (after.ends[0] - with(a.wider, b.wider), lean)
}
