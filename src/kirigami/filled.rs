//! The pattern as one surface in each state.
//!
//! Closed, the pieces' cells between the sheet's corners tile the sheet. Open, the vertices are the pieces', those that a
//! hinge joins being one; every piece is a face, and so is every hole: a loop of the pieces' sides that goes from piece to
//! piece through hinges and does not touch the sheet's border. Both are disks wherever the sheet is, and they are what "the
//! pattern covers the target" means: slits and holes count as covered.

use std::collections::BTreeSet;

use super::design::{Design, PatternKind};
use crate::geometry::mesh::PolyMesh;
use crate::geometry::union_find::UnionFind;

/// The closed sheet, slits filled: one face per piece. Faces are counter-clockwise seen from outside.
pub fn closed_surface(design: &Design) -> PolyMesh {
    let faces = design.pieces.iter().map(|piece| piece.corners.clone()).collect();
    PolyMesh { vertices: design.corners.clone(), faces }
}

/// The open sheet, holes filled: first one face per piece, then one per hole.
pub fn open_surface(design: &Design) -> PolyMesh {
    let starts: Vec<usize> = design
        .pieces
        .iter()
        .scan(0, |next, piece| {
            *next += piece.corners.len();
            Some(*next - piece.corners.len())
        })
        .collect();
    let sides = Sides::new(design, &starts);
    let mut joined = UnionFind::new(sides.previous.len());
    for (vertex, &partner) in sides.partner.iter().enumerate() {
        joined.join(vertex, partner);
    }
    // Names of the vertices that are left when hinges join them.
    let mut name = vec![usize::MAX; sides.previous.len()];
    let mut vertices = Vec::new();
    for (piece, &start) in design.pieces.iter().zip(&starts) {
        for (i, point) in piece.open.iter().enumerate() {
            let root = joined.root(start + i);
            if name[root] == usize::MAX {
                name[root] = vertices.len();
                vertices.push(*point);
            }
            name[start + i] = name[root];
        }
    }
    let pieces = design.pieces.iter().zip(&starts);
    let mut faces: Vec<Vec<usize>> = pieces
        .map(|(piece, &start)| (start..start + piece.corners.len()).map(|v| name[v]).collect())
        .collect();
    // The corners of a bistable sheet hang on one hinge each, between notches: only with these filled it is a disk.
    let notches = design.pattern == PatternKind::Bistable;
    faces.extend(sides.holes(notches).iter().map(|hole| hole.iter().map(|&v| name[v]).collect()));
    PolyMesh { vertices, faces }
}

/// The sides of all pieces, each named after the vertex at its end, counter-clockwise around its piece.
struct Sides {
    /// The vertex at a side's start.
    previous: Vec<usize>,
    /// The vertex that a hinge joins to a vertex; itself where there is none.
    partner: Vec<usize>,
    /// Whether a side is on the sheet's border: no other piece has it in the closed sheet.
    border: Vec<bool>,
}

impl Sides {
    fn new(design: &Design, starts: &[usize]) -> Self {
        let mut sides = Self { previous: Vec::new(), partner: Vec::new(), border: Vec::new() };
        let mut known = BTreeSet::new();
        let mut ends = Vec::new();
        for (piece, &start) in design.pieces.iter().zip(starts) {
            let n = piece.corners.len();
            for i in 0..n {
                let before = (i + n - 1) % n;
                sides.partner.push(start + i);
                sides.previous.push(start + before);
                known.insert([piece.corners[before], piece.corners[i]]);
                ends.push([piece.corners[before], piece.corners[i]]);
            }
        }
        for hinge in &design.hinges {
            let [v, w] = [0, 1].map(|k| starts[hinge.pieces[k]] + hinge.vertices[k]);
            (sides.partner[v], sides.partner[w]) = (w, v);
        }
        sides.border = ends.iter().map(|[p, q]| !known.contains(&[*q, *p])).collect();
        sides
    }

    /// The holes: loops of vertices, counter-clockwise, around each. With `notches` also those that slits open in the border,
    /// each from one of its ends to the other.
    fn holes(&self, notches: bool) -> Vec<Vec<usize>> {
        let mut seen = vec![false; self.previous.len()];
        let mut holes = Vec::new();
        for start in 0..seen.len() {
            let (mut side, mut inside, mut hole) = (start, true, Vec::new());
            while !seen[side] {
                seen[side] = true;
                hole.push(side);
                inside &= !self.border[side];
                // Back along the side, and through the hinge there.
                side = self.partner[self.previous[side]];
            }
            if inside && hole.len() > 2 {
                holes.push(hole);
            } else if notches && !inside {
                holes.extend(self.notches(&hole));
            }
        }
        holes
    }

    /// The runs of sides inside the sheet in a loop along its border.
    fn notches(&self, border: &[usize]) -> Vec<Vec<usize>> {
        let first = border.iter().position(|&side| self.border[side]).unwrap_or(0);
        let around = border[first..].iter().chain(&border[..first]);
        let (mut notches, mut run) = (Vec::new(), Vec::new());
        for &side in around.chain([&border[first]]) {
            if !self.border[side] {
                run.push(side);
            } else if let Some(&last) = run.last() {
                run.push(self.previous[last]);
                notches.push(std::mem::take(&mut run));
            }
        }
        notches
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::topology::disk;
    use crate::kirigami::bistable::cell::BistableCell;
    use crate::kirigami::bistable::pattern::regular;
    use crate::kirigami::design::State;
    use crate::kirigami::quality::triangles;

    #[test]
    fn both_states_of_a_bistable_sheet_are_rectangles_without_gaps() {
        let cell = BistableCell { cell: [10.0, 9.0], rectangle: [4.0, 3.6], phi: 0.3, gap: 0.0 };
        let (mesh, pattern) = regular(&cell, [4, 3]);
        let design = pattern.design(&mesh, 0.0, Some(State::Closed));
        for (surface, sides) in
            [(closed_surface(&design), cell.cell), (open_surface(&design), cell.expanded())]
        {
            assert!(disk(&surface.faces).is_ok());
            let area = triangles(&surface).area();
            assert!((area / (12.0 * sides[0] * sides[1]) - 1.0).abs() < 1e-12);
        }
        let holes = open_surface(&design).faces.len() - design.pieces.len();
        assert_eq!(holes, 4 * 4 + 5 * 3, "one per edge of the grid, those of the border notches");
    }
}
