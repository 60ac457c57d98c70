//! How far hinge points stand from the slit that passes them.
//!
//! A ligament of width h beside a groove of width k has its centre (h + k)/2 from the groove's centre line. Its hinge point
//! is nearer by the offset of its pole ([`pole_offset`]). Where both walls of the groove are ruled, each along the axis of
//! its own hinge, the groove must be k wide where it is narrowest; at mid-plane, over the thickness t, it is wider by
//! t/2 |l1 - l2|, with l1 and l2 the lean of the two axes across the slit, the tangent of their tilt.
//!
//! Where three or more slits meet no hinge has another one across its groove: the polygon between them falls out. But the
//! tool's axis turns from one hinge's to the next one's around each of its corners, and its sides must be as long as that
//! takes.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use super::fabricate::ligament_lengths;
use super::mechanics::pole_offset;
use crate::geometry::{Vector2, Vector3};
use crate::kirigami::design::{Design, Hinge, PatternKind, State};
use crate::kirigami::pattern::JUNCTION_REACH;
use crate::profile::{Pole, Profile};

/// Directions of two hinges at a corner, seen from its midpoint, that are opposite: the cosine of their angle.
const OPPOSITE: f64 = -0.999;

/// Whether all hinges of sheets of this profile need the same gap.
pub fn is_even(profile: &Profile) -> bool {
    !profile.cut.ruled && profile.ligament.pole == Pole::Part(0.0)
}

/// Half the gap of each hinge in the closed state, millimetres, in the order of [`Design::hinges`]; `None` where a hinge needs a
/// ligament that the profile cannot make, of designs that are flat in neither state, and of those cut open without poles.
///
/// Sheets that are cut open have ligaments on the far sides of their hinge points (`open_sheet::gap`): so poles count the other
/// way there, and no wall tapers between two hinges.
///
/// Where more than two hinges meet it is beside the radius that all patterns leave for the polygon between them.
pub fn half_gaps(design: &Design, profile: &Profile) -> Option<Vec<f64>> {
    let lengths = ligament_lengths(design, profile).ok()?;
    let poles = profile.ligament.pole != Pole::Part(0.0) && design.pattern != PatternKind::Bistable;
    let (tapers, towards) = match design.sheet_state? {
        State::Closed => (tapers(design, profile, &lengths), -1.0),
        State::Open if poles => (vec![0.0; design.hinges.len()], 1.0),
        State::Open => return None,
    };
    let half = |(id, hinge): (usize, &Hinge)| {
        0.5 * profile.hinge_gap() + tapers[id] + towards * pole_offset(profile, lengths[id], hinge.angle)
    };
    Some(design.hinges.iter().enumerate().map(half).collect())
}

/// By how much each half of a passing slit is wider at mid-plane than half a groove, per hinge: t/4 |l1 - l2|.
fn tapers(design: &Design, profile: &Profile, lengths: &[f64]) -> Vec<f64> {
    let mut tapers = vec![0.0; design.hinges.len()];
    if !profile.cut.ruled {
        return tapers;
    }
    let mut at_corner: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (id, hinge) in design.hinges.iter().enumerate() {
        at_corner.entry(design.pieces[hinge.pieces[0]].corners[hinge.vertices[0]]).or_default().push(id);
    }
    for (corner, hinges) in at_corner {
        if hinges.len() > 2 {
            let room = polygon_room(design, profile, lengths, corner, &hinges);
            hinges.iter().for_each(|&id| tapers[id] = room);
        }
        let [first, second] = hinges[..] else { continue };
        let arm = |id: usize| (design.hinges[id].point - design.corners[corner]).try_normalize(1e-6);
        let (Some(normal), Some(other)) = (arm(first), arm(second)) else { continue };
        if normal.dot(&other) > OPPOSITE {
            continue;
        }
        let lean = |id: usize| lean(&design.hinges[id].axis, &normal);
        let taper = 0.25 * profile.sheet.thickness * (lean(first) - lean(second)).abs();
        tapers[first] = taper;
        tapers[second] = taper;
    }
    tapers
}

/// How far beside a hinge point the tool must stand along the hinge's axis: before the ligament, and a little more.
pub fn held_beside(length: f64, radius: f64) -> f64 {
    0.5 * length + 0.1 * radius
}

/// How far beside a corner of such a polygon, whose sides turn by `angle` there, the axis has the same direction as at the
/// corner: as far as the walls do that meet outside of it, where the slit begins that halves the angle.
pub fn turned_beside(angle: f64, radius: f64) -> f64 {
    radius * ((0.25 * angle).tan() + 0.1)
}

/// Over which length of a groove an axis may turn whose foot at the sheet's faces moves across it by `shift`.
///
/// The faces' grooves then run at an angle a to that of mid-plane, tan a = shift / length, and the tool cuts R (1/cos a - 1)
/// beyond the wall that is as far from its line everywhere. That is to be a half of the 0.01 mm that milling may err.
fn turning_length(shift: f64, radius: f64) -> f64 {
    shift / (2.0 * TURNING_ERROR / radius).sqrt()
}

/// See [`turning_length`], millimetres.
const TURNING_ERROR: f64 = 5e-3;

/// Sides of the polygon that turn by so much less than half a circle do not meet in one corner.
const OPEN: f64 = 0.2;

/// The least part along the sheet's normal of an axis that a tool can follow at all.
const FLATTEST: f64 = 0.5;

/// How far the sides of such a polygon must reach beside two neighbouring hinges whose arms are `angle` apart, millimetres,
/// for the tool's axis to turn from one hinge's to the other's between them. `lengths`: of the ligaments.
pub fn turning_reach(
    design: &Design,
    profile: &Profile,
    lengths: &[f64],
    hinges: [usize; 2],
    angle: f64,
) -> f64 {
    let radius = 0.5 * profile.cut.kerf;
    let [first, second] = hinges.map(|id| {
        let axis = design.hinges[id].axis;
        // Those that lie flatter are refused with the walls.
        if axis.z.abs() > FLATTEST { axis.xy() / axis.z } else { Vector2::zeros() }
    });
    // At the corner the axis has the mean direction.
    let shift = 0.25 * profile.sheet.thickness * (first - second).norm();
    let [length, other] = hinges.map(|id| lengths[id]);
    held_beside(length.max(other), radius) + turning_length(shift, radius) + turned_beside(angle, radius)
}

/// By how much the polygon between the hinges of a corner must be wider, measured from its middle, than patterns make it.
fn polygon_room(design: &Design, profile: &Profile, lengths: &[f64], corner: usize, hinges: &[usize]) -> f64 {
    let arm = |&id: &usize| {
        let arm = (design.hinges[id].point - design.corners[corner]).xy();
        (arm.norm() > 1e-6).then(|| (arm.y.atan2(arm.x), id))
    };
    let mut arms: Vec<(f64, usize)> = hinges.iter().filter_map(arm).collect();
    arms.sort_by(|a, b| a.0.total_cmp(&b.0));
    let [mut least, mut wanted] = [0.0_f64; 2];
    for (i, &(from, first)) in arms.iter().enumerate() {
        let (to, second) = arms[(i + 1) % arms.len()];
        let angle = (to - from).rem_euclid(2.0 * PI);
        if !(OPEN..PI - OPEN).contains(&angle) {
            continue;
        }
        let reach = turning_reach(design, profile, lengths, [first, second], angle);
        let per_reach = 1.0 / (0.5 * angle).tan();
        wanted = wanted.max(reach * per_reach);
        least = least.max(JUNCTION_REACH * design.gap * per_reach);
    }
    (wanted - least).max(0.0)
}

/// How far an axis moves along a direction of the sheet per millimetre of height.
fn lean(axis: &Vector3, along: &Vector3) -> f64 {
    axis.xy().dot(&along.xy()) / axis.z
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fabrication::test_sheet::{TestSheet, profile};

    fn sheet() -> Design {
        TestSheet::rectangle([4, 3], [10.0, 10.0], profile().hinge_gap()).design(0.7)
    }

    #[test]
    fn half_gaps_are_half_a_ligament_and_groove_less_the_pole_and_more_for_tilts() {
        let mut profile = profile();
        let design = sheet();
        assert!(is_even(&profile));
        assert!(half_gaps(&design, &profile).unwrap().iter().all(|&half| half == 0.275));
        profile.ligament.pole = Pole::Part(0.1);
        assert!(!is_even(&profile));
        let lengths = ligament_lengths(&design, &profile).unwrap();
        for (half, length) in half_gaps(&design, &profile).unwrap().iter().zip(&lengths) {
            assert!((half - (0.275 - 0.1 * length)).abs() < 1e-12);
        }
    }

    #[test]
    fn milled_slits_grow_with_the_difference_of_the_two_leans_only() {
        let mut profile = profile();
        (profile.cut.ruled, profile.sheet.thickness) = (true, 5.0);
        let mut design = sheet();
        let corner_of = |design: &Design, id: usize| {
            let hinge = &design.hinges[id];
            design.pieces[hinge.pieces[0]].corners[hinge.vertices[0]]
        };
        // Every axis leans away from the slit that passes its hinge, each by an angle of its own; half of them point down.
        let tilt = |id: usize| (0.5 + 0.3 * id as f64).to_radians();
        for id in 0..design.hinges.len() {
            let out = design.hinges[id].point - design.corners[corner_of(&design, id)];
            if let Some(out) = out.try_normalize(1e-6) {
                let axis = Vector3::z() * tilt(id).cos() + out * tilt(id).sin();
                design.hinges[id].axis = if id % 2 == 0 { axis } else { -axis };
            }
        }
        let halves = half_gaps(&design, &profile).unwrap();
        let mut two = 0;
        for (id, half) in halves.iter().enumerate() {
            let corner = corner_of(&design, id);
            let partner = (0..halves.len()).find(|&other| other != id && corner_of(&design, other) == corner);
            let apart = partner.map_or(0.0, |partner| tilt(id).tan() + tilt(partner).tan());
            two += usize::from(partner.is_some());
            // A slit that is k wide at its narrow face and k + t (tan a1 + tan a2) at the other is half of that wider at
            // mid-plane.
            let slit = 2.0 * half - profile.ligament.width;
            assert!((slit - (profile.cut.kerf + 2.5 * apart)).abs() < 1e-12, "{slit}");
        }
        assert!(two > 4);
        // The same tilt on both sides needs nothing.
        for hinge in &mut design.hinges {
            hinge.axis = Vector3::new(0.1, 0.05, 1.0).normalize();
        }
        let halves = half_gaps(&design, &profile).unwrap();
        assert!(halves.iter().all(|half| (half - 0.275).abs() < 1e-12));
    }

    /// Three hinges around a corner whose axes lean by `lean` towards it.
    fn star(profile: &Profile, lean: f64) -> Design {
        let mut design = sheet();
        design.gap = profile.hinge_gap();
        let corner = design.pieces[0].corners[0];
        let of = design.hinges[0].clone();
        design.hinges.clear();
        for i in 0..3 {
            let (sin, cos) = (0.4 + 2.0 * PI * f64::from(i) / 3.0).sin_cos();
            let arm = Vector3::new(cos, sin, 0.0);
            let point = design.corners[corner] + 2.0 * arm;
            let axis = (Vector3::z() - lean * arm).normalize();
            design.hinges.push(Hinge { pieces: [0, 0], vertices: [0, 0], point, axis, ..of.clone() });
        }
        design
    }

    #[test]
    fn a_polygon_of_milled_slits_has_room_for_the_axis_to_turn() {
        let mut profile = profile();
        (profile.cut.ruled, profile.sheet.thickness, profile.cut.kerf) = (true, 5.0, 1.0);
        let radius = 0.5_f64;
        let length = ligament_lengths(&star(&profile, 0.0), &profile).unwrap()[0];
        let room = |lean: f64| {
            let halves = half_gaps(&star(&profile, lean), &profile).unwrap();
            assert!(halves.iter().all(|half| (half - halves[0]).abs() < 1e-12));
            halves[0] - 0.5 * profile.hinge_gap()
        };
        assert_eq!(room(0.0), 0.0);
        // An axis that lies in the sheet is refused later, with a message.
        assert!(room(1e9) == 0.0 && room(1.9) == 0.0);
        for lean in [0.2_f64, 0.4] {
            // The three leans are the corners of a triangle of this circumradius: half a side is what the axis turns by from a
            // hinge to a corner of the polygon, over half the thickness.
            let shift = 2.5 * 0.5 * 3.0_f64.sqrt() * lean;
            // Chords of circles about the tool leave the wall by R tan^2 / 2: half of 0.01 mm.
            let turning = shift / (0.01 / radius).sqrt();
            let reach = 0.5 * length + 0.1 * radius + turning + radius * ((PI / 6.0).tan() + 0.1);
            let expected = (reach - 1.5 * profile.hinge_gap()) / 3.0_f64.sqrt();
            assert!(expected > 0.0 && (room(lean) - expected).abs() < 1e-9, "{} {expected}", room(lean));
        }
    }
}
