mod alternation;
mod control;
mod cuts;
mod faults;
mod generators;

use super::*;
use generators::{block, cells, five, obj, patches, star, three};
use std::fs;
use std::path::Path;

/// Every face a piece, the given cuts alone.
fn read(mesh: &PolyMesh, cuts: &[Vec<usize>]) -> Result<PatternMesh, PatternMeshError> {
    pattern_mesh(mesh, Reading::Pieces, &numbered(cuts), CutRequest::AsGiven)
}

/// Every face a piece, with cuts where they are needed.
fn mended(mesh: &PolyMesh) -> PatternMesh {
    pattern_mesh(mesh, Reading::Pieces, &[], CutRequest::Automatic).unwrap()
}

/// Cuts in lines 10, 20 and so on.
fn numbered(cuts: &[Vec<usize>]) -> Vec<CutPath> {
    let cut =
        |(i, vertices): (usize, &Vec<usize>)| CutPath { vertices: vertices.clone(), line: 10 * (i + 1) };
    cuts.iter().enumerate().map(cut).collect()
}

/// Checks what every pattern promises: each corner has one fan, neighbours alternate, the parts fit each other, and the
/// surface to flatten is a disk made of the pieces.
fn check(pattern: &PatternMesh) {
    let PatternMesh { mesh, corners, flatten, .. } = pattern;
    assert_eq!([corners.len(), pattern.source_vertex.len(), mesh.fans.len()], [mesh.corner_count; 3]);
    assert_eq!([pattern.centres.len(), pattern.source_piece.len()], [mesh.pieces.len(); 2]);
    let around = mesh.pieces_around();
    for (corner, fan) in mesh.fans.iter().enumerate() {
        let pieces = mesh.pieces.iter().filter(|piece| piece.contains(&corner)).count();
        assert_eq!(fan.edges.len(), pieces + usize::from(!fan.closed), "corner {corner}");
        assert_eq!(around[corner].len(), pieces);
        assert!(!fan.closed || pieces % 2 == 0);
    }
    for edge in &mesh.edges {
        if let Some(neighbour) = edge.neighbour {
            assert_ne!(mesh.counter_clockwise[edge.piece], mesh.counter_clockwise[neighbour]);
        }
    }
    for (corners, owned) in mesh.pieces.iter().zip(&mesh.owned) {
        assert!(corners.iter().zip(owned).all(|(&corner, &edge)| mesh.edges[edge].hinge_corner == corner));
    }
    let border: usize = pattern.loops.iter().map(Vec::len).sum();
    assert_eq!(border, mesh.edges.iter().filter(|edge| edge.is_border()).count());
    let disk = crate::geometry::topology::disk(&flatten.mesh.faces).unwrap();
    assert_eq!(disk.boundary, flatten.boundary);
    assert_eq!(flatten.mesh.faces.len(), mesh.pieces.iter().map(Vec::len).sum::<usize>());
    assert!(flatten.corner_vertex.iter().zip(corners).all(|(&v, p)| flatten.mesh.vertices[v] == *p));
    assert!(flatten.centre_vertex.iter().zip(&pattern.centres).all(|(&v, p)| flatten.mesh.vertices[v] == *p));
    for (face, &piece) in flatten.mesh.faces.iter().zip(&flatten.piece_of) {
        let own = mesh.pieces[piece].iter().map(|&corner| flatten.corner_vertex[corner]);
        let own: Vec<usize> = own.chain([flatten.centre_vertex[piece]]).collect();
        assert!(face.iter().all(|v| own.contains(v)));
    }
}

/// The samples' files and what stands in them.
fn samples() -> [(&'static str, String); 4] {
    let five = five();
    [
        ("three.obj", obj(&three(), "a dome of three patches of quads around one corner, millimetres")),
        ("star.obj", obj(&star(), "a dome of six patches of quads around one corner, millimetres")),
        ("five.obj", obj(&five, "a dome of five patches of quads around one corner, millimetres")),
        ("five-cuts.obj", to_obj(&mended(&five).mended, &five.vertices)),
    ]
}

/// The proposed cuts as an OBJ file, which may serve as the cuts of the mesh with these vertices.
fn to_obj(proposal: &Alternation, vertices: &[Point3]) -> String {
    let mut text = String::from("# cuts along which the sheet is to be opened\n");
    let mut count = 0;
    for path in &proposal.paths {
        for p in path.iter().map(|&v| vertices[v]) {
            text.push_str(&format!("v {} {} {}\n", p.x, p.y, p.z));
        }
        let numbers: Vec<String> = (1..=path.len()).map(|i| (count + i).to_string()).collect();
        text.push_str(&format!("l {}\n", numbers.join(" ")));
        count += path.len();
    }
    text
}

#[test]
fn the_samples_are_what_their_generators_make() {
    for (name, text) in samples() {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples").join(name);
        if std::env::var_os("UPDATE_SAMPLES").is_some() {
            fs::write(&file, &text).unwrap();
        }
        assert!(fs::read_to_string(&file).unwrap() == text, "samples/{name}: run with UPDATE_SAMPLES=1");
    }
}

#[test]
fn a_grid_is_the_regular_cover() {
    let l_shape: Vec<[i32; 2]> = block(7, 6).into_iter().filter(|[i, j]| *i < 3 || *j < 2).collect();
    for grid in [block(2, 2), block(6, 5), l_shape] {
        let pattern = read(&cells(&grid), &[]).unwrap();
        check(&pattern);
        let (expected, positions) = PieceMesh::from_cells(&grid);
        assert_eq!(pattern.mesh, expected);
        assert!(pattern.directions_agree && pattern.mended.odd.is_empty() && pattern.loops.len() == 1);
        let at = |p: &Point3| [p.x as i32, p.y as i32];
        assert_eq!(pattern.corners.iter().map(at).collect::<Vec<_>>(), positions);
        assert_eq!(pattern.centres[0], Point3::new(0.5, 0.5, 0.0));
    }
}

#[test]
fn numbering_does_not_matter() {
    let grid = cells(&block(5, 4));
    let expected = read(&grid, &[]).unwrap();
    // Vertices and faces in another order, faces begun elsewhere; 7 has no common factor with 30 or 20.
    let n = grid.vertices.len();
    let mut mesh = PolyMesh { vertices: vec![Point3::origin(); n], faces: Vec::new() };
    (0..n).for_each(|v| mesh.vertices[7 * v % n] = grid.vertices[v]);
    for f in 0..20 {
        let mut face: Vec<usize> = grid.faces[7 * f % 20].iter().map(|v| 7 * v % n).collect();
        face.rotate_left(f % 4);
        mesh.faces.push(face);
    }
    let pattern = read(&mesh, &[]).unwrap();
    check(&pattern);
    // Joined pieces, hinge places and directions, said by positions; the first piece is the same one.
    let said = |pattern: &PatternMesh| {
        let edge = |edge: &crate::kirigami::piece_mesh::Edge| {
            let p = |c: usize| (pattern.corners[c].x as i32, pattern.corners[c].y as i32);
            let ends = edge.corners.map(p);
            let ends = [*ends.iter().min().unwrap(), *ends.iter().max().unwrap()];
            (ends, edge.is_border(), p(edge.hinge_corner))
        };
        let mut edges: Vec<_> = pattern.mesh.edges.iter().map(edge).collect();
        edges.sort_unstable();
        edges
    };
    assert_eq!(said(&pattern), said(&expected));
    let horizontal = |pattern: &PatternMesh, e: usize| {
        let [p, q] = pattern.mesh.edges[e].corners.map(|c| pattern.corners[c]);
        p.y == q.y
    };
    let first = pattern.mesh.edges[0].direction == usize::from(!horizontal(&pattern, 0));
    for (e, edge) in pattern.mesh.edges.iter().enumerate() {
        assert_eq!(edge.direction == usize::from(!horizontal(&pattern, e)), first);
    }
}

#[test]
fn lines_go_straight_on_where_the_pattern_is_a_grid() {
    let l_shape: Vec<[i32; 2]> = block(4, 4).into_iter().filter(|[i, j]| *i < 2 || *j < 2).collect();
    for mesh in [cells(&l_shape), patches(6, 4, 1.0, 0.0)] {
        let pattern = read(&mesh, &[]).unwrap();
        check(&pattern);
        let PatternMesh { mesh, corners, .. } = &pattern;
        for (corner, fan) in mesh.fans.iter().enumerate() {
            let regular = fan.edges.len() != 6 && fan.edges.len() != 2;
            let expected = match (regular, fan.edges.len()) {
                (false, _) => 0,
                (_, 3) => 1,
                _ => 2,
            };
            assert_eq!(fan.opposite_pairs().len(), expected);
            for pair in fan.opposite_pairs() {
                let [p, q] = pair.map(|e| corners[mesh.edges[e].other_end(corner)] - corners[corner]);
                // Within 41 degrees, in a mesh that is as square as six sectors allow.
                assert!(p.normalize().dot(&q.normalize()) < -0.75, "{corner}");
                assert_eq!(mesh.edges[pair[0]].direction, mesh.edges[pair[1]].direction);
            }
        }
        assert!(mesh.edge_triples().iter().all(|([e, f, g], [p, q])| {
            let ends = |e: &usize| mesh.edges[*e].corners;
            ends(e).contains(p) && ends(f).contains(p) && ends(f).contains(q) && ends(g).contains(q)
        }));
    }
}
