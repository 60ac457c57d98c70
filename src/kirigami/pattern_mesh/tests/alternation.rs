use super::*;

#[test]
fn even_patches_alternate_and_odd_ones_are_named() {
    for k in [3, 4, 5, 6, 7, 8] {
        let n = 4;
        let mesh = patches(k, n, 10.0, 4.0);
        if k % 2 == 0 {
            let pattern = read(&mesh, &[]).unwrap();
            check(&pattern);
            assert!(pattern.directions_agree && pattern.mended.paths.is_empty());
            continue;
        }
        let PatternMeshError::Alternation(found) = read(&mesh, &[]).unwrap_err() else { panic!("{k}") };
        assert_eq!(found.odd.len(), 1);
        let odd = &found.odd[0];
        assert_eq!((odd.kind, &odd.vertices[..], odd.pieces), (Odd::Corner, &[0][..], k));
        assert_eq!(odd.at, mesh.vertices[0]);
        // The shortest way out: straight along the ray between two patches.
        assert_eq!((found.paths.len(), found.paths[0].len(), found.shortest), (1, n + 1, true));
        let steps = found.paths[0].windows(2).map(|w| (mesh.vertices[w[1]] - mesh.vertices[w[0]]).norm());
        assert!((steps.sum::<f64>() - found.length).abs() < 1e-9);
        let message = read(&mesh, &[]).unwrap_err().to_string();
        assert!(
            message.contains(&format!("{k} pieces meet at vertex 1, (0.00, 0.00, 4.00) mm")),
            "{message}"
        );

        let pattern = mended(&mesh);
        check(&pattern);
        assert_eq!(pattern.mended, *found);
        // The end inside stays one corner, the others are doubled.
        assert_eq!(pattern.mesh.corner_count, mesh.vertices.len() + n);
        assert_eq!((pattern.loops.len(), pattern.loops[0].len()), (1, 2 * n * k + 2 * n));
        assert_eq!(pattern.mesh.fans[0].edges.len(), k + 1);
        // The singularity is at the border now.
        assert!(pattern.directions_agree);
        assert!(!control_directions(&mesh));
    }
}

/// Whether directions agree around a piece with an odd number of corners.
fn control_directions(mesh: &PolyMesh) -> bool {
    let reading = Reading::ControlMesh { pieces_at: Some(0) };
    pattern_mesh(mesh, reading, &[], CutRequest::AsGiven).unwrap().directions_agree
}

/// A block of squares, each split along one diagonal or the other; corners have any valences.
fn split_block(columns: i32, rows: i32, seed: u64) -> PolyMesh {
    let mut mesh = cells(&block(columns, rows));
    let mut state = seed;
    mesh.faces = mesh
        .faces
        .iter()
        .flat_map(|f| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let [a, b, c, d] = if state >> 62 & 1 == 0 { [0, 1, 2, 3] } else { [1, 2, 3, 0] }.map(|i| f[i]);
            [vec![a, b, c], vec![a, c, d]]
        })
        .collect();
    mesh
}

/// Whether pieces can alternate over the inner edges that are not left out.
fn alternates(mesh: &PieceMesh, left_out: impl Fn(usize) -> bool) -> bool {
    let mut sides = crate::geometry::union_find::UnionFind::new(2 * mesh.pieces.len());
    for (e, edge) in mesh.edges.iter().enumerate().filter(|(e, _)| !left_out(*e)) {
        if let (p, Some(q)) = (edge.piece, mesh.edges[e].neighbour) {
            sides.join(2 * p, 2 * q + 1);
            sides.join(2 * p + 1, 2 * q);
        }
    }
    (0..mesh.pieces.len()).all(|piece| !sides.same(2 * piece, 2 * piece + 1))
}

#[test]
fn the_proposed_cuts_are_the_shortest() {
    // Against all sets of inner edges.
    let mut odd = 0;
    for seed in 0..12 {
        let source = split_block(3, 2, seed);
        let (cut, tiling) = (EdgeSet::new(), faces::pieces(&source));
        let mesh = Sheet::new(&tiling, &cut).unwrap().mesh;
        let inner: Vec<usize> = (0..mesh.edges.len()).filter(|&e| !mesh.edges[e].is_border()).collect();
        let length = |e: &usize| {
            let [p, q] = mesh.edges[*e].corners.map(|c| source.vertices[c]);
            (q - p).norm()
        };
        let mut least = f64::INFINITY;
        for set in 0..1_usize << inner.len() {
            let chosen = |i: usize| set >> i & 1 == 1;
            let total: f64 = (0..inner.len()).filter(|&i| chosen(i)).map(|i| length(&inner[i])).sum();
            let out = |e: usize| inner.iter().position(|&f| f == e).is_some_and(chosen);
            if total < least && alternates(&mesh, out) {
                least = total;
            }
        }
        let pattern = mended(&source);
        check(&pattern);
        assert!((pattern.mended.length - least).abs() < 1e-9, "{seed}: {} {least}", pattern.mended.length);
        odd += pattern.mended.odd.len();
    }
    assert!(odd > 6, "{odd}");
}

#[test]
fn many_odd_corners_are_mended_in_one_piece() {
    let mut most = 0;
    for (columns, rows, seed) in [(4, 4, 1), (8, 5, 2), (12, 12, 3), (25, 20, 4), (40, 40, 5)] {
        let source = split_block(columns, rows, seed);
        let pattern = mended(&source);
        check(&pattern);
        let odd = &pattern.mended.odd;
        assert_eq!(pattern.mended.shortest, odd.len() + odd.len() % 2 <= proposal::MOST_EXACT);
        let expected = alternation_oracle(&source);
        assert_eq!(odd.iter().map(|odd| odd.vertices[0]).collect::<Vec<_>>(), expected);
        most = most.max(odd.len());
        // Cuts to the border are longer and leave a disk.
        let to_border = pattern_mesh(&source, Reading::Pieces, &[], CutRequest::AutomaticToBorder).unwrap();
        check(&to_border);
        assert_eq!(&to_border.mended.odd, odd);
        assert!(to_border.loops.len() == 1 && to_border.mended.length >= pattern.mended.length - 1e-9);
    }
    assert!(most > proposal::MOST_PAIRED, "{most}");
}

/// Inner vertices of a split block with an odd number of triangles.
fn alternation_oracle(mesh: &PolyMesh) -> Vec<usize> {
    let high = mesh.vertices.iter().fold(Point3::origin(), |high, p| high.sup(p));
    let inner = |p: &Point3| p.x > 0.0 && p.y > 0.0 && p.x < high.x && p.y < high.y;
    let valence = |v: usize| mesh.faces.iter().filter(|face| face.contains(&v)).count();
    (0..mesh.vertices.len()).filter(|&v| inner(&mesh.vertices[v]) && valence(v) % 2 == 1).collect()
}

#[test]
fn odd_holes_are_named_and_opened() {
    // Five patches without the five pieces in the middle: three more of each patch lie around.
    let mut mesh = patches(5, 4, 10.0, 0.0);
    mesh.faces.retain(|face| !face.contains(&0));
    let PatternMeshError::Alternation(found) = read(&mesh, &[]).unwrap_err() else { panic!() };
    assert_eq!(found.odd.len(), 1);
    assert_eq!((found.odd[0].kind, found.odd[0].pieces, found.odd[0].vertices.len()), (Odd::Hole, 15, 10));
    assert!((found.odd[0].at.coords.norm()) < 1e-6);
    let pattern = mended(&mesh);
    check(&pattern);
    assert_eq!((pattern.mended.paths.len(), pattern.mended.paths[0].len(), pattern.loops.len()), (1, 4, 1));
    // An even hole needs no cut to alternate, but the sheet must be opened to be laid flat.
    let ring: Vec<[i32; 2]> = block(5, 5).into_iter().filter(|&cell| cell != [2, 2]).collect();
    let message = read(&cells(&ring), &[]).unwrap_err().to_string();
    assert!(message.contains("an annulus with 2 boundary loops (of 20 and 4 edges)"), "{message}");
}
