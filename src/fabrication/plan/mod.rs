//! What the machine is told to do with a checked sheet: how many copies, in which order, and what that takes.

mod copies;

mod error;

mod engrave;

mod leads;

mod lettering;

mod pierce;

mod report;

mod tabs;

#[cfg(test)]
mod finish_tests;

#[cfg(test)]
mod tests;

use kurbo::{Point, Rect, Vec2};
use rstar::RTree;

use super::cuts::bounding_box;
use super::fabricate::{Fabrication, hinge_points};
use super::layout::{CutKind, CutLayout, CutPath, Engraving, Note, Tabs};
use super::notes::notes;
use super::order::{Cooling, Pace, cooled, cutting_order, rest};
use crate::profile::Profile;

use report::Finish;

pub use error::PlanError;
pub use report::{CutReport, EngraveReport, LeadReport, Price, Times};

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
    /// How the beam comes to closed cuts; `None`: it pierces on their line, well away from ligaments.
    pub leads: Option<Leads>,
    /// What is to hold the part when its border is cut; `None`: nothing.
    pub tabs: Option<TabWish>,
    /// The part's name, if it and the pieces' numbers are to be engraved.
    pub engrave: Option<String>,
}

/// Where cuts are pierced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pierce {
    /// Slits at an end: at the border, or in the groove of the relief bar there, which is cut before.
    SlitEnd,
    /// Slits well away from ligaments; each is two cuts.
    MidSlit,
    /// Slits at an end, closed cuts in scrap: with leads.
    Scrap,
}

/// Ways into closed cuts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leads {
    /// Their shape.
    pub shape: LeadShape,
    /// Their length, millimetres; where there is less room they are shorter.
    pub length: f64,
}

/// The shape of a lead.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LeadShape {
    /// A straight line, at 45 degrees to the cut.
    Line,
    /// A quarter of a circle that the cut touches.
    Arc,
}

/// Tabs on the border.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TabWish {
    /// How many on each part; at least one.
    pub count: usize,
    /// Width of the material that is left at each, millimetres.
    pub width: f64,
}

/// What the order of the cuts is to save.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CutOrder {
    /// The way between cuts.
    Travel,
    /// The hinges from heat: no cut beside a hinge begins before it has rested.
    Heat {
        /// For so long, seconds.
        cool: f64,
        /// Since the last cut that came so near to it, millimetres; `None`: since the last one beside it.
        within: Option<f64>,
    },
}

impl Default for CutOptions {
    fn default() -> Self {
        Self {
            copies: 1,
            spacing: 5.0,
            passes: 1,
            pierce: Pierce::SlitEnd,
            order: CutOrder::Travel,
            leads: None,
            tabs: None,
            engrave: None,
        }
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
/// More copies than fit on the sheet; more tabs than the border has places for; a border without room for a lead.
pub fn cut_plan(
    fabrication: &Fabrication,
    profile: &Profile,
    options: &CutOptions,
) -> Result<CutPlan, PlanError> {
    let one = &fabrication.layout;
    let part = bounding_box(&one.paths).inset(0.5 * one.kerf);
    let offsets = copies::offsets(part, &profile.sheet, options.copies, options.spacing)?;
    let points = hinge_points(&fabrication.design);
    let ligaments: Vec<_> =
        offsets.iter().flat_map(|&by| points.iter().map(move |&point| point + by)).collect();
    let plain = match offsets.len() {
        1 => one.paths.clone(),
        _ => {
            let copy = |&by: &Vec2| one.paths.iter().map(move |path| copies::moved(path, by));
            let all: Vec<_> = offsets.iter().flat_map(copy).collect();
            cutting_order(&all, &ligaments)
        }
    };
    let pace = pace(profile);
    let tree = RTree::bulk_load(ligaments.iter().map(|p| [p.x, p.y]).collect());
    let mut paths = plain.clone();
    if options.pierce == Pierce::MidSlit {
        paths = pierce::in_mid_slit(paths, &tree);
    }
    let asked = match options.order {
        CutOrder::Travel => 0.0,
        CutOrder::Heat { cool, within } => {
            paths = cooled(&paths, &ligaments, &pace, Cooling { cool, within });
            cool
        }
    };
    let rest = rest(&paths, &ligaments, &pace, asked);
    let tabs = match &options.tabs {
        Some(wish) => Some(tabs::places(&one.paths, &points, wish, profile)?),
        None => None,
    };
    if let Some(tabs) = &tabs {
        paths = with_tabs(paths, tabs, &offsets, part.center(), one.kerf);
    }
    let mut without_lead = 0;
    if let Some(leads) = options.leads {
        (paths, without_lead) = leads::with_leads(paths, leads, &tree, profile)?;
    }
    let engraved = options.engrave.as_ref().map(|name| engrave::engraved(&fabrication.outlines, name));
    let engravings = engraved.as_ref().map_or(Vec::new(), |engraved| copied(&engraved.engravings, &offsets));
    let finish = Finish { tabs, without_lead, engraved: engraved.as_ref() };
    let report = CutReport::new(&paths, &plain, finish, rest, offsets.clone(), profile, options);
    let all = offsets.iter().fold(part, |all: Rect, &by| all.union(part + by));
    let notes = notes(profile, all, &remarks(options, &engravings));
    Ok(CutPlan { layout: CutLayout { engravings, paths, notes, ..one.clone() }, report })
}

/// The cuts with every border in stretches. `middle`: of the first copy.
fn with_tabs(paths: Vec<CutPath>, tabs: &Tabs, offsets: &[Vec2], middle: Point, kerf: f64) -> Vec<CutPath> {
    let stretched = |path: CutPath| {
        if path.kind != CutKind::Border {
            return vec![path];
        }
        let at = bounding_box(std::slice::from_ref(&path)).center();
        let off = |by: &&Vec2| (middle + **by).distance(at);
        let by = offsets.iter().min_by(|a, b| off(a).total_cmp(&off(b))).copied().unwrap_or_default();
        tabs::stretches(&path, tabs, by, kerf)
    };
    paths.into_iter().flat_map(stretched).collect()
}

/// The engravings of all copies.
fn copied(one: &[Engraving], offsets: &[Vec2]) -> Vec<Engraving> {
    let moved = |engraving: &Engraving, by: Vec2| {
        let Engraving { label, strokes } = engraving;
        let stroke = |stroke: &Vec<Point>| stroke.iter().map(|&point| point + by).collect();
        Engraving {
            label: Note { position: label.position + by, ..label.clone() },
            strokes: strokes.iter().map(stroke).collect(),
        }
    };
    offsets.iter().flat_map(|&by| one.iter().map(move |engraving| moved(engraving, by))).collect()
}

/// What the notes beside the part say of the choices.
fn remarks(options: &CutOptions, engravings: &[Engraving]) -> Vec<String> {
    let mut lines = Vec::new();
    if options.passes > 1 {
        lines.push(format!("every cut {} times", options.passes));
    }
    if let Some(TabWish { count, width }) = options.tabs {
        lines.push(format!("{count} tabs of {width} mm hold each part"));
    }
    if !engravings.is_empty() {
        lines.push("layer ENGRAVE: engrave, do not cut through".to_owned());
    }
    lines
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
