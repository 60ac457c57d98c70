//! Machines: kinematics, limits, set-up and controller, one TOML file each (`profiles/machines/*.toml`).
//!
//! A machine file is version 1 of this layout; [`load()`] finds, reads and checks it as
//! [`crate::profile::load`] does a material's. Inside, lengths are millimetres, angles radians, speeds
//! millimetres or radians per minute.

mod load;
mod read;

pub use load::{load, names, source};
pub use read::parse;

use nalgebra::Rotation3;

use crate::geometry::Point3;

/// A checked machine.
#[derive(Debug, Clone, PartialEq)]
pub struct Machine {
    /// Name, as in the file name.
    pub name: String,
    /// Who reads the program.
    pub dialect: Dialect,
    /// Whether the controller holds the tool's tip while it turns axes (tool centre point control). A machine
    /// of three axes has nothing to hold and says `false`.
    pub tcp: bool,
    /// Least and largest joint position of X, Y, Z: of the spindle's face, machine coordinates, millimetres.
    pub travel: [[f64; 2]; 3],
    /// Speed of a linear axis between cuts, mm/min.
    pub rapid: f64,
    /// The two rotary axes; `None` for a machine of three.
    pub rotary: Option<Rotary>,
    /// How the job sits on it.
    pub setup: Setup,
    /// Its spindle.
    pub spindle: Spindle,
    /// How its programs are written.
    pub output: Output,
}

/// Who reads the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dialect {
    /// LinuxCNC: `M68` switches kinematics; without tool centre point control inverse time feed.
    LinuxCnc,
    /// Fanuc 30i, `G43.4`: angles of the rotary axes.
    FanucAngles,
    /// Fanuc 30i, `G43.5`: vectors of the tool's axis.
    FanucVectors,
    /// Heidenhain with `FUNCTION TCPM`.
    HeidenhainTcpm,
    /// Heidenhain with `M128`.
    HeidenhainM128,
    /// Siemens 840D, `TRAORI`, angles of the rotary axes.
    SiemensAngles,
    /// Siemens 840D, `TRAORI`, vectors of the tool's axis.
    SiemensVectors,
    /// Haas, `G234`.
    Haas,
}

impl Dialect {
    /// Whether the program says where the tool's axis points and leaves the angles to the controller.
    pub fn writes_vectors(self) -> bool {
        matches!(self, Self::FanucVectors | Self::SiemensVectors)
    }
}

/// Which two axes turn the table, innermost (fixed to the machine's bed) first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Table {
    /// A tilts, C turns on it: LinuxCNC's xyzac-trt.
    TiltAC,
    /// B tilts, C turns on it: LinuxCNC's xyzbc-trt.
    TiltBC,
    /// B tilts, A turns on it: LinuxCNC's xyzab-tdr. Its pole lies at B = ±90°, far from any sheet's.
    TiltBA,
}

impl Table {
    /// Letters of the axis that tilts and of the axis on top of it.
    pub fn letters(self) -> [char; 2] {
        match self {
            Self::TiltAC => ['A', 'C'],
            Self::TiltBC => ['B', 'C'],
            Self::TiltBA => ['B', 'A'],
        }
    }
}

/// Two rotary axes under the part.
#[derive(Debug, Clone, PartialEq)]
pub struct Rotary {
    /// Which.
    pub table: Table,
    /// +1: an angle is that of the tool seen from the part (ISO); -1: the table itself turns by it,
    /// LinuxCNC's habit for trunnions.
    pub sign: f64,
    /// A point on the axis that tilts, machine coordinates.
    pub tilt_centre: Point3,
    /// A point on the axis that it carries, machine coordinates with both angles zero.
    pub turn_centre: Point3,
    /// Least and largest angle of the axis that tilts and of the one on top of it, as commanded.
    pub limits: [[f64; 2]; 2],
    /// Speed of either axis between cuts, rad/min.
    pub rapid: f64,
    /// Fastest turn of either axis while cutting, rad/min.
    pub cutting: f64,
    /// Largest turn of an axis within one block of a cut; more needs a retreat.
    pub max_swing: f64,
    /// Tilt below which the tool is set upright and the turning axis held.
    pub upright: f64,
}

/// How the job sits on the machine.
#[derive(Debug, Clone, PartialEq)]
pub struct Setup {
    /// The word for the program's zero: `G54`; a preset's number for Heidenhain.
    pub work_offset: u32,
    /// Machine coordinates of the program's zero, both angles zero.
    pub zero: Point3,
    /// From the part's frame to the table's: a wedge under the stock, turned about the program's zero.
    pub fixture: Rotation3<f64>,
    /// Height of the tip above the stock at which the tool goes from cut to cut, millimetres.
    pub safe_height: f64,
    /// Height above the stock down to which the tool comes at rapid when it re-enters a cut, millimetres.
    pub clearance: f64,
    /// Machine coordinate of Z before the program, at the tool change and after.
    pub home_z: f64,
    /// The tool's number, in magazine and length table.
    pub tool_number: u32,
    /// From the spindle's face to the tip, millimetres.
    pub tool_length: f64,
    /// What blows or pours.
    pub coolant: Coolant,
}

/// What blows or pours while cutting.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coolant {
    /// Nothing, or an air blast that the program does not switch.
    Off,
    /// `M7`.
    Mist,
    /// `M8`.
    Flood,
}

/// The spindle.
#[derive(Debug, Clone, PartialEq)]
pub struct Spindle {
    /// Least and largest speed, turns per minute.
    pub range: [f64; 2],
    /// Time to reach it, seconds.
    pub start_seconds: f64,
}

/// How programs are written.
#[derive(Debug, Clone, PartialEq)]
pub struct Output {
    /// Digits after the point of a length in millimetres.
    pub decimals: usize,
    /// Digits after the point of an angle in degrees, and of a vector's components.
    pub angle_decimals: usize,
    /// Bytes that a program may have; longer ones are split between cuts.
    pub max_bytes: Option<usize>,
    /// Fanuc and Haas: the number after O.
    pub program_number: u32,
    /// LinuxCNC: the analog output that switches kinematics, its value with tool centre point control and
    /// without.
    pub switch: [u32; 3],
}

impl Machine {
    /// Whether the tool can stand along hinges' tilted axes.
    pub fn follows_axes(&self) -> bool {
        self.rotary.is_some()
    }
}

#[cfg(test)]
mod tests;
