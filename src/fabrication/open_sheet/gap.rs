//! How far apart the hinge points of a closed corner must stand.
//!
//! A ligament that bends by the angle a while its pieces turn about the hinge point P starts and ends on two lines
//! through P at a/2 to its former axis, and its centre line is as long as the way along these lines by P: so it cannot
//! cut the corner. As an elastica, clamped in both and unstretched, it passes P at 0.03 lengths for 90 degrees and 0.04
//! for 120; its face, half a width further, goes beyond P by hardly less than h/2 and never by more. At a closed inner
//! corner two such faces bulge towards each other across the slit that passes. They touch where the hinge points
//! stand h apart, whatever the angle and the length. Between them we leave the width that a closed sheet's slit has,
//! the kerf, or where the pieces are tilted against each other as much as the sheet's faces close in: t tan(tilt/2).
//!
//! The windows' rounded ends need no room of their own: flats and roots are cut into the pieces, behind the sides
//! of the hinge polygons. The roots clear each other as well: they need a ligament h tan(a/2) long, and so wide is the
//! closing window's own corner where the flat cuts it.
//!
//! A ligament whose pole is not its middle stands off P by the pole's offset, towards the other ligament of the corner: so
//! much more, for each of the two, they stand apart.

use kurbo::Point;

use super::neck::Neck;
use crate::fabrication::error::FabricationError;
use crate::fabrication::states::corner_place;
use crate::fabrication::topology::Topology;
use crate::geometry::Vector3;
use crate::geometry::rotation::RigidMotion;
use crate::kirigami::design::Design;
use crate::profile::Profile;

/// A shortage below this is no error, millimetres: the optimisation meets its gap to far less, files round to it.
const GAP_TOLERANCE: f64 = 1e-3;

/// The distance that two hinge points of a closed inner corner must have in a sheet that is cut open, millimetres.
///
/// `tilt`: angle between the closed pieces on either side of the passing slit, radians, in 0 to less than pi; 0 where
/// the closed state is flat.
pub fn open_sheet_gap(profile: &Profile, tilt: f64) -> f64 {
    profile.ligament.width + profile.cut.kerf.max(profile.sheet.thickness * (0.5 * tilt).tan())
}

/// Checks the distances of the hinge points at every inner corner in the closed state.
///
/// # Errors
/// The corner that is shortest of room.
pub fn check_gaps(
    design: &Design,
    topology: &Topology,
    motions: &[RigidMotion],
    profile: &Profile,
    necks: &[Neck],
) -> Result<(), FabricationError> {
    let mut worst: Option<(f64, usize, [usize; 2], f64, f64)> = None;
    for (corner, fan) in topology.fans.iter().enumerate().filter(|(_, fan)| !fan.border) {
        let hinges: Vec<usize> =
            fan.edges.iter().filter_map(|&edge| topology.edges[edge].hinge_at(corner)).collect();
        for (i, &first) in hinges.iter().enumerate() {
            for &second in &hinges[i + 1..] {
                let pair = [first, second];
                let [p, q] = pair.map(|hinge| {
                    let hinge = &design.hinges[hinge];
                    design.pieces[hinge.pieces[0]].closed[hinge.vertices[0]]
                });
                let [a, b] = pair.map(|hinge| mean_normal(design.hinges[hinge].pieces, motions));
                let poles: f64 = pair.iter().map(|&hinge| necks[hinge].pole).sum();
                let (found, needed) = ((p - q).norm(), open_sheet_gap(profile, a.angle(&b)) + poles);
                if worst.is_none_or(|(short, ..)| needed - found > short) {
                    worst = Some((needed - found, corner, pair, found, needed));
                }
            }
        }
    }
    match worst {
        // A distance that is not a number must not pass.
        Some((short, corner, hinges, found, needed)) if short.is_nan() || short > GAP_TOLERANCE => {
            let Point { x, y } = corner_place(design, corner);
            Err(FabricationError::NarrowGap { corner, x, y, hinges, found, needed })
        }
        _ => Ok(()),
    }
}

fn mean_normal(pieces: [usize; 2], motions: &[RigidMotion]) -> Vector3 {
    pieces.iter().map(|&piece| motions[piece].rotation * Vector3::z()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fabrication::test_sheet::profile;

    /// End angle, extent along and across of half an elastica of length 1/2: theta'' = -load sin(theta) from theta = 0
    /// with the given curvature, by Runge-Kutta steps.
    fn half_elastica(load: f64, curvature: f64) -> [f64; 3] {
        const STEPS: usize = 60;
        let step = 0.5 / STEPS as f64;
        let slope = |[theta, bend, ..]: [f64; 4]| [bend, -load * theta.sin(), theta.cos(), theta.sin()];
        let moved = |s: [f64; 4], d: [f64; 4], by: f64| std::array::from_fn(|i| s[i] + by * d[i]);
        let mut state = [0.0, curvature, 0.0, 0.0];
        for _ in 0..STEPS {
            let a = slope(state);
            let b = slope(moved(state, a, 0.5 * step));
            let c = slope(moved(state, b, 0.5 * step));
            let d = slope(moved(state, c, step));
            state = std::array::from_fn(|i| state[i] + step / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
        }
        [state[0], state[2], state[3]]
    }

    /// The value in a range at which an increasing function changes its sign.
    fn root(mut low: f64, mut high: f64, value: impl Fn(f64) -> f64) -> f64 {
        for _ in 0..45 {
            let middle = 0.5 * (low + high);
            if value(middle) < 0.0 { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }

    #[test]
    fn a_folded_ligaments_face_passes_the_hinge_point_by_at_most_half_a_width() {
        // Finite rotation of the ends about the hinge point: half the chord is cos(a/2)/2 of the length.
        for (degrees, stand_off) in [(30.0_f64, 0.0096), (60.0, 0.0195), (90.0, 0.0304), (120.0, 0.0427)] {
            let half = 0.5 * degrees.to_radians();
            let clamped = |load: f64| root(0.0, 60.0, |curvature| half_elastica(load, curvature)[0] - half);
            let load = root(0.0, 38.0, |load| 0.5 * half.cos() - half_elastica(load, clamped(load))[1]);
            let [end, along, across] = half_elastica(load, clamped(load));
            assert!((end - half).abs() < 1e-9 && (along - 0.5 * half.cos()).abs() < 1e-9);
            // The ends stand sin(a/2)/2 beside the hinge point, the middle `across` below them.
            let found = 0.5 * half.sin() - across;
            assert!((found - stand_off).abs() < 1e-4, "{degrees}: {found}");
        }
    }

    #[test]
    fn the_gap_is_a_ligament_and_a_kerf_or_the_faces_approach() {
        let profile = profile();
        assert_eq!(open_sheet_gap(&profile, 0.0), profile.hinge_gap());
        // 0.5 tan 5 degrees = 0.0437 is less than the kerf of 0.05, 0.5 tan 10 degrees is more.
        assert_eq!(open_sheet_gap(&profile, 10_f64.to_radians()), profile.hinge_gap());
        assert!((open_sheet_gap(&profile, 20_f64.to_radians()) - (0.5 + 0.0881635)).abs() < 1e-6);
    }
}
