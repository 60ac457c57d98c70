use super::*;

fn fault(mesh: &PolyMesh) -> PatternMeshError {
    read(mesh, &[]).unwrap_err()
}

#[test]
fn faulty_faces_are_named() {
    let sheet = cells(&block(4, 3));
    let with = |change: &dyn Fn(&mut PolyMesh)| {
        let mut mesh = sheet.clone();
        change(&mut mesh);
        fault(&mesh)
    };
    let repeated = with(&|mesh| mesh.faces[4][2] = mesh.faces[4][0]).to_string();
    assert!(repeated.starts_with("face 5 names vertex"), "{repeated}");
    let welded = with(&|mesh| mesh.vertices[1] = mesh.vertices[0]).to_string();
    assert!(welded.contains("face 1: vertices 1 and 2 lie in one place, (0.00, 0.00, 0.00) mm"), "{welded}");
    let branching = with(&|mesh| {
        mesh.vertices.push(Point3::new(0.0, 0.0, 1.0));
        mesh.faces.push(vec![1, 2, 20]);
    });
    assert!(matches!(&branching, PatternMeshError::Mesh(fault)
        if matches!(fault.defect, crate::geometry::topology::Defect::BranchingEdge { .. })));
    assert!(branching.is_bad_input());
    let parts = with(&|mesh| {
        mesh.vertices.extend([5.0, 6.0, 7.0].map(|x| Point3::new(x, x * x, 0.0)));
        mesh.faces.push(vec![20, 21, 22]);
    });
    assert!(parts.to_string().contains("2 components, with 12 and 1 faces"), "{parts}");
    let few = fault(&cells(&block(3, 1)));
    assert!(matches!(few, PatternMeshError::TooFew { pieces: 3 }) && few.is_bad_input());
}

#[test]
fn closed_surfaces_are_refused() {
    // A cube of six faces.
    let vertices =
        (0..8).map(|v| Point3::new(f64::from(v & 1), f64::from(v >> 1 & 1), f64::from(v >> 2))).collect();
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let closed = fault(&PolyMesh { vertices, faces: faces.map(Vec::from).to_vec() });
    assert!(closed.to_string().contains("closed surface of genus 0") && !closed.is_bad_input(), "{closed}");
}

#[test]
fn faces_wound_the_other_way_are_turned_over() {
    let sheet = cells(&block(5, 4));
    let expected = read(&sheet, &[]).unwrap();
    let mut mesh = sheet.clone();
    mesh.faces[3].reverse();
    mesh.faces[7].reverse();
    let pattern = read(&mesh, &[]).unwrap();
    check(&pattern);
    assert_eq!((&pattern.turned_faces[..], &expected.turned_faces[..]), (&[3, 7][..], &[][..]));
    assert_eq!(pattern.mesh.edges.len(), expected.mesh.edges.len());
    assert_eq!(pattern.loops, expected.loops);
}

#[test]
fn pieces_with_two_common_sides_are_refused() {
    // The middle edge of two cells is bent at a vertex that only these two have.
    let mut mesh = cells(&block(2, 2));
    mesh.vertices.push(Point3::new(0.9, 0.5, 0.0));
    let new = mesh.vertices.len() - 1;
    let at = |x: f64, y: f64| mesh.vertices.iter().position(|p| (p.x, p.y) == (x, y)).unwrap();
    let (low, high) = (at(1.0, 0.0), at(1.0, 1.0));
    for face in &mut mesh.faces[..2] {
        let i = face.iter().position(|&v| v == low).unwrap();
        let after = face[(i + 1) % 4] == high;
        face.insert(if after { i + 1 } else { i }, new);
    }
    let fault = fault(&mesh);
    assert!(matches!(fault, PatternMeshError::SharedTwice { pieces: [0, 1], .. }), "{fault}");
    assert!(fault.to_string().contains("face 1 and 2 share two sides"), "{fault}");
}

#[test]
fn control_meshes_have_quads_and_two_colours() {
    let control = |mesh: &PolyMesh, pieces_at| {
        let reading = Reading::ControlMesh { pieces_at };
        pattern_mesh(mesh, reading, &[], CutRequest::AsGiven).unwrap_err().to_string()
    };
    let mut mesh = cells(&block(4, 4));
    assert!(control(&mesh, Some(77)).contains("no face has vertex 78"));
    mesh.faces[6].pop();
    let message = control(&mesh, None);
    assert!(message.starts_with("face 7 at (2.00, 1.00, 0.00) mm has 3 corners"), "{message}");
    // Seven cells around a hole.
    let mut ring = PolyMesh::default();
    for k in 0..7 {
        let turn = f64::from(k) * std::f64::consts::TAU / 7.0;
        ring.vertices.extend([1.0, 2.0, 3.0].map(|r| Point3::new(r * turn.cos(), r * turn.sin(), 0.0)));
        let (a, b) = (3 * k as usize, 3 * (k as usize + 1) % 21);
        ring.faces.extend([vec![a, a + 1, b + 1, b], vec![a + 1, a + 2, b + 2, b + 1]]);
    }
    let message = control(&ring, None);
    assert!(message.contains("centres and corners of pieces do not take turns"), "{message}");
    // A vertex with two faces around.
    let mut doublet = cells(&block(4, 4));
    let [a, b, c, d] = [0, 1, 2, 3].map(|i| doublet.faces[5][i]);
    doublet.vertices.push(Point3::new(1.6, 1.4, 0.0));
    let new = doublet.vertices.len() - 1;
    doublet.faces[5] = vec![a, b, c, new];
    doublet.faces.push(vec![a, new, c, d]);
    let message = control(&doublet, Some(new));
    assert!(
        message.contains(&format!("vertex {} at (1.60, 1.40, 0.00) mm is the centre", new + 1)),
        "{message}"
    );
    let message = control(&doublet, Some(a));
    assert!(message.contains("share two sides"), "{message}");
}
