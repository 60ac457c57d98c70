//! What can be wrong with a milling program.

use std::fmt;

use crate::geometry::Point3;

/// What is wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Trouble {
    /// The tool cuts into the part.
    Gouge,
    /// Material is left on the part's walls.
    Leftover,
    /// A ligament is too wide or too narrow.
    NeckWidth,
    /// A ligament is off its axis.
    NeckCentre,
    /// A rapid move near the stock.
    Rapid,
    /// Shank or holder in the stock.
    Shank,
    /// The spindle stands, or turns otherwise than the profile says.
    Spindle,
    /// Too fast, or down too fast.
    Feed,
    /// More is cut at once than a pass may take.
    Depth,
    /// The tool jumps from one place to another; it, or an axis of the machine, turns too far in one move.
    Jump,
    /// The sheet falls apart before its border is cut.
    Body,
}

impl Trouble {
    /// Whether a move is to blame by itself, and not what all moves together leave.
    pub fn is_of_a_move(self) -> bool {
        !matches!(self, Self::Leftover | Self::NeckWidth | Self::NeckCentre | Self::Body)
    }
}

/// One thing that is wrong, and where.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// What.
    pub trouble: Trouble,
    /// Where, in the program's frame.
    pub at: Point3,
    /// How much.
    pub value: f64,
    /// How much there may be.
    pub limit: f64,
    /// The hinge.
    pub hinge: Option<usize>,
    /// The move, from 0.
    pub step: Option<usize>,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { trouble, at, value, limit, hinge, step } = self;
        let hinge = hinge.map_or(String::new(), |hinge| format!("hinge {hinge}: "));
        let step = step.map_or(String::new(), |step| format!(" (move {step})"));
        let place = format!("at ({:.2}, {:.2}, {:.2}) mm{step}", at.x, at.y, at.z);
        match trouble {
            Trouble::Gouge => {
                write!(f, "the tool cuts {value:.3} mm into the part {place}, the limit is {limit} mm")
            }
            Trouble::Leftover => {
                write!(
                    f,
                    "{value:.3} mm of material is left on the part's wall {place}, the limit is {limit} mm"
                )
            }
            Trouble::NeckWidth => write!(
                f,
                "{hinge}the ligament's width is {value:.3} mm off what it should be {place}, the limit is {limit} mm"
            ),
            Trouble::NeckCentre => write!(
                f,
                "{hinge}the ligament's centre is {value:.3} mm off the hinge's axis {place}, the limit is {limit} mm"
            ),
            Trouble::Rapid => {
                write!(
                    f,
                    "a rapid move comes within {value:.3} mm of the stock {place}, the limit is {limit} mm"
                )
            }
            Trouble::Shank => write!(
                f,
                "shank or holder are {value:.3} mm above the stock {place}, the limit is {limit} mm: take a tool with longer \
                 edges"
            ),
            Trouble::Spindle => {
                write!(
                    f,
                    "the spindle turns {value:.0} times a minute in the cut {place}, the profile says {limit:.0}"
                )
            }
            Trouble::Feed => write!(f, "the feed is {value:.0} mm/min {place}, the limit is {limit:.0}"),
            Trouble::Depth => write!(
                f,
                "the tool cuts {value:.3} mm deep at once {place}, the limit is {limit} mm: a pass is missing, or the way is off"
            ),
            Trouble::Jump => write!(f, "the tool turns or jumps by {value:.3} {place}, the limit is {limit}"),
            Trouble::Body => {
                write!(
                    f,
                    "{value:.0} pieces of the part come loose before the border is cut, one of them {place}"
                )
            }
        }
    }
}
