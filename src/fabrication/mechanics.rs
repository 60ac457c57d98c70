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

#[cfg(test)]
mod tests;

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

/// How far a hinge turns back when it is let go at `angle`, radians: all the way while elastic; beyond, by the moment of a
/// rectangular section that yields without hardening, 1.5 c_y (1 - (c_y / c)^2 / 3) of the angle, c_y being that of first yield.
pub fn springback(profile: &Profile, free_length: f64, angle: f64) -> f64 {
    let first = yield_angle(profile, free_length);
    if angle <= first { angle } else { 1.5 * first * (1.0 - (first / angle).powi(2) / 3.0) }
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
