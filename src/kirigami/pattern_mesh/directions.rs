//! The two directions of sides, where the pieces form a grid at least locally.
//!
//! The sides of a quad have directions 0, 1, 0, 1, and at an inner corner of four pieces the four sides do, around the
//! corner. These demands meet all quads and regular corners; around an inner corner of three or five quads they
//! contradict each other, around six they do not.

use crate::kirigami::piece_mesh::PieceMesh;

/// Gives each edge its direction: along the first side of the first piece it is 0. Returns whether all demands are
/// met; if not, directions are of no use.
pub(super) fn assign(mesh: &mut PieceMesh) -> bool {
    let mut across: Vec<Vec<usize>> = vec![Vec::new(); mesh.edges.len()];
    let quads = mesh.pieces.iter().zip(&mesh.owned).filter(|(corners, _)| corners.len() == 4);
    // Owned edges run around the piece as its sides do.
    let around_quads = quads.map(|(_, owned)| owned);
    let around_corners =
        mesh.fans.iter().filter(|fan| fan.closed && fan.edges.len() == 4).map(|fan| &fan.edges);
    for four in around_quads.chain(around_corners) {
        for i in 0..4 {
            let (e, f) = (four[i], four[(i + 1) % 4]);
            across[e].push(f);
            across[f].push(e);
        }
    }
    let mut agree = true;
    let mut directions: Vec<Option<usize>> = vec![None; mesh.edges.len()];
    for start in 0..mesh.edges.len() {
        if directions[start].is_some() {
            continue;
        }
        directions[start] = Some(0);
        let mut open = vec![(start, 0)];
        while let Some((edge, direction)) = open.pop() {
            for &other in &across[edge] {
                match directions[other] {
                    None => {
                        directions[other] = Some(1 - direction);
                        open.push((other, 1 - direction));
                    }
                    Some(found) => agree &= found != direction,
                }
            }
        }
    }
    for (edge, direction) in mesh.edges.iter_mut().zip(directions) {
        edge.direction = direction.unwrap_or_default();
    }
    agree
}
