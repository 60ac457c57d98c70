//! The ligament at a hinge as a short beam with springs in all directions, in series with the two pieces that it joins.
//!
//! In: the neck's shape and the stock. Out: a [`Ligament`]: spring constants, and the loads at which it yields. Bending,
//! stretch and shear are Timoshenko's beam integrals over the neck's width; the same integrals give the notch's effective
//! length of the hinge report. What lies beyond the neck is taken from finite elements: two constants, given here.

use std::f64::consts::FRAC_PI_2;

use crate::profile::{Profile, Shape};

/// Poisson's ratio of shear: 0.29 for steel, 0.39 for nylon, 0.5 for rubber. The shear stiffness varies by 8 % over these.
const POISSON: f64 = 0.35;
/// Timoshenko's factor of a rectangular section: parabolic shear stress.
const SHEAR_FACTOR: f64 = 1.2;
/// Series compliance of the two pieces beside a hinge, in the plane and in each direction, times modulus and thickness.
///
/// In plane stress it depends on the shape alone. By finite elements of whole cells (nonlinear, `tests/oracle/snap_cell.py`)
/// it is 18 to 22 for rectangles of 0.36 to 0.5 of the cell; most of it is the bending of the 8-gons' arms.
pub const PIECE_COMPLIANCE: f64 = 19.0;
/// Length that the roots of a notch add to its effective length, in widths; by the same finite elements.
pub const NOTCH_ROOT: f64 = 0.85;
/// Steps of Simpson's rule over a quarter of a round. The integrands are smooth in the angle; error below 1e-9.
const STEPS: usize = 64;

/// The material that is left at a hinge, seen on the sheet: a straight stretch between ends that widen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Neck {
    /// Least width, millimetres.
    pub width: f64,
    /// Length of the straight stretch of that width, millimetres.
    pub straight: f64,
    /// Radius of the rounds at both ends, millimetres; 0 for square ends.
    pub radius: f64,
    /// Whether both sides are round; otherwise one is a straight wall.
    pub two_sided: bool,
}

/// What the sheet is made of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stock {
    /// Young's modulus, MPa.
    pub modulus: f64,
    /// Thickness of the sheet, millimetres.
    pub thickness: f64,
    /// Strain at which the material yields. The model's material has no hardening.
    pub yield_strain: f64,
}

/// Spring constants of one hinge, between the two pieces. The ligament's axis leads from piece to piece.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spring {
    /// Turning about the hinge axis, N mm per radian.
    pub bending: f64,
    /// Along the ligament's axis, N per mm.
    pub axial: f64,
    /// Across it in the sheet, N per mm.
    pub shear: f64,
    /// Out of the sheet, along the hinge axis, N per mm.
    pub lift: f64,
    /// Turning about the ligament's axis, N mm per radian.
    pub twist: f64,
    /// Turning about the direction across it in the sheet, N mm per radian.
    pub tilt: f64,
}

/// A ligament: its springs and its strength.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ligament {
    /// Spring constants.
    pub spring: Spring,
    /// Effective length in bending, without roots, millimetres.
    pub effective_length: f64,
    /// Lever, millimetres, with which a shear force bends the weakest section.
    pub reach: f64,
    /// Axial force that strains the narrowest section by 1, N.
    pub unit_force: f64,
    /// Moment that strains the outer fibre of the narrowest section by 1, N mm.
    pub unit_moment: f64,
    /// Strain at which it yields.
    pub yield_strain: f64,
}

/// Beam integrals over the neck, per unit of thickness.
struct Integrals {
    /// Of dx / h.
    stretch: f64,
    /// Of dx / h^3.
    bending: f64,
    /// Of x^2 dx / h^3, x from the middle.
    lever: f64,
    /// Largest x (t / h)^2.
    reach: f64,
}

fn integrals(neck: &Neck) -> Integrals {
    let (t, half) = (neck.width, 0.5 * neck.straight);
    let sides = if neck.two_sided { 2.0 } else { 1.0 };
    let mut sums = Integrals {
        stretch: neck.straight / t,
        bending: neck.straight / t.powi(3),
        lever: neck.straight.powi(3) / (12.0 * t.powi(3)),
        reach: half,
    };
    for i in 0..=STEPS {
        let angle = FRAC_PI_2 * i as f64 / STEPS as f64;
        let simpson = if i == 0 || i == STEPS { 1.0 } else { 2.0 + 2.0 * (i % 2) as f64 };
        let h = t + sides * neck.radius * (1.0 - angle.cos());
        let x = half + neck.radius * angle.sin();
        // Both ends; dx = radius cos(angle) d(angle).
        let dx = 2.0 * simpson * neck.radius * angle.cos() * FRAC_PI_2 / (3.0 * STEPS as f64);
        sums.stretch += dx / h;
        sums.bending += dx / h.powi(3);
        sums.lever += x * x * dx / h.powi(3);
        sums.reach = sums.reach.max(x * (t / h).powi(2));
    }
    sums
}

impl Ligament {
    /// A neck in a stock. `root`: length that its roots add in bending, in widths; `pieces`: series compliance of the
    /// pieces, times modulus and thickness ([`PIECE_COMPLIANCE`], or 0 for rigid ones).
    pub fn new(neck: &Neck, stock: &Stock, root: f64, pieces: f64) -> Self {
        let Stock { modulus, thickness, yield_strain } = *stock;
        let (t, plate) = (neck.width, modulus * thickness);
        let sums = integrals(neck);
        let bending = sums.bending + root / (t * t);
        let shear = SHEAR_FACTOR * 2.0 * (1.0 + POISSON) * sums.stretch;
        let turning = plate / (12.0 * bending);
        // Torsion of a strip: G b t^3 / 3 against E b t^3 / 12.
        let twist = turning * 2.0 / (1.0 + POISSON);
        Self {
            spring: Spring {
                bending: turning,
                axial: plate / (sums.stretch + pieces),
                shear: plate / (12.0 * sums.lever + shear + pieces),
                lift: plate / (shear + pieces),
                twist,
                tilt: turning * (thickness / t).powi(2),
            },
            effective_length: t.powi(3) * sums.bending,
            // A section also yields in shear, at 1 / sqrt 3 of the tensile stress.
            reach: sums.reach.max(0.25 * 3.0_f64.sqrt() * t),
            unit_force: plate * t,
            unit_moment: plate * t * t / 6.0,
            yield_strain,
        }
    }

    /// A ligament of the profile, `length` millimetres long, as the hinge report measures it.
    pub fn of_profile(profile: &Profile, length: f64) -> Self {
        let width = profile.ligament.width;
        let (straight, radius, root) = match profile.ligament.shape {
            Shape::Beam(beam) | Shape::Rounded(beam) => (length, 0.0, beam.root_compliance),
            Shape::Notch { extra_length } => (extra_length, 0.5 * profile.cut.kerf, NOTCH_ROOT),
        };
        let neck = Neck { width, straight, radius, two_sided: false };
        Self::new(&neck, &Stock::of_profile(profile), root, PIECE_COMPLIANCE)
    }

    /// Largest moment that it bears: the whole section at the yield stress, N mm.
    pub fn full_moment(&self) -> f64 {
        1.5 * self.unit_moment * self.yield_strain
    }

    /// Largest axial force that it bears, N.
    pub fn full_force(&self) -> f64 {
        self.unit_force * self.yield_strain
    }

    /// Nominal strain of the outer fibre of the narrowest section under a turn (radians), and forces along and across (N),
    /// all elastic: an index above some 10 %.
    pub fn strain(&self, turn: f64, axial: f64, shear: f64) -> f64 {
        let moment = self.spring.bending * turn.abs() + self.reach * shear.abs();
        axial.abs() / self.unit_force + moment / self.unit_moment
    }

    /// Springs along and across in series: what a misfit meets that the pieces around share out between both.
    pub fn series(&self) -> f64 {
        let Spring { axial, shear, .. } = self.spring;
        axial * shear / (axial + shear)
    }
}

impl Stock {
    /// The profile's sheet.
    pub fn of_profile(profile: &Profile) -> Self {
        Self {
            modulus: profile.material.youngs_modulus,
            thickness: profile.sheet.thickness,
            yield_strain: profile.material.yield_strain,
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    const NYLON: Stock = Stock { modulus: 3300.0, thickness: 5.0, yield_strain: 0.025 };

    /// The paper's nylon hinge, milled: radius and width half a millimetre, `straight` millimetres longer.
    pub fn nylon(straight: f64) -> Ligament {
        Ligament::new(&neck(straight, 0.5, false), &NYLON, NOTCH_ROOT, PIECE_COMPLIANCE)
    }

    fn neck(straight: f64, radius: f64, two_sided: bool) -> Neck {
        Neck { width: 0.5, straight, radius, two_sided }
    }

    fn bare(neck: &Neck) -> Ligament {
        Ligament::new(neck, &NYLON, 0.0, 0.0)
    }

    #[test]
    fn effective_lengths_of_notches_are_the_published_ones() {
        // Figures to three digits; half a millimetre of radius and width.
        for (two_sided, straight, length) in
            [(true, 0.0, 0.517), (true, 1.0, 1.517), (false, 0.0, 0.653), (false, 1.0, 1.653)]
        {
            let found = bare(&neck(straight, 0.5, two_sided));
            assert!((found.effective_length - length).abs() < 5e-4, "{}", found.effective_length);
        }
        // Published: 332 N mm per radian at 3300 MPa, to three digits.
        assert!((bare(&neck(0.0, 0.5, true)).spring.bending - 332.0).abs() < 0.5);
    }

    #[test]
    fn a_square_ended_beam_has_the_closed_forms() {
        let Spring { bending, axial, shear, .. } = bare(&neck(2.0, 0.0, false)).spring;
        let plate = NYLON.modulus * NYLON.thickness;
        assert!((bending - plate * 0.125 / 24.0).abs() < 1e-9 * bending);
        assert!((axial - plate * 0.25).abs() < 1e-9 * axial);
        // L^3 / (E b t^3) in bending, 1.2 L / (G b t) in shear.
        let compliance = 8.0 / 0.125 + 1.2 * 2.0 * 1.35 * 4.0;
        assert!((shear - plate / compliance).abs() < 1e-9 * shear);
        let ligament = bare(&neck(2.0, 0.0, false));
        // Outer fibre of a beam of constant curvature: t angle / (2 L).
        assert!((ligament.strain(0.3, 0.0, 0.0) - 0.5 * 0.3 / 4.0).abs() < 1e-12);
        assert!((ligament.strain(0.0, plate * 0.5 * 0.01, 0.0) - 0.01).abs() < 1e-12);
    }

    #[test]
    fn stiffness_goes_with_modulus_and_thickness() {
        let neck = neck(1.0, 0.5, false);
        let one = Ligament::new(&neck, &NYLON, NOTCH_ROOT, PIECE_COMPLIANCE).spring;
        let stiff = Stock { modulus: 2.0 * NYLON.modulus, ..NYLON };
        let two = Ligament::new(&neck, &stiff, NOTCH_ROOT, PIECE_COMPLIANCE).spring;
        let thick = Stock { thickness: 2.0 * NYLON.thickness, ..NYLON };
        let three = Ligament::new(&neck, &thick, NOTCH_ROOT, PIECE_COMPLIANCE).spring;
        for (spring, doubled) in [(one.bending, two.bending), (one.axial, two.axial), (one.shear, two.shear)]
        {
            assert!((doubled - 2.0 * spring).abs() < 1e-12 * doubled);
        }
        for (spring, doubled) in [(one.bending, three.bending), (one.shear, three.shear)] {
            assert!((doubled - 2.0 * spring).abs() < 1e-12 * doubled);
        }
        assert!((three.tilt - 8.0 * one.tilt).abs() < 1e-12 * three.tilt);
    }
}
