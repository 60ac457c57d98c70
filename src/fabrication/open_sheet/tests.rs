//! Open sheets laid out from exact flat designs, against closed forms and invariances.

use kurbo::{Point, Vec2};

use super::cuts::WindowCuts;
use super::cuts_of;
use super::ligament::measure_ligaments;
use super::narrow::check_rims;
use crate::fabrication::cuts::bounding_box;
use crate::fabrication::error::FabricationError;
use crate::fabrication::fabricate::{Fabrication, fabricate, ligament_lengths};
use crate::fabrication::hinge_table::Verdict;
use crate::fabrication::layout::{CutKind, CutPath};
use crate::fabrication::ligament::MeasuredLigament;
use crate::fabrication::outline::area;
use crate::fabrication::test_sheet::{ROUNDING, TestSheet, assert_moved, cut_open, profile, sheets, turn};
use crate::fabrication::web::CutIndex;
use crate::geometry::{Point3, Vector3};
use crate::kirigami::design::Design;
use crate::profile::Pole;

fn made(sheet: &TestSheet, phi: f64) -> Fabrication {
    let design = cut_open(sheet.design(phi));
    fabricate(&design, &profile(), &ligament_lengths(&design, &profile()).unwrap()).unwrap()
}

fn refused(design: &Design, length: f64) -> FabricationError {
    fabricate(design, &profile(), &vec![length; design.hinges.len()]).map(|_| ()).unwrap_err()
}

/// The cuts where the design lies and the ligaments measured on them.
fn cuts(design: &Design, length: f64) -> (WindowCuts, Vec<MeasuredLigament>) {
    let (set, _) = cuts_of(design, &profile(), &vec![length; design.hinges.len()]).unwrap();
    let ligaments = measure_ligaments(&design.hinges, &set, &CutIndex::new(&set.paths), &profile());
    (set, ligaments)
}

fn moved(design: &Design, motion: impl Fn(f64, f64) -> [f64; 2]) -> Design {
    let apply = |p: &mut Point3| {
        let [x, y] = motion(p.x, p.y);
        *p = Point3::new(x, y, p.z);
    };
    let mut design = design.clone();
    design.pieces.iter_mut().flat_map(|piece| &mut piece.open).for_each(apply);
    design.hinges.iter_mut().map(|hinge| &mut hinge.point).for_each(apply);
    design
}

fn turned_by(angle: f64, v: Vec2) -> Vec2 {
    angle.cos() * v + angle.sin() * v.turn_90()
}

fn square() -> (TestSheet, f64) {
    sheets().swap_remove(0)
}

fn path_area(path: &CutPath) -> f64 {
    let mut points: Vec<[f64; 2]> = path.flatten(1e-5).iter().map(|p| [p.x, p.y]).collect();
    points.push(points[0]);
    area(&points)
}

#[test]
fn every_inner_corner_is_a_window_and_the_border_comes_last() {
    let [nx, ny] = [4, 3];
    let (sheet, phi) = square();
    let made = made(&sheet, phi);
    let paths = &made.layout.paths;
    assert_eq!(paths.len(), (nx - 1) * (ny - 1) + 1);
    assert!(paths.iter().all(|path| path.closed));
    assert!(paths.iter().rev().skip(1).all(|path| path.kind == CutKind::Window));
    assert_eq!(paths[paths.len() - 1].kind, CutKind::Border);
    assert_eq!((made.hinges.len(), made.outlines.len()), (nx * (ny - 1) + ny * (nx - 1), nx * ny));
    // A missing block of cells is one window more.
    let (with_hole, phi) = sheets().swap_remove(3);
    let paths = self::made(&with_hole, phi).layout.paths;
    assert_eq!(paths.iter().filter(|path| path.kind == CutKind::Border).count(), 1);
    let largest = paths.iter().filter(|path| path.kind == CutKind::Window).map(path_area).fold(0.0, f64::min);
    assert!(largest < -500.0, "{largest}");
}

#[test]
fn every_ligament_is_as_wide_and_as_long_as_it_should_be_and_centred_on_its_hinge() {
    for (sheet, phi) in sheets() {
        let made = made(&sheet, phi);
        let lengths = ligament_lengths(&made.design, &profile()).unwrap();
        for (row, hinge) in made.hinges.iter().zip(&made.design.hinges) {
            assert!((row.width - 0.5).abs() < ROUNDING && row.centre_offset < ROUNDING, "{row:?}");
            // Feet are cut for the length on both sides.
            assert!((row.length - lengths[row.id]).abs() < ROUNDING, "{row:?}");
            assert_eq!((row.point, row.pieces, row.tilt), (hinge.point, hinge.pieces, 0.0));
            assert_eq!((row.verdict, row.reason.as_str()), (Verdict::Ok, ""));
            let strain = 0.5 * 0.5 * row.angle / row.length;
            assert!((row.strain - strain).abs() < ROUNDING);
            // From the flat across the piece to the next window.
            assert!(row.nearest_cut > 4.0, "{row:?}");
        }
    }
}

#[test]
fn a_bent_ligament_whose_pole_is_not_its_middle_stands_where_it_turns_about_the_hinge() {
    for (sheet, phi) in sheets() {
        // Room for what bulges out further: the two poles of a corner.
        let design = cut_open(TestSheet { gap: 1.0, ..sheet }.design(phi));
        let mut bent = profile();
        bent.ligament.pole = Pole::IdealArc;
        let lengths = ligament_lengths(&design, &bent).unwrap();
        let (set, _) = cuts_of(&design, &bent, &lengths).unwrap();
        let ligaments = measure_ligaments(&design.hinges, &set, &CutIndex::new(&set.paths), &bent);
        for (i, (hinge, found)) in design.hinges.iter().zip(&ligaments).enumerate() {
            assert!(found.centre_offset < ROUNDING && found.pole_offset > 0.05, "{found:?}");
            assert!((found.width - 0.5).abs() < ROUNDING, "{found:?}");
            // The ends of the straight ligament; the second one turns about the hinge point with its piece. An arc of
            // constant curvature between them is as long as the ligament: its chord is 2 l / a sin(a/2).
            let along = set.necks[i].along;
            let [from, to] = [-0.5, 0.5].map(|part| found.centre + part * found.length * along);
            let point = Point::new(hinge.point.x, hinge.point.y);
            let turned = point + turned_by(hinge.angle * hinge.axis.z.signum(), to - point);
            let chord = 2.0 * found.length / hinge.angle * (0.5 * hinge.angle).sin();
            assert!(
                (turned.distance(from) - chord).abs() < ROUNDING,
                "{i}: {} {chord}",
                turned.distance(from)
            );
        }
    }
}

#[test]
fn a_window_is_its_hinge_polygon_with_feet_and_without_the_corners_at_the_ligaments() {
    let (sheet, phi) = square();
    let design = cut_open(sheet.design(phi));
    let (set, _) = cuts(&design, 1.0);
    // The middle of the sheet: at a hinge a square corner loses the triangle above the flat, (h + k)/2 high, and the
    // feet add what lies between the flat, the walls at l/2 + r and the sides. Its angle differs from 90 degrees by the
    // gap's wedge, so compare with the polygon cut by half planes and united with rectangles.
    let windows = set.paths.iter().filter(|path| path.kind == CutKind::Window);
    let (reach, root) = (0.5 * (0.5 + 0.05), 0.25 * 0.5 - 0.5 * 0.05);
    let wall = 0.5 * 1.0 + root;
    let rounding = (1.0 - 0.25 * std::f64::consts::PI) * root * root;
    for window in windows {
        let cut = -path_area(window);
        let hinges = design.hinges.iter().filter(|hinge| {
            let at = Point::new(hinge.point.x, hinge.point.y);
            window.vertices.iter().filter(|v| v.point.distance(at) < 0.75).count() >= 4
        });
        let mut points: Vec<[f64; 2]> = hinges.map(|hinge| [hinge.point.x, hinge.point.y]).collect();
        assert_eq!(points.len(), 4);
        let middle = points.iter().fold([0.0; 2], |m, p| [m[0] + 0.25 * p[0], m[1] + 0.25 * p[1]]);
        points.sort_by(|a, b| {
            let angle = |p: &[f64; 2]| (p[1] - middle[1]).atan2(p[0] - middle[0]);
            angle(a).total_cmp(&angle(b))
        });
        points.push(points[0]);
        // For right angles: triangle lost reach^2, feet (wall - reach)^2, less the two roundings.
        let expected = area(&points) + 4.0 * ((wall - reach).powi(2) - reach.powi(2) - 2.0 * rounding);
        // The corners differ from right angles by up to 3.2 degrees, in pairs of opposite signs.
        assert!((cut - expected).abs() < 0.01, "{cut} {expected}");
    }
}

#[test]
fn turning_the_sheet_turns_the_cuts() {
    for (sheet, phi) in sheets() {
        let design = cut_open(sheet.design(phi));
        let (straight, _) = cuts(&design, 1.1);
        let (turned, _) = cuts(&moved(&design, turn), 1.1);
        assert_moved(&straight.paths, &turned.paths, turn);
    }
}

#[test]
fn bent_sheets_keep_the_ligaments_width_and_length() {
    let bend = |x: f64, y: f64| [x + 1.2 * (y / 11.0).sin(), y + 1.2 * (x / 12.0).cos()];
    for (sheet, phi) in sheets() {
        let design = moved(&cut_open(sheet.design(phi)), bend);
        let (set, ligaments) = cuts(&design, 1.0);
        check_rims(&set.paths, 0.05, 0.35).unwrap();
        for ligament in &ligaments {
            assert!(
                (ligament.width - 0.5).abs() < ROUNDING && ligament.centre_offset < ROUNDING,
                "{ligament:?}"
            );
            // Where a corner is blunt its own flat may be longer than the feet.
            assert!((1.0 - ROUNDING..1.1).contains(&ligament.length), "{ligament:?}");
        }
        let ordered = set.clone().started_on_longest_straights();
        let index = CutIndex::new(&ordered.paths);
        let again = measure_ligaments(&design.hinges, &ordered, &index, &profile());
        for (a, b) in ligaments.iter().zip(&again) {
            assert!((a.width - b.width).abs() < ROUNDING && (a.length - b.length).abs() < ROUNDING);
        }
    }
}

#[test]
fn hinges_that_open_less_get_deeper_feet_until_the_sides_end() {
    let (sheet, full) = square();
    // Half open: the closing window's corner is sharp, the other one blunt.
    let half = made(&sheet, 0.5 * full);
    assert!(half.hinges.iter().all(|row| (row.width - 0.5).abs() < ROUNDING && row.verdict == Verdict::Ok));
    // At 4 degrees the walls beside a ligament of 0.5 mm would be 0.35 / tan 2 degrees + 1 mm = 10 mm high.
    let design = cut_open(sheet.design(0.5 * 4_f64.to_radians()));
    let error = refused(&design, 0.5).to_string();
    assert!(error.contains("take larger pieces, shorter ligaments or hinges that turn further"), "{error}");
}

#[test]
fn windows_by_nearest_neighbour_start_far_from_ligaments() {
    let (sheet, phi) = sheets().swap_remove(2);
    let made = made(&sheet, phi);
    for path in &made.layout.paths {
        let start = path.vertices[0].point;
        let nearest = made.hinges.iter().map(|row| start.distance(Point::new(row.point.x, row.point.y)));
        assert!(nearest.fold(f64::INFINITY, f64::min) > 3.0);
    }
    let starts: Vec<Point> = made.layout.paths.iter().map(|path| path.vertices[0].point).collect();
    let travel: f64 = starts.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
    // One step per window is one cell's side of the open sheet, 11.3 mm; some steps back are longer.
    assert!(travel < 2.0 * 11.4 * starts.len() as f64, "{travel}");
}

#[test]
fn the_part_is_placed_in_its_open_state() {
    let (sheet, phi) = sheets().swap_remove(1);
    let first = made(&sheet, phi);
    let part = bounding_box(&first.layout.paths).inset(0.025);
    assert!((part.x0 - 5.0).abs() < ROUNDING && (part.y0 - 5.0).abs() < ROUNDING);
    // The closed state and its corners stay where they are.
    let design = cut_open(sheet.design(phi));
    assert_eq!(first.design.corners, design.corners);
    assert_eq!(first.design.pieces[2].closed, design.pieces[2].closed);
    let lengths = ligament_lengths(&first.design, &profile()).unwrap();
    let again = fabricate(&first.design, &profile(), &lengths).unwrap();
    for (a, b) in first.design.pieces.iter().zip(&again.design.pieces) {
        assert!((a.open[0] - b.open[0]).norm() < ROUNDING);
    }
    let mut small = profile();
    small.sheet.width = 0.9 * part.width() + 10.0;
    let error = fabricate(&design, &small, &lengths).unwrap_err();
    let FabricationError::TooLarge { width, scale, .. } = error else { panic!("{error}") };
    assert!((width - part.width()).abs() < ROUNDING && (scale - 0.9).abs() < 0.01, "{width} {scale}");
}

#[test]
fn a_gap_that_the_folded_ligaments_do_not_fit_is_refused_with_the_one_needed() {
    let narrow = TestSheet::rectangle([4, 4], [10.0, 10.0], 0.5);
    let error = refused(&cut_open(narrow.design(narrow.full_angle())), 1.1);
    let FabricationError::NarrowGap { found, needed, .. } = error else { panic!("{error}") };
    assert!((found - 0.5).abs() < ROUNDING && (needed - 0.55).abs() < ROUNDING);
    assert!(error.to_string().contains("optimise the design with a gap (gap_mm) of at least that"));
    let wide = TestSheet::rectangle([4, 4], [10.0, 10.0], needed);
    let design = cut_open(wide.design(wide.full_angle()));
    assert!(fabricate(&design, &profile(), &vec![1.1; design.hinges.len()]).is_ok());
}

#[test]
fn pieces_and_ligaments_that_collide_when_closed_are_named() {
    let (sheet, phi) = square();
    let good = cut_open(sheet.design(phi));
    // The windows' own corners leave h tan(a/2) = 0.473 mm and a little more, so roots never meet.
    let short = fabricate(&good, &profile(), &vec![0.1; good.hinges.len()]).unwrap();
    assert!(short.hinges.iter().all(|row| row.length > 0.44 && row.length < 0.56));
    // A hinge that turns too far.
    let mut design = good.clone();
    design.hinges[3].angle += 0.1;
    let error = refused(&design, 1.1);
    assert!(matches!(error, FabricationError::HingeCollision { hinge: 3, .. }), "{error}");
    // The pieces diagonally across the inner corner between them: 5 on 10.
    let mut design = cut_open(TestSheet::rectangle([4, 4], [10.0, 10.0], 0.55).design(phi));
    let shift = design.pieces[10].closed[0] - design.pieces[5].closed[2];
    let towards = Vector3::new(5.0, 5.0, 0.0) + shift;
    design.pieces[5].closed.iter_mut().for_each(|p| *p += towards);
    let error = refused(&design, 1.1).to_string();
    assert!(error.contains("in the closed state") || error.contains("apart"), "{error}");
}

#[test]
fn bad_designs_are_refused_by_name() {
    let (sheet, phi) = square();
    let good = cut_open(sheet.design(phi));
    let edit = |change: fn(&mut Design)| {
        let mut design = good.clone();
        change(&mut design);
        refused(&design, 1.1).to_string()
    };
    assert!(edit(|d| d.sheet_state = None).contains("neither state of the design is flat"));
    assert!(
        edit(|d| d.pieces[3].open[1].z = 0.1).contains("piece 3: a vertex of its sheet state has z = 0.1")
    );
    assert!(edit(|d| d.corners[3].x = f64::NAN).contains("corner 3"));
    assert!(edit(|d| d.hinges.truncate(16)).contains("carries 0 hinges"));
    let collapsed = edit(|d| d.pieces[5].open = vec![Point3::origin(); 4]);
    assert!(collapsed.contains("piece 5") || collapsed.contains("hinge"), "{collapsed}");
    // A closed state in space is no fault.
    let mut lifted = good.clone();
    lifted.corners.iter_mut().for_each(|p| p.z += 7.0);
    lifted.pieces.iter_mut().flat_map(|piece| &mut piece.closed).for_each(|p| p.z += 7.0);
    assert!(fabricate(&lifted, &profile(), &vec![1.1; lifted.hinges.len()]).is_ok());
}

fn ring(points: &[(f64, f64)]) -> CutPath {
    use crate::fabrication::layout::PathVertex;
    let vertices = points.iter().map(|&(x, y)| PathVertex { point: Point::new(x, y), bulge: 0.0 });
    CutPath { kind: CutKind::Window, vertices: vertices.collect(), closed: true }
}

#[test]
fn thin_webs_and_narrow_windows_of_one_rim_are_told_apart() {
    // Two chambers, joined by a channel 1 mm long whose half width is `half`; clockwise: the material to the left.
    let chambers = |half: f64| {
        let right = [(0.5, half), (0.5, 3.0), (4.0, 3.0), (4.0, -3.0), (0.5, -3.0), (0.5, -half)];
        let left = right.iter().map(|&(x, y)| (-x, -y));
        ring(&right.iter().copied().chain(left).collect::<Vec<_>>())
    };
    assert!(path_area(&chambers(0.5)) < 0.0);
    assert_eq!(check_rims(&[chambers(0.03)], 0.05, 0.35), Ok(()));
    let error = check_rims(&[chambers(0.02)], 0.05, 0.35).unwrap_err();
    assert!(
        matches!(error, FabricationError::NarrowWindow { width, .. } if (width - 0.04).abs() < 1e-12),
        "{error}"
    );
    // The same line backwards bounds material inside: the channel is a web now.
    let turned = |half: f64| {
        let mut path = chambers(half);
        path.vertices.reverse();
        path
    };
    assert_eq!(check_rims(&[turned(0.21)], 0.05, 0.35), Ok(()));
    let error = check_rims(&[turned(0.19)], 0.05, 0.35).unwrap_err();
    assert!(matches!(error, FabricationError::Web { web, .. } if (web - 0.33).abs() < 1e-12), "{error}");
    let crossed = ring(&[(0.0, 0.0), (2.0, 2.0), (2.0, 0.0), (0.0, 2.0)]);
    let error = check_rims(&[crossed], 0.05, 0.35).unwrap_err();
    assert!(matches!(error, FabricationError::NarrowWindow { width: 0.0, .. }), "{error}");
}
