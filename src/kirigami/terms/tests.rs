use super::*;
use crate::geometry::Point3;
use crate::geometry::mesh::TriMesh;
use crate::kirigami::control_mesh::Target;
use crate::kirigami::guides::GuideAim;
use crate::solver::Term;
use crate::solver::derivative_check::largest_jacobian_error;

fn at(start: usize, dimension: usize) -> PointAt {
    PointAt { start, dimension }
}

/// Numbers without a pattern.
fn scattered(n: usize) -> Vec<f64> {
    (0..n).map(|i| ((i * i + 3 * i) as f64 * 0.7391).sin() * 1.7).collect()
}

fn piece(n: usize) -> PieceAt {
    piece_in(2, n)
}

/// A piece whose closed state has this dimension.
fn piece_in(d: usize, n: usize) -> PieceAt {
    piece_between(d, 3, n)
}

/// A piece whose states have these dimensions.
fn piece_between(closed: usize, open: usize, n: usize) -> PieceAt {
    let offset = |i: usize| Vector3::new(0.1 * i as f64, -0.05, 0.0);
    let vertex = |i| ClosedVertex { corner: at(closed * i, closed), offset: offset(i), lift: None };
    PieceAt {
        closed: (0..n).map(vertex).collect(),
        open: (0..n).map(|i| at(closed * n + open * i, open)).collect(),
    }
}

/// A piece whose closed vertices are lifted by unknowns of their own.
fn lifted(mut piece: PieceAt) -> PieceAt {
    for (i, vertex) in piece.closed.iter_mut().enumerate() {
        vertex.lift = Some((34 + i, Vector3::new(0.2, -0.3, 0.9 - 0.1 * i as f64)));
    }
    piece
}

fn target() -> Target {
    let vertices = [[-9.0, -9.0, 0.1], [9.0, -8.0, 0.0], [8.0, 9.0, 0.4], [-9.0, 8.0, -0.3]];
    Target::new(
        TriMesh { vertices: vertices.map(Point3::from).to_vec(), faces: vec![[0, 1, 2], [0, 2, 3]] },
        &[0, 1, 2, 3],
    )
}

#[test]
fn jacobians_agree_with_differences() {
    let x = scattered(40);
    let target = target();
    let inner =
        |d: usize, s: usize| Diagonals::new(at(s, d), at(s + d, d), at(s + 2 * d, d), Some(at(s + 3 * d, d)));
    let border = |d: usize, s: usize| Diagonals::new(at(s, d), at(s + d, d), at(s + 2 * d, d), None);
    let aims = [
        GuideAim::Point(Point3::new(1.0, -2.0, 0.3)),
        GuideAim::Curves(vec![vec![Point3::new(-5.0, -4.0, 0.3), Point3::new(6.0, 3.0, 2.0)]]),
    ];
    let mean = ([at(0, 3), at(6, 3), at(30, 3)], [0.2, 0.9, -0.1]);
    let mut terms: Vec<Box<dyn Term + '_>> = vec![
        Box::new(Guided::new([mean], &aims[0], 2.0)),
        Box::new(Guided::new([mean], &aims[1], 2.0)),
        Box::new(LinearTerm::new("fair", 3, &[vec![(at(0, 3), 1.0), (at(3, 3), -2.5), (at(9, 3), 1.5)]])),
        Box::new(OrthogonalDiagonals::new([inner(2, 0), inner(3, 8), border(2, 0), border(3, 8)])),
        Box::new(CellDimensions::new([(inner(3, 0), inner(3, 12))], 0.7, 0.0)),
        Box::new(CellDimensions::new([(inner(2, 0), inner(3, 8)), (border(2, 0), border(3, 8))], 0.7, 0.05)),
        Box::new(PrincipalStretches::new(
            [((inner(2, 0), inner(3, 8)), 0), ((border(2, 0), border(3, 8)), 1)],
            [1.2, 1.4],
        )),
        Box::new(Isometry::new(&[piece(4), piece(5)])),
        Box::new(Planarity::new(&[piece(4), piece(6)])),
        Box::new(Isometry::new(&[piece_in(3, 4), piece_in(3, 5)])),
        Box::new(Planarity::new(&[piece_in(3, 4), piece_in(3, 6)])),
        Box::new(Isometry::new(&[lifted(piece_between(3, 2, 4)), lifted(piece_between(3, 3, 5))])),
        Box::new(Planarity::new(&[lifted(piece_between(3, 2, 4)), lifted(piece_between(3, 3, 5))])),
        Box::new(Isometry::new(&[piece_between(3, 2, 4), piece_between(3, 2, 5)])),
        Box::new(Planarity::new(&[piece_between(3, 2, 4), piece_between(3, 2, 6)])),
        Box::new(LeastWidths::new([[at(0, 3), at(6, 3), at(30, 3)], [at(30, 3), at(0, 3), at(6, 3)]], 9.0)),
        Box::new(Pull::new("pull", &scattered(9))),
        Box::new(Lengths::new("sides", [([at(0, 2), at(6, 2)], 0.9), ([at(8, 2), at(2, 2)], 1.2)])),
        Box::new(RightAngles::new("opening", [[at(0, 3), at(6, 3), at(30, 3)]])),
        Box::new(RightAngles::new("rectangles", [[at(0, 2), at(6, 2), at(30, 2)]])),
        Box::new(LeastWidths::new([[at(0, 2), at(6, 2), at(30, 2)], [at(30, 2), at(0, 2), at(6, 2)]], 9.0)),
        Box::new(Held::new("prox", [at(0, 3), at(6, 3)].map(|p| (p, Hold::Surface)), &target, 2.0)),
        Box::new(Held::new(
            "boundary",
            vec![
                (at(0, 3), Hold::Plane(Point3::new(1.0, 2.0, 3.0), Vector3::y())),
                (at(3, 3), Hold::Boundary),
                (at(6, 3), Hold::Inside(Point3::new(1.0, 2.0, 3.0), Vector3::x())),
            ],
            &target,
            2.0,
        )),
    ];
    for term in &mut terms {
        term.refresh(&x);
        // Cubic residuals at most: the central difference errs by h^2 = 1e-10, rounding by 1e-16 / 1e-5.
        let error = largest_jacobian_error(term.as_ref(), &x, 1e-5);
        assert!(error < 1e-8, "{}: {error}", term.name());
        assert!(term.blocks() > 0);
    }
}

#[test]
fn proximity_and_boundary_measure_distances() {
    let target = target();
    let mut proximity = Held::new("prox", [(at(0, 3), Hold::Surface)], &target, 1.0);
    let x = [1.0, 2.0, 3.0];
    proximity.refresh(&x);
    let mut residual = [0.0];
    proximity.evaluate(0, &x, &mut residual, &mut [0.0; 3]);
    let distance = target.surface.distance(&Point3::from(x));
    // The two facets differ by about two degrees, so the smooth normal shortens by at most 1e-3.
    assert!((residual[0].abs() / distance - 1.0).abs() < 1e-3, "{} {distance}", residual[0]);
    // A point outside, straight before the middle of the edge y = -9 .. -8: positive distance outwards.
    let mut boundary = Held::new("boundary", [(at(0, 3), Hold::Boundary)], &target, 1.0);
    let outside = [0.0, -10.5, 0.05];
    boundary.refresh(&outside);
    boundary.evaluate(0, &outside, &mut residual, &mut [0.0; 3]);
    assert!((residual[0] - 2.0).abs() < 0.02, "{}", residual[0]);
}

#[test]
fn a_point_that_is_held_inside_glides_in_its_plane_until_it_leaves_the_outline() {
    let target = target();
    let hold = Hold::Inside(Point3::new(0.0, -7.0, 0.0), -Vector3::y());
    let mut term = Held::new("boundary", [(at(0, 3), hold)], &target, 1.0);
    let mut residual = |x: [f64; 3]| {
        let mut residual = [0.0];
        term.refresh(&x);
        term.evaluate(0, &x, &mut residual, &mut [0.0; 3]);
        residual[0]
    };
    assert!((residual([3.0, -6.0, 0.0]) + 1.0).abs() < 1e-12);
    // Beyond the other side, near x = 9 at y = -7, the outline counts: half a unit outside.
    let outside = residual([9.5 - 1.0 / 17.0, -7.0, 0.02]);
    assert!((outside - 0.5).abs() < 0.02, "{outside}");
}

#[test]
fn widths_are_those_of_the_quad_and_count_only_where_they_lack() {
    // A trapezoid with parallel sides of 4 and 2 at a distance of 1, counter-clockwise.
    let x = [0.0, 0.0, 4.0, 0.0, 3.0, 1.0, 1.0, 1.0];
    let corners: Vec<[PointAt; 3]> =
        (0..4).map(|i| [i, (i + 1) % 4, (i + 3) % 4].map(|c| at(2 * c, 2))).collect();
    let lacks = |least: f64, corners: &[[PointAt; 3]], x: &[f64]| -> Vec<f64> {
        let term = LeastWidths::new(corners.iter().copied(), least);
        let mut residual = [0.0];
        (0..term.blocks())
            .map(|b| {
                term.evaluate(b, x, &mut residual, &mut [0.0; 6]);
                residual[0]
            })
            .collect()
    };
    // Seen from the long side's ends its height is 1; the other corners see the distance from the short side, 1 too, or
    // from the slanted one, 2 / sqrt 2, where that is longer: it is not.
    assert!(lacks(1.5, &corners, &x).iter().all(|lack| (lack - 0.5).abs() < 1e-15));
    assert_eq!(lacks(0.99, &corners, &x), [0.0; 4]);
    // Mirrored it is turned over: heights are negative.
    let mirrored: Vec<f64> = x.chunks(2).flat_map(|p| [-p[0], p[1]]).collect();
    assert!(lacks(0.5, &corners, &mirrored).iter().all(|lack| (lack - 1.5).abs() < 1e-15));
}

#[test]
fn pins_measure_the_distance() {
    let target = target();
    let pins = Hold::pins(Point3::new(1.0, -2.0, 3.0)).map(|hold| (at(0, 3), hold));
    let mut term = Held::new("corners", pins, &target, 2.0);
    // 2 mm per unit: at (2, -2, 6) mm the distance is sqrt(1 + 0 + 9) mm.
    let x = [1.0, -1.0, 3.0];
    term.refresh(&x);
    let squares: f64 = (0..term.blocks())
        .map(|b| {
            let mut residual = [0.0];
            term.evaluate(b, &x, &mut residual, &mut [0.0; 3]);
            residual[0].powi(2)
        })
        .sum();
    assert!((4.0 * squares - 10.0).abs() < 1e-12, "{squares}");
}

#[test]
fn a_rigid_motion_has_no_isometry_residual() {
    let piece = piece(4);
    let closed = [[0.0, 0.0], [1.0, 0.1], [1.1, 0.9], [-0.1, 1.0]];
    let mut x: Vec<f64> = closed.concat();
    let turn = nalgebra::Rotation3::from_euler_angles(0.4, -0.8, 2.0);
    for (i, vertex) in piece.closed.iter().enumerate() {
        let place = Vector3::new(closed[i][0], closed[i][1], 0.0) + vertex.offset;
        let p = turn * place + Vector3::new(3.0, 1.0, -2.0);
        x.extend(p.iter());
    }
    let mut residuals = [0.0; 6];
    Isometry::new(std::slice::from_ref(&piece)).evaluate(0, &x, &mut residuals, &mut [0.0; 6 * 20]);
    assert!(residuals.iter().all(|r| r.abs() < 1e-14), "{residuals:?}");
    Planarity::new(&[piece]).evaluate(0, &x, &mut residuals[..1], &mut [0.0; 12]);
    assert!(residuals[0].abs() < 1e-14);
}

#[test]
fn bending_a_flat_piece_shows_to_first_order_in_either_state() {
    let mut piece = piece_in(3, 5);
    piece.closed.iter_mut().for_each(|vertex| vertex.offset = Vector3::zeros());
    let flat: Vec<f64> = [[0.0, 0.0], [1.0, 0.1], [1.1, 0.9], [0.4, 1.3], [-0.1, 1.0]]
        .into_iter()
        .flat_map(|[x, y]| [x, y, 0.0])
        .collect();
    let turn = nalgebra::Rotation3::from_euler_angles(-1.1, 0.3, 0.8);
    let moved = |points: &[f64]| -> Vec<f64> {
        points.chunks(3).flat_map(|p| (turn * Vector3::new(p[0], p[1], p[2])).data.0[0]).collect()
    };
    let residuals = |closed: &[f64], open: &[f64]| {
        let terms: [Box<dyn Term>; 2] = [
            Box::new(Isometry::new(std::slice::from_ref(&piece))),
            Box::new(Planarity::new(std::slice::from_ref(&piece))),
        ];
        let x = [closed, open].concat();
        terms.map(|term| {
            let mut residuals = vec![0.0; term.rows(0)];
            term.evaluate(0, &x, &mut residuals, &mut vec![0.0; term.rows(0) * 30]);
            residuals
        })
    };
    let largest = |r: &[f64]| r.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let [isometry, planarity] = residuals(&flat, &moved(&flat));
    assert_eq!(planarity.len(), 4);
    assert!(largest(&isometry) < 1e-14 && largest(&planarity) < 1e-14);
    // Lift the last vertex by a millionth: twice the area of the first triangle times that, in the bent state only.
    let lift = 1e-6;
    let bent: Vec<f64> = flat.iter().enumerate().map(|(i, v)| if i == 14 { v + lift } else { *v }).collect();
    let area = 1.0 * 0.9 - 0.1 * 1.1;
    for (closed, open, row) in [(&bent, moved(&flat), 1), (&flat, moved(&bent), 3)] {
        let [isometry, planarity] = residuals(closed, &open);
        assert!(largest(&isometry) < 1e-11);
        assert!((planarity[row] - area * lift).abs() < 1e-14, "{planarity:?}");
        assert!(planarity.iter().enumerate().all(|(i, v)| i == row || v.abs() < 1e-14));
    }
}
