use super::copies::{moved, offsets};
use super::*;
use crate::fabrication::fabricate::{fabricate, ligament_lengths};
use crate::fabrication::layout::CutKind;
use crate::fabrication::order::Rest;
use crate::fabrication::test_sheet::{TestSheet, profile};
use crate::profile::Sheet;

fn made() -> Fabrication {
    let sheet = TestSheet::rectangle([4, 3], [10.0, 10.0], profile().hinge_gap());
    let design = sheet.design(sheet.full_angle());
    fabricate(&design, &profile(), &ligament_lengths(&design, &profile()).unwrap()).unwrap()
}

#[test]
fn copies_fill_rows_from_the_lower_left_and_no_more_than_fit() {
    let sheet = Sheet { width: 100.0, height: 65.0, margin: 5.0, thickness: 0.5 };
    let part = Rect::new(5.0, 5.0, 35.0, 25.0);
    // 3 x 30 = 90 mm would fill the width, but not with 1 mm between them; 2 x 20 and 3 x 1 fill no 55 mm.
    assert_eq!(offsets(part, &sheet, 3, 1e-9).unwrap()[2].x, 60.0 + 2e-9);
    let two = offsets(part, &sheet, 4, 1.0).unwrap();
    assert_eq!(two, [[0.0, 0.0], [31.0, 0.0], [0.0, 21.0], [31.0, 21.0]].map(|[x, y]| Vec2::new(x, y)));
    let error = offsets(part, &sheet, 5, 1.0).unwrap_err().to_string();
    assert!(
        error.contains("5 copies of 30.00 x 20.00 mm") && error.contains("4 do, 2 in each of 2 rows"),
        "{error}"
    );
    // To within rounding a copy that just fits does.
    assert_eq!(offsets(part, &Sheet { width: 71.0 - 1e-9, ..sheet }, 2, 1.0).unwrap().len(), 2);
}

#[test]
fn copies_are_cut_inside_first_and_all_borders_last() {
    let (one, profile) = (made(), profile());
    let options = CutOptions { copies: 3, spacing: 4.0, ..CutOptions::default() };
    let plan = cut_plan(&one, &profile, &options).unwrap();
    let (paths, alone) = (&plan.layout.paths, &one.layout.paths);
    assert_eq!(
        (paths.len(), paths.iter().filter(|path| path.kind == CutKind::Border).count()),
        (3 * alone.len(), 3)
    );
    assert!(paths[paths.len() - 3..].iter().all(|path| path.kind == CutKind::Border));
    // As many cuts of every kind and length as three times the part's.
    let sum =
        |paths: &[crate::fabrication::layout::CutPath]| paths.iter().map(|path| path.length()).sum::<f64>();
    assert!((sum(paths) - 3.0 * sum(alone)).abs() < 1e-9);
    let boxes: Vec<Rect> =
        paths[paths.len() - 3..].iter().map(|path| bounding_box(std::slice::from_ref(path))).collect();
    let mut lefts: Vec<f64> = boxes.iter().map(|place| place.x0).collect();
    lefts.sort_by(f64::total_cmp);
    // 40 mm of part, a kerf and the spacing; the first stays where the design lies.
    assert!(
        lefts.iter().zip([5.025, 49.075, 93.125]).all(|(x, right)| (x - right).abs() < 1e-9),
        "{lefts:?}"
    );
    assert!(plan.report.travel.length >= plan.report.travel.bound);
}

#[test]
fn times_are_those_of_constant_speeds() {
    let (one, mut profile) = (made(), profile());
    let plan = |profile: &Profile, passes: usize| {
        cut_plan(&one, profile, &CutOptions { passes, ..CutOptions::default() }).unwrap()
    };
    let CutReport { cuts, length, travel, times, .. } = plan(&profile, 1).report;
    let times = times.unwrap();
    assert!(
        (times.cutting - length / 10.0).abs() < 1e-9 && (times.travel - travel.length / 500.0).abs() < 1e-9
    );
    assert!((times.piercing - 0.1 * cuts as f64).abs() < 1e-9 && times.cost().is_none());
    // The profile's speed is that of all passes together; each pierces, and open cuts are gone back.
    let thrice = plan(&profile, 3);
    let again = thrice.report.times.unwrap();
    assert_eq!((again.cutting, again.piercing), (times.cutting, 3.0 * times.piercing));
    assert!(again.travel > times.travel && thrice.layout.paths == one.layout.paths);
    assert!(thrice.layout.notes.iter().any(|note| note.text == "every cut 3 times"));
    profile.machine.as_mut().unwrap().hourly_rate = Some(90.0);
    let cost = plan(&profile, 1).report.times.unwrap().cost().unwrap();
    assert!((cost - 90.0 * times.total() / 3600.0).abs() < 1e-9);
    profile.machine = None;
    assert_eq!(plan(&profile, 1).report.times, None);
}

#[test]
fn a_moved_cut_keeps_its_arcs() {
    let path = &made().layout.paths[0];
    let back = moved(&moved(path, Vec2::new(3.0, -4.0)), Vec2::new(-3.0, 4.0));
    assert!(back.vertices.iter().zip(&path.vertices).all(|(a, b)| a.point.distance(b.point) < 1e-12));
}

#[test]
fn slits_pierced_in_the_middle_are_two_cuts_that_begin_far_from_ligaments() {
    let (one, profile) = (made(), profile());
    let plan =
        cut_plan(&one, &profile, &CutOptions { pierce: Pierce::MidSlit, ..CutOptions::default() }).unwrap();
    let of = |paths: &[crate::fabrication::layout::CutPath]| -> (usize, f64) {
        let slits: Vec<_> = paths.iter().filter(|path| path.kind == CutKind::Slit).collect();
        (slits.len(), slits.iter().map(|path| path.length()).sum())
    };
    let ((halves, after), (slits, before)) = (of(&plan.layout.paths), of(&one.layout.paths));
    assert!(halves == 2 * slits && (after - before).abs() < 1e-9);
    let halves: Vec<_> = plan.layout.paths.iter().filter(|path| path.kind == CutKind::Slit).collect();
    let points = hinge_points(&one.design);
    for pair in halves.chunks_exact(2) {
        let [begin, other] = [0, 1].map(|i| pair[i].vertices[0].point);
        assert_eq!(begin, other);
        assert!(points.iter().all(|point| point.distance(begin) > 3.0), "{begin}");
    }
}

#[test]
fn hinges_rest_as_long_as_asked_where_there_is_enough_else_to_cut() {
    let sheet = TestSheet::rectangle([12, 12], [10.0, 10.0], profile().hinge_gap());
    let design = sheet.design(sheet.full_angle());
    let one = fabricate(&design, &profile(), &ligament_lengths(&design, &profile()).unwrap()).unwrap();
    let plan =
        |order: CutOrder| cut_plan(&one, &profile(), &CutOptions { order, ..CutOptions::default() }).unwrap();
    let [travel, heat] = [CutOrder::Travel, CutOrder::Heat { cool: 5.0, within: None }].map(plan);
    // A bar and its slit follow each other at once.
    let cuts = travel.layout.paths.len();
    let points = hinge_points(&one.design);
    let hasty = rest(&travel.layout.paths, &points, &pace(&profile()), 5.0);
    assert!(hasty.least < 0.1 && hasty.early > cuts / 2, "{hasty:?}");
    // Only the last cuts have nothing else to wait with.
    let Rest { least, early, .. } = heat.report.rest;
    assert!(least > hasty.least && early < cuts / 20, "{least} {early} of {cuts}");
    assert_eq!(travel.layout.paths.len(), heat.layout.paths.len());
    let sum = |plan: &CutPlan| plan.layout.paths.iter().map(|path| path.length()).sum::<f64>();
    assert!((sum(&travel) - sum(&heat)).abs() < 1e-6);
    assert_eq!(heat.layout.paths.last().unwrap().kind, CutKind::Border);
    assert!(heat.report.travel.length > travel.report.travel.length);
}
