//! Cuts burned on paper: what grooves of the kerf's width leave of the sheet, and measures of contours.

use std::f64::consts::PI;

use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::single::SingleFloatOverlay;
use i_overlay::mesh::float::stroke::offset::StrokeOffset;
use i_overlay::mesh::float::style::{LineCap, LineJoin, StrokeStyle};
use i_overlay::mesh::math::MathMode;
use kurbo::{Point, Rect, Vec2};
use rayon::prelude::*;

use super::cuts::ARC_TOLERANCE;
use super::layout::{CutKind, CutPath};
use super::ligament::MeasuredLigament;
use super::web::nearest_on_segment;

/// A closed contour: x, y in millimetres, counter-clockwise if it bounds from outside.
pub type Contour = Vec<[f64; 2]>;
/// An outer contour and its holes.
pub type Shape = Vec<Contour>;

/// Distance by which the round ends' chords leave the circle, millimetres.
const CAP_TOLERANCE: f64 = 3e-4;

/// What the cuts leave of the sheet: one shape per body, its outer contour counter-clockwise, then its holes clockwise.
/// Scraps smaller than a kerf square are left out.
pub fn burned_bodies(paths: &[CutPath], kerf: f64) -> Vec<Shape> {
    let bodies = subtract(&sheet(paths), &grooves(paths.iter(), kerf, ARC_TOLERANCE));
    bodies.into_iter().filter(|body| area(&body[0]) > kerf * kerf).collect()
}

/// The grooves of all paths, as the tool leaves them: round ends, radius half the kerf. Arcs are taken as chords within
/// `tolerance`, millimetres. Where grooves meet their shapes overlap.
pub fn grooves<'a>(
    paths: impl Iterator<Item = &'a CutPath> + Clone,
    kerf: f64,
    tolerance: f64,
) -> Vec<Shape> {
    let lines = |closed: bool| -> Vec<Contour> {
        paths.clone().filter(|path| path.closed == closed).map(|path| contour(path, tolerance)).collect()
    };
    let mut grooves: Vec<Shape> = lines(false).par_iter().flat_map_iter(|line| groove(line, kerf)).collect();
    grooves.extend(stroke(lines(true), kerf, true));
    grooves
}

/// The groove along an open line.
pub(super) fn groove(line: &[[f64; 2]], kerf: f64) -> Vec<Shape> {
    match *line {
        [from, to] if from != to => vec![vec![capsule(from, to, kerf)]],
        _ => stroke(vec![line.to_vec()], kerf, false),
    }
}

/// The groove along a straight line, counter-clockwise: most cuts are straight, and a union of one needs no time.
fn capsule(from: [f64; 2], to: [f64; 2], kerf: f64) -> Contour {
    let [from, to] = [from, to].map(|[x, y]| Point::new(x, y));
    let steps = (PI / cap_step(kerf)).ceil();
    let arm = 0.5 * kerf * (to - from).normalize();
    // Around the far end from its right side to its left, then around the near one.
    let cap = |end: Point, forth: Vec2| {
        let side = -forth.turn_90();
        (0..=steps as usize).map(move |i| {
            let (sin, cos) = (PI * i as f64 / steps).sin_cos();
            let at = end + cos * side + sin * forth;
            [at.x, at.y]
        })
    };
    cap(to, arm).chain(cap(from, -arm)).collect()
}

/// The angle of a round end's chords: over the angle a they leave a circle by r (1 - cos(a/2)).
fn cap_step(kerf: f64) -> f64 {
    2.0 * (1.0 - (2.0 * CAP_TOLERANCE / kerf).min(0.1)).acos()
}

/// The grooves along open or closed lines.
pub fn stroke(lines: Vec<Contour>, kerf: f64, closed: bool) -> Vec<Shape> {
    let step = cap_step(kerf);
    let style = StrokeStyle::new(kerf)
        .line_join(LineJoin::Round(step))
        .start_cap(LineCap::Round(step))
        .end_cap(LineCap::Round(step))
        .math(MathMode::Float);
    lines.stroke(style, closed)
}

fn contour(path: &CutPath, tolerance: f64) -> Contour {
    path.flatten(tolerance).into_iter().map(|point| [point.x, point.y]).collect()
}

/// The sheet's outer contour and its windows.
fn sheet(paths: &[CutPath]) -> Shape {
    let (borders, windows): (Vec<_>, Vec<_>) = paths
        .iter()
        .filter(|path| matches!(path.kind, CutKind::Border | CutKind::Window))
        .partition(|path| path.kind == CutKind::Border);
    borders.into_iter().chain(windows).map(|path| contour(path, ARC_TOLERANCE)).collect()
}

pub(super) fn subtract(subject: &Shape, clip: &Vec<Shape>) -> Vec<Shape> {
    subject.overlay(clip, OverlayRule::Difference, FillRule::NonZero)
}

/// The ligament's free rectangle, widened to the middle of the grooves on either side.
pub(super) fn ligament_region(ligament: &MeasuredLigament) -> Contour {
    let [from, to] = ligament.bar;
    let middle = from.midpoint(to);
    // A round notch has no bar; its ligament lies across the line to the groove that passes.
    let along = if from == to { (ligament.centre - middle).turn_90() } else { to - from }.normalize();
    let across = along.turn_90();
    let half = 0.5 * ligament.length * along;
    let depth = 2.0 * (ligament.centre - middle).dot(across) * across;
    let corners = [middle - half, middle + half, middle + half + depth, middle - half + depth];
    let mut contour: Contour = corners.iter().map(|point| [point.x, point.y]).collect();
    if area(&contour) < 0.0 {
        contour.reverse(); // opposite senses would cancel under the non-zero rule
    }
    contour
}

/// The bounding box of a contour.
pub fn contour_box(contour: &[[f64; 2]]) -> Rect {
    let start = Rect::new(f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY);
    contour
        .iter()
        .fold(start, |all, &[x, y]| Rect::new(all.x0.min(x), all.y0.min(y), all.x1.max(x), all.y1.max(y)))
}

/// Signed area of a contour, positive counter-clockwise, square millimetres.
pub fn area(contour: &[[f64; 2]]) -> f64 {
    let Some(&[x, y]) = contour.first() else { return 0.0 };
    // Relative to the first vertex, so that small contours far from the origin keep their digits.
    let cross = |a: [f64; 2], b: [f64; 2]| (a[0] - x) * (b[1] - y) - (b[0] - x) * (a[1] - y);
    contour.windows(2).map(|pair| 0.5 * cross(pair[0], pair[1])).sum()
}

/// Centroid of the area inside a contour; its first vertex if the area vanishes.
pub(super) fn centroid(contour: &[[f64; 2]]) -> [f64; 2] {
    let Some(&[x, y]) = contour.first() else { return [0.0; 2] };
    let total = area(contour);
    if total == 0.0 {
        return [x, y];
    }
    let mut sum = [0.0; 2];
    for pair in contour.windows(2) {
        let [a, b] = [0, 1].map(|i| [pair[i][0] - x, pair[i][1] - y]);
        let cross = a[0] * b[1] - b[0] * a[1];
        sum = [sum[0] + cross * (a[0] + b[0]), sum[1] + cross * (a[1] + b[1])];
    }
    [x + sum[0] / (6.0 * total), y + sum[1] / (6.0 * total)]
}

/// A point inside a polygon: the centroid where it lies more than `clear` inside, else, of the middles of some horizontal
/// chords, the one farthest from the sides. Bistable sheets have pieces like stars and hooks.
pub fn inner_point(polygon: &[[f64; 2]], clear: f64) -> [f64; 2] {
    let depth = |[x, y]: [f64; 2]| {
        let point = Point::new(x, y);
        let sides = (0..polygon.len()).map(|i| [polygon[i], polygon[(i + 1) % polygon.len()]]);
        let sides = sides.map(|side| side.map(|[x, y]| Point::new(x, y)));
        sides.map(|side| nearest_on_segment(point, side).distance(point)).fold(f64::INFINITY, f64::min)
    };
    let middle = centroid(polygon);
    if contains(polygon, middle) && depth(middle) > clear {
        return middle;
    }
    let mut heights: Vec<f64> = polygon.iter().map(|point| point[1]).collect();
    heights.sort_by(f64::total_cmp);
    let chords = heights.windows(2).flat_map(|pair| {
        let y = 0.5 * (pair[0] + pair[1]);
        let crossing = |i: usize| {
            let [[ax, ay], [bx, by]] = [polygon[i], polygon[(i + 1) % polygon.len()]];
            ((ay > y) != (by > y)).then(|| ax + (y - ay) / (by - ay) * (bx - ax))
        };
        let mut xs: Vec<f64> = (0..polygon.len()).filter_map(crossing).collect();
        xs.sort_by(f64::total_cmp);
        xs.chunks_exact(2).map(|x| [0.5 * (x[0] + x[1]), y]).collect::<Vec<_>>()
    });
    chords.max_by(|&a, &b| depth(a).total_cmp(&depth(b))).unwrap_or(middle)
}

/// Whether a point lies inside a contour (even-odd rule).
pub fn contains(contour: &[[f64; 2]], [x, y]: [f64; 2]) -> bool {
    let mut inside = false;
    for (i, &[ax, ay]) in contour.iter().enumerate() {
        let [bx, by] = contour[(i + 1) % contour.len()];
        if (ay > y) != (by > y) && x < ax + (y - ay) / (by - ay) * (bx - ax) {
            inside = !inside;
        }
    }
    inside
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_groove_of_a_straight_cut_is_a_capsule_in_every_direction() {
        let (from, length, kerf) = ([3.0, -2.0], 7.0, 0.2);
        for direction in 0..12 {
            let (sin, cos) = (0.3 + direction as f64).sin_cos();
            let line = [from, [from[0] + length * cos, from[1] + length * sin]];
            let [groove] = &groove(&line, kerf)[..] else { panic!("one shape") };
            let [contour] = &groove[..] else { panic!("without holes") };
            // Its ends are chords of circles, within the tolerance.
            let exact = length * kerf + 0.25 * PI * kerf * kerf;
            let most = PI * kerf * CAP_TOLERANCE;
            let closed: Contour = contour.iter().chain(contour.first()).copied().collect();
            assert!((0.0..most).contains(&(exact - area(&closed))), "{direction}");
            // The same as that of the library, which draws any line.
            let [drawn] = &stroke(vec![line.to_vec()], kerf, false)[..] else { panic!("one shape") };
            assert!((area(contour) - area(&drawn[0])).abs() < 0.1 * most, "{direction}");
            let [ours, theirs] = [contour, &drawn[0]].map(|contour| contour_box(contour));
            for (a, b) in
                [(ours.x0, theirs.x0), (ours.y0, theirs.y0), (ours.x1, theirs.x1), (ours.y1, theirs.y1)]
            {
                assert!((a - b).abs() < CAP_TOLERANCE, "{direction}");
            }
        }
    }
}
