//! What the machine is told to do with a checked sheet: how many copies, in which order, and what that takes.

mod copies;

mod pierce;

mod report;

#[cfg(test)]
mod tests;

use kurbo::{Rect, Vec2};

use super::cuts::bounding_box;
use super::error::FabricationError;
use super::fabricate::{Fabrication, hinge_points};
use super::layout::CutLayout;
use super::notes::notes;
use super::order::{Pace, cooled, cutting_order, rest};
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
    /// Where slits are pierced.
    pub pierce: Pierce,
    /// What the order is to save.
    pub order: CutOrder,
}

/// Where a slit is pierced; closed cuts are pierced on their line, well away from ligaments.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pierce {
    /// At an end: at the border, or in the groove of the relief bar there, which is cut before.
    SlitEnd,
    /// Well away from ligaments; the slit is two cuts.
    MidSlit,
}

/// What the order of the cuts is to save.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CutOrder {
    /// The way between cuts.
    Travel,
    /// The hinges from heat: each is to rest between two cuts, seconds.
    Heat(f64),
}

impl Default for CutOptions {
    fn default() -> Self {
        Self { copies: 1, spacing: 5.0, passes: 1, pierce: Pierce::SlitEnd, order: CutOrder::Travel }
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
    let points = hinge_points(&fabrication.design);
    let ligaments: Vec<_> =
        offsets.iter().flat_map(|&by| points.iter().map(move |&point| point + by)).collect();
    let mut paths = match offsets.len() {
        1 => one.paths.clone(),
        _ => {
            let copy = |&by: &Vec2| one.paths.iter().map(move |path| copies::moved(path, by));
            let all: Vec<_> = offsets.iter().flat_map(copy).collect();
            cutting_order(&all, &ligaments)
        }
    };
    if options.pierce == Pierce::MidSlit {
        paths = pierce::in_mid_slit(paths, &ligaments);
    }
    let pace = pace(profile);
    if let CutOrder::Heat(cool) = options.order {
        paths = cooled(&paths, &ligaments, &pace, cool);
    }
    let asked = if let CutOrder::Heat(cool) = options.order { cool } else { 0.0 };
    let rest = rest(&paths, &ligaments, &pace, asked);
    let all = offsets.iter().fold(part, |all: Rect, &by| all.union(part + by));
    let report = CutReport::new(&paths, offsets, rest, profile, options);
    let layout = CutLayout { paths, notes: notes(profile, all, options.passes), ..one.clone() };
    Ok(CutPlan { layout, report })
}

/// The machine's speeds; without them in the profile no time passes between cuts.
fn pace(profile: &Profile) -> Pace {
    let machine = profile.machine.as_ref();
    Pace {
        cutting: profile.cut.speed,
        rapid: machine.map_or(f64::INFINITY, |machine| machine.rapid_speed),
        pierce: machine.map_or(0.0, |machine| machine.pierce_time),
        // The grooves on both sides of a ligament, and a tenth of its width for those that stand askew.
        reach: 0.5 * profile.hinge_gap() + 0.1 * profile.ligament.width,
    }
}
