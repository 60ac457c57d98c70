//! The sheet at one height: walls, grooves and ligaments.

use kurbo::{Point, Vec2};
use rstar::primitives::{GeomWithData, Line};
use rstar::{AABB, RTree};

use super::finding::{Finding, Trouble};
use super::section::{Counted, Section, sections};
use super::{Move, NECK_LIMIT, Neck, Wanted};
use crate::fabrication::web::{nearest_on_segment, segment_gap};
use crate::geometry::Point3;
use crate::geometry::mesh::TriMesh;

/// Walls are looked at in steps of this, millimetres.
const STEP: f64 = 0.25;

/// Of sides shorter than that every third is looked at: they are parts of one round or of one ruled wall.
const SHORT: f64 = 0.1;

/// Half the angle of the cone in which a ligament's other wall is looked for, radians.
const CONE: f64 = 1.0;

type Lines = RTree<GeomWithData<Line<[f64; 2]>, usize>>;

/// The worst of something and its place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Worst {
    /// How much.
    pub value: f64,
    /// Where.
    pub at: Point,
    /// The move, where there is one.
    pub step: Option<usize>,
}

impl Worst {
    const NONE: Worst = Worst { value: 0.0, at: Point::ORIGIN, step: None };

    fn take(&mut self, value: f64, at: Point, step: Option<usize>) {
        if value > self.value {
            *self = Worst { value, at, step };
        }
    }

    /// As a finding.
    pub fn finding(&self, trouble: Trouble, height: f64, limit: f64) -> Finding {
        let at = Point3::new(self.at.x, self.at.y, height);
        Finding { trouble, at, value: self.value, limit, hinge: None, step: self.step }
    }
}

/// A ligament at one height.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Found {
    /// Its place among those that are wanted.
    pub neck: usize,
    /// Width through the axis; infinite where a wall is missing.
    pub width: f64,
    /// Distance of its middle from the axis.
    pub off: f64,
    /// Where the axis is.
    pub at: Point,
}

/// The sheet at one height.
#[derive(Debug, Clone, PartialEq)]
pub struct Slice {
    /// Height above the top of the stock.
    pub height: f64,
    /// How far the tool cuts into the part.
    pub gouge: Worst,
    /// How much it leaves on its walls.
    pub leftover: Worst,
    /// The ligaments.
    pub necks: Vec<Found>,
}

impl Slice {
    /// Measures the sheet at a height.
    pub fn new(moves: &[Move], z: f64, wanted: &Wanted) -> Self {
        let above_middle = z + 0.5 * wanted.thickness;
        let walls = walls(wanted.part, above_middle);
        let touched = sections(moves, z, wanted.radius, Counted::Touched);
        let gouge = gouge(&touched, &walls, wanted.radius);
        drop(touched);
        let cleared = sections(moves, z, wanted.radius, Counted::Cleared);
        let grooves = tree(cleared.iter().map(|section| section.ends));
        let leftover = leftover(&walls, &cleared, &grooves, above_middle, wanted);
        let find = |place: usize| {
            let neck = &wanted.necks[place];
            found(neck, place, (&cleared, &grooves), above_middle, wanted.radius)
        };
        Self { height: z, gouge, leftover, necks: (0..wanted.necks.len()).map(find).collect() }
    }

    /// The ligaments that are off.
    pub fn neck_findings(&self, wanted: &Wanted) -> Vec<Finding> {
        let mut findings = Vec::new();
        for found in &self.necks {
            let neck = &wanted.necks[found.neck];
            let at = Point3::new(found.at.x, found.at.y, self.height);
            let mut tell = |trouble, value: f64, limit| {
                if value > limit {
                    findings.push(Finding { trouble, at, value, limit, hinge: Some(neck.id), step: None });
                }
            };
            tell(Trouble::NeckWidth, (found.width - neck.width).abs(), NECK_LIMIT);
            tell(Trouble::NeckCentre, found.off, NECK_LIMIT + neck.told);
        }
        findings
    }
}

/// The lines in which the part's walls meet the plane at a height above mid-plane.
fn walls(part: &TriMesh, height: f64) -> Vec<[Point; 2]> {
    let mut lines = Vec::new();
    for triangle in part.triangles() {
        let above = triangle.map(|corner| corner.z >= height);
        if above[0] == above[1] && above[1] == above[2] {
            continue;
        }
        let ends = [0, 1, 2].map(|i| {
            let [a, b] = [triangle[i], triangle[(i + 1) % 3]];
            (above[i] != above[(i + 1) % 3]).then(|| {
                let cut = a + (b - a) * ((height - a.z) / (b.z - a.z));
                Point::new(cut.x, cut.y)
            })
        });
        let mut ends = ends.into_iter().flatten();
        lines.extend(ends.next().zip(ends.next()).map(|(a, b)| [a, b]));
    }
    lines
}

fn tree(lines: impl Iterator<Item = [Point; 2]>) -> Lines {
    let line =
        |(index, [a, b]): (usize, [Point; 2])| GeomWithData::new(Line::new([a.x, a.y], [b.x, b.y]), index);
    RTree::bulk_load(lines.enumerate().map(line).collect())
}

fn around([a, b]: [Point; 2], reach: f64) -> AABB<[f64; 2]> {
    let low = [a.x.min(b.x) - reach, a.y.min(b.y) - reach];
    let high = [a.x.max(b.x) + reach, a.y.max(b.y) + reach];
    AABB::from_corners(low, high)
}

/// How far from its axis a tilted tool reaches in a unit direction.
fn reach(radius: f64, lean: Vec2, direction: Vec2) -> f64 {
    radius * 1.0_f64.hypot(lean.dot(direction))
}

/// How far the sections' tools reach into the walls.
fn gouge(sections: &[Section], walls: &[[Point; 2]], radius: f64) -> Worst {
    let sides = tree(walls.iter().copied());
    let mut worst = Worst::NONE;
    for section in sections {
        let most = radius * 1.0_f64.hypot(section.lean.hypot());
        for side in sides.locate_in_envelope_intersecting(&around(section.ends, most)) {
            let wall = walls[side.data];
            let (gap, at) = segment_gap(section.ends, wall);
            if gap >= most {
                continue;
            }
            let far = nearest_on_segment(at, wall) - nearest_on_segment(at, section.ends);
            let towards = if far.hypot() > 0.0 { far.normalize() } else { Vec2::ZERO };
            worst.take(reach(radius, section.lean, towards) - gap, at, Some(section.step));
        }
        // A tool that comes down inside the part may be far from any wall.
        if !section.goes_on && inside(section.ends[0], &sides, walls) {
            let away = sides.nearest_neighbor(&[section.ends[0].x, section.ends[0].y]).map_or(0.0, |side| {
                nearest_on_segment(section.ends[0], walls[side.data]).distance(section.ends[0])
            });
            worst.take(radius + away, section.ends[0], Some(section.step));
        }
    }
    worst
}

/// Whether a point is in the part: an odd number of walls to its right.
fn inside(point: Point, sides: &Lines, walls: &[[Point; 2]]) -> bool {
    let ray = AABB::from_corners([point.x, point.y], [1e9, point.y]);
    let crossed = sides.locate_in_envelope_intersecting(&ray).filter(|side| {
        let [a, b] = walls[side.data];
        (a.y > point.y) != (b.y > point.y) && point.x < a.x + (point.y - a.y) / (b.y - a.y) * (b.x - a.x)
    });
    crossed.count() % 2 == 1
}

/// How much the cleared grooves leave on the walls.
fn leftover(
    walls: &[[Point; 2]],
    sections: &[Section],
    grooves: &Lines,
    above_middle: f64,
    wanted: &Wanted,
) -> Worst {
    let mut worst = Worst::NONE;
    let tabs: Vec<_> = wanted.tabs.iter().filter(|tab| above_middle < tab.top + wanted.radius).collect();
    for (side, &[a, b]) in walls.iter().enumerate() {
        if a.distance(b) < SHORT && side % 3 > 0 {
            continue;
        }
        let count = (a.distance(b) / STEP).ceil().max(1.0);
        for i in 0..count as usize {
            let point = a.lerp(b, i as f64 / count);
            if tabs.iter().any(|tab| tab.at.distance(point) < tab.reach) {
                continue;
            }
            let Some(section) = grooves.nearest_neighbor(&[point.x, point.y]).map(|line| sections[line.data])
            else {
                worst.take(f64::INFINITY, point, None);
                continue;
            };
            let away = point - nearest_on_segment(point, section.ends);
            let towards = if away.hypot() > 0.0 { away.normalize() } else { Vec2::ZERO };
            worst.take(away.hypot() - reach(wanted.radius, section.lean, towards), point, None);
        }
    }
    worst
}

/// A ligament between the cleared grooves.
fn found(
    neck: &Neck,
    place: usize,
    (sections, grooves): (&[Section], &Lines),
    above_middle: f64,
    radius: f64,
) -> Found {
    let at = neck.at + above_middle * neck.lean;
    let nothing = Found { neck: place, width: f64::INFINITY, off: f64::INFINITY, at };
    let far = 4.0 * (neck.width + radius);
    let near: Vec<Section> =
        grooves.locate_within_distance([at.x, at.y], far * far).map(|line| sections[line.data]).collect();
    let free = |section: &Section, ends: [Point; 2]| {
        let way = nearest_on_segment(at, ends) - at;
        let length = way.hypot();
        (length - reach(radius, section.lean, way / length.max(f64::MIN_POSITIVE)), way)
    };
    let nearest = near.iter().map(|section| free(section, section.ends));
    let Some((first, way)) = nearest.min_by(order) else { return nothing };
    let axis = -way.normalize();
    let beyond = near.iter().filter_map(|section| Some(free(section, in_cone(section.ends, at, axis)?)));
    let Some((second, _)) = beyond.min_by(order) else { return nothing };
    Found { neck: place, width: first + second, off: (0.5 * (second - first).abs() - neck.beside).abs(), at }
}

/// By distance, ties by place: the index has no order.
fn order(a: &(f64, Vec2), b: &(f64, Vec2)) -> std::cmp::Ordering {
    a.0.total_cmp(&b.0).then(a.1.x.total_cmp(&b.1.x)).then(a.1.y.total_cmp(&b.1.y))
}

/// The part of a segment in the cone about a direction.
fn in_cone(segment: [Point; 2], point: Point, axis: Vec2) -> Option<[Point; 2]> {
    let (sine, cosine) = CONE.sin_cos();
    let normals = [1.0, -1.0].map(|sign| sine * axis + sign * cosine * axis.turn_90());
    normals.into_iter().try_fold(segment, |[a, b], normal| {
        let [s, t] = [a, b].map(|p| (p - point).dot(normal));
        match (s >= 0.0, t >= 0.0) {
            (true, true) => Some([a, b]),
            (false, false) => None,
            (true, false) => Some([a, a.lerp(b, s / (s - t))]),
            (false, true) => Some([a.lerp(b, s / (s - t)), b]),
        }
    })
}
