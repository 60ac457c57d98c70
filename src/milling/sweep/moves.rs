//! What needs no material: heights of rapid moves, shank and holder, spindle, feeds, jumps.

use super::finding::{Finding, Trouble};
use super::grooves::Grooves;
use super::{Move, Wanted};
use crate::geometry::Point3;
use crate::milling::toolpath::{Pose, Rate};

/// Rapid moves keep so far from the stock, millimetres.
pub const RAPID_LIMIT: f64 = 1.0;
/// Shank and holder keep so far above it, millimetres.
pub const SHANK_LIMIT: f64 = 0.0;
/// The axis may turn so far in one move in the stock, radians.
pub const SWING_LIMIT: f64 = 0.5;
/// Where a move ends the next one begins, millimetres.
const JUMP_LIMIT: f64 = 1e-3;
/// By how much feeds may exceed what was asked for, relative: without tool centre point control a program tells times, and its
/// moves are a little longer than their chords.
const RATE_PLAY: f64 = 0.01;
/// Rounding of heights, millimetres.
const PLAY: f64 = 1e-3;

/// What the moves show by themselves.
pub struct Moves {
    /// What is wrong.
    pub findings: Vec<Finding>,
    /// Least height of a rapid move above the stock.
    pub rapid: f64,
    /// Least height of shank and holder above the stock.
    pub shank: f64,
    /// Way in the material.
    pub cut: f64,
}

/// Looks at every move; of each kind of trouble the first few are told.
pub fn check(moves: &[Move], wanted: &Wanted) -> Moves {
    let mut all = Moves { findings: Vec::new(), rapid: f64::INFINITY, shank: f64::INFINITY, cut: 0.0 };
    let grooves = Grooves::new(moves, wanted.tool.feed * (1.0 + RATE_PLAY));
    for (step, a_move) in moves.iter().enumerate() {
        if over_stock(a_move, wanted) {
            heights(step, a_move, wanted, &grooves, &mut all);
        }
        if let Some(last) = step.checked_sub(1).map(|last| &moves[last]) {
            let jump = (last.to.tip - a_move.from.tip).norm() + last.to.axis.angle(&a_move.from.axis);
            // From one program to the next the tool may be moved by hand, high above the stock.
            if last.to.tip.z.min(a_move.from.tip.z) < RAPID_LIMIT {
                tell(&mut all.findings, Trouble::Jump, a_move.from.tip, jump, JUMP_LIMIT, step);
            }
        }
    }
    all
}

/// Tells of a value beyond its limit.
fn tell(findings: &mut Vec<Finding>, trouble: Trouble, at: Point3, value: f64, limit: f64, step: usize) {
    let known = findings.iter().filter(|finding| finding.trouble == trouble).count();
    // What is not a number is wrong.
    if (value > limit || value.is_nan()) && known < 100 {
        findings.push(Finding { trouble, at, value, limit, hinge: None, step: Some(step) });
    }
}

/// Whether any part of tool or holder may be above the stock.
fn over_stock(a_move: &Move, wanted: &Wanted) -> bool {
    let [width, height] = wanted.stock;
    let reach = wanted.tool.holder_radius.max(wanted.tool.shank_radius) + RAPID_LIMIT;
    let sides = |pose: &Pose| {
        let far = pose.lifted(wanted.tool.stickout).tip;
        let [x, y] = [[pose.tip.x, far.x], [pose.tip.y, far.y]];
        [x[0].min(x[1]), x[0].max(x[1]), y[0].min(y[1]), y[0].max(y[1])]
    };
    let [a, b] = [sides(&a_move.from), sides(&a_move.to)];
    let beyond = |low: f64, high: f64, size: f64| low > size + reach || high < -reach;
    !(beyond(a[0].min(b[0]), a[1].max(b[1]), width) || beyond(a[2].min(b[2]), a[3].max(b[3]), height))
}

fn heights(step: usize, a_move: &Move, wanted: &Wanted, grooves: &Grooves, all: &mut Moves) {
    let tool = wanted.tool;
    let findings = &mut all.findings;
    let lowest = lowest(a_move, 0.0, wanted.radius);
    let at = if a_move.to.tip.z < a_move.from.tip.z { a_move.to.tip } else { a_move.from.tip };
    let shank = self::lowest(a_move, tool.flute_length, tool.shank_radius).min(self::lowest(
        a_move,
        tool.stickout,
        tool.holder_radius,
    ));
    all.shank = all.shank.min(shank);
    tell(findings, Trouble::Shank, at, -shank, -SHANK_LIMIT, step);
    let way = a_move.to.tip - a_move.from.tip;
    let Rate::Feed(feed) = a_move.rate else {
        all.rapid = all.rapid.min(lowest);
        if lowest < RAPID_LIMIT - PLAY {
            let limit = RAPID_LIMIT;
            findings.push(Finding {
                trouble: Trouble::Rapid,
                at,
                value: lowest,
                limit,
                hinge: None,
                step: Some(step),
            });
        }
        return;
    };
    if lowest >= 0.0 {
        return;
    }
    all.cut += way.norm();
    if (a_move.spindle - tool.spindle).abs() > RATE_PLAY * tool.spindle {
        let (value, limit) = (a_move.spindle, tool.spindle);
        findings.push(Finding { trouble: Trouble::Spindle, at, value, limit, hinge: None, step: Some(step) });
    }
    // Straight down into the material is a plunge; along a ramp it is not.
    let steep = -way.z > way.norm() * (1.5 * tool.ramp).sin().max(0.5_f64.sin()) && way.norm() > PLAY;
    let faster = feed > tool.feed * (1.0 + RATE_PLAY) && feed <= tool.retrace * (1.0 + RATE_PLAY);
    let limit = match steep {
        true => tool.plunge.max(1.0),
        false if faster && grooves.is_empty_at(step, a_move) => tool.retrace,
        false => tool.feed,
    };
    tell(findings, Trouble::Feed, at, feed, limit * (1.0 + RATE_PLAY), step);
    if feed <= 0.0 || feed.is_nan() {
        findings.push(Finding {
            trouble: Trouble::Feed,
            at,
            value: feed,
            limit,
            hinge: None,
            step: Some(step),
        });
    }
    tell(findings, Trouble::Jump, at, a_move.from.axis.angle(&a_move.to.axis), SWING_LIMIT, step);
}

/// The lowest point of a disc across the tool, so far up from the tip, during a move.
fn lowest(a_move: &Move, up: f64, radius: f64) -> f64 {
    let height = |pose: &Pose| pose.lifted(up).tip.z - radius * pose.axis.x.hypot(pose.axis.y);
    height(&a_move.from).min(height(&a_move.to))
}
