//! Exact regular bistable sheets, cut closed and cut open: beams in steel, notches in nylon.

use std::path::Path;

use crate::fabrication::error::FabricationError;
use crate::fabrication::fabricate::{Fabrication, fabricate, ligament_lengths};
use crate::fabrication::hinge_table::Verdict;
use crate::fabrication::layout::{CutKind, CutPath};
use crate::fabrication::outline::area;
use crate::kirigami::bistable::cell::BistableCell;
use crate::kirigami::bistable::pattern::regular;
use crate::kirigami::design::{Design, State};
use crate::profile::{Profile, Shape, load};

/// Rounding of coordinates of some 100 mm through a few dozen operations.
const ROUNDING: f64 = 1e-9;

fn profile(name: &str) -> Profile {
    load(name, Path::new("")).unwrap()
}

fn cell(profile: &Profile, size: [f64; 2], rectangle: [f64; 2]) -> BistableCell {
    BistableCell { cell: size, rectangle, phi: 18_f64.to_radians(), gap: profile.hinge_gap() }
}

fn design(cell: &BistableCell, counts: [usize; 2], state: State) -> Design {
    assert!(cell.misses().is_empty());
    let (mesh, pattern) = regular(cell, counts);
    pattern.design(&mesh, cell.gap, Some(state))
}

fn sheets() -> Vec<(Profile, BistableCell, [usize; 2])> {
    let (steel, nylon) = (profile("steel-304-0.5mm"), profile("nylon-6-5mm"));
    let mut longer = nylon.clone();
    longer.ligament.shape = Shape::Notch { extra_length: 1.0 };
    vec![
        (steel.clone(), cell(&steel, [12.0, 11.0], [4.4, 3.6]), [4, 3]),
        (steel.clone(), cell(&steel, [14.0, 14.0], [5.0, 5.2]), [1, 2]),
        (nylon.clone(), cell(&nylon, [24.0, 24.0], [7.5, 7.0]), [4, 4]),
        (nylon.clone(), cell(&nylon, [25.0, 25.0], [9.5, 9.5]), [3, 2]),
        (longer.clone(), cell(&longer, [24.0, 24.0], [9.0, 9.0]), [3, 3]),
    ]
}

fn made(design: &Design, profile: &Profile) -> Fabrication {
    fabricate(design, profile, &ligament_lengths(design, profile).unwrap()).unwrap()
}

fn count(paths: &[CutPath], kind: CutKind) -> usize {
    paths.iter().filter(|path| path.kind == kind).count()
}

#[test]
fn every_ligament_is_as_wide_as_the_profile_says_and_centred_on_its_hinge() {
    for (profile, cell, counts) in sheets() {
        let design = design(&cell, counts, State::Closed);
        let made = made(&design, &profile);
        let [nx, ny] = counts;
        assert_eq!((made.hinges.len(), made.outlines.len()), (4 * nx * ny, nx * ny + (nx + 1) * (ny + 1)));
        for row in &made.hinges {
            assert!((row.width - profile.ligament.width).abs() < ROUNDING, "{row:?}");
            assert!(row.centre_offset < ROUNDING, "{row:?}");
            assert_eq!(row.verdict, Verdict::Ok, "{row:?}");
        }
        // Two slits meet on every edge of the grid inside, and are one; each border edge has one that leaves.
        let paths = &made.layout.paths;
        let (inner, border) = (nx * (ny - 1) + ny * (nx - 1), 2 * (nx + ny));
        assert_eq!(count(paths, CutKind::Slit), inner + border);
        let bars = if profile.ligament_lengths()[0] > profile.cut.kerf { 4 * nx * ny } else { 0 };
        assert_eq!((count(paths, CutKind::Relief), count(paths, CutKind::Border)), (bars, 1));
        assert_eq!(paths.last().map(|path| path.kind), Some(CutKind::Border));
        assert!(made.outlines.iter().all(|outline| area(outline) > 1.0));
    }
}

#[test]
fn sheets_that_are_cut_expanded_have_a_window_at_every_crossing() {
    for (profile, cell, [nx, ny]) in sheets().into_iter().take(3) {
        let made = made(&design(&cell, [nx, ny], State::Open), &profile);
        for row in &made.hinges {
            assert!((row.width - profile.ligament.width).abs() < ROUNDING, "{row:?}");
            assert!(row.centre_offset < 0.01, "{row:?}");
            assert_ne!(row.verdict, Verdict::Fail, "{row:?}");
        }
        let paths = &made.layout.paths;
        let inner = nx * (ny - 1) + ny * (nx - 1);
        assert_eq!((count(paths, CutKind::Window), count(paths, CutKind::Border)), (inner, 1));
        assert_eq!(paths.len(), inner + 1);
        assert_eq!(made.outlines.len(), nx * ny + (nx + 1) * (ny + 1));
    }
    // Those with border corners too slender to be cut round in the expanded state are refused for it.
    for (profile, cell, counts) in sheets().into_iter().skip(3) {
        let design = design(&cell, counts, State::Open);
        let error = fabricate(&design, &profile, &ligament_lengths(&design, &profile).unwrap()).unwrap_err();
        assert!(matches!(error, FabricationError::ShortSide { .. }), "{error}");
    }
}
