//! Whether leaning walls stay clear of each other on their way from the mid-plane to the faces.

use kurbo::Point;
use rstar::primitives::{GeomWithData, Line};
use rstar::{AABB, RTree};

use super::error::SolidError;
use super::outline::{Plate, shifted};
use crate::fabrication::web::segment_gap;

/// A side of an outline: from, to, and the leans of both.
struct Side {
    points: [[f64; 2]; 2],
    leans: [[f64; 2]; 2],
    /// Number of the side that follows.
    next: usize,
}

impl Side {
    fn at(&self, height: f64) -> [Point; 2] {
        [0, 1].map(|end| Point::from(<(f64, f64)>::from(shifted(self.points[end], self.leans[end], height))))
    }
}

/// Checks that at both faces no side runs backwards and no two sides meet. Points move in straight lines
/// between the faces and outlines are apart at the mid-plane, so walls that are clear at both faces are clear
/// between them.
///
/// `half`: of the thickness, millimetres.
///
/// # Errors
/// The first wall that folds over or meets another.
pub fn check_walls(plate: &Plate, half: f64) -> Result<(), SolidError> {
    let sides = sides(plate);
    for height in [-half, half] {
        check_folds(&sides, height)?;
        check_meetings(&sides, height)?;
    }
    Ok(())
}

fn sides(plate: &Plate) -> Vec<Side> {
    let mut sides = Vec::new();
    for outline in &plate.outlines {
        let (n, start) = (outline.points.len(), sides.len());
        let lean = |i: usize| outline.lean.as_ref().map_or([0.0; 2], |lean| lean[i]);
        sides.extend((0..n).map(|i| {
            let j = (i + 1) % n;
            Side {
                points: [outline.points[i], outline.points[j]],
                leans: [lean(i), lean(j)],
                next: start + j,
            }
        }));
    }
    sides
}

fn check_folds(sides: &[Side], height: f64) -> Result<(), SolidError> {
    for side in sides {
        let ([a, b], [c, d]) = (side.at(0.0), side.at(height));
        if (b - a).dot(d - c) <= 0.0 {
            let middle = a.midpoint(b);
            return Err(SolidError::WallFolds { x: middle.x, y: middle.y, depth: height });
        }
    }
    Ok(())
}

fn check_meetings(sides: &[Side], height: f64) -> Result<(), SolidError> {
    let line = |(index, side): (usize, &Side)| {
        let [a, b] = side.at(height);
        GeomWithData::new(Line::new([a.x, a.y], [b.x, b.y]), index)
    };
    let tree = RTree::bulk_load(sides.iter().enumerate().map(line).collect());
    for (index, side) in sides.iter().enumerate() {
        let [a, b] = side.at(height);
        let reach = AABB::from_corners([a.x, a.y], [b.x, b.y]);
        for other in tree.locate_in_envelope_intersecting(&reach).map(|line| line.data) {
            if other <= index || sides[other].next == index || side.next == other {
                continue;
            }
            if segment_gap([a, b], sides[other].at(height)).0 == 0.0 {
                return Err(meeting([side, &sides[other]], height));
            }
        }
    }
    Ok(())
}

fn meeting(pair: [&Side; 2], height: f64) -> SolidError {
    let (width, at) = segment_gap(pair[0].at(0.0), pair[1].at(0.0));
    let [a, b] = pair.map(|side| [0, 1].map(|k| 0.5 * (side.leans[0][k] + side.leans[1][k])));
    let closing = height.abs() * (a[0] - b[0]).hypot(a[1] - b[1]);
    SolidError::WallsMeet { x: at.x, y: at.y, depth: height, closing, width }
}
