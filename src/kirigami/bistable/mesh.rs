//! Combinatorics of a bistable sheet: rectangles, 8-gons and the points where their sides meet.
//!
//! The cells are those of a [`PieceMesh`]: quads around corners, neighbours of opposite handedness. Each cell holds one
//! rectangle; the corner regions of the cells around a corner of the grid form one piece, at an inner corner of four
//! cells a nonconvex 8-gon. At the border such pieces are partial: their outline runs along the cells' edges.
//!
//! Corners of the sheet, in this order: the four of each rectangle, one on each edge of the grid (where two slits meet, or
//! one leaves the sheet), and the border's corners of the grid. With a cell's corners and sides numbered 0 to 3,
//! counter-clockwise, and `+` for cells whose rectangle is turned by +phi:
//!
//! ```text
//!   slit            begins at           passes              ends on the edge
//!   +, at m         rectangle m + 1     rectangle m         m - 1
//!   -, at m         rectangle m - 1     rectangle m         m
//! ```
//!
//! The piece around the cell's corner m passes straight by rectangle corner m (a T-junction), and hangs on the rectangle
//! at the corner where that slit begins.

use crate::kirigami::hinges::Joint;
use crate::kirigami::piece_mesh::PieceMesh;

/// A vertex of a piece.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Vertex {
    /// The corner of the sheet.
    pub corner: usize,
    /// What stands there.
    pub role: Role,
}

/// What stands at a vertex.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// A hinge: the point of the open state is that of the corner's hinge.
    Hinge,
    /// A free vertex of the border: index of its point of the open state.
    Free(usize),
    /// A vertex that its piece carries along: where a side passes a T-junction, or a crossing inside the sheet.
    Carried,
}

/// The slit that passes a corner of a rectangle: corners of the sheet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Passing {
    /// The corner of the rectangle where it begins.
    pub origin: usize,
    /// The other corner of the rectangle next to this one: the hinge stands on its side of the slit.
    pub beside: usize,
    /// Where it meets the cell's edge.
    pub crossing: usize,
}

/// The combinatorics of a bistable sheet.
#[derive(Debug, Clone, PartialEq)]
pub struct BistableMesh {
    /// Number of cells, which is that of rectangles: piece i is the rectangle of cell i, its vertices are the corners
    /// 4 i to 4 i + 3.
    pub cells: usize,
    /// Corners of the sheet.
    pub corner_count: usize,
    /// Points of the open state: one per rectangle corner, with the same index, and one per free vertex.
    pub open_count: usize,
    /// The pieces' vertices, counter-clockwise: rectangles, then the pieces around the grid's corners in their order.
    pub pieces: Vec<Vec<Vertex>>,
    /// Hinge i stands at corner i; its pieces are the rectangle and the one that hangs on it.
    pub joints: Vec<Joint>,
    /// The slit that passes corner i of a rectangle.
    pub passing: Vec<Passing>,
    /// For each edge of the grid inside the sheet the corners of rectangles that the two slits pass which meet there.
    pub meetings: Vec<Option<[usize; 2]>>,
    /// For each corner of the grid that of the sheet, at the border.
    pub outline: Vec<Option<usize>>,
}

impl BistableMesh {
    /// Builds the combinatorics. All cells must be quads.
    pub fn new(grid: &PieceMesh) -> Self {
        let cells = grid.pieces.len();
        let crossing = |edge: usize| 4 * cells + edge;
        let mut corner_count = 4 * cells + grid.edges.len();
        let outline: Vec<Option<usize>> = grid
            .fans
            .iter()
            .map(|fan| {
                let border = !fan.closed && !fan.edges.is_empty();
                corner_count += usize::from(border);
                border.then(|| corner_count - 1)
            })
            .collect();
        let mut mesh = Self {
            cells,
            corner_count,
            open_count: 4 * cells,
            pieces: (0..cells)
                .map(|c| (0..4).map(|m| Vertex { corner: 4 * c + m, role: Role::Hinge }).collect())
                .collect(),
            joints: vec![Joint { pieces: [0; 2], vertices: [0; 2] }; 4 * cells],
            passing: Vec::with_capacity(4 * cells),
            meetings: vec![None; grid.edges.len()],
            outline,
        };
        for cell in 0..cells {
            mesh.add_passing(grid, cell);
        }
        mesh.meetings = meetings(grid, &mesh.passing);
        for corner in 0..grid.fans.len() {
            mesh.add_piece_around(grid, corner, crossing);
        }
        mesh
    }

    /// Whether a corner of the sheet is where two slits meet inside it.
    pub fn is_meeting(&self, corner: usize) -> bool {
        corner
            .checked_sub(4 * self.cells)
            .is_some_and(|edge| self.meetings.get(edge).is_some_and(Option::is_some))
    }

    fn add_passing(&mut self, grid: &PieceMesh, cell: usize) {
        for m in 0..4 {
            let (next, last) = ((m + 1) % 4, (m + 3) % 4);
            // Side m leads from corner m to the next one.
            let (origin, beside, side) =
                if grid.counter_clockwise[cell] { (next, last, last) } else { (last, next, m) };
            let ends = [side, (side + 1) % 4].map(|i| grid.pieces[cell][i]);
            let edge = grid.fans[ends[0]].edges.iter().copied().find(|&e| {
                let edge = &grid.edges[e];
                edge.corners.contains(&ends[1]) && (edge.piece == cell || edge.neighbour == Some(cell))
            });
            let crossing = 4 * self.cells + edge.expect("a cell's sides are edges of the grid");
            self.passing.push(Passing { origin: 4 * cell + origin, beside: 4 * cell + beside, crossing });
        }
    }

    /// Adds the piece around a corner of the grid: from the outline's corner, where there is one, counter-clockwise.
    fn add_piece_around(&mut self, grid: &PieceMesh, corner: usize, crossing: impl Fn(usize) -> usize) {
        let fan = &grid.fans[corner];
        if fan.edges.is_empty() {
            return;
        }
        let piece = self.pieces.len();
        let mut vertices = Vec::new();
        if let Some(own) = self.outline[corner] {
            let vertex = self.free(own);
            vertices.push(vertex);
        }
        let last = fan.edges.len() - usize::from(!fan.closed);
        for &e in &fan.edges[..last] {
            let edge = &grid.edges[e];
            // The cell that lies counter-clockwise after the edge, and which of its corners this is.
            let cell = if edge.corners[0] == corner { Some(edge.piece) } else { edge.neighbour };
            let cell = cell.expect("between the edges of a fan lie cells");
            let m = grid.pieces[cell].iter().position(|&c| c == corner).expect("a cell has its corners");
            let at_crossing = self.crossing_vertex(grid, crossing(e), e);
            vertices.push(at_crossing);
            let passed = Vertex { corner: 4 * cell + m, role: Role::Carried };
            let hinge = Vertex { corner: self.passing[4 * cell + m].origin, role: Role::Hinge };
            let first = vertices.len();
            let hinge_at = if grid.counter_clockwise[cell] {
                vertices.extend([hinge, passed]);
                first
            } else {
                vertices.extend([passed, hinge]);
                first + 1
            };
            self.joints[hinge.corner] =
                Joint { pieces: [cell, piece], vertices: [hinge.corner - 4 * cell, hinge_at] };
        }
        if !fan.closed {
            let e = fan.edges[last];
            let at_crossing = self.crossing_vertex(grid, crossing(e), e);
            vertices.push(at_crossing);
        }
        self.pieces.push(vertices);
    }

    fn crossing_vertex(&mut self, grid: &PieceMesh, corner: usize, edge: usize) -> Vertex {
        if grid.edges[edge].is_border() { self.free(corner) } else { Vertex { corner, role: Role::Carried } }
    }

    fn free(&mut self, corner: usize) -> Vertex {
        self.open_count += 1;
        Vertex { corner, role: Role::Free(self.open_count - 1) }
    }
}

/// For each inner edge the two corners whose slits meet there.
fn meetings(grid: &PieceMesh, passing: &[Passing]) -> Vec<Option<[usize; 2]>> {
    let first = 4 * grid.pieces.len();
    let mut ends: Vec<Vec<usize>> = vec![Vec::new(); grid.edges.len()];
    for (corner, slit) in passing.iter().enumerate() {
        ends[slit.crossing - first].push(corner);
    }
    ends.into_iter().map(|ends| <[usize; 2]>::try_from(ends).ok()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    fn block(columns: i32, rows: i32) -> (PieceMesh, BistableMesh) {
        let cells: Vec<[i32; 2]> = (0..rows).flat_map(|j| (0..columns).map(move |i| [i, j])).collect();
        let grid = PieceMesh::from_cells(&cells).0;
        let mesh = BistableMesh::new(&grid);
        (grid, mesh)
    }

    #[test]
    fn counts_of_a_block() {
        let (_, mesh) = block(4, 3);
        assert_eq!(mesh.pieces.len(), 12 + 5 * 4);
        assert_eq!(mesh.joints.len(), 48);
        // Around inner corners: four hinges, four T-junctions, four crossings.
        let inner = mesh.pieces[12..].iter().filter(|piece| piece.len() == 12).count();
        assert_eq!(inner, 3 * 2);
        // At the four corners of the sheet: its corner, two crossings, one hinge, one T-junction.
        assert_eq!(mesh.pieces.iter().filter(|piece| piece.len() == 5).count(), 4);
        assert_eq!(mesh.meetings.iter().flatten().count(), 3 * 3 + 4 * 2);
    }

    #[test]
    fn pieces_tile_the_sheet() {
        // Each directed side occurs once, and its reverse too, but for the border.
        let (_, mesh) = block(3, 4);
        let mut sides: BTreeMap<[usize; 2], usize> = BTreeMap::new();
        for piece in &mesh.pieces {
            for (i, vertex) in piece.iter().enumerate() {
                let next = piece[(i + 1) % piece.len()];
                *sides.entry([vertex.corner, next.corner]).or_default() += 1;
            }
        }
        assert!(sides.values().all(|&count| count == 1));
        let border = sides.keys().filter(|[p, q]| !sides.contains_key(&[*q, *p])).count();
        assert_eq!(border, 2 * 2 * (3 + 4));
        let euler = mesh.corner_count as i64 - (sides.len() + border) as i64 / 2 + mesh.pieces.len() as i64;
        assert_eq!(euler, 1);
    }

    #[test]
    fn hinges_join_a_rectangle_and_a_piece_that_shares_a_side_there() {
        let (_, mesh) = block(3, 3);
        for (corner, joint) in mesh.joints.iter().enumerate() {
            let [rectangle, other] = joint.pieces;
            assert!(rectangle < mesh.cells && other >= mesh.cells);
            let at = |k: usize| mesh.pieces[joint.pieces[k]][joint.vertices[k]];
            assert!(at(0).corner == corner && at(1).corner == corner && at(1).role == Role::Hinge);
            // The side between the hinge and the T-junction belongs to both.
            let slit = mesh.passing.iter().position(|slit| slit.origin == corner).unwrap();
            for piece in joint.pieces {
                let corners: Vec<usize> = mesh.pieces[piece].iter().map(|v| v.corner).collect();
                let n = corners.len();
                let i = corners.iter().position(|&c| c == corner).unwrap();
                assert!([corners[(i + 1) % n], corners[(i + n - 1) % n]].contains(&slit));
            }
        }
    }

    #[test]
    fn slits_that_meet_come_from_both_sides_of_an_edge() {
        let (grid, mesh) = block(3, 2);
        for (edge, meeting) in mesh.meetings.iter().enumerate() {
            let Some(ends) = meeting else {
                assert!(grid.edges[edge].is_border());
                continue;
            };
            let mut cells = ends.map(|corner| corner / 4);
            cells.sort_unstable();
            let mut both = [grid.edges[edge].piece, grid.edges[edge].neighbour.unwrap()];
            both.sort_unstable();
            assert_eq!(cells, both);
            assert!(mesh.is_meeting(4 * mesh.cells + edge));
        }
    }
}
