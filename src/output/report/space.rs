//! What the 3D view shows: the pieces' outlines, where each piece is at some moments between the closed and the open
//! state, the targets, and the figures of the way.
//!
//! Frame of the page: millimetres about the middle of the pieces, turned so that the pieces on average stand as they lie on
//! the sheet; z is the side that is up. Without that the picture would wander from the stock to where the target's file lies.

mod encode;

mod target;

mod way;

use nalgebra::{Matrix3, Rotation3, UnitQuaternion};
use serde_json::{Value, json};

use super::Report;
use crate::fabrication::product::Product;
use crate::fabrication::states::motions;
use crate::geometry::closest::ClosestPoints;
use crate::geometry::rotation::{RigidMotion, nearest_rotation};
use crate::geometry::{Point3, Vector3, centroid};
use crate::kirigami::design::{Design, Piece, State};
use crate::output::preview::assembly::{frame, normals};
use crate::output::preview::opening::senses;
use crate::output::preview::page::{Sense, simplified};
use encode::{base64, counts};
use kurbo::Point;

/// Vertices that change an outline by less are left out, millimetres: a tenth of a pixel of a sheet of 300 mm.
const TOLERANCE: f64 = 0.02;
/// Most numbers of all poses, of two bytes each: fewer moments of more pieces.
const MOST_NUMBERS: usize = 600_000;
/// Numbers of a pose: place and quaternion.
const POSE: usize = 7;

/// A piece's outline in its own frame, and how that frame lies in the sheet state (closed, where neither is flat).
struct Shape {
    outline: Vec<[f64; 2]>,
    lies: RigidMotion,
}

/// A moment of the way.
struct Moment {
    /// 0 closed to 1 open: the part of their turn that the hinges have made.
    at: f64,
    /// What takes the design's coordinates of that moment to the page.
    page: RigidMotion,
    /// Each piece's own frame on the page.
    poses: Vec<RigidMotion>,
}

/// All of the view; null without pieces.
pub fn object(report: &Report) -> Value {
    let design = report.product.design();
    if design.pieces.is_empty() {
        return Value::Null;
    }
    let shapes = shapes(report.product);
    let moments = chosen(moments(report, &shapes));
    let last = moments.len() - 1;
    let step_of = |state| if state == State::Open { last } else { 0 };
    let rest = step_of(design.sheet_state.unwrap_or(State::Closed));
    let unit = |largest: f64| largest.max(1e-6) / f64::from(i16::MAX);
    let largest = shapes
        .iter()
        .flat_map(|shape| shape.outline.as_flattened())
        .fold(0.0, |most: f64, c| most.max(c.abs()));
    let corners = shapes.iter().flat_map(|shape| shape.outline.as_flattened().iter().copied());
    let reach = moments
        .iter()
        .flat_map(|moment| &moment.poses)
        .map(|pose| pose.translation.amax())
        .fold(0.0, f64::max);
    let targets = report.seen.targets.iter();
    json!({
        "thickness": report.heading.profile.sheet.thickness,
        "counts": base64(counts(shapes.iter().map(|shape| shape.outline.len()))),
        "outline_unit": unit(largest),
        "outlines": base64(encode::rounded(corners, unit(largest))),
        "place_unit": unit(reach),
        "at": moments.iter().map(|moment| moment.at).collect::<Vec<_>>(),
        "poses": base64(poses(&moments, unit(reach))),
        "rest": { "step": rest, "page": rows(&moments[rest].page) },
        "senses": turning(design, report.product),
        "targets": targets.clone().map(|(state, surface)| {
            target::object(*state, surface.mesh(), &moments[step_of(*state)].page)
        }).collect::<Vec<_>>(),
        "way": report.seen.morph.map(|morph| way::object(morph, moments.len())),
        "distance": distances(design, report.seen.targets),
    })
}

/// The true outlines of a sheet, the hinge polygons of an assembly, each about its middle.
fn shapes(product: &Product) -> Vec<Shape> {
    match product {
        Product::Sheet(sheet) => {
            let shape = |outline: &Vec<[f64; 2]>| {
                let points: Vec<Point> = outline.iter().map(|&p| Point::from((p[0], p[1]))).collect();
                let points = simplified(&points, TOLERANCE);
                let middle =
                    points.iter().map(|p| p.to_vec2()).sum::<kurbo::Vec2>() / points.len().max(1) as f64;
                let translation = Vector3::new(middle.x, middle.y, 0.0);
                let outline = points.iter().map(|p| [p.x - middle.x, p.y - middle.y]).collect();
                Shape { outline, lies: RigidMotion { rotation: Matrix3::identity(), translation } }
            };
            sheet.outlines.iter().map(shape).collect()
        }
        Product::Assembly(assembly) => {
            let normals = normals(&assembly.design, State::Closed);
            let [right, away, _] = frame(&normals);
            let pieces = assembly.design.pieces.iter().zip(&normals);
            pieces.map(|(piece, up)| in_space(&piece.closed, up, [right, away])).collect()
        }
    }
}

/// A polygon in space in a frame of its own: x as near to `right` as its plane allows.
fn in_space(polygon: &[Point3], up: &Vector3, [right, away]: [Vector3; 2]) -> Shape {
    let across = |v: Vector3| (v - up * v.dot(up)).try_normalize(1e-3);
    let x = across(right).or_else(|| across(away)).unwrap_or_else(Vector3::x);
    let rotation = Matrix3::from_columns(&[x, up.cross(&x), *up]);
    let lies = RigidMotion { rotation, translation: centroid(polygon).coords };
    let back = lies.inverse();
    let flat = |p: &Point3| {
        let p = back.apply(p);
        [p.x, p.y]
    };
    Shape { outline: polygon.iter().map(flat).collect(), lies }
}

/// The motion `second` after `first`.
fn after(second: &RigidMotion, first: &RigidMotion) -> RigidMotion {
    RigidMotion {
        rotation: second.rotation * first.rotation,
        translation: second.rotation * first.translation + second.translation,
    }
}

/// The steps of the way, or where none was found the two states alone.
fn moments(report: &Report, shapes: &[Shape]) -> Vec<Moment> {
    if let Some(morph) = report.seen.morph {
        let poses = morph.steps.iter().map(|step| &step.poses);
        return way::shares(morph)
            .into_iter()
            .zip(poses)
            .map(|(at, poses)| moment(at, poses, shapes))
            .collect();
    }
    let design = report.product.design();
    let still = vec![RigidMotion::identity(); design.pieces.len()];
    let mut ends = [still, motions(design)];
    if design.sheet_state == Some(State::Open) {
        ends.reverse();
    }
    [0.0, 1.0].into_iter().zip(ends).map(|(at, motions)| moment(at, &motions, shapes)).collect()
}

/// As many moments as the page has room for, evenly, with both ends.
fn chosen(moments: Vec<Moment>) -> Vec<Moment> {
    let pieces = moments[0].poses.len();
    let (last, most) = (moments.len() - 1, (MOST_NUMBERS / POSE / pieces).max(2) - 1);
    let most = most.min(last);
    let kept: Vec<usize> = (0..=most).map(|i| i * last / most).collect();
    let moments = moments.into_iter().enumerate();
    moments.filter(|(i, _)| kept.binary_search(i).is_ok()).map(|(_, moment)| moment).collect()
}

/// `motions`: of each piece from where it lies.
fn moment(at: f64, motions: &[RigidMotion], shapes: &[Shape]) -> Moment {
    let placed: Vec<RigidMotion> =
        motions.iter().zip(shapes).map(|(motion, shape)| after(motion, &shape.lies)).collect();
    let count = placed.len() as f64;
    let turned = nearest_rotation(&placed.iter().map(|pose| pose.rotation).sum()).transpose();
    let middle = placed.iter().map(|pose| pose.translation).sum::<Vector3>() / count;
    let page = RigidMotion { rotation: turned, translation: -(turned * middle) };
    Moment { at, page, poses: placed.iter().map(|pose| after(&page, pose)).collect() }
}

/// Moment by moment, piece by piece: x, y, z, then the quaternion's i, j, k, w, each moment's on the side of the last one's.
fn poses(moments: &[Moment], unit: f64) -> Vec<u8> {
    let mut before: Vec<UnitQuaternion<f64>> = vec![UnitQuaternion::identity(); moments[0].poses.len()];
    let mut bytes = Vec::new();
    for moment in moments {
        for (pose, before) in moment.poses.iter().zip(&mut before) {
            let rotation = Rotation3::from_matrix_unchecked(pose.rotation);
            let quaternion = UnitQuaternion::from_rotation_matrix(&rotation);
            let near = quaternion.coords.dot(&before.coords) >= 0.0;
            *before = if near { quaternion } else { UnitQuaternion::new_unchecked(-quaternion.into_inner()) };
            bytes.extend(encode::rounded(pose.translation.iter().copied(), unit));
            bytes.extend(encode::rounded(before.coords.iter().copied(), 1.0 / f64::from(i16::MAX)));
        }
    }
    bytes
}

/// Row by row, the translation last in each.
fn rows(motion: &RigidMotion) -> Vec<f64> {
    (0..3)
        .flat_map(|i| {
            (0..4).map(move |j| if j < 3 { motion.rotation[(i, j)] } else { motion.translation[i] })
        })
        .collect()
}

/// 0 counter-clockwise, 1 clockwise, 2 neither.
fn turning(design: &Design, product: &Product) -> Vec<u8> {
    let normals = match product {
        Product::Sheet(_) => vec![Vector3::z(); design.pieces.len()],
        Product::Assembly(_) => normals(design, State::Closed),
    };
    let number = |sense| match sense {
        Sense::CounterClockwise => 0,
        Sense::Clockwise => 1,
        Sense::Still => 2,
    };
    senses(design, &normals).into_iter().map(number).collect()
}

/// The largest distance of each piece's vertices from a target, millimetres.
fn distances(design: &Design, targets: &[(State, ClosestPoints)]) -> Value {
    if targets.is_empty() {
        return Value::Null;
    }
    let off = |piece: &Piece| {
        let of = |(state, surface): &(State, ClosestPoints)| {
            piece.vertices(*state).iter().map(|p| surface.distance(p)).fold(0.0, f64::max)
        };
        let most = targets.iter().map(of).fold(0.0, f64::max);
        (most * 1e5).round() / 1e5
    };
    design.pieces.iter().map(off).collect()
}
