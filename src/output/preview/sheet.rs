//! The sheet as it will be cut: pieces, cuts by kind, hinges by verdict, the stock's corner with rulers.

use kurbo::{Affine, Point, Rect, Vec2};
use svg::node::element::{Group, Path};

use super::opening::Bend;
use super::page::{
    self, BOLD, BORDER, GREY, INK, RELIEF, SLIT, STOCK, arrow, dots, fit, number, push_polyline, rectangle,
    scale_of, segment, simplified, stroke, text, text_width, text_with_halo,
};
use super::tables::{HingeClass, marker};
use super::{Scene, detail};
use crate::fabrication::cuts::bounding_box;
use crate::fabrication::hinge_table::HingeRow;
use crate::fabrication::layout::{CutKind, CutPath};

/// Height of the strip that says which side is up.
const BANNER: f64 = 24.0;
/// Chords stay this near to arcs, page millimetres.
const ARC_TOLERANCE: f64 = 0.01;
/// Vertices that change a piece's drawn outline by less are left out, page millimetres: in full and in simplified
/// drawings.
const TOLERANCE: [f64; 2] = [0.004, 0.05];

/// The panel.
pub fn panel(scene: &Scene, area: Rect) -> Group {
    let banner = Rect::new(area.x0 + 2.0, area.y0 + 8.0, area.x1 - 2.0, area.y0 + 8.0 + BANNER);
    let drawing = Rect::new(area.x0 + 12.0, banner.y1 + 5.0, area.x1 - 5.0, area.y1 - 16.0);
    let part = part_box(scene);
    let [width, height] = scene.fabrication.layout.sheet;
    // The part with the stock's lower left corner, and its other edges if they are near.
    let reach = 1.04 * part.x1.max(part.y1);
    let shown =
        Rect::new(0.0, 0.0, (part.x1 + 0.04 * reach).min(width), (part.y1 + 0.04 * reach).min(height));
    let map = fit(shown, drawing);
    page::panel(area, "1  The sheet as it will be cut, seen from above: this face up on the machine")
        .add(banner_group(scene, banner, part))
        .add(rectangle(map.transform_rect_bbox(shown), STOCK))
        .add(rulers(shown, map))
        .add(pieces(scene, map))
        .add(cuts(scene, map))
        .add(hinges(scene, map))
        .add(names(scene, map))
        .add(scene.corner.as_ref().map_or_else(Group::new, |corner| detail::mark(corner, map)))
        .add(captions(scene, map, area, part))
}

/// The box that the cuts leave, burned edges included.
fn part_box(scene: &Scene) -> Rect {
    let layout = &scene.fabrication.layout;
    bounding_box(&layout.paths).inset(0.5 * layout.kerf)
}

fn banner_group(scene: &Scene, banner: Rect, part: Rect) -> Group {
    let becomes = match scene.opening.bend {
        Bend::Flat => "It stays nearly flat.",
        Bend::Convex => "It ends CONVEX: the sheet bulges towards you.",
        Bend::Concave => "It ends CONCAVE: the sheet sinks away from you like a bowl.",
        Bend::Mixed => "It ends partly convex, partly concave (like a saddle or a wave).",
    };
    let x = banner.x0 + 24.0;
    let line = |y: f64, size: f64, content: &str| text(Point::new(x, banner.y0 + y), size, content);
    Group::new()
        .add(rectangle(banner, "#f5f5f5"))
        .add(up_sign(Rect::new(banner.x0 + 3.0, banner.y0 + 2.0, banner.x0 + 21.0, banner.y1 - 2.0)))
        .add(line(7.5, 6.0, "THIS SIDE UP").set("font-weight", "bold"))
        .add(line(14.0, 3.8, "It becomes the side of the target that the target's normals point to."))
        .add(line(19.5, 3.8, becomes).set("font-weight", "bold"))
        .add(stock_inset(scene.fabrication.layout.sheet, part, banner))
}

/// An arrow that rises from the sheet.
fn up_sign(area: Rect) -> Group {
    let middle = area.center();
    let ring = [
        Point::new(area.x0 + 4.5, area.y1 - 8.0),
        Point::new(area.x1, area.y1 - 8.0),
        Point::new(area.x1 - 4.5, area.y1),
        Point::new(area.x0, area.y1),
    ];
    let mut data = String::new();
    push_polyline(&mut data, ring, true, 2);
    let foot = Point::new(middle.x, area.y1 - 4.0);
    Group::new()
        .add(page::area(data, "#cccccc").set("stroke", INK).set("stroke-width", "0.3"))
        .add(segment(foot, Point::new(middle.x, area.y0 + 4.0), INK, 1.2))
        .add(page::arrow_head(Point::new(middle.x, area.y0), Vec2::new(0.0, -1.0), 6.0, INK))
}

/// The whole stock, small, with the part on it and its size.
fn stock_inset([width, height]: [f64; 2], part: Rect, banner: Rect) -> Group {
    let place = Rect::new(banner.x1 - 30.0, banner.y0 + 5.0, banner.x1 - 8.0, banner.y1 - 1.0);
    let map = fit(Rect::new(0.0, 0.0, width, height), place);
    let stock = map.transform_rect_bbox(Rect::new(0.0, 0.0, width, height));
    let above = Point::new(stock.center().x, stock.y0 - 1.0);
    let beside = Point::new(stock.x1 + 1.0, stock.center().y + 1.0);
    Group::new()
        .add(rectangle(stock, "#ffffff").set("stroke", INK).set("stroke-width", "0.25"))
        .add(rectangle(map.transform_rect_bbox(part), "#999999"))
        .add(text(above, 3.0, &format!("stock {}", number(width, 1))).set("text-anchor", "middle"))
        .add(text(beside, 3.0, &number(height, 1)))
}

/// The stock's edges as far as they are shown, with ticks in sheet millimetres along x and y.
fn rulers(shown: Rect, map: Affine) -> Group {
    let at = |x: f64, y: f64| map * Point::new(x, y);
    let origin = at(0.0, 0.0);
    let step = tick_step(scale_of(map));
    let mut data = String::new();
    let mut group = Group::new();
    for (length, horizontal) in [(shown.x1, true), (shown.y1, false)] {
        for i in 0..=(length / step) as usize {
            let value = step * i as f64;
            let (foot, out, anchor) = match horizontal {
                true => (at(value, 0.0), Vec2::new(0.0, 1.0), "middle"),
                false => (at(0.0, value), Vec2::new(-1.0, 0.0), "end"),
            };
            push_polyline(&mut data, [foot, foot + 1.6 * out], false, 2);
            if i > 0 {
                let shift = if horizontal { Vec2::new(0.0, 4.4) } else { Vec2::new(-2.2, 1.0) };
                group = group.add(text(foot + shift, 2.8, &number(value, 1)).set("text-anchor", anchor));
            }
        }
    }
    let ends = [at(0.0, shown.y1), at(shown.x1, 0.0)];
    let corner = origin + Vec2::new(-1.6, 4.4);
    group
        .add(stroke(data, GREY, 0.25))
        .add(text(corner, 2.8, "0").set("text-anchor", "end"))
        .add(arrow(origin, ends[1] + Vec2::new(4.0, 0.0), INK, 0.4))
        .add(arrow(origin, ends[0] - Vec2::new(0.0, 4.0), INK, 0.4))
        .add(text_with_halo(ends[1] + Vec2::new(6.6, 1.3), 4.0, "x", "middle"))
        .add(text_with_halo(ends[0] + Vec2::new(-3.0, -2.4), 4.0, "y", "middle"))
}

/// A round distance between ticks that takes at least 12 mm of the page.
fn tick_step(scale: f64) -> f64 {
    let steps = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0];
    steps.into_iter().find(|step| step * scale >= 12.0).unwrap_or(2000.0)
}

fn pieces(scene: &Scene, map: Affine) -> Group {
    let (tolerance, digits) = if scene.simplified { (TOLERANCE[1], 2) } else { (TOLERANCE[0], 3) };
    let mut group = Group::new();
    for sense in [page::Sense::CounterClockwise, page::Sense::Clockwise, page::Sense::Still] {
        let mut data = String::new();
        for (outline, _) in
            scene.fabrication.outlines.iter().zip(&scene.opening.senses).filter(|(_, s)| **s == sense)
        {
            let contour: Vec<Point> = outline.iter().map(|&[x, y]| map * Point::new(x, y)).collect();
            push_polyline(&mut data, simplified(&contour, tolerance), true, digits);
        }
        group = group.add(page::area(data, &page::colour(sense.tone())));
    }
    group
}

/// How cuts of a kind are drawn: colour and width on the page. The relief bars are left out where simplified.
pub fn cut_style(kind: CutKind) -> (&'static str, f64) {
    match kind {
        CutKind::Slit => (SLIT, 0.18),
        CutKind::Relief => (RELIEF, 0.18),
        CutKind::Window => (BORDER, 0.2),
        CutKind::Border => (BORDER, 0.4),
        CutKind::Lead => (BORDER, 0.2),
    }
}

fn cuts(scene: &Scene, map: Affine) -> Group {
    let mut group = Group::new();
    for kind in [CutKind::Slit, CutKind::Relief, CutKind::Window, CutKind::Border] {
        if kind == CutKind::Relief && scene.simplified {
            continue;
        }
        let (colour, width) = cut_style(kind);
        let data = path_data(scene.fabrication.layout.paths.iter().filter(|path| path.kind == kind), map);
        if !data.is_empty() {
            group = group.add(stroke(data, colour, width));
        }
    }
    group
}

/// The centre lines of paths, arcs as chords.
pub fn path_data<'a>(paths: impl Iterator<Item = &'a CutPath>, map: Affine) -> String {
    let mut data = String::new();
    for path in paths {
        let points = path.flatten(ARC_TOLERANCE / scale_of(map)).into_iter().map(|p| map * p);
        push_polyline(&mut data, points, path.closed, 3);
    }
    data
}

fn hinges(scene: &Scene, map: Affine) -> Group {
    let radius = (0.35 * scene.fabrication.design.gap * scale_of(map))
        .clamp(if scene.simplified { 0.14 } else { 0.22 }, 0.7);
    let mut group = Group::new();
    for class in HingeClass::ALL {
        let rows = scene.fabrication.hinges.iter().filter(|row| HingeClass::of(row) == class);
        let points = rows.map(|row| map * Point::new(row.point.x, row.point.y));
        match class.marker_size() {
            None => group = group.add(dots(points, radius, class.colour())),
            Some(size) => group = points.fold(group, |group, point| group.add(marker(class, point, size))),
        }
    }
    group
}

/// A ring around each of the worst hinges and its id, where no other id stands.
fn names(scene: &Scene, map: Affine) -> Group {
    const SIZE: f64 = 3.4;
    let at = |row: &HingeRow| map * Point::new(row.point.x, row.point.y);
    let mut taken: Vec<Rect> =
        scene.worst.iter().map(|row| Rect::from_center_size(at(row), (3.2, 3.2))).collect();
    taken.extend(scene.corner.as_ref().map(|corner| detail::mark_box(corner, map)));
    let mut group = Group::new();
    for row in &scene.worst {
        let point = at(row);
        let name = format!("#{}", row.id);
        let width = text_width(&name, BOLD * SIZE);
        let place = |i: usize| {
            let reach = 7.0 + 4.0 * (i / 8) as f64;
            let centre = point + reach * Vec2::from_angle(std::f64::consts::FRAC_PI_4 * (i as f64 - 1.0));
            Rect::from_center_size(centre, (width, SIZE))
        };
        let free = |rect: &Rect| taken.iter().all(|other| other.inset(0.5).intersect(*rect).area() <= 0.0);
        let label = (0..32).map(place).find(free).unwrap_or_else(|| place(0));
        taken.push(label);
        let to_label = (label.center() - point).normalize();
        group = group
            .add(ring(point, 1.6))
            .add(segment(point + 1.6 * to_label, point + 4.5 * to_label, INK, 0.35))
            .add(text_with_halo(Point::new(label.center().x, label.y1 - 0.4), SIZE, &name, "middle"));
    }
    group
}

fn ring(centre: Point, radius: f64) -> Path {
    let [x, y, r] = [centre.x - radius, centre.y, radius].map(|v| number(v, 2));
    let across = number(2.0 * radius, 2);
    stroke(format!("M{x},{y}a{r},{r} 0 1 0 {across},0a{r},{r} 0 1 0 -{across},0Z"), INK, 0.35)
}

/// Scale bar and sizes below the drawing.
fn captions(scene: &Scene, map: Affine, area: Rect, part: Rect) -> Group {
    let scale = scale_of(map);
    let y = area.y1 - 4.0;
    let units = [1.0, 2.0, 10.0, 20.0, 100.0, 200.0];
    let unit = units.into_iter().rfind(|unit| 5.0 * unit * scale <= 95.0).unwrap_or(1.0);
    let left = area.x0 + 12.0;
    let mut group = Group::new();
    for i in 0..5 {
        let [x0, x1] = [i, i + 1].map(|i| left + f64::from(i) * unit * scale);
        let fill = if i % 2 == 0 { INK } else { "#ffffff" };
        group = group.add(
            rectangle(Rect::new(x0, y - 2.0, x1, y), fill).set("stroke", INK).set("stroke-width", "0.2"),
        );
    }
    // A short first segment has no room for its own label.
    let labels = [(0, ""), (1, ""), (5, " mm")].into_iter().filter(|&(i, _)| i != 1 || unit * scale > 6.0);
    for (i, unit_text) in labels {
        let x = left + f64::from(i) * unit * scale;
        let label = format!("{}{unit_text}", number(f64::from(i) * unit, 0));
        group = group.add(text(Point::new(x, y - 2.8), 2.8, &label).set("text-anchor", "middle"));
    }
    let [sheet_x, sheet_y] = scene.fabrication.layout.sheet.map(|v| number(v, 1));
    let sizes = format!(
        "part {} x {} mm at ({}, {}) on stock {sheet_x} x {sheet_y} mm",
        number(part.width(), 1),
        number(part.height(), 1),
        number(part.x0, 1),
        number(part.y0, 1)
    );
    let right =
        |y: f64, content: &str| text(Point::new(area.x1 - 3.0, y), 3.2, content).set("text-anchor", "end");
    if scene.simplified {
        let left_out = "more than 3,000 pieces: relief bars not drawn, outlines simplified";
        return group.add(right(y - 2.4, &sizes)).add(right(y + 2.0, left_out));
    }
    group.add(right(y, &sizes))
}
