//! The cut sheet: pieces over corners, of which each has one fan.

use std::collections::{BTreeMap, BTreeSet};

use crate::geometry::Point3;
use crate::geometry::topology;
use crate::geometry::union_find::UnionFind;
use crate::kirigami::piece_mesh::PieceMesh;

use super::faces::Tiling;
use super::{CutError, EdgeSet, PatternMeshError, sorted};

/// A tiling with its corners doubled along cuts.
pub(super) struct Sheet {
    /// The corners around each piece, counter-clockwise.
    pub pieces: Vec<Vec<usize>>,
    /// #corners: the source's vertex.
    pub source_vertex: Vec<usize>,
    /// Ends of slits of one edge; see [`PieceMesh::from_polygons`].
    pub apart: BTreeSet<[usize; 2]>,
    /// Edges and fans; the senses in it mean nothing yet.
    pub mesh: PieceMesh,
}

impl Sheet {
    /// Cuts a tiling along edges of the source.
    ///
    /// Corners are numbered by the source's vertices; copies of a vertex follow each other in the order of their
    /// first pieces.
    pub fn new(tiling: &Tiling, cut: &EdgeSet) -> Result<Self, PatternMeshError> {
        let slots: Vec<usize> = tiling.pieces.iter().flatten().copied().collect();
        let mut joined = UnionFind::new(slots.len());
        let mut parts = UnionFind::new(tiling.pieces.len());
        let sides = Sides::new(tiling);
        for ([a, b], one) in &sides.by_ends {
            let Some(other) = sides.by_ends.get(&[*b, *a]) else { continue };
            if !cut.contains(&sorted([*a, *b])) {
                joined.join(one.slots[0], other.slots[1]);
                joined.join(one.slots[1], other.slots[0]);
                parts.join(one.piece, other.piece);
            }
        }
        check_one_part(tiling.pieces.len(), &mut parts)?;
        let mut roots: Vec<(usize, usize)> = (0..slots.len())
            .filter(|&slot| joined.root(slot) == slot)
            .map(|slot| (slots[slot], slot))
            .collect();
        roots.sort_unstable();
        let number: BTreeMap<usize, usize> =
            roots.iter().enumerate().map(|(i, &(_, slot))| (slot, i)).collect();
        let mut slot = 0..slots.len();
        let pieces: Vec<Vec<usize>> = tiling
            .pieces
            .iter()
            .map(|piece| slot.by_ref().take(piece.len()).map(|slot| number[&joined.root(slot)]).collect())
            .collect();
        let source_vertex: Vec<usize> = roots.iter().map(|&(vertex, _)| vertex).collect();
        let apart = sides.apart(cut, |slot| number[&joined.root(slot)]);
        let senses = vec![true; pieces.len()];
        let mesh = PieceMesh::from_polygons(source_vertex.len(), pieces.clone(), senses, &apart);
        Ok(Self { pieces, source_vertex, apart, mesh })
    }
}

/// All sides of all pieces by their directed ends.
struct Sides {
    by_ends: BTreeMap<[usize; 2], Side>,
}

struct Side {
    piece: usize,
    /// The corners at its two ends, counted through all pieces.
    slots: [usize; 2],
}

impl Sides {
    fn new(tiling: &Tiling) -> Self {
        let mut by_ends = BTreeMap::new();
        let mut first = 0;
        for (piece, corners) in tiling.pieces.iter().enumerate() {
            let n = corners.len();
            for i in 0..n {
                let j = (i + 1) % n;
                by_ends.insert([corners[i], corners[j]], Side { piece, slots: [first + i, first + j] });
            }
            first += n;
        }
        Self { by_ends }
    }

    /// The cut edges whose two sides end at the same two corners, in the numbers that `corner` gives to slots.
    fn apart(&self, cut: &EdgeSet, mut corner: impl FnMut(usize) -> usize) -> BTreeSet<[usize; 2]> {
        let mut ends = |key: [usize; 2]| self.by_ends.get(&key).map(|side| side.slots.map(&mut corner));
        let mut found = BTreeSet::new();
        for &[a, b] in cut {
            if let (Some(one), Some([d, c])) = (ends([a, b]), ends([b, a]))
                && one == [c, d]
            {
                found.insert(sorted(one));
            }
        }
        found
    }
}

fn check_one_part(pieces: usize, parts: &mut UnionFind) -> Result<(), CutError> {
    let mut counts: BTreeMap<usize, usize> = BTreeMap::new();
    (0..pieces).for_each(|piece| *counts.entry(parts.root(piece)).or_default() += 1);
    if counts.len() < 2 {
        return Ok(());
    }
    let mut pieces: Vec<usize> = counts.into_values().collect();
    pieces.sort_unstable_by(|a, b| b.cmp(a));
    Err(CutError::InParts { pieces })
}

/// The border loops in corners, the sheet on the left: the longest first, the others by their least corner.
pub(super) fn border_loops(mesh: &PieceMesh, corners: &[Point3]) -> Vec<Vec<usize>> {
    let edges: Vec<topology::Edge> = mesh
        .edges
        .iter()
        .map(|edge| topology::Edge { vertices: edge.corners, left: edge.piece, right: edge.neighbour })
        .collect();
    let mut loops = topology::boundary_loops(&edges);
    let length = |cycle: &Vec<usize>| -> f64 {
        (0..cycle.len()).map(|i| (corners[cycle[(i + 1) % cycle.len()]] - corners[cycle[i]]).norm()).sum()
    };
    // Of equally long ones the first.
    let longest = (0..loops.len()).rev().max_by(|&i, &j| length(&loops[i]).total_cmp(&length(&loops[j])));
    if let Some(longest) = longest {
        loops[..=longest].rotate_right(1);
    }
    loops
}
