//! The start of Stage 3: the model cell in every quad of the control meshes (section 3.4).
//!
//! One model does not fit quads that are stretched by different amounts. So every quad has its own, with the stretches that
//! the control meshes have there ([`BistableCell::restretched`]): they vary as smoothly as the meshes do. A quad takes the
//! points of its model by the bilinear map of the model's rectangle onto it. Slits of neighbours meet where their lines
//! cross.

use super::cell::BistableCell;
use super::mesh::{BistableMesh, Passing, Role};
use super::pattern::BistablePattern;
use super::reach::Asked;
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

/// The share of its cell's edge, counter-clockwise around the cell, at which the slit that passes a corner of a rectangle
/// meets that edge.
pub fn exit_share(models: &[BistableCell], grid: &PieceMesh, corner: usize) -> f64 {
    let (c, m) = (corner / 4, corner % 4);
    let (i, sign) = if grid.counter_clockwise[c] { (m, 1.0) } else { (MIRRORED[m], -1.0) };
    0.5 + sign * models[c].crossing(i) / models[c].cell[1 - i % 2]
}

/// The ends of the edge that a slit of a cell meets, counter-clockwise around that cell: corners of the grid.
pub fn edge_of_cell(grid: &PieceMesh, mesh: &BistableMesh, slit: &Passing, cell: usize) -> [usize; 2] {
    let edge = &grid.edges[slit.crossing - 4 * mesh.cells];
    if edge.piece == cell { edge.corners } else { [edge.corners[1], edge.corners[0]] }
}

/// What the quads of control meshes, corners of the grid in both states, ask of their cells.
pub fn asked(grid: &PieceMesh, closed: &[Point3], open: &[Point3]) -> Vec<Asked> {
    let local = |quad: &Vec<usize>| {
        // The mean length of two opposite sides.
        let mean = |corners: &[Point3], side: usize| {
            let length = |i: usize| (corners[quad[(i + 1) % 4]] - corners[quad[i]]).norm();
            0.5 * (length(side) + length(side + 2))
        };
        let cell = [0, 1].map(|side| mean(closed, side));
        let stretches = [0, 1].map(|side| mean(open, side) / cell[side]);
        let at = Point3::from(quad.iter().map(|&k| open[k].coords).sum::<Vector3>() / 4.0);
        Asked { cell, stretches, at }
    };
    grid.pieces.iter().map(local).collect()
}

/// The model cell of each quad of control meshes: `model` with the quad's own sides and stretches.
pub fn local_models(
    model: &BistableCell,
    grid: &PieceMesh,
    closed: &[Point3],
    open: &[Point3],
) -> Vec<BistableCell> {
    asked(grid, closed, open).iter().map(|asked| model.restretched(asked.cell, asked.stretches)).collect()
}

/// The pattern of these control meshes: corners of the grid in both states, and the model of each cell.
pub fn fitted(
    models: &[BistableCell],
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
        let (cell, turned) = (&models[c], grid.counter_clockwise[c]);
        let at = handed(turned, m, |i| cell.passing(i));
        let hinge = handed(turned, m, |i| cell.hinge(i, cell.phi));
        let snapped = handed(turned, m, |i| cell.hinge(i, -cell.phi));
        pattern.corners[corner] = map(closed, c, at, cell.cell);
        pattern.offsets[corner] = map(closed, c, hinge, cell.cell) - pattern.corners[corner];
        pattern.open[corner] = map(open, c, snapped, cell.expanded());
    }
    for (corner, slit) in mesh.passing.iter().enumerate() {
        let share = exit_share(models, grid, corner);
        let [p, q] = edge_of_cell(grid, mesh, slit, corner / 4);
        pattern.corners[slit.crossing] = closed[p] + (closed[q] - closed[p]) * share;
    }
    for (corner, own) in mesh.outline.iter().enumerate() {
        if let Some(own) = own {
            pattern.corners[*own] = closed[corner];
        }
    }
    place_free(grid, mesh, &mut pattern, [closed, open]);
    pattern
}

/// Open points of free vertices: each piece around a corner of the grid moves, as the model has it, without turning: its
/// crossings keep their distance from that corner.
fn place_free(
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
            let distance = (pattern.corners[vertex.corner] - closed[corner]).norm();
            let along = (open[far] - open[corner]).try_normalize(0.0).unwrap_or_default();
            pattern.open[at] = open[corner] + along * distance;
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
        settled.settle(&mesh, |_| 0.6);
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
