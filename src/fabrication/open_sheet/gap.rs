//! How far apart the hinge points of a closed corner must stand.
//!
//! A ligament that bends by the angle a while its pieces turn about the hinge point P starts and ends on two lines
//! through P at a/2 to its former axis. Its centre line is as long as the way along these lines by P, so it cannot
//! cut the corner: clamped in both and unstretched, it comes to within 0.03 a/2 lengths of P, or about 0.02 lengths,
//! and its face, half a width further, passes P by not more than h/2 and hardly less. At a closed inner corner two
//! such faces bulge towards each other across the slit that passes, hence h between the hinge points for them to
//! touch, whatever the angle and the length. Between them we leave the width that a closed sheet's slit has, the
//! kerf, or where the pieces are tilted against each other as much as the sheet's faces close in: t tan(tilt/2).
//!
//! The windows' rounded ends need no room of their own: flats and roots are cut into the pieces, behind the sides
//! of the hinge polygons, as long as the ligament is at least h tan(a/2) long.

use kurbo::Point;

use super::super::error::FabricationError;
use super::super::states::corner_place;
use super::super::topology::Topology;
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
    profile.ligament.width + profile.laser.kerf.max(profile.sheet.thickness * (0.5 * tilt).tan())
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
                let (found, needed) = ((p - q).norm(), open_sheet_gap(profile, a.angle(&b)));
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
