use super::*;
use crate::geometry::read::polylines;

/// A block of 6 x 4 cells whose vertex (x, y) has number 7 y + x.
fn sheet() -> PolyMesh {
    let vertex = |v: i32| Point3::new(f64::from(v % 7), f64::from(v / 7), 0.0);
    let face = |f: usize| {
        let v = f / 6 * 7 + f % 6;
        vec![v, v + 1, v + 8, v + 7]
    };
    PolyMesh { vertices: (0..35).map(vertex).collect(), faces: (0..24).map(face).collect() }
}

fn path(points: &[[usize; 2]]) -> Vec<usize> {
    points.iter().map(|[x, y]| 7 * y + x).collect()
}

/// What cuts add to the sheet: corners, border edges, loops, and vertices of the surface to flatten.
fn added(cuts: &[Vec<usize>]) -> [usize; 4] {
    let pattern = read(&sheet(), cuts).unwrap();
    check(&pattern);
    let border: usize = pattern.loops.iter().map(Vec::len).sum();
    [
        pattern.mesh.corner_count - 35,
        border - 20,
        pattern.loops.len() - 1,
        pattern.flatten.mesh.vertices.len() - 35 - 24,
    ]
}

#[test]
fn corners_are_doubled_along_cuts() {
    // From the border inwards: the end inside stays one corner.
    let notch = path(&[[3, 0], [3, 1], [3, 2]]);
    assert_eq!(added(std::slice::from_ref(&notch)), [2, 4, 0, 2]);
    // Both ends inside: a hole, which the surface to flatten does not have.
    let slit = path(&[[2, 2], [3, 2], [4, 2]]);
    assert_eq!(added(std::slice::from_ref(&slit)), [1, 4, 1, 0]);
    // The same of one edge: no corner is doubled.
    assert_eq!(added(&[path(&[[3, 2], [4, 2]])]), [0, 2, 1, 0]);
    // A cut that ends at another one, and two that cross: where they meet there are three corners, and four.
    assert_eq!(added(&[notch.clone(), slit.clone()]), [4, 8, 0, 4]);
    assert_eq!(added(&[path(&[[3, 0], [3, 1], [3, 2], [3, 3]]), slit.clone()]), [5, 10, 0, 5]);
    // The same edges one by one, in any order and direction, some of them twice.
    let edges: Vec<Vec<usize>> =
        notch.windows(2).chain(slit.windows(2)).chain(slit.windows(2)).map(|w| vec![w[1], w[0]]).collect();
    assert_eq!(read(&sheet(), &edges).unwrap().mesh, read(&sheet(), &[notch, slit]).unwrap().mesh);
}

#[test]
fn the_sides_of_a_slit_share_vertices_in_the_surface_to_flatten() {
    let pattern = read(&sheet(), &[path(&[[2, 2], [3, 2], [4, 2]])]).unwrap();
    let doubled: Vec<usize> =
        (0..pattern.mesh.corner_count).filter(|&c| pattern.source_vertex[c] == 17).collect();
    assert_eq!(doubled.len(), 2);
    assert_eq!(pattern.flatten.corner_vertex[doubled[0]], pattern.flatten.corner_vertex[doubled[1]]);
    assert_eq!(pattern.loops[1].len(), 4);
    // Across the slit pieces need not alternate, but here they still do.
    assert!(pattern.directions_agree);
}

#[test]
fn cuts_may_open_a_hole_or_mend_the_alternation() {
    let ring: Vec<[i32; 2]> = block(5, 5).into_iter().filter(|&cell| cell != [2, 2]).collect();
    let mesh = cells(&ring);
    let at = |x: f64, y: f64| mesh.vertices.iter().position(|p| (p.x, p.y) == (x, y)).unwrap();
    let pattern = read(&mesh, &[vec![at(2.0, 0.0), at(2.0, 1.0), at(2.0, 2.0)]]).unwrap();
    check(&pattern);
    assert_eq!((pattern.loops.len(), pattern.loops[0].len()), (1, 28));
    // Another way to mend five patches than the proposed one.
    let five = patches(5, 4, 10.0, 4.0);
    let PatternMeshError::Alternation(found) = read(&five, &[]).unwrap_err() else { panic!() };
    let other: Vec<usize> =
        found.paths[0].iter().map(|&v| if v == 0 { 0 } else { (v + 19) % 100 + 1 }).collect();
    check(&read(&five, &[other]).unwrap());
    // A slit that ends short of the border makes an odd hole of the odd corner.
    let slit = found.paths[0][..3].to_vec();
    let PatternMeshError::Alternation(still) = read(&five, std::slice::from_ref(&slit)).unwrap_err() else {
        panic!()
    };
    assert_eq!((still.odd.len(), still.odd[0].kind), (1, Odd::Hole));
    let request = CutRequest::Automatic;
    let pattern = pattern_mesh(&five, Reading::Pieces, &numbered(&[slit]), request).unwrap();
    check(&pattern);
    assert_eq!((pattern.loops.len(), pattern.mended.paths[0].len()), (1, 3));
}

#[test]
fn cuts_are_found_by_their_places() {
    let mesh = sheet();
    let file = |x: f64| {
        let text = format!("v 0.3 0 0\nv {x} 0.1 0\nv 0.3 0.2 0\nl 1 2 3\n");
        cut_paths(&mesh, &polylines::parse(text.as_bytes()).unwrap(), 10.0)
    };
    // The file is in centimetres, the tolerance 0.01 mm.
    let expected = CutPath { vertices: path(&[[3, 0], [3, 1], [3, 2]]), line: 4 };
    assert_eq!(file(0.3009).unwrap(), [expected]);
    let message = file(0.302).unwrap_err().to_string();
    let expected = "line 4: vertex 2 of the cut at (3.02, 1.00, 0.00) mm is not a vertex of the mesh: the nearest one, \
        11, is 0.0200 mm away, and up to 0.0100 mm are allowed";
    assert_eq!(message, expected);
    let none = cut_paths(&mesh, &polylines::parse(b"v 0 0 0\n").unwrap(), 1.0).unwrap_err();
    assert!(none.to_string().contains("no cuts"));
    let own = own_cut_paths(&polylines::parse(b"v 0 0 0\nv 1 0 0\nf 1 2 1\nl 2 1\n").unwrap());
    assert_eq!(own, [CutPath { vertices: vec![1, 0], line: 4 }]);
}

#[test]
fn a_written_proposal_reads_back() {
    let mesh = patches(5, 4, 10.0, 4.0);
    let proposal = mended(&mesh).mended;
    let lines = polylines::parse(to_obj(&proposal, &mesh.vertices).as_bytes()).unwrap();
    let cuts = cut_paths(&mesh, &lines, 1.0).unwrap();
    assert_eq!(cuts.iter().map(|cut| cut.vertices.clone()).collect::<Vec<_>>(), proposal.paths);
}

#[test]
fn faulty_cuts_are_named() {
    let fault = |points: &[[usize; 2]]| read(&sheet(), &[path(points)]).unwrap_err().to_string();
    let across = fault(&[[2, 0], [2, 1], [2, 2], [2, 3], [2, 4]]);
    assert!(across.contains("2 parts, of 16; 8 pieces"), "{across}");
    let around = fault(&[[2, 1], [3, 1], [3, 2], [2, 2], [2, 1]]);
    assert!(around.contains("2 parts, of 23; 1 pieces"), "{around}");
    assert!(fault(&[[1, 1], [2, 2]]).contains("from vertex 9 to 17, but no two pieces share a side"));
    assert!(fault(&[[1, 1], [1, 0], [2, 0]]).contains("from vertex 2 to 3 the cut runs along the border"));
    assert!(fault(&[[1, 1]]).contains("line 10: the cut has only one vertex"));
    assert!(fault(&[[1, 1], [1, 1]]).contains("names vertex 9 twice in a row"));
    assert!(fault(&[[1, 1], [1, 2], [1, 1]]).contains("runs twice between vertex 16 and 9"));
    let unused = read(&sheet(), &[vec![3, 99]]).unwrap_err();
    assert!(
        unused.to_string().contains("vertex 100, which is the corner of no piece") && unused.is_bad_input()
    );
}
