//! The paper's reading: a quad mesh whose vertices are, by turns, piece centres (black) and piece corners (white).
//!
//! A black vertex with faces all around is a piece with one corner for each. At the border a black vertex with k
//! faces has k + 1 white neighbours, and the piece is their polygon, closed by a straight side along the border: a
//! triangle where the border goes straight on (k = 2). The outline then runs through the white border vertices
//! alone. One with k = 1, at a corner of the mesh, is no piece: the sheet ends at the diagonal between its two
//! white neighbours, half a face short of the mesh. So end pieces with a single neighbour, which would hang on one
//! hinge: they are dropped until every piece has two.

use std::collections::{BTreeMap, BTreeSet};

use crate::geometry::mesh::PolyMesh;
use crate::geometry::topology::Defect;
use crate::geometry::topology::check_disk;
use crate::geometry::{Point3, centroid};

use super::alternation::odd_corners;
use super::faces::Tiling;
use super::{CutPath, PatternMeshError};

/// The pieces of a control mesh. Without `pieces_at` a cut tells which vertices are corners, if there is one.
pub(super) fn pieces(
    mesh: &PolyMesh,
    pieces_at: Option<usize>,
    cuts: &[CutPath],
) -> Result<Tiling, PatternMeshError> {
    if let Some((face, vertices)) = mesh.faces.iter().enumerate().find(|(_, face)| face.len() != 4) {
        let at = mesh.vertices[vertices[0]];
        return Err(PatternMeshError::NotAQuad { face, corners: vertices.len(), at });
    }
    let colours = two_colours(mesh)?;
    let colour_of = |vertex: usize| colours.get(vertex).copied().flatten();
    if let Some(vertex) = pieces_at {
        let black = colour_of(vertex).ok_or(PatternMeshError::NoSuchVertex { vertex })?;
        return tiling(mesh, &colours, black);
    }
    if let Some(white) = cuts.first().and_then(|cut| cut.vertices.first()).and_then(|&v| colour_of(v)) {
        return tiling(mesh, &colours, !white);
    }
    let merit = |tiling: &Tiling| (odd_corners(&tiling.pieces), usize::MAX - tiling.pieces.len());
    match (tiling(mesh, &colours, false), tiling(mesh, &colours, true)) {
        (Ok(first), Ok(second)) => Ok(if merit(&first) <= merit(&second) { first } else { second }),
        (Ok(only), Err(_)) | (Err(_), Ok(only)) => Ok(only),
        (Err(fault), Err(_)) => Err(fault),
    }
}

/// The colour of each vertex, that of the first used vertex being `false`; `None` where no face uses the vertex.
fn two_colours(mesh: &PolyMesh) -> Result<Vec<Option<bool>>, PatternMeshError> {
    let mut neighbours: Vec<Vec<(usize, usize)>> = vec![Vec::new(); mesh.vertices.len()];
    for (face, vertices) in mesh.faces.iter().enumerate() {
        for (i, &from) in vertices.iter().enumerate() {
            let to = vertices[(i + 1) % vertices.len()];
            neighbours[from].push((to, face));
            neighbours[to].push((from, face));
        }
    }
    let mut colours = vec![None; mesh.vertices.len()];
    let first = mesh.faces.iter().flatten().copied().min().into_iter();
    let mut open: Vec<(usize, bool)> = first.map(|vertex| (vertex, false)).collect();
    open.iter().for_each(|&(vertex, colour)| colours[vertex] = Some(colour));
    while let Some((vertex, colour)) = open.pop() {
        for &(neighbour, face) in &neighbours[vertex] {
            match colours[neighbour] {
                None => {
                    colours[neighbour] = Some(!colour);
                    open.push((neighbour, !colour));
                }
                Some(same) if same == colour => {
                    let at = mesh.vertices[vertex];
                    return Err(PatternMeshError::NoTwoColours { face, ends: [vertex, neighbour], at });
                }
                Some(_) => {}
            }
        }
    }
    Ok(colours)
}

/// The pieces around the vertices of one colour.
fn tiling(mesh: &PolyMesh, colours: &[Option<bool>], black: bool) -> Result<Tiling, PatternMeshError> {
    // Counter-clockwise around a vertex, each face leads from the vertex after it to the one before it.
    let mut around: BTreeMap<usize, BTreeMap<usize, usize>> = BTreeMap::new();
    for face in &mesh.faces {
        for i in (0..4).filter(|&i| colours[face[i]] == Some(black)) {
            around.entry(face[i]).or_default().insert(face[(i + 1) % 4], face[(i + 3) % 4]);
        }
    }
    let point = |v: &usize| mesh.vertices[*v];
    let mut pieces = Vec::new();
    for (&centre, next) in &around {
        let (corners, closed) = ring(next);
        if closed && corners.len() < 3 {
            let at = mesh.vertices[centre];
            return Err(PatternMeshError::Doublet { vertex: centre, at });
        }
        let mean = centroid(&corners.iter().map(point).collect::<Vec<_>>());
        pieces.push((centre, corners, if closed { mesh.vertices[centre] } else { mean }));
    }
    let dropped = drop_hanging(&mut pieces);
    let tiling = Tiling {
        source: pieces.iter().map(|(centre, ..)| *centre).collect(),
        what: "the piece at vertex",
        centres: pieces.iter().map(|(.., at)| *at).collect(),
        pieces: pieces.into_iter().map(|(_, corners, _)| corners).collect(),
        dropped,
    };
    let polygons = PolyMesh { vertices: mesh.vertices.clone(), faces: tiling.pieces.clone() };
    match check_disk(&polygons) {
        Err(fault) if matches!(fault.defect, Defect::NoFaces) => Err(PatternMeshError::TooFew { pieces: 0 }),
        Err(fault) if !matches!(fault.defect, Defect::Holes { .. }) => Err(PatternMeshError::Pieces(fault)),
        _ => Ok(tiling),
    }
}

/// The neighbours of a vertex in the counter-clockwise order in which `next` leads on, and whether they close up.
fn ring(next: &BTreeMap<usize, usize>) -> (Vec<usize>, bool) {
    let arrivals: BTreeSet<usize> = next.values().copied().collect();
    let border = next.keys().find(|vertex| !arrivals.contains(vertex));
    let start = border.or(next.keys().next());
    let mut ring: Vec<usize> = start.copied().into_iter().collect();
    while let Some(&after) = ring.last().and_then(|at| next.get(at)) {
        if Some(&after) == start {
            break;
        }
        ring.push(after);
    }
    (ring, border.is_none())
}

/// Drops polygons of fewer than three corners or two neighbours until there is none, and tells which vertices they
/// were at.
fn drop_hanging(pieces: &mut Vec<(usize, Vec<usize>, Point3)>) -> Vec<usize> {
    let mut dropped = Vec::new();
    loop {
        let sides = |corners: &[usize]| -> Vec<[usize; 2]> {
            (0..corners.len()).map(|i| [corners[i], corners[(i + 1) % corners.len()]]).collect()
        };
        let polygons = pieces.iter().filter(|(_, corners, _)| corners.len() > 2);
        let all: BTreeSet<[usize; 2]> = polygons.flat_map(|(_, corners, _)| sides(corners)).collect();
        let neighbours =
            |corners: &[usize]| sides(corners).iter().filter(|[a, b]| all.contains(&[*b, *a])).count();
        let before = pieces.len();
        pieces.retain(|(centre, corners, _)| {
            let stays = corners.len() > 2 && neighbours(corners) > 1;
            if !stays {
                dropped.push(*centre);
            }
            stays
        });
        if pieces.len() == before {
            dropped.sort_unstable();
            return dropped;
        }
    }
}
