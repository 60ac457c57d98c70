use super::*;

fn control(mesh: &PolyMesh, pieces_at: Option<usize>) -> PatternMesh {
    let reading = Reading::ControlMesh { pieces_at };
    let pattern = pattern_mesh(mesh, reading, &[], CutRequest::AsGiven).unwrap();
    check(&pattern);
    pattern
}

/// Area of the pieces, seen from above.
fn area(pattern: &PatternMesh) -> f64 {
    let piece = |corners: &Vec<usize>| -> f64 {
        let p = |i: usize| pattern.corners[corners[i % corners.len()]].coords.xy();
        (0..corners.len()).map(|i| 0.5 * p(i).perp(&p(i + 1))).sum()
    };
    pattern.mesh.pieces.iter().map(piece).sum()
}

#[test]
fn a_grid_makes_diamonds_and_triangles() {
    // Vertex 0 is a corner of the grid; with an even number of cells both ways all four corners are alike.
    let (columns, rows) = (6, 4);
    let grid = cells(&block(columns, rows));
    for pieces_at_corner in [false, true] {
        let pattern = control(&grid, Some(usize::from(!pieces_at_corner)));
        // A centre at each vertex of one colour: those of 7 x 5 vertices, of which the corners' colour has 18.
        let expected = if pieces_at_corner { 18 - 4 } else { 17 };
        assert_eq!(pattern.mesh.pieces.len(), expected);
        assert_eq!(pattern.dropped.len(), if pieces_at_corner { 4 } else { 0 });
        // Without its corner pieces the sheet ends at the diagonals there.
        let missing = if pieces_at_corner { 2.0 } else { 0.0 };
        assert!((area(&pattern) - f64::from(columns * rows) + missing).abs() < 1e-12);
        // One hinge for each face, except where the piece on the other side was dropped.
        let hinges = pattern.mesh.edges.iter().filter(|edge| !edge.is_border()).count();
        assert_eq!(hinges, grid.faces.len() - pattern.dropped.len());
        for (piece, corners) in pattern.mesh.pieces.iter().enumerate() {
            let centre = grid.vertices[pattern.source_piece[piece]];
            let inside = centre.x % f64::from(columns) * (centre.y % f64::from(rows)) > 0.0;
            assert_eq!(corners.len(), if inside { 4 } else { 3 });
            assert!(!inside || pattern.centres[piece] == centre);
        }
        assert!(pattern.directions_agree);
        // Unasked, the choice with more pieces.
        assert_eq!(control(&grid, None).mesh.pieces.len(), 17);
    }
}

#[test]
fn singular_vertices_become_pieces() {
    for k in [3, 5, 6, 7] {
        let mesh = patches(k, 4, 1.0, 0.5);
        let pattern = control(&mesh, None);
        // Around an odd number of faces there is a piece; an even number may meet in a corner.
        if k % 2 == 1 {
            let centre = pattern.source_piece.iter().position(|&v| v == 0).expect("a piece in the middle");
            assert_eq!(pattern.mesh.pieces[centre].len(), k);
        }
        // The other choice has an odd corner there, which is named.
        let reading = Reading::ControlMesh { pieces_at: Some(1) };
        match pattern_mesh(&mesh, reading, &[], CutRequest::AsGiven) {
            Ok(pattern) => check(&pattern),
            Err(PatternMeshError::Alternation(found)) => {
                assert!(k % 2 == 1);
                assert_eq!((found.odd.len(), &found.odd[0].vertices, found.odd[0].pieces), (1, &vec![0], k));
            }
            Err(other) => panic!("{other}"),
        }
    }
}

#[test]
fn a_cut_tells_which_vertices_are_corners() {
    let grid = cells(&block(6, 6));
    let at = |x: i32, y: i32| {
        grid.vertices.iter().position(|p| (p.x, p.y) == (f64::from(x), f64::from(y))).unwrap()
    };
    for shift in [0, 1] {
        let path: Vec<usize> = (0..3).map(|i| at(i + shift, i)).collect();
        let reading = Reading::ControlMesh { pieces_at: None };
        let cut =
            |path: &[usize]| pattern_mesh(&grid, reading, &numbered(&[path.to_vec()]), CutRequest::AsGiven);
        let pattern = cut(&path).unwrap();
        check(&pattern);
        assert!(path.iter().all(|v| pattern.source_vertex.contains(v)));
        // The two corners before the inner end are doubled.
        assert_eq!(pattern.source_vertex.iter().filter(|v| path.contains(v)).count(), 5);
        let through = cut(&[path[0], at(shift + 1, 0), path[1]]).unwrap_err().to_string();
        assert!(through.contains("the centre of a piece"), "{through}");
    }
}

#[test]
fn a_strip_one_face_wide_is_no_control_mesh() {
    let reading = Reading::ControlMesh { pieces_at: None };
    let strip = pattern_mesh(&cells(&block(9, 1)), reading, &[], CutRequest::AsGiven).unwrap_err();
    assert!(matches!(strip, PatternMeshError::TooFew { .. }), "{strip}");
}
