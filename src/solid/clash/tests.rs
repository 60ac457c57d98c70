//! Overlaps of known depth.

use nalgebra::Rotation3;

use super::super::outline::plate;
use super::*;

const HALF: f64 = 0.25;

/// A square of side 4 about the origin, moved.
fn piece(turn: Vector3, by: Vector3) -> Placed {
    let square = vec![[-2.0, -2.0], [2.0, -2.0], [2.0, 2.0], [-2.0, 2.0]];
    let rotation = Rotation3::from_scaled_axis(turn).into_inner();
    Placed {
        plate: plate(&[square]).unwrap(),
        motion: RigidMotion { rotation, translation: by },
        misfit: 0.0,
        corners: vec![],
    }
}

fn depth(pieces: &[Placed]) -> Option<f64> {
    match deepest("open", &[], pieces, 2.0 * HALF, Walls::Vertical) {
        Ok(clash) => clash.map(|clash| clash.depth),
        Err(SolidError::Clash(clash)) => {
            assert!(clash.depth > clash.limit && clash.pieces == [0, 1]);
            Some(clash.depth)
        }
        Err(error) => panic!("{error}"),
    }
}

#[test]
fn overlaps_are_as_deep_as_their_closed_forms() {
    let still = piece(Vector3::zeros(), Vector3::zeros());
    let of = |turn: Vector3, by: Vector3| depth(&[still.clone(), piece(turn, by)]);
    let none = Vector3::zeros();
    // Beside each other, and on top of each other, by a tenth of a millimetre too near. Rounding only.
    assert!((of(none, Vector3::new(3.9, 0.3, 0.0)).unwrap() - 0.1).abs() < 1e-6);
    assert!((of(none, Vector3::new(1.0, 1.0, 0.4)).unwrap() - 0.1).abs() < 1e-6);
    assert_eq!(of(none, Vector3::new(4.001, 0.0, 0.0)), None);
    assert_eq!(of(none, Vector3::new(1.0, 1.0, 0.501)), None);
    // Folded by 30 degrees about the line in which their mid-planes meet: the lower edges run t/2 sin(30)
    // deep.
    let fold = 30.0_f64.to_radians();
    let hinge = Vector3::new(2.0 + 2.0 * fold.cos(), 0.0, 2.0 * fold.sin());
    let found = of(Vector3::new(0.0, -fold, 0.0), hinge).unwrap();
    assert!((found - HALF * fold.sin()).abs() < 1e-6, "{found}");
    // One stands in the other like a blade: 0.2 mm of its edge below the upper face.
    let blade =
        of(Vector3::new(std::f64::consts::FRAC_PI_2, 0.0, 0.0), Vector3::new(0.0, 0.0, 2.05)).unwrap();
    assert!((blade - 0.2).abs() < 1e-6, "{blade}");
    // Crossed in the middle, no corner inside the other: each runs through the other's mid-plane, t/2
    // deep.
    let crossed =
        of(Vector3::new(std::f64::consts::FRAC_PI_2, 0.0, 0.0), Vector3::new(0.5, 0.0, 0.0)).unwrap();
    assert!((crossed - HALF).abs() < 1e-6, "{crossed}");
}

#[test]
fn far_pieces_are_found_and_the_order_does_not_matter() {
    // A chain of 200 pieces, the last of which comes back on to the first.
    let mut pieces: Vec<Placed> =
        (0..200).map(|i| piece(Vector3::zeros(), Vector3::new(4.1 * f64::from(i), 0.0, 0.0))).collect();
    assert_eq!(depth(&pieces), None);
    pieces.push(piece(Vector3::new(0.0, 0.0, 0.4), Vector3::new(-1.0, 0.2, 0.1)));
    let clash = |pieces: &[Placed]| match deepest("open", &[], pieces, 0.5, Walls::Vertical) {
        Err(SolidError::Clash(clash)) => clash,
        other => panic!("{other:?}"),
    };
    let there = clash(&pieces);
    assert_eq!(there.pieces, [0, 200]);
    pieces.reverse();
    let back = clash(&pieces);
    assert_eq!((back.pieces, back.depth), ([0, 200], there.depth));
}

#[test]
fn tilted_hinges_excuse_what_vertical_walls_cannot_follow_but_only_near_them() {
    use crate::fabrication::test_sheet::profile;
    let fold = 0.05;
    let hinge = Vector3::new(2.0 + 2.0 * f64::cos(fold), 0.0, 2.0 * f64::sin(fold));
    let mut pieces = [piece(Vector3::zeros(), Vector3::zeros()), piece(Vector3::new(0.0, -fold, 0.0), hinge)];
    // They meet in a corner: no cut lies between them.
    pieces.iter_mut().for_each(|piece| piece.corners = vec![7]);
    // The edges run t/2 sin(fold) = 0.0125 mm deep, all along.
    let mut row = crate::fabrication::hinge_table::planned_rows(
        &crate::fabrication::test_sheet::TestSheet::rectangle([2, 1], [9.0, 9.0], 0.0).design(0.7),
        &profile(),
    )
    .remove(0);
    (row.pieces, row.tilt, row.angle) = ([0, 1], 0.2, 1.5);
    row.point = Point3::new(2.0, -2.0, 0.0);
    row.length = 1.0;
    let try_with = |walls| deepest("open", std::slice::from_ref(&row), &pieces, 2.0 * HALF, walls);
    // Beside the hinge they may, at the far end of the edge they may not.
    match try_with(Walls::Vertical) {
        Err(SolidError::Clash(clash)) => assert!(clash.tilt == 0.0 && clash.limit == PLAY, "{clash}"),
        other => panic!("{other:?}"),
    }
    row.length = 5.0;
    let excused = deepest("open", &[row.clone()], &pieces, 2.0 * HALF, Walls::Vertical).unwrap().unwrap();
    let tilt = 2.0 * HALF * f64::tan(0.2) * f64::sin(0.75);
    assert!((excused.tilt - tilt).abs() < 1e-12 && (excused.depth - HALF * fold.sin()).abs() < 1e-6);
    assert!(deepest("open", &[row], &pieces, 2.0 * HALF, Walls::Ruled).is_err());
}

#[test]
fn rims_across_a_cut_may_meet_by_a_ligament_s_width_and_no_more() {
    use crate::fabrication::test_sheet::{TestSheet, profile};
    let design = TestSheet::rectangle([2, 1], [9.0, 9.0], 0.0).design(0.7);
    let row = crate::fabrication::hinge_table::planned_rows(&design, &profile()).remove(0);
    let meet = |by: f64, corners: [usize; 2]| {
        let mut pieces = [0.0, 4.0 - by].map(|x| piece(Vector3::zeros(), Vector3::new(x, 0.0, 0.0)));
        pieces.iter_mut().zip(corners).for_each(|(piece, corner)| piece.corners = vec![corner]);
        deepest("open", std::slice::from_ref(&row), &pieces, 2.0, Walls::Vertical)
    };
    let touching = meet(0.4, [1, 2]).unwrap().unwrap();
    assert!((touching.depth - 0.4).abs() < 1e-6 && touching.rim == 0.5, "{touching}");
    // Farther, or around a corner of the sheet, nothing excuses it.
    assert!(matches!(meet(0.6, [1, 2]), Err(SolidError::Clash(clash)) if clash.rim == 0.0));
    assert!(matches!(meet(0.4, [1, 1]), Err(SolidError::Clash(clash)) if clash.limit == PLAY));
}
