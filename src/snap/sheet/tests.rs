use super::super::cell::Cell;
use super::super::ligament::tests::nylon;
use super::*;
use crate::kirigami::bistable::cell::BistableCell;
use crate::kirigami::bistable::pattern::regular;
use crate::kirigami::design::{PatternKind, Piece};
use crate::kirigami::hinges::{Joint as Vertices, assemble};

/// A regular sheet: cells of 20 mm, rectangles of `side`, without a gap.
pub(crate) fn bistable(side: f64, degrees: f64, counts: [usize; 2]) -> Design {
    let cell =
        BistableCell { cell: [20.0; 2], rectangle: [side; 2], phi: f64::to_radians(degrees), gap: 0.0 };
    let (mesh, pattern) = regular(&cell, counts);
    pattern.design(&mesh, 0.0, Some(State::Closed))
}

fn snapped(design: &Design, ligament: &Ligament) -> SheetSnap {
    Sheet::new(design, &vec![*ligament; design.hinges.len()]).snap(12)
}

/// Squares of side 10 that turn by 40 degrees, neighbours in opposite senses: a mechanism.
pub(crate) fn squares(columns: i32, rows: i32) -> Design {
    let turn = 40_f64.to_radians();
    let pitch = 10.0 * (turn.cos() + turn.sin());
    let mut pieces = Vec::new();
    for (j, i) in (0..rows).flat_map(|j| (0..columns).map(move |i| (j, i))) {
        let sense = if (i + j) % 2 == 0 { turn } else { -turn };
        let rotation = nalgebra::Rotation2::new(sense);
        let corner = |[x, y]: [f64; 2], spacing: f64, turned: bool| {
            let p = nalgebra::Vector2::new(5.0 * x, 5.0 * y);
            let p = if turned { rotation * p } else { p };
            Point3::new(p.x + spacing * f64::from(i), p.y + spacing * f64::from(j), 0.0)
        };
        const CORNERS: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let at = |a: i32, b: i32| ((j + b) * (columns + 1) + i + a) as usize;
        pieces.push(Piece {
            corners: vec![at(0, 0), at(1, 0), at(1, 1), at(0, 1)],
            closed: CORNERS.map(|c| corner(c, 10.0, false)).to_vec(),
            open: CORNERS.map(|c| corner(c, pitch, true)).to_vec(),
        });
    }
    let mut joints = Vec::new();
    for (p, first) in pieces.iter().enumerate() {
        for (q, second) in pieces.iter().enumerate().skip(p + 1) {
            for (v, w) in (0..4).flat_map(|v| (0..4).map(move |w| (v, w))) {
                let near = |state| (first.vertices(state)[v] - second.vertices(state)[w]).norm() < 1e-9;
                if near(State::Closed) && near(State::Open) {
                    joints.push(Vertices { pieces: [p, q], vertices: [v, w] });
                }
            }
        }
    }
    let corners = (0..=rows)
        .flat_map(|j| (0..=columns).map(move |i| (i, j)))
        .map(|(i, j)| Point3::new(10.0 * f64::from(i) - 5.0, 10.0 * f64::from(j) - 5.0, 0.0))
        .collect();
    assemble(PatternKind::RotatingRectangles, Some(State::Closed), 0.0, corners, pieces, &joints)
}

#[test]
fn a_mechanism_has_no_barrier() {
    let design = squares(4, 3);
    assert_eq!(design.hinges.len(), 3 * 3 + 4 * 2);
    let soft = Ligament {
        spring: super::super::ligament::Spring { bending: 1e-9, ..nylon(0.0).spring },
        ..nylon(0.0)
    };
    let free = snapped(&design, &soft);
    assert!(free.path.iter().all(|sample| sample.energy < 1e-6), "{:?}", free.path);
    assert!((free.path[12].share - 1.0).abs() < 1e-4 && (free.path[6].share - 0.5).abs() < 1e-3);
    // With hinges that bend: 1/2 K angle^2 each, uphill all the way, and back again when let go.
    let ligament = nylon(0.0);
    let bent = snapped(&design, &ligament);
    let last = bent.path[12];
    let expected = 0.5 * ligament.spring.bending * (80_f64.to_radians() * last.share).powi(2) * 17.0;
    assert!((last.energy / expected - 1.0).abs() < 1e-3, "{} {expected}", last.energy);
    assert!(!bent.bistable && bent.back_barrier == 0.0 && bent.released.energy < 1e-3 * last.energy);
    // Cut in the open state it is at rest there, and comes back from the closed one.
    let cut_open = snapped(&Design { sheet_state: Some(State::Open), ..design }, &ligament);
    assert!(!cut_open.bistable && cut_open.path[0].energy < 1e-6 && cut_open.released.share.abs() < 0.1);
    assert!((cut_open.path[12].energy / last.energy - 1.0).abs() < 1e-3);
}

#[test]
fn the_middle_of_a_regular_sheet_is_like_one_cell() {
    let design = bistable(8.4, 18.0, [5, 5]);
    let ligament = nylon(0.0);
    let sheet = Sheet::new(&design, &vec![ligament; design.hinges.len()]);
    let cell = Cell { rectangle: [8.4; 2], phi: 18_f64.to_radians() };
    let mut system = System::new(sheet.layout.places());
    let [mut x, _] = sheet.ends();
    let mut tested = 0;
    for i in 0..=12 {
        sheet.minimise(&mut system, &mut x, Some(f64::from(i) / 12.0));
        // The hinges of cell 12, the middle one.
        let energy: f64 = sheet.energies(&x)[48..52].iter().sum();
        let turn = sheet.joints[48].turned(&sheet.layout, &x).abs();
        let expected = cell.energy(&ligament, cell.phi - turn);
        // The border, two cells away, is softer: it bears fewer hinges.
        assert!((energy - expected).abs() < 0.05 * expected + 0.02, "{i}: {energy} {expected}");
        tested += usize::from(expected > 50.0);
    }
    assert!(tested > 5);
}

#[test]
fn a_bistable_sheet_stays_open_and_a_stiff_hinge_closes_it() {
    // Cells of 20 mm with the notch alone are near the limit at this size, since border cells are held by fewer pieces.
    let design = bistable(8.4, 18.0, [6, 6]);
    let mut ligament = nylon(0.0);
    ligament.spring.bending *= 0.4;
    let snap = snapped(&design, &ligament);
    let told = format!("{snap:?}");
    assert!(snap.bistable && snap.back_barrier > 0.0 && snap.back_barrier < snap.barrier, "{told}");
    assert!(snap.released.share > 0.8 && snap.released.share < 1.0, "{told}");
    // Both ways are the same.
    for (p, q) in snap.path.iter().zip(&snap.back) {
        assert!((p.energy - q.energy).abs() < 2e-3 * snap.barrier, "{p:?} {q:?}");
    }
    ligament.spring.bending *= 10.0;
    let snap = snapped(&design, &ligament);
    assert!(!snap.bistable && snap.back_barrier == 0.0 && snap.released.share < 0.1, "{:?}", snap.released);
}

#[test]
fn energy_goes_with_modulus_and_small_sheets_have_less_of_it_per_cell() {
    let ligament = nylon(0.0);
    let mut stiff = ligament;
    let spring = &mut stiff.spring;
    for constant in [&mut spring.bending, &mut spring.axial, &mut spring.shear] {
        *constant *= 3.0;
    }
    let design = bistable(8.4, 18.0, [3, 3]);
    let (one, three) = (snapped(&design, &ligament), snapped(&design, &stiff));
    for (p, q) in one.path.iter().zip(&three.path) {
        assert!((q.energy - 3.0 * p.energy).abs() < 1e-4 * three.barrier, "{p:?} {q:?}");
    }
    // Pieces at the border have fewer hinges, and give way.
    let mid = |n: usize| {
        let mut soft = ligament;
        soft.spring.bending = 1e-6;
        snapped(&bistable(8.4, 18.0, [n, n]), &soft).barrier / (n * n) as f64
    };
    let (small, large) = (mid(3), mid(6));
    let mut soft = ligament;
    soft.spring.bending = 1e-6;
    let cell = Cell { rectangle: [8.4; 2], phi: 18_f64.to_radians() }.path(&soft, 72).barrier;
    println!("barrier per cell: 2 {} 3 {small} 6 {large} alone {cell}", mid(2));
    assert!(mid(2) < small && small < 0.8 * large && large < cell, "{} {small} {large} {cell}", mid(2));
}

#[test]
fn without_bending_both_states_are_free() {
    let design = bistable(7.2, 15.0, [3, 2]);
    let mut ligament = nylon(0.0);
    ligament.spring.bending = 1e-9;
    let snap = snapped(&design, &ligament);
    assert!(snap.bistable && snap.path[12].energy < 1e-6 && snap.released.energy < 1e-6);
    assert!((snap.barrier - snap.back_barrier).abs() < 1e-5 * snap.barrier);
}

#[test]
fn the_frame_of_the_open_state_does_not_matter() {
    // Turned in space, the open state makes the same energies with six unknowns per piece.
    let flat = bistable(8.4, 18.0, [4, 3]);
    let motion = nalgebra::Isometry3::new(Vector3::new(3.0, -2.0, 7.0), Vector3::new(0.3, 0.9, -0.4));
    let mut turned = flat.clone();
    for piece in &mut turned.pieces {
        piece.open.iter_mut().for_each(|p| *p = motion * *p);
    }
    let (one, two) = (snapped(&flat, &nylon(0.0)), snapped(&turned, &nylon(0.0)));
    assert!(one.barrier > 1.0 && (one.released.share - two.released.share).abs() < 1e-3, "{two:?}");
    for (p, q) in one.path.iter().chain(&one.back).zip(two.path.iter().chain(&two.back)) {
        assert!((p.energy - q.energy).abs() < 1e-4 * one.barrier, "{p:?} {q:?}");
    }
}
