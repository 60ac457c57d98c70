use super::*;

fn mesh(vertices: &[[f64; 3]], faces: &[&[usize]]) -> PolyMesh {
    PolyMesh {
        vertices: vertices.iter().map(|&v| Point3::from(v)).collect(),
        faces: faces.iter().map(|face| face.to_vec()).collect(),
    }
}

/// One polygon through all points.
fn polygon(points: &[[f64; 3]]) -> PolyMesh {
    let face: Vec<usize> = (0..points.len()).collect();
    mesh(points, &[&face])
}

fn flat(points: &[[f64; 2]]) -> PolyMesh {
    polygon(&points.iter().map(|&[x, y]| [x, y, 0.0]).collect::<Vec<_>>())
}

fn triangles(mesh: &PolyMesh) -> Vec<[usize; 3]> {
    triangulate(mesh, 1.0).unwrap().mesh.faces
}

/// Area of the triangles of a planar mesh, signed by +z.
fn signed_areas(surface: &Surface) -> Vec<f64> {
    let v = &surface.mesh.vertices;
    let area = |[a, b, c]: [usize; 3]| (v[b] - v[a]).cross(&(v[c] - v[a])).z / 2.0;
    surface.mesh.faces.iter().map(|&face| area(face)).collect()
}

/// A triangle as the cycle that begins with its least index.
fn cycle(mut triangle: [usize; 3]) -> [usize; 3] {
    while triangle[0] != *triangle.iter().min().unwrap() {
        triangle.rotate_left(1);
    }
    triangle
}

#[test]
fn a_triangle_stays_and_is_scaled() {
    let source = mesh(&[[9.0; 3], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]], &[&[3, 1, 2]]);
    let surface = triangulate(&source, 10.0).unwrap();
    assert_eq!(surface.vertex_of, [1, 2, 3]);
    assert_eq!(surface.face_of, [0]);
    assert_eq!(surface.mesh.faces, [[2, 0, 1]]);
    assert_eq!(surface.mesh.vertices[2], Point3::new(0.0, 0.0, 30.0));
}

#[test]
fn a_quad_is_split_along_its_shorter_diagonal() {
    let kite = |x: f64| flat(&[[-x, 0.0], [0.0, -1.0], [x, 0.0], [0.0, 1.0]]);
    let across =
        |mesh: &PolyMesh, corner: usize| triangles(mesh).iter().filter(|t| t.contains(&corner)).count();
    // Both triangles meet the ends of the diagonal, one the other corners.
    assert_eq!((across(&kite(0.5), 0), across(&kite(0.5), 1)), (2, 1));
    assert_eq!((across(&kite(2.0), 0), across(&kite(2.0), 1)), (1, 2));
    assert_eq!((across(&kite(1.0), 0), across(&kite(1.0), 1)), (2, 1), "equal diagonals: from corner 0");
}

#[test]
fn a_dart_is_split_through_its_reflex_corner_from_whichever_corner_it_starts() {
    // The diagonal through the reflex corner (0, 0.9) is the longer one.
    let dart = [[-0.4, 0.0], [0.0, 0.9], [0.4, 0.0], [0.0, 3.0]];
    for shift in 0..4 {
        let mut points = dart;
        points.rotate_left(shift);
        points.reverse();
        let surface = triangulate(&flat(&points), 1.0).unwrap();
        let areas = signed_areas(&surface);
        let sign = areas[0].signum();
        assert!(areas.iter().all(|area| area * sign > 0.1), "{areas:?}");
    }
}

#[test]
fn a_warped_quad_is_split_from_its_centre_whichever_corner_it_starts_with() {
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.6], [1.0, 1.0, 0.0], [0.0, 1.0, 0.6]];
    for shift in 0..4 {
        let mut turned = corners;
        turned.rotate_left(shift);
        let surface = triangulate(&polygon(&turned), 2.0).unwrap();
        assert_eq!(surface.mesh.vertices.last(), Some(&Point3::new(1.0, 1.0, 0.6)));
        assert_eq!((surface.face_of.as_slice(), surface.vertex_of.len()), ([0; 4].as_slice(), 4));
        // Four equal parts of the square of side 2 below.
        assert!(signed_areas(&surface).iter().all(|&area| (area - 1.0).abs() < 1e-15));
    }
}

#[test]
fn a_warped_face_that_its_centre_does_not_see_is_cut_along_diagonals() {
    // A dart whose centre lies outside: two triangles, both facing up.
    let dart = [[-0.4, 0.0, 0.1], [0.0, 0.9, 0.0], [0.4, 0.0, 0.1], [0.0, 1.1, 0.2]];
    let surface = triangulate(&polygon(&dart), 1.0).unwrap();
    let areas = signed_areas(&surface);
    assert_eq!(areas.len(), 2);
    assert!(areas.iter().all(|&area| area > 0.0), "{areas:?}");
}

#[test]
fn triangles_of_a_concave_polygon_cover_it_exactly() {
    // A comb: 4 teeth of width 1 and height 5 on a base of 7 x 1. Area 7 + 4 * 5.
    let mut points = vec![[0.0, 0.0], [7.0, 0.0]];
    for tooth in (0..4).rev() {
        let x = 2.0 * f64::from(tooth);
        points.extend([[x + 1.0, 6.0], [x, 6.0]]);
        if tooth > 0 {
            points.extend([[x, 1.0], [x - 1.0, 1.0]]);
        }
    }
    for shift in 0..points.len() {
        points.rotate_left(1);
        let surface = triangulate(&flat(&points), 1.0).unwrap();
        let areas = signed_areas(&surface);
        assert_eq!(areas.len(), points.len() - 2);
        assert!(areas.iter().all(|&area| area > 0.0), "shift {shift}");
        // Sums of a dozen numbers of order 10.
        assert!((areas.iter().sum::<f64>() - 27.0).abs() < 1e-12);
    }
}

#[test]
fn a_polygon_with_corners_on_a_line_gets_no_flat_triangle() {
    let square = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 2.0], [0.0, 2.0], [0.0, 1.0]];
    let areas = signed_areas(&triangulate(&flat(&square), 1.0).unwrap());
    assert!(areas.iter().all(|&area| area > 0.4), "{areas:?}");
    // The same with a corner that rounding moved off the line, on either side.
    for y in [-1e-16, 1e-16] {
        let quad = [[0.0, 0.0], [0.1, y], [0.3, 0.0], [0.1, 1.0]];
        assert_eq!(signed_areas(&triangulate(&flat(&quad), 1.0).unwrap()).len(), 2);
    }
}

#[test]
fn a_polygon_may_lie_anywhere_in_space() {
    // The regular hexagon's pieces have equal areas wherever it lies, and the sides keep their direction.
    let tilted: Vec<[f64; 3]> = (0..6)
        .map(|i| {
            let (sin, cos) = (f64::from(i) * std::f64::consts::FRAC_PI_3).sin_cos();
            [100.0 + cos, 200.0 + 0.6 * sin, -300.0 + 0.8 * sin]
        })
        .collect();
    let surface = triangulate(&polygon(&tilted), 1.0).unwrap();
    let v = &surface.mesh.vertices;
    let normal = Vector3::new(0.0, -0.8, 0.6);
    let areas =
        surface.mesh.faces.iter().map(|&[a, b, c]| (v[b] - v[a]).cross(&(v[c] - v[a])).dot(&normal) / 2.0);
    let areas: Vec<f64> = areas.collect();
    assert!(areas.iter().all(|&area| area > 0.4));
    // Coordinates of 300 carry 6e-14.
    assert!((areas.iter().sum::<f64>() - 1.5 * 3.0_f64.sqrt()).abs() < 1e-11);
}

#[test]
fn splitting_does_not_depend_on_scale_and_place() {
    let dart = [[0.0, 0.0, 0.1], [2.0, 0.0, 0.0], [2.5, 2.0, 0.3], [1.2, 0.4, 0.0], [0.0, 3.0, 0.2]];
    let expected = triangles(&polygon(&dart));
    for scale in [1e-6, 1e-3, 1e3, 1e6] {
        assert_eq!(triangulate(&polygon(&dart), scale).unwrap().mesh.faces, expected);
    }
    let moved = dart.map(|[x, y, z]| [x - 5e3, y + 2e4, z - 1e4]);
    assert_eq!(triangles(&polygon(&moved)), expected);
}

#[test]
fn neighbouring_faces_keep_their_numbers() {
    let source = mesh(
        &[[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [5.0; 3], [2.0, 0.0, 0.0]],
        &[&[0, 1, 2, 3], &[1, 5, 2]],
    );
    let surface = triangulate(&source, 1.0).unwrap();
    assert_eq!(surface.face_of, [0, 0, 1]);
    assert_eq!(surface.vertex_of, [0, 1, 2, 3, 5]);
    assert_eq!(cycle(surface.mesh.faces[2]), [1, 4, 2]);
}

#[test]
fn faces_without_area_are_named() {
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [2.0, 0.0, 0.0], [3.0, 0.0, 0.0]];
    for degenerate in [&[0, 1, 3][..], &[0, 1, 4, 3]] {
        let error = triangulate(&mesh(&corners, &[&[0, 1, 2], degenerate]), 1.0).unwrap_err();
        assert!(matches!(error, TriangulateError::ZeroArea { face: 1, .. }), "{error:?}");
        assert!(error.to_string().starts_with("face 2 at x 0.000000"), "{error}");
    }
    // Flat but for rounding: so far from the origin, x is a multiple of 1.5e-8.
    let sliver = flat(&[[1e8, 0.0], [1e8 + 0.1, 0.1], [1e8 + 0.3, 0.3]]);
    assert!(matches!(triangulate(&sliver, 1.0), Err(TriangulateError::ZeroArea { .. })));
    // Thin, but no accident.
    assert!(triangulate(&flat(&[[0.0, 0.0], [1.0, 0.0], [0.5, 1e-6]]), 1.0).is_ok());
}

#[test]
fn polygons_that_cross_themselves_are_refused() {
    let bow_tie = [[0.0, 0.0], [3.0, 0.0], [0.5, 1.0], [1.0, 2.0]];
    let crossing = [bow_tie[0], bow_tie[2], bow_tie[1], bow_tie[3]];
    let star: Vec<[f64; 2]> =
        (0..5).map(|i| f64::from(2 * i) * std::f64::consts::TAU / 5.0).map(|a| [a.cos(), a.sin()]).collect();
    // A strip around a square that passes over its own beginning: its turning number is that of a simple polygon.
    let overlap = [
        [0.0, 0.0],
        [10.0, 0.0],
        [10.0, 10.0],
        [3.0, 10.0],
        [3.0, -5.0],
        [5.0, -5.0],
        [5.0, 8.0],
        [8.0, 8.0],
        [8.0, 2.0],
        [0.0, 2.0],
    ];
    for points in [&crossing[..], &star, &overlap] {
        let error = triangulate(&flat(points), 1.0).unwrap_err();
        assert!(matches!(error, TriangulateError::SelfCrossing { face: 0, .. }), "{error:?}");
    }
}

#[test]
fn bad_scales_sizes_and_counts_are_refused() {
    let source = flat(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1e6]]);
    for scale in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(triangulate(&source, scale), Err(TriangulateError::Scale { .. })));
    }
    let error = triangulate(&source, 1e4).unwrap_err();
    assert_eq!(error, TriangulateError::TooLarge { vertex: 2, value: 1e10 });
    assert!(matches!(triangulate(&source, 1e-320), Err(TriangulateError::ZeroArea { .. })));
    let circle = |n: u32| {
        let angle = |i: u32| f64::from(i) * std::f64::consts::TAU / f64::from(n);
        flat(&(0..n).map(|i| [angle(i).cos(), angle(i).sin()]).collect::<Vec<_>>())
    };
    assert_eq!(triangles(&circle(300)).len(), 298);
    assert_eq!(
        triangulate(&circle(1001), 1.0),
        Err(TriangulateError::TooManyCorners { face: 0, corners: 1001 })
    );
}
