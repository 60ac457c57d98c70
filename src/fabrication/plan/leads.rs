//! Ways into closed cuts: the beam pierces in scrap, inside of a window's hole or outside of the border, and comes to the
//! cut from there.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_8};

use kurbo::{Point, Rect, Vec2};
use rstar::RTree;

use super::error::PlanError;
use super::{LeadShape, Leads};
use crate::fabrication::cuts::{ARC_TOLERANCE, bounding_box};
use crate::fabrication::layout::{CutKind, CutPath, PathVertex};
use crate::fabrication::order::closed_starts;
use crate::fabrication::outline::{area, contains};
use crate::fabrication::web::segment_gap;
use crate::profile::Profile;

/// Shares of the asked length that are tried.
const SHARES: [f64; 4] = [1.0, 0.7, 0.5, 0.35];
/// Shortest lead, in kerfs: a shorter one does not leave the groove of its own cut.
const SHORTEST: f64 = 3.0;
/// Last part of a lead that is not held against its own cut, which it meets there.
const MEETING: f64 = 0.25;
/// How far the rest stays from its own cut, in lengths of the lead. An arc is 0.048 away where the last quarter begins.
const OFF: f64 = 0.04;

/// The cuts of a sheet with a lead before each closed one and each stretch of a border, and how many have none because
/// there is no room: stretches begin at a tab and nowhere else.
///
/// # Errors
/// A border without room for a lead.
pub fn with_leads(
    paths: Vec<CutPath>,
    leads: Leads,
    ligaments: &RTree<[f64; 2]>,
    profile: &Profile,
) -> Result<(Vec<CutPath>, usize), PlanError> {
    let borders: Vec<CutPath> = paths.iter().filter(|path| path.kind == CutKind::Border).cloned().collect();
    let boxes: Vec<Rect> = borders.iter().map(|border| bounding_box(std::slice::from_ref(border))).collect();
    let room = Room { leads, profile, borders: &borders, boxes: &boxes };
    let mut all = Vec::with_capacity(paths.len());
    let (mut without, mut border) = (0, 0);
    for path in paths {
        let index = (path.kind == CutKind::Border).then_some(border);
        border += usize::from(index.is_some());
        if index.is_none() && !path.closed {
            all.push(path);
            continue;
        }
        match room.lead(&path, index, ligaments) {
            Some((lead, path)) => all.extend([lead, path]),
            None if index.is_some() && path.closed => {
                let Point { x, y } = path.vertices[0].point;
                return Err(PlanError::NoRoomForLead { x, y, length: leads.length });
            }
            None => {
                without += 1;
                all.push(path);
            }
        }
    }
    Ok((all, without))
}

/// What a lead must find room in.
struct Room<'a> {
    leads: Leads,
    profile: &'a Profile,
    /// The borders of all copies, or their stretches.
    borders: &'a [CutPath],
    boxes: &'a [Rect],
}

impl Room<'_> {
    /// A lead, and its cut begun where it ends: as near as possible to where the cut begins now. `index`: among the
    /// borders.
    fn lead(
        &self,
        path: &CutPath,
        index: Option<usize>,
        ligaments: &RTree<[f64; 2]>,
    ) -> Option<(CutPath, CutPath)> {
        let at = path.vertices[0].point;
        let mut starts = if path.closed { closed_starts(path, ligaments) } else { vec![path.clone()] };
        starts.sort_by(|a, b| a.vertices[0].point.distance(at).total_cmp(&b.vertices[0].point.distance(at)));
        let contour: Vec<[f64; 2]> = path.flatten(ARC_TOLERANCE).iter().map(|p| [p.x, p.y]).collect();
        let least = SHORTEST * self.profile.cut.kerf;
        let lengths = SHARES.map(|share| share * self.leads.length);
        for length in lengths.into_iter().filter(|&length| length >= least) {
            for start in starts.iter().filter(|start| start.vertices[0].bulge == 0.0) {
                let lead = self.drawn(start, &contour, length);
                if self.fits(&lead, start, &contour, length, index) {
                    return Some((lead, start.clone()));
                }
            }
        }
        None
    }

    /// The lead to where a cut begins with a straight segment.
    fn drawn(&self, path: &CutPath, contour: &[[f64; 2]], length: f64) -> CutPath {
        let [to, next] = [0, 1].map(|i| path.vertices[i].point);
        let along = (next - to).normalize();
        // Stretches of a border keep its sense: counter-clockwise, scrap on the right. Windows have it inside.
        let left = path.closed && (area(contour) > 0.0) == (path.kind == CutKind::Window);
        let side = if left { 1.0 } else { -1.0 };
        let scrap: Vec2 = side * along.turn_90();
        let (from, bulge) = match self.leads.shape {
            LeadShape::Line => (to + length * std::f64::consts::FRAC_1_SQRT_2 * (scrap - along), 0.0),
            LeadShape::Arc => {
                let radius = length / FRAC_PI_2;
                (to + radius * (scrap - along), side * FRAC_PI_8.tan())
            }
        };
        let vertices = vec![PathVertex { point: from, bulge }, PathVertex { point: to, bulge: 0.0 }];
        CutPath { kind: CutKind::Lead, vertices, closed: false }
    }

    /// Whether a lead stays in scrap, off its own cut but for its end, off other parts and on the stock.
    fn fits(
        &self,
        lead: &CutPath,
        path: &CutPath,
        contour: &[[f64; 2]],
        length: f64,
        index: Option<usize>,
    ) -> bool {
        let points = lead.flatten(1e-2 * length);
        let begin = points[0];
        let inside = path.closed && contains(contour, [begin.x, begin.y]);
        if path.closed && inside != (path.kind == CutKind::Window) {
            return false;
        }
        let off = OFF * length;
        let apart = |segments: &[[Point; 2]], least: f64| {
            trimmed(&points, MEETING * length).windows(2).all(|pair| {
                segments.iter().all(|&segment| segment_gap([pair[0], pair[1]], segment).0 >= least)
            })
        };
        if !apart(&path.segments(ARC_TOLERANCE), off) {
            return false;
        }
        let Some(index) = index else { return true };
        let (sheet, cut) = (&self.profile.sheet, &self.profile.cut);
        let place = points.iter().fold(Rect::from_points(begin, begin), |place, &p| place.union_pt(p));
        let groove = place.inset(0.5 * cut.kerf - 1e-9);
        let on_stock = groove.x0 >= sheet.margin
            && groove.y0 >= sheet.margin
            && groove.x1 <= sheet.width - sheet.margin
            && groove.y1 <= sheet.height - sheet.margin;
        let web = cut.kerf + cut.min_web;
        // Stretches of the same border meet the lead's own at the tab, half a tab's gap away: only what it runs into counts.
        on_stock
            && self.borders.iter().enumerate().filter(|&(other, _)| other != index).all(|(other, border)| {
                !self.boxes[other].inset(web).overlaps(place)
                    || apart(&border.segments(ARC_TOLERANCE), if path.closed { web } else { off })
            })
    }
}

/// Points of a way without its last part of this length.
fn trimmed(points: &[Point], last: f64) -> Vec<Point> {
    let mut points = points.to_vec();
    let mut left = last;
    while let [.., before, end] = points[..] {
        let length = before.distance(end);
        if length > left {
            let count = points.len();
            points[count - 1] = end.lerp(before, left / length);
            break;
        }
        left -= length;
        points.pop();
    }
    points
}
