use super::*;

/// The faces of a text with four vertices before it.
fn faces(text: &str) -> Vec<Vec<usize>> {
    parse(format!("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n{text}").as_bytes()).unwrap().faces
}

/// The fault of a text with four vertices before it, so that its first line is line 5.
fn fault(text: &str) -> String {
    parse(format!("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n{text}").as_bytes()).unwrap_err().to_string()
}

#[test]
fn all_forms_of_corners_are_read() {
    let text = "f 1 2 3\nf 1/9 2/9 3/9 4/9\nf 2//9 3//9 4//9\nf 3/9/9 4/9/9 1/9/9\nf 1/ 2/ 3/\n";
    assert_eq!(faces(text), [vec![0, 1, 2], vec![0, 1, 2, 3], vec![1, 2, 3], vec![2, 3, 0], vec![0, 1, 2]]);
}

#[test]
fn negative_indices_count_back_from_the_face() {
    let text = "f -4 -3 -2\nv 5 5 5\nf -1 -2 -5//-1\n";
    assert_eq!(faces(text), [[0, 1, 2], [4, 3, 0]]);
}

#[test]
fn a_face_may_precede_its_vertices() {
    let mesh = parse(b"f 3 1 2\nv 0 0 0\nv 1 0 0\nv 0 1 0").unwrap();
    assert_eq!(mesh.faces, [[2, 0, 1]]);
}

#[test]
fn groups_are_joined_and_other_statements_passed_over() {
    let text = "mtllib a.mtl\no lid\ng a b\ns off\nusemtl x\nvt 0 0\nvn 0 0 1\nvp 1\nl 1 2\np 3\nf 1 2 3\no box\n\
                g\nf 1 3 4\ncstype bezier\ncurv 0 1 1 2 3 4\nend\nfo 2 3 4\n";
    assert_eq!(faces(text), [[0, 1, 2], [0, 2, 3], [1, 2, 3]]);
}

#[test]
fn unused_vertices_keep_their_numbers() {
    let mesh = parse(b"v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 2 3 4\n").unwrap();
    assert_eq!(mesh.vertices.len(), 4);
    assert_eq!(mesh.vertices[0], Point3::new(9.0, 9.0, 9.0));
    assert_eq!(mesh.faces, [[1, 2, 3]]);
}

#[test]
fn weights_and_colours_may_follow_the_coordinates() {
    let mesh = parse(b"v 1 2 3 1\nv 4 5 6 0.1 0.2 0.3\nv 7 8 9 1 0.1 0.2 0.3\nf 1 2 3").unwrap();
    assert_eq!(mesh.vertices[1], Point3::new(4.0, 5.0, 6.0));
}

#[test]
fn line_ends_comments_and_continuations_are_read() {
    assert_eq!(
        faces("f 1 2 \\\n 3 \\\n4 # f 9 9 9\r\n#f 9 9\r\n  \t f\t1 2 3   \r\n"),
        [vec![0, 1, 2, 3], vec![0, 1, 2]]
    );
    // A backslash within a comment does not swallow the next line.
    assert_eq!(faces("f 1 2 3 # from C:\\meshes\\\nf 1 3 4\n"), [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(faces("f 1 2 3 \\\r\n4\r\n"), [[0, 1, 2, 3]]);
    assert_eq!(faces("f 1 2 3 \\"), [[0, 1, 2]]);
    assert_eq!(parse(b"v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3").unwrap().faces, [[0, 1, 2]]);
}

#[test]
fn bytes_that_are_not_utf8_are_tolerated_outside_numbers() {
    let text = b"# K\xfchn \xff\no Gr\xfc\xdfe\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    assert_eq!(parse(text).unwrap().faces.len(), 1);
    let error = parse(b"v 0 0 \xff\n").unwrap_err();
    assert_eq!(error.place, Place::Line(1));
}

#[test]
fn faults_of_faces_name_line_and_range() {
    assert_eq!(fault("f 1 2 0\n"), "line 5: vertex 0 is named, but the vertices run from 1 to 4");
    assert_eq!(fault("\n\nf 1 2 5\n"), "line 7: vertex 5 is named, but the vertices run from 1 to 4");
    assert_eq!(
        fault("f 1 2 -5\n"),
        "line 5: the face counts back to vertex -5, but only 4 vertices precede it"
    );
    assert_eq!(fault("f 1 2\n"), "line 5: the face has 2 corners, it needs at least 3");
    assert_eq!(fault("f\n"), "line 5: the face has 0 corners, it needs at least 3");
    assert!(fault("f 1 2 3 -3\n").starts_with("line 5: the face names vertex 2 twice"));
    assert_eq!(fault("f 1 2 3.0\n"), "line 5: `3.0` is not the index of a vertex");
    for huge in ["9223372036854775807", "9223372036854775808", "-9223372036854775808", "99999999999999999999"]
    {
        assert!(fault(&format!("f 1 2 {huge}\n")).starts_with("line 5:"), "{huge}");
    }
    // The line of a continued statement is its first.
    assert!(fault("f 1 \\\n2\n").starts_with("line 5: the face has 2 corners"));
}

#[test]
fn faults_of_vertices_name_line_and_value() {
    assert!(fault("v 1 2 1,5").starts_with("line 5: `1,5` is not a number"));
    assert!(fault("v 1 2 nan").starts_with("line 5: the coordinate `nan` is not finite"));
    assert!(fault("v 1 -1e999 0").starts_with("line 5: the coordinate `-1e999` is not finite"));
    assert!(fault("v 1 2 -1.5e9").starts_with("line 5: the coordinate -1.5e9 is beyond the limit of 1e9"));
    assert_eq!(fault("v 1 2"), "line 5: a vertex has three coordinates, this one has 2 numbers");
    assert_eq!(fault("v 1 2 3 4 5 6 7 8"), "line 5: a vertex has three coordinates, this one has 8 numbers");
    assert_eq!(fault("1 2 3\n"), "line 5: expected a statement such as `v` or `f`, found `1`");
}

#[test]
fn files_that_are_no_mesh_are_refused() {
    assert_eq!(parse(b"# nothing\n").unwrap_err().problem, Problem::NoVertices);
    assert_eq!(
        fault(""),
        "the file has no faces: export a polygon mesh, not points, curves, strips or NURBS"
    );
    assert!(parse(b"\x7fELF\x02\x01\x01\0\0\0\n").is_err());
    assert!(parse(&[0; 4096]).is_err());
}
