//! How deep the tool cuts at once: a pass that was left out makes the next one take two.

use kurbo::{Point, Vec2};
use rayon::prelude::*;
use rstar::primitives::{GeomWithData, Line};
use rstar::{AABB, RTree};

use super::finding::{Finding, Trouble};
use super::{Move, Wanted};
use crate::fabrication::web::nearest_on_segment;
use crate::geometry::Point3;
use crate::milling::toolpath::Pose;

/// How far beside its earlier way the tool may come by and find it cut, millimetres: the passes of one groove have one line at
/// mid-plane.
const BESIDE: f64 = 0.05;
/// The way in which a tool is still in the cut that it makes, millimetres.
const RECENT: f64 = 2.0 * BESIDE;
/// Long moves are looked at in steps of this, millimetres.
const STEP: f64 = 1.0;
/// By how much a cut may be deeper than the profile's step, relative and in millimetres.
const PLAY: f64 = 0.01;

/// So many findings are told.
const TOLD: usize = 100;

/// A move in the stock at mid-plane.
#[derive(Debug, Clone, Copy)]
struct Pass {
    ends: [Point; 2],
    /// Heights of the tip.
    heights: [f64; 2],
    /// The way of the tip up to its ends.
    way: [f64; 2],
    step: usize,
}

/// Where more is cut at once than a pass may take; the first few are told.
pub fn check(moves: &[Move], wanted: &Wanted) -> Vec<Finding> {
    let passes = passes(moves, wanted.thickness);
    let line = |(index, pass): (usize, &Pass)| {
        let [from, to] = pass.ends.map(|end| [end.x, end.y]);
        GeomWithData::new(Line::new(from, to), index)
    };
    let tree = RTree::bulk_load(passes.iter().enumerate().map(line).collect());
    // Largest cut of every move, and the place.
    let deepest = |(index, pass): (usize, &Pass)| {
        let count = (pass.ends[0].distance(pass.ends[1]) / STEP).ceil().max(1.0);
        let places = (0..count as usize).map(|i| (i as f64 + 0.5) / count);
        let cuts = places.map(|part| {
            let at = pass.ends[0].lerp(pass.ends[1], part);
            let [height, way] = [pass.heights, pass.way].map(|[a, b]| a + part * (b - a));
            let near = AABB::from_corners([at.x - BESIDE, at.y - BESIDE], [at.x + BESIDE, at.y + BESIDE]);
            let before = tree.locate_in_envelope_intersecting(&near).filter(|line| line.data < index);
            let before = before.filter_map(|line| passes[line.data].height_at(at, way - RECENT));
            (before.fold(0.0, f64::min) - height, at, height)
        });
        let most = cuts.max_by(|a, b| a.0.total_cmp(&b.0));
        most.map_or((0.0, Point3::origin()), |(cut, at, height)| (cut, Point3::new(at.x, at.y, height)))
    };
    let cuts: Vec<(f64, Point3)> = passes.par_iter().enumerate().map(deepest).collect();
    let limit = wanted.tool.step_down;
    let too_deep = passes.iter().zip(cuts).filter(|(_, (cut, _))| *cut > limit * (1.0 + PLAY) + PLAY);
    let finding = |(pass, (value, at)): (&Pass, (f64, Point3))| {
        let step = Some(pass.step);
        Finding { trouble: Trouble::Depth, at, value, limit, hinge: None, step }
    };
    too_deep.take(TOLD).map(finding).collect()
}

fn passes(moves: &[Move], thickness: f64) -> Vec<Pass> {
    let mut way = 0.0;
    let mut passes = Vec::new();
    for (step, a_move) in moves.iter().enumerate() {
        let before = way;
        let [from, to] = [a_move.from, a_move.to];
        way += (to.tip - from.tip).norm();
        if from.tip.z.min(to.tip.z) < 0.0 {
            let ends = [from, to].map(|pose| at_middle(&pose, thickness));
            passes.push(Pass { ends, heights: [from.tip.z, to.tip.z], way: [before, way], step });
        }
    }
    passes
}

/// Where the tool's axis is at mid-plane.
fn at_middle(pose: &Pose, thickness: f64) -> Point {
    let lean = Vec2::new(pose.axis.x, pose.axis.y) / pose.axis.z;
    Point::new(pose.tip.x, pose.tip.y) - (pose.tip.z + 0.5 * thickness) * lean
}

impl Pass {
    /// Height of the tip where it came by a place, if that was before so much way.
    fn height_at(&self, at: Point, latest: f64) -> Option<f64> {
        let foot = nearest_on_segment(at, self.ends);
        if foot.distance(at) > BESIDE {
            return None;
        }
        let length = self.ends[0].distance(self.ends[1]);
        // Where it goes down on the spot, as deep as it comes.
        let part = if length > 0.0 { foot.distance(self.ends[0]) / length } else { 1.0 };
        let [height, way] = [self.heights, self.way].map(|[a, b]| a + part * (b - a));
        (way < latest).then_some(height)
    }
}
