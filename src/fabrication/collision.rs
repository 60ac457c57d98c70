//! Whether the true outlines overlap in the open state. Outlines, not hinge polygons: the strip outside a hinge
//! polygon collides first.

use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::single::SingleFloatOverlay;
use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion};

use super::error::FabricationError;
use super::ligament::MeasuredLigament;
use super::outline::{Contour, area, contour_box};
use super::topology::Fan;
use crate::geometry::{Point3, Vector3};
use crate::kirigami::design::{Design, Hinge, Piece};

/// Overlaps below this are ignored, square millimetres: two right-angled corners that touch a hundredth of a
/// millimetre deep.
pub const OVERLAP_TOLERANCE: f64 = 1e-4;

/// Checks every pair of pieces that share a hinge, each turned about its own hinge axis by the full angle and
/// looked at along the axis.
///
/// `outlines`: #pieces, sheet millimetres, without the ligaments.
///
/// # Errors
/// The first pair that overlaps, with the free length that would clear its roots.
pub fn check_hinge_collisions(
    design: &Design,
    outlines: &[Contour],
    ligaments: &[MeasuredLigament],
) -> Result<(), FabricationError> {
    for (id, (hinge, ligament)) in design.hinges.iter().zip(ligaments).enumerate() {
        let Some(axis) = hinge.axis.try_normalize(1e-9) else {
            return Err(FabricationError::BadHinge { hinge: id, reason: "its axis has no direction".into() });
        };
        let [still, turned] = [(0, 0.0), (1, hinge.angle)]
            .map(|(side, angle)| seen_along_axis(&outlines[hinge.pieces[side]], hinge, axis, angle));
        let area = overlap(&still, &turned);
        if area > OVERLAP_TOLERANCE {
            return Err(FabricationError::HingeCollision {
                pieces: hinge.pieces,
                hinge: id,
                x: hinge.point.x,
                y: hinge.point.y,
                area,
                angle_deg: hinge.angle.to_degrees(),
                length: ligament.length,
                needed: ligament.width * (0.5 * hinge.angle).tan(),
            });
        }
    }
    Ok(())
}

/// Checks the pairs of pieces that meet at a corner without sharing a hinge, placed by their rigid motions and
/// looked at along their mean normal.
///
/// `fans`: one per corner of the design; `outlines`: #pieces, sheet millimetres.
///
/// # Errors
/// The first pair that overlaps.
pub fn check_corner_collisions(
    design: &Design,
    fans: &[Fan],
    outlines: &[Contour],
) -> Result<(), FabricationError> {
    let motions: Vec<_> = design.pieces.iter().map(opening_motion).collect();
    for (corner, fan) in fans.iter().enumerate() {
        for (&first, &second) in fan.pieces.iter().zip(fan.pieces.iter().skip(2)) {
            let pair = [first, second];
            let area = open_overlap(pair.map(|piece| (&outlines[piece], &motions[piece])));
            if area > OVERLAP_TOLERANCE {
                let [x, y] = [design.corners[corner].x, design.corners[corner].y];
                return Err(FabricationError::CornerCollision { pieces: pair, corner, x, y, area });
            }
        }
    }
    Ok(())
}

/// A sheet outline turned by `angle` about the hinge's axis, in a plane perpendicular to the axis, from the hinge.
fn seen_along_axis(outline: &[[f64; 2]], hinge: &Hinge, axis: Vector3, angle: f64) -> Contour {
    let guide = if axis.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
    let u = (guide - axis * axis.dot(&guide)).normalize();
    let v = axis.cross(&u);
    let (sin, cos) = angle.sin_cos();
    let project = |&[x, y]: &[f64; 2]| {
        let arm = Point3::new(x, y, 0.0) - hinge.point;
        let [a, b] = [arm.dot(&u), arm.dot(&v)];
        [cos * a - sin * b, sin * a + cos * b]
    };
    outline.iter().map(project).collect()
}

/// Overlap of two outlines in the open state, seen along their mean normal.
fn open_overlap(pieces: [(&Contour, &Isometry3<f64>); 2]) -> f64 {
    let normals = pieces.map(|(_, motion)| motion * Vector3::z());
    let Some(normal) = (normals[0] + normals[1]).try_normalize(1e-9) else {
        return 0.0; // folded back to back: they do not face each other
    };
    let guide = if normal.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
    let u = (guide - normal * normal.dot(&guide)).normalize();
    let v = normal.cross(&u);
    let [first, second] = pieces.map(|(outline, motion)| -> Contour {
        let project = |&[x, y]: &[f64; 2]| {
            let point = (motion * Point3::new(x, y, 0.0)).coords;
            [point.dot(&u), point.dot(&v)]
        };
        outline.iter().map(project).collect()
    });
    overlap(&first, &second)
}

/// Area common to two contours, square millimetres.
fn overlap(first: &Contour, second: &Contour) -> f64 {
    let common = contour_box(first).intersect(contour_box(second));
    // The common box bounds the overlap; most corner pairs end here.
    if common.width() <= 0.0 || common.height() <= 0.0 || common.area() < OVERLAP_TOLERANCE {
        return 0.0;
    }
    let shapes = first.overlay(second, OverlayRule::Intersect, FillRule::NonZero);
    shapes.iter().flatten().map(|contour| area(contour)).sum()
}

/// The rigid motion that takes a piece from its closed to its open state: the best fit in the sense of least
/// squares (Kabsch 1976).
fn opening_motion(piece: &Piece) -> Isometry3<f64> {
    let mean =
        |points: &[Point3]| points.iter().map(|point| point.coords).sum::<Vector3>() / points.len() as f64;
    let (from, to) = (mean(&piece.closed), mean(&piece.open));
    let spread: Matrix3<f64> = piece
        .closed
        .iter()
        .zip(&piece.open)
        .map(|(p, q)| (q.coords - to) * (p.coords - from).transpose())
        .sum();
    let svd = spread.svd(true, true);
    let (u, v_t) = (svd.u.unwrap_or_default(), svd.v_t.unwrap_or_default());
    let sign = (u * v_t).determinant().signum();
    let matrix = u * Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, sign)) * v_t;
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(matrix));
    Isometry3::from_parts(Translation3::from(to - rotation * from), rotation)
}
