//! The enlarged corner in the other state: its pieces, with the hinges' turning angles.

use kurbo::{Point, Rect, Vec2};
use svg::node::element::Group;

use super::Scene;
use super::detail::{Corner, pieces_at};
use super::page::{
    self, INK, arrow_head, bounds, colour, dots, fit, fixed, push_polyline, simplified, stroke,
    text_with_halo, turn_arrow,
};
use crate::fabrication::states::other_vertices;
use crate::geometry::{Point3, Vector3, centroid};
use crate::kirigami::design::Piece;

/// Vertices that change a drawn outline by less are left out, page millimetres.
const TOLERANCE: f64 = 0.02;

/// The pieces around the corner in the other state, seen along their mean normal.
pub fn picture(scene: &Scene, corner: &Corner, window: Rect) -> Group {
    let pieces = pieces_at(scene, corner);
    let motions = &scene.opening.motions;
    let along = Vec2::from_angle(corner.direction);
    let sum = |v: Vector3| -> Vector3 { pieces.iter().map(|&piece| motions[piece].rotation * v).sum() };
    let up = sum(Vector3::z()).normalize();
    let level = sum(Vector3::new(along.x, along.y, 0.0));
    let Some(right) = (level - up * level.dot(&up)).try_normalize(1e-9) else { return Group::new() };
    let project = |p: &Point3| Point::new(p.coords.dot(&right), p.coords.dot(&up.cross(&right)));
    let contours: Vec<Vec<Point>> = pieces
        .iter()
        .map(|&piece| {
            let outline = scene.fabrication.outlines[piece].iter();
            outline.map(|&[x, y]| project(&motions[piece].apply(&Point3::new(x, y, 0.0)))).collect()
        })
        .collect();
    let map = fit(bounds(contours.iter().flatten().copied()), window.inset(-2.0));
    let mut group = Group::new();
    for (&piece, contour) in pieces.iter().zip(&contours) {
        let sense = scene.opening.senses[piece];
        let contour: Vec<Point> = contour.iter().map(|&p| map * p).collect();
        let mut data = String::new();
        push_polyline(&mut data, simplified(&contour, TOLERANCE), true, 2);
        let design = &scene.fabrication.design;
        let middle = map * project(&centroid(other_vertices(design, &design.pieces[piece])));
        group = group
            .add(page::area(data, &colour(sense.tone())).set("stroke", "#555555").set("stroke-width", "0.2"))
            .add(turn_arrow(middle, 3.6, sense, 0.6));
    }
    let place = |p: &Point3| map * project(p);
    group.add(hinges(scene, corner, &pieces, place))
}

fn hinges(scene: &Scene, corner: &Corner, pieces: &[usize], place: impl Fn(&Point3) -> Point) -> Group {
    let design = &scene.fabrication.design;
    let mut group = Group::new();
    let inside = design.hinges.iter().filter(|hinge| hinge.pieces.iter().all(|piece| pieces.contains(piece)));
    let vertex = |piece: usize, vertex: usize| &other_vertices(design, &design.pieces[piece])[vertex];
    group = group.add(dots(inside.map(|h| place(vertex(h.pieces[0], h.vertices[0]))), 0.7, INK));
    for row in &corner.hinges {
        let hinge = &design.hinges[row.id];
        let [j, k] = hinge.pieces.map(|piece| &design.pieces[piece]);
        let at = place(vertex(hinge.pieces[0], hinge.vertices[0]));
        if scene.opening.closes {
            // The sides lie together: nothing is left to draw the angle between.
            let label = format!("#{}: {}\u{b0}", row.id, fixed(row.angle.to_degrees(), 1));
            group = group.add(text_with_halo(at + Vec2::new(1.6, 1.2), 3.0, &label, "start"));
            continue;
        }
        let Some(far) = far_corner(j, k, corner.id) else { continue };
        let towards = [j, k].map(|piece| far_vertex(piece, far).map(|p| place(p) - at));
        if let [Some(a), Some(b)] = towards {
            let (arc, middle) = angle_arc(at, a, b);
            let label = at + 15.0 * middle + Vec2::new(0.0, 1.2);
            group = group.add(arc).add(text_with_halo(
                label,
                3.4,
                &format!("{}\u{b0}", fixed(row.angle.to_degrees(), 1)),
                "middle",
            ));
        }
        group = group.add(text_with_halo(at + Vec2::new(1.6, 1.2), 3.0, &format!("#{}", row.id), "start"));
    }
    group
}

/// The other end of the side that two neighbours share at a corner.
fn far_corner(j: &Piece, k: &Piece, corner: usize) -> Option<usize> {
    let n = j.corners.len();
    let at = j.corners.iter().position(|&c| c == corner)?;
    [(at + 1) % n, (at + n - 1) % n].map(|i| j.corners[i]).into_iter().find(|c| k.corners.contains(c))
}

fn far_vertex(piece: &Piece, corner: usize) -> Option<&Point3> {
    piece.open.get(piece.corners.iter().position(|&c| c == corner)?)
}

/// An arc with heads from one direction to the other, the short way, and the direction midway.
fn angle_arc(at: Point, a: Vec2, b: Vec2) -> (Group, Vec2) {
    const RADIUS: f64 = 9.0;
    let sweep = a.cross(b).atan2(a.dot(b));
    let start = a.atan2();
    let points = (0..=16).map(|i| at + RADIUS * Vec2::from_angle(start + sweep * f64::from(i) / 16.0));
    let mut data = String::new();
    push_polyline(&mut data, points, false, 2);
    let head = |angle: f64, sign: f64| {
        let direction = sign * sweep.signum() * Vec2::from_angle(angle).turn_90();
        arrow_head(at + RADIUS * Vec2::from_angle(angle), direction, 2.0, INK)
    };
    let group = Group::new().add(stroke(data, INK, 0.3)).add(head(start, -1.0)).add(head(start + sweep, 1.0));
    (group, Vec2::from_angle(start + 0.5 * sweep))
}
