//! From a design to a checked cut layout: the stages of fabrication, one after the other.

use kurbo::Point;

use super::cuts::bounding_box;
use super::error::FabricationError;
use super::hinge_table::{HingeRow, hinge_rows};
use super::layout::{CutLayout, CutPath};
use super::ligament::MeasuredLigament;
use super::mechanics::{LengthError, clearance_length, required_length};
use super::notes::notes;
use super::order::cutting_order;
use super::outline::Contour;
use super::placement::place_on_sheet;
use super::{closed_sheet, open_sheet};
use crate::kirigami::design::{Design, Hinge, State};
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
    let longest = profile.ligament_lengths()[1];
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

/// What the layouts of closed and of open sheets have in common: checked cuts and what is left between them.
#[derive(Debug, Clone, PartialEq)]
pub struct LaidOut {
    /// The cuts, in no useful order.
    pub paths: Vec<CutPath>,
    /// One per hinge of the design, measured on the cuts.
    pub ligaments: Vec<MeasuredLigament>,
    /// One per piece, without the ligaments.
    pub outlines: Vec<Contour>,
}

/// Lays out a design for the laser and checks the result.
///
/// `lengths`: free ligament length per hinge, millimetres, in the order of [`Design::hinges`].
///
/// # Errors
/// A design that is damaged or flat in neither state, too large for the stock, with cuts too close together, with
/// pieces that fall off, hang together or collide in the other state. Hinges that are only weak or inaccurate are
/// no error: their row says so.
pub fn fabricate(
    design: &Design,
    profile: &Profile,
    lengths: &[f64],
) -> Result<Fabrication, FabricationError> {
    let design = place_on_sheet(design, profile, lengths)?;
    let laid = match design.sheet_state {
        Some(State::Closed) => closed_sheet::lay_out(&design, profile, lengths)?,
        Some(State::Open) => open_sheet::lay_out(&design, profile, lengths)?,
        None => return Err(FabricationError::NoFlatState),
    };
    let (hinges, layout) = rayon::join(
        || hinge_rows(&design, &laid.ligaments, profile),
        || layout(&laid.paths, &design, profile),
    );
    Ok(Fabrication { layout, design, hinges, outlines: laid.outlines })
}

/// The hinge points on the sheet.
pub fn hinge_points(design: &Design) -> Vec<Point> {
    design.hinges.iter().map(|hinge| Point::new(hinge.point.x, hinge.point.y)).collect()
}

fn layout(paths: &[CutPath], design: &Design, profile: &Profile) -> CutLayout {
    let kerf = profile.cut.kerf;
    let paths = cutting_order(paths, &hinge_points(design));
    let part = bounding_box(&paths).inset(0.5 * kerf);
    CutLayout {
        sheet: [profile.sheet.width, profile.sheet.height],
        kerf,
        engravings: Vec::new(),
        paths,
        notes: notes(profile, part, &[]),
    }
}
