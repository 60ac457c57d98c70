//! How far hinge points stand from the slit that passes them.
//!
//! A ligament of width h beside a groove of width k has its centre (h + k)/2 from the groove's centre line. Its hinge point
//! is nearer by the offset of its pole ([`pole_offset`]). Where both walls of the groove are ruled, each along the axis of
//! its own hinge, the groove must be k wide where it is narrowest; at mid-plane, over the thickness t, it is wider by
//! t/2 |l1 - l2|, with l1 and l2 the lean of the two axes across the slit, the tangent of their tilt.

use std::collections::BTreeMap;

use super::fabricate::ligament_lengths;
use super::mechanics::pole_offset;
use crate::geometry::Vector3;
use crate::kirigami::design::{Design, Hinge, PatternKind, State};
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
/// Meant for hinges that one slit passes; where more slits meet at angles they do not taper.
pub fn half_gaps(design: &Design, profile: &Profile) -> Option<Vec<f64>> {
    let lengths = ligament_lengths(design, profile).ok()?;
    let poles = profile.ligament.pole != Pole::Part(0.0) && design.pattern != PatternKind::Bistable;
    let (tapers, towards) = match design.sheet_state? {
        State::Closed => (tapers(design, profile), -1.0),
        State::Open if poles => (vec![0.0; design.hinges.len()], 1.0),
        State::Open => return None,
    };
    let half = |(id, hinge): (usize, &Hinge)| {
        0.5 * profile.hinge_gap() + tapers[id] + towards * pole_offset(profile, lengths[id], hinge.angle)
    };
    Some(design.hinges.iter().enumerate().map(half).collect())
}

/// By how much each half of a passing slit is wider at mid-plane than half a groove, per hinge: t/4 |l1 - l2|.
fn tapers(design: &Design, profile: &Profile) -> Vec<f64> {
    let mut tapers = vec![0.0; design.hinges.len()];
    if !profile.cut.ruled {
        return tapers;
    }
    let mut at_corner: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (id, hinge) in design.hinges.iter().enumerate() {
        at_corner.entry(design.pieces[hinge.pieces[0]].corners[hinge.vertices[0]]).or_default().push(id);
    }
    for (corner, hinges) in at_corner {
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
}
