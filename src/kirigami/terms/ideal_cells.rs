//! The ideal cells in the plane, where every residual must vanish: closed forms against the terms.

use super::*;
use crate::geometry::mesh::TriMesh;
use crate::geometry::{Point2, Point3, Vector2};
use crate::kirigami::control_mesh::{Goals, Layout, Layouts, LinearMap, Target, stage1};
use crate::kirigami::cover::{PieceSize, cover};
use crate::kirigami::pattern::{Opening, Unknowns, initial_pattern};
use crate::kirigami::pattern_terms::{hard_terms, soft_terms};
use crate::kirigami::stage3::{Problem, Regime, Weights};
use crate::solver::{Coupling, Term};

/// The largest residual of a term.
fn largest(term: &dyn Term, x: &[f64]) -> f64 {
    let mut worst = 0.0_f64;
    for b in 0..term.blocks() {
        let mut residuals = vec![0.0; term.rows(b)];
        term.evaluate(b, x, &mut residuals, &mut vec![0.0; term.rows(b) * term.unknowns(b).len()]);
        worst = residuals.iter().fold(worst, |worst, r| worst.max(r.abs()));
    }
    worst
}

#[test]
fn rotating_rectangles_leave_no_residual() {
    // 1/m1 + 1/m2 = sqrt 2; cells of side 10 open and 10/m1 by 10/m2 closed.
    let m1 = 1.3;
    let stretches = [m1, 1.0 / (std::f64::consts::SQRT_2 - 1.0 / m1)];
    let outline = [[0.0, 0.0], [60.0, 0.0], [60.0, 40.0], [0.0, 40.0]].map(|[x, y]| Point2::new(x, y));
    let cover = cover(&outline, &Vector2::x(), PieceSize::Counts([6, 4]), stretches, 0.0, None).unwrap();
    let vertices = outline.iter().map(|p| Point3::new(p.x, p.y, 0.0)).collect();
    let mesh = TriMesh { vertices, faces: vec![[0, 1, 2], [0, 2, 3]] };
    let open = Layout::Lifted(LinearMap::new(mesh.clone(), &outline));
    let control = stage1(&cover, &Layouts { closed: Layout::Grid, open });
    let pattern = initial_pattern(&cover, &control, 0.0, Opening::Full);
    let target = Target::new(mesh, &[0, 1, 2, 3]);
    let goals = Goals::opening(&target);
    let (at, scale) = (Unknowns::new(&cover.mesh, &goals), cover.cell.edge());
    let weights = Weights { corners: 0.0, ..Weights::default() };
    let problem = Problem { cover: &cover, goals, gap: 0.0, weights: &weights };
    let mut terms = hard_terms(&cover.mesh, &at, &pattern, scale);
    terms.extend(soft_terms(&problem, [&pattern; 2], &at, &Regime::from_model(1).phases[0], Coupling::Full));
    let x = at.pack(&pattern, scale);
    let names: Vec<&str> = terms.iter().map(|weighted| weighted.term.name()).collect();
    let all = ["isom", "planarity", "prox", "boundary", "sides", "opening", "rectangles", "widths"];
    assert_eq!(names, [&all[..], &["fair-closed", "fair-open"]].concat());
    for weighted in &mut terms {
        weighted.term.refresh(&x);
        let worst = largest(weighted.term.as_ref(), &x);
        assert!(worst < 1e-13, "{}: {worst:e}", weighted.term.name());
    }
}

/// The bistable cell (Fig. 5, DESIGN 2.3): corners of the rectangle, and the quarter of the 8-gon at the upper right,
/// which hangs on the rectangle's upper left corner.
fn bistable([a, b]: [f64; 2], [big_a, big_b]: [f64; 2], phi: f64) -> ([Vector2; 4], [Vector2; 4]) {
    let turn = nalgebra::Rotation2::new(phi);
    let [bl, br, tr, tl] =
        [[-a, -b], [a, -b], [a, b], [-a, b]].map(|[x, y]| turn * Vector2::new(0.5 * x, 0.5 * y));
    // The top side prolonged to the right edge of the cell, and the left side to the top edge.
    let right = tl + (tr - tl) * ((0.5 * big_a - tl.x) / (tr.x - tl.x));
    let top = bl + (tl - bl) * ((0.5 * big_b - bl.y) / (tl.y - bl.y));
    ([bl, br, tr, tl], [tl, right, Vector2::new(0.5 * big_a, 0.5 * big_b), top])
}

#[test]
fn bistable_cells_snap_without_strain() {
    let ([a, b], [big_a, big_b], phi) = ([0.5, 0.4], [1.0, 1.1], 18_f64.to_radians());
    let (rectangle, quarter) = bistable([a, b], [big_a, big_b], phi);
    // Eq. (2): the cell grows, and the 8-gons only translate, by half as much.
    let grown = [big_a + 2.0 * b * phi.sin(), big_b + 2.0 * a * phi.sin()];
    let (snapped, _) = bistable([a, b], grown, -phi);
    let shift = Vector2::new(0.5 * (grown[0] - big_a), 0.5 * (grown[1] - big_b));
    let moved = quarter.map(|p| p + shift);
    assert!((moved[0] - snapped[3]).norm() < 1e-15, "the hinge holds");
    assert!((moved[2] - Vector2::new(0.5 * grown[0], 0.5 * grown[1])).norm() < 1e-15);
    for (closed, open) in [(rectangle, snapped), (quarter, moved)] {
        let corner = |i: usize| PointAt { start: 2 * i, dimension: 2 };
        let vertex = |i| ClosedVertex { corner: corner(i), offset: Vector3::zeros(), lift: None };
        let piece = PieceAt {
            closed: (0..4).map(vertex).collect(),
            open: (0..4).map(|i| PointAt { start: 8 + 3 * i, dimension: 3 }).collect(),
        };
        let plane = closed.iter().flat_map(|p| [p.x, p.y]);
        let x: Vec<f64> = plane.chain(open.iter().flat_map(|p| [p.x, p.y, 0.7])).collect();
        assert!(largest(&Isometry::new(std::slice::from_ref(&piece)), &x) < 1e-15);
        assert!(largest(&Planarity::new(&[piece]), &x) < 1e-15);
    }
    // Not so with any other growth.
    let wrong = quarter.map(|p| p + 0.9 * shift);
    assert!((wrong[0] - snapped[3]).norm() > 1e-3);
}
