//! Turned, mirrored and renumbered sheets have the same cuts.

use super::*;

#[test]
fn turning_the_sheet_turns_the_cuts() {
    for (sheet, phi) in sheets() {
        let design = sheet.design(phi);
        let (straight, before) = cuts(&design, &profile(), 1.1);
        let (turned, after) = cuts(&moved(&design, turn), &profile(), 1.1);
        assert_moved(&straight.paths, &turned.paths, turn);
        for (a, b) in before.iter().zip(&after) {
            assert!((a.nearest_cut - b.nearest_cut).abs() < ROUNDING);
        }
    }
}

/// Per path: kind, length and number of vertices, rounded to a nanometre and sorted.
fn fingerprint(paths: &[CutPath]) -> Vec<(CutKind, i64, usize)> {
    let mut prints: Vec<_> = paths
        .iter()
        .map(|path| (path.kind, (1e6 * path.length()).round() as i64, path.vertices.len()))
        .collect();
    prints.sort();
    prints
}

#[test]
fn mirrored_and_renumbered_designs_give_congruent_cuts() {
    for (sheet, phi) in sheets() {
        let design = sheet.design(phi);
        let (cuts_before, _) = cuts(&design, &profile(), 1.1);
        let mut mirrored = moved(&design, |x, y| [-x, y]);
        for piece in &mut mirrored.pieces {
            piece.corners.reverse();
            piece.closed.reverse();
        }
        for hinge in &mut mirrored.hinges {
            hinge.vertices = hinge.vertices.map(|vertex| 3 - vertex);
        }
        let (cuts_mirrored, _) = cuts(&mirrored, &profile(), 1.1);
        assert_eq!(fingerprint(&cuts_before.paths), fingerprint(&cuts_mirrored.paths));

        let mut renumbered = design.clone();
        let (pieces, corners) = (design.pieces.len(), design.corners.len());
        renumbered.pieces.reverse();
        renumbered.corners.reverse();
        for piece in &mut renumbered.pieces {
            piece.corners.iter_mut().for_each(|corner| *corner = corners - 1 - *corner);
            piece.corners.rotate_left(1);
            piece.closed.rotate_left(1);
            piece.open.rotate_left(1);
        }
        for hinge in &mut renumbered.hinges {
            hinge.pieces = hinge.pieces.map(|piece| pieces - 1 - piece);
            hinge.vertices = hinge.vertices.map(|vertex| (vertex + 3) % 4);
        }
        let lengths = vec![1.1; design.hinges.len()];
        let a = fabricate(&design, &profile(), &lengths).unwrap();
        let b = fabricate(&renumbered, &profile(), &lengths).unwrap();
        assert_eq!(fingerprint(&a.layout.paths), fingerprint(&b.layout.paths));
        for (row, other) in a.hinges.iter().zip(&b.hinges) {
            assert!((row.point - other.point).norm() < ROUNDING);
            assert!((row.nearest_cut - other.nearest_cut).abs() < ROUNDING);
        }
    }
}
