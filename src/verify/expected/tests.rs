use std::f64::consts::PI;

use crate::fabrication::fabricate::{Fabrication, fabricate, ligament_lengths};
use crate::fabrication::test_sheet::{TestSheet, cut_open, moved, profile, sheets};
use crate::kirigami::design::Design;
use crate::profile::{Pole, Profile};
use crate::verify::grooves::Grooves;
use crate::verify::machine_file::MachineFile;
use crate::verify::{ONE_PART, Wanted, pieces};

/// The largest distance of the cuts from where they are expected, or the first fault.
fn off(design: &Design, profile: &Profile) -> Result<f64, String> {
    let lengths = ligament_lengths(design, profile).map_err(|error| error.to_string())?;
    let Fabrication { design, layout, .. } =
        fabricate(design, profile, &lengths).map_err(|error| error.to_string())?;
    let file = MachineFile { paths: layout.paths, ..MachineFile::new("cut.dxf") };
    let wanted = Wanted { design: &design, profile, hash: "", copies: &ONE_PART, tabs: None };
    let mut faults = Vec::new();
    let worst = pieces::check(&file, &Grooves::new(&file.paths), wanted, &mut faults);
    faults.first().map_or(Ok(worst), |fault| Err(fault.to_string()))
}

/// Steps, windows and holes in the border, straight and bent by up to 12 degrees; with a gap and without one.
#[test]
fn closed_sheets_are_cut_where_the_rule_says() {
    let (bend, shear) = (|y: f64| 1.2 * (y / 11.0).sin(), |x: f64| 1.2 * (x / 12.0).cos());
    for (sheet, phi) in sheets() {
        let straight = sheet.design(phi);
        for design in [moved(&straight, |x, y| [x + bend(y), y + shear(x)]), straight] {
            let found = off(&design, &profile());
            assert!(found.as_ref().is_ok_and(|off| *off < 1e-6), "{found:?}");
        }
    }
    let without_gap = TestSheet::rectangle([4, 5], [10.0, 10.0], 0.0).design(0.25 * PI);
    for degrees in [0.0_f64, 30.0, 60.0, -30.0] {
        let slope = (0.5 * degrees).to_radians().tan();
        let kink = |x: f64, y: f64| [x, y + slope * (x - 10.0).abs().min(10.0) * (1.0 - y / 10.0).max(0.0)];
        let found = off(&moved(&without_gap, kink), &profile());
        assert!(found.as_ref().is_ok_and(|off| *off < 1e-6), "{degrees}: {found:?}");
    }
}

#[test]
fn open_sheets_are_cut_where_the_rule_says() {
    let mut bent = profile();
    bent.ligament.pole = Pole::IdealArc;
    for (sheet, phi) in sheets() {
        // The poles of a corner take room from each other.
        let wider = TestSheet { gap: 1.0, ..sheet };
        for (sheet, profile) in [(sheet, profile()), (wider, bent.clone())] {
            let found = off(&cut_open(sheet.design(phi)), &profile);
            assert!(found.as_ref().is_ok_and(|off| *off < 1e-6), "{found:?}");
        }
    }
}
