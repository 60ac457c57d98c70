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
//! that a length l is free on both sides. A notch cuts no feet: the window ends as its sides leave it, or as far drawn out
//! as the profile says, and the groove's own rounds are the ligament's roots.

use kurbo::{Point, Vec2};

use crate::fabrication::error::FabricationError;
use crate::kirigami::design::{Design, Hinge, PatternKind};
use crate::profile::Profile;

/// Radius of the burned roots of a ligament in units of its width: at a quarter the stress concentration of a
/// shouldered bar in bending is about 1.3.
const ROOT_RADIUS: f64 = 0.25;

/// Where a ligament lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Neck {
    /// The hinge point.
    pub centre: Point,
    /// Unit direction from the hinge's first piece to its second.
    pub along: Vec2,
    /// Free length, millimetres.
    pub length: f64,
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
pub fn necks(design: &Design, lengths: &[f64]) -> Result<Vec<Neck>, FabricationError> {
    let neck = |(hinge, &length): (usize, &f64)| {
        let centre = Point::new(design.hinges[hinge].point.x, design.hinges[hinge].point.y);
        let along = neck_direction(design, hinge).ok_or(FabricationError::WindowCorner {
            hinge,
            x: centre.x,
            y: centre.y,
            reason: "its two pieces lie on the same side of it; the design is damaged, make it anew",
        })?;
        Ok(Neck { centre, along, length })
    };
    lengths.iter().enumerate().map(neck).collect()
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
