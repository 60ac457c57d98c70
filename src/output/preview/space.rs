//! A state in space: the pieces, shaded, painted back to front. Of a sheet it is the other state, with the pieces' true
//! outlines carried by their motions.

use kurbo::{Affine, Point, Rect, Vec2};
use svg::node::element::Group;

use super::Scene;
use super::page::{
    self, GREY, Sense, arrow, colour, fit, number, push_polyline, simplified, text, text_with_halo,
};
use crate::fabrication::states::other_vertices;
use crate::geometry::{Point3, Vector3, centroid};

/// Angle between the mean normal and the line of sight of the slanting view, degrees.
const TILT: f64 = 52.0;
/// Direction from which the slanting view looks, seen from above, degrees from the sheet's x.
const AZIMUTH: f64 = -65.0;
/// The light in the frame of the open state: from the left behind and above.
const LIGHT: [f64; 3] = [-0.55, 0.45, 0.70];
/// Brightness of a face that the light does not reach.
const AMBIENT: f64 = 0.62;
/// Tone of the side that is down on the machine.
const UNDERSIDE: [f64; 3] = [150.0, 150.0, 150.0];
/// Vertices that change a drawn outline by less are left out, page millimetres.
const TOLERANCE: f64 = 0.02;

/// An orthographic view: unit vectors to the right, up, and towards the eye.
struct View {
    right: Vector3,
    up: Vector3,
    towards: Vector3,
}

impl View {
    /// Straight on the upper side, the sheet's x to the right.
    fn top([right, up, towards]: [Vector3; 3]) -> Self {
        View { right, up, towards }
    }

    /// Slanting from above and in front.
    fn slanting([x, y, normal]: [Vector3; 3]) -> Self {
        let (sin_azimuth, cos_azimuth) = AZIMUTH.to_radians().sin_cos();
        let (sin_tilt, cos_tilt) = TILT.to_radians().sin_cos();
        let front = x * cos_azimuth + y * sin_azimuth;
        let towards = normal * cos_tilt + front * sin_tilt;
        View { right: normal.cross(&front), up: normal * sin_tilt - front * cos_tilt, towards }
    }

    fn project(&self, p: &Vector3) -> Point {
        Point::new(p.dot(&self.right), p.dot(&self.up))
    }
}

/// A state to be drawn.
pub struct Body<'a> {
    /// The outline of each piece.
    pub faces: Vec<Vec<Point3>>,
    /// The unit normal of each piece, on its upper side.
    pub normals: Vec<Vector3>,
    /// Which way each piece turns.
    pub senses: &'a [Sense],
    /// What x, y and up are on the page: a right-handed frame.
    pub frame: [Vector3; 3],
    /// Whether outlines are drawn.
    pub outlined: bool,
}

/// The slanting view.
pub fn slanting(body: &Body, area: Rect) -> Group {
    picture(body, &View::slanting(body.frame), area)
}

/// The view from the top.
pub fn top(body: &Body, area: Rect) -> Group {
    picture(body, &View::top(body.frame), area)
}

/// The panel with the slanting view and the view from the top.
pub fn panel(scene: &Scene, area: Rect) -> Group {
    let heading = if scene.opening.closes {
        "2  Closed: the upper side seen from above"
    } else {
        "2  Opened: the upper side seen from above"
    };
    let opening = scene.opening;
    let body = Body {
        faces: faces(scene),
        normals: (0..opening.motions.len()).map(|piece| opening.normal(piece)).collect(),
        senses: &opening.senses,
        frame: opening.frame,
        outlined: !scene.simplified,
    };
    let split = area.x0 + 0.6 * area.width();
    let views = Rect::new(area.x0 + 2.0, area.y0 + 8.0, area.x1 - 2.0, area.y1 - 7.0);
    let caption = Point::new(area.x0 + 2.0, area.y1 - 2.0);
    page::panel(area, heading)
        .add(slanting(&body, Rect { x1: split - 1.0, ..views }))
        .add(top(&body, Rect { x0: split + 1.0, ..views }))
        .add(text(caption, 3.2, &format!("{} {}", opening.done(), extents(&body))))
        .add(text(Point::new(split + 1.0, caption.y), 3.2, "straight from above"))
}

/// The outline of each piece in the other state.
fn faces(scene: &Scene) -> Vec<Vec<Point3>> {
    let design = &scene.fabrication.design;
    if scene.simplified {
        return design.pieces.iter().map(|piece| other_vertices(design, piece).to_vec()).collect();
    }
    let carry = |(outline, motion): (&Vec<[f64; 2]>, &crate::geometry::rotation::RigidMotion)| {
        outline.iter().map(|&[x, y]| motion.apply(&Point3::new(x, y, 0.0))).collect()
    };
    scene.fabrication.outlines.iter().zip(&scene.opening.motions).map(carry).collect()
}

/// How large a state is, in words.
pub fn extents(body: &Body) -> String {
    let extent = |axis: &Vector3| {
        let heights = || body.faces.iter().flatten().map(|p| p.coords.dot(axis));
        heights().fold(f64::NEG_INFINITY, f64::max) - heights().fold(f64::INFINITY, f64::min)
    };
    let [x, y, z] = [0, 1, 2].map(|i| number(extent(&body.frame[i]), 1));
    format!("{x} x {y} mm, {z} mm high")
}

fn picture(body: &Body, view: &View, area: Rect) -> Group {
    let projected: Vec<Vec<Point>> =
        body.faces.iter().map(|face| face.iter().map(|p| view.project(&p.coords)).collect()).collect();
    let map = fit(page::bounds(projected.iter().flatten().copied()), area.inset(-1.0));
    let mut order: Vec<(f64, usize)> = body
        .faces
        .iter()
        .enumerate()
        .map(|(piece, face)| (centroid(face).coords.dot(&view.towards), piece))
        .collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut group = Group::new();
    if body.outlined {
        group = group.set("stroke", "#555555").set("stroke-width", "0.06").set("stroke-linejoin", "round");
    }
    for (_, piece) in order {
        let contour: Vec<Point> = projected[piece].iter().map(|&p| map * p).collect();
        let mut data = String::new();
        push_polyline(&mut data, simplified(&contour, TOLERANCE), true, 2);
        group = group.add(page::area(data, &shade(body, piece, view)));
    }
    Group::new().add(group).add(axes(view, body.frame, area))
}

/// Lambert's law: brightness by the angle between the visible side's normal and the light.
fn shade(body: &Body, piece: usize, view: &View) -> String {
    let [x, y, up] = body.frame;
    let light = (x * LIGHT[0] + y * LIGHT[1] + up * LIGHT[2]).normalize();
    let normal = body.normals[piece];
    let upper = normal.dot(&view.towards) >= 0.0;
    let tone = if upper { body.senses[piece].tone() } else { UNDERSIDE };
    let visible = if upper { normal } else { -normal };
    let brightness = AMBIENT + (1.0 - AMBIENT) * visible.dot(&light).max(0.0) / light.dot(&up).max(0.5);
    colour(tone.map(|c| c * brightness.min(1.08)))
}

/// Where the sheet's x and y axes and its upper side point to.
fn axes(view: &View, frame: [Vector3; 3], area: Rect) -> Group {
    let tip = |axis: &Vector3, length: f64| {
        let p = view.project(axis);
        length * Vec2::new(p.x, -p.y)
    };
    let tips = [0, 1, 2].map(|i| tip(&frame[i], 8.0));
    let names = ["x", "y", "up"];
    let around = tips.iter().fold(Rect::ZERO, |all, v| all.union_pt(v.to_point())).inset(2.5);
    let origin = Affine::translate((area.x0 - around.x0, area.y1 - around.y1)) * Point::ORIGIN;
    let mut group = Group::new();
    for (tip, name) in tips.iter().zip(names) {
        // An axis along the line of sight has no arrow.
        if tip.length() > 1.0 {
            let label = origin + *tip + 2.0 * tip.normalize() + Vec2::new(0.0, 1.0);
            group = group
                .add(arrow(origin, origin + *tip, GREY, 0.3))
                .add(text_with_halo(label, 2.8, name, "middle"));
        }
    }
    group
}

/// The name of a turning sense.
pub fn sense_name(sense: Sense) -> &'static str {
    match sense {
        Sense::CounterClockwise => "counter-clockwise",
        Sense::Clockwise => "clockwise",
        Sense::Still => "shifted, not turned",
    }
}
