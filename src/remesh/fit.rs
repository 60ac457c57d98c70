//! The quad parametrisation: coordinates whose unit grid follows a combed field.
//!
//! The gradients of the two coordinates are fitted to the two directions of the field over the cells' sides.
//! A gradient that points elsewhere costs more than one of another length (Bommes et al. 2009, section 5, the
//! anisotropic norm): few pairs of direction fields have lines at equal distances, so that the sizes give way.
//! Across cuts whole numbers and quarter turns keep the grid whole. Singular vertices lie in the centres of
//! cells, at halves, never at corners: around every inner corner four cells meet, and cells can alternate.

use super::comb::{Combed, turned};
use super::least_squares::{Row, System, Whole};
use super::links::Links;
use super::map::Principal;
use super::seams::{Corners, Sum, combine, corners, value};
use crate::geometry::Vector2;
use crate::geometry::mesh::TriMesh;
use crate::geometry::stretch::Gradients;
use nalgebra::Complex;

/// What the grid is to be like.
#[derive(Debug, Clone, Copy)]
pub struct Sizes {
    /// Sides of the open cell along the direction of the largest stretch and across it, millimetres.
    pub cell: [f64; 2],
    /// Weight of the sides' lengths against their directions, above 0; 1 weighs both alike.
    pub length_weight: f64,
    /// Whether grid lines lie on the boundary.
    pub boundary: bool,
}

/// Coordinates of all corners of all triangles.
pub struct Grid {
    /// #F by 3: in cells, in the chart of the triangle.
    pub uv: Vec<[Vector2; 3]>,
    /// #F by 3: quarter turns from the first chart of the corner's vertex to the triangle's.
    pub quarters: Vec<[u8; 3]>,
    /// Triangles that are turned over.
    pub folded: Vec<usize>,
}

/// Weight of a row that must hold, against triangles of mean weight 1.
const FIRM: f64 = 1e6;

/// Rounds that stiffen triangles that fold.
const STIFFENINGS: usize = 8;

/// Fits coordinates; `None` where the equations cannot be solved because triangles are too thin.
pub fn fit(
    mesh: &TriMesh,
    links: &Links,
    combed: &Combed,
    principal: &[Principal],
    sizes: Sizes,
) -> Option<Grid> {
    let Corners { sums, quarters } = corners(links, combed, &mesh.faces);
    let gradients: Vec<Gradients> = mesh.faces.iter().map(|face| Gradients::new(mesh, face)).collect();
    let mean_area = gradients.iter().map(|g| g.area).sum::<f64>() / gradients.len() as f64;
    let (firm, wholes) = conditions(mesh, links, combed, &sums, sizes.boundary);
    let mut weights: Vec<f64> = gradients.iter().map(|g| g.area / mean_area).collect();
    let mut best: Option<Grid> = None;
    for _ in 0..=STIFFENINGS {
        let mut rows = Vec::with_capacity(4 * weights.len() + firm.len());
        for (f, gradient) in gradients.iter().enumerate() {
            let cell = cell_sides(combed.directions[f], &principal[f], sizes.cell);
            add_rows(&mut rows, gradient, &sums[f], combed.directions[f], cell, sizes, weights[f]);
        }
        rows.extend(firm.iter().cloned());
        let x = System::new(2 * mesh.vertices.len(), &rows)?.solve(&wholes);
        let point = |[u, v]: &[Sum; 2]| Vector2::new(value(u, &x), value(v, &x));
        let uv: Vec<[Vector2; 3]> = sums.iter().map(|row| std::array::from_fn(|i| point(&row[i]))).collect();
        let folded: Vec<usize> = (0..uv.len()).filter(|&f| !upright(&uv[f])).collect();
        if best.as_ref().is_none_or(|best| folded.len() < best.folded.len()) {
            best = Some(Grid { uv, quarters: quarters.clone(), folded: folded.clone() });
        }
        if folded.is_empty() {
            break;
        }
        for &f in &folded {
            weights[f] *= 3.0;
            links.across[f].iter().flatten().for_each(|&(g, _)| weights[g] *= 2.0);
        }
    }
    best
}

/// Rows that must hold, and sums that must be whole: singular vertices in the middle of cells, the boundary on grid
/// lines if asked for, and one place held, since the whole grid may be shifted.
fn conditions(
    mesh: &TriMesh,
    links: &Links,
    combed: &Combed,
    sums: &[[[Sum; 2]; 3]],
    boundary: bool,
) -> (Vec<Row>, Vec<Whole>) {
    let runs = if boundary { boundary_runs(mesh, links, combed, sums) } else { vec![] };
    let mut wholes = vec![];
    for &(vertex, _) in &combed.singular {
        wholes.extend(own(vertex).map(|sum| Whole { sum, offset: 0.5 }));
    }
    let mut firm = match combed.singular.first() {
        Some(&(vertex, _)) => own(vertex).map(|sum| Row { sum, value: 0.5 }).to_vec(),
        None => anchors(&runs, mesh.faces[0][0]),
    };
    add_runs(&runs, &mut firm, &mut wholes);
    let root = FIRM.sqrt();
    for row in &mut firm {
        row.sum.iter_mut().for_each(|(_, factor)| *factor *= root);
        row.value *= root;
    }
    (firm, wholes)
}

/// Whether a triangle of the parameter plane keeps its orientation.
fn upright([a, b, c]: &[Vector2; 3]) -> bool {
    (b - a).perp(&(c - a)) > 0.0
}

/// Sides of the cell along `direction` and across it. Where the largest stretch is neither along nor across, or
/// means nothing, the sides are between both.
fn cell_sides(direction: Complex<f64>, principal: &Principal, [most, least]: [f64; 2]) -> [f64; 2] {
    let cosine = principal.weight * (principal.direction * direction.conj()).powu(2).re;
    let (sum, difference) = (0.5 * (most.ln() + least.ln()), 0.5 * cosine * (most.ln() - least.ln()));
    [(sum + difference).exp(), (sum - difference).exp()]
}

/// The four equations of one triangle: per coordinate the length of the gradient along its direction, which is one
/// over the cell's side, and its part across, which is zero; both times the cell's side.
fn add_rows(
    rows: &mut Vec<Row>,
    gradients: &Gradients,
    sums: &[[Sum; 2]; 3],
    direction: Complex<f64>,
    cell: [f64; 2],
    sizes: Sizes,
    weight: f64,
) {
    for k in 0..2 {
        for across in 0..2 {
            let along = turned(direction, (k + across) as u8);
            let strength = if across == 0 { sizes.length_weight } else { 1.0 };
            let factor = (weight * strength).sqrt();
            let sum = (0..3).fold(Sum::new(), |sum, i| {
                let slope = (gradients.of_corners[i] * along.conj()).re;
                combine(&sum, &sums[i][k], factor * cell[k] * slope)
            });
            rows.push(Row { sum, value: if across == 0 { factor } else { 0.0 } });
        }
    }
}

/// A run of boundary edges along one coordinate line.
struct Run {
    /// Which coordinate is constant.
    constant: usize,
    /// That coordinate, vertex after vertex.
    sums: Vec<Sum>,
}

/// The boundary cut into runs; each lies in one chart.
fn boundary_runs(mesh: &TriMesh, links: &Links, combed: &Combed, sums: &[[[Sum; 2]; 3]]) -> Vec<Run> {
    let edges = boundary_edges(mesh, links);
    let mut runs: Vec<Run> = Vec::new();
    let mut last: Option<[Sum; 2]> = None;
    for &(f, i) in &edges {
        let along = (links.edges[f][i] * combed.directions[f].conj()).powu(2).re > 0.0;
        let constant = usize::from(along);
        let [start, end] = [i, (i + 1) % 3].map(|k| &sums[f][k]);
        // A chart ends where the same vertex has other coordinates.
        let follows = last.as_ref() == Some(start) && runs.last().is_some_and(|run| run.constant == constant);
        if !follows {
            runs.push(Run { constant, sums: vec![start[constant].clone()] });
        }
        runs.last_mut().expect("begun").sums.push(end[constant].clone());
        last = Some(end.clone());
    }
    // The loop may begin in the middle of a run.
    let joined = runs.len() > 1
        && last.as_ref() == edges.first().map(|&(f, i)| &sums[f][i])
        && runs[0].constant == runs[runs.len() - 1].constant;
    if joined {
        let mut tail = runs.pop().expect("two or more");
        tail.sums.pop();
        tail.sums.append(&mut runs[0].sums);
        runs[0] = tail;
    }
    runs
}

/// The boundary's edges in order, as triangle and edge number.
fn boundary_edges(mesh: &TriMesh, links: &Links) -> Vec<(usize, usize)> {
    let first = (0..mesh.faces.len()).flat_map(|f| (0..3).map(move |i| (f, i)));
    let Some(first) = first.into_iter().find(|&(f, i)| links.across[f][i].is_none()) else { return vec![] };
    let after = |&(f, i): &(usize, usize)| {
        let end = mesh.faces[f][(i + 1) % 3];
        links.first[end].filter(|&next| next != first)
    };
    std::iter::successors(Some(first), after).collect()
}

fn add_runs(runs: &[Run], firm: &mut Vec<Row>, wholes: &mut Vec<Whole>) {
    for run in runs {
        for pair in run.sums.windows(2) {
            firm.push(Row { sum: combine(&pair[1], &pair[0], -1.0), value: 0.0 });
        }
        wholes.push(Whole { sum: run.sums[run.sums.len() / 2].clone(), offset: 0.0 });
    }
}

/// Holds the first line of each coordinate; where a coordinate has none, a vertex.
fn anchors(runs: &[Run], vertex: usize) -> Vec<Row> {
    let line = |k: usize| runs.iter().find(|run| run.constant == k).map(|run| run.sums[0].clone());
    (0..2).map(|k| Row { sum: line(k).unwrap_or_else(|| own(vertex)[k].clone()), value: 0.0 }).collect()
}

fn own(vertex: usize) -> [Sum; 2] {
    [vec![(2 * vertex, 1.0)], vec![(2 * vertex + 1, 1.0)]]
}
