//! The material between the grooves at every hinge.
//!
//! The nearest groove to the hinge point gives one wall of the ligament; the other is looked for on the opposite side.
//! The width is that through the hinge point; the neck is the least distance of the two walls over the length that the
//! hinge's angle asks of the ligament, and both walls must be that long.

use kurbo::{Point, Rect, Vec2};
use rayon::prelude::*;

use super::Wanted;
use super::fault::{Check, Fault};
use super::grooves::{Grooves, around};
use super::machine_file::MachineFile;
use crate::fabrication::layout::CutKind;
use crate::fabrication::mechanics::{clearance_length, pole_offset, required_length, strain_length_at};
use crate::fabrication::states::sheet_vertices;
use crate::fabrication::web::{nearest_on_segment, segment_gap};
use crate::kirigami::design::{Hinge, PatternKind, State};
use crate::profile::{Profile, Shape};

/// Largest difference of a ligament's width from the profile's, anywhere along it, millimetres.
pub const WIDTH_TOLERANCE: f64 = 0.01;
/// Largest distance of a ligament's centre from its hinge point beside what the design's own gap forces, millimetres.
pub const CENTRE_TOLERANCE: f64 = 0.01;

/// How much shorter than its angle asks a ligament may be, millimetres: as much as a length is rounded to.
pub(super) const LENGTH_TOLERANCE: f64 = 0.01;
/// How far a ligament's middle may be moved along it, in its widths: the layout does so where sides are too short, and
/// the hinge report warns of it from half of that on.
const SHIFT: f64 = 0.1;
/// How far a wall may lead away from the hinge and still bound the ligament, in ligament widths: the slit that passes
/// bends there, where the sheet has cuts by a large angle.
const WALL_BEND: f64 = 0.5;

/// How much more than the least web may be left beside a bar that was shortened for it, millimetres.
const CROWDED: f64 = 0.02;
/// Cuts that meet are nearer than this, millimetres.
const ON: f64 = 1e-3;

/// Half the angle in which the far wall is looked for: wide enough for a wall that stands askew, and less than a right
/// angle, so that cuts beside the ligament do not count.
const CONE: f64 = 70.0 * std::f64::consts::PI / 180.0;

/// The ligament at one hinge.
#[derive(Debug, Clone, Copy)]
struct Ligament {
    /// Through the hinge point.
    width: f64,
    /// Least distance of the walls.
    neck: f64,
    /// Length of the shorter wall, and the length that the hinge's angle asks for.
    length: [f64; 2],
    /// Twice the least length of a wall to one side of the hinge.
    centred: f64,
    /// Distance of the middle from where it should be.
    off: f64,
    /// Distance of that from the hinge point.
    forced: f64,
}

/// The extremes of all ligaments, millimetres.
pub(super) struct Ligaments {
    /// Least and largest width, least neck.
    pub widths: [f64; 3],
    /// Least and largest free length.
    pub lengths: [f64; 2],
    /// Largest distance of a centre from its hinge, and what of it the design's gap forces.
    pub centre: [f64; 2],
}

/// Measures all ligaments.
pub(super) fn check(
    file: &MachineFile,
    grooves: &Grooves,
    wanted: Wanted,
    faults: &mut Vec<Fault>,
) -> Ligaments {
    let design = wanted.design;
    let width = wanted.profile.ligament.width;
    let forced = forced(wanted);
    let measured: Vec<Result<Ligament, String>> =
        design.hinges.par_iter().map(|hinge| ligament_of(hinge, grooves, wanted, forced)).collect();
    let mut all = Ligaments {
        widths: [f64::INFINITY, 0.0, f64::INFINITY],
        lengths: [f64::INFINITY, 0.0],
        centre: [0.0, forced.abs()],
    };
    for (id, (hinge, ligament)) in design.hinges.iter().zip(measured).enumerate() {
        let says = match ligament {
            Err(reason) => vec![reason],
            Ok(ligament) => {
                let [least, most, neck] = all.widths;
                all.widths = [least.min(ligament.width), most.max(ligament.width), neck.min(ligament.neck)];
                let [shortest, longest] = all.lengths;
                all.lengths = [shortest.min(ligament.length[0]), longest.max(ligament.length[0])];
                all.centre[0] = all.centre[0].max(ligament.off + ligament.forced);
                wrong(ligament, width)
            }
        };
        for says in says {
            let at = Point::new(hinge.point.x, hinge.point.y);
            let [j, k] = hinge.pieces;
            let what = format!("hinge {id} (pieces {j} and {k})");
            faults.push(Fault { hinge: Some(id), ..Fault::new(Check::Ligament, file.name, what, at, says) });
        }
    }
    all
}

/// How much farther from the passing slit the ligaments stand than the hinge points of a closed sheet. Hinges that are
/// closer together than ligaments and grooves need, as in the paper's model without a gap, cannot have them on their
/// points.
fn forced(wanted: Wanted) -> f64 {
    match wanted.design.sheet_state {
        // A nanometre: the gap is the sum of two numbers of the profile.
        Some(State::Closed) => Some(0.5 * (wanted.profile.hinge_gap() - wanted.design.gap)),
        _ => None,
    }
    .filter(|forced| forced.abs() > 1e-6)
    .unwrap_or(0.0)
}

/// The ligament of a hinge: on its point, or, where the design's gap moves it off, on the side of the hinge's pieces.
fn ligament_of(hinge: &Hinge, grooves: &Grooves, wanted: Wanted, forced: f64) -> Result<Ligament, String> {
    let Wanted { design, profile, .. } = wanted;
    let point = Point::new(hinge.point.x, hinge.point.y);
    // Where the angle asks for more than the profile's longest ligament, that one is made, and the hinge fails.
    // A notch is free over what it is drawn out by.
    let length = match profile.ligament.shape {
        Shape::Notch { extra_length } => extra_length,
        Shape::Beam(beam) | Shape::Rounded(beam) => {
            required_length(profile, hinge.angle).unwrap_or(beam.max_length)
        }
    };
    let free = required_length(profile, hinge.angle).unwrap_or(profile.ligament_lengths()[1]);
    let (inwards, pole) = match design.sheet_state {
        Some(State::Closed) => (inwards(hinge, grooves, wanted), pole_offset(profile, free, hinge.angle)),
        Some(State::Open) if design.pattern != PatternKind::Bistable => {
            (away_from_closing(hinge, grooves, wanted), pole_offset(profile, free, hinge.angle))
        }
        _ => (None, 0.0),
    };
    // So that it turns about its point, the bent ligament's middle stands off it.
    let point = point + pole * inwards.unwrap_or_default();
    let here = measure(grooves, point, length, profile);
    let free = here.as_ref().map_or(length, |found| found.length[0]);
    if free < length - LENGTH_TOLERANCE && is_crowded(grooves, point, profile) {
        // The bar gave way to its neighbours, as far as the material bears it.
        let least = strain_length_at(profile, profile.material.elongation, hinge.angle);
        let least = least.max(clearance_length(profile, hinge.angle)).max(free);
        return measure(grooves, point, least.min(length), profile);
    }
    if forced == 0.0 || here.as_ref().is_ok_and(|found| wrong(*found, profile.ligament.width).is_empty()) {
        return here;
    }
    let Some(inwards) = inwards else { return here };
    Ok(Ligament { forced: forced.abs(), ..measure(grooves, point + forced * inwards, length, profile)? })
}

/// Whether the relief bar beside a ligament is as near to another cut as the process allows.
fn is_crowded(grooves: &Grooves, point: Point, profile: &Profile) -> bool {
    let reach = 2.0 * profile.ligament.width + profile.cut.kerf;
    let is_bar = |&segment: &usize| grooves.paths[grooves.segments[segment].path].kind == CutKind::Relief;
    let foot = |segment: usize| nearest_on_segment(point, grooves.segments[segment].ends).distance(point);
    let bars = grooves.near(around(point, reach)).filter(is_bar);
    let Some(bar) = bars.min_by(|&a, &b| foot(a).total_cmp(&foot(b)).then(a.cmp(&b))) else { return false };
    let bar = &grooves.segments[bar];
    let most = profile.cut.min_web + profile.cut.kerf + CROWDED;
    let place = Rect::from_points(bar.ends[0], bar.ends[1]).inflate(most, most);
    let others = grooves.near(place).map(|other| &grooves.segments[other]);
    let gaps = others.filter(|other| other.path != bar.path).map(|other| segment_gap(bar.ends, other.ends).0);
    // The slit that ends on the bar touches it.
    gaps.into_iter().any(|gap| gap > ON && gap < most)
}

/// A unit vector square to the groove that is nearest to a point; `None` without one.
fn across(point: Point, grooves: &Grooves) -> Option<Vec2> {
    let [from, to] = grooves.segments[grooves.nearest(point)?.1].ends;
    let foot = nearest_on_segment(point, [from, to]);
    // A round end stands opposite; on a groove that runs over the point there is no way to its foot.
    Some(if foot.distance(point) > 1e-6 { foot - point } else { (to - from).turn_90() }.normalize())
}

/// The unit vector square to the groove that is nearest to a hinge point, towards the hinge's pieces; `None` without one.
fn inwards(hinge: &Hinge, grooves: &Grooves, wanted: Wanted) -> Option<Vec2> {
    let design = wanted.design;
    let point = Point::new(hinge.point.x, hinge.point.y);
    let across = across(point, grooves)?;
    let vertices = hinge.pieces.iter().flat_map(|&piece| sheet_vertices(design, &design.pieces[piece]));
    let inwards: f64 = vertices.map(|vertex| across.dot(Point::new(vertex.x, vertex.y) - point)).sum();
    Some(inwards.signum() * across)
}

/// That vector on a sheet that is cut open, away from the window that closes. About an axis that points up piece k turns
/// counter-clockwise as piece j sees it, away from the window on the right of the way from j to k.
fn away_from_closing(hinge: &Hinge, grooves: &Grooves, wanted: Wanted) -> Option<Vec2> {
    let point = Point::new(hinge.point.x, hinge.point.y);
    let across = across(point, grooves)?;
    let towards = |piece: usize| {
        let vertices = sheet_vertices(wanted.design, &wanted.design.pieces[piece]);
        vertices.iter().map(|vertex| Point::new(vertex.x, vertex.y) - point).sum::<Vec2>().normalize()
    };
    let [j, k] = hinge.pieces.map(towards);
    Some((-hinge.axis.z * across.dot((k - j).turn_90())).signum() * across)
}

fn wrong(ligament: Ligament, width: f64) -> Vec<String> {
    let Ligament { width: found, neck, length: [length, needed], centred, off, forced } = ligament;
    let mut says = Vec::new();
    if (found - width).abs() > WIDTH_TOLERANCE {
        says.push(format!(
            "the ligament is {found:.3} mm wide, the limit is {width} +- {WIDTH_TOLERANCE} mm"
        ));
    } else if width - neck > WIDTH_TOLERANCE {
        let limit = width - WIDTH_TOLERANCE;
        says.push(format!("the ligament is {neck:.3} mm wide at its neck, the limit is {limit:.3} mm"));
    }
    if length < needed - LENGTH_TOLERANCE {
        says.push(format!(
            "the ligament is free over {length:.3} mm, its angle needs {needed:.3} mm, the limit is {LENGTH_TOLERANCE} mm less"
        ));
    }
    let shift = 0.5 * (needed - centred);
    if shift > SHIFT * width + LENGTH_TOLERANCE {
        let limit = SHIFT * width + LENGTH_TOLERANCE;
        says.push(format!(
            "the ligament is {shift:.3} mm too short to one side of the hinge, the limit is {limit:.3} mm"
        ));
    }
    if off > CENTRE_TOLERANCE {
        let place = if forced > 0.0 {
            "the place beside the hinge point that the design's gap leaves it"
        } else {
            "the hinge point"
        };
        says.push(format!(
            "the ligament's centre is {off:.3} mm off {place}, the limit is {CENTRE_TOLERANCE} mm"
        ));
    }
    says
}

/// The ligament of the given length at a point.
fn measure(grooves: &Grooves, point: Point, length: f64, profile: &Profile) -> Result<Ligament, String> {
    let half_kerf = 0.5 * profile.cut.kerf;
    let reach = 4.0 * profile.ligament.width + half_kerf;
    let place = around(point, reach.max(length));
    let near: Vec<[Point; 2]> = grooves.near(place).map(|segment| grooves.segments[segment].ends).collect();
    let foot = |&segment: &[Point; 2]| nearest_on_segment(point, segment);
    // Ties by place: the index has no order.
    let order = |a: &Point, b: &Point| {
        let distances = a.distance_squared(point).total_cmp(&b.distance_squared(point));
        distances.then(a.x.total_cmp(&b.x)).then(a.y.total_cmp(&b.y))
    };
    let Some(first) = near.iter().map(foot).min_by(order).filter(|first| first.distance(point) <= reach)
    else {
        return Err(format!(
            "no cut is within {reach:.2} mm of the hinge point: the ligament is not cut free"
        ));
    };
    let near_distance = first.distance(point) - half_kerf;
    if near_distance <= 0.0 {
        let distance = first.distance(point);
        return Err(format!(
            "the ligament is cut through: its middle is burned, {distance:.3} mm from a cut, the limit is {half_kerf} mm"
        ));
    }
    let side = (first - point).normalize();
    let beyond = near.iter().filter_map(|&segment| in_cone(segment, point, -side));
    let far_distance =
        beyond.map(|part| foot(&part).distance(point)).fold(f64::INFINITY, f64::min) - half_kerf;
    if far_distance > reach {
        return Err(format!(
            "no cut is within {reach:.2} mm on one side of the hinge point: the ligament is not cut free"
        ));
    }
    let band = WALL_BEND * profile.ligament.width;
    let walls = [(side, near_distance), (-side, far_distance)].map(|(side, distance)| {
        let middle = point + (distance + half_kerf) * side;
        let [before, after] = wall(&near, middle, side, band).map(|length| length + half_kerf);
        [before + after, 2.0 * before.min(after)]
    });
    let [[first_length, first_centred], [second_length, second_centred]] = walls;
    let [first, second] = [side, -side].map(|side| -> Vec<[Point; 2]> {
        near.iter().filter_map(|&segment| clipped(segment, point, side, 0.5 * length)).collect()
    });
    let gaps = first.iter().flat_map(|&a| second.iter().map(move |&b| segment_gap(a, b).0));
    let width = near_distance + far_distance;
    let neck = (gaps.fold(f64::INFINITY, f64::min) - 2.0 * half_kerf).min(width);
    let off = 0.5 * (far_distance - near_distance).abs();
    Ok(Ligament {
        width,
        neck,
        length: [first_length.min(second_length), length],
        centred: first_centred.min(second_centred),
        off,
        forced: 0.0,
    })
}

/// The lengths by which a wall goes on to both sides of its middle, within a band about it.
fn wall(near: &[[Point; 2]], middle: Point, side: Vec2, band: f64) -> [f64; 2] {
    let along = side.turn_90();
    let strip = [(middle - band * side, side), (middle + band * side, -side)];
    let parts = near.iter().filter_map(|&segment| {
        strip.into_iter().try_fold(segment, |segment, (origin, normal)| half_plane(segment, origin, normal))
    });
    let mut spans: Vec<[f64; 2]> = parts
        .map(|part| part.map(|end| (end - middle).dot(along)))
        .map(|[a, b]| [a.min(b), a.max(b)])
        .collect();
    spans.sort_by(|a, b| a[0].total_cmp(&b[0]));
    // The spans that hang together about the middle.
    let mut wall = [0.0_f64; 2];
    for [from, to] in spans.iter().filter(|[_, to]| *to >= -1e-6) {
        if *from <= wall[1] + 1e-6 {
            wall[1] = wall[1].max(*to);
        }
    }
    spans.sort_by(|a, b| b[1].total_cmp(&a[1]));
    for [from, to] in spans.iter().filter(|[from, _]| *from <= 1e-6) {
        if *to >= wall[0] - 1e-6 {
            wall[0] = wall[0].min(*from);
        }
    }
    [-wall[0], wall[1]]
}

/// The part of a segment in the cone about a direction.
fn in_cone(segment: [Point; 2], point: Point, axis: Vec2) -> Option<[Point; 2]> {
    let (sine, cosine) = CONE.sin_cos();
    // Inward normals of the cone's two sides.
    let normals = [1.0, -1.0].map(|sign| sine * axis + sign * cosine * axis.turn_90());
    normals.into_iter().try_fold(segment, |segment, normal| half_plane(segment, point, normal))
}

/// The part of a segment on one side of a point, within `half` along the ligament.
fn clipped(segment: [Point; 2], point: Point, side: Vec2, half: f64) -> Option<[Point; 2]> {
    let along = side.turn_90();
    let strip = [(point, side), (point - half * along, along), (point + half * along, -along)];
    strip.into_iter().try_fold(segment, |segment, (origin, normal)| half_plane(segment, origin, normal))
}

/// The part of a segment where (p - origin) . normal >= 0.
fn half_plane([a, b]: [Point; 2], origin: Point, normal: Vec2) -> Option<[Point; 2]> {
    let [s, t] = [a, b].map(|p| (p - origin).dot(normal));
    match (s >= 0.0, t >= 0.0) {
        (true, true) => Some([a, b]),
        (false, false) => None,
        (true, false) => Some([a, a.lerp(b, s / (s - t))]),
        (false, true) => Some([a.lerp(b, s / (s - t)), b]),
    }
}
