//! Why a path does not become a program.

use thiserror::Error;

use crate::geometry::Point3;

/// A path that a machine cannot take. Runs and blocks count from 1, places are those of the tip in the part's
/// frame.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MachineError {
    /// There is nothing to do.
    #[error("the path has no run from the one asked for on ({first} of {count}); ask for one that exists")]
    NoRun {
        /// The first run asked for, from 1.
        first: usize,
        /// How many there are.
        count: usize,
    },
    /// A pose or feed that means nothing.
    #[error("run {run}, block {block}: {what}; this is a fault of the path, not of the machine")]
    Path {
        /// Run.
        run: usize,
        /// Block; 0 is the run's start.
        block: usize,
        /// What.
        what: &'static str,
    },
    /// A tilted tool on a machine that cannot tilt it.
    #[error(
        "run {run}, block {block}, {}: the tool tilts by {degrees:.3} degrees, and the machine has three \
         axes; make vertical walls, or name a machine with five",
        place(tip)
    )]
    Tilted {
        /// Run.
        run: usize,
        /// Block; 0 is the run's start.
        block: usize,
        /// Where.
        tip: Point3,
        /// From the vertical.
        degrees: f64,
    },
    /// No way within the limits of the rotary axes.
    #[error(
        "run {run}, {}: no angles within the limits of the rotary axes reach from here on, and no place in \
         this run is far enough from the ends of its slits to retreat and turn back; widen the limits, set the \
         job on a wedge ([fixture] tilt_deg), or name another machine",
        place(tip)
    )]
    Limits {
        /// Run.
        run: usize,
        /// Where.
        tip: Point3,
    },
    /// A joint beyond its travel.
    #[error(
        "run {run}, {}: {axis} would stand at {value:.3} mm, and travels from {} to {} mm; move the job on \
         the table (setup.zero_mm), use a shorter or longer tool (setup.tool_length_mm), or name another machine",
        place(tip), range[0], range[1]
    )]
    Travel {
        /// Run.
        run: usize,
        /// Where.
        tip: Point3,
        /// Which.
        axis: char,
        /// Its position, machine coordinates.
        value: f64,
        /// Its travel.
        range: [f64; 2],
    },
    /// A spindle speed that the spindle does not have.
    #[error(
        "the tool is to turn at {rpm} turns a minute, and the spindle does {} to {}; change the profile's \
         speed, or name another machine", range[0], range[1]
    )]
    Spindle {
        /// Asked for.
        rpm: f64,
        /// What there is.
        range: [f64; 2],
    },
    /// A run that is longer than the controller's memory.
    #[error(
        "run {run} alone takes {bytes} bytes, and a program may have {limit} (output.max_bytes): a run is \
         cut without a stop; raise the limit or feed the program from a drive"
    )]
    Memory {
        /// Run.
        run: usize,
        /// Its program.
        bytes: usize,
        /// What there is.
        limit: usize,
    },
}

fn place(tip: &Point3) -> String {
    format!("at ({:.3}, {:.3}, {:.3})", tip.x, tip.y, tip.z)
}
