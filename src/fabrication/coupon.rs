//! The test coupon: a small sheet whose cuts tell how wide a machine's groove and its ligaments really are.
//!
//! In the lower row flaps hang on two ligaments each, of graded widths (L1 to L5); above are slots of graded widths (S1
//! to S4, the first a single slit) and square holes of known sides (W1 to W3). All is drawn as in every sheet: centre lines
//! of the groove, with the profile's kerf applied, so that with the true kerf everything has its nominal size.

use kurbo::{Point, Rect, Vec2};

use super::layout::{CutKind, CutLayout, CutPath, Note, PathVertex};
use super::order::cutting_order;
use crate::profile::Profile;

/// Widths of the ligaments, in the profile's ligament widths.
pub const LIGAMENTS: [f64; 5] = [0.5, 0.75, 1.0, 1.5, 2.0];
/// Sides of the square holes, millimetres.
pub const HOLES: [f64; 3] = [5.0, 10.0, 20.0];
/// Widths of the slots, in kerfs.
pub const SLOTS: [f64; 4] = [1.0, 3.0, 5.0, 9.0];

/// Space between the parts of the coupon and around them, millimetres.
const SPACE: f64 = 4.0;
/// Letter height, millimetres.
const LETTER: f64 = 2.0;
/// Length of the slots, millimetres.
const SLOT: f64 = 12.0;
/// Least side of a hinge's flap, millimetres.
const FLAP: f64 = 8.0;

/// What is measured at a feature.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// Width of the material between two grooves above each other.
    Ligament,
    /// Width of an opening in x.
    Slot,
    /// Width of an opening in x and in y.
    Hole,
}

/// One feature of the coupon.
#[derive(Debug, Clone, PartialEq)]
pub struct Feature {
    /// As on the coupon: L, S or W and a number. Both ligaments of a flap have the same name.
    pub name: String,
    /// What is measured.
    pub measure: Measure,
    /// Its size with the profile's kerf, millimetres.
    pub nominal: f64,
    /// Its middle.
    pub at: Point,
}

/// The coupon: its cuts, and what is to be measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Coupon {
    /// Cuts in order and labels.
    pub layout: CutLayout,
    /// Ligaments, slots, holes.
    pub features: Vec<Feature>,
    /// Outer size in x and y, millimetres.
    pub size: [f64; 2],
}

/// The test coupon is larger than the sheet.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "the coupon measures {width:.1} x {height:.1} mm, but the sheet leaves {room_x:.1} x {room_y:.1} mm between its \
     margins: set the profile's sheet to a larger piece of the same stock"
)]
pub struct CouponTooLarge {
    /// Size in x.
    pub width: f64,
    /// Size in y.
    pub height: f64,
    /// Room in x.
    pub room_x: f64,
    /// Room in y.
    pub room_y: f64,
}

/// Draws the coupon for a profile, at the margins of its sheet.
///
/// # Errors
/// A sheet that is smaller than the coupon.
pub fn coupon(profile: &Profile) -> Result<Coupon, CouponTooLarge> {
    let (kerf, sheet) = (profile.cut.kerf, &profile.sheet);
    let origin = Point::new(sheet.margin + kerf, sheet.margin + kerf);
    let flap = FLAP.max(8.0 * profile.ligament.width);
    let mut pen = Pen { kerf, paths: Vec::new(), notes: Vec::new(), features: Vec::new() };
    let lower = pen.hinges(origin + Vec2::new(SPACE, SPACE), flap, profile.ligament.width);
    let row = origin.y + flap + 3.0 * SPACE + LETTER;
    let right = pen.slots(Point::new(origin.x + SPACE, row));
    let upper = pen.holes(Point::new(right, row));
    let size = [lower.max(upper) - origin.x, row - origin.y + HOLES[2] + 3.0 * SPACE + LETTER];
    let [room_x, room_y] = [sheet.width, sheet.height].map(|side| side - 2.0 * (sheet.margin + kerf));
    if size[0] > room_x || size[1] > room_y {
        let (width, height) = (size[0], size[1]);
        return Err(CouponTooLarge { width, height, room_x, room_y });
    }
    let outside = Rect::from_origin_size(origin, (size[0], size[1]));
    let [width, height] = size;
    let label = format!("kerf {kerf} mm, outside {width:.2} x {height:.2} mm");
    pen.note(Point::new(origin.x + SPACE, outside.y1 - 1.5 * SPACE), label);
    // Half a kerf outside, so that the part keeps its size.
    pen.closed(CutKind::Border, outside.inset(0.5 * kerf));
    let ligaments: Vec<Point> = pen.features.iter().map(|feature| feature.at).collect();
    let paths = cutting_order(&pen.paths, &ligaments);
    let sheet = [sheet.width, sheet.height];
    let layout = CutLayout { sheet, kerf, engravings: Vec::new(), paths, notes: pen.notes };
    Ok(Coupon { layout, features: pen.features, size })
}

/// What draws.
struct Pen {
    kerf: f64,
    paths: Vec<CutPath>,
    notes: Vec<Note>,
    features: Vec<Feature>,
}

impl Pen {
    fn open(&mut self, points: &[Point]) {
        self.push(CutKind::Slit, points, false);
    }

    /// A closed rectangle: a border counter-clockwise, a window clockwise, as all are.
    fn closed(&mut self, kind: CutKind, place: Rect) {
        let corners =
            [(place.x0, place.y0), (place.x1, place.y0), (place.x1, place.y1), (place.x0, place.y1)];
        let mut corners = corners.map(|(x, y)| Point::new(x, y));
        if kind == CutKind::Window {
            corners.reverse();
        }
        self.push(kind, &corners, true);
    }

    fn push(&mut self, kind: CutKind, points: &[Point], closed: bool) {
        let vertices = points.iter().map(|&point| PathVertex { point, bulge: 0.0 }).collect();
        self.paths.push(CutPath { kind, vertices, closed });
    }

    fn note(&mut self, position: Point, text: String) {
        self.notes.push(Note { position, height: LETTER, text });
    }

    fn feature(&mut self, name: &str, measure: Measure, nominal: f64, at: Point) {
        self.features.push(Feature { name: name.to_owned(), measure, nominal, at });
    }

    /// Flaps on two ligaments each: one slit along the lower side, and one round the others that ends a ligament above
    /// it. Returns where the row ends.
    fn hinges(&mut self, at: Point, flap: f64, ligament: f64) -> f64 {
        let mut left = at.x;
        for (i, factor) in LIGAMENTS.into_iter().enumerate() {
            let (name, width) = (format!("L{}", i + 1), factor * ligament);
            let (right, top, foot) = (left + flap, at.y + flap, at.y + width + self.kerf);
            self.open(&[Point::new(left, at.y), Point::new(right, at.y)]);
            let around = [(left, foot), (left, top), (right, top), (right, foot)];
            self.open(&around.map(|(x, y)| Point::new(x, y)));
            for x in [left, right] {
                self.feature(&name, Measure::Ligament, width, Point::new(x, 0.5 * (at.y + foot)));
            }
            self.note(Point::new(left, top + 0.5 * SPACE), name);
            left = right + SPACE.max(4.0 * ligament);
        }
        left
    }

    /// Slots of graded widths. Returns where the row ends.
    fn slots(&mut self, at: Point) -> f64 {
        let mut left = at.x;
        for (i, kerfs) in SLOTS.into_iter().enumerate() {
            let (name, width) = (format!("S{}", i + 1), kerfs * self.kerf);
            let slot = Rect::new(left, at.y, left + width - self.kerf, at.y + SLOT);
            match i {
                0 => self.open(&[Point::new(left, slot.y0), Point::new(left, slot.y1)]),
                _ => self.closed(CutKind::Window, slot),
            }
            self.feature(&name, Measure::Slot, width, slot.center());
            self.note(Point::new(left, slot.y1 + 0.5 * SPACE), name);
            left = slot.x1 + 2.0 * SPACE;
        }
        left
    }

    /// Square holes. Returns where the row ends.
    fn holes(&mut self, at: Point) -> f64 {
        let mut left = at.x;
        for (i, side) in HOLES.into_iter().enumerate() {
            let hole = Rect::new(left, at.y, left + side, at.y + side);
            let name = format!("W{}", i + 1);
            self.closed(CutKind::Window, hole.inset(-0.5 * self.kerf));
            self.feature(&name, Measure::Hole, side, hole.center());
            self.note(Point::new(left, hole.y1 + 0.5 * SPACE), format!("{name} {side}"));
            left = hole.x1 + SPACE;
        }
        left
    }
}
