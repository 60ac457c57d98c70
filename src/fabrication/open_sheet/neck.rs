//! The ligament of an open sheet: a neck between the ends of two windows.
//!
//! ```text
//!         window
//!    \               /
//!     |             |   foot
//!   j |_____   _____|
//!            P          k      h
//!      _____   _____
//!     |      l      |
//!     |             |
//!    /               \
//! ```
//!
//! The neck's axis runs from piece j to piece k through the hinge point P and halves the angle between the pieces' own
//! bisectors. Either window ends in a straight flat, half a width and half a kerf from P, with rounded ends. Where the
//! pieces are wider than the ligament the window's end cuts feet into them, as a T bar does into a closed sheet, so
//! that a length l is free on both sides. A ligament whose pole is beside its middle stands off P by as much, away from the
//! window that closes: the pole is on the bent ligament's inner side. A notch cuts no feet: the window ends as its sides leave it, or as far drawn out
//! as the profile says, and the groove's own rounds are the ligament's roots.

use kurbo::{Point, Vec2};

use crate::fabrication::error::FabricationError;
use crate::fabrication::mechanics::pole_offset;
use crate::kirigami::design::{Design, Hinge, PatternKind};
use crate::profile::{Profile, Shape};

/// Radius of the burned roots of a ligament in units of its width: at a quarter the stress concentration of a
/// shouldered bar in bending is about 1.3.
const ROOT_RADIUS: f64 = 0.25;

/// Where a ligament lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Neck {
    /// Its middle: the hinge point, or beside it by the offset of its pole.
    pub centre: Point,
    /// Unit direction from the hinge's first piece to its second.
    pub along: Vec2,
    /// Length of the flats on both sides, millimetres: the free length, but for a notch's rounds.
    pub length: f64,
    /// How far the middle stands off the hinge point, millimetres: away from the window that closes, where positive.
    pub pole: f64,
}

/// Radius of the cut's centre line at the roots of the ligaments, millimetres; the groove adds half a kerf.
pub fn root_radius(profile: &Profile) -> f64 {
    (ROOT_RADIUS * profile.ligament.width - 0.5 * profile.cut.kerf).max(0.0)
}

/// The neck of every hinge, in the hinges' order.
///
/// `lengths`: free length per hinge, millimetres.
///
/// # Errors
/// A hinge whose pieces do not lie on opposite sides of it.
pub fn necks(design: &Design, profile: &Profile, lengths: &[f64]) -> Result<Vec<Neck>, FabricationError> {
    // A notch is as long as its groove from end to end, the groove's centre line shorter.
    let notch = matches!(profile.ligament.shape, Shape::Notch { .. });
    let shorter = if notch { profile.cut.kerf } else { 0.0 };
    let neck = |(id, &length): (usize, &f64)| {
        let hinge = &design.hinges[id];
        let point = Point::new(hinge.point.x, hinge.point.y);
        let along = neck_direction(design, id).ok_or(FabricationError::WindowCorner {
            hinge: id,
            x: point.x,
            y: point.y,
            reason: "its two pieces lie on the same side of it; the design is damaged, make it anew",
        })?;
        // The hinges of bistable sheets turn there and back on their way.
        let carried = design.pattern != PatternKind::Bistable;
        let pole = if carried { pole_offset(profile, length, hinge.angle) } else { 0.0 };
        let centre = point - pole * towards_closing(hinge, along);
        Ok(Neck { centre, along, length: length - shorter, pole })
    };
    lengths.iter().enumerate().map(neck).collect()
}

/// Unit vector across a ligament that leads from piece j to piece k `along`, into the window that closes: about an axis that
/// points up, piece k turns counter-clockwise as seen from piece j, so the window closes that comes next after k.
fn towards_closing(hinge: &Hinge, along: Vec2) -> Vec2 {
    if hinge.axis.z > 0.0 { along.turn_90() } else { -along.turn_90() }
}

/// Unit direction of a hinge's ligament in the open state, from its first piece to its second.
pub fn neck_direction(design: &Design, hinge: usize) -> Option<Vec2> {
    let hinge = &design.hinges[hinge];
    if design.pattern == PatternKind::Bistable {
        return beside_narrow_window(design, hinge);
    }
    let [j, k] = [0, 1].map(|side| {
        let vertices = &design.pieces[hinge.pieces[side]].open;
        let (count, at) = (vertices.len(), hinge.vertices[side]);
        let to = |other: usize| {
            let arm = vertices[other % count] - vertices[at];
            Vec2::new(arm.x, arm.y).normalize()
        };
        // The sum vanishes at a straight angle, the turned difference where the angle does.
        let [next, previous] = [to(at + 1), to(at + count - 1)];
        let bisector = next + previous;
        if bisector.length() > 0.1 { bisector.normalize() } else { (next - previous).turn_90().normalize() }
    });
    let along = k - j;
    (along.length() > 0.1).then(|| along.normalize())
}

/// The direction of a ligament between windows of very different width: across the narrower one's bisector, whose end
/// alone decides where the ligament is.
fn beside_narrow_window(design: &Design, hinge: &Hinge) -> Option<Vec2> {
    let arms = |side: usize| {
        let vertices = &design.pieces[hinge.pieces[side]].open;
        let (count, at) = (vertices.len(), hinge.vertices[side]);
        [at + 1, at + count - 1].map(|other| {
            let arm = vertices[other % count] - vertices[at];
            Vec2::new(arm.x, arm.y).normalize()
        })
    };
    let [[next_j, previous_j], [next_k, previous_k]] = [arms(0), arms(1)];
    let between = |from: Vec2, to: Vec2| from.cross(to).atan2(from.dot(to)).rem_euclid(std::f64::consts::TAU);
    // Counter-clockwise around the hinge: piece j, a window, piece k, a window.
    let [after_j, after_k] = [between(previous_j, next_k), between(previous_k, next_j)];
    let (bisector, sign) =
        if after_j < after_k { (previous_j + next_k, 1.0) } else { (previous_k + next_j, -1.0) };
    (bisector.length() > 0.1).then(|| sign * bisector.normalize().turn_90())
}
