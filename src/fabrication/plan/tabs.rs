//! Tabs: short stretches of the border that are not cut, so that the part stays in the sheet.

use kurbo::{Point, Vec2};

use super::TabWish;
use super::error::PlanError;
use crate::fabrication::cuts::ARC_TOLERANCE;
use crate::fabrication::layout::{CutKind, CutPath, PathVertex, Tabs};
use crate::fabrication::web::CutIndex;
use crate::profile::Profile;

/// Distance between places that are looked at, millimetres.
const STEP: f64 = 1.0;
/// Straight cut that is left on either side of a tab, millimetres.
const SHOULDER: f64 = 0.5;
/// A tab at least this far from slits and ligaments is far enough, millimetres: breaking it bends nothing there.
const CLEAR: f64 = 3.5;
/// Ways of starting the even division that are tried.
const PHASES: usize = 32;

/// A place for a tab: its way along the border, and where that is.
#[derive(Debug, Clone, Copy)]
struct Place {
    way: f64,
    point: Point,
}

/// Places for the tabs of a part, spread evenly over its border, on straight stretches well away from everything else that
/// is cut and from the hinges.
///
/// # Errors
/// More tabs than there are such places.
pub fn places(
    paths: &[CutPath],
    hinges: &[Point],
    wish: &TabWish,
    profile: &Profile,
) -> Result<Tabs, PlanError> {
    let gap = wish.width + profile.cut.kerf;
    let (borders, inner): (Vec<CutPath>, Vec<CutPath>) =
        paths.iter().cloned().partition(|path| path.kind == CutKind::Border);
    let (inner, hinges) =
        (CutIndex::new(&inner), rstar::RTree::bulk_load(hinges.iter().map(|p| [p.x, p.y]).collect()));
    let clearance = |point: Point| {
        let hinge = hinges.nearest_neighbor(&[point.x, point.y]);
        let hinge = hinge.map_or(f64::INFINITY, |&[x, y]| point.distance(Point::new(x, y)));
        inner.nearest([point, point], &[]).min(hinge) - 0.5 * gap
    };
    let (around, candidates) =
        borders.iter().map(|border| straight_places(border, gap)).next().unwrap_or_default();
    let clear: Vec<f64> = candidates.iter().map(|place| clearance(place.point)).collect();
    let best = clear.iter().copied().fold(0.0, f64::max);
    // Never nearer than a ligament's width and length, on small parts half of what is possible.
    let least = profile.ligament.width + 0.5 * profile.ligament_lengths()[1];
    let limit = least.max(CLEAR.min(0.5 * best));
    let good: Vec<Place> = candidates
        .iter()
        .zip(&clear)
        .filter(|(_, clear)| **clear >= limit)
        .map(|(place, _)| *place)
        .collect();
    match spread(&good, around, wish.count) {
        Some(chosen) => {
            Ok(Tabs { places: chosen.iter().map(|place| place.point).collect(), width: wish.width })
        }
        None => {
            let fit =
                (1..wish.count).rev().find(|&count| spread(&good, around, count).is_some()).unwrap_or(0);
            Err(PlanError::TooManyTabs { tabs: wish.count, fit, width: wish.width, clear: limit })
        }
    }
}

/// The border's length, and places on its straight segments where a tab of this gap has shoulders.
fn straight_places(border: &CutPath, gap: f64) -> (f64, Vec<Place>) {
    let mut way = 0.0;
    let mut found = Vec::new();
    let count = border.vertices.len();
    for i in 0..count {
        let part = CutPath {
            kind: CutKind::Border,
            vertices: vec![border.vertices[i], PathVertex { bulge: 0.0, ..border.vertices[(i + 1) % count] }],
            closed: false,
        };
        let length: f64 = part.segments(ARC_TOLERANCE).iter().map(|[a, b]| a.distance(*b)).sum();
        let room = length - gap - 2.0 * SHOULDER;
        if border.vertices[i].bulge == 0.0 && room >= 0.0 {
            let [from, to] = [0, 1].map(|k| part.vertices[k].point);
            let steps = (room / STEP).floor() as usize;
            found.extend((0..=steps).map(|k| {
                let at = 0.5 * length + (k as f64 - 0.5 * steps as f64) * STEP;
                Place { way: way + at, point: from.lerp(to, at / length) }
            }));
        }
        way += length;
    }
    (way, found)
}

/// So many of the places, as evenly as possible: each less than a quarter of their distance from where it should be.
fn spread(places: &[Place], around: f64, count: usize) -> Option<Vec<Place>> {
    if places.is_empty() {
        return None;
    }
    let pitch = around / count as f64;
    let nearest = |way: f64| -> (f64, Place) {
        let after = places.partition_point(|place| place.way < way);
        let beside = [after + places.len() - 1, after].map(|i| places[i % places.len()]);
        let off = |place: &Place| {
            let off = (place.way - way).rem_euclid(around);
            off.min(around - off)
        };
        let [a, b] = beside;
        if off(&a) <= off(&b) { (off(&a), a) } else { (off(&b), b) }
    };
    let division = |phase: usize| -> (f64, Vec<Place>) {
        let start = pitch * phase as f64 / PHASES as f64;
        let chosen: Vec<(f64, Place)> =
            (0..count).map(|k| nearest((start + pitch * k as f64).rem_euclid(around))).collect();
        let worst = chosen.iter().map(|(off, _)| *off).fold(0.0, f64::max);
        (worst, chosen.into_iter().map(|(_, place)| place).collect())
    };
    let (worst, mut chosen) = (0..PHASES).map(division).min_by(|a, b| a.0.total_cmp(&b.0))?;
    chosen.sort_by(|a, b| a.way.total_cmp(&b.way));
    (worst < 0.25 * pitch || count == 1).then_some(chosen)
}

/// The stretches of a border between tabs, in its sense, the first from the tab nearest to where it begins. `by`: from the
/// first copy.
pub fn stretches(border: &CutPath, tabs: &Tabs, by: Vec2, kerf: f64) -> Vec<CutPath> {
    let half = 0.5 * (tabs.width + kerf);
    let vertices = &border.vertices;
    let next = |i: usize| vertices[(i + 1) % vertices.len()].point;
    // Segment, way along it, direction.
    let mut gaps: Vec<(usize, f64, Point, Vec2)> = tabs
        .places
        .iter()
        .filter_map(|&place| {
            let place = place + by;
            let straight = (0..vertices.len()).filter(|&i| vertices[i].bulge == 0.0);
            let off = |&i: &usize| {
                let foot = crate::fabrication::web::nearest_on_segment(place, [vertices[i].point, next(i)]);
                foot.distance(place)
            };
            let segment = straight.min_by(|a, b| off(a).total_cmp(&off(b)))?;
            let from = vertices[segment].point;
            Some((segment, from.distance(place), place, (next(segment) - from).normalize()))
        })
        .collect();
    gaps.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let begin = vertices[0].point;
    let first =
        (0..gaps.len()).min_by(|&a, &b| gaps[a].2.distance(begin).total_cmp(&gaps[b].2.distance(begin)));
    gaps.rotate_left(first.unwrap_or(0));
    let straight = |point: Point| PathVertex { point, bulge: 0.0 };
    let stretch = |k: usize| {
        let ((from, way, start, out), (to, until, end, into)) = (gaps[k], gaps[(k + 1) % gaps.len()]);
        // Once round where there is one tab, or the next is behind this one on the same segment.
        let round =
            if from == to && until > way { 0 } else { (to + vertices.len() - from - 1) % vertices.len() + 1 };
        let between = (1..=round).map(|step| vertices[(from + step) % vertices.len()]);
        let mut all = vec![straight(start + half * out)];
        all.extend(between);
        all.push(straight(end - half * into));
        CutPath { kind: CutKind::Border, vertices: all, closed: false }
    };
    (0..gaps.len()).map(stretch).collect()
}
