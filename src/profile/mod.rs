//! Profiles: material, sheet, laser and ligament in one TOML file each (`profiles/*.toml`).
//!
//! Keys carry their unit as a suffix; inside the program lengths are millimetres, stresses megapascals (N/mm²),
//! angles radians. A profile file is version 1 of this layout; [`load`] finds, reads and checks it. The same files
//! are embedded in the program, and one in the folder `profiles` of the working directory goes before an embedded
//! one of the same name.

mod load;
mod machine;
mod read;

pub use load::{ProfileError, load, names};
pub use machine::Machine;
pub use read::parse;
pub(crate) use read::{KERF, SHEET_SIDE};

/// A checked profile: every number is finite and in its range.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// Name, as in the file name.
    pub name: String,
    /// The stock.
    pub sheet: Sheet,
    /// The material's mechanics.
    pub material: Material,
    /// The cutting beam.
    pub laser: Laser,
    /// The piece of material that is left at a hinge.
    pub ligament: Ligament,
    /// Speeds and rates for estimates; `None` where the file has none.
    pub machine: Option<Machine>,
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
    /// Young's modulus, MPa.
    pub youngs_modulus: f64,
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

/// The cutting beam.
#[derive(Debug, Clone, PartialEq)]
pub struct Laser {
    /// Width of the burned groove, millimetres.
    pub kerf: f64,
    /// Least width of material that may stand between two cuts, millimetres.
    pub min_web: f64,
    /// Cutting speed, millimetres per second, over all passes together.
    pub cutting_speed: f64,
}

/// The ligament at each hinge: a beam between a relief bar and the slit that passes.
#[derive(Debug, Clone, PartialEq)]
pub struct Ligament {
    /// Width of the beam, between the relief bar and the passing slit, millimetres.
    pub width: f64,
    /// Least free length of the beam, millimetres. Longer where the hinge's angle needs it.
    pub min_length: f64,
    /// Largest free length of the beam, millimetres.
    pub max_length: f64,
    /// Elastic effective length minus free length, in units of the width (root compliance, by finite elements).
    pub root_compliance: f64,
}

impl Profile {
    /// Distance between the two hinge points of an inner corner: ligament width plus slit width, millimetres.
    pub fn hinge_gap(&self) -> f64 {
        self.ligament.width + self.laser.kerf
    }
}

#[cfg(test)]
mod tests;
