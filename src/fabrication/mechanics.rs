//! Mechanics of a hinge: a ligament that bends as a beam while two pieces turn against each other.
//!
//! In: a [`Profile`], the ligament's free length and the hinge's turning angle. Out: strain, stiffness, the length
//! that an angle needs, and a fatigue class. Effective lengths L are those of E b h^3 / (12 K), K the turning stiffness.
//! A notch has one, by the beam integral ([`super::notch`]). A beam between relief bars has two: it has constant curvature: a fibre at its face strains by
//! h theta / (2 L), with h the ligament's width and L its effective length. While elastic, the roots bend too and L is
//! the free length plus `root_compliance` widths (finite elements); once the outer fibre yields, strain gathers in the
//! free part and L is the free length. Above some 10 % the strain is an index to compare hinges by, not a
//! measured strain, and above yield no torque follows from it.
//!
//! Units: millimetres, radians, MPa, N mm. Strains are plain ratios.

use std::f64::consts::PI;
use std::fmt;

use thiserror::Error;

use super::notch::{Sides, effective_length};
use crate::profile::{Beam, Material, Profile, Shape};

/// Free lengths are rounded up to this many steps per millimetre: finer than any laser places a cut.
const STEPS_PER_MM: f64 = 100.0;

/// Part of a step by which a length may exceed a full step and still count as that step: it takes up the
/// rounding of decimal numbers, 1e-13, and costs a relative strain of 1e-10.
const STEP_ROUNDING: f64 = 1.0e-8;

/// Fewer cycles than this are called a single deployment: the estimate is good to a factor of ten only.
const FEW_CYCLES: f64 = 10.0;

/// What the outer fibre of a bent ligament does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum StrainClass {
    /// Up to the yield strain: springs back.
    Elastic,
    /// Above the yield strain, up to the elongation at break: stays bent, holds few turns.
    PlasticLowCycle,
    /// Above the elongation at break: tears.
    BeyondElongation,
}

impl fmt::Display for StrainClass {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Elastic => "elastic",
            Self::PlasticLowCycle => "plastic low-cycle",
            Self::BeyondElongation => "beyond elongation",
        })
    }
}

/// How often a hinge can be turned between 0 and its full angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fatigue {
    /// The strain amplitude is within the endurance strain.
    Unlimited,
    /// Estimated number of cycles, at least ten; right to an order of magnitude.
    Cycles(f64),
    /// Fewer than ten cycles.
    SingleDeployment,
    /// Tears before the full angle.
    Tears,
    /// The profile has no numbers for it.
    Unknown,
}

impl fmt::Display for Fatigue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unlimited => f.pad("unlimited"),
            Self::Cycles(cycles) => {
                let decade = 10.0_f64.powf(cycles.log10().floor());
                let rounded = (cycles / decade).round() * decade;
                f.pad(&format!("about {rounded:.0} cycles (order of magnitude)"))
            }
            Self::SingleDeployment => f.pad("single deployment"),
            Self::Tears => f.pad("tears"),
            Self::Unknown => f.pad("unknown"),
        }
    }
}

/// A ligament at the full angle of its hinge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HingeLoad {
    /// The length that the strain is computed with, millimetres: a beam's is elastic or free, as the class says.
    pub effective_length: f64,
    /// Nominal strain of the outer fibre.
    pub strain: f64,
    /// What that strain means.
    pub class: StrainClass,
    /// Torque, N mm; `None` above yield.
    pub torque: Option<f64>,
    /// Life under repeated turns.
    pub fatigue: Fatigue,
}

/// No ligament of the profile suits an angle.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum LengthError {
    /// The ligament would be longer than the profile allows.
    #[error(
        "a hinge that turns {:.1} degrees needs a ligament {needed:.2} mm long ({reason}), the profile allows \
         {allowed} mm; use a target of less curvature, a narrower ligament or a longer limit",
        angle.to_degrees()
    )]
    TooLong {
        /// Turning angle, radians.
        angle: f64,
        /// Free length needed, millimetres.
        needed: f64,
        /// Longest free length of the profile, millimetres.
        allowed: f64,
        /// Which rule asks for it.
        reason: &'static str,
    },
    /// The angle is outside 0 <= angle < pi.
    #[error("a hinge cannot turn {:.1} degrees; allowed is 0 to less than 180", angle.to_degrees())]
    Angle {
        /// Turning angle, radians.
        angle: f64,
    },
}

/// Effective length of a ligament while it is elastic, millimetres.
pub fn elastic_length(profile: &Profile, free_length: f64) -> f64 {
    match profile.ligament.shape {
        Shape::Beam(Beam { root_compliance, .. }) | Shape::Rounded(Beam { root_compliance, .. }) => {
            free_length + root_compliance * profile.ligament.width
        }
        Shape::Notch { .. } => plastic_length(profile, free_length),
    }
}

/// Effective length once the outer fibre has yielded, millimetres: a beam's free length, a notch's as if elastic.
fn plastic_length(profile: &Profile, free_length: f64) -> f64 {
    let kerf = profile.cut.kerf;
    match profile.ligament.shape {
        Shape::Beam(_) | Shape::Rounded(_) => free_length,
        Shape::Notch { .. } => {
            free_length - kerf + effective_length(0.5 * kerf, profile.ligament.width, Sides::One)
        }
    }
}

/// How far from a ligament's centre the pole lies about which its hinge turns by `angle`, millimetres, towards the groove
/// that passes. The ligament has to stand as far off its hinge point, away from that groove.
pub fn pole_offset(profile: &Profile, free_length: f64, angle: f64) -> f64 {
    profile.ligament.pole.part(angle) * free_length
}

/// Strain of the outer fibre of a ligament of the profile's width, bent by `angle` over `effective_length` (> 0).
pub fn nominal_strain(profile: &Profile, effective_length: f64, angle: f64) -> f64 {
    profile.ligament.width * angle / (2.0 * effective_length)
}

/// Turning stiffness of an elastic ligament, N mm per radian: E b h^3 / (12 L) with b the sheet's thickness.
pub fn stiffness(profile: &Profile, effective_length: f64) -> f64 {
    let width = profile.ligament.width;
    profile.material.youngs_modulus * profile.sheet.thickness * width.powi(3) / (12.0 * effective_length)
}

/// Largest angle at which a ligament springs back, radians.
pub fn yield_angle(profile: &Profile, free_length: f64) -> f64 {
    2.0 * elastic_length(profile, free_length) * profile.material.yield_strain / profile.ligament.width
}

/// Free length at which the nominal strain at `angle`, once plastic, is the profile's strain limit, millimetres.
pub fn strain_length(profile: &Profile, angle: f64) -> f64 {
    strain_length_at(profile, profile.material.strain_limit, angle)
}

/// Free length at which the nominal strain at `angle`, once plastic, is `strain` (> 0), millimetres.
pub fn strain_length_at(profile: &Profile, strain: f64, angle: f64) -> f64 {
    let effective = profile.ligament.width * angle / (2.0 * strain);
    // The free part adds to the effective length one to one, whatever the shape.
    effective - plastic_length(profile, 0.0)
}

/// Free length at which the strips outside of the hinge polygons just touch when the hinge has turned by `angle`,
/// millimetres: h tan(angle / 2). `angle` in 0 to less than pi.
pub fn clearance_length(profile: &Profile, angle: f64) -> f64 {
    profile.ligament.width * (angle / 2.0).tan()
}

/// Least free length of a ligament whose hinge turns by `angle` radians, millimetres, rounded up to 0.01 mm: within
/// the strain limit, clear of the neighbouring strips, and not below the profile's least length.
///
/// # Errors
/// The length is above the profile's `max_length`, or the angle is not finite, negative or at least pi.
pub fn required_length(profile: &Profile, angle: f64) -> Result<f64, LengthError> {
    if !(0.0..PI).contains(&angle) {
        return Err(LengthError::Angle { angle });
    }
    let [shortest, allowed] = profile.ligament_lengths();
    let rules = [
        (strain_length(profile, angle), "to stay within the strain limit"),
        (clearance_length(profile, angle), "to keep the strips beside it from colliding"),
        (shortest, "the profile's least length"),
    ];
    let [first, others @ ..] = rules;
    let (least, reason) = others.into_iter().fold(first, |a, b| if b.0 > a.0 { b } else { a });
    let needed = if least > shortest {
        (least * STEPS_PER_MM - STEP_ROUNDING).ceil() / STEPS_PER_MM
    } else {
        shortest
    };
    if needed > allowed {
        return Err(LengthError::TooLong { angle, needed, allowed, reason });
    }
    Ok(needed)
}

/// Strain, class, torque and life of a ligament of `free_length` millimetres (> 0) when its hinge has turned by
/// `angle` radians (>= 0).
pub fn assess(profile: &Profile, free_length: f64, angle: f64) -> HingeLoad {
    let material = &profile.material;
    let elastic = elastic_length(profile, free_length);
    let elastic_strain = nominal_strain(profile, elastic, angle);
    if elastic_strain <= material.yield_strain {
        return HingeLoad {
            effective_length: elastic,
            strain: elastic_strain,
            class: StrainClass::Elastic,
            torque: Some(stiffness(profile, elastic) * angle),
            fatigue: fatigue(material, elastic_strain),
        };
    }
    let effective_length = plastic_length(profile, free_length);
    let strain = nominal_strain(profile, effective_length, angle);
    let tears = strain > material.elongation;
    HingeLoad {
        effective_length,
        strain,
        class: if tears { StrainClass::BeyondElongation } else { StrainClass::PlasticLowCycle },
        torque: None,
        fatigue: fatigue(material, strain),
    }
}

/// Life of a hinge whose outer fibre goes between 0 and `strain`, an amplitude of half of that.
///
/// Within the endurance strain it is unlimited; above, Coffin-Manson: amplitude = eps_f' (2 N)^c.
pub fn fatigue(material: &Material, strain: f64) -> Fatigue {
    let amplitude = strain / 2.0;
    if strain > material.elongation {
        return Fatigue::Tears;
    }
    if material.endurance_strain.is_some_and(|endurance| amplitude <= endurance) {
        return Fatigue::Unlimited;
    }
    let Some([coefficient, exponent]) = material.coffin_manson else { return Fatigue::Unknown };
    let cycles = (amplitude / coefficient).powf(1.0 / exponent) / 2.0;
    match cycles {
        cycles if cycles.is_infinite() => Fatigue::Unlimited,
        cycles if cycles < FEW_CYCLES => Fatigue::SingleDeployment,
        cycles => Fatigue::Cycles(cycles),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::Pole;
    use std::path::Path;

    fn steel() -> Profile {
        crate::profile::load("steel-304-0.5mm", Path::new("")).unwrap()
    }

    fn rubber() -> Profile {
        crate::profile::load("nitrile-rubber-2mm", Path::new("")).unwrap()
    }

    fn set_longest(profile: &mut Profile, length: f64) {
        let Shape::Beam(beam) = &mut profile.ligament.shape else { panic!("{profile:?}") };
        beam.max_length = length;
    }

    fn close(value: f64, expected: f64, relative: f64) {
        assert!((value / expected - 1.0).abs() < relative, "{value} is not {expected}");
    }

    #[test]
    fn steel_of_half_a_millimetre_has_the_handbook_numbers() {
        let steel = steel();
        // Published to three digits: 0.873 % per degree and 2010 N mm per radian at L = h = b = 0.5.
        close(nominal_strain(&steel, 0.5, 1.0_f64.to_radians()), 0.00873, 1e-3);
        close(stiffness(&steel, 0.5), 2010.0, 1e-3);
        // Published to two digits after the point.
        for (degrees, length) in [(90.0_f64, 0.98), (102.0, 1.11), (36.0, 0.39)] {
            assert!((strain_length(&steel, degrees.to_radians()) - length).abs() < 0.005);
        }
        // h tan 45 degrees = h.
        close(clearance_length(&steel, PI / 2.0), 0.5, 1e-14);
        // Effective lengths by finite elements are given to 0.1 mm.
        for (free, effective) in [(0.5, 1.13), (1.0, 1.6), (1.5, 2.1)] {
            assert!((elastic_length(&steel, free) - effective).abs() < 0.05);
        }
    }

    #[test]
    fn notches_have_the_published_lengths() {
        let mut nylon = crate::profile::load("nylon-6-5mm", Path::new("")).unwrap();
        // Published to three digits for radius and width 0.5, and 2.5 times softer at 1 mm more.
        close(elastic_length(&nylon, 1.0), 0.653, 1e-3);
        nylon.ligament.shape = Shape::Notch { extra_length: 1.0 };
        let longer = required_length(&nylon, 0.6).unwrap();
        assert_eq!(longer, 2.0);
        close(elastic_length(&nylon, longer) / elastic_length(&nylon, 1.0), 2.5, 0.02);
    }

    #[test]
    fn a_ligament_bent_to_an_arc_turns_about_its_pole() {
        let mut profile = steel();
        assert_eq!(pole_offset(&profile, 1.0, 1.0), 0.0);
        profile.ligament.pole = Pole::Part(0.1);
        assert_eq!(pole_offset(&profile, 2.0, 1.0), 0.2);
        profile.ligament.pole = Pole::IdealArc;
        // Published to three digits.
        assert!((pole_offset(&profile, 1.0, PI / 2.0) - 0.137).abs() < 5e-4);
        for (length, angle) in [(0.7, 2.0e-4), (0.7, 0.02), (1.3, 1.1), (1.0, 2.9_f64)] {
            // The arc's ends are (0, 0) with direction 0 and r (sin a, 1 - cos a) with direction a; straight, the second one
            // was (l, 0). A point of the second piece that lies `below` the middle of the straight beam on the inner side
            // comes back to where it was: so it does as a point of the first piece.
            let radius = length / angle;
            let pole = kurbo::Point::new(0.5 * length, pole_offset(&profile, length, angle));
            let arm = kurbo::Affine::rotate(angle) * (pole - kurbo::Vec2::new(length, 0.0));
            let end = kurbo::Vec2::new(radius * angle.sin(), radius * (1.0 - angle.cos()));
            assert!((end + arm.to_vec2() - pole.to_vec2()).hypot() < 1e-9 * length, "{angle}");
        }
    }

    #[test]
    fn required_lengths_are_the_largest_of_three_rules_rounded_up() {
        let steel = steel();
        for (degrees, expected) in [(0.0_f64, 0.5), (36.0, 0.5), (45.0, 0.5), (90.0, 0.99), (102.0, 1.12)] {
            let length = required_length(&steel, degrees.to_radians()).unwrap();
            assert_eq!(length, expected, "{degrees} degrees");
        }
        // Rubber: 1.5 x (pi/2) / 2 = 1.178 by strain, 1.5 by clearance; 1.5 must not be rounded up to 1.51.
        assert_eq!(required_length(&rubber(), PI / 2.0).unwrap(), 1.5);
        // Any angle: the rules hold at the length found, and break one step below it.
        let mut angle = 0.7;
        while angle < 1.9 {
            let length = required_length(&steel, angle).unwrap();
            let holds = |length: f64| {
                nominal_strain(&steel, length, angle) <= steel.material.strain_limit * (1.0 + 1e-9)
                    && length >= clearance_length(&steel, angle) - 1e-9
                    && length >= steel.ligament_lengths()[0]
            };
            assert!(holds(length) && !holds(length - 0.0101), "{angle}: {length}");
            angle += 0.0137;
        }
    }

    #[test]
    fn angles_that_no_ligament_suits_are_refused_with_the_rule() {
        let mut steel = steel();
        // 0.5 x (150 degrees) / 0.8 = 1.636 by strain, 0.5 tan 75 degrees = 1.866 by clearance.
        assert!(required_length(&steel, 150.0_f64.to_radians()).is_ok());
        let error = required_length(&steel, 160.0_f64.to_radians()).unwrap_err().to_string();
        assert!(error.contains("160.0 degrees needs a ligament 2.84 mm long (to keep the strips"), "{error}");
        set_longest(&mut steel, 0.98);
        let error = required_length(&steel, PI / 2.0).unwrap_err().to_string();
        assert!(error.contains("0.99 mm long (to stay within the strain limit)"), "{error}");
        set_longest(&mut steel, 0.99);
        assert!(required_length(&steel, PI / 2.0).is_ok());
        for angle in [-1e-9, PI, 4.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(required_length(&steel, angle), Err(LengthError::Angle { .. })), "{angle}");
        }
    }

    #[test]
    fn a_hinge_is_elastic_up_to_the_yield_angle() {
        for profile in [steel(), rubber()] {
            let length = 1.2;
            let limit = yield_angle(&profile, length);
            let below = assess(&profile, length, limit * (1.0 - 1e-12));
            assert_eq!(below.class, StrainClass::Elastic);
            close(below.strain, profile.material.yield_strain, 1e-11);
            // A beam under pure bending: torque = stress times section modulus, sigma b h^2 / 6.
            let (b, h) = (profile.sheet.thickness, profile.ligament.width);
            let stress = profile.material.youngs_modulus * below.strain;
            close(below.torque.unwrap(), stress * b * h * h / 6.0, 1e-12);
            let above = assess(&profile, length, limit * (1.0 + 1e-12));
            assert_eq!((above.class, above.torque), (StrainClass::PlasticLowCycle, None));
            assert_eq!(above.effective_length, length);
            assert!(above.strain > below.strain);
        }
        // (0.5 + 0.625) mm of effective length: 2 x 1.125 x 0.00161 / 0.5 rad.
        close(yield_angle(&steel(), 0.5), 0.007245, 1e-12);
    }

    #[test]
    fn a_hinge_beyond_its_elongation_tears() {
        let steel = steel();
        let limit = 2.0 * 0.5 * steel.material.elongation / steel.ligament.width;
        let below = assess(&steel, 0.5, limit * (1.0 - 1e-12));
        assert_eq!((below.class, below.fatigue), (StrainClass::PlasticLowCycle, Fatigue::SingleDeployment));
        let above = assess(&steel, 0.5, limit * (1.0 + 1e-12));
        assert_eq!((above.class, above.fatigue), (StrainClass::BeyondElongation, Fatigue::Tears));
    }

    #[test]
    fn fatigue_follows_endurance_and_coffin_manson() {
        let steel = steel().material;
        assert_eq!(fatigue(&steel, 0.0), Fatigue::Unlimited);
        assert_eq!(fatigue(&steel, 2.0 * 0.00124), Fatigue::Unlimited);
        // Amplitude 0.01: (0.01 / 0.25)^-2 / 2 = 312.5.
        let Fatigue::Cycles(cycles) = fatigue(&steel, 0.02) else { panic!() };
        close(cycles, 312.5, 1e-12);
        // Halving the strain at c = -0.5 gives four times the life.
        let Fatigue::Cycles(longer) = fatigue(&steel, 0.01) else { panic!() };
        close(longer / cycles, 4.0, 1e-12);
        // Ten cycles: amplitude 0.25 x 20^-0.5 = 0.0559.
        assert!(matches!(fatigue(&steel, 2.0 * 0.0559), Fatigue::Cycles(_)));
        assert_eq!(fatigue(&steel, 2.0 * 0.0560), Fatigue::SingleDeployment);
        assert_eq!(fatigue(&steel, 0.4), Fatigue::SingleDeployment);
        let rubber = rubber().material;
        assert_eq!(fatigue(&rubber, 0.3), Fatigue::Unlimited);
        assert_eq!(fatigue(&rubber, 0.31), Fatigue::Unknown);
        let unlimited = Material { endurance_strain: None, ..steel };
        assert_eq!(fatigue(&unlimited, 0.0), Fatigue::Unlimited);
    }

    #[test]
    fn classes_have_their_names_and_estimates_their_label() {
        use StrainClass::{BeyondElongation, Elastic, PlasticLowCycle};
        let names = [Elastic, PlasticLowCycle, BeyondElongation].map(|class| class.to_string());
        assert_eq!(names, ["elastic", "plastic low-cycle", "beyond elongation"]);
        assert_eq!(Fatigue::Cycles(312.5).to_string(), "about 300 cycles (order of magnitude)");
        assert_eq!(Fatigue::Cycles(9600.0).to_string(), "about 10000 cycles (order of magnitude)");
        assert_eq!(Fatigue::SingleDeployment.to_string(), "single deployment");
    }
}
