//! Profiles: material, sheet, cutting process and ligament in one TOML file each (`profiles/*.toml`).
//!
//! Keys carry their unit as a suffix; inside the program lengths are millimetres, stresses megapascals (N/mm²),
//! angles radians. A profile file is version 1 of this layout; [`load()`] finds, reads and checks it. The same files
//! are embedded in the program, and one in the folder `profiles` of the working directory goes before an embedded
//! one of the same name.

mod load;
mod machine;
mod read;
mod tool;

pub use load::{embedded, load, names, source};
pub use machine::Machine;
pub use read::parse;
pub(crate) use read::{KERF, SHEET_SIDE};
pub(crate) use tool::TOOL_RADIUS;
pub use tool::Tool;

/// A checked profile: every number is finite and in its range.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// Name, as in the file name.
    pub name: String,
    /// What cuts the sheet.
    pub process: Process,
    /// The stock.
    pub sheet: Sheet,
    /// The material's mechanics.
    pub material: Material,
    /// The groove that it leaves.
    pub cut: Cut,
    /// The piece of material that is left at a hinge.
    pub ligament: Ligament,
    /// Speeds and rates for estimates; `None` where the file has none.
    pub machine: Option<Machine>,
    /// The tool of a profile for milling, `None` of one for a laser.
    pub tool: Option<Tool>,
}

/// The stock that is cut.
#[derive(Debug, Clone, PartialEq)]
pub struct Sheet {
    /// Size in x, millimetres.
    pub width: f64,
    /// Size in y, millimetres.
    pub height: f64,
    /// Least distance between any cut and the stock's edge, millimetres.
    pub margin: f64,
    /// Thickness, millimetres.
    pub thickness: f64,
}

/// Mechanics of the sheet material.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Name as printed in reports.
    pub name: String,
    /// Young's modulus, MPa; of plastics that take up moisture that of the dry material.
    pub youngs_modulus: f64,
    /// Young's modulus after conditioning in moist air, MPa, at most `youngs_modulus`; `None` where it makes no
    /// difference.
    pub conditioned_modulus: Option<f64>,
    /// Yield strain (rubber: strain up to which the material recovers), dimensionless.
    pub yield_strain: f64,
    /// Largest nominal fibre strain that a hinge may reach in a single deployment, dimensionless.
    pub strain_limit: f64,
    /// Elongation at break, dimensionless. At least `strain_limit`.
    pub elongation: f64,
    /// Strain amplitude below which no fatigue is expected; `None` where unknown.
    pub endurance_strain: Option<f64>,
    /// Coffin-Manson ductility coefficient eps_f' and exponent c (< 0); `None` where unknown.
    pub coffin_manson: Option<[f64; 2]>,
}

/// What cuts the sheet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Process {
    /// A laser's beam: walls stand square to the sheet.
    Laser,
    /// A cylindrical milling tool.
    Milling,
}

/// The groove of one cut, burned or milled: its centre line is what the machine is told to follow.
#[derive(Debug, Clone, PartialEq)]
pub struct Cut {
    /// Width of the groove, millimetres: a laser's kerf, twice a tool's radius.
    pub kerf: f64,
    /// Least width of material that may stand between two grooves, millimetres.
    pub min_web: f64,
    /// Cutting speed, millimetres per second, over all passes together.
    pub speed: f64,
    /// Whether the walls follow the hinges' tilted axes, as a mill with five axes cuts them.
    pub ruled: bool,
    /// How far beside a groove the heat changes the material, millimetres; `None` where unknown.
    pub heat_affected: Option<f64>,
}

/// The piece of material that is left at each hinge, between the end of one groove and the wall of another.
#[derive(Debug, Clone, PartialEq)]
pub struct Ligament {
    /// Its least width, across the line from one piece to the other, millimetres.
    pub width: f64,
    /// How it gets its length.
    pub shape: Shape,
    /// Where it turns.
    pub pole: Pole,
}

/// Where a bent ligament turns: how far from its centre the pole of its finite rotation lies, towards the groove that
/// passes, as a part of its free length. Negative: towards the slit that ends there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pole {
    /// The same part at all angles; 0 is the centre.
    Part(f64),
    /// A beam bent to an arc of constant curvature: 1/a - cot(a/2)/2 at the angle a, 0.137 at a right angle.
    IdealArc,
}

impl Pole {
    /// The part of the length at an angle of 0 to less than pi.
    pub fn part(self, angle: f64) -> f64 {
        match self {
            Self::Part(part) => part,
            // The next term of the series is angle^3 / 720.
            Self::IdealArc if angle < 1e-3 => angle / 12.0,
            Self::IdealArc => 1.0 / angle - 0.5 / (0.5 * angle).tan(),
        }
    }
}

/// How a ligament gets its length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// A straight beam between a relief bar across the slit's end (a T) and the groove that passes. The bar ends, as
    /// every groove does, in rounds of half the groove's width.
    Beam(Beam),
    /// The same cut, for materials whose wide groove makes those rounds count: a straight beam with rounded ends.
    Rounded(Beam),
    /// No bar: the slit's own round end stands against the wall of the groove that passes, a notch of half the
    /// groove's width on one side. With `extra_length` (millimetres) the end is drawn out along the wall: that much
    /// of a straight beam between two half notches.
    Notch {
        /// Straight length between the halves of the notch, millimetres; 0 for a round one.
        extra_length: f64,
    },
}

/// The numbers of a beam that is freed by a relief bar.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beam {
    /// Least free length, millimetres. Longer where the hinge's angle needs it.
    pub min_length: f64,
    /// Largest free length, millimetres.
    pub max_length: f64,
    /// Elastic effective length minus free length, in units of the width (root compliance, by finite elements).
    pub root_compliance: f64,
}

impl Profile {
    /// Distance between the two hinge points of an inner corner: ligament width plus slit width, millimetres.
    pub fn hinge_gap(&self) -> f64 {
        self.ligament.width + self.cut.kerf
    }

    /// Least and largest free length of a ligament, millimetres: that of the groove beside it from end to end. A notch
    /// has one length, the groove's width and what it is drawn out by.
    pub fn ligament_lengths(&self) -> [f64; 2] {
        match self.ligament.shape {
            Shape::Beam(beam) | Shape::Rounded(beam) => [beam.min_length, beam.max_length],
            Shape::Notch { extra_length } => [self.cut.kerf + extra_length; 2],
        }
    }
}

#[cfg(test)]
mod tests;
