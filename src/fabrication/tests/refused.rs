//! Designs that cannot be laid out.

use super::*;

#[test]
fn bad_designs_are_refused_by_name() {
    let (sheet, phi) = sheets()[0];
    let good = sheet.design(phi);
    let edit = |change: fn(&mut Design)| {
        let mut design = good.clone();
        change(&mut design);
        refused(&design, &profile(), 1.1).to_string()
    };
    assert!(edit(|d| d.sheet_state = None).contains("neither state of the design is flat"));
    assert!(edit(|d| d.hinges.truncate(16)).contains("carries 0 hinges"));
    assert!(edit(|d| d.hinges[1] = d.hinges[0].clone()).contains("hinges, but it needs exactly one"));
    assert!(edit(|d| d.hinges[4].pieces[1] = 99).contains("hinge 4: a piece or vertex index"));
    assert!(edit(|d| d.hinges[4].angle = f64::NAN).contains("hinge 4: its point, axis or angle"));
    assert!(edit(|d| d.hinges[4].axis *= 0.0).contains("hinge 4: its axis has no direction"));
    assert!(edit(|d| d.pieces[2].corners[1] = 99).contains("piece 2: corner 99 is out of range"));
    assert!(edit(|d| d.pieces[2].closed[1].x = f64::INFINITY).contains("piece 2: a vertex is not finite"));
    assert!(edit(|d| d.pieces[2].corners.truncate(2)).contains("piece 2: it has 2 corners"));
    assert!(edit(|d| d.pieces[2] = d.pieces[1].clone()).contains("piece 1 has the same side"));
    assert!(edit(|d| d.corners[3].z = 0.5).contains("must be finite and lie in z = 0"));
    assert!(edit(|d| d.corners.fill(Point3::origin())).contains("coincide"));
    assert!(edit(|d| d.corners[1] = d.corners[0] + Vector3::new(1.0, 0.0, 0.0)).contains("1.000 mm long"));
    let error = fabricate(&good, &profile(), &[1.0]).unwrap_err().to_string();
    assert!(error.contains("1 ligament lengths were given for 17 hinges"), "{error}");
    for length in [0.05, f64::NAN, f64::INFINITY] {
        assert!(matches!(refused(&good, &profile(), length), FabricationError::BadLength { hinge: 0, .. }));
    }
}

#[test]
fn pieces_that_touch_in_one_point_are_refused() {
    let gap = profile().hinge_gap();
    let mut sheet = TestSheet::rectangle([3, 3], [10.0, 10.0], gap);
    sheet.present = |i, j| !((i, j) == (1, 1) || (i, j) == (2, 2));
    let error = refused(&sheet.design(sheet.full_angle()), &profile(), 1.1).to_string();
    assert!(error.contains("touch here in one point only"), "{error}");
    // Two separate parts.
    sheet.present = |i, _| i != 1;
    let mut design = sheet.design(sheet.full_angle());
    for piece in design.pieces.iter_mut().filter(|piece| piece.open.is_empty()) {
        piece.open = piece.closed.clone();
    }
    let error = refused(&design, &profile(), 1.1);
    assert_eq!(error, FabricationError::SeveralParts { count: 2 });
}

#[test]
fn hinges_on_the_wrong_end_are_refused() {
    let (sheet, phi) = sheets()[0];
    let mut design = sheet.design(phi);
    // Move one hinge to the other end of its edge: piece j's next corner, piece k's previous one.
    let id = design.hinges.iter().position(|h| h.pieces == [5, 6] || h.pieces == [6, 5]).unwrap();
    let hinge = &design.hinges[id];
    let corner = |side: usize, step: usize| {
        let vertex = (hinge.vertices[side] + step) % 4;
        (vertex, design.pieces[hinge.pieces[side]].corners[vertex])
    };
    let vertices = [1, 3]
        .iter()
        .flat_map(|&a| [1, 3].map(|b| (corner(0, a), corner(1, b))))
        .find(|(a, b)| a.1 == b.1)
        .map(|(a, b)| [a.0, b.0])
        .unwrap();
    design.hinges[id].vertices = vertices;
    let error = refused(&design, &profile(), 1.1).to_string();
    assert!(error.contains("do not alternate"), "{error}");
}
