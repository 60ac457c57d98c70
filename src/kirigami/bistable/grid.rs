//! The grid of cells over a flattened target.

use super::cell::BistableCell;
use super::fit::fitted;
use super::mesh::BistableMesh;
use crate::geometry::{Point2, Point3, Vector2};
use crate::kirigami::cover::{Boundary, Cover, CoverError, PieceSize, cover, grid_axis, stretched};
use crate::kirigami::design::State;

/// Lays cells of these proportions over an outline, counter-clockwise; `first` is the direction that the grid's first axis
/// should come nearest to, and a size in millimetres is the mean of the cell's sides A and B. Cells in the given state
/// fill the outline.
///
/// # Errors
/// Those of [`cover()`]; slits that miss their edges because hinges need a `gap`.
pub fn cover_cells(
    outline: &[Point2],
    first: &Vector2,
    size: PieceSize,
    proportions: &BistableCell,
    gap: f64,
    boundary: Option<Boundary>,
    state: State,
) -> Result<Cover, CoverError> {
    let axis = grid_axis(outline, first);
    let (filling, stretches) = match state {
        State::Open => (proportions.expanded(), proportions.stretches()),
        State::Closed => (proportions.cell, [1.0; 2]),
    };
    // Seen through this factor across the axis, the cells are squares.
    let squeeze = filling[0] / filling[1];
    let squeezed: Vec<Point2> = outline.iter().map(|p| stretched(p, &axis, [1.0, squeeze])).collect();
    let size = match size {
        PieceSize::Edge(mean) => {
            let sides = |b: f64| 1.0 / stretches[0] + b / stretches[1];
            PieceSize::Edge(mean * sides(1.0) / sides(1.0 / squeeze))
        }
        counts => counts,
    };
    let mut cover = cover(&squeezed, &axis, size, stretches, 0.0, boundary)?;
    for point in cover.corners.iter_mut().chain(&mut cover.centres) {
        *point = stretched(point, &axis, [1.0, 1.0 / squeeze]);
    }
    cover.cell.open[1] /= squeeze;
    cover.cell.closed[1] /= squeeze;
    if state == State::Closed {
        let stretches = proportions.stretches();
        cover.cell.open = [0, 1].map(|i| cover.cell.closed[i] * stretches[i]);
    }
    let cell = in_millimetres(proportions, &cover, gap);
    let misses = cell.misses();
    if !misses.is_empty() || cell.rectangle.iter().any(|&side| side <= LEAST_RECTANGLE * gap) {
        return Err(CoverError::CellTooSmall {
            cell: cover.cell.closed,
            gap,
            least: least_size(proportions, gap),
        });
    }
    cover.asked_edge = asked_edge(&cell, &cover);
    Ok(cover)
}

/// Rectangles must be this many gaps wide: ligaments stand on all their corners.
const LEAST_RECTANGLE: f64 = 2.5;

/// The model cell of these proportions at the size of a cover's cells.
pub fn in_millimetres(proportions: &BistableCell, cover: &Cover, gap: f64) -> BistableCell {
    proportions.scaled(cover.cell.closed[0] / proportions.cell[0], gap)
}

/// The least sides A and B that leave room for hinges.
fn least_size(proportions: &BistableCell, gap: f64) -> [f64; 2] {
    let narrow = proportions.rectangle[0].min(proportions.rectangle[1]);
    let mut factor = LEAST_RECTANGLE * gap / narrow;
    // The gap's part of the cell shrinks as the cell grows, until inequalities (3) hold with it as they do without.
    while factor < 1e6 && !proportions.scaled(factor, gap).misses().is_empty() {
        factor *= 1.01;
    }
    proportions.cell.map(|side| side * factor)
}

/// The mean edge of the regular sheet with these cells.
fn asked_edge(cell: &BistableCell, cover: &Cover) -> f64 {
    let mesh = BistableMesh::new(&cover.mesh);
    let corner = |[i, j]: &[f64; 2]| Point3::new(i * cell.cell[0], j * cell.cell[1], 0.0);
    let corners: Vec<Point3> = cover.places.iter().map(corner).collect();
    // Only the unexpanded state counts.
    fitted(&vec![*cell; mesh.cells], &cover.mesh, &mesh, &corners, &corners)
        .design(&mesh, cell.gap, None)
        .mean_edge()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn expanded_cells_of_any_shape_fill_a_rectangle() {
        let cell = BistableCell { cell: [1.0, 0.8], rectangle: [0.4, 0.35], phi: 0.25, gap: 0.0 };
        let [a, b] = cell.expanded().map(|side| 25.0 * side);
        for turn in [0.0, 0.4] {
            let corners = [[0.0, 0.0], [6.0 * a, 0.0], [6.0 * a, 4.0 * b], [0.0, 4.0 * b]];
            let outline = corners.map(|[x, y]| nalgebra::Rotation2::new(turn) * Point2::new(x, y));
            let first = Vector2::new(f64::cos(turn), f64::sin(turn));
            for size in [PieceSize::Counts([6, 4]), PieceSize::Edge(25.0 * 0.9)] {
                let cover = cover_cells(&outline, &first, size, &cell, 0.5, None, State::Open).unwrap();
                assert_eq!(cover.mesh.pieces.len(), 24);
                for (found, expected) in cover.cell.open.into_iter().zip([a, b]) {
                    assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
                }
                assert!(
                    (cover.cell.closed[0] - 25.0).abs() < 1e-7 && (cover.cell.closed[1] - 20.0).abs() < 1e-7
                );
                let far = nalgebra::Rotation2::new(turn) * Point2::new(6.0 * a, 4.0 * b);
                assert!(cover.corners.iter().any(|p| (p - far).norm() < 1e-6));
            }
        }
    }

    #[test]
    fn cells_that_are_too_small_for_the_gap_are_refused_with_the_least_size() {
        let cell = BistableCell { cell: [1.0; 2], rectangle: [0.42; 2], phi: 18_f64.to_radians(), gap: 0.0 };
        let square =
            |side: f64| [[0.0, 0.0], [side, 0.0], [side, side], [0.0, side]].map(|[x, y]| Point2::new(x, y));
        let lay = |mean: f64| {
            let outline = square(6.0 * mean * cell.stretches()[0]);
            cover_cells(&outline, &Vector2::x(), PieceSize::Counts([6, 6]), &cell, 1.5, None, State::Open)
        };
        let Err(CoverError::CellTooSmall { least, .. }) = lay(8.0) else { panic!("8 mm are too small") };
        assert!(lay(0.99 * least[0]).is_err() && lay(1.01 * least[0]).is_ok());
    }
}
