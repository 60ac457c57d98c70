//! Corners of a piece that nearly coincide, as other programs leave them: laid out as one.

use super::design::Design;
use super::rigidity::mean_piece_side;
use crate::geometry::Point3;

/// Corners nearer than this, in mean sides of the pieces, nearly coincide.
pub const NEARLY: f64 = 1e-3;

/// The design without the free vertices that nearly coincide, in both states, with another vertex of their piece, and
/// the pieces that lost one. Triangles keep theirs. Their sheet corners become one.
pub fn without_repeated_corners(design: &Design) -> (Design, Vec<usize>) {
    let least = NEARLY * mean_piece_side(design);
    let mut simple = design.clone();
    let mut changed = Vec::new();
    for id in 0..design.pieces.len() {
        let Some((gone, kept)) = repeated(&simple, id, least) else { continue };
        changed.push(id);
        let [from, to] = [gone, kept].map(|vertex| simple.pieces[id].corners[vertex]);
        let piece = &mut simple.pieces[id];
        piece.corners.remove(gone);
        piece.closed.remove(gone);
        piece.open.remove(gone);
        for piece in &mut simple.pieces {
            piece.corners.iter_mut().filter(|corner| **corner == from).for_each(|corner| *corner = to);
        }
        for hinge in &mut simple.hinges {
            for end in 0..2 {
                if hinge.pieces[end] == id && hinge.vertices[end] > gone {
                    hinge.vertices[end] -= 1;
                }
            }
        }
    }
    (simple, changed)
}

/// A free vertex of a piece and the one that it repeats.
fn repeated(design: &Design, id: usize, least: f64) -> Option<(usize, usize)> {
    let piece = &design.pieces[id];
    let n = piece.closed.len();
    let hinged = |vertex: usize| {
        design.hinges.iter().any(|h| (0..2).any(|end| h.pieces[end] == id && h.vertices[end] == vertex))
    };
    let near = |points: &[Point3], i: usize, j: usize| (points[i] - points[j]).norm() < least;
    let pairs = (0..n).flat_map(|i| [(i, (i + 1) % n), ((i + 1) % n, i)]);
    pairs
        .filter(|_| n > 3)
        .filter(|&(i, j)| near(&piece.closed, i, j) && near(&piece.open, i, j))
        .find(|&(i, _)| !hinged(i))
}
