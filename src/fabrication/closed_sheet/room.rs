//! Relief bars that come too near to other cuts are shortened.
//!
//! A bar is as long as its hinge's angle asks, and at least as long as the profile's shortest ligament. Where that leaves
//! less material to the next cut than the process needs, its arms are shortened: first down to what angle and strain limit
//! ask, below the profile's shortest; then, where the material may bear more than the limit, down to what its elongation
//! asks. Never below the length at which the strips beside the ligament collide.

use super::cuts::CutSet;
use super::cuts_of;
use super::ligament::measure_ligaments;
use crate::fabrication::error::FabricationError;
use crate::fabrication::ligament::MeasuredLigament;
use crate::fabrication::mechanics::{clearance_length, strain_length_at};
use crate::fabrication::topology::Topology;
use crate::fabrication::web::CutIndex;
use crate::kirigami::design::Design;
use crate::profile::{Profile, Shape};

/// Rounds of shortening; each halves what is lacking, at least.
const ROUNDS: usize = 16;
/// What is lacking at most when a bar counts as clear, millimetres.
const CLEAR: f64 = 1e-3;
/// Lengths end on whole steps of this, millimetres.
const STEP: f64 = 0.01;

/// Cuts whose bars have room, as far as they can.
pub struct Fitted {
    /// The cuts.
    pub cuts: CutSet,
    /// Who meets whom.
    pub topology: Topology,
    /// The cuts by place.
    pub index: CutIndex,
    /// Measured on the cuts.
    pub ligaments: Vec<MeasuredLigament>,
}

/// The cuts of a design, with bars shortened where they come nearer to other cuts than the process allows. What cannot be
/// mended stays as it is.
///
/// # Errors
/// Those of [`cuts_of`].
pub fn fitted(design: &Design, profile: &Profile, lengths: &[f64]) -> Result<Fitted, FabricationError> {
    let mut fitted = cut(design, profile, lengths, lengths)?;
    if matches!(profile.ligament.shape, Shape::Notch { .. }) {
        return Ok(fitted);
    }
    let mut shorter = lengths.to_vec();
    for limit in [profile.material.strain_limit, profile.material.elongation] {
        for _ in 0..ROUNDS {
            if !shorten(design, profile, &fitted.ligaments, limit, &mut shorter) {
                break;
            }
            fitted = cut(design, profile, &shorter, lengths)?;
        }
    }
    Ok(fitted)
}

fn cut(
    design: &Design,
    profile: &Profile,
    lengths: &[f64],
    asked: &[f64],
) -> Result<Fitted, FabricationError> {
    let (cuts, topology) = cuts_of(design, profile, lengths)?;
    let index = CutIndex::new(&cuts.paths);
    let mut ligaments = measure_ligaments(&design.hinges, &cuts, &index, profile);
    ligaments.iter_mut().zip(asked).for_each(|(ligament, &asked)| ligament.asked = asked);
    Ok(Fitted { cuts, topology, index, ligaments })
}

/// Shortens the bars that are too near to other cuts by what is lacking, as far as strain allows; whether any was.
fn shorten(
    design: &Design,
    profile: &Profile,
    ligaments: &[MeasuredLigament],
    strain: f64,
    lengths: &mut [f64],
) -> bool {
    let mut any = false;
    for ((hinge, ligament), length) in design.hinges.iter().zip(ligaments).zip(lengths) {
        let lacking = profile.cut.min_web - ligament.nearest_cut;
        if lacking <= CLEAR {
            continue;
        }
        let least = strain_length_at(profile, strain, hinge.angle)
            .max(clearance_length(profile, hinge.angle))
            .max(profile.cut.kerf + STEP);
        let steps = |value: f64, round: fn(f64) -> f64| round(value / STEP + 1e-8 * value.signum()) * STEP;
        // Two bars that meet both give way; each end recedes by half of what the bar loses.
        let shorter = steps(*length - lacking, f64::floor).max((least / STEP - 1e-8).ceil() * STEP);
        if shorter < *length - 0.5 * STEP {
            *length = shorter;
            any = true;
        }
    }
    any
}

/// The error of the hinge whose bar is nearest to another cut, if any is too near.
pub fn crowded(
    design: &Design,
    profile: &Profile,
    ligaments: &[MeasuredLigament],
) -> Option<FabricationError> {
    let near = ligaments.iter().enumerate().min_by(|a, b| a.1.nearest_cut.total_cmp(&b.1.nearest_cut))?;
    let (hinge, ligament) = near;
    let (web, limit) = (ligament.nearest_cut, profile.cut.min_web);
    let point = design.hinges[hinge].point;
    (web < limit - CLEAR).then_some(FabricationError::CrowdedHinge {
        hinge,
        x: point.x,
        y: point.y,
        length: ligament.length,
        web,
        limit,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fabrication::fabricate::{Fabrication, fabricate, ligament_lengths};
    use crate::fabrication::hinge_table::Verdict;
    use crate::fabrication::test_sheet::{TestSheet, profile};

    fn made(size: f64, change: impl Fn(&mut Profile)) -> Result<Fabrication, FabricationError> {
        let mut profile = profile();
        change(&mut profile);
        let sheet = TestSheet::rectangle([4, 4], [size, size], profile.hinge_gap());
        let design = sheet.design(sheet.full_angle());
        fabricate(&design, &profile, &ligament_lengths(&design, &profile).unwrap())
    }

    /// The largest size, in tenths of a millimetre, at which a sheet is not made as asked.
    fn tight(as_asked: impl Fn(f64) -> bool) -> f64 {
        let sizes = (15..80).rev().map(|tenths| 0.1 * f64::from(tenths));
        sizes.into_iter().find(|&size| !as_asked(size)).unwrap()
    }

    #[test]
    fn bars_without_room_are_shortened_to_what_their_angle_asks_and_the_report_says_so() {
        // Ligaments are planned longer than angles need: 1.6 mm where some 0.9 mm do.
        let long = |profile: &mut Profile| {
            let Shape::Beam(beam) = &mut profile.ligament.shape else { panic!() };
            beam.min_length = 1.6;
        };
        let size =
            tight(|size| made(size, long).unwrap().hinges.iter().all(|row| row.verdict == Verdict::Ok));
        let sheet = made(size, long).unwrap();
        let mut shortened = 0;
        for row in &sheet.hinges {
            assert!(row.nearest_cut >= 0.35 - 1e-3 && (row.width - 0.5).abs() < 1e-9, "{row:?}");
            assert!(row.strain <= 0.4 * (1.0 + 1e-6) && row.verdict != Verdict::Fail, "{row:?}");
            if row.length < 1.6 - 1e-9 {
                shortened += 1;
                assert!(
                    row.verdict == Verdict::Warn && row.reason.contains("instead of 1.60 mm"),
                    "{}",
                    row.reason
                );
            }
        }
        assert!(shortened > 0);
    }

    #[test]
    fn then_they_take_from_the_margin_of_strain_and_at_last_the_hinge_is_refused() {
        let with = |limit: f64, elongation: f64| {
            move |profile: &mut Profile| {
                (profile.material.strain_limit, profile.material.elongation) = (limit, elongation);
            }
        };
        let tough = with(0.2, 0.4);
        let size =
            tight(|size| made(size, tough).unwrap().hinges.iter().all(|row| row.verdict == Verdict::Ok));
        let sheet = made(size, tough).unwrap();
        let strained: Vec<_> = sheet.hinges.iter().filter(|row| row.strain > 0.2 * (1.0 + 1e-6)).collect();
        assert!(!strained.is_empty());
        for row in strained {
            assert!(row.strain <= 0.4 && row.verdict == Verdict::Warn, "{row:?}");
            assert!(row.reason.contains("limit") && row.reason.contains("room"), "{}", row.reason);
        }
        // Without that margin the same sheet is refused, by the name of a hinge.
        let error = made(size, with(0.2, 0.2)).unwrap_err();
        let FabricationError::CrowdedHinge { web, limit, .. } = error else { panic!("{error}") };
        assert!(web < limit && limit == 0.35);
        assert!(error.to_string().contains("larger pieces"), "{error}");
    }
}
