//! The start of Stage 3: the model cell in every quad of the control meshes (section 3.4).
//!
//! A quad takes the model's points by the bilinear map of the model's rectangle onto it. Of all maps that are linear along
//! the edges it is the one that takes the corners to the corners, so that neighbours match: they have the same points on
//! their common edge.

use super::cell::BistableCell;
use super::mesh::{BistableMesh, Role};
use super::pattern::BistablePattern;
use crate::geometry::{Point2, Point3, Vector3};
use crate::kirigami::piece_mesh::PieceMesh;

/// Weights of a quad's corners 0 to 3 at a point of the model's rectangle with sides `sides`, the origin in its middle.
pub fn bilinear(p: Point2, sides: [f64; 2]) -> [f64; 4] {
    let (u, v) = (p.x / sides[0] + 0.5, p.y / sides[1] + 0.5);
    [(1.0 - u) * (1.0 - v), u * (1.0 - v), u * v, (1.0 - u) * v]
}

/// The image of corner m in cells turned by -phi: the mirror image of this corner in cells turned by +phi.
const MIRRORED: [usize; 4] = [1, 0, 3, 2];

/// A point that the model has at rectangle corner `m` of cells turned by +phi, in a cell turned by `turned` + or -.
pub fn handed(turned: bool, m: usize, at: impl Fn(usize) -> Point2) -> Point2 {
    if turned {
        return at(m);
    }
    let p = at(MIRRORED[m]);
    Point2::new(-p.x, p.y)
}

/// The share of a grid edge, from its first corner to its second, at which a slit of this cell meets it; `m` is the corner
/// that the slit passes.
fn share(cell: &BistableCell, turned: bool, m: usize) -> f64 {
    let (i, sign) = if turned { (m, 1.0) } else { (MIRRORED[m], -1.0) };
    let length = cell.cell[1 - i % 2];
    0.5 + sign * cell.crossing(i) / length
}

/// The pattern of these control meshes: corners of the grid in both states.
pub fn fitted(
    cell: &BistableCell,
    grid: &PieceMesh,
    mesh: &BistableMesh,
    closed: &[Point3],
    open: &[Point3],
) -> BistablePattern {
    let map = |corners: &[Point3], c: usize, p: Point2, sides: [f64; 2]| {
        let weights = bilinear(p, sides);
        Point3::from((0..4).map(|k| corners[grid.pieces[c][k]].coords * weights[k]).sum::<Vector3>())
    };
    let mut pattern = BistablePattern {
        corners: vec![Point3::origin(); mesh.corner_count],
        offsets: vec![Vector3::zeros(); 4 * mesh.cells],
        open: vec![Point3::origin(); mesh.open_count],
    };
    for corner in 0..4 * mesh.cells {
        let (c, m) = (corner / 4, corner % 4);
        let turned = grid.counter_clockwise[c];
        let at = handed(turned, m, |i| cell.passing(i));
        let hinge = handed(turned, m, |i| cell.hinge(i, cell.phi));
        let snapped = handed(turned, m, |i| cell.hinge(i, -cell.phi));
        pattern.corners[corner] = map(closed, c, at, cell.cell);
        pattern.offsets[corner] = map(closed, c, hinge, cell.cell) - pattern.corners[corner];
        pattern.open[corner] = map(open, c, snapped, cell.expanded());
    }
    for (corner, slit) in mesh.passing.iter().enumerate() {
        let (c, turned) = (corner / 4, grid.counter_clockwise[corner / 4]);
        let edge = &grid.edges[slit.crossing - 4 * mesh.cells];
        let share = share(cell, turned, corner % 4);
        // Counter-clockwise around the cell.
        let [p, q] = if edge.piece == c { edge.corners } else { [edge.corners[1], edge.corners[0]] };
        pattern.corners[slit.crossing] = closed[p] + (closed[q] - closed[p]) * share;
    }
    for (corner, own) in mesh.outline.iter().enumerate() {
        if let Some(own) = own {
            pattern.corners[*own] = closed[corner];
        }
    }
    place_free(cell, grid, mesh, &mut pattern, [closed, open]);
    pattern
}

/// Open points of free vertices: each piece around a corner of the grid moves, as the model has it, without turning: its
/// crossings keep their distance from that corner.
fn place_free(
    cell: &BistableCell,
    grid: &PieceMesh,
    mesh: &BistableMesh,
    pattern: &mut BistablePattern,
    [closed, open]: [&[Point3]; 2],
) {
    let around = (0..grid.fans.len()).filter(|&corner| !grid.fans[corner].edges.is_empty());
    for (corner, piece) in around.zip(&mesh.pieces[mesh.cells..]) {
        for vertex in piece {
            let Role::Free(at) = vertex.role else { continue };
            let Some(edge) = vertex.corner.checked_sub(4 * mesh.cells).and_then(|e| grid.edges.get(e)) else {
                pattern.open[at] = open[corner];
                continue;
            };
            let far = edge.other_end(corner);
            let part = (pattern.corners[vertex.corner] - closed[corner]).norm()
                / (closed[far] - closed[corner]).norm();
            let stretch = cell.stretches()[edge.direction];
            pattern.open[at] = open[corner] + (open[far] - open[corner]) * (part / stretch);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::pattern::regular;
    use super::*;
    use crate::kirigami::design::{Design, State};
    use crate::kirigami::quality::measure_alone;

    fn design(gap: f64, rectangle: [f64; 2], counts: [usize; 2]) -> (Design, BistablePattern) {
        let cell = BistableCell { cell: [24.0, 22.0], rectangle, phi: 18_f64.to_radians(), gap };
        assert!(cell.misses().is_empty());
        let (mesh, pattern) = regular(&cell, counts);
        (pattern.design(&mesh, gap, Some(State::Closed)), pattern)
    }

    #[test]
    fn the_regular_pattern_snaps_without_strain() {
        for (gap, rectangle) in [(0.0, [8.4, 7.6]), (1.5, [8.0, 8.0]), (0.55, [6.0, 8.5])] {
            let (design, _) = design(gap, rectangle, [4, 3]);
            assert!(measure_alone(&design).max_length_error < 1e-13, "{gap}");
            for hinge in &design.hinges {
                assert!((hinge.angle - 36_f64.to_radians()).abs() < 1e-12);
                let [p, q] = [0, 1].map(|k| {
                    let piece = &design.pieces[hinge.pieces[k]];
                    (piece.closed[hinge.vertices[k]], piece.open[hinge.vertices[k]])
                });
                assert_eq!(p, q);
            }
        }
    }

    #[test]
    fn settling_changes_nothing_in_the_regular_pattern() {
        let cell = BistableCell { cell: [20.0, 18.0], rectangle: [8.0, 7.0], phi: 0.3, gap: 1.2 };
        let (mesh, pattern) = regular(&cell, [3, 3]);
        let mut settled = pattern.clone();
        settled.settle(&mesh, 1.2);
        for (p, q) in pattern.corners.iter().zip(&settled.corners) {
            assert!((p - q).norm() < 1e-6, "{p} {q}");
        }
        for (p, q) in pattern.offsets.iter().zip(&settled.offsets) {
            assert!((p - q).norm() < 1e-6, "{p} {q}");
        }
    }

    #[test]
    fn closed_pieces_cover_the_sheet_exactly() {
        let (design, pattern) = design(0.0, [8.4, 7.6], [4, 3]);
        let area = |polygon: &[Point3]| -> f64 {
            let n = polygon.len();
            (0..n).map(|i| 0.5 * polygon[i].xy().coords.perp(&polygon[(i + 1) % n].xy().coords)).sum()
        };
        let areas: Vec<f64> = design.pieces.iter().map(|piece| area(&piece.closed)).collect();
        assert!(areas.iter().all(|area| *area > 1.0));
        assert!((areas.iter().sum::<f64>() - 96.0 * 66.0).abs() < 1e-9);
        assert!(pattern.corners.iter().all(|p| p.z == 0.0));
        // Expanded: as large as Eq. (2) says.
        let far = design
            .pieces
            .iter()
            .flat_map(|piece| &piece.open)
            .fold([0.0, 0.0], |[x, y]: [f64; 2], p| [x.max(p.x), y.max(p.y)]);
        let sin = 18_f64.to_radians().sin();
        assert!((far[0] - 4.0 * (24.0 + 2.0 * 7.6 * sin)).abs() < 1e-9);
        assert!((far[1] - 3.0 * (22.0 + 2.0 * 8.4 * sin)).abs() < 1e-9);
    }
}
