use super::*;
use crate::geometry::Point3;

/// Quads of an m x n grid; `vertex(i, j)` numbers the corners.
fn grid(m: usize, n: usize, vertex: impl Fn(usize, usize) -> usize) -> Vec<Vec<usize>> {
    let cells = (0..n).flat_map(|j| (0..m).map(move |i| (i, j)));
    cells.map(|(i, j)| vec![vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)]).collect()
}

fn sheet(m: usize, n: usize) -> Vec<Vec<usize>> {
    grid(m, n, |i, j| j * (m + 1) + i)
}

fn torus(m: usize, n: usize) -> Vec<Vec<usize>> {
    grid(m, n, |i, j| (j % n) * m + i % m)
}

fn tube(m: usize, n: usize) -> Vec<Vec<usize>> {
    grid(m, n, |i, j| j * m + i % m)
}

const TETRAHEDRON: [[usize; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

/// Faces of `second` numbered behind those of `first`.
fn beside(mut first: Vec<Vec<usize>>, second: &[Vec<usize>]) -> Vec<Vec<usize>> {
    let offset = 1 + first.iter().flatten().max().unwrap();
    first.extend(second.iter().map(|face| face.iter().map(|v| v + offset).collect()));
    first
}

#[test]
fn the_boundary_of_a_disk_runs_with_its_faces() {
    assert_eq!(disk(&[[7, 5, 6]]).unwrap().boundary, [5, 6, 7]);
    // 6 7 8
    // 3 4 5
    // 0 1 2
    assert_eq!(disk(&sheet(2, 2)).unwrap().boundary, [0, 1, 2, 5, 8, 7, 6, 3]);
    let turned: Vec<Vec<usize>> = sheet(2, 2).iter().map(|f| f.iter().rev().copied().collect()).collect();
    assert_eq!(disk(&turned).unwrap().boundary, [0, 3, 6, 7, 8, 5, 2, 1]);
}

#[test]
fn the_boundary_does_not_depend_on_the_order_of_faces_and_corners() {
    let mut faces = sheet(5, 4);
    let expected = disk(&faces).unwrap();
    faces.reverse();
    for (shift, face) in faces.iter_mut().enumerate() {
        face.rotate_left(shift % 4);
    }
    faces.swap(3, 11);
    assert_eq!(disk(&faces).unwrap(), expected);
}

#[test]
fn edges_know_the_faces_on_both_sides() {
    // Face 0 runs 0 1 2, face 1 runs 1 0 3.
    let edges = edges(&[[0, 1, 2], [1, 0, 3]]).unwrap();
    assert_eq!(edges.len(), 5);
    assert_eq!(edges[0], Edge { vertices: [0, 1], left: 0, right: Some(1) });
    assert_eq!(edges[1], Edge { vertices: [2, 0], left: 0, right: None });
    assert_eq!(edges[2], Edge { vertices: [0, 3], left: 1, right: None });
    assert_eq!(boundary_loops(&edges), [[0, 3, 1, 2]]);
}

#[test]
fn surfaces_that_are_no_disk_are_told_by_name() {
    let holed = |holes: &[usize]| -> Vec<Vec<usize>> {
        let faces = sheet(5, 5).into_iter().enumerate();
        faces.filter(|(i, _)| !holes.contains(i)).map(|(_, face)| face).collect()
    };
    let torus_with_hole = torus(4, 3)[1..].to_vec();
    assert_eq!(disk::<Vec<usize>>(&[]), Err(Defect::NoFaces));
    assert_eq!(disk(&TETRAHEDRON), Err(Defect::Closed { genus: 0 }));
    assert_eq!(disk(&torus(4, 3)), Err(Defect::Closed { genus: 1 }));
    assert_eq!(disk(&tube(6, 2)), Err(Defect::Holes { loops: vec![6, 6] }));
    assert_eq!(disk(&holed(&[12])), Err(Defect::Holes { loops: vec![20, 4] }));
    assert_eq!(disk(&holed(&[6, 8, 16, 17])), Err(Defect::Holes { loops: vec![20, 6, 4, 4] }));
    assert_eq!(disk(&torus_with_hole), Err(Defect::Handles { genus: 1, loops: vec![4] }));
    let three = beside(beside(sheet(1, 2), &sheet(5, 2)), &sheet(1, 1));
    assert_eq!(disk(&three), Err(Defect::Components { sizes: vec![10, 2, 1] }));
}

#[test]
fn two_tori_joined_by_a_tube_have_genus_2() {
    // Remove one quad of each torus and join the two rims by four quads. A removed face runs against its rim.
    let torus = torus(4, 4);
    let mut faces = beside(torus[1..].to_vec(), &torus[1..]);
    let (a, b) = (&torus[0], torus[0].iter().map(|v| v + 16).collect::<Vec<_>>());
    for i in 0..4 {
        let j = (i + 1) % 4;
        // The second rim is followed backwards, from the same corner.
        faces.push(vec![a[i], a[j], b[(4 - j) % 4], b[(4 - i) % 4]]);
    }
    assert_eq!(disk(&faces), Err(Defect::Closed { genus: 2 }));
}

#[test]
fn a_branching_edge_is_named_with_all_its_faces() {
    let faces = [[0, 1, 2], [1, 0, 3], [0, 1, 4]];
    let defect = disk(&faces).unwrap_err();
    assert_eq!(defect, Defect::BranchingEdge { edge: [0, 1], faces: vec![0, 1, 2] });
    assert!(
        defect.to_string().starts_with("3 faces (1, 2 and 3) share the edge from vertex 1 to 2"),
        "{defect}"
    );
}

#[test]
fn a_turned_face_is_named() {
    let mut faces = sheet(3, 3);
    faces[0].reverse();
    let defect = disk(&faces).unwrap_err();
    // Face 0 has corners 0 1 5 4; its neighbours are face 1 across 1-5 and face 3 across 4-5.
    assert_eq!(defect, Defect::Winding { edge: [5, 1], faces: [0, 1], more: 1 });
    assert_eq!(
        defect.to_string(),
        "face 1 and face 2 both run from vertex 6 to 2: one is wound the wrong way (likewise at 1 more edge); \
         unify the normals"
    );
}

#[test]
fn a_moebius_strip_has_one_side() {
    // A strip of 5 quads whose end is turned over before it is joined to the start.
    let vertex = |i: usize, j: usize| if i < 5 { 2 * i + j } else { 1 - j };
    let defect = disk(&grid(5, 1, vertex)).unwrap_err();
    assert!(matches!(defect, Defect::OneSided { edge: [0, 1] | [1, 0], faces: [0, 4] }), "{defect:?}");
}

#[test]
fn pinched_vertices_are_named() {
    // Two triangles that touch in vertex 2.
    let bow_tie = [[0, 1, 2], [2, 3, 4]];
    assert_eq!(disk(&bow_tie), Err(Defect::PinchedVertex { vertex: 2, fans: 2, faces: [0, 1] }));
    // Two closed fans: tetrahedra that share a corner. Counting edges and faces at the vertex does not show it.
    let two: Vec<[usize; 3]> = TETRAHEDRON
        .iter()
        .copied()
        .chain(TETRAHEDRON.map(|f| f.map(|v| if v == 0 { 0 } else { v + 3 })))
        .collect();
    assert_eq!(disk(&two), Err(Defect::PinchedVertex { vertex: 0, fans: 2, faces: [0, 4] }));
    // A sheet two of whose corners are one vertex.
    let ring: Vec<Vec<usize>> =
        sheet(3, 3).iter().map(|f| f.iter().map(|&v| if v == 15 { 0 } else { v }).collect()).collect();
    assert!(matches!(disk(&ring), Err(Defect::PinchedVertex { vertex: 0, fans: 2, .. })));
}

#[test]
fn a_double_face_is_a_winding_or_branching_fault() {
    assert!(matches!(disk(&[[0, 1, 2], [1, 2, 0]]), Err(Defect::Winding { faces: [0, 1], .. })));
    // Back to back: closed, like an empty bag.
    assert_eq!(disk(&[[0, 1, 2], [2, 1, 0]]), Err(Defect::Closed { genus: 0 }));
}

#[test]
fn messages_give_the_place_in_space() {
    let mesh = PolyMesh {
        vertices: (0..5).map(|i| Point3::new(f64::from(i), 0.5, -1.0)).collect(),
        faces: vec![vec![0, 1, 2], vec![2, 3, 4]],
    };
    let error = check_disk(&mesh).unwrap_err();
    assert_eq!(error.at, Some(Point3::new(2.0, 0.5, -1.0)));
    assert!(error.to_string().contains("at vertex 3 form 2 fans"), "{error}");
    assert!(error.to_string().ends_with("(at x 2, y 0.5, z -1)"), "{error}");
}
