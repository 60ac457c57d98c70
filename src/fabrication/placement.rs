//! Where the part lies on the stock.

use super::cuts::bounding_box;
use super::error::FabricationError;
use super::{closed_sheet, open_sheet};
use crate::geometry::{Point3, Vector3};
use crate::kirigami::design::{Design, State};
use crate::profile::{Profile, Shape};

/// The design, moved in x and y so that its cuts, with half a kerf, keep the stock's margin from the left and the
/// lower edge. The other state stays where it is. Moving a moved design changes nothing beyond rounding.
///
/// `lengths`: free ligament length per hinge, millimetres.
///
/// # Errors
/// A design that is flat in neither state or damaged, or a part that is larger than the stock.
pub fn place_on_sheet(
    design: &Design,
    profile: &Profile,
    lengths: &[f64],
) -> Result<Design, FabricationError> {
    let state = design.sheet_state.ok_or(FabricationError::NoFlatState)?;
    check_lengths(design, profile, lengths)?;
    let paths = match state {
        State::Closed => closed_sheet::cuts_of(design, profile, lengths)?.0.paths,
        State::Open => open_sheet::cuts_of(design, profile, lengths)?.0.paths,
    };
    let part = bounding_box(&paths).inset(0.5 * profile.cut.kerf);
    let sheet = &profile.sheet;
    let [room_x, room_y] = [sheet.width, sheet.height].map(|size| size - 2.0 * sheet.margin);
    // A nanometre of rounding may make a part that just fits seem too large.
    if part.width() > room_x + 1e-6 || part.height() > room_y + 1e-6 {
        // When the target is scaled, ligament and kerf around the pieces keep their size, and so does half a gap on
        // each piece's side.
        let ligaments = if state == State::Closed { profile.hinge_gap() } else { 0.0 };
        let rim = ligaments + profile.cut.kerf;
        let gap_share = 0.5 * design.gap / design.mean_edge();
        let scale_in = |room: f64, size: f64| {
            let fixed = rim + gap_share * (size - rim);
            (room - fixed).max(0.0) / (size - fixed)
        };
        let scale = scale_in(room_x, part.width()).min(scale_in(room_y, part.height()));
        return Err(FabricationError::TooLarge {
            width: part.width(),
            height: part.height(),
            room_x,
            room_y,
            scale,
        });
    }
    Ok(moved(design, Vector3::new(sheet.margin - part.x0, sheet.margin - part.y0, 0.0)))
}

fn check_lengths(design: &Design, profile: &Profile, lengths: &[f64]) -> Result<(), FabricationError> {
    if lengths.len() != design.hinges.len() {
        return Err(FabricationError::LengthCount { found: lengths.len(), expected: design.hinges.len() });
    }
    let limit = profile.cut.kerf;
    // A round notch is as long as the groove is wide; a bar is longer.
    let notch = matches!(profile.ligament.shape, Shape::Notch { .. });
    let fits = |length: f64| length.is_finite() && (length > limit || (notch && length == limit));
    let bad = lengths.iter().position(|&length| !fits(length));
    match bad {
        Some(hinge) => Err(FabricationError::BadLength { hinge, value: lengths[hinge], limit }),
        None => Ok(()),
    }
}

fn moved(design: &Design, by: Vector3) -> Design {
    let shift = |points: &mut [Point3]| points.iter_mut().for_each(|point| *point += by);
    let mut design = design.clone();
    let open = design.sheet_state == Some(State::Open);
    if !open {
        shift(&mut design.corners);
    }
    for piece in &mut design.pieces {
        shift(if open { &mut piece.open } else { &mut piece.closed });
    }
    for hinge in &mut design.hinges {
        hinge.point += by;
    }
    design
}
