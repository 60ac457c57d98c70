//! The stages together, on exact flat designs, against closed forms and invariances.

mod refused;

mod symmetry;

use std::f64::consts::PI;

use super::closed_sheet::cuts::CutSet;
use super::closed_sheet::cuts_of;
use super::closed_sheet::ligament::measure_ligaments;
use super::cuts::bounding_box;
use super::error::FabricationError;
use super::fabricate::{Fabrication, fabricate, ligament_lengths};
use super::hinge_table::Verdict;
use super::layout::{CutKind, CutPath};
use super::ligament::MeasuredLigament;
use super::outline::area;
use super::test_sheet::{ROUNDING, TestSheet, assert_moved, moved, profile, sheets, turn};
use super::web::CutIndex;
use crate::geometry::{Point3, Vector3};
use crate::kirigami::design::Design;
use crate::profile::{Pole, Profile};

fn made(sheet: &TestSheet, phi: f64) -> Fabrication {
    let design = sheet.design(phi);
    fabricate(&design, &profile(), &ligament_lengths(&design, &profile()).unwrap()).unwrap()
}

fn refused(design: &Design, profile: &Profile, length: f64) -> FabricationError {
    fabricate(design, profile, &vec![length; design.hinges.len()]).unwrap_err()
}

/// The cuts where the design lies, before placing and ordering, and the ligaments measured on them.
fn cuts(design: &Design, profile: &Profile, length: f64) -> (CutSet, Vec<MeasuredLigament>) {
    let (set, _) = cuts_of(design, profile, &vec![length; design.hinges.len()]).unwrap();
    let index = CutIndex::new(&set.paths);
    let ligaments = measure_ligaments(&design.hinges, &set, &index, profile);
    (set, ligaments)
}

fn count(paths: &[CutPath], kind: CutKind) -> usize {
    paths.iter().filter(|path| path.kind == kind).count()
}

#[test]
fn a_rectangle_has_the_cuts_and_the_size_of_the_closed_form() {
    let profile = profile();
    for cells in [[2, 2], [4, 3], [3, 4], [5, 5]] {
        let size = [10.0, 8.0];
        let sheet = TestSheet::rectangle(cells, size, profile.hinge_gap());
        let made = made(&sheet, sheet.full_angle());
        let [nx, ny] = cells;
        let edges = nx * (ny - 1) + ny * (nx - 1);
        // Vertical slits pass even corners, so they exit there at the lower and upper border; horizontal ones at
        // odd corners of the left and right border.
        let exits = (1..nx).map(|i| usize::from(i % 2 == 0) + usize::from((i + ny) % 2 == 0)).sum::<usize>()
            + (1..ny).map(|j| usize::from(j % 2 == 1) + usize::from((nx + j) % 2 == 1)).sum::<usize>();
        let paths = &made.layout.paths;
        assert_eq!(count(paths, CutKind::Slit), (nx - 1) * (ny - 1) + exits);
        assert_eq!(count(paths, CutKind::Relief), edges);
        assert_eq!((count(paths, CutKind::Border), count(paths, CutKind::Window)), (1, 0));
        assert_eq!((made.hinges.len(), made.outlines.len()), (edges, nx * ny));
        // The border's centre line runs on the lattice lines (see the generator).
        let part = bounding_box(paths).inset(0.5 * profile.cut.kerf);
        assert!((part.width() - (nx as f64 * size[0] + profile.cut.kerf)).abs() < ROUNDING);
        assert!((part.height() - (ny as f64 * size[1] + profile.cut.kerf)).abs() < ROUNDING);
        assert!((part.x0 - profile.sheet.margin).abs() < ROUNDING);
        assert!((part.y0 - profile.sheet.margin).abs() < ROUNDING);
    }
}

#[test]
fn every_ligament_is_as_wide_as_the_profile_says_and_centred_on_its_hinge() {
    let profile = profile();
    for (sheet, phi) in sheets() {
        let made = made(&sheet, phi);
        assert!(made.hinges.len() > 10);
        for (row, hinge) in made.hinges.iter().zip(&made.design.hinges) {
            assert!((row.width - profile.ligament.width).abs() < ROUNDING, "{row:?}");
            assert!(row.centre_offset < ROUNDING, "{row:?}");
            assert!(
                (row.length - ligament_lengths(&made.design, &profile).unwrap()[row.id]).abs() < ROUNDING
            );
            assert_eq!((row.point, row.pieces, row.tilt), (hinge.point, hinge.pieces, 0.0));
            assert_eq!((row.verdict, row.reason.as_str()), (Verdict::Ok, ""));
            // Strain of a plastic hinge: h theta / (2 l).
            let strain = 0.5 * profile.ligament.width * row.angle / row.length;
            assert!((row.strain - strain).abs() < ROUNDING && row.torque.is_none());
        }
    }
}

#[test]
fn a_gap_that_carries_the_poles_puts_every_ligament_beside_its_hinge() {
    let mut profile = profile();
    profile.ligament.pole = Pole::Part(0.137);
    let (sheet, phi) = sheets().remove(0);
    let length = ligament_lengths(&sheet.design(phi), &profile).unwrap()[0];
    let sheet = TestSheet { gap: profile.hinge_gap() - 2.0 * 0.137 * length, ..sheet };
    let design = sheet.design(phi);
    let made = fabricate(&design, &profile, &vec![length; design.hinges.len()]).unwrap();
    for row in &made.hinges {
        // At the border, too, where the border's cut makes room.
        assert!((row.width - 0.5).abs() < ROUNDING && row.centre_offset < ROUNDING, "{row:?}");
        assert!((row.pole_offset - 0.137 * length).abs() < ROUNDING, "{row:?}");
    }
    // A gap without it leaves what is missing, at all hinges but those of the border.
    let sheet = TestSheet { gap: profile.hinge_gap(), ..sheet };
    let made = fabricate(&sheet.design(phi), &profile, &vec![length; design.hinges.len()]).unwrap();
    let off: Vec<f64> =
        made.hinges.iter().map(|row| row.centre_offset).filter(|off| *off > ROUNDING).collect();
    assert!(off.len() > 8 && off.iter().all(|off| (off - 0.137 * length).abs() < ROUNDING), "{off:?}");
}

#[test]
fn milled_walls_set_apart_are_two_grooves_with_every_ligament_on_its_hinge() {
    let mut profile = profile();
    (profile.cut.ruled, profile.cut.kerf) = (true, 0.5);
    for apart in [0.0, 0.05, 0.12, 0.26] {
        let gap = profile.hinge_gap() + 2.0 * apart;
        let sheet = TestSheet::rectangle([4, 3], [16.0, 14.0], gap);
        let design = sheet.design(0.5);
        let lengths = vec![1.4; design.hinges.len()];
        let made = fabricate(&design, &profile, &lengths);
        if apart > 0.25 {
            // More than a groove: a core would be left between the two passes.
            let error = made.unwrap_err().to_string();
            assert!(error.contains("0.520 mm wider than the tool") && error.contains("0.500 mm"), "{error}");
            continue;
        }
        let made = made.unwrap();
        let inner = if apart > 0.0 { 2 * 6 } else { 6 };
        let exits = 5;
        assert_eq!(count(&made.layout.paths, CutKind::Slit), inner + exits);
        assert_eq!(made.outlines.len(), 12);
        for row in &made.hinges {
            assert!((row.width - 0.5).abs() < ROUNDING && row.centre_offset < ROUNDING, "{row:?}");
        }
    }
}

#[test]
fn without_a_gap_the_offset_is_half_a_ligament_and_kerf_and_is_reported() {
    let profile = profile();
    let sheet = TestSheet::rectangle([4, 4], [10.0, 10.0], 0.0);
    let design = sheet.design(0.25 * PI);
    let made = fabricate(&design, &profile, &vec![1.1; design.hinges.len()]).unwrap();
    let mut shifted = 0;
    for row in &made.hinges {
        // Hinges of border corners stay centred: there the border makes room, not a second hinge.
        let expected = if row.centre_offset > 0.1 { 0.5 * profile.hinge_gap() } else { 0.0 };
        assert!((row.centre_offset - expected).abs() < ROUNDING);
        assert!((row.width - profile.ligament.width).abs() < ROUNDING);
        if expected > 0.0 {
            shifted += 1;
            assert_eq!(row.verdict, Verdict::Warn);
        }
    }
    assert_eq!(shifted, 2 * 9); // two hinges at each inner corner
}

#[test]
fn material_and_burned_grooves_fill_the_sheet() {
    let profile = profile();
    let (kerf, width) = (profile.cut.kerf, profile.ligament.width);
    for (sheet, phi) in sheets() {
        let made = made(&sheet, phi);
        let closed = |path: &&CutPath| path.closed;
        let contour = |path: &CutPath| -> Vec<[f64; 2]> {
            path.flatten(1e-6).into_iter().map(|p| [p.x, p.y]).collect()
        };
        let sheet_area: f64 = made.layout.paths.iter().filter(closed).map(|p| area(&contour(p))).sum();
        let burned: f64 = made
            .layout
            .paths
            .iter()
            .map(|path| {
                // Closed cuts burn half their width inside.
                if path.closed { 0.5 * kerf * path.length() } else { kerf * path.length() }
            })
            .sum();
        let ligaments: f64 = made.hinges.iter().map(|row| row.length * width).sum();
        let pieces: f64 = made.outlines.iter().map(|outline| area(outline)).sum();
        let rest = sheet_area - burned - ligaments - pieces;
        // Round ends, T-joints and corners overlap by at most a kerf square each; there are two ends per path.
        assert!(rest.abs() < 2.0 * kerf * kerf * made.layout.paths.len() as f64, "{rest}");
        assert!(made.outlines.iter().all(|outline| area(outline) > 10.0));
    }
}

#[test]
fn pieces_clear_each_other_from_the_length_of_the_closed_form_on() {
    let profile = profile();
    for (sheet, phi) in sheets() {
        let design = sheet.design(phi);
        let needed = profile.ligament.width * phi.tan(); // the hinge turns by 2 phi
        let at = |length: f64| fabricate(&design, &profile, &vec![length; design.hinges.len()]);
        // A hundredth of a millimetre more than needed passes. The overlap below grows with the square of what is
        // missing and the tolerance is a hundredth of a millimetre squared, so a twentieth less is found.
        assert!(at(needed + 0.01).is_ok());
        let Err(FabricationError::HingeCollision { length, needed: told, area, .. }) = at(needed - 0.05)
        else {
            panic!("no collision found at {needed} - 0.05 mm");
        };
        assert!((length - (needed - 0.05)).abs() < ROUNDING && (told - needed).abs() < ROUNDING);
        assert!(area > 0.0 && area < 0.05);
    }
}

#[test]
fn pieces_that_only_meet_at_a_corner_are_checked_in_the_open_state() {
    let sheet = TestSheet::rectangle([4, 4], [10.0, 10.0], profile().hinge_gap());
    let mut design = sheet.design(sheet.full_angle());
    // Pieces 5 and 10 lie diagonally across the inner corner between them: lay 5 on 10.
    let shift = design.pieces[10].open[0] - design.pieces[5].open[0];
    design.pieces[5].open.iter_mut().for_each(|p| *p += 0.5 * shift);
    let error = refused(&design, &profile(), 1.1);
    assert!(matches!(error, FabricationError::CornerCollision { .. }), "{error}");
}

#[test]
fn a_part_that_is_too_large_is_refused_with_a_scale_that_fits() {
    let gap = profile().hinge_gap();
    let sheet = TestSheet::rectangle([4, 3], [10.0, 10.0], gap);
    let mut small = profile();
    (small.sheet.width, small.sheet.height) = (35.0, 200.0);
    let error = refused(&sheet.design(sheet.full_angle()), &small, 1.1);
    let FabricationError::TooLarge { width, height, room_x, room_y, scale } = error else {
        panic!("{error}")
    };
    assert!((width - 40.05).abs() < ROUNDING && (height - 30.05).abs() < ROUNDING);
    assert_eq!((room_x, room_y), (25.0, 190.0));
    // As the sides of pieces grow with the target: all but half a gap.
    let side = (10.0 - 0.5 * gap) * scale + 0.5 * gap;
    let scaled = TestSheet::rectangle([4, 3], [side, side], gap);
    let design = scaled.design(scaled.full_angle());
    assert!(fabricate(&design, &small, &vec![1.1; design.hinges.len()]).is_ok());
    // The room is used to within the ligament's width.
    assert!(4.0 * side + small.cut.kerf > room_x - gap);
}

#[test]
fn webs_below_the_limit_are_found_where_they_are() {
    let sheet = TestSheet::rectangle([4, 4], [5.0, 5.0], profile().hinge_gap());
    let design = sheet.design(sheet.full_angle());
    // The ligament itself is the narrowest web.
    let mut strict = profile();
    strict.cut.min_web = 0.51;
    let error = refused(&design, &strict, 1.1);
    let FabricationError::Web { web, limit, .. } = error else { panic!("{error}") };
    assert!((web - 0.5).abs() < ROUNDING && limit == 0.51);
    // The end of one bar approaches the next corner's bar, which stands across it: 5 - 0.55 - l/2 of material.
    // Its strain allows no shorter one.
    let mut brittle = profile();
    (brittle.material.strain_limit, brittle.material.elongation) = (0.04, 0.04);
    let error = refused(&design, &brittle, 8.3);
    let FabricationError::CrowdedHinge { web, x, y, length, .. } = error else { panic!("{error}") };
    assert!((length - 8.3).abs() < ROUNDING);
    assert!((web - (5.0 - 0.55 - 4.15)).abs() < 0.03, "{web}");
    assert!((5.0..25.1).contains(&x) && (5.0..25.1).contains(&y));
}

#[test]
fn bent_slits_keep_the_ligaments_width() {
    // A smooth map that bends the lattice lines by up to 5 degrees from piece to piece.
    let bend = |x: f64, y: f64| [x + 1.2 * (y / 11.0).sin(), y + 1.2 * (x / 12.0).cos()];
    for cells in [[6, 6], [5, 7]] {
        let sheet = TestSheet::rectangle(cells, [10.0, 10.0], 0.0);
        let (_, ligaments) = cuts(&moved(&sheet.design(0.25 * PI), bend), &profile(), 1.1);
        for ligament in &ligaments {
            // The slit is straight along the ligament, at the design distance from the bar.
            assert!((ligament.width - 0.5).abs() < 1e-6, "{ligament:?}");
        }
    }
}

#[test]
fn bent_sheets_with_steps_and_windows_are_made_too() {
    let (bend, shear) = (|y: f64| 1.2 * (y / 11.0).sin(), |x: f64| 1.2 * (x / 12.0).cos());
    for (sheet, phi) in sheets() {
        let design = moved(&sheet.design(phi), |x, y| [x + bend(y), y + shear(x)]);
        let made = fabricate(&design, &profile(), &vec![1.1; design.hinges.len()]).unwrap();
        assert_eq!(made.outlines.len(), design.pieces.len());
        for row in &made.hinges {
            // The map shears by up to 12 degrees, so hinge points leave their slits' normals by up to
            // g/2 sin 12 degrees = 0.06 mm; the ligaments themselves stay true.
            assert!((row.width - 0.5).abs() < 1e-3 && row.centre_offset < 0.06, "{row:?}");
        }
    }
}

#[test]
fn kinked_borders_keep_the_ligaments_width() {
    // The border turns at the hinge in (10, 0): the corner comes out of the sheet, or goes into it.
    for degrees in [30.0_f64, 45.0, 60.0, -30.0] {
        let slope = (0.5 * degrees).to_radians().tan();
        let kink = |x: f64, y: f64| [x, y + slope * (x - 10.0).abs().min(10.0) * (1.0 - y / 10.0).max(0.0)];
        let sheet = TestSheet::rectangle([4, 3], [10.0, 10.0], 0.0);
        for length in [0.5, 1.1, 1.6] {
            let (_, ligaments) = cuts(&moved(&sheet.design(0.25 * PI), kink), &profile(), length);
            for ligament in &ligaments {
                assert!((ligament.width - 0.5).abs() < 1e-3, "{degrees}: {ligament:?}");
            }
        }
    }
}

#[test]
fn inner_cuts_come_first_and_the_border_last() {
    for (sheet, phi) in sheets() {
        let paths = made(&sheet, phi).layout.paths;
        let rank = |path: &CutPath| match path.kind {
            CutKind::Slit | CutKind::Relief => 0,
            CutKind::Window => 1,
            CutKind::Border | CutKind::Lead => 2,
        };
        assert!(paths.windows(2).all(|pair| rank(&pair[0]) <= rank(&pair[1])));
        assert_eq!(count(&paths, CutKind::Border), 1);
        let travel = |paths: &[CutPath]| -> f64 {
            let open: Vec<_> = paths.iter().filter(|path| !path.closed).collect();
            let end = |path: &CutPath| path.vertices[path.vertices.len() - 1].point;
            open.windows(2).map(|pair| end(pair[0]).distance(pair[1].vertices[0].point)).sum()
        };
        let (unordered, _) = cuts(&sheet.design(phi), &profile(), 1.1);
        assert_eq!(unordered.paths.len(), paths.len());
        // All slits in the corners' order, then all bars: several times as far.
        assert!(travel(&paths) < 0.5 * travel(&unordered.paths), "{}", travel(&paths));
    }
}

#[test]
fn a_window_is_cut_as_a_window_with_corners_on_its_outline() {
    let (sheet, phi) = sheets()[3];
    let paths = made(&sheet, phi).layout.paths;
    assert_eq!((count(&paths, CutKind::Window), count(&paths, CutKind::Border)), (1, 1));
    let window = paths.iter().find(|path| path.kind == CutKind::Window).unwrap();
    let size = bounding_box(std::slice::from_ref(window));
    // 3 x 2 cells of 9 x 8 mm; at concave corners the cut runs on or g/2 beside the lattice lines.
    assert!((size.width() - 27.0).abs() < 0.56 && (size.height() - 16.0).abs() < 0.56, "{size:?}");
}

#[test]
fn exiting_slits_end_on_the_border() {
    for (sheet, phi) in sheets() {
        let (set, _) = cuts(&sheet.design(phi), &profile(), 1.1);
        let loops: Vec<_> = set.paths.iter().filter(|path| path.closed).collect();
        let exits: Vec<_> = set.slits.iter().filter(|slit| slit.exits).collect();
        assert!(exits.len() >= 3);
        for slit in exits {
            let end = slit.points.last().unwrap();
            assert!(loops.iter().flat_map(|path| &path.vertices).any(|vertex| vertex.point == *end));
        }
    }
}

#[test]
fn notes_stand_outside_the_part_and_inside_the_sheet() {
    let (sheet, phi) = sheets()[0];
    let made = made(&sheet, phi);
    let part = bounding_box(&made.layout.paths);
    assert_eq!(made.layout.notes.len(), 4);
    assert!(
        made.layout.notes.iter().any(|note| note.text == "kerf 0.05 mm already applied: cut on the line")
    );
    for note in &made.layout.notes {
        assert!(note.position.y > part.y1 || note.position.x > part.x1);
        assert!(note.position.y + note.height <= made.layout.sheet[1]);
    }
}

#[test]
fn placing_twice_moves_once() {
    let (sheet, phi) = sheets()[2];
    let first = made(&sheet, phi);
    let lengths = ligament_lengths(&first.design, &profile()).unwrap();
    let again = fabricate(&first.design, &profile(), &lengths).unwrap();
    for (a, b) in first.design.corners.iter().zip(&again.design.corners) {
        assert!((a - b).norm() < ROUNDING);
    }
    assert_eq!(first.design.pieces[3].open, sheet.design(phi).pieces[3].open);
}
