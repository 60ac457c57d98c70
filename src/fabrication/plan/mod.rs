//! What the machine is told to do with a checked sheet: how many copies, in which order, and what that takes.

mod copies;

mod report;

#[cfg(test)]
mod tests;

use kurbo::{Rect, Vec2};

use super::cuts::bounding_box;
use super::error::FabricationError;
use super::fabricate::{Fabrication, hinge_points};
use super::layout::CutLayout;
use super::notes::notes;
use super::order::cutting_order;
use crate::profile::Profile;

pub use report::{CutReport, Times};

/// What a job may choose.
#[derive(Debug, Clone, PartialEq)]
pub struct CutOptions {
    /// How many parts are cut from the sheet; at least one.
    pub copies: usize,
    /// Between the burned edges of copies, millimetres.
    pub spacing: f64,
    /// How often the beam follows each cut; at least once. Never drawn.
    pub passes: usize,
}

impl Default for CutOptions {
    fn default() -> Self {
        Self { copies: 1, spacing: 5.0, passes: 1 }
    }
}

/// What the machine files hold, and what it takes to cut that.
#[derive(Debug, Clone, PartialEq)]
pub struct CutPlan {
    /// The cuts of all copies in order, with notes.
    pub layout: CutLayout,
    /// Figures of it.
    pub report: CutReport,
}

/// Plans the cutting of a sheet.
///
/// # Errors
/// More copies than fit on the sheet.
pub fn cut_plan(
    fabrication: &Fabrication,
    profile: &Profile,
    options: &CutOptions,
) -> Result<CutPlan, FabricationError> {
    let one = &fabrication.layout;
    let part = bounding_box(&one.paths).inset(0.5 * one.kerf);
    let offsets = copies::offsets(part, &profile.sheet, options.copies, options.spacing)?;
    let paths = match offsets.len() {
        1 => one.paths.clone(),
        _ => {
            let copy = |&by: &Vec2| one.paths.iter().map(move |path| copies::moved(path, by));
            let all: Vec<_> = offsets.iter().flat_map(copy).collect();
            let points = hinge_points(&fabrication.design);
            let ligaments: Vec<_> =
                offsets.iter().flat_map(|&by| points.iter().map(move |&point| point + by)).collect();
            cutting_order(&all, &ligaments)
        }
    };
    let all = offsets.iter().fold(part, |all: Rect, &by| all.union(part + by));
    let report = CutReport::new(&paths, offsets, profile, options);
    let layout = CutLayout { paths, notes: notes(profile, all, options.passes), ..one.clone() };
    Ok(CutPlan { layout, report })
}
