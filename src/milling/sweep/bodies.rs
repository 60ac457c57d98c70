//! Whether the sheet holds together until its border is cut.

use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::single::SingleFloatOverlay;
use kurbo::{Point, Rect};

use super::finding::{Finding, Trouble};
use super::section::{Counted, Section, sections};
use super::{Move, Wanted};
use crate::fabrication::outline::{Contour, area, contains, contour_box, stroke};
use crate::geometry::Point3;

/// Bodies of the stock before the border is cut.
pub struct Bodies {
    /// How many hold parts of the part.
    pub bodies: usize,
    /// How many scraps are loose.
    pub loose: usize,
    /// What is wrong.
    pub findings: Vec<Finding>,
}

/// Burns all sections at mid-plane up to the first one along the part's outer contour.
pub fn before_border(moves: &[Move], wanted: &Wanted) -> Bodies {
    let z = -0.5 * wanted.thickness;
    let mut all = sections(moves, z, wanted.radius, Counted::Touched);
    let end = border_begins(&all, wanted);
    all.truncate(end);
    let grooves = stroke(chains(&all), 2.0 * wanted.radius, false);
    let [width, height] = wanted.stock;
    // A rim, so that grooves at the stock's edge do not part it.
    let rim = 2.0 * wanted.radius + 1.0;
    let stock: Contour =
        vec![[-rim, -rim], [width + rim, -rim], [width + rim, height + rim], [-rim, height + rim]];
    let bodies = vec![stock].overlay(&grooves, OverlayRule::Difference, FillRule::NonZero);
    let least = wanted.radius * wanted.radius;
    let mut bodies: Vec<_> = bodies.into_iter().filter(|body| area(&body[0]) > least).collect();
    bodies.sort_by(|a, b| area(&b[0]).total_cmp(&area(&a[0])));
    // A body that holds material of the part: the middle of a ligament is a point of it.
    let boxes: Vec<_> = bodies.iter().map(|body| contour_box(&body[0])).collect();
    let holds = |body: usize, point: Point| {
        boxes[body].contains(point)
            && contains(&bodies[body][0], [point.x, point.y])
            && !bodies[body][1..].iter().any(|hole| contains(hole, [point.x, point.y]))
    };
    let mut with_part = vec![false; bodies.len()];
    for point in wanted.necks.iter().map(|neck| neck.at) {
        if let Some(body) = (0..bodies.len()).find(|&body| holds(body, point)) {
            with_part[body] = true;
        }
    }
    // The stock around the part is the frame; what of the part is elsewhere has come off it.
    let frame = (0..bodies.len()).find(|&body| boxes[body].x0 < 0.0).unwrap_or(0);
    let off: Vec<usize> = (0..bodies.len()).filter(|&body| with_part[body] && body != frame).collect();
    let mut findings = Vec::new();
    if let Some(&body) = off.first() {
        let [x, y] = bodies[body][0][0];
        let (at, value) = (Point3::new(x, y, z), off.len() as f64);
        findings.push(Finding { trouble: Trouble::Body, at, value, limit: 0.0, hinge: None, step: None });
    }
    let count = 1 + off.len();
    Bodies { bodies: count, loose: bodies.len().saturating_sub(count), findings }
}

/// The first of the sections whose tool runs along the part's outer contour away from its hinges and grooves: the
/// last stretch of moves that all lie outside of the part's outer contour.
fn border_begins(all: &[Section], wanted: &Wanted) -> usize {
    let (mut low, mut high) =
        (Point::new(f64::INFINITY, f64::INFINITY), Point::new(f64::NEG_INFINITY, f64::NEG_INFINITY));
    for corner in &wanted.part.vertices {
        low = Point::new(low.x.min(corner.x), low.y.min(corner.y));
        high = Point::new(high.x.max(corner.x), high.y.max(corner.y));
    }
    // Leaning walls stand out at one face.
    let of = Rect::from_points(low, high).inset(-0.5 * wanted.thickness);
    let mut end = all.len();
    // Runs, from the last: a border's sections reach the box of the part's contour on all four sides.
    while end > 0 {
        let start = (0..end).rev().find(|&i| !all[i].goes_on).unwrap_or(0);
        let mut low = Point::new(f64::INFINITY, f64::INFINITY);
        let mut high = Point::new(f64::NEG_INFINITY, f64::NEG_INFINITY);
        for point in all[start..end].iter().flat_map(|section| section.ends) {
            low = Point::new(low.x.min(point.x), low.y.min(point.y));
            high = Point::new(high.x.max(point.x), high.y.max(point.y));
        }
        let encloses = low.x < of.x0 && low.y < of.y0 && high.x > of.x1 && high.y > of.y1;
        if !encloses {
            return end;
        }
        end = start;
    }
    0
}

/// Sections that go on from one another, as lines.
fn chains(sections: &[Section]) -> Vec<Contour> {
    let mut chains: Vec<Contour> = Vec::new();
    let mut last: Option<Point> = None;
    for section in sections {
        let [from, to] = section.ends;
        if last != Some(from) {
            chains.push(vec![[from.x, from.y]]);
        }
        if let Some(chain) = chains.last_mut() {
            chain.push([to.x, to.y]);
        }
        last = Some(to);
    }
    chains
}
