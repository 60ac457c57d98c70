//! Patterns from quad meshes with singularities: the samples, and a mesh that others made.

mod peers;

use std::path::{Path, PathBuf};

use kirimorph::geometry::flatten::{ConformalScale, flatten};
use kirimorph::geometry::read::polylines::read_polylines;
use kirimorph::geometry::read::read_mesh;
use kirimorph::geometry::stretch::{stretches, worst_ratio};
use kirimorph::kirigami::feasibility::EASY_RATIO;
use kirimorph::kirigami::pattern_mesh::{
    CutRequest, Odd, PatternMesh, PatternMeshError, Reading, cut_paths, pattern_mesh,
};

fn sample(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("samples").join(name)
}

/// Sorted valences of the closed corners other than 4.
fn irregular(pattern: &PatternMesh) -> Vec<usize> {
    let closed = pattern.mesh.fans.iter().filter(|fan| fan.closed).map(|fan| fan.edges.len());
    let mut irregular: Vec<usize> = closed.filter(|&n| n != 4).collect();
    irregular.sort_unstable();
    irregular
}

/// Largest over smallest stretch of a pattern's surface laid flat.
fn flattened(pattern: &PatternMesh) -> f64 {
    let surface = &pattern.flatten;
    let scale = ConformalScale::solve(&surface.mesh, &surface.boundary).unwrap();
    let flat = flatten(&surface.mesh, &scale, EASY_RATIO).unwrap();
    worst_ratio(&stretches(&surface.mesh, &flat.points))
}

#[test]
fn the_star_has_one_singularity_and_needs_no_cut() {
    let mesh = read_mesh(&sample("star.obj")).unwrap();
    let star = pattern_mesh(&mesh, Reading::Pieces, &[], CutRequest::AsGiven).unwrap();
    assert_eq!((star.mesh.pieces.len(), irregular(&star)), (294, vec![6]));
    assert!(star.directions_agree && star.mended.odd.is_empty());
    assert!(flattened(&star) < 1.2, "{}", flattened(&star));
}

#[test]
fn the_sample_of_five_patches_needs_its_cut() {
    let mesh = read_mesh(&sample("five.obj")).unwrap();
    let read = |cuts: &[_]| pattern_mesh(&mesh, Reading::Pieces, cuts, CutRequest::AsGiven);
    let message = read(&[]).unwrap_err().to_string();
    assert!(message.contains("5 pieces meet at vertex 1, (0.00, 0.00, 30.00) mm"), "{message}");
    let lines = read_polylines(&sample("five-cuts.obj")).unwrap();
    let five = read(&cut_paths(&mesh, &lines, 1.0).unwrap()).unwrap();
    assert_eq!((five.mesh.pieces.len(), irregular(&five)), (245, vec![]));
    assert_eq!((five.loops.len(), five.mesh.corner_count), (1, mesh.vertices.len() + 7));
    assert!(flattened(&five) < 1.2, "{}", flattened(&five));
}

#[test]
fn a_mesh_with_four_odd_vertices_comes_through_both_readings() {
    // Vertices 2, 29, 47 and 54 have three faces each; distances by an independent program (Dijkstra's method).
    const ODD: [usize; 4] = [1, 28, 46, 53];
    const BORDER: [f64; 4] = [1.303667, 1.211521, 0.879318, 2.631920];
    let Some(path) = peers::shared("meshes/6-sub-lifted.obj") else { return };
    let mesh = read_mesh(&path).unwrap();
    let read = |reading, request| pattern_mesh(&mesh, reading, &[], request);

    let PatternMeshError::Alternation(found) = read(Reading::Pieces, CutRequest::AsGiven).unwrap_err() else {
        panic!("four corners of three pieces alternate")
    };
    assert_eq!(found.odd.iter().map(|odd| odd.vertices[0]).collect::<Vec<_>>(), ODD);
    assert!(found.odd.iter().all(|odd| (odd.kind, odd.pieces) == (Odd::Corner, 3)));
    // Two go to the border, the two others to each other.
    assert!(
        (found.length - (BORDER[0] + BORDER[1] + 2.973)).abs() < 1e-3 && found.shortest,
        "{}",
        found.length
    );
    let ends: Vec<[usize; 2]> = found.paths.iter().map(|path| [path[0], path[path.len() - 1]]).collect();
    assert_eq!(ends, [[1, 2], [27, 28], [46, 53]]);
    let cut = read(Reading::Pieces, CutRequest::Automatic).unwrap();
    assert_eq!((cut.mesh.pieces.len(), cut.loops.len(), irregular(&cut)), (188, 2, vec![]));
    assert!(flattened(&cut) < 1.3, "{}", flattened(&cut));
    let cut = read(Reading::Pieces, CutRequest::AutomaticToBorder).unwrap();
    assert_eq!((cut.mended.paths.len(), cut.loops.len()), (4, 1));
    assert!((cut.mended.length - BORDER.iter().sum::<f64>()).abs() < 1e-5);

    // As a control mesh it has pieces of three corners at the four, and nothing fails.
    let control = read(Reading::ControlMesh { pieces_at: None }, CutRequest::AsGiven).unwrap();
    assert!(control.mended.odd.is_empty() && irregular(&control).is_empty());
    for odd in ODD {
        let piece = control.source_piece.iter().position(|&v| v == odd).expect("a piece there");
        assert_eq!(control.mesh.pieces[piece].len(), 3);
    }
    // The other way round the four are corners again.
    let other = Reading::ControlMesh { pieces_at: Some(control.source_vertex[0]) };
    let PatternMeshError::Alternation(found) = read(other, CutRequest::AsGiven).unwrap_err() else {
        panic!()
    };
    assert_eq!(found.odd.iter().map(|odd| odd.vertices[0]).collect::<Vec<_>>(), ODD);
    read(other, CutRequest::Automatic).unwrap();
}
