//! The grid's corners, edges and cells on the surface.
//!
//! Every point with whole coordinates is a corner. From each, walks of length 1 lead to its up to four
//! neighbours, and cells are found by always turning left (H.-C. Ebke et al., *QEx*, 2013, for maps that do not
//! fold). Around a singular vertex three or five turns close a cell, without further ado.

use super::atlas::{Atlas, quarter_turns};
use crate::geometry::Vector2;
use std::collections::BTreeMap;

/// A corner of the grid.
#[derive(Debug, Clone, Copy)]
pub struct Node {
    /// Its triangle.
    pub triangle: usize,
    /// Its whole coordinates there.
    pub at: Vector2,
}

/// The cells of a grid.
pub struct Cells {
    /// Corners.
    pub nodes: Vec<Node>,
    /// Cells as corners and the ports (0 to 3: along u, v, -u, -v in the corner's chart) by which each side leaves,
    /// counter-clockwise.
    pub faces: Vec<Vec<(usize, u8)>>,
    /// Samples of each cell: a quad has 16, `SAMPLES` squared, where it lies on the surface as a whole.
    pub samples: Vec<Vec<Sample>>,
}

/// A place within a cell, on the surface.
#[derive(Debug, Clone, Copy)]
pub struct Sample {
    /// Its triangle.
    pub triangle: usize,
    /// The coordinate of that triangle's chart along which the cell's first side runs, 0 or 1.
    pub axis: usize,
}

/// Samples along a cell's side.
pub const SAMPLES: usize = 4;

/// Most corners of a cell.
const MOST_CORNERS: usize = 6;

/// Finds the cells of an atlas.
pub fn extract(atlas: &Atlas) -> Cells {
    let (nodes, at) = find_nodes(atlas);
    let links = find_links(atlas, &nodes, &at);
    let mut faces: Vec<Vec<(usize, u8)>> = Vec::new();
    let mut face_of: Vec<[Option<(usize, usize)>; 4]> = vec![[None; 4]; nodes.len()];
    for start in (0..nodes.len()).flat_map(|n| (0..4).map(move |d| (n, d))) {
        if face_of[start.0][usize::from(start.1)].is_some() {
            continue;
        }
        if let Some(face) = find_face(&links, start) {
            for (k, &(n, d)) in face.iter().enumerate() {
                face_of[n][usize::from(d)] = Some((faces.len(), k));
            }
            faces.push(face);
        }
    }
    let samples = find_samples(atlas, &at, &face_of, faces.len());
    Cells { nodes, faces, samples }
}

/// Points `(k + offset) / parts` for whole k within a triangle.
fn lattice(atlas: &Atlas, t: usize, parts: f64, offset: f64) -> Vec<Vector2> {
    let corners = &atlas.moved[t];
    let low = corners[0].inf(&corners[1]).inf(&corners[2]) * parts;
    let high = corners[0].sup(&corners[1]).sup(&corners[2]) * parts;
    let range = |low: f64, high: f64| (low - offset).ceil() as i64..=(high - offset).floor() as i64;
    let mut found = Vec::new();
    for j in range(low.y, high.y) {
        for i in range(low.x, high.x) {
            let p = Vector2::new(i as f64 + offset, j as f64 + offset) / parts;
            if atlas.holds(t, p) {
                found.push(p);
            }
        }
    }
    found
}

/// Corners by triangle and whole coordinates.
type Index = BTreeMap<(usize, i64, i64), usize>;

fn key(triangle: usize, at: Vector2) -> (usize, i64, i64) {
    (triangle, at.x.round() as i64, at.y.round() as i64)
}

fn find_nodes(atlas: &Atlas) -> (Vec<Node>, Index) {
    let mut nodes = Vec::new();
    let mut index = Index::new();
    for triangle in 0..atlas.uv.len() {
        for at in lattice(atlas, triangle, 1.0, 0.0) {
            index.insert(key(triangle, at), nodes.len());
            nodes.push(Node { triangle, at });
        }
    }
    (nodes, index)
}

/// The direction of a port.
fn port(d: u8) -> Vector2 {
    quarter_turns(Vector2::x(), d)
}

/// For each corner and port the neighbour and the port by which the way arrives there.
fn find_links(atlas: &Atlas, nodes: &[Node], index: &Index) -> Vec<[Option<(usize, u8)>; 4]> {
    let link = |node: &Node, d: u8| {
        let (triangle, quarters, at) = atlas.walk(node.triangle, node.at, node.at + port(d))?;
        let &there = index.get(&key(triangle, at))?;
        Some((there, (d + quarters + 2) % 4))
    };
    let one_way: Vec<[Option<(usize, u8)>; 4]> =
        nodes.iter().map(|node| std::array::from_fn(|d| link(node, d as u8))).collect();
    let mutual = |n: usize, d: usize| {
        one_way[n][d].filter(|&(m, back)| one_way[m][usize::from(back)] == Some((n, d as u8)))
    };
    (0..nodes.len()).map(|n| std::array::from_fn(|d| mutual(n, d))).collect()
}

/// The cell on the left of a side, if it closes.
fn find_face(links: &[[Option<(usize, u8)>; 4]], start: (usize, u8)) -> Option<Vec<(usize, u8)>> {
    let mut face = vec![start];
    let (mut n, mut d) = start;
    while face.len() <= MOST_CORNERS {
        let (next, back) = links[n][usize::from(d)]?;
        (n, d) = (next, (back + 3) % 4);
        if (n, d) == start {
            return Some(face);
        }
        face.push((n, d));
    }
    None
}

/// Puts samples of the surface into the cells that hold them.
fn find_samples(
    atlas: &Atlas,
    index: &Index,
    face_of: &[[Option<(usize, usize)>; 4]],
    count: usize,
) -> Vec<Vec<Sample>> {
    let mut samples = vec![Vec::new(); count];
    for triangle in 0..atlas.surface {
        for p in lattice(atlas, triangle, SAMPLES as f64, 0.5) {
            // The nearest corner first; near the boundary the way to it may leave the surface.
            let near = p.map(f64::round);
            let far = p.map(|x| if x.round() == x.floor() { x.ceil() } else { x.floor() });
            let corners = [near, Vector2::new(far.x, near.y), Vector2::new(near.x, far.y), far].into_iter();
            let found = corners.into_iter().find_map(|corner| {
                let (there, quarters, at) = atlas.walk(triangle, p, corner)?;
                let &node = index.get(&key(there, at))?;
                // The quadrant around the corner, as the port on its right.
                let quadrant = match (p.x > corner.x, p.y > corner.y) {
                    (true, true) => 0,
                    (false, true) => 1,
                    (false, false) => 2,
                    (true, false) => 3,
                };
                let port = (quadrant + quarters) % 4;
                let (face, side) = face_of[node][usize::from(port)]?;
                // That side leaves along this coordinate of the sample's chart; sides alternate.
                Some((face, (usize::from(quadrant) + side) % 2))
            });
            if let Some((face, axis)) = found {
                samples[face].push(Sample { triangle, axis });
            }
        }
    }
    samples
}
