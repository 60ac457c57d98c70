//! Reads the machine files back and measures what the machine would leave of the sheet.
//!
//! The files are held against the design and the profile alone: nothing of the layout that made them is known here,
//! and none of its code (`fabrication::closed_sheet`, `fabrication::open_sheet`) is called. All cuts are burned on
//! paper, as grooves of the kerf's width with round ends; every figure is one of the grooves.
//!
//! ```text
//! cut.dxf ──read_dxf──┐                ┌─ paths: numbers, layers, closed, border last, stock, webs, ends
//! cut.svg ──read_svg──┴─> [CutPath] ───┤─ finish: leads, tabs, engraving
//!                                      ├─ burn: bodies, pieces held
//!                      agreement       ├─ ligaments: width, neck, centre
//!                                      └─ pieces: a cut along every side, no cut elsewhere
//! ```
//!
//! Another kind of machine file is one more reader beside `read_dxf` and `read_svg`, and one more call in [`verify`].

mod agreement;

mod burn;

mod contacts;

mod copies;

mod coupon;

mod expected;

mod fault;

mod finish;

mod grooves;

mod ligaments;

mod machine_file;

mod paths;

mod pieces;

mod read_dxf;

mod read_svg;

mod report;

#[cfg(test)]
mod round_trip;

use kurbo::{Point, Vec2};

use crate::fabrication::layout::{CutPath, Tabs};
use crate::kirigami::design::Design;
use crate::profile::Profile;

use contacts::{Contacts, Crowded};
use grooves::Grooves;
use machine_file::MachineFile;

pub use coupon::verify_coupon;
pub use fault::{Check, Fault};
pub use ligaments::{CENTRE_TOLERANCE, WIDTH_TOLERANCE};
pub use machine_file::{ReadError, hash_comment};
pub use report::{faults, table};

/// What the files are held against.
#[derive(Debug, Clone, Copy)]
pub struct Wanted<'a> {
    /// The design in sheet coordinates, as `design.json` holds it.
    pub design: &'a Design,
    /// The profile, with the kerf and the stock that were asked for.
    pub profile: &'a Profile,
    /// The hash of the design file's bytes, which the machine files name.
    pub hash: &'a str,
    /// Where every copy of the part lies, from the design's coordinates, millimetres; [`ONE_PART`] is the part alone.
    pub copies: &'a [Vec2],
    /// What holds each part when its border is cut.
    pub tabs: Option<&'a Tabs>,
}

/// The place of a part that is alone on its sheet.
pub const ONE_PART: [Vec2; 1] = [Vec2::ZERO];

/// The bytes of the machine files.
#[derive(Debug, Clone, Copy)]
pub struct Files<'a> {
    /// `cut.dxf`.
    pub dxf: &'a [u8],
    /// `cut.svg`.
    pub svg: &'a [u8],
}

/// What was measured, and what is wrong.
#[derive(Debug, Clone, PartialEq)]
pub struct Verified {
    /// The figures; `None` where the cuts cannot be measured at all.
    pub figures: Option<Figures>,
    /// Everything that is wrong; empty if the files may be cut.
    pub faults: Vec<Fault>,
}

/// Figures of the burned sheet. Millimetres.
#[derive(Debug, Clone, PartialEq)]
pub struct Figures {
    /// Number and length of the cuts per layer, in the layers' order.
    pub cuts: Vec<(&'static str, usize, f64)>,
    /// Number and length of the strokes that are engraved.
    pub engraved: (usize, f64),
    /// Least and largest width of the tabs; `None` where there are none.
    pub tab_widths: Option<[f64; 2]>,
    /// Largest distance between the two files.
    pub files_apart: f64,
    /// Least distance of a groove from the stock's edge, negative outside.
    pub stock_distance: f64,
    /// The shortest segment.
    pub shortest_segment: f64,
    /// Number of bodies, and of pieces that are in the largest.
    pub bodies: usize,
    /// Number of pieces in the body.
    pub pieces_held: usize,
    /// Least and largest width of the ligaments through the hinge points, least width anywhere along them.
    pub ligament_widths: [f64; 3],
    /// Least and largest free length of the ligaments.
    pub ligament_lengths: [f64; 2],
    /// Largest distance of a ligament's centre from its hinge point, and that which the design itself forces.
    pub ligament_centre: [f64; 2],
    /// Largest distance of a piece's cuts from its sides.
    pub piece_deviation: f64,
    /// Least material between two cuts that do not meet; infinite where none are near each other.
    pub web: f64,
    /// Least distance between ends of different cuts that do not coincide; infinite where there are none.
    pub end_gap: f64,
}

impl Figures {
    /// Of no cut.
    const NOTHING: Figures = Figures {
        cuts: Vec::new(),
        engraved: (0, 0.0),
        tab_widths: None,
        files_apart: 0.0,
        stock_distance: f64::INFINITY,
        shortest_segment: f64::INFINITY,
        bodies: 0,
        pieces_held: 0,
        ligament_widths: [f64::INFINITY, 0.0, f64::INFINITY],
        ligament_lengths: [f64::INFINITY, 0.0],
        ligament_centre: [0.0, 0.0],
        piece_deviation: 0.0,
        web: f64::INFINITY,
        end_gap: f64::INFINITY,
    };

    /// These and those of one more part.
    fn with(self, part: Figures) -> Figures {
        let [least, most, neck] = part.ligament_widths;
        let [shortest, longest] = part.ligament_lengths;
        let [off, forced] = part.ligament_centre;
        Figures {
            bodies: self.bodies + part.bodies,
            pieces_held: self.pieces_held + part.pieces_held,
            ligament_widths: [
                self.ligament_widths[0].min(least),
                self.ligament_widths[1].max(most),
                self.ligament_widths[2].min(neck),
            ],
            ligament_lengths: [self.ligament_lengths[0].min(shortest), self.ligament_lengths[1].max(longest)],
            ligament_centre: [self.ligament_centre[0].max(off), self.ligament_centre[1].max(forced)],
            piece_deviation: self.piece_deviation.max(part.piece_deviation),
            web: self.web.min(part.web),
            ..self
        }
    }

    /// The largest tolerance with which a program may join ends of cuts without welding different cuts together,
    /// millimetres: half of the least distance between them, as both ends may be moved.
    pub fn join_tolerance(&self) -> f64 {
        0.5 * self.end_gap
    }
}

/// Measures the machine files of a sheet.
///
/// The DXF is measured; so is the SVG, by itself, wherever it differs.
///
/// # Errors
/// A file that is no DXF or SVG.
pub fn verify(files: Files, wanted: Wanted) -> Result<Verified, ReadError> {
    let (dxf, svg) = rayon::join(|| read_dxf::read(files.dxf), || read_svg::read(files.svg, wanted.profile));
    let (dxf, svg) = (dxf?, svg?);
    let mut faults = Vec::new();
    for file in [&dxf, &svg] {
        faults.extend(file.faults.iter().cloned());
        faults.extend(file.hash_fault(wanted.hash));
    }
    let (agreement, (mut figures, found)) =
        rayon::join(|| agreement::compare(&dxf, &svg), || measure(&dxf, wanted));
    faults.extend(found);
    if let Some(fault) = agreement.fault {
        faults.push(fault);
        faults.extend(measure(&svg, wanted).1);
    }
    if let Some(figures) = &mut figures {
        figures.files_apart = agreement.apart;
    }
    Ok(Verified { figures, faults })
}

/// Measures the cuts of one file.
fn measure(file: &MachineFile, wanted: Wanted) -> (Option<Figures>, Vec<Fault>) {
    let mut faults = paths::check_numbers(file);
    if !faults.is_empty() || file.paths.is_empty() {
        return (None, faults);
    }
    if !paths::check_extent(file, wanted.profile, &mut faults) {
        return (None, faults);
    }
    let stock_distance = paths::check_stock(file, wanted.profile, &mut faults);
    let shortest_segment = paths::check_segments(file, &mut faults);
    let whole = finish::whole(file, wanted, &mut faults);
    let (file, raw) = (&whole.file, file);
    if !paths::check_borders(file, wanted.copies.len(), &mut faults) {
        return (None, faults);
    }
    finish::check_leads(&whole, wanted, &mut faults);
    finish::check_engraving(raw, wanted, &mut faults);
    let parts = || match wanted.copies {
        [Vec2::ZERO] => {
            let (figures, found) = measure_part(file, wanted);
            faults.extend(found);
            vec![figures]
        }
        copies => copies::each(file, copies, &mut faults, |part| measure_part(part, wanted)),
    };
    let (end_gap, parts) = rayon::join(|| crate::fabrication::cuts::end_gap(&raw.paths), parts);
    let of_sheet = Figures {
        cuts: paths::cuts(&raw.paths),
        engraved: finish::engraved_length(raw),
        tab_widths: whole.tab_widths,
        stock_distance,
        shortest_segment,
        end_gap,
        ..Figures::NOTHING
    };
    (Some(parts.into_iter().fold(of_sheet, Figures::with)), faults)
}

/// Measures the cuts of one part, of which the last is its border.
fn measure_part(file: &MachineFile, wanted: Wanted) -> (Figures, Vec<Fault>) {
    let mut faults = Vec::new();
    let (profile, kerf) = (wanted.profile, wanted.profile.cut.kerf);
    let border = file.paths.len() - 1;
    let grooves = Grooves::new(&file.paths);
    let contacts = match Contacts::new(&grooves, profile) {
        Ok(contacts) => contacts,
        Err(Crowded) => {
            let says = "cross or run along each other nearly everywhere, so nothing else was measured";
            faults.push(Fault::new(Check::Overlap, file.name, "the cuts", None, says));
            return (Figures::NOTHING, faults);
        }
    };
    let left = || {
        let mut faults = Vec::new();
        let web = paths::check_webs(file, &contacts, profile, &mut faults);
        let burned = burn::check(file, border, &grooves, &contacts, wanted, &mut faults);
        (web, burned, faults)
    };
    let placed = || {
        let mut faults = Vec::new();
        let ligaments = ligaments::check(file, &grooves, wanted, &mut faults);
        let piece_deviation = pieces::check(file, &grooves, wanted, &mut faults);
        paths::check_free_ends(file, &grooves, wanted, kerf, &mut faults);
        (ligaments, piece_deviation, faults)
    };
    // Each has stretches that keep one core busy only.
    let ((web, burned, of_body), (ligaments, piece_deviation, of_places)) = rayon::join(left, placed);
    faults.extend(of_body.into_iter().chain(of_places));
    let figures = Figures {
        bodies: burned.bodies,
        pieces_held: burned.pieces_held,
        ligament_widths: ligaments.widths,
        ligament_lengths: ligaments.lengths,
        ligament_centre: ligaments.centre,
        piece_deviation,
        web,
        ..Figures::NOTHING
    };
    (figures, faults)
}

/// How a cut is called: its number in cutting order, from 0, and its layer.
fn cut_name(paths: &[CutPath], index: usize) -> String {
    format!("cut {index} ({})", machine_file::layer_name(paths[index].kind))
}

/// The hinge points on the sheet.
fn hinge_points(design: &Design) -> impl Iterator<Item = Point> {
    design.hinges.iter().map(|hinge| Point::new(hinge.point.x, hinge.point.y))
}
