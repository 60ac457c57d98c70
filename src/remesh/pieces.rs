//! The cells of a grid as pieces in both states, with what the map does to each and how well they are aligned.

use super::RemeshError;
use super::atlas::Atlas;
use super::extract::{Cells, SAMPLES, Sample, extract};
use super::map::{Principal, SurfaceMap};
use super::tidy::tidy;
use crate::geometry::Point3;
use crate::geometry::mesh::PolyMesh;
use crate::geometry::stretch::Gradients;
use crate::geometry::topology::disk;
use nalgebra::Complex;
use std::collections::BTreeMap;

/// A mesh of pieces on the open surface, and the same corners on the closed one.
#[derive(Debug, Clone)]
pub struct Aligned {
    /// Corners on the open surface; the faces are pieces, counter-clockwise. Corners of pieces that reach beyond the
    /// outline lie where the surface would go on.
    pub mesh: PolyMesh,
    /// The corners on the closed surface.
    pub closed: Vec<Point3>,
    /// One per face of the mesh.
    pub pieces: Vec<Piece>,
    /// How well the grid follows the directions.
    pub alignment: Alignment,
    /// The pieces that do not have four corners but 3, 5 or 6: where the directions turn around a place.
    pub singular: Vec<usize>,
    /// Part of the open surface that the pieces cover, 0 to 1.
    pub covered: f64,
    /// The smoothing that was needed, in mean cell sides; infinite where the directions were given up but for one turn
    /// of the whole.
    pub smoothing: f64,
}

/// What the map does to one piece.
#[derive(Debug, Clone, PartialEq)]
pub struct Piece {
    /// Mean stretch, open over closed, along its first side (that from its first corner) and along its second.
    pub stretches: [f64; 2],
    /// For each side whether it runs along the direction that is stretched more or less.
    pub sides: Vec<Side>,
}

/// A side of a piece.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Along the direction of the larger stretch.
    Most,
    /// Across it.
    Least,
}

/// How well grid lines follow the principal directions, radians, over the pieces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Alignment {
    /// Mean angle between the lines and the directions, each place weighted by how much its direction means.
    pub mean: f64,
    /// Largest angle where the direction means something (weight of a half or more); 0 where it does nowhere.
    pub largest: f64,
    /// Least and largest side of a cell that there is anywhere, millimetres.
    pub sizes: [f64; 2],
}

/// What all steps from cells to pieces share.
pub(super) struct Source<'a> {
    /// The map.
    pub map: &'a SurfaceMap,
    /// Its stretches.
    pub principal: &'a [Principal],
    /// Its grid.
    pub atlas: &'a Atlas,
}

/// Turns the cells of an atlas into pieces. `trimmed` leaves away loose cells at the outline.
pub(super) fn pieces(source: &Source, trimmed: bool) -> Result<Aligned, RemeshError> {
    let cells = extract(source.atlas);
    let corners: Vec<Vec<usize>> = cells.faces.iter().map(|f| f.iter().map(|&(n, _)| n).collect()).collect();
    // A quad has all its samples; a piece with n corners n quarters as many.
    let full = |f: usize| SAMPLES * SAMPLES * corners[f].len() / 4;
    let whole: Vec<bool> = (0..corners.len())
        .map(|f| corners[f].len() >= 3 && 6 * cells.samples[f].len() >= 5 * full(f))
        .collect();
    let kept = tidy(&corners, &whole, trimmed);
    if kept.len() < 4 {
        return Err(RemeshError::TooFew { pieces: kept.len() });
    }
    let faces: Vec<Vec<usize>> = kept.iter().map(|&f| corners[f].clone()).collect();
    disk(&faces).map_err(RemeshError::PiecesNotADisk)?;
    Ok(assemble(source, &cells, &kept, faces))
}

fn assemble(source: &Source, cells: &Cells, kept: &[usize], mut faces: Vec<Vec<usize>>) -> Aligned {
    let mut number: BTreeMap<usize, usize> = faces.iter().flatten().map(|&n| (n, 0)).collect();
    number.values_mut().enumerate().for_each(|(k, value)| *value = k);
    faces.iter_mut().flatten().for_each(|n| *n = number[n]);
    let node = |&n: &usize| source.atlas.position(cells.nodes[n].triangle, cells.nodes[n].at);
    let (closed, vertices) = number.keys().map(node).map(|[closed, open]| (closed, open)).unzip();
    let lines = grid_lines(source);
    let samples: Vec<&[Sample]> = kept.iter().map(|&f| cells.samples[f].as_slice()).collect();
    Aligned {
        pieces: pieces_of(source.principal, &lines, &samples, &faces),
        alignment: alignment(source.principal, &lines, &samples),
        singular: (0..faces.len()).filter(|&f| faces[f].len() != 4).collect(),
        covered: covered(source.map, &lines, &samples),
        mesh: PolyMesh { vertices, faces },
        closed,
        smoothing: 0.0,
    }
}

/// Per triangle how a point moves per unit of each coordinate, in the triangle's frame, millimetres.
fn grid_lines(source: &Source) -> Vec<[Complex<f64>; 2]> {
    let line = |(f, face): (usize, &[usize; 3])| {
        let gradients = Gradients::new(source.map.open(), face).of_corners;
        let slope =
            |k: usize| -> Complex<f64> { (0..3).map(|i| gradients[i] * source.atlas.uv[f][i][k]).sum() };
        let (u, v) = (slope(0), slope(1));
        let area = (u.conj() * v).im;
        let i = Complex::new(0.0, 1.0);
        [-i * v / area, i * u / area]
    };
    source.map.open().faces.iter().enumerate().map(line).collect()
}

fn pieces_of(
    principal: &[Principal],
    lines: &[[Complex<f64>; 2]],
    samples: &[&[Sample]],
    faces: &[Vec<usize>],
) -> Vec<Piece> {
    let edge = |face: &[usize], i: usize| {
        let (a, b) = (face[i], face[(i + 1) % face.len()]);
        (a.min(b), a.max(b))
    };
    // Both pieces of a side have a say, so that they agree; a singular piece has none, its sides do not alternate.
    let mut votes: BTreeMap<(usize, usize), f64> = BTreeMap::new();
    for (face, samples) in faces.iter().zip(samples) {
        let mut vote = 0.0;
        for sample in samples.iter().filter(|_| face.len() == 4) {
            let here = &principal[sample.triangle];
            let along = lines[sample.triangle][sample.axis];
            vote += here.weight * (along * here.direction.conj() / along.norm()).powu(2).re;
        }
        for i in 0..face.len() {
            *votes.entry(edge(face, i)).or_default() += if i % 2 == 0 { vote } else { -vote };
        }
    }
    let piece = |(face, samples): (&Vec<usize>, &&[Sample])| {
        let mean = |side: usize| {
            let stretch = |s: &Sample| principal[s.triangle].along(lines[s.triangle][(s.axis + side) % 2]);
            samples.iter().map(stretch).sum::<f64>() / samples.len() as f64
        };
        let side = |i: usize| if votes[&edge(face, i)] >= 0.0 { Side::Most } else { Side::Least };
        Piece { stretches: [mean(0), mean(1)], sides: (0..face.len()).map(side).collect() }
    };
    faces.iter().zip(samples).map(piece).collect()
}

fn alignment(principal: &[Principal], lines: &[[Complex<f64>; 2]], samples: &[&[Sample]]) -> Alignment {
    let (mut weights, mut sum, mut largest) = (0.0, 0.0, 0.0_f64);
    let mut sizes = [f64::INFINITY, 0.0_f64];
    for sample in samples.iter().flat_map(|samples| samples.iter()) {
        let here = &principal[sample.triangle];
        for along in lines[sample.triangle] {
            // To the nearer of the two directions.
            let angle = 0.25 * (along * here.direction.conj() / along.norm()).powu(4).arg().abs();
            weights += here.weight;
            sum += here.weight * angle;
            largest = if here.weight >= 0.5 { largest.max(angle) } else { largest };
            sizes = [sizes[0].min(along.norm()), sizes[1].max(along.norm())];
        }
    }
    Alignment { mean: if weights > 0.0 { sum / weights } else { 0.0 }, largest, sizes }
}

/// Part of the surface within the pieces, by samples: exact where the cells are alike.
fn covered(map: &SurfaceMap, lines: &[[Complex<f64>; 2]], samples: &[&[Sample]]) -> f64 {
    let cell = |s: &Sample| (lines[s.triangle][0].conj() * lines[s.triangle][1]).im;
    let area: f64 = samples.iter().flat_map(|samples| samples.iter()).map(cell).sum();
    (area / (SAMPLES * SAMPLES) as f64 / map.area()).min(1.0)
}
