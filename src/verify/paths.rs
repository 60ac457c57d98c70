//! The cuts as such: numbers, order, the stock, and what stands between them.

use kurbo::{Point, Rect};
use rstar::RTree;

use super::contacts::{Contacts, Pair};
use super::cut_name;
use super::fault::{Check, Fault};
use super::grooves::{Grooves, around};
use super::machine_file::{MachineFile, layer_name};
use super::{Wanted, hinge_points};
use crate::fabrication::cuts::{bounding_box, ends};
use crate::fabrication::layout::{CutKind, CutPath};
use crate::profile::Profile;

/// Shortest segment, millimetres. On shorter ones a machine stutters, and programs that import with a tolerance
/// weld their ends.
pub(super) const SHORTEST: f64 = 0.01;
/// Two cuts may run along each other for this long, millimetres: so much do cuts share that meet at a degree.
pub(super) const SHARED: f64 = 0.06;
/// What rounding may take of a web or of the stock's margin, millimetres.
const ROUNDING: f64 = 1e-3;
/// Coordinates beyond this are no place on any machine, millimetres.
const FAR: f64 = 1e5;
/// How far a slit may end from the centre line of the cut that it meets, or beyond the border's, millimetres.
pub(super) const END_TOLERANCE: f64 = 0.01;

/// Every number finite and within any machine's reach; every cut with a segment.
pub(super) fn check_numbers(file: &MachineFile) -> Vec<Fault> {
    let mut faults = Vec::new();
    for (index, path) in file.paths.iter().enumerate() {
        let bad = path.vertices.iter().position(|v| {
            let sizes = [v.point.x.abs(), v.point.y.abs(), v.bulge.abs()];
            !sizes.iter().all(|&size| size < FAR)
        });
        if let Some(vertex) = bad {
            let v = path.vertices[vertex];
            let says = format!(
                "vertex {vertex} is ({}, {}) with bulge {}, which is not finite or beyond {FAR} mm",
                v.point.x, v.point.y, v.bulge
            );
            faults.push(file.cut_fault(Check::Numbers, index, None, says));
        } else if path.vertices.len() < 2 {
            let says = format!("has {} vertices, a cut needs 2", path.vertices.len());
            faults.push(file.cut_fault(Check::Numbers, index, None, says));
        }
    }
    faults
}

/// Whether there is anything to measure: a stock has room for cuts of a certain length side by side, and cuts that are
/// further away than it is large are not on it. Measuring them would take time and memory without end.
pub(super) fn check_extent(file: &MachineFile, profile: &Profile, faults: &mut Vec<Fault>) -> bool {
    let sheet = &profile.sheet;
    let (length, room) = (file.paths.iter().map(CutPath::length).sum::<f64>(), sheet.width * sheet.height);
    let longest = 2.0 * room / profile.cut.min_web + 4.0 * (sheet.width + sheet.height);
    if length > longest {
        let says = format!(
            "are {length:.0} mm long together, the stock of {} x {} mm has room for {longest:.0} mm",
            sheet.width, sheet.height
        );
        faults.push(Fault::new(Check::Stock, file.name, "the cuts", None, says));
        return false;
    }
    let beyond = sheet.width + sheet.height;
    let far = |at: Point| {
        at.x < -beyond || at.y < -beyond || at.x > sheet.width + beyond || at.y > sheet.height + beyond
    };
    for (index, path) in file.paths.iter().enumerate() {
        if let Some(vertex) = path.vertices.iter().find(|vertex| far(vertex.point)) {
            let says = format!("lies far outside of the stock of {} x {} mm", sheet.width, sheet.height);
            faults.push(file.cut_fault(Check::Stock, index, vertex.point, says));
            return false;
        }
    }
    true
}

/// Number and length of the cuts per layer.
pub(super) fn cuts(paths: &[CutPath]) -> Vec<(&'static str, usize, f64)> {
    let of = |kind: CutKind| {
        let all: Vec<_> = paths.iter().filter(|path| path.kind == kind).collect();
        (layer_name(kind), all.len(), all.iter().map(|path| path.length()).sum())
    };
    let kinds = [CutKind::Slit, CutKind::Relief, CutKind::Window, CutKind::Border, CutKind::Lead];
    kinds.into_iter().map(of).filter(|(_, count, _)| *count > 0).collect()
}

/// Least distance of the grooves from the stock's edge.
pub(super) fn check_stock(file: &MachineFile, profile: &Profile, faults: &mut Vec<Fault>) -> f64 {
    let (sheet, half) = (&profile.sheet, 0.5 * profile.cut.kerf);
    let distance = |part: Rect| {
        [part.x0, part.y0, sheet.width - part.x1, sheet.height - part.y1]
            .into_iter()
            .fold(f64::INFINITY, f64::min)
            - half
    };
    for (index, path) in file.paths.iter().enumerate() {
        let part = bounding_box(std::slice::from_ref(path));
        if distance(part) < sheet.margin - ROUNDING {
            let says = format!(
                "is {:.3} mm from the edge of the stock of {} x {} mm, the limit is {} mm",
                distance(part),
                sheet.width,
                sheet.height,
                sheet.margin
            );
            faults.push(file.cut_fault(Check::Stock, index, part.center(), says));
        }
    }
    distance(bounding_box(&file.paths))
}

/// Length of the shortest segment.
pub(super) fn check_segments(file: &MachineFile, faults: &mut Vec<Fault>) -> f64 {
    let mut shortest = f64::INFINITY;
    for (index, path) in file.paths.iter().enumerate() {
        let count = path.vertices.len();
        for i in 0..if path.closed { count } else { count - 1 } {
            let (from, to) = (path.vertices[i], path.vertices[(i + 1) % count].point);
            let length = from.point.distance(to);
            shortest = shortest.min(length);
            if length < SHORTEST {
                let says = format!("segment {i} is {length:.6} mm long, the least is {SHORTEST} mm");
                faults.push(file.cut_fault(Check::Segment, index, from.point, says));
            }
        }
    }
    shortest
}

/// One closed border for each of `wanted` parts, the last cuts. Windows are closed too, slits and relief bars open. Whether
/// the borders are of use.
pub(super) fn check_borders(file: &MachineFile, wanted: usize, faults: &mut Vec<Fault>) -> bool {
    let paths = &file.paths;
    for (index, path) in paths.iter().enumerate() {
        let contour = matches!(path.kind, CutKind::Window | CutKind::Border);
        if contour != path.closed {
            let [first, last] = [0, path.vertices.len() - 1].map(|i| path.vertices[i].point);
            let says = match contour {
                true => format!("is open: its ends are {:.3} mm apart, they must meet", first.distance(last)),
                false => "is closed: what it goes round falls out".to_owned(),
            };
            faults.push(Fault::new(Check::Border, file.name, cut_name(paths, index), first, says));
        }
    }
    let borders: Vec<usize> = (0..paths.len()).filter(|&i| paths[i].kind == CutKind::Border).collect();
    if borders.len() != wanted {
        let says = format!("{} cuts are on BORDER, there must be {wanted}", borders.len());
        faults.push(Fault::new(Check::Border, file.name, "the border", None, says));
        return false;
    }
    let first = paths.len() - wanted;
    for &border in borders.iter().filter(|&&border| border < first) {
        let says = format!(
            "is cut {border} of {}; it must be the last, as nothing holds the part after it",
            paths.len()
        );
        faults.push(file.cut_fault(Check::Border, border, None, says));
    }
    borders.iter().all(|&border| border >= first && paths[border].closed)
}

/// Cuts that are made twice, that run along each other or come too near; the least web between cuts that do not meet.
pub(super) fn check_webs(
    file: &MachineFile,
    contacts: &Contacts,
    profile: &Profile,
    faults: &mut Vec<Fault>,
) -> f64 {
    let paths = &file.paths;
    let (kerf, limit) = (profile.cut.kerf, profile.cut.min_web);
    let mut web = f64::INFINITY;
    for &Pair { paths: [a, b], gap, at, contact, shared } in contacts.pairs.iter().chain(&contacts.folded) {
        let [first, second] = [a, b].map(|path| cut_name(paths, path));
        if shared > SHARED {
            // What is less than the limit longer than the shared part is the same cut, in whatever direction.
            let twice = a != b && paths[a].length().max(paths[b].length()) - shared < SHARED;
            let (check, says) = match twice {
                true => (
                    Check::Duplicate,
                    format!("is cut twice, as {first} and over again as {second}, {shared:.3} mm"),
                ),
                false => (
                    Check::Overlap,
                    format!(
                        "{first} and {second} run along each other for {shared:.3} mm, the limit is {SHARED} mm"
                    ),
                ),
            };
            faults.push(Fault::new(check, file.name, second, at, says));
        } else if a != b && contact.is_none() {
            web = web.min(gap - kerf);
            if gap - kerf < limit - ROUNDING {
                let says = format!("leaves {:.3} mm to {second}, the limit is {limit} mm", gap - kerf);
                faults.push(Fault::new(Check::Web, file.name, first, at, says));
            }
        }
    }
    web
}

/// Every slit ends on another cut, within the border, or beside a hinge.
pub(super) fn check_free_ends(
    file: &MachineFile,
    grooves: &Grooves,
    wanted: Wanted,
    kerf: f64,
    faults: &mut Vec<Fault>,
) {
    let hinges: Vec<[f64; 2]> = hinge_points(wanted.design).map(|point| [point.x, point.y]).collect();
    let hinges = RTree::bulk_load(hinges);
    // A slit without a bar ends half a ligament and half a kerf from the hinge, as far as the ligament's own checks allow.
    let beside = 0.5 * (wanted.profile.ligament.width + kerf) + 0.1 * wanted.profile.ligament.width;
    for (index, end) in ends(&file.paths).filter(|(index, _)| file.paths[*index].kind == CutKind::Slit) {
        let meets = |segment: usize| {
            let segment = &grooves.segments[segment];
            let foot = crate::fabrication::web::nearest_on_segment(end, segment.ends);
            segment.path != index && foot.distance(end) <= END_TOLERANCE
        };
        if grooves.near(around(end, END_TOLERANCE)).any(meets) {
            continue;
        }
        let hinge = hinges.nearest_neighbor(&[end.x, end.y]);
        let distance = hinge.map_or(f64::INFINITY, |&[x, y]| end.distance(Point::new(x, y)));
        if distance > beside {
            let says = format!(
                "ends {:.3} mm beside the next cut, and {distance:.3} mm from the nearest hinge; it must meet a cut to within \
                 {END_TOLERANCE} mm or end beside a hinge",
                next_cut(grooves, index, end)
            );
            faults.push(file.cut_fault(Check::End, index, end, says));
        }
    }
}

/// Distance from a point to the nearest other cut within 10 mm, or that.
fn next_cut(grooves: &Grooves, index: usize, end: Point) -> f64 {
    let distances = grooves
        .near(around(end, 10.0))
        .filter(|&s| grooves.segments[s].path != index)
        .map(|s| crate::fabrication::web::nearest_on_segment(end, grooves.segments[s].ends).distance(end));
    distances.fold(10.0, f64::min)
}
