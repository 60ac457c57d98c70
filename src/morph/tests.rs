use super::*;
use crate::geometry::{Point3, Vector3};
use crate::kirigami::design::State;
use crate::snap::sheet::tests::{bistable, squares};
use crate::solid::Walls;
use crate::solid::clash::Placed;
use crate::solid::outline::plate;

/// Half the turn of the hinges of [`squares`], radians.
const TURN: f64 = 40.0 * std::f64::consts::PI / 180.0;

fn largest_miss(design: &Design, step: &Step, state: State) -> f64 {
    let sheet = design.sheet_state.unwrap_or(State::Closed);
    let misses = design.pieces.iter().zip(&step.poses).flat_map(|(piece, pose)| {
        let ends = piece.vertices(sheet).iter().zip(piece.vertices(state));
        ends.map(|(p, q)| (pose.apply(p) - q).norm())
    });
    misses.fold(0.0, f64::max)
}

#[test]
fn rotating_squares_follow_the_closed_form() {
    let design = squares(4, 3);
    for design in [design.clone(), Design { sheet_state: Some(State::Open), ..design }] {
        let morph = morph(&design, None);
        assert_eq!(morph.steps.len(), STEPS + 1);
        assert!(morph.jump < 1e-6 && !morph.thick);
        for (i, step) in morph.steps.iter().enumerate() {
            assert!((step.at - i as f64 / STEPS as f64).abs() < 1e-15);
            let turn = step.at * TURN;
            // All hinges turn alike and nothing is strained, to what the minimisation leaves (its floor: 1e-6 of the drive).
            assert!(step.strain < 1e-5 && step.mean_parting <= step.parting.0, "{i}: {}", step.strain);
            assert!(step.angles.iter().all(|angle| (angle - 2.0 * turn).abs() < 1e-5), "{:?}", step.angles);
            assert!((step.share - step.at).abs() < 1e-5 && step.lean < 1e-6);
            // Twelve squares and six holes, which are rhombi with the angle twice the turn.
            let area = 1.0 + 0.5 * (2.0 * turn).sin();
            assert!((step.area_expansion - area).abs() < 1e-4, "{i}: {} {area}", step.area_expansion);
            // Neighbours turn in opposite senses; middles stand a pitch apart, the sheet's middle stays on its line.
            let pitch = 10.0 * (turn.cos() + turn.sin());
            let middle = |piece: usize| {
                let sheet = design.sheet_state.unwrap();
                step.poses[piece].apply(&crate::geometry::centroid(design.pieces[piece].vertices(sheet)))
            };
            assert!(((middle(1) - middle(0)) - Vector3::new(pitch, 0.0, 0.0)).norm() < 1e-3);
            assert!(((middle(4) - middle(0)) - Vector3::new(0.0, pitch, 0.0)).norm() < 1e-3);
            let open = 10.0 * (TURN.cos() + TURN.sin());
            let along = 10.0 + step.at * (open - 10.0);
            let whole = Point3::from((0..12).map(|p| middle(p).coords).sum::<Vector3>() / 12.0);
            assert!((whole - Point3::new(1.5 * along, along, 0.0)).norm() < 1e-9);
        }
        assert!(largest_miss(&design, &morph.steps[0], State::Closed) < 1e-12);
        assert!(largest_miss(&design, &morph.steps[STEPS], State::Open) < 1e-12);
    }
}

#[test]
fn what_snaps_is_strained_by_the_misfit_of_one_cell() {
    let design = bistable(8.4, 18.0, [6, 6]);
    let morph = morph(&design, None);
    let worst = morph.worst();
    assert!((worst.share - 0.5).abs() < 0.05, "half way: {}", worst.share);
    // Half way a rectangle's corners are off the 8-gons' by 1 - cos(phi) of half its sides, in either direction, if those only
    // moved evenly; pieces at the border give way.
    let most = 4.2 * 2.0_f64.sqrt() * (1.0 - 18_f64.to_radians().cos());
    assert!(worst.parting.0 > 0.5 * most && worst.parting.0 < 1.1 * most, "{} {most}", worst.parting.0);
    assert!(morph.jump < 1e-4);
    for step in &morph.steps {
        assert!((step.strain - step.parting.0 / design.mean_edge()).abs() < 1e-12);
    }
}

#[test]
fn the_sheet_as_a_whole_goes_evenly_to_where_the_open_state_is() {
    let flat = squares(4, 3);
    let motion = nalgebra::Isometry3::new(Vector3::new(300.0, -200.0, 70.0), Vector3::new(0.3, 2.1, -0.4));
    let mut design = flat.clone();
    for piece in &mut design.pieces {
        piece.open.iter_mut().for_each(|p| *p = motion * *p);
    }
    let (here, there) = (morph(&flat, None), morph(&design, None));
    assert!(largest_miss(&design, &there.steps[0], State::Closed) < 1e-12);
    assert!(largest_miss(&design, &there.steps[STEPS], State::Open) < 1e-9);
    let full = nalgebra::Rotation3::new(Vector3::new(0.3, 2.1, -0.4)).angle();
    for (one, two) in here.steps.iter().zip(&there.steps) {
        assert!((one.strain - two.strain).abs() < 1e-5 && (one.angles[1] - two.angles[1]).abs() < 1e-4);
        // What the second has in addition is one motion of all pieces, which turns evenly.
        let extra = |piece: usize| two.poses[piece].after(&one.poses[piece].inverse());
        let turn = crate::geometry::rotation::axis_angle(&extra(0).rotation).1;
        assert!((turn - one.at * full).abs() < 1e-3, "{turn}");
        assert!((1..12).all(|piece| (extra(piece).rotation - extra(0).rotation).norm() < 1e-3));
    }
    // No step is longer than another by much.
    let p = flat.pieces[5].closed[0];
    let places: Vec<Point3> = there.steps.iter().map(|step| step.poses[5].apply(&p)).collect();
    let lengths: Vec<f64> = places.windows(2).map(|pair| (pair[1] - pair[0]).norm()).collect();
    let mean = lengths.iter().sum::<f64>() / STEPS as f64;
    assert!(lengths.iter().all(|length| (length / mean - 1.0).abs() < 0.1), "{lengths:?}");
}

/// The squares as plates whose sides stand `margin` outside the hinge points, in the closed state.
fn plates(design: &Design, margin: f64) -> Vec<Placed> {
    let placed = |piece: &crate::kirigami::design::Piece| {
        let middle = crate::geometry::centroid(&piece.closed);
        let grown = |p: &Point3| {
            let q = middle + (p - middle) * (1.0 + margin / 5.0);
            [q.x, q.y]
        };
        let outline = piece.closed.iter().map(grown).collect();
        let still = RigidMotion::identity();
        Placed {
            plate: plate(&[outline]).unwrap(),
            motion: still,
            misfit: 0.0,
            corners: piece.corners.clone(),
        }
    };
    design.pieces.iter().map(placed).collect()
}

#[test]
fn collisions_on_the_way_are_found_where_they_are() {
    let design = squares(4, 3);
    let follow = |margin: f64| {
        let pieces = plates(&design, margin);
        morph(&design, Some(&Thick::new(&[], &pieces, 2.0, Walls::Vertical)))
    };
    // Squares within their hinge points never meet on this way.
    let free = follow(-0.05);
    assert!(free.thick && free.collision().is_none());
    // Two sides that stand out by 0.3 mm are 0.6 mm deep in each other in the closed state, and near it nearly so.
    let tight = follow(0.3);
    let (step, clash) = tight.collision().unwrap();
    assert_eq!(step.at, 1.0 / 24.0);
    assert!(clash.depth > 0.5 && clash.depth < 0.65, "{clash:?}");
    assert!(tight.steps[1..STEPS].iter().all(|step| step.collision.is_some()));
}

#[test]
fn a_piece_that_passes_through_another_collides_half_way() {
    let design = squares(2, 1);
    let pieces = plates(&design, 0.0);
    let thick = Thick::new(&[], &pieces, 0.5, Walls::Vertical);
    let shifted = |x: f64| {
        let moved = RigidMotion { translation: Vector3::new(x, 3.0, 0.0), ..RigidMotion::identity() };
        thick.collision(&[RigidMotion::identity(), moved])
    };
    // The second square, 10 mm wide, comes from the right and goes out to the left.
    // It may overlap by 0.01 mm, and by twice the 0.01 mm that outlines may be off.
    assert!(shifted(-0.029).is_none() && shifted(-0.031).is_some());
    assert!(shifted(0.5).is_none() && shifted(-20.5).is_none());
    let clash = shifted(-10.0).unwrap();
    // Deeper than the sheet is thick they would leave along the normal.
    assert!((clash.depth - 0.5).abs() < 1e-9 && clash.pieces == [0, 1], "{clash:?}");
    let clash = shifted(-0.2).unwrap();
    assert!((clash.depth - 0.2).abs() < 1e-3, "{clash:?}");
}
