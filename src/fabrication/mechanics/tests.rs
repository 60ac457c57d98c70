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
fn a_yielded_section_gives_back_what_its_moment_holds() {
    let steel = steel();
    for (length, factor) in [(0.7, 0.4), (0.7, 1.0), (1.0, 1.3), (1.2, 4.0), (1.2, 120.0)] {
        let first = yield_angle(&steel, length);
        let angle = factor * first;
        // Stress over half of the section, without hardening, by the midpoint rule; 1 is that of first yield at the face.
        const LAYERS: usize = 20_000;
        let heights = (0..LAYERS).map(|i| (i as f64 + 0.5) / LAYERS as f64);
        let moment: f64 = heights.map(|y| (factor * y).min(1.0) * y / LAYERS as f64).sum();
        // Let go, it unbends elastically by that moment; 1/3 is the elastic moment of first yield.
        close(springback(&steel, length, angle), first * moment * 3.0, 1e-6);
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
