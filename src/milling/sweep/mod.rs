//! What a program leaves of the sheet, from the tool's poses alone.
//!
//! Nothing of the walks and centre lines that made the program is known here. At several heights through the sheet every
//! move is cut to the line that the tool's axis draws there ([`section`]); a tilted cylinder's section is an ellipse that
//! reaches R sqrt(1 + s^2) from that line where the axis leans by s. Held against it are the walls of `part.stl` and the
//! hinges' axes at that height ([`mod@slice`]); what needs no material, such as speeds and heights, is looked at move by move
//! ([`moves`]), and every place for how deep the tool cuts there at once ([`depth`]).
//!
//! Frame: the program's; x and y as on the sheet, z = 0 on top of the stock. The part's own z = 0 is its mid-plane.

pub mod depth;

pub mod finding;

mod grooves;

pub mod moves;

pub mod section;

pub mod slice;

pub mod bodies;

use rayon::prelude::*;

use self::finding::{Finding, Trouble};
use self::slice::Slice;
use kurbo::{Point, Vec2};

use super::path::Tab;
use super::toolpath::{Pose, Rate, Toolpath};
use crate::fabrication::hinge_table::HingeRow;
use crate::geometry::mesh::TriMesh;
use crate::profile::Tool;

/// How far the tool may cut into the part, millimetres.
pub const GOUGE_LIMIT: f64 = 0.01;
/// How much may be left on a wall, millimetres.
pub const LEFTOVER_LIMIT: f64 = 0.02;
/// How far a ligament's width and centre may be off at any height, millimetres.
pub const NECK_LIMIT: f64 = 0.02;

/// Parts of the thickness, from the lower face, at which the sheet is looked at.
const HEIGHTS: [f64; 7] = [0.001, 0.16, 0.33, 0.5, 0.67, 0.84, 0.999];

/// A move of the tool as a program tells it: the tip on a straight line, the axis turning evenly.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Move {
    /// Where it begins.
    pub from: Pose,
    /// Where it ends.
    pub to: Pose,
    /// How fast.
    pub rate: Rate,
    /// Turns of the spindle per minute, clockwise; 0 where it stands.
    pub spindle: f64,
}

/// A ligament as it should be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Neck {
    /// The hinge.
    pub id: usize,
    /// Its point, at mid-plane.
    pub at: Point,
    /// Which way its middle runs through the sheet: (dx/dz, dy/dz).
    pub lean: Vec2,
    /// Its width.
    pub width: f64,
    /// How far beside the hinge's axis its middle belongs.
    pub beside: f64,
    /// How far it is known to be off that.
    pub told: f64,
}

impl Neck {
    /// From the hinge table, for walls that follow the hinges' axes or, on machines with three axes, stand upright.
    pub fn new(row: &HingeRow, upright: bool) -> Self {
        let lean = if upright { Vec2::ZERO } else { Vec2::new(row.axis.x, row.axis.y) / row.axis.z };
        let at = Point::new(row.point.x, row.point.y);
        let (beside, told) = (row.pole_offset.abs(), row.centre_offset);
        Self { id: row.id, at, lean, width: row.width, beside, told }
    }

    /// The same of a copy.
    #[must_use]
    pub fn moved(&self, by: Vec2) -> Self {
        Self { at: self.at + by, ..*self }
    }
}

/// What a program is held against.
#[derive(Debug, Clone, Copy)]
pub struct Wanted<'a> {
    /// The finished part, in the sheet's frame.
    pub part: &'a TriMesh,
    /// How many copies of it that is, one after the other.
    pub copies: usize,
    /// Its ligaments.
    pub necks: &'a [Neck],
    /// Size of the stock in x and y, millimetres, from the origin.
    pub stock: [f64; 2],
    /// Thickness of the sheet, millimetres.
    pub thickness: f64,
    /// Radius of the tool, millimetres.
    pub radius: f64,
    /// The tool.
    pub tool: &'a Tool,
    /// The bridges that are to be left.
    pub tabs: &'a [Tab],
}

/// What was measured. Millimetres.
#[derive(Debug, Clone, PartialEq)]
pub struct Figures {
    /// How far the tool cuts into the part.
    pub gouge: f64,
    /// How much is left on its walls.
    pub leftover: f64,
    /// Least and largest width of ligaments.
    pub widths: [f64; 2],
    /// Largest distance of a ligament's centre from its axis at any height.
    pub centre: f64,
    /// Least height of a rapid move above the stock.
    pub rapid: f64,
    /// Least height of shank and holder above the stock.
    pub shank: f64,
    /// Number of moves.
    pub moves: usize,
    /// Way in the material, millimetres.
    pub cut: f64,
    /// Bodies that the stock holds before its border is cut.
    pub bodies: usize,
    /// Scraps that come loose before that.
    pub loose: usize,
}

/// Measures a program.
pub fn inspect(moves: &[Move], wanted: &Wanted) -> (Figures, Vec<Finding>) {
    let heights: Vec<f64> = HEIGHTS.iter().map(|part| (part - 1.0) * wanted.thickness).collect();
    let (slices, (moved, depths, bodies)) = rayon::join(
        || heights.par_iter().map(|&z| Slice::new(moves, z, wanted)).collect::<Vec<_>>(),
        || (moves::check(moves, wanted), depth::check(moves, wanted), bodies::before_border(moves, wanted)),
    );
    let mut findings = moved.findings;
    let mut figures = Figures {
        gouge: 0.0,
        leftover: 0.0,
        widths: [f64::INFINITY, 0.0],
        centre: 0.0,
        rapid: moved.rapid,
        shank: moved.shank,
        moves: moves.len(),
        cut: moved.cut,
        bodies: bodies.bodies,
        loose: bodies.loose,
    };
    for slice in &slices {
        let [gouge, leftover] = [&slice.gouge, &slice.leftover].map(|worst| worst.value);
        figures.gouge = figures.gouge.max(gouge);
        figures.leftover = figures.leftover.max(leftover);
        findings.extend(
            (gouge > GOUGE_LIMIT).then(|| slice.gouge.finding(Trouble::Gouge, slice.height, GOUGE_LIMIT)),
        );
        let left = || slice.leftover.finding(Trouble::Leftover, slice.height, LEFTOVER_LIMIT);
        findings.extend((leftover > LEFTOVER_LIMIT).then(left));
        for neck in &slice.necks {
            figures.widths = [figures.widths[0].min(neck.width), figures.widths[1].max(neck.width)];
            figures.centre = figures.centre.max(neck.off);
        }
        findings.extend(slice.neck_findings(wanted));
    }
    findings.extend(bodies.findings);
    // A way that is off is too deep nearly everywhere: what it does to the part comes first.
    findings.extend(depths);
    (figures, findings)
}

/// The moves of a path without a machine: rapid between the ends of runs.
pub fn of_path(path: &Toolpath, spindle: f64) -> Vec<Move> {
    let mut moves = Vec::new();
    let mut last: Option<Pose> = None;
    for run in &path.runs {
        if let Some(from) = last {
            moves.push(Move { from, to: run.start, rate: Rate::Rapid, spindle });
        }
        let mut from = run.start;
        for block in &run.blocks {
            moves.push(Move { from, to: block.to, rate: block.rate, spindle });
            from = block.to;
        }
        last = Some(from);
    }
    moves
}
