//! Flattening of a disk: a conformal map to predict the stretch, and the as-rigid-as-possible map of Stage 1.
//!
//! The conformal map keeps the lengths of the boundary, which makes the area distortion least (B. Springborn,
//! P. Schröder, U. Pinkall 2008; R. Sawhney, K. Crane, *Boundary First Flattening*, 2017). With the positive
//! semidefinite cotangent Laplacian `L` (see [`super::cotangent`]), angle defects `K` and logarithmic scale
//! `u`: `L u = -K` inside, `u = 0` on the boundary. The as-rigid-as-possible map alternates best rotations
//! per triangle with one linear solve (L. Liu et al., *A local/global approach to mesh parameterization*,
//! 2008). Further rounds then lower the worst stretch: each pulls the maps of the triangles into a band of
//! singular values that is a little narrower than what the map before needed (bounded distortion, as in S.
//! Kovalsky et al., *Large-scale bounded distortion mappings*, 2015, by local and global steps).

use super::cotangent::corner_angles;
use super::laplacian::Laplacian;
use super::mesh::TriMesh;
use super::stretch::{Gradients, PlaneMap, Stretch};
use super::{Point2, Vector2};
use std::f64::consts::PI;

/// A disk laid out in the plane.
#[derive(Debug, Clone)]
pub struct Flattening {
    /// #V positions in the plane; triangles keep their orientation.
    pub points: Vec<Point2>,
    /// As-rigid-as-possible energy (square units of length) before the first round and after each.
    pub energies: Vec<f64>,
    /// Whether the energy had settled when the rounds ended.
    pub settled: bool,
    /// Largest over smallest stretch of the whole map, of the as-rigid-as-possible map first and then after
    /// each round that lowers it; infinite for maps that fold.
    pub ratios: Vec<f64>,
}

/// Why a disk has no usable flattening.
#[derive(Debug, Clone, thiserror::Error)]
pub enum FlattenError {
    /// The equations cannot be solved, because triangles are too thin.
    #[error("the mesh cannot be flattened: its triangles are too thin or too uneven; remesh it more evenly")]
    Degenerate,
    /// A triangle is turned over.
    #[error("the flattening folds over at triangle {triangle} (stretch ratio {ratio:.3})")]
    Folded {
        /// Which triangle.
        triangle: usize,
        /// Stretch ratio of the conformal flattening.
        ratio: f64,
    },
}

/// Logarithmic scale factors of the conformal flattening with boundary lengths kept.
pub struct ConformalScale {
    /// #V; 0 on the boundary.
    pub log_scale: Vec<f64>,
    /// Exterior angle of the flattened boundary at each vertex of the boundary loop.
    exterior_angles: Vec<f64>,
    cycle: Vec<usize>,
    /// With the boundary held.
    laplacian: Laplacian,
}

impl ConformalScale {
    /// Solves for the scale factors of a disk. `cycle` holds its boundary loop, the surface on the left (see
    /// [`super::topology::disk`]).
    ///
    /// # Errors
    /// [`FlattenError::Degenerate`] where the equations cannot be solved.
    pub fn solve(mesh: &TriMesh, cycle: &[usize]) -> Result<Self, FlattenError> {
        let n = mesh.vertices.len();
        let mut angle_sums = vec![0.0; n];
        for (face, angles) in mesh.faces.iter().zip(corner_angles(mesh)) {
            (0..3).for_each(|i| angle_sums[face[i]] += angles[i]);
        }
        let mut fixed = vec![false; n];
        cycle.iter().for_each(|&v| fixed[v] = true);
        let laplacian = Laplacian::new(mesh, &fixed).ok_or(FlattenError::Degenerate)?;
        let defects: Vec<f64> = angle_sums.iter().map(|sum| sum - 2.0 * PI).collect();
        let log_scale = laplacian.solve(&defects, &vec![0.0; n]);
        let flux = laplacian.apply(&log_scale);
        let exterior_angles = cycle.iter().map(|&v| PI - angle_sums[v] + flux[v]).collect();
        if log_scale.iter().any(|u| !u.is_finite()) {
            return Err(FlattenError::Degenerate);
        }
        Ok(Self { log_scale, exterior_angles, cycle: cycle.to_vec(), laplacian })
    }

    /// Largest divided by smallest scale: 1 for developable surfaces; the intrinsic measure of how hard the
    /// target is.
    pub fn ratio(&self) -> f64 {
        let (low, high) = self.log_scale.iter().fold((0.0_f64, 0.0_f64), |(l, h), &u| (l.min(u), h.max(u)));
        (high - low).exp()
    }

    /// The vertex whose scale differs most from those on the boundary.
    pub fn most_scaled(&self) -> usize {
        let scales = self.log_scale.iter().map(|u| u.abs()).enumerate();
        scales.fold((0, 0.0), |most, next| if next.1 > most.1 { next } else { most }).0
    }

    /// The stretches of the way back from this flattening, one per face: alike in all directions.
    pub fn stretches(&self, mesh: &TriMesh) -> Vec<Stretch> {
        let stretch = |face: &[usize; 3]| {
            let shrunk = (-face.iter().map(|&v| self.log_scale[v]).sum::<f64>() / 3.0).exp();
            let area = Gradients::new(mesh, face).area;
            Stretch { principal: [shrunk; 2], direction: Vector2::x(), area }
        };
        mesh.faces.iter().map(stretch).collect()
    }

    /// The flattened boundary: its points in the order of the loop.
    ///
    /// Edges keep their lengths but for the least change that closes the curve.
    fn boundary_points(&self, mesh: &TriMesh) -> Vec<Point2> {
        let count = self.cycle.len();
        let lengths: Vec<f64> = (0..count)
            .map(|i| (mesh.vertices[self.cycle[(i + 1) % count]] - mesh.vertices[self.cycle[i]]).norm())
            .collect();
        let mut heading = 0.0;
        let tangents: Vec<Vector2> = (0..count)
            .map(|i| {
                if i > 0 {
                    heading += self.exterior_angles[i];
                }
                Vector2::new(f64::cos(heading), f64::sin(heading))
            })
            .collect();
        let closure: Vector2 = tangents.iter().zip(&lengths).map(|(t, l)| t * *l).sum();
        let mut metric = nalgebra::Matrix2::zeros();
        tangents.iter().zip(&lengths).for_each(|(t, l)| metric += t * t.transpose() * *l);
        let multiplier = metric.try_inverse().map_or(Vector2::zeros(), |inverse| inverse * closure);
        let mut at = Point2::origin();
        (0..count)
            .map(|i| {
                let here = at;
                at += tangents[i] * (lengths[i] * (1.0 - tangents[i].dot(&multiplier)));
                here
            })
            .collect()
    }
}

/// The conformal flattening itself: the boundary curve of [`ConformalScale`], filled harmonically.
pub fn conformal_points(mesh: &TriMesh, scale: &ConformalScale) -> Vec<Point2> {
    let n = mesh.vertices.len();
    let mut held = [vec![0.0; n], vec![0.0; n]];
    for (&v, p) in scale.cycle.iter().zip(scale.boundary_points(mesh)) {
        held[0][v] = p.x;
        held[1][v] = p.y;
    }
    let zero = vec![0.0; n];
    let (x, y) = (scale.laplacian.solve(&zero, &held[0]), scale.laplacian.solve(&zero, &held[1]));
    x.into_iter().zip(y).map(|(x, y)| Point2::new(x, y)).collect()
}

/// Flattens a disk: as rigidly as possible, starting from the conformal flattening; where the largest stretch
/// of that map is more than `bound` times the smallest, with this ratio lowered, to the bound if that can be.
///
/// # Errors
/// [`FlattenError::Degenerate`] for triangles too thin, [`FlattenError::Folded`] where the result is not
/// injective around some triangle.
pub fn flatten(mesh: &TriMesh, scale: &ConformalScale, bound: f64) -> Result<Flattening, FlattenError> {
    let rounds = Rounds::new(mesh)?;
    let mut points = conformal_points(mesh, scale);
    let mut energies: Vec<f64> = Vec::new();
    let mut settled = false;
    while !settled && energies.len() <= ROUNDS {
        let maps = rounds.maps(&points);
        let energy = rounds.energy(&maps);
        settled = energies.last().is_some_and(|last| energy >= last * (1.0 - SETTLED));
        energies.push(energy);
        if !settled {
            points = rounds.global_step(maps.iter().map(|map| map.within(1.0, 1.0)), &points[0]);
        }
    }
    let (points, ratios) = rounds.bounded(points, bound);
    let folded = rounds.maps(&points).iter().position(|map| map.singular_values()[1] <= 0.0);
    match folded {
        Some(triangle) => Err(FlattenError::Folded { triangle, ratio: scale.ratio() }),
        None => Ok(Flattening { points, energies, settled, ratios }),
    }
}

/// Most local/global rounds; meshes here settle within a few tens.
const ROUNDS: usize = 300;

/// The energy has settled when a round lowers it by less than this part.
const SETTLED: f64 = 1e-4;

/// Most rounds that lower the worst stretch.
const BOUNDED_ROUNDS: usize = 60;

/// Each of these rounds asks for this part of the deviation from 1 that the map before had: a narrower band
/// moves more of the map, a wider one needs more rounds (0.97 needs three times as many).
const NARROWER: f64 = 0.9;

/// How far beyond the band a map outside is pushed, in parts of its distance from it: the global step
/// averages the wishes of neighbours, so that asking for just enough gives too little. Below 2, the limit of
/// stability.
const OVERSHOOT: f64 = 1.7;

/// The worst stretch has settled when this many rounds lower it by less than a part of `RATIO_SETTLED`.
const PATIENCE: usize = 5;

/// See [`PATIENCE`].
const RATIO_SETTLED: f64 = 1e-3;

/// What all local/global rounds share.
struct Rounds<'a> {
    mesh: &'a TriMesh,
    gradients: Vec<Gradients>,
    /// With the first vertex held.
    laplacian: Laplacian,
}

impl<'a> Rounds<'a> {
    fn new(mesh: &'a TriMesh) -> Result<Self, FlattenError> {
        let mut fixed = vec![false; mesh.vertices.len()];
        fixed[0] = true;
        Ok(Self {
            mesh,
            gradients: mesh.faces.iter().map(|face| Gradients::new(mesh, face)).collect(),
            laplacian: Laplacian::new(mesh, &fixed).ok_or(FlattenError::Degenerate)?,
        })
    }

    /// The maps of the triangles into the plane.
    fn maps(&self, points: &[Point2]) -> Vec<PlaneMap> {
        let faces = self.mesh.faces.iter().zip(&self.gradients);
        faces.map(|(face, gradients)| gradients.map_to(face.map(|v| points[v]))).collect()
    }

    /// The as-rigid-as-possible energy: squared distance of the maps from rotations, over the area.
    fn energy(&self, maps: &[PlaneMap]) -> f64 {
        let terms = maps.iter().zip(&self.gradients).map(|(map, gradients)| {
            let [first, second] = map.singular_values();
            gradients.area * ((first - 1.0).powi(2) + (second - 1.0).powi(2))
        });
        terms.sum()
    }

    /// The points whose maps come nearest to the wanted ones; the first stays at `anchor`.
    fn global_step(&self, wanted: impl Iterator<Item = PlaneMap>, anchor: &Point2) -> Vec<Point2> {
        let n = self.mesh.vertices.len();
        let mut rhs = [vec![0.0; n], vec![0.0; n]];
        for ((face, gradients), map) in self.mesh.faces.iter().zip(&self.gradients).zip(wanted) {
            for (&v, &gradient) in face.iter().zip(&gradients.of_corners) {
                let pull = map.apply(gradient) * gradients.area;
                rhs[0][v] += pull.re;
                rhs[1][v] += pull.im;
            }
        }
        let held = [anchor.x, anchor.y].map(|value| vec![value; n]);
        let (x, y) = (self.laplacian.solve(&rhs[0], &held[0]), self.laplacian.solve(&rhs[1], &held[1]));
        x.into_iter().zip(y).map(|(x, y)| Point2::new(x, y)).collect()
    }

    /// Lowers the largest over the smallest stretch while it exceeds `bound`; returns the best points found,
    /// and the ratios on the way.
    fn bounded(&self, points: Vec<Point2>, bound: f64) -> (Vec<Point2>, Vec<f64>) {
        let mut points = points;
        let mut ratios = Vec::new();
        let mut best = (f64::INFINITY, points.clone());
        while ratios.len() <= BOUNDED_ROUNDS {
            let maps = self.maps(&points);
            let [high, low] = extremes(&maps);
            let ratio = if low > 0.0 { high / low } else { f64::INFINITY };
            ratios.push(ratio);
            if ratio < best.0 {
                best = (ratio, points.clone());
            }
            let before = ratios.len().checked_sub(PATIENCE + 1).map(|i| ratios[i]);
            let settled = before.is_some_and(|before| ratio >= before * (1.0 - RATIO_SETTLED));
            if settled || ratio <= bound {
                break;
            }
            let high = 1.0 + NARROWER * (high - 1.0).max(0.0);
            let low = (1.0 - NARROWER * (1.0 - low).max(0.0)).max(LEAST_BOUND);
            let wanted = maps.iter().map(|map| {
                let inside = map.within(low, high);
                let past = |from, to| from + (to - from) * OVERSHOOT;
                PlaneMap {
                    turning: past(map.turning, inside.turning),
                    mirroring: past(map.mirroring, inside.mirroring),
                }
            });
            points = self.global_step(wanted, &points[0]);
        }
        (best.1, ratios)
    }
}

/// Smallest stretch that is asked for where triangles are nearly or fully turned over.
const LEAST_BOUND: f64 = 0.1;

/// Largest and smallest singular value of all maps.
fn extremes(maps: &[PlaneMap]) -> [f64; 2] {
    maps.iter().map(PlaneMap::singular_values).fold([0.0, f64::INFINITY], |[high, low], [first, second]| {
        [f64::max(high, first), f64::min(low, second)]
    })
}

#[cfg(test)]
mod tests;
