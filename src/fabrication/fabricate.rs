//! From a design to a checked cut layout: the stages of fabrication, one after the other.

use super::collision::{check_corner_collisions, check_hinge_collisions};
use super::cuts::{CutSet, bounding_box, cut_set};
use super::error::FabricationError;
use super::frame::corner_frames;
use super::hinge_table::{HingeRow, hinge_rows};
use super::layout::CutLayout;
use super::ligament::measure_ligaments;
use super::mechanics::{LengthError, clearance_length, required_length};
use super::notes::notes;
use super::order::in_cutting_order;
use super::outline::{Contour, piece_outlines};
use super::placement::place_on_sheet;
use super::slit::Plan;
use super::topology::topology;
use super::web::{CutIndex, check_webs};
use crate::kirigami::design::{Design, Hinge};
use crate::profile::Profile;

/// A checked sheet, ready to be written.
#[derive(Debug, Clone, PartialEq)]
pub struct Fabrication {
    /// The design in sheet coordinates: its sheet state lies where it will be cut.
    pub design: Design,
    /// The cuts in order, with notes.
    pub layout: CutLayout,
    /// One row per hinge of the design.
    pub hinges: Vec<HingeRow>,
    /// True outline of every piece in the sheet state, counter-clockwise, millimetres, without the ligaments.
    pub outlines: Vec<Contour>,
}

/// The free ligament length that each hinge's own angle needs, millimetres, in the order of [`Design::hinges`]. Where
/// the strain limit asks for more than the profile's longest ligament it is that one: too weak, as the hinge's row
/// will say.
///
/// # Errors
/// A hinge whose neighbouring strips collide beside the longest ligament.
pub fn ligament_lengths(design: &Design, profile: &Profile) -> Result<Vec<f64>, FabricationError> {
    let longest = profile.ligament.max_length;
    let length = |(id, hinge): (usize, &Hinge)| {
        let at = hinge.point;
        match required_length(profile, hinge.angle) {
            Err(LengthError::TooLong { .. }) if clearance_length(profile, hinge.angle) <= longest => {
                Ok(longest)
            }
            Err(source) => Err(FabricationError::Length { hinge: id, x: at.x, y: at.y, source }),
            Ok(length) => Ok(length),
        }
    };
    design.hinges.iter().enumerate().map(length).collect()
}

/// Lays out a design for the laser and checks the result.
///
/// `lengths`: free ligament length per hinge, millimetres, in the order of [`Design::hinges`].
///
/// # Errors
/// A design that is damaged or not closed and flat, too large for the stock, with cuts too close together, with
/// pieces that fall off, hang together or collide when they open. Hinges that are only weak or inaccurate are no
/// error: their row says so.
pub fn fabricate(
    design: &Design,
    profile: &Profile,
    lengths: &[f64],
) -> Result<Fabrication, FabricationError> {
    let kerf = profile.laser.kerf;
    let design = place_on_sheet(design, profile, lengths)?;
    let topology = topology(&design)?;
    let frames = corner_frames(&design, &topology)?;
    let cuts = in_cutting_order(&cut_set(&Plan::new(&topology, &frames, lengths, profile))?);
    let index = CutIndex::new(&cuts.paths);
    check_webs(&cuts, &index, kerf, profile.laser.min_web)?;
    let ligaments = measure_ligaments(&design.hinges, &cuts, &index, kerf);
    let outlines = piece_outlines(&design, &cuts.paths, &ligaments, kerf)?;
    check_hinge_collisions(&design, &outlines, &ligaments)?;
    check_corner_collisions(&design, &topology.fans, &outlines)?;
    let hinges = hinge_rows(&design, &ligaments, profile);
    Ok(Fabrication { layout: layout(cuts, profile), design, hinges, outlines })
}

fn layout(cuts: CutSet, profile: &Profile) -> CutLayout {
    let kerf = profile.laser.kerf;
    let part = bounding_box(&cuts.paths).inset(0.5 * kerf);
    CutLayout {
        sheet: [profile.sheet.width, profile.sheet.height],
        kerf,
        paths: cuts.paths,
        notes: notes(profile, part),
    }
}
