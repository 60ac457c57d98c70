//! Whether the true outlines overlap in the state that the sheet turns into. Outlines, not hinge polygons: of a closed
//! sheet the strip outside a hinge polygon collides first.

use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::single::SingleFloatOverlay;
use kurbo::{Point, Rect};
use rayon::prelude::*;

use super::error::FabricationError;
use super::ligament::MeasuredLigament;
use super::outline::{Contour, area, contains, contour_box};
use super::states::{corner_place, motions, other_name};
use super::topology::{Fan, Topology};
use super::web::segment_gap;
use crate::geometry::rotation::RigidMotion;
use crate::geometry::{Point3, Vector3};
use crate::kirigami::design::{Design, Hinge};

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
    let collision = |(id, (hinge, ligament)): (usize, (&Hinge, &MeasuredLigament))| {
        let Some(axis) = hinge.axis.try_normalize(1e-9) else {
            let reason = "its axis has no direction".into();
            return Some(FabricationError::BadHinge { hinge: id, reason });
        };
        let [still, turned] = [(0, 0.0), (1, hinge.angle)]
            .map(|(side, angle)| seen_along_axis(&outlines[hinge.pieces[side]], hinge, axis, angle));
        let area = overlap(&[still], &[turned]);
        (area > OVERLAP_TOLERANCE).then(|| FabricationError::HingeCollision {
            pieces: hinge.pieces,
            hinge: id,
            x: hinge.point.x,
            y: hinge.point.y,
            area,
            angle_deg: hinge.angle.to_degrees(),
            length: ligament.length,
            needed: ligament.width * (0.5 * hinge.angle).tan(),
        })
    };
    let hinges = design.hinges.par_iter().zip(ligaments).enumerate();
    hinges.find_map_first(collision).map_or(Ok(()), Err)
}

/// Checks the pairs of pieces that meet at a corner or along an edge without sharing a hinge, placed by their rigid
/// motions and looked at along their mean normal.
///
/// `outlines`: #pieces, sheet millimetres.
///
/// # Errors
/// The first pair that overlaps.
pub fn check_corner_collisions(
    design: &Design,
    topology: &Topology,
    outlines: &[Contour],
) -> Result<(), FabricationError> {
    let motions = motions(design);
    let around =
        topology.fans.iter().enumerate().flat_map(|(corner, fan)| apart(fan).map(move |pair| (corner, pair)));
    let beside = topology.edges.iter().filter(|edge| edge.hinge.is_none());
    let beside = beside.filter_map(|edge| Some((edge.ends[0], [edge.left, edge.right?])));
    let pairs: Vec<(usize, [usize; 2])> = around.chain(beside).collect();
    let collision = |&(corner, pieces): &(usize, [usize; 2])| {
        let area = turned_overlap(pieces.map(|piece| (&outlines[piece], &motions[piece])));
        (area > OVERLAP_TOLERANCE).then(|| {
            let Point { x, y } = corner_place(design, corner);
            FabricationError::CornerCollision { pieces, corner, x, y, area, state: other_name(design) }
        })
    };
    pairs.par_iter().find_map_first(collision).map_or(Ok(()), Err)
}

/// The pairs of pieces around a corner that share no edge there.
fn apart(fan: &Fan) -> impl Iterator<Item = [usize; 2]> {
    let count = fan.pieces.len();
    let last = if fan.border { count } else { count.saturating_sub(1) };
    (0..count).flat_map(move |i| {
        let end = if i == 0 { last } else { count };
        (i + 2..end).map(move |j| [fan.pieces[i], fan.pieces[j]])
    })
}

/// Two directions that span the plane perpendicular to a line of sight.
#[derive(Debug, Clone, Copy)]
pub struct View {
    right: Vector3,
    up: Vector3,
}

impl View {
    /// Looks against the unit vector `normal`: what is counter-clockwise around it stays so.
    pub fn against(normal: Vector3) -> Self {
        let guide = if normal.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
        let right = (guide - normal * normal.dot(&guide)).normalize();
        View { right, up: normal.cross(&right) }
    }

    /// A point of the sheet as it is seen after a motion.
    pub fn of(&self, [x, y]: [f64; 2], motion: &RigidMotion) -> [f64; 2] {
        let point = motion.apply(&Point3::new(x, y, 0.0)).coords;
        [point.dot(&self.right), point.dot(&self.up)]
    }
}

/// A sheet outline turned by `angle` about the hinge's axis, seen against the axis, from the hinge.
fn seen_along_axis(outline: &[[f64; 2]], hinge: &Hinge, axis: Vector3, angle: f64) -> Contour {
    let View { right, up } = View::against(axis);
    let (sin, cos) = angle.sin_cos();
    let project = |&[x, y]: &[f64; 2]| {
        let arm = Point3::new(x, y, 0.0) - hinge.point;
        let [a, b] = [arm.dot(&right), arm.dot(&up)];
        [cos * a - sin * b, sin * a + cos * b]
    };
    outline.iter().map(project).collect()
}

/// Overlap of two outlines in the other state, seen along their mean normal.
fn turned_overlap(pieces: [(&Contour, &RigidMotion); 2]) -> f64 {
    let sum: Vector3 = pieces.iter().map(|(_, motion)| motion.rotation * Vector3::z()).sum();
    let Some(normal) = sum.try_normalize(1e-9) else {
        return 0.0; // folded back to back: they do not face each other
    };
    let view = View::against(normal);
    let [first, second] = pieces.map(|(outline, motion)| -> Contour {
        outline.iter().map(|&point| view.of(point, motion)).collect()
    });
    overlap(&[first], &[second])
}

/// Whether the sides of two shapes cross within a box that holds all that they have in common, or one lies in the other.
fn meet(first: &[Contour], second: &[Contour], common: Rect) -> bool {
    let sides = |shape: &[Contour]| -> Vec<[Point; 2]> {
        let sides = shape
            .iter()
            .flat_map(|contour| (0..contour.len()).map(|i| [contour[i], contour[(i + 1) % contour.len()]]));
        let sides = sides.map(|side| side.map(|[x, y]| Point::new(x, y)));
        sides.filter(|[a, b]| common.overlaps(Rect::from_points(*a, *b))).collect()
    };
    let (ours, theirs) = (sides(first), sides(second));
    let beside = |a: &[Point; 2]| {
        let place = Rect::from_points(a[0], a[1]);
        theirs.iter().any(|b| place.overlaps(Rect::from_points(b[0], b[1])) && segment_gap(*a, *b).0 == 0.0)
    };
    let holds = |shape: &[Contour], other: &[Contour]| {
        let inside = |contour: &Contour| shape.iter().any(|around| contains(around, contour[0]));
        other.iter().filter(|contour| !contour.is_empty()).any(inside)
    };
    ours.iter().any(beside) || holds(first, second) || holds(second, first)
}

/// Area common to two shapes, each the union of contours that run counter-clockwise, square millimetres.
pub fn overlap(first: &[Contour], second: &[Contour]) -> f64 {
    let bounds = |shape: &[Contour]| contour_box(&shape.concat());
    let common = bounds(first).intersect(bounds(second));
    // The common box bounds the overlap; most pairs end here.
    if common.width() <= 0.0 || common.height() <= 0.0 || common.area() < OVERLAP_TOLERANCE {
        return 0.0;
    }
    if !meet(first, second, common) {
        return 0.0;
    }
    let shapes = first.to_vec().overlay(&second.to_vec(), OverlayRule::Intersect, FillRule::NonZero);
    shapes.iter().flatten().map(|contour| area(contour)).sum()
}
