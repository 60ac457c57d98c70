//! One corner from the middle of the sheet, or of an open sheet one hinge, enlarged: as it is cut, and in the other state.

use std::collections::BTreeMap;

use kurbo::{Affine, Point, Rect, Vec2};
use svg::node::element::{ClipPath, Group};

use super::page::{
    self, INK, LIGAMENT, bounds, colour, dimension, dots, number, push_polyline, rectangle, scale_of,
    segment, simplified, stroke, text, text_with_halo, turn_arrow,
};
use super::sheet::{cut_style, path_data};
use super::{Scene, opened_corner};
use crate::fabrication::fabricate::Fabrication;
use crate::fabrication::hinge_table::HingeRow;
use crate::fabrication::layout::{CutKind, CutLayout, CutPath};
use crate::fabrication::open_sheet::neck::neck_direction;
use crate::fabrication::states::sheet_vertices;
use crate::geometry::{Point3, centroid};
use crate::kirigami::design::State;

/// Half the window's side over the reach of the ligaments and their bars.
const WINDOW: f64 = 1.3;
/// Vertices that change a drawn outline by less are left out, page millimetres.
const TOLERANCE: f64 = 0.02;
/// Side of the square that marks the corner on the sheet drawing, page millimetres.
const MARK: f64 = 4.0;

/// A corner with its hinges.
#[derive(Debug, Clone)]
pub struct Corner<'a> {
    /// Index into the design's corners.
    pub id: usize,
    /// Its place on the sheet.
    pub middle: Point,
    /// Its hinges, the upper one of the enlarged picture first.
    pub hinges: Vec<&'a HingeRow>,
    /// Direction of the ligaments' length, radians from the sheet's x, within a quarter turn: on a closed sheet that of
    /// the slit that passes.
    pub direction: f64,
}

impl<'a> Corner<'a> {
    /// The corner with two hinges (else with any) that is nearest to the part's middle; of an open sheet one of its
    /// hinges.
    pub fn nearest_to_middle(fabrication: &'a Fabrication) -> Option<Self> {
        let design = &fabrication.design;
        if design.sheet_state == Some(State::Open) {
            return Self::hinge_nearest_to_middle(fabrication);
        }
        let mut hinges_of: BTreeMap<usize, Vec<&HingeRow>> = BTreeMap::new();
        for (hinge, row) in design.hinges.iter().zip(&fabrication.hinges) {
            let corner = design.pieces[hinge.pieces[0]].corners[hinge.vertices[0]];
            hinges_of.entry(corner).or_default().push(row);
        }
        let place = |corner: usize| Point::new(design.corners[corner].x, design.corners[corner].y);
        let part = bounds((0..design.corners.len()).map(place)).center();
        let rank =
            |(corner, hinges): &(usize, Vec<_>)| (hinges.len() < 2, place(*corner).distance_squared(part));
        let (id, mut hinges) = hinges_of.into_iter().min_by(|a, b| {
            let (a, b) = (rank(a), rank(b));
            a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
        })?;
        let direction = bar_direction(&fabrication.layout.paths, flat(&hinges[0].point));
        let across =
            |row: &HingeRow| (flat(&row.point) - place(id)).dot(Vec2::from_angle(direction).turn_90());
        hinges.sort_by(|a, b| across(b).total_cmp(&across(a)));
        Some(Corner { id, middle: place(id), hinges, direction })
    }

    fn hinge_nearest_to_middle(fabrication: &'a Fabrication) -> Option<Self> {
        let design = &fabrication.design;
        let corner = |id: usize| {
            let hinge = &design.hinges[id];
            design.pieces[hinge.pieces[0]].corners[hinge.vertices[0]]
        };
        let mut hinges_at = vec![0; design.corners.len()];
        for id in 0..design.hinges.len() {
            hinges_at[corner(id)] += 1;
        }
        let part = bounds(fabrication.hinges.iter().map(|row| flat(&row.point))).center();
        let rank = |row: &HingeRow| (hinges_at[corner(row.id)] < 2, flat(&row.point).distance_squared(part));
        let row = fabrication.hinges.iter().min_by(|a, b| {
            let (a, b) = (rank(a), rank(b));
            a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
        })?;
        let along = neck_direction(design, row.id)?;
        let along = if along.x > 0.0 || (along.x == 0.0 && along.y > 0.0) { along } else { -along };
        let middle = flat(&row.point);
        Some(Corner { id: corner(row.id), middle, hinges: vec![row], direction: along.atan2() })
    }
}

fn flat(p: &Point3) -> Point {
    Point::new(p.x, p.y)
}

/// Direction of the relief bar nearest to a hinge, in (-pi/2, pi/2]: that of the slit that passes the hinge.
fn bar_direction(paths: &[CutPath], hinge: Point) -> f64 {
    let bars = paths.iter().filter(|path| path.kind == CutKind::Relief);
    let ends = bars.map(|path| [path.vertices[0].point, path.vertices[path.vertices.len() - 1].point]);
    let distance = |[a, b]: &[Point; 2]| a.midpoint(*b).distance_squared(hinge);
    let Some([a, b]) = ends.min_by(|a, b| distance(a).total_cmp(&distance(b))) else { return 0.0 };
    let along = if b.x > a.x || (b.x == a.x && b.y > a.y) { b - a } else { a - b };
    along.atan2()
}

/// The panel.
pub fn panel(scene: &Scene, area: Rect) -> Group {
    let group = page::panel(area, "3  How a hinge is cut and bends");
    let Some(corner) = &scene.corner else {
        return group.add(text(Point::new(area.x0 + 2.0, area.y0 + 12.0), 3.2, "This sheet has no hinge."));
    };
    let side = area.height() - 18.0;
    let top = area.y0 + 7.5;
    let closed = Rect::new(area.x0 + 2.0, top, area.x0 + 2.0 + side, top + side);
    let opened = Rect::new(closed.x1 + 4.0, top, area.x1 - 2.0, top + side);
    let turned = corner.direction.to_degrees().round();
    let place =
        if turned == 0.0 { String::new() } else { format!(", turned by {}\u{b0}", number(-turned, 0)) };
    let turned_caption = if scene.opening.closes {
        "Closed, from above: pieces turn in their"
    } else {
        "Opened, from above: pieces turn in their"
    };
    let line = |x: f64, i: f64, content: &str| text(Point::new(x, closed.y1 + 4.0 * i), 3.2, content);
    group
        .add(enlarged(scene, corner, closed))
        .add(opened_corner::picture(scene, corner, opened))
        .add(line(closed.x0, 1.0, &format!("As cut: square A of picture 1{place}.")))
        .add(line(closed.x0, 2.0, "Green: ligaments, W x L. White: cut away."))
        .add(line(opened.x0, 1.0, turned_caption))
        .add(line(opened.x0, 2.0, "plane, ligaments bend sideways, nothing folds."))
}

/// The corner as it is cut, the slit that passes level, grooves at their true width.
fn enlarged(scene: &Scene, corner: &Corner, window: Rect) -> Group {
    let layout = &scene.fabrication.layout;
    let longest = corner.hinges.iter().map(|row| row.length).fold(0.0, f64::max);
    let reach = 0.5 * longest + scene.fabrication.design.gap.max(layout.kerf);
    // Ligaments and cuts without size are shown in a window of a millimetre or so.
    let half = WINDOW * if reach > 0.0 { reach } else { 1.0 };
    let scale = 0.5 * window.width() / half;
    let map = Affine::translate(window.center().to_vec2())
        * Affine::scale_non_uniform(scale, -scale)
        * Affine::rotate(-corner.direction)
        * Affine::translate(-corner.middle.to_vec2());
    let clip = ClipPath::new().set("id", "corner").add(rectangle(window, "none"));
    let drawing = Group::new()
        .set("clip-path", "url(#corner)")
        .add(rectangle(window, page::STOCK))
        .add(ligaments(corner, map))
        .add(outlines(scene, corner, map))
        .add(grooves(&layout.paths, layout.kerf, map, window))
        .add(turn_arrows(scene, corner, map, window))
        .add(dots(corner.hinges.iter().map(|row| map * flat(&row.point)), 0.9, INK));
    let frame = rectangle(window, "none").set("stroke", "#999999").set("stroke-width", "0.25");
    Group::new()
        .add(clip)
        .add(drawing)
        .add(frame)
        .add(dimensions(corner, layout, map, window))
        .add(if scene.opening.closes { Group::new() } else { groove_dimension(scene, map, window) })
}

/// The ligaments' rectangles, wide enough to show through wherever pieces and grooves leave them free.
fn ligaments(corner: &Corner, map: Affine) -> Group {
    let mut group = Group::new();
    let along = Vec2::from_angle(corner.direction);
    for row in &corner.hinges {
        let [half_length, half_width] = [0.5 * row.length * along, 0.55 * row.width * along.turn_90()];
        let centre = flat(&row.point);
        let ring = [
            half_length + half_width,
            half_width - half_length,
            -half_length - half_width,
            half_length - half_width,
        ];
        let mut data = String::new();
        push_polyline(&mut data, ring.map(|v| map * (centre + v)), true, 2);
        group = group.add(page::area(data, LIGAMENT));
    }
    group
}

fn outlines(scene: &Scene, corner: &Corner, map: Affine) -> Group {
    let mut group = Group::new();
    for piece in pieces_at(scene, corner) {
        let contour: Vec<Point> =
            scene.fabrication.outlines[piece].iter().map(|&[x, y]| map * Point::new(x, y)).collect();
        let mut data = String::new();
        push_polyline(&mut data, simplified(&contour, TOLERANCE), true, 2);
        group = group.add(page::area(data, &colour(scene.opening.senses[piece].tone())));
    }
    group
}

/// The pieces that meet at the corner.
pub fn pieces_at(scene: &Scene, corner: &Corner) -> Vec<usize> {
    let pieces = scene.fabrication.design.pieces.iter().enumerate();
    pieces.filter(|(_, piece)| piece.corners.contains(&corner.id)).map(|(id, _)| id).collect()
}

/// Cuts as wide as the beam burns them, white, with their centre lines in the colour of their kind.
fn grooves(paths: &[CutPath], kerf: f64, map: Affine, window: Rect) -> Group {
    let seen = |path: &&CutPath| {
        let points = path.vertices.iter().map(|v| map * v.point);
        !bounds(points).inset(5.0).intersect(window).is_zero_area()
    };
    let near: Vec<&CutPath> = paths.iter().filter(seen).collect();
    let width = kerf * scale_of(map);
    let all = path_data(near.iter().copied(), map);
    let burned = stroke(all, "#ffffff", width).set("stroke-linecap", "round").set("stroke-linejoin", "round");
    let mut group = Group::new().add(burned);
    for kind in [CutKind::Slit, CutKind::Relief, CutKind::Window, CutKind::Border] {
        let data = path_data(near.iter().copied().filter(|path| path.kind == kind), map);
        if !data.is_empty() {
            group = group.add(stroke(data, cut_style(kind).0, 0.4));
        }
    }
    group
}

fn turn_arrows(scene: &Scene, corner: &Corner, map: Affine, window: Rect) -> Group {
    let mut group = Group::new();
    let design = &scene.fabrication.design;
    let closes = scene.opening.closes;
    let joined = |piece: usize| corner.hinges.iter().any(|row| row.pieces.contains(&piece));
    for piece in pieces_at(scene, corner).into_iter().filter(|&piece| !closes || joined(piece)) {
        let middle = map * flat(&centroid(sheet_vertices(design, &design.pieces[piece])));
        let away = middle - window.center();
        let reach = 0.36 * window.width();
        // Closed pieces fill the window's corners, open ones its sides.
        let towards = if closes { away.normalize() } else { Vec2::new(away.x.signum(), away.y.signum()) };
        let at = window.center() + reach * towards;
        group = group.add(turn_arrow(at, 4.5, scene.opening.senses[piece], 0.7));
    }
    group
}

/// Width at the upper ligament, length at the lower one.
fn dimensions(corner: &Corner, layout: &CutLayout, map: Affine, window: Rect) -> Group {
    let kerf = layout.kerf;
    let scale = scale_of(map);
    let mut group = Group::new();
    for row in &corner.hinges {
        let at = map * flat(&row.point) + Vec2::new(2.0, 1.2);
        group = group.add(text_with_halo(at, 3.4, &format!("#{}", row.id), "start"));
    }
    if let Some(upper) = corner.hinges.first() {
        let at = map * flat(&upper.point);
        let [right, half] = [0.5 * upper.length * scale, 0.5 * upper.width * scale];
        let x = at.x + right + 4.0;
        let ends = [-half, half].map(|dy| Point::new(x, at.y + dy));
        for end in ends {
            group = group.add(segment(Point::new(at.x + right, end.y), end + Vec2::new(1.5, 0.0), INK, 0.15));
        }
        let label = Point::new(window.x1 - 1.0, ends[0].y - 1.6);
        group = group.add(dimension(ends[0], ends[1])).add(text_with_halo(
            label,
            3.2,
            &millimetres("W", upper.width),
            "end",
        ));
    }
    if let Some(lower) = corner.hinges.last() {
        let at = map * flat(&lower.point);
        let [half, down] = [0.5 * lower.length * scale, (0.5 * lower.width + kerf) * scale];
        let y = at.y + down + 5.0;
        let ends = [-half, half].map(|dx| Point::new(at.x + dx, y));
        for end in ends {
            group = group.add(segment(Point::new(end.x, at.y + down), end + Vec2::new(0.0, 1.5), INK, 0.15));
        }
        let label = Point::new(at.x, y + 4.6);
        group = group.add(dimension(ends[0], ends[1])).add(text_with_halo(
            label,
            3.2,
            &millimetres("L", lower.length),
            "middle",
        ));
    }
    group
}

/// The width of the slit that passes.
fn groove_dimension(scene: &Scene, map: Affine, window: Rect) -> Group {
    let layout = &scene.fabrication.layout;
    let kerf = layout.kerf;
    let x = window.x0 + 0.08 * window.width();
    let at = Point::new(x, slit_height(&layout.paths, map, x, window.center().y));
    let half = Vec2::new(0.0, 0.5 * kerf * scale_of(map));
    let label = Point::new(window.x0 + 1.0, at.y - half.y - 6.6);
    let name = text_with_halo(label, 3.2, &millimetres(scene.groove, kerf), "start");
    Group::new().add(dimension(at - half, at + half)).add(name)
}

fn millimetres(name: &str, value: f64) -> String {
    format!("{name} {} mm", number(value, 3))
}

/// Where a cut crosses the page's vertical at `x`, as near as possible to `y`; `y` if none does.
fn slit_height(paths: &[CutPath], map: Affine, x: f64, y: f64) -> f64 {
    let crossing = |[a, b]: [Point; 2]| {
        let (a, b) = (map * a, map * b);
        ((a.x > x) != (b.x > x)).then(|| a.y + (x - a.x) / (b.x - a.x) * (b.y - a.y))
    };
    let segments = paths.iter().flat_map(|path| path.segments(TOLERANCE / scale_of(map)));
    let heights = segments.filter_map(crossing);
    heights.min_by(|a, b| (a - y).abs().total_cmp(&(b - y).abs())).unwrap_or(y)
}

/// The square on the sheet drawing that shows where the enlarged corner is.
pub fn mark(corner: &Corner, map: Affine) -> Group {
    let all = mark_box(corner, map);
    let square = Rect { x1: all.x0 + MARK, ..all };
    Group::new()
        .add(rectangle(square, "none").set("stroke", INK).set("stroke-width", "0.4"))
        .add(text_with_halo(Point::new(square.x1 + 0.8, square.y1), MARK, "A", "start"))
}

/// The room that the mark and its letter take.
pub fn mark_box(corner: &Corner, map: Affine) -> Rect {
    let square = Rect::from_center_size(map * corner.middle, (MARK, MARK));
    Rect { x1: square.x1 + MARK, ..square }
}
