//! The guides of a job: read, scaled, and checked to lie on the closed surface.

use std::path::Path;

use super::error::PipelineError;
use crate::geometry::Point3;
use crate::geometry::read::polylines::read_polylines;
use crate::job::{self, GuideWay};
use crate::kirigami::control_mesh::Target;
use crate::kirigami::guides::{Guide, GuideAim};

/// Why a guide cannot be used. Guides are counted from 1, as they stand in the job file.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs)] // The names say it.
pub enum GuideError {
    /// A guided place that is not a place of the sheet.
    #[error(
        "guide {number}: ({:.2}, {:.2}, {:.2}) mm is {distance:.2} mm off the closed surface; allowed is half a cell, \
         {allowed:.2} mm. Coordinates are those of the mesh file, scaled as it is: name places on the closed surface",
        at.x, at.y, at.z
    )]
    Off { number: usize, at: Point3, distance: f64, allowed: f64 },
    /// A curve without length.
    #[error("guide {number}: {path}: no polyline: allowed are l elements of an OBJ file, each with a length")]
    NoCurve { number: usize, path: String },
}

/// The guides of a job in millimetres. `scale` is that of the closed mesh and `side` the side of a closed cell, both
/// in millimetres. Curves on the closed surface become places half a side apart.
///
/// # Errors
/// A file without curves, a place that is off the closed surface by more than half a cell.
pub(super) fn read_guides(
    guides: &[job::Guide],
    scale: f64,
    closed: &Target,
    side: f64,
) -> Result<Vec<Guide>, PipelineError> {
    let allowed = 0.5 * side;
    let read = |(i, guide): (usize, &job::Guide)| {
        let number = i + 1;
        let (places, aim) = match &guide.way {
            GuideWay::Point { closed, open } => (vec![closed * scale], GuideAim::Point(open * scale)),
            GuideWay::Curve { closed, open } => {
                let lines = curves(number, closed, scale)?;
                let places = lines.iter().flat_map(|line| samples(line, allowed)).collect();
                (places, GuideAim::Curves(curves(number, open, scale)?))
            }
        };
        for place in &places {
            let distance = closed.surface.distance(place);
            if distance > allowed {
                return Err(GuideError::Off { number, at: *place, distance, allowed }.into());
            }
        }
        Ok(Guide { places, aim, weight: guide.weight })
    };
    guides.iter().enumerate().map(read).collect()
}

/// The polylines of a file, millimetres: without repeated points, each of two points or more.
fn curves(number: usize, path: &Path, scale: f64) -> Result<Vec<Vec<Point3>>, PipelineError> {
    let found = read_polylines(path)?;
    let line = |vertices: &Vec<usize>| {
        let mut points: Vec<Point3> = vertices.iter().map(|&v| found.vertices[v] * scale).collect();
        points.dedup();
        points
    };
    let lines = found.lines.iter().map(|polyline| line(&polyline.vertices));
    let lines: Vec<_> = lines.filter(|points| points.len() > 1).collect();
    if lines.is_empty() {
        return Err(GuideError::NoCurve { number, path: path.display().to_string() }.into());
    }
    Ok(lines)
}

/// Points along a polyline, evenly spaced, about `spacing` apart, its ends among them.
fn samples(line: &[Point3], spacing: f64) -> Vec<Point3> {
    let mut along = vec![0.0];
    for pair in line.windows(2) {
        along.push(along[along.len() - 1] + (pair[1] - pair[0]).norm());
    }
    let length = along[along.len() - 1];
    let count = (length / spacing).ceil().max(1.0);
    let at = |i: usize| {
        let s = length * i as f64 / count;
        let side = along.partition_point(|&end| end < s).clamp(1, line.len() - 1);
        let part = (s - along[side - 1]) / (along[side] - along[side - 1]);
        line[side - 1] + (line[side] - line[side - 1]) * part
    };
    (0..=count as usize).map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_evenly_spaced_along_the_line() {
        let line = [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [3.0, 4.0, 0.0]].map(Point3::from);
        let found = samples(&line, 1.1);
        let expected =
            [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0], [3.0, 1.0], [3.0, 2.0], [3.0, 3.0], [3.0, 4.0]];
        assert_eq!(found.len(), expected.len());
        for (p, [x, y]) in found.iter().zip(expected) {
            assert!((p - Point3::new(x, y, 0.0)).norm() < 1e-12, "{p}");
        }
        assert_eq!(samples(&line[..2], 100.0), line[..2]);
    }
}
