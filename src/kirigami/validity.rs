//! Whether a pattern can exist: no cell inverted, crossing itself or overlapping a neighbour, in either
//! state.
//!
//! A tiling by simple, equally oriented faces around every vertex has no local overlap, so it suffices to
//! look at each face: the closed cells between corner midpoints, and in the open state the pieces and the
//! holes between them. Outlines with their real slits and ligaments are checked again in fabrication.

use super::control_mesh::{Goal, Goals};
use super::design::{Design, State};
use super::filled::open_surface;
use super::mirror::is_mirrored;
use crate::geometry::{Point3, Vector3, centroid};

/// Why a pattern cannot be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Invalid {
    /// A face is turned over or crosses itself.
    #[error("{face} near ({:.2}, {:.2}, {:.2}) mm is {fault} in the {state} state: the target asks for more than the pattern can give there; use smaller pieces or cut the target into parts", at.x, at.y, at.z)]
    Face {
        /// Which face, as "piece 12" or "hole 7".
        face: String,
        /// "turned over", "crossing itself" or "mirrored".
        fault: &'static str,
        /// Which state.
        state: &'static str,
        /// Centre of the face.
        at: Point3,
    },
    /// A piece is too narrow.
    #[error("piece {piece} near ({:.2}, {:.2}) mm is only {width:.3} mm wide, less than {least:.3} mm: use larger pieces, or smaller hinges", at.x, at.y)]
    Narrow {
        /// Which piece.
        piece: usize,
        /// Its least width.
        width: f64,
        /// The least allowed.
        least: f64,
        /// Centre of the piece in the sheet state.
        at: Point3,
    },
}

/// Checks a pattern; `least_width` is the least width of a piece's hinge polygon.
///
/// # Errors
/// The first [`Invalid`] face found.
pub fn check(design: &Design, goals: &Goals, least_width: f64) -> Result<(), Invalid> {
    for (i, piece) in design.pieces.iter().enumerate() {
        let cell: Vec<Point3> = piece.corners.iter().map(|&c| design.corners[c]).collect();
        for polygon in [&cell, &piece.closed] {
            check_face(polygon, &outside(goals.closed, polygon), "closed", || format!("piece {i}"))?;
        }
        let width = least_width_of(&piece.closed);
        // A width that is not a number must not pass.
        if width.is_nan() || width < least_width {
            let at = centroid(piece.vertices(design.sheet_state.unwrap_or(State::Closed)));
            return Err(Invalid::Narrow { piece: i, width, least: least_width, at });
        }
    }
    let open = open_surface(design);
    for (i, face) in open.faces.iter().enumerate() {
        let polygon: Vec<Point3> = face.iter().map(|&v| open.vertices[v]).collect();
        check_face(&polygon, &outside(goals.open, &polygon), "open", || {
            match i.checked_sub(design.pieces.len()) {
                None => format!("piece {i}"),
                Some(hole) => format!("hole {hole}"),
            }
        })?;
    }
    mirrored(design, goals)?;
    folded(design, goals)
}

/// Every piece must be the same in both states, not its mirror image.
fn mirrored(design: &Design, goals: &Goals) -> Result<(), Invalid> {
    for (i, piece) in design.pieces.iter().enumerate() {
        let normals = [outside(goals.closed, &piece.closed), outside(goals.open, &piece.open)];
        if is_mirrored(piece, normals) {
            let (face, at) = (format!("piece {i}"), centroid(&piece.open));
            return Err(Invalid::Face { face, fault: "mirrored", state: "open", at });
        }
    }
    Ok(())
}

/// The direction against which a face of a state is seen counter-clockwise: the goal's normal, or the face's own where
/// there is none.
fn outside(goal: Goal, polygon: &[Point3]) -> Vector3 {
    match goal {
        Goal::Plane => Vector3::z(),
        Goal::Surface { target, .. } => target.surface.closest(&centroid(polygon)).normal,
        Goal::Free => area_vector(polygon).try_normalize(0.0).unwrap_or_default(),
    }
}

/// Where a state has no goal, pieces must not fold onto their neighbours: the normals of two that share a hinge are less
/// than a right angle apart.
fn folded(design: &Design, goals: &Goals) -> Result<(), Invalid> {
    for (state, name) in [(State::Closed, "closed"), (State::Open, "open")] {
        if !matches!(goals.of(state), Goal::Free) {
            continue;
        }
        for hinge in &design.hinges {
            let [j, k] = hinge.pieces.map(|piece| design.pieces[piece].vertices(state));
            // A product that is not a number must not pass.
            if area_vector(j).dot(&area_vector(k)) > 0.0 {
                continue;
            }
            let face = format!("piece {}", hinge.pieces[1]);
            return Err(Invalid::Face { face, fault: "turned over", state: name, at: centroid(k) });
        }
    }
    Ok(())
}

/// Area of a polygon times its normal.
fn area_vector(polygon: &[Point3]) -> Vector3 {
    let origin = polygon[0];
    polygon.windows(2).map(|pair| 0.5 * (pair[0] - origin).cross(&(pair[1] - origin))).sum()
}

fn check_face(
    polygon: &[Point3],
    normal: &Vector3,
    state: &'static str,
    name: impl Fn() -> String,
) -> Result<(), Invalid> {
    let area = signed_area(polygon, normal);
    let fault = if crosses_itself(polygon, normal) {
        "crossing itself"
    } else if area <= 0.0 || !area.is_finite() {
        "turned over"
    } else {
        return Ok(());
    };
    Err(Invalid::Face { face: name(), fault, state, at: centroid(polygon) })
}

/// Area of a polygon projected along `normal`, positive where it runs counter-clockwise seen against the
/// normal.
fn signed_area(polygon: &[Point3], normal: &Vector3) -> f64 {
    area_vector(polygon).dot(normal)
}

/// Whether two sides that are not neighbours cross, seen along `normal`.
fn crosses_itself(polygon: &[Point3], normal: &Vector3) -> bool {
    let n = polygon.len();
    let side = |a: Point3, b: Point3, c: Point3| (b - a).cross(&(c - a)).dot(normal);
    let cross = |a, b, c, d| side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0;
    (0..n).any(|i| {
        (i + 2..n)
            .filter(|j| (j + 1) % n != i)
            .any(|j| cross(polygon[i], polygon[(i + 1) % n], polygon[j], polygon[(j + 1) % n]))
    })
}

/// Least distance of a vertex from a side that does not touch it: the width of a convex quad or a lower
/// bound.
fn least_width_of(polygon: &[Point3]) -> f64 {
    let n = polygon.len();
    let mut least = f64::INFINITY;
    for i in 0..n {
        let (a, b) = (polygon[i], polygon[(i + 1) % n]);
        for j in (0..n).filter(|&j| j != i && j != (i + 1) % n) {
            let along = b - a;
            let t = ((polygon[j] - a).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
            let distance = (polygon[j] - (a + along * t)).norm();
            if distance.is_nan() {
                return f64::NAN;
            }
            least = least.min(distance);
        }
    }
    least
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polygon(points: &[[f64; 2]]) -> Vec<Point3> {
        points.iter().map(|[x, y]| Point3::new(*x, *y, 0.3)).collect()
    }

    #[test]
    fn faults_of_faces_are_told_apart() {
        let square = polygon(&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]]);
        let bow = polygon(&[[0.0, 0.0], [2.0, 1.0], [2.0, 0.0], [0.0, 1.2]]);
        let reversed: Vec<Point3> = square.iter().rev().copied().collect();
        let up = Vector3::z();
        let fault = |face: &[Point3]| match check_face(face, &up, "open", || "piece 1".into()) {
            Err(Invalid::Face { fault, .. }) => fault,
            _ => "",
        };
        assert_eq!(fault(&square), "");
        assert_eq!(fault(&bow), "crossing itself");
        assert_eq!(fault(&reversed), "turned over");
        let mut broken = square.clone();
        broken[2].x = f64::NAN;
        assert_ne!(fault(&broken), "");
        assert!((signed_area(&square, &up) - 2.0).abs() < 1e-15);
        assert!((least_width_of(&square) - 1.0).abs() < 1e-15);
    }
}
