//! What a tool is to do, whatever machine does it.
//!
//! Frame: the program's, millimetres: x and y as on the sheet, z = 0 on top of the stock.

use kurbo::Vec2;
use nalgebra::{Unit, Vector3};

use crate::geometry::Point3;

/// Where a tool stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// The middle of its flat end.
    pub tip: Point3,
    /// From the tip to the shank.
    pub axis: Unit<Vector3<f64>>,
}

impl Pose {
    /// The same tool moved along its own axis, towards the shank where `by` (mm) is positive.
    pub fn lifted(&self, by: f64) -> Self {
        Self { tip: self.tip + self.axis.as_ref() * by, ..*self }
    }
}

/// How fast a tool moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Rate {
    /// As fast as the machine can, outside the stock.
    Rapid,
    /// Speed of the tip, mm/min.
    Feed(f64),
}

/// What a block does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Towards the stock, along the tool's axis.
    Approach,
    /// Down into the material along the path.
    Ramp,
    /// Removes most of the material.
    Rough,
    /// Back along a groove that is already cut at this depth.
    Retrace,
    /// Leaves the wall.
    Finish,
    /// Out of the stock, along the tool's axis.
    Retract,
}

/// A move from the pose before to this one: the tip on a straight line, the axis turning evenly.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Block {
    /// Where it ends.
    pub to: Pose,
    /// How fast.
    pub rate: Rate,
    /// What for.
    pub kind: Kind,
}

/// The contour that a run cuts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Contour {
    /// An opening with nothing left in it: connected slits, or a window with scrap that comes loose.
    Opening,
    /// Around the part: comes last.
    Border,
}

/// From the safe height into the stock and out again, without a stop.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// What it cuts.
    pub contour: Contour,
    /// Where it begins: outside the stock, the axis as in the first block.
    pub start: Pose,
    /// Its moves; the last ends outside the stock.
    pub blocks: Vec<Block>,
}

impl Run {
    /// The same elsewhere on the sheet.
    #[must_use]
    pub fn moved(&self, by: Vec2) -> Self {
        let pose = |pose: Pose| Pose { tip: pose.tip + Vector3::new(by.x, by.y, 0.0), ..pose };
        let blocks = self.blocks.iter().map(|block| Block { to: pose(block.to), ..*block }).collect();
        Self { contour: self.contour, start: pose(self.start), blocks }
    }
}

/// All runs in the order of cutting. Between them the tool goes up to the safe height, turns, and goes on above the next
/// start: how, is the machine's affair.
#[derive(Debug, Clone, PartialEq)]
pub struct Toolpath {
    /// Radius of the cylindrical tool, millimetres.
    pub radius: f64,
    /// Thickness of the stock: it fills z from minus this to 0.
    pub thickness: f64,
    /// Runs.
    pub runs: Vec<Run>,
}
