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

/// A tool that comes down so near to where it left goes on there, millimetres.
const SAME_PLACE: f64 = 1e-3;

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
    let end = border_begins(moves, &all, wanted);
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

/// Where the last runs begin, those that go around a whole part.
fn border_begins(moves: &[Move], all: &[Section], wanted: &Wanted) -> usize {
    let runs = runs(moves);
    let size = wanted.part.vertices.len().div_ceil(wanted.copies.max(1)).max(1);
    let parts: Vec<Rect> = wanted
        .part
        .vertices
        .chunks(size)
        .map(|part| box_of(part.iter().map(|p| Point::new(p.x, p.y))).inset(-0.5 * wanted.thickness))
        .collect();
    let mut end = all.len();
    for sections in all.chunk_by(|a, b| runs[a.step] == runs[b.step]).rev() {
        let around = box_of(sections.iter().flat_map(|section| section.ends));
        // Leaning walls stand out at one face, so the parts' boxes were taken smaller.
        if !parts.iter().any(|part| around.contains(part.origin()) && around.union(*part) == around) {
            break;
        }
        end -= sections.len();
    }
    end
}

/// The run of each move: all that the tool does between two times above the stock. Where it comes down again at the place
/// where it left, as after a retreat, the run goes on.
fn runs(moves: &[Move]) -> Vec<usize> {
    let mut runs = Vec::with_capacity(moves.len());
    let (mut run, mut left, mut away) = (0, None, true);
    for a_move in moves {
        let [from, to] = [a_move.from.tip, a_move.to.tip];
        if from.z > 0.0 && to.z <= 0.0 {
            run += usize::from(left.is_none_or(|left: Point3| (to - left).norm() > SAME_PLACE));
            away = false;
        } else if from.z <= 0.0 && to.z > 0.0 {
            (left, away) = (Some(from), true);
        }
        runs.push(if away && from.z > 0.0 { usize::MAX } else { run });
    }
    runs
}

fn box_of(points: impl Iterator<Item = Point>) -> Rect {
    let start = Rect::new(f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY);
    points.fold(start, |all, p| Rect::new(all.x0.min(p.x), all.y0.min(p.y), all.x1.max(p.x), all.y1.max(p.y)))
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
