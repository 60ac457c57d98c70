//! The hinge placement report's rows: what was measured on the layout, and a verdict per hinge.

use kurbo::Point;

use super::ligament::MeasuredLigament;
use super::mechanics::{
    Fatigue, StrainClass, assess, elastic_length, pole_offset, required_length, stiffness,
};
use crate::geometry::plane::doubled_area;
use crate::geometry::{Point3, Vector3};
use crate::kirigami::design::{Design, Hinge, PatternKind, State};
use crate::profile::Profile;

/// Whether a hinge can be made as designed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// As designed.
    Ok,
    /// Makeable, but less exact than it should be.
    Warn,
    /// Do not cut this.
    Fail,
}

/// One hinge of the report. Millimetres and radians, in the sheet's frame.
#[derive(Debug, Clone, PartialEq)]
pub struct HingeRow {
    /// Index into [`Design::hinges`].
    pub id: usize,
    /// The two pieces.
    pub pieces: [usize; 2],
    /// The hinge point.
    pub point: Point3,
    /// Unit axis.
    pub axis: Vector3,
    /// Angle between the axis and the sheet's normal, in 0..=pi/2.
    pub tilt: f64,
    /// Turning angle.
    pub angle: f64,
    /// Width of the ligament, measured.
    pub width: f64,
    /// Free length of the ligament, measured.
    pub length: f64,
    /// How far from the hinge point, away from the groove that passes, the ligament's centre belongs, so that it turns
    /// about the point.
    pub pole_offset: f64,
    /// Distance of the ligament's centre from there, measured.
    pub centre_offset: f64,
    /// Material between the relief bar and the nearest cut that does not belong to the same corner.
    pub nearest_cut: f64,
    /// Nominal strain of the outer fibre at the full angle, for the profile's width and the measured length.
    pub strain: f64,
    /// What that strain means.
    pub strain_class: StrainClass,
    /// The length that the strain is computed with.
    pub effective_length: f64,
    /// Turning stiffness while elastic, N mm per radian.
    pub stiffness: f64,
    /// The same of a plastic that has taken up moisture; `None` where that makes no difference.
    pub conditioned_stiffness: Option<f64>,
    /// By how much the ligament is wider than the least web that the process leaves, millimetres.
    pub width_margin: f64,
    /// By how much it is wider than what the heat of the cuts on both sides of it changes, millimetres; `None` where the
    /// profile says nothing of it.
    pub heat_margin: Option<f64>,
    /// Torque at the full angle, N mm; `None` above yield.
    pub torque: Option<f64>,
    /// Life under repeated turns.
    pub fatigue: Fatigue,
    /// The verdict.
    pub verdict: Verdict,
    /// Why, in words; empty if the verdict is ok.
    pub reason: String,
}

/// Ligaments whose width differs from the profile's by more than this fail, millimetres.
const WIDTH_TOLERANCE: f64 = 0.02;
/// Largest offset of the ligament's centre that passes where nothing forces it, millimetres.
const CENTRE_TOLERANCE: f64 = 0.01;
/// Largest offset of the ligament's centre, in ligament widths, that passes without a warning where the design forces it.
const OFFSET_LIMIT: f64 = 0.05;
/// Largest error of the axis at the sheet's faces, in ligament widths, that passes without a warning.
const TILT_LIMIT: f64 = 0.1;
/// Below this turning angle (radians) the axis is ill-conditioned: an error of a thousandth of a piece in the open
/// state turns it by more than a degree.
const LEAST_ANGLE: f64 = 3.0 * std::f64::consts::PI / 180.0;

/// The rows of all hinges, in the design's order.
///
/// `design`: in sheet coordinates; `ligaments`: measured on its cuts, one per hinge.
pub fn hinge_rows(design: &Design, ligaments: &[MeasuredLigament], profile: &Profile) -> Vec<HingeRow> {
    design
        .hinges
        .iter()
        .zip(ligaments)
        .enumerate()
        .map(|(id, (hinge, ligament))| {
            let row = hinge_row(id, hinge, ligament, profile);
            if is_exact(design, profile, ligament) { strict(row) } else { row }
        })
        .collect()
}

/// Whether nothing keeps the cuts from putting the ligaments of a design where they belong: it was made by this program, with
/// the gap that this profile needs.
fn is_exact(design: &Design, profile: &Profile, ligament: &MeasuredLigament) -> bool {
    let poles = match (design.pattern, design.sheet_state) {
        (PatternKind::RotatingRectangles, Some(_)) => true,
        _ => ligament.pole_offset == 0.0,
    };
    let gap = design.sheet_state == Some(State::Open) || (design.gap - profile.hinge_gap()).abs() < 1e-6;
    design.pattern != PatternKind::Imported && gap && poles
}

/// The row of a hinge whose ligament could be at its place: it fails where it is not.
fn strict(mut row: HingeRow) -> HingeRow {
    if row.centre_offset <= CENTRE_TOLERANCE {
        return row;
    }
    row.verdict = Verdict::Fail;
    if !row.reason.contains(OFF) {
        let others = if row.reason.is_empty() { String::new() } else { format!("; {}", row.reason) };
        row.reason = off_its_place(&row) + &others;
    }
    row
}

/// How a reason begins that tells of a ligament beside its place.
const OFF: &str = "ligament's centre is";

fn off_its_place(row: &HingeRow) -> String {
    let place = if row.pole_offset == 0.0 { "the hinge point" } else { "its place beside the hinge point" };
    format!("{OFF} {:.3} mm from {place}", row.centre_offset)
}

/// The rows of hinges that were not laid out: with the profile's width and the length that each angle needs (at most
/// the profile's longest), as if their cuts were exact and nothing else were near. Where the design has no flat state
/// the tilt is that against the mean normal of the two pieces.
pub fn planned_rows(design: &Design, profile: &Profile) -> Vec<HingeRow> {
    let longest = profile.ligament_lengths()[1];
    let plan = |(id, hinge): (usize, &Hinge)| {
        let length = required_length(profile, hinge.angle).unwrap_or(longest);
        let ligament = MeasuredLigament {
            width: profile.ligament.width,
            length,
            asked: length,
            pole_offset: pole_offset(profile, length, hinge.angle),
            centre: Point::new(hinge.point.x, hinge.point.y),
            centre_offset: 0.5 * (profile.hinge_gap() - design.gap).abs(),
            nearest_cut: f64::INFINITY,
            bar: [Point::ORIGIN; 2],
        };
        let up = match design.sheet_state {
            Some(_) => Vector3::z(),
            None => hinge
                .pieces
                .iter()
                .map(|&piece| doubled_area(&design.pieces[piece].closed).normalize())
                .sum::<Vector3>()
                .try_normalize(0.0)
                .unwrap_or_else(Vector3::z),
        };
        let rise = hinge.axis.dot(&up).clamp(-1.0, 1.0);
        // The same tilt, in a frame whose z is up.
        let axis = Vector3::new((1.0 - rise * rise).sqrt(), 0.0, rise);
        let mut row = hinge_row(id, &Hinge { axis, ..hinge.clone() }, &ligament, profile);
        row.axis = hinge.axis;
        if let Err(error) = required_length(profile, hinge.angle) {
            row.verdict = Verdict::Fail;
            row.reason = error.to_string();
        }
        row
    };
    design.hinges.iter().enumerate().map(plan).collect()
}

fn hinge_row(id: usize, hinge: &Hinge, ligament: &MeasuredLigament, profile: &Profile) -> HingeRow {
    let load = assess(profile, ligament.length, hinge.angle);
    let material = &profile.material;
    let elastic = stiffness(profile, elastic_length(profile, ligament.length));
    let softer = material.conditioned_modulus.map(|modulus| modulus / material.youngs_modulus);
    let mut row = HingeRow {
        id,
        pieces: hinge.pieces,
        point: hinge.point,
        axis: hinge.axis,
        tilt: hinge.axis.xy().norm().atan2(hinge.axis.z.abs()),
        angle: hinge.angle,
        width: ligament.width,
        length: ligament.length,
        pole_offset: ligament.pole_offset,
        centre_offset: ligament.centre_offset,
        nearest_cut: ligament.nearest_cut,
        strain: load.strain,
        strain_class: load.class,
        effective_length: load.effective_length,
        stiffness: elastic,
        conditioned_stiffness: softer.map(|softer| softer * elastic),
        width_margin: ligament.width - profile.cut.min_web,
        heat_margin: profile.cut.heat_affected.map(|zone| ligament.width - 2.0 * zone),
        torque: load.torque,
        fatigue: load.fatigue,
        verdict: Verdict::Ok,
        reason: String::new(),
    };
    let findings = findings(&row, ligament.asked, profile);
    row.verdict = findings.iter().map(|(verdict, _)| *verdict).max().unwrap_or(Verdict::Ok);
    row.reason = findings.into_iter().map(|(_, reason)| reason).collect::<Vec<_>>().join("; ");
    row
}

/// A ligament that lacks this much of the length that was asked for was shortened for want of room, millimetres.
const SHORTENED: f64 = 5e-3;

/// Everything that is wrong with a hinge, worst first; `asked`: the length that was asked for.
fn findings(row: &HingeRow, asked: f64, profile: &Profile) -> Vec<(Verdict, String)> {
    let width = profile.ligament.width;
    let mut findings = Vec::new();
    // A millionth above the limit: rounding of a length that was chosen to meet it.
    if row.strain > profile.material.strain_limit * (1.0 + 1e-6) {
        let text = format!(
            "strain {:.1} % is above the limit of {:.1} %",
            100.0 * row.strain,
            100.0 * profile.material.strain_limit
        );
        let spared = row.length < asked - SHORTENED && row.strain <= profile.material.elongation;
        findings.push((if spared { Verdict::Warn } else { Verdict::Fail }, text));
    }
    if (row.width - width).abs() > WIDTH_TOLERANCE {
        let text = format!("ligament is {:.3} mm wide instead of {width:.3} mm", row.width);
        findings.push((Verdict::Fail, text));
    }
    // A micrometre, as for all webs.
    if row.nearest_cut < profile.cut.min_web - 1e-3 {
        let text = format!(
            "only {:.3} mm to the next cut, the cut needs {:.3} mm",
            row.nearest_cut, profile.cut.min_web
        );
        findings.push((Verdict::Fail, text));
    }
    if row.length < asked - SHORTENED {
        let text = format!("for want of room its bar is {:.2} mm long instead of {asked:.2} mm", row.length);
        findings.push((Verdict::Warn, text));
    }
    if row.centre_offset > OFFSET_LIMIT * width {
        findings.push((Verdict::Warn, off_its_place(row)));
    }
    if let Some(margin) = row.heat_margin.filter(|margin| *margin < 0.0) {
        let text = format!("the heat of both cuts reaches through it, by {:.3} mm", -margin);
        findings.push((Verdict::Warn, text));
    }
    let tilt_error = 0.5 * profile.sheet.thickness * row.tilt.tan();
    if !profile.cut.ruled && tilt_error > TILT_LIMIT * width {
        let text = format!(
            "axis tilts by {:.1} degrees, {tilt_error:.3} mm at the sheet's faces",
            row.tilt.to_degrees()
        );
        findings.push((Verdict::Warn, text));
    }
    if row.angle < LEAST_ANGLE {
        let text = format!("axis is ill-conditioned: it turns by {:.2} degrees only", row.angle.to_degrees());
        findings.push((Verdict::Warn, text));
    }
    findings
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fabrication::test_sheet::profile;

    const GOOD: MeasuredLigament = MeasuredLigament {
        width: 0.5,
        length: 1.0,
        asked: 1.0,
        centre: Point::ORIGIN,
        pole_offset: 0.0,
        centre_offset: 0.0,
        nearest_cut: 2.0,
        bar: [Point::new(-0.475, 0.275), Point::new(0.475, 0.275)],
    };

    fn row(ligament: MeasuredLigament, tilt: f64, angle: f64) -> HingeRow {
        let axis = Vector3::new(0.0, -tilt.sin(), -tilt.cos());
        let hinge = Hinge { pieces: [3, 7], vertices: [0, 1], point: Point3::origin(), axis, angle };
        hinge_row(5, &hinge, &ligament, &profile())
    }

    #[test]
    fn a_good_hinge_is_ok() {
        let row = row(GOOD, 0.05, 1.5);
        assert_eq!((row.verdict, row.reason.as_str(), row.id, row.pieces), (Verdict::Ok, "", 5, [3, 7]));
        // The axis points down: its tilt is that of the line. Rounding of one arc tangent.
        assert!((row.tilt - 0.05).abs() < 1e-15);
    }

    #[test]
    fn a_notch_in_nylon_has_two_stiffnesses_and_no_room_for_a_thinner_web() {
        let nylon = crate::profile::load("nylon-6-5mm", std::path::Path::new("")).unwrap();
        let hinge = Hinge {
            pieces: [0, 1],
            vertices: [0, 0],
            point: Point3::origin(),
            axis: Vector3::z(),
            angle: 36_f64.to_radians(),
        };
        let row = hinge_row(0, &hinge, &MeasuredLigament { length: 1.0, ..GOOD }, &nylon);
        // 3300 x 5 x 0.125 / (12 x 0.653), and 1500 instead of 3300: to three digits of the length.
        assert!((row.stiffness - 263.2).abs() < 0.3, "{row:?}");
        assert!((row.conditioned_stiffness.unwrap() / row.stiffness - 1500.0 / 3300.0).abs() < 1e-12);
        assert_eq!((row.width_margin, row.strain_class), (0.0, StrainClass::PlasticLowCycle));
        assert!((row.strain - 0.2406).abs() < 5e-4 && (row.effective_length - 0.653).abs() < 5e-4);
        assert_eq!(row.verdict, Verdict::Ok, "{}", row.reason);
    }

    #[test]
    fn ligaments_that_could_be_at_their_place_fail_beside_it() {
        let good = row(GOOD, 0.0, 1.5);
        for (centre_offset, verdict) in [(0.009, Verdict::Ok), (0.011, Verdict::Fail), (0.03, Verdict::Fail)]
        {
            let row = strict(row(MeasuredLigament { centre_offset, ..GOOD }, 0.0, 1.5));
            assert_eq!(row.verdict, verdict);
            assert_eq!(
                row.reason.matches(OFF).count(),
                usize::from(verdict == Verdict::Fail),
                "{}",
                row.reason
            );
        }
        assert_eq!(strict(good.clone()), good);
    }

    #[test]
    fn heat_from_both_sides_leaves_a_margin_or_a_warning() {
        let hinge = Hinge {
            pieces: [3, 7],
            vertices: [0, 1],
            point: Point3::origin(),
            axis: Vector3::z(),
            angle: 1.5,
        };
        let with = |zone| {
            let mut profile = profile();
            profile.cut.heat_affected = zone;
            hinge_row(5, &hinge, &GOOD, &profile)
        };
        assert_eq!((with(None).heat_margin, with(Some(0.125)).heat_margin), (None, Some(0.25)));
        assert_eq!(with(Some(0.25)).verdict, Verdict::Ok);
        let row = with(Some(0.3));
        assert_eq!(row.verdict, Verdict::Warn);
        assert!(row.reason.contains("heat") && row.reason.ends_with("0.100 mm"), "{}", row.reason);
    }

    #[test]
    fn each_fault_has_its_verdict_and_reason() {
        let faults = [
            (row(MeasuredLigament { width: 0.521, ..GOOD }, 0.0, 1.5), Verdict::Fail, "0.521 mm wide"),
            (row(MeasuredLigament { width: 0.479, ..GOOD }, 0.0, 1.5), Verdict::Fail, "0.479 mm wide"),
            (
                row(MeasuredLigament { nearest_cut: 0.3, ..GOOD }, 0.0, 1.5),
                Verdict::Fail,
                "0.300 mm to the next",
            ),
            // 0.5 x 1.7 / (2 x 1.0) = 42.5 %.
            (row(GOOD, 0.0, 1.7), Verdict::Fail, "strain 42.5 % is above the limit of 40.0 %"),
            (
                row(MeasuredLigament { centre_offset: 0.026, ..GOOD }, 0.0, 1.5),
                Verdict::Warn,
                "0.026 mm from",
            ),
            // 0.25 tan 12 degrees = 0.053 mm, a tenth of the width is 0.05 mm.
            (row(GOOD, 12_f64.to_radians(), 1.5), Verdict::Warn, "axis tilts by 12.0 degrees, 0.053 mm"),
            (row(GOOD, 0.0, 0.02), Verdict::Warn, "ill-conditioned"),
        ];
        for (row, verdict, reason) in faults {
            assert_eq!(row.verdict, verdict, "{}", row.reason);
            assert!(row.reason.contains(reason), "{}", row.reason);
        }
        let both = row(MeasuredLigament { width: 0.4, centre_offset: 0.1, ..GOOD }, 0.0, 1.5);
        assert_eq!(both.verdict, Verdict::Fail);
        assert!(both.reason.contains("wide") && both.reason.contains("; ligament's centre"));
    }
}
