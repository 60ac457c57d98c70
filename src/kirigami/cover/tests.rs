use super::*;
use std::f64::consts::{PI, SQRT_2};

fn rectangle(width: f64, height: f64, turn: f64) -> Vec<Point2> {
    let corners = [[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]];
    let per_side = 20;
    let rotation = nalgebra::Rotation2::new(turn);
    (0..4 * per_side)
        .map(|k| {
            let (side, t) = (k / per_side, (k % per_side) as f64 / per_side as f64);
            let (p, q) = (corners[side], corners[(side + 1) % 4]);
            rotation * Point2::new(p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1]))
        })
        .collect()
}

#[test]
fn a_turned_rectangle_is_filled_exactly() {
    for turn in [0.0, 0.3, -0.6] {
        let outline = rectangle(30.0, 20.0, turn);
        let first = Vector2::new(f64::cos(turn), f64::sin(turn));
        let cover = cover(&outline, &first, PieceSize::Counts([15, 10]), [SQRT_2; 2], 0.0, None).unwrap();
        assert_eq!(cover.boundary, Boundary::Glide);
        assert_eq!(cover.mesh.pieces.len(), 150);
        assert!((cover.cell.open[0] - 2.0).abs() < 1e-9);
        assert!((cover.cell.edge() - SQRT_2).abs() < 1e-9);
        // The grid's first axis is the asked one.
        let at = |place| cover.corners[cover.places.iter().position(|&p| p == place).unwrap()];
        assert!(((at([15.0, 0.0]) - at([0.0, 0.0])).normalize() - first).norm() < 1e-9);
    }
}

#[test]
fn the_asked_boundary_is_taken_or_refused() {
    let lay = |outline: &[Point2], boundary| {
        cover(outline, &Vector2::x(), PieceSize::Counts([15, 10]), [SQRT_2; 2], 0.0, boundary)
    };
    let four = rectangle(30.0, 20.0, 0.0);
    let pinned = lay(&four, Some(Boundary::FixedCorners)).unwrap();
    // Each corner of the sheet lies on its corner of the outline: the rectangle's own four, in order.
    let corners = [[0.0, 0.0], [30.0, 0.0], [30.0, 20.0], [0.0, 20.0]].map(Point2::from);
    for ((corner, outline), expected) in pinned.tips.iter().zip(corners) {
        assert_eq!(pinned.mesh.fans[*corner].edges.len(), 2);
        assert!(
            (pinned.corners[*corner] - expected).norm() < 1e-9 && (four[*outline] - expected).norm() < 1e-9
        );
    }
    assert_eq!((pinned.boundary, pinned.tips.len()), (Boundary::FixedCorners, 4));
    for boundary in [Boundary::Glide, Boundary::Trimmed] {
        let cover = lay(&four, Some(boundary)).unwrap();
        assert_eq!((cover.boundary, cover.mesh.pieces.len()), (boundary, 150));
        assert_eq!(cover.tips, []);
    }
    let round: Vec<Point2> =
        (0..90).map(|k| PI / 45.0 * k as f64).map(|t| Point2::new(t.cos(), t.sin())).collect();
    assert_eq!(lay(&round, Some(Boundary::Trimmed)).unwrap().boundary, Boundary::Trimmed);
    for (boundary, word) in [(Boundary::Glide, "\"glide\""), (Boundary::FixedCorners, "\"fixed-corners\"")] {
        let error = lay(&round, Some(boundary)).unwrap_err().to_string();
        assert!(error.contains(word) && error.contains("four corners"), "{error}");
    }
}

#[test]
fn a_disk_is_covered_by_a_tidy_staircase() {
    let outline: Vec<Point2> =
        (0..200).map(|k| 2.0 * PI * k as f64 / 200.0).map(|t| Point2::new(t.cos(), t.sin()) * 10.0).collect();
    let cover = cover(&outline, &Vector2::x(), PieceSize::Edge(1.0), [SQRT_2; 2], 0.0, None).unwrap();
    assert_eq!(cover.boundary, Boundary::Trimmed);
    let area = cover.mesh.pieces.len() as f64 * cover.cell.open[0].powi(2);
    // Border cells lie inside by two thirds or more, so a cell a side goes missing at most: perimeter /
    // side = 44.
    assert!((area / (100.0 * PI) - 1.0).abs() < 0.15 && area < 100.0 * PI, "{area}");
    // One boundary, no pinch: around every border corner there is exactly one fan.
    for (corner, fan) in cover.mesh.fans.iter().enumerate() {
        let pieces = cover.mesh.pieces.iter().filter(|piece| piece.contains(&corner)).count();
        assert_eq!(pieces, if fan.closed { 4 } else { fan.edges.len() - 1 });
    }
}

#[test]
fn model_cell_inverts() {
    for m1 in [1.2, SQRT_2, 1.8] {
        let stretches = [m1, 1.0 / (SQRT_2 - 1.0 / m1)];
        let cell = ModelCell::from_edge(10.0, stretches, 0.55);
        assert!((cell.edge() - 10.0).abs() < 1e-12);
        assert!((cell.open[0] / (cell.closed[0] - 0.275) - m1).abs() < 1e-12);
    }
}

#[test]
fn refuses_what_cannot_be_made() {
    let outline = rectangle(30.0, 20.0, 0.0);
    let lay = |size, gap| cover(&outline, &Vector2::x(), size, [SQRT_2; 2], gap, None);
    assert!(matches!(lay(PieceSize::Edge(1.0), 0.55), Err(CoverError::GapTooWide { .. })));
    assert!(matches!(lay(PieceSize::Edge(0.001), 0.0), Err(CoverError::TooMany { .. })));
    let hexagon: Vec<Point2> =
        (0..6).map(|k| PI / 3.0 * k as f64).map(|t| Point2::new(t.cos(), t.sin())).collect();
    let lone = cover(&hexagon, &Vector2::x(), PieceSize::Edge(5.0), [SQRT_2; 2], 0.0, None);
    assert!(matches!(lone, Err(CoverError::TooFew { .. })));
}
