//! From walks to the tool's path: depth after depth, down along ramps between ligaments, the border last, with tabs.

use std::f64::consts::PI;

use kurbo::{Point, Vec2};
use nalgebra::{Unit, Vector3};

use super::error::MillingError;
use super::order::shortened;
use super::toolpath::{Block, Contour, Kind, Pose, Rate, Run, Toolpath};
use super::track::{Avoid, Station, Track};
use super::walk::walks;
use crate::fabrication::hinge_table::HingeRow;
use crate::geometry::Point3;
use crate::profile::Tool;
use crate::solid::strokes::Strokes;

/// Height of the lowest point of the tool above the stock where a run begins and ends, millimetres: rapid moves stay a
/// millimetre away.
pub const CLEARANCE: f64 = 2.0;

/// The slope by which the tool climbs over tabs, radians.
const TAB_SLOPE: f64 = 30.0 * PI / 180.0;

/// Stretches shorter than this are no place to go down, millimetres.
const LEAST_RAMP: f64 = 0.2;

/// A bridge that is left between part and stock.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tab {
    /// Its middle, on the tool's centre line at mid-plane.
    pub at: Point,
    /// How far from there the border is not cut through, millimetres.
    pub reach: f64,
    /// Its top above mid-plane, millimetres.
    pub top: f64,
}

/// What a tool is to do to a sheet.
#[derive(Debug, Clone, Copy)]
pub struct Work<'a> {
    /// The centre lines with the tool's axes.
    pub strokes: &'a Strokes,
    /// The sheet's hinges.
    pub hinges: &'a [HingeRow],
    /// The tool.
    pub tool: &'a Tool,
    /// Thickness of the sheet, millimetres.
    pub thickness: f64,
}

/// A path and the bridges that it leaves.
#[derive(Debug, Clone, PartialEq)]
pub struct Planned {
    /// The path.
    pub path: Toolpath,
    /// The bridges on the borders.
    pub tabs: Vec<Tab>,
}

impl Planned {
    /// The same for several parts: all openings before the first border.
    #[must_use]
    pub fn copied(&self, copies: &[Vec2]) -> Self {
        let of = |contour: Contour| {
            copies.iter().flat_map(move |by| {
                self.path.runs.iter().filter(move |run| run.contour == contour).map(|run| run.moved(*by))
            })
        };
        let runs = of(Contour::Opening).chain(of(Contour::Border)).collect();
        let tabs = copies.iter().flat_map(|by| self.tabs.iter().map(|tab| Tab { at: tab.at + *by, ..*tab }));
        Self { path: Toolpath { runs, ..self.path }, tabs: tabs.collect() }
    }
}

/// The path that cuts all openings, then the borders. `way`: time from above one place to above another; the order of the
/// openings makes it short.
///
/// # Errors
/// A tool with too short edges; an opening with no place to go down away from ligaments.
pub fn path(work: &Work, way: &(dyn Fn(&Pose, &Pose) -> f64 + Sync)) -> Result<Planned, MillingError> {
    let deepest = work.deepest(work.strokes.steepest());
    let (needed, given) = (-deepest * 1.0_f64.hypot(work.strokes.steepest()), work.tool.flute_length);
    if needed > given {
        return Err(MillingError::ShortEdges { needed, given });
    }
    let avoid = Avoid::new(work.hinges, work.strokes.radius, []);
    let mut runs = Vec::new();
    let mut tabs = Vec::new();
    for walk in walks(work.strokes) {
        let track = Track::new(&walk, work.strokes);
        let ramp = work.ramp(&track, &avoid)?;
        let own = if walk.contour == Contour::Border { work.tabs(&track, ramp) } else { Vec::new() };
        runs.push(work.run(&track, walk.contour, ramp, &own));
        tabs.extend(own.iter().map(|&along| work.tab(&track, along)));
    }
    let openings = runs.iter().filter(|run| run.contour == Contour::Opening).count();
    let order = shortened(openings, &|a, b| way(&runs[a].start, &runs[b].start));
    let runs = order.into_iter().chain(openings..runs.len()).map(|run| runs[run].clone()).collect();
    let path = Toolpath { radius: work.strokes.radius, thickness: work.thickness, runs };
    Ok(Planned { path, tabs })
}

impl Work<'_> {
    /// Height of the tip, above the top of the stock, of the last pass of a walk that leans so far.
    fn deepest(&self, lean: f64) -> f64 {
        -self.thickness - self.strokes.radius * sine(lean) - self.tool.breakthrough
    }

    /// The tool at a station with its tip at a height above the top of the stock.
    fn pose(&self, station: &Station, height: f64) -> Pose {
        let Station { at, lean, .. } = *station;
        let tip = at + (height + 0.5 * self.thickness) * lean;
        let axis = Unit::new_normalize(Vector3::new(lean.x, lean.y, 1.0));
        Pose { tip: Point3::new(tip.x, tip.y, height), axis }
    }

    /// Where the tool goes down: from and to.
    fn ramp(&self, track: &Track, avoid: &Avoid) -> Result<[f64; 2], MillingError> {
        let clear = track.clear(avoid);
        let longest = clear.into_iter().reduce(|a, b| if b[1] - b[0] > a[1] - a[0] + 1e-9 { b } else { a });
        let [from, to] = longest.filter(|[from, to]| to - from > LEAST_RAMP).ok_or_else(|| {
            let Point { x, y } = track.at(0.0).at;
            MillingError::NoEntry { x, y }
        })?;
        let half = 0.5 * (to - from).min(self.tool.step_down / self.tool.ramp.tan());
        let middle = 0.5 * (from + to);
        Ok([middle - half, middle + half])
    }

    /// The middles of tabs, evenly spread but away from ligaments, from grooves that run out and from the ramp.
    fn tabs(&self, track: &Track, ramp: [f64; 2]) -> Vec<f64> {
        let radius = self.strokes.radius;
        let mut degree = vec![0; self.strokes.nodes.len()];
        self.strokes.edges.iter().flat_map(|edge| edge.ends).for_each(|end| degree[end] += 1);
        let meeting = self.strokes.nodes.iter().zip(&degree).filter(|(_, degree)| **degree > 2);
        let own = 0.5 * self.tool.tab_width + 2.0 * radius + self.climb();
        let meeting = meeting.map(|(node, _)| (node.at, 2.0 * radius));
        let [from, to] = ramp;
        let entry =
            (0..=8).map(|i| (track.at(from + (to - from) * f64::from(i) / 8.0).at, 0.13 * (to - from)));
        let clear = track.clear(&Avoid::new(self.hinges, radius, meeting.chain(entry)));
        let room: Vec<[f64; 2]> = clear
            .into_iter()
            .map(|[from, to]| [from + own, to - own])
            .filter(|[from, to]| from <= to)
            .collect();
        let (length, count) = (track.length(), self.tool.tabs);
        let mut tabs: Vec<f64> = Vec::new();
        for k in 0..count {
            let wanted = (k as f64 + 0.5) * length / count as f64;
            let places = room.iter().flat_map(|&[from, to]| {
                [-length, 0.0, length].map(|turn| (wanted + turn).clamp(from, to) - turn)
            });
            let free = |at: &f64| tabs.iter().all(|tab| apart(*tab, *at, length) > 2.0 * own);
            let best = places.filter(free).min_by(|a, b| (a - wanted).abs().total_cmp(&(b - wanted).abs()));
            tabs.extend(best);
        }
        tabs.iter_mut().for_each(|tab| *tab = tab.rem_euclid(length));
        tabs.sort_by(f64::total_cmp);
        tabs
    }

    /// The length of the way up to a tab's top.
    fn climb(&self) -> f64 {
        (self.tool.tab_height - self.deepest(self.strokes.steepest()) - self.thickness) / TAB_SLOPE.tan()
    }

    fn tab(&self, track: &Track, along: f64) -> Tab {
        let reach = 0.5 * self.tool.tab_width + 2.0 * self.strokes.radius + self.climb();
        Tab { at: track.at(along).at, reach, top: self.tool.tab_height - 0.5 * self.thickness }
    }

    /// One opening, from above the stock and back.
    fn run(&self, track: &Track, contour: Contour, [from, to]: [f64; 2], tabs: &[f64]) -> Run {
        let deepest = self.deepest(track.steepest());
        let steps = (-deepest / self.tool.step_down).ceil().max(1.0);
        let start = self.pose(&track.at(from), 0.0);
        let tilt = sine(track.steepest());
        // The rim of a tilted tool is below its tip.
        let touch = start.lifted((self.strokes.radius * tilt) / start.axis.z);
        let above = touch.lifted(CLEARANCE / start.axis.z);
        let feed = Rate::Feed(self.tool.feed);
        let mut blocks = vec![Block { to: touch, rate: Rate::Feed(self.tool.plunge), kind: Kind::Approach }];
        let mut height = touch.tip.z;
        let around = track.length();
        let mut lap = 0.0;
        for step in 1..=steps as usize {
            let depth = deepest * step as f64 / steps;
            let (from, to) = (from + lap, to + lap);
            self.descend(track, [from, to], [height, depth], &mut blocks);
            let kind = if step == steps as usize { Kind::Finish } else { Kind::Rough };
            lap += around;
            let until = if kind == Kind::Finish { to + around } else { from + around };
            self.level(track, [to, until], depth, tabs, (feed, kind), &mut blocks);
            height = depth;
        }
        for _ in 0..self.tool.finish_passes {
            let from = to + lap;
            lap += around;
            self.level(track, [from, from + around], deepest, tabs, (feed, Kind::Finish), &mut blocks);
        }
        let last =
            self.pose(&track.at(to), 0.0).lifted((self.strokes.radius * tilt + CLEARANCE) / start.axis.z);
        blocks.push(Block { to: last, rate: feed, kind: Kind::Retract });
        Run { contour, start: above, blocks }
    }

    /// Down along a stretch, forth and back as often as the slope asks for, to its end.
    fn descend(&self, track: &Track, [from, to]: [f64; 2], [high, low]: [f64; 2], blocks: &mut Vec<Block>) {
        let once = (to - from) * self.tool.ramp.tan();
        let ways = ((high - low) / once - 1e-9).ceil().max(1.0) as usize;
        let ways = ways + 1 - ways % 2;
        for way in 0..ways {
            let height = |part: f64| high + (low - high) * (way as f64 + part) / ways as f64;
            let mut stations = track.between(from, to);
            if way % 2 == 1 {
                stations.pop();
                stations.reverse();
                stations.push(track.at(from));
            }
            for station in stations {
                let part = (station.along - from) / (to - from);
                let part = if way % 2 == 1 { 1.0 - part } else { part };
                let to = self.pose(&station, height(part));
                blocks.push(Block { to, rate: Rate::Feed(self.tool.feed), kind: Kind::Ramp });
            }
        }
    }

    /// Along the walk at one depth, over the tabs.
    fn level(
        &self,
        track: &Track,
        [from, to]: [f64; 2],
        depth: f64,
        tabs: &[f64],
        (rate, kind): (Rate, Kind),
        blocks: &mut Vec<Block>,
    ) {
        let top = self.tool.tab_height - self.thickness;
        let flat = 0.5 * self.tool.tab_width + self.strokes.radius;
        let way = (top - depth).max(0.0) / TAB_SLOPE.tan();
        let length = track.length();
        let bends = tabs.iter().flat_map(|tab| [-flat - way, -flat, flat, flat + way].map(|by| tab + by));
        // From where the pass began, and from where the tool came down, the groove is cut at this depth.
        let begun = [track.mirrored(from), track.mirrored(to)].into_iter().flatten();
        let places = bends.filter(|_| way > 0.0).chain(begun.filter(|_| kind == Kind::Rough));
        let turns =
            places.flat_map(|at| (-1..=(to / length) as i64 + 1).map(move |turn| at + turn as f64 * length));
        let mut stations = track.between(from, to);
        stations.extend(turns.filter(|&at| at > from && at < to).map(|at| track.at(at)));
        stations.sort_by(|a, b| a.along.total_cmp(&b.along));
        let mut behind = from;
        for station in stations {
            let near =
                tabs.iter().map(|&tab| apart(tab, station.along, length)).fold(f64::INFINITY, f64::min);
            let floor = top - (near - flat).max(0.0) * TAB_SLOPE.tan();
            let height = depth.max(floor);
            let to = self.pose(&station, height);
            let way = [std::mem::replace(&mut behind, station.along), station.along];
            let back = kind == Kind::Rough && track.retraces(from, way);
            let (rate, kind) =
                if back { (Rate::Feed(self.tool.retrace), Kind::Retrace) } else { (rate, kind) };
            // Down from a tab the tool plunges.
            let down = blocks.last().is_some_and(|last| last.to.tip.z > height + 1e-9);
            blocks.push(Block { to, rate: if down { Rate::Feed(self.tool.plunge) } else { rate }, kind });
        }
    }
}

/// Distance along a closed walk.
fn apart(a: f64, b: f64, length: f64) -> f64 {
    let way = (a - b).rem_euclid(length);
    way.min(length - way)
}

/// The sine of the tilt whose slope is `lean`.
fn sine(lean: f64) -> f64 {
    lean / 1.0_f64.hypot(lean)
}
