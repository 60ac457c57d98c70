//! Where the tool has been: a move in a groove that is already cut takes no chip and may go faster than the feed.

use nalgebra::Vector3;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use super::Move;
use crate::geometry::Point3;
use crate::milling::toolpath::{Pose, Rate};

/// How far a move may be off the one before it to be in its groove, millimetres: the rounding of a program's coordinates, and a
/// quarter of what may be cut into a wall.
const OFF: f64 = 2.5e-3;
/// The same of the tool's axis, radians: over five millimetres as much again.
const TURNED: f64 = 5e-4;
/// Places on a move that are looked at.
const PLACES: [f64; 3] = [0.0, 0.5, 1.0];

/// The moves that cut at the feed or slower, by place.
pub struct Grooves<'a> {
    moves: &'a [Move],
    tree: RTree<GeomWithData<Rectangle<[f64; 3]>, usize>>,
}

impl<'a> Grooves<'a> {
    /// Of a program in which no cut is made faster than `feed` (mm/min). Where nothing is, nothing has to be found.
    pub fn new(moves: &'a [Move], feed: f64) -> Self {
        let slow = |a: &Move| matches!(a.rate, Rate::Feed(rate) if rate <= feed);
        let fast = moves.iter().any(|a| matches!(a.rate, Rate::Feed(rate) if rate > feed));
        let corner = |p: &Point3| [p.x, p.y, p.z];
        let boxes = moves.iter().enumerate().filter(|(_, a)| fast && slow(a)).map(|(step, a)| {
            GeomWithData::new(Rectangle::from_corners(corner(&a.from.tip), corner(&a.to.tip)), step)
        });
        Self { moves, tree: RTree::bulk_load(boxes.collect()) }
    }

    /// Whether the tool was everywhere on a move before.
    pub fn is_empty_at(&self, step: usize, a_move: &Move) -> bool {
        PLACES.iter().all(|&part| {
            let (at, axis) = place(a_move, part);
            let [low, high] = [-OFF, OFF].map(|by| [at.x + by, at.y + by, at.z + by]);
            let mut near = self.tree.locate_in_envelope_intersecting(&AABB::from_corners(low, high));
            near.any(|other| other.data < step && passes(&self.moves[other.data], &at, &axis))
        })
    }
}

/// Tip and axis in the course of a move.
fn place(a_move: &Move, part: f64) -> (Point3, Vector3<f64>) {
    let Move { from, to, .. } = a_move;
    let tip = from.tip + part * (to.tip - from.tip);
    (tip, from.axis.lerp(&to.axis, part).normalize())
}

/// Whether the tool stood in this way during a move.
fn passes(a_move: &Move, at: &Point3, axis: &Vector3<f64>) -> bool {
    let [Pose { tip: from, .. }, Pose { tip: to, .. }] = [a_move.from, a_move.to];
    let way = to - from;
    let length = way.norm_squared();
    let part = if length > 0.0 { ((at - from).dot(&way) / length).clamp(0.0, 1.0) } else { 0.0 };
    // Where the tool turned on the spot any of its axes may be the one.
    let parts = if length > OFF * OFF { [part; 3] } else { PLACES };
    parts.iter().any(|&part| {
        let (tip, other) = place(a_move, part);
        (tip - at).norm() <= OFF && other.angle(axis) <= TURNED
    })
}
