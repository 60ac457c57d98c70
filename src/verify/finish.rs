//! What belongs to the cuts without shaping the part: leads, tabs, engraving.
//!
//! Leads are taken out and borders with tabs are closed, so that all other checks see the part as it is when its tabs are
//! broken. What was taken out is held against the pieces of the design.

use kurbo::{Point, Rect, Vec2};
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use super::cut_name;
use super::fault::{Check, Fault};
use super::grooves::{FLAT, Grooves, around};
use super::machine_file::MachineFile;
use super::{Wanted, hinge_points};
use crate::fabrication::layout::{CutKind, CutPath, Tabs};
use crate::fabrication::outline::{contains, contour_box};
use crate::fabrication::states::sheet_vertices;
use crate::fabrication::web::segment_gap;

/// A lead ends this near to where its cut begins, millimetres: twice the last digit of the SVG.
const MEETS: f64 = 2e-6;
/// How far a tab's width and place may be off, millimetres.
const OFF: f64 = 0.01;
/// What rounding may take of the material between a lead and another cut, millimetres.
const ROUNDING: f64 = 1e-3;
/// Least distance between a stroke's middle line and a groove's edge, millimetres.
const ENGRAVED_CLEAR: f64 = 0.25;

/// The cuts of a file without leads, every border closed.
pub(super) struct Whole {
    /// The cuts; those of a border with tabs are one.
    pub file: MachineFile,
    /// Least and largest width of the tabs.
    pub tab_widths: Option<[f64; 2]>,
    leads: Vec<Lead>,
}

/// A lead: its number in the file, its path, and the cut of [`Whole`] that it leads into.
struct Lead {
    number: usize,
    path: CutPath,
    into: usize,
}

/// Takes out the leads and closes borders with tabs.
pub(super) fn whole(raw: &MachineFile, wanted: Wanted, faults: &mut Vec<Fault>) -> Whole {
    let mut file = MachineFile::new(raw.name);
    let mut leads = Vec::new();
    let mut border: Vec<CutPath> = Vec::new();
    let mut found = FoundTabs { wanted, used: Vec::new(), widths: [f64::INFINITY, 0.0] };
    for (number, path) in raw.paths.iter().enumerate() {
        if path.kind == CutKind::Lead {
            match lead_fault(raw, number) {
                Some(says) => {
                    let at = path.vertices[0].point;
                    faults.push(Fault::new(Check::Lead, raw.name, cut_name(&raw.paths, number), at, says));
                }
                None => leads.push(Lead { number, path: path.clone(), into: file.paths.len() }),
            }
            continue;
        }
        let tabs = wanted.tabs.filter(|_| path.kind == CutKind::Border && !path.closed);
        let Some(tabs) = tabs else {
            file.paths.push(path.clone());
            continue;
        };
        border.push(path.clone());
        if border.len() == tabs.places.len() {
            found.take(raw.name, tabs, &border, faults);
            file.paths.push(closed(&border));
            border.clear();
        }
    }
    // Stretches that are no whole border stay as they are, and are told of as open.
    file.paths.extend(border);
    let tab_widths = wanted.tabs.map(|tabs| found.finish(raw.name, tabs, faults));
    Whole { file, tab_widths, leads }
}

/// Why a lead leads nowhere.
fn lead_fault(file: &MachineFile, number: usize) -> Option<String> {
    let path = &file.paths[number];
    let Some(next) = file.paths.get(number + 1) else { return Some("is the last cut".to_owned()) };
    if path.closed || !matches!(next.kind, CutKind::Window | CutKind::Border) {
        return Some(format!(
            "must be open, and before a window or a border; {} comes next",
            cut_name(&file.paths, number + 1)
        ));
    }
    let off = path.vertices[path.vertices.len() - 1].point.distance(next.vertices[0].point);
    // NaN is a fault.
    if off <= MEETS { None } else { Some(format!("ends {off:.4} mm from where the next cut begins")) }
}

fn closed(stretches: &[CutPath]) -> CutPath {
    let vertices = stretches.iter().flat_map(|stretch| stretch.vertices.iter().copied()).collect();
    CutPath { kind: CutKind::Border, vertices, closed: true }
}

/// The tabs of all copies as they were found.
struct FoundTabs<'a> {
    wanted: Wanted<'a>,
    /// Copy and tab.
    used: Vec<(usize, usize)>,
    widths: [f64; 2],
}

impl FoundTabs<'_> {
    /// Takes the gaps between the stretches of one border.
    fn take(&mut self, file: &'static str, tabs: &Tabs, stretches: &[CutPath], faults: &mut Vec<Fault>) {
        let kerf = self.wanted.profile.cut.kerf;
        for (i, stretch) in stretches.iter().enumerate() {
            let next = &stretches[(i + 1) % stretches.len()];
            let [from, to] = [stretch.vertices[stretch.vertices.len() - 1].point, next.vertices[0].point];
            let (width, at) = (from.distance(to) - kerf, from.midpoint(to));
            self.widths = [self.widths[0].min(width), self.widths[1].max(width)];
            if (width - tabs.width).abs() > OFF {
                let says = format!("is {width:.3} mm wide, hinges.json tells of {} mm", tabs.width);
                faults.push(Fault::new(Check::Tab, file, "a tab", at, says));
            }
            let places = self.wanted.copies.iter().enumerate().flat_map(|(copy, &by)| {
                tabs.places.iter().enumerate().map(move |(tab, &place)| ((copy, tab), place + by))
            });
            let nearest =
                places.map(|(tab, place)| (tab, place.distance(at))).min_by(|a, b| a.1.total_cmp(&b.1));
            match nearest {
                Some((tab, off)) if off <= OFF && !self.used.contains(&tab) => self.used.push(tab),
                _ => {
                    let off = nearest.map_or(f64::INFINITY, |(_, off)| off);
                    let says = format!(
                        "stands {off:.3} mm from where hinges.json tells of a tab, or is there twice"
                    );
                    faults.push(Fault::new(Check::Tab, file, "a tab", at, says));
                }
            }
        }
    }

    /// Every tab must be there, and away from hinges. Least and largest width.
    fn finish(self, file: &'static str, tabs: &Tabs, faults: &mut Vec<Fault>) -> [f64; 2] {
        let Wanted { design, profile, copies, .. } = self.wanted;
        let expected = copies.len() * tabs.places.len();
        if self.used.len() != expected {
            let says =
                format!("{} tabs where they should be, hinges.json tells of {expected}", self.used.len());
            faults.push(Fault::new(Check::Tab, file, "the border", None, says));
        }
        let hinges = RTree::bulk_load(hinge_points(design).map(|point| [point.x, point.y]).collect());
        let half = 0.5 * (tabs.width + profile.cut.kerf);
        let limit = half + profile.ligament.width + 0.5 * profile.ligament_lengths()[1] - ROUNDING;
        for &at in &tabs.places {
            let hinge = hinges.nearest_neighbor(&[at.x, at.y]);
            let distance = hinge.map_or(f64::INFINITY, |&[x, y]| at.distance(Point::new(x, y)));
            if distance < limit {
                let says = format!("is {distance:.3} mm from a hinge, the limit is {limit:.3} mm");
                faults.push(Fault::new(Check::Tab, file, "a tab", at, says));
            }
        }
        self.widths
    }
}

/// Every lead lies in scrap: outside of all borders or in its own window's hole, over no piece, and clear of all cuts but its
/// own.
pub(super) fn check_leads(whole: &Whole, wanted: Wanted, faults: &mut Vec<Fault>) {
    if whole.leads.is_empty() {
        return;
    }
    let paths = &whole.file.paths;
    let (pieces, grooves) = (Pieces::new(wanted), Grooves::new(paths));
    let (kerf, min_web) = (wanted.profile.cut.kerf, wanted.profile.cut.min_web);
    let contour =
        |path: &CutPath| -> Vec<[f64; 2]> { path.flatten(FLAT).iter().map(|p| [p.x, p.y]).collect() };
    let borders: Vec<_> = paths.iter().filter(|path| path.kind == CutKind::Border).map(contour).collect();
    for Lead { number, path, into } in &whole.leads {
        let segments = path.segments(FLAT);
        let mut wrong = |at: Point, says: String| {
            let what = format!("cut {number} (LEAD)");
            faults.push(Fault::new(Check::Lead, whole.file.name, what, at, says));
        };
        // All but the end, which is on the cut.
        let begins = segments.iter().flat_map(|&[a, b]| (0..8).map(move |i| a.lerp(b, f64::from(i) / 8.0)));
        let window = (paths[*into].kind == CutKind::Window).then(|| contour(&paths[*into]));
        let scrap = |at: Point| match &window {
            Some(hole) => contains(hole, [at.x, at.y]),
            None => !borders.iter().any(|border| contains(border, [at.x, at.y])),
        };
        if let Some(at) = begins.clone().find(|&at| !scrap(at)) {
            let place = if window.is_some() { "inside of its window" } else { "outside of the border" };
            wrong(at, format!("is not in scrap: it must lie {place}"));
            continue;
        }
        let mut begins = begins;
        if let Some(at) = begins.find(|&at| pieces.hold(at)) {
            wrong(at, "lies over a piece".to_owned());
        }
        let limit = kerf + min_web;
        for &segment in &segments {
            let near = grooves.near(Rect::from_points(segment[0], segment[1]).inflate(limit, limit));
            let others = near.map(|s| grooves.segments[s]).filter(|other| other.path != *into);
            let gaps = others.map(|other| (segment_gap(segment, other.ends), other.path));
            if let Some(((gap, at), other)) = gaps.min_by(|a, b| a.0.0.total_cmp(&b.0.0))
                && gap < limit - ROUNDING
            {
                let other = cut_name(paths, other);
                wrong(at, format!("leaves {:.3} mm to {other}, the limit is {min_web} mm", gap - kerf));
            }
        }
    }
}

/// Number and length of the strokes.
pub(super) fn engraved_length(file: &MachineFile) -> (usize, f64) {
    let lengths = file.engraved.iter().flat_map(|stroke| stroke.windows(2)).map(|p| p[0].distance(p[1]));
    (file.engraved.len(), lengths.sum())
}

/// Every stroke lies on a piece and clear of all grooves.
pub(super) fn check_engraving(file: &MachineFile, wanted: Wanted, faults: &mut Vec<Fault>) {
    if file.engraved.is_empty() {
        return;
    }
    let (pieces, grooves) = (Pieces::new(wanted), Grooves::new(&file.paths));
    let limit = 0.5 * wanted.profile.cut.kerf + ENGRAVED_CLEAR;
    for (number, stroke) in file.engraved.iter().enumerate() {
        let mut wrong = |at: Point, says: String| {
            faults.push(Fault::new(
                Check::Engraving,
                file.name,
                format!("stroke {number} (ENGRAVE)"),
                at,
                says,
            ));
        };
        if let Some(&at) = stroke.iter().find(|&&at| !pieces.hold(at)) {
            wrong(at, "is on no piece".to_owned());
            continue;
        }
        for pair in stroke.windows(2) {
            let segment = [pair[0], pair[1]];
            let place = Rect::from_points(segment[0], segment[1]).inflate(limit, limit);
            let gaps = grooves.near(place).map(|s| segment_gap(segment, grooves.segments[s].ends));
            if let Some((gap, at)) = gaps.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|(gap, _)| *gap < limit) {
                wrong(at, format!("is {gap:.3} mm from a cut, the limit is {limit:.3} mm"));
                break;
            }
        }
    }
}

/// The pieces of all copies on the sheet, by place.
struct Pieces {
    polygons: Vec<Vec<[f64; 2]>>,
    /// A piece's box, its index, and where its copy lies.
    tree: RTree<PlacedPiece>,
}

type PlacedPiece = GeomWithData<Rectangle<[f64; 2]>, (usize, [f64; 2])>;

impl Pieces {
    fn new(wanted: Wanted) -> Self {
        let flat = |piece| sheet_vertices(wanted.design, piece).iter().map(|v| [v.x, v.y]).collect();
        let polygons: Vec<Vec<[f64; 2]>> = wanted.design.pieces.iter().map(flat).collect();
        let boxes = wanted.copies.iter().flat_map(|&by| {
            polygons.iter().enumerate().map(move |(i, polygon)| {
                let Rect { x0, y0, x1, y1 } = contour_box(polygon) + by;
                GeomWithData::new(Rectangle::from_corners([x0, y0], [x1, y1]), (i, [by.x, by.y]))
            })
        });
        let tree = RTree::bulk_load(boxes.collect());
        Self { polygons, tree }
    }

    fn near(&self, place: Rect) -> impl Iterator<Item = (&Vec<[f64; 2]>, Vec2)> {
        let place = AABB::from_corners([place.x0, place.y0], [place.x1, place.y1]);
        let found = self.tree.locate_in_envelope_intersecting(&place);
        found.map(|item| (&self.polygons[item.data.0], Vec2::new(item.data.1[0], item.data.1[1])))
    }

    /// Whether a point lies in a piece.
    fn hold(&self, at: Point) -> bool {
        self.near(around(at, 0.0)).any(|(polygon, by)| contains(polygon, [at.x - by.x, at.y - by.y]))
    }
}
