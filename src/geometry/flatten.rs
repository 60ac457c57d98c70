//! Flattening of a disk: a conformal map to predict the stretch, and the as-rigid-as-possible map of Stage 1.
//!
//! The conformal map keeps the lengths of the boundary, which makes the area distortion least (B. Springborn,
//! P. Schröder, U. Pinkall 2008; R. Sawhney, K. Crane, *Boundary First Flattening*, 2017). With the positive
//! semidefinite cotangent Laplacian `L` (see [`super::cotangent`]), angle defects `K` and logarithmic scale
//! `u`: `L u = -K` inside, `u = 0` on the boundary. The as-rigid-as-possible map alternates best rotations
//! per triangle with one linear solve (L. Liu et al., *A local/global approach to mesh parameterization*,
//! 2008).

use super::cotangent::{corner_angles, half_cotangents};
use super::mesh::TriMesh;
use super::{Point2, Vector2};
use crate::solver::cholesky::{CholeskyFactor, CholeskyPattern};
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
        let laplacian = Laplacian::new(mesh, &fixed)?;
        let defects: Vec<f64> = angle_sums.iter().map(|sum| sum - 2.0 * PI).collect();
        let log_scale = laplacian.solve(&defects, &vec![0.0; n]);
        let flux = laplacian.apply(&log_scale);
        let exterior_angles = cycle.iter().map(|&v| PI - angle_sums[v] + flux[v]).collect();
        if log_scale.iter().any(|u| !u.is_finite()) {
            return Err(FlattenError::Degenerate);
        }
        Ok(Self { log_scale, exterior_angles, cycle: cycle.to_vec() })
    }

    /// Largest divided by smallest scale: 1 for developable surfaces; the intrinsic measure of how hard the target is.
    pub fn ratio(&self) -> f64 {
        let (low, high) = self.log_scale.iter().fold((0.0_f64, 0.0_f64), |(l, h), &u| (l.min(u), h.max(u)));
        (high - low).exp()
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
fn conformal_points(mesh: &TriMesh, scale: &ConformalScale) -> Result<Vec<Point2>, FlattenError> {
    let n = mesh.vertices.len();
    let mut fixed = vec![false; n];
    let mut held = [vec![0.0; n], vec![0.0; n]];
    for (&v, p) in scale.cycle.iter().zip(scale.boundary_points(mesh)) {
        fixed[v] = true;
        held[0][v] = p.x;
        held[1][v] = p.y;
    }
    let laplacian = Laplacian::new(mesh, &fixed)?;
    let zero = vec![0.0; n];
    let (x, y) = (laplacian.solve(&zero, &held[0]), laplacian.solve(&zero, &held[1]));
    Ok(x.into_iter().zip(y).map(|(x, y)| Point2::new(x, y)).collect())
}

/// Flattens a disk as rigidly as possible, starting from the conformal flattening.
///
/// # Errors
/// [`FlattenError::Degenerate`] for triangles too thin, [`FlattenError::Folded`] where the result is not
/// injective around some triangle.
pub fn flatten(mesh: &TriMesh, scale: &ConformalScale) -> Result<Flattening, FlattenError> {
    let mut points = conformal_points(mesh, scale)?;
    let local: Vec<[Point2; 3]> = mesh.faces.iter().map(|face| lay_out(mesh, face)).collect();
    let weights = half_cotangents(mesh);
    let mut fixed = vec![false; mesh.vertices.len()];
    fixed[0] = true;
    let laplacian = Laplacian::new(mesh, &fixed)?;
    let mut energies: Vec<f64> = Vec::new();
    let mut settled = false;
    while !settled && energies.len() <= ROUNDS {
        let (rotations, energy) = best_rotations(mesh, &local, &weights, &points);
        settled = energies.last().is_some_and(|last| energy >= last * (1.0 - SETTLED));
        energies.push(energy);
        if !settled {
            points = global_step(mesh, &local, &weights, &rotations, &laplacian, &points[0]);
        }
    }
    let folded = mesh.faces.iter().position(|face| {
        let [a, b, c] = face.map(|v| points[v]);
        (b - a).perp(&(c - a)) <= 0.0
    });
    match folded {
        Some(triangle) => Err(FlattenError::Folded { triangle, ratio: scale.ratio() }),
        None => Ok(Flattening { points, energies, settled }),
    }
}

/// Most local/global rounds; meshes here settle within a few tens.
const ROUNDS: usize = 300;

/// The energy has settled when a round lowers it by less than this part.
const SETTLED: f64 = 1e-6;

/// A triangle of the mesh, laid out in a plane without distortion.
fn lay_out(mesh: &TriMesh, face: &[usize; 3]) -> [Point2; 3] {
    let [a, b, c] = face.map(|v| mesh.vertices[v]);
    let x = (b - a).normalize();
    let along = (c - a).dot(&x);
    let across = ((c - a) - x * along).norm();
    [Point2::origin(), Point2::new((b - a).norm(), 0.0), Point2::new(along, across)]
}

/// The rotation (cosine, sine) of each triangle nearest to its map, and the energy with these rotations.
fn best_rotations(
    mesh: &TriMesh,
    local: &[[Point2; 3]],
    weights: &[[f64; 3]],
    points: &[Point2],
) -> (Vec<Vector2>, f64) {
    let mut energy = 0.0;
    let rotations = (0..mesh.faces.len())
        .map(|f| {
            let face = &mesh.faces[f];
            let edges: [(Vector2, Vector2); 3] = std::array::from_fn(|i| {
                let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                (local[f][j] - local[f][k], points[face[j]] - points[face[k]])
            });
            let (mut cosine, mut sine) = (0.0, 0.0);
            for (i, (from, to)) in edges.iter().enumerate() {
                cosine += weights[f][i] * from.dot(to);
                sine += weights[f][i] * from.perp(to);
            }
            let rotation = Vector2::new(cosine, sine).try_normalize(0.0).unwrap_or(Vector2::x());
            for (i, (from, to)) in edges.iter().enumerate() {
                energy += weights[f][i] * (to - rotate(&rotation, from)).norm_squared();
            }
            rotation
        })
        .collect();
    (rotations, energy)
}

fn rotate(rotation: &Vector2, v: &Vector2) -> Vector2 {
    Vector2::new(rotation.x * v.x - rotation.y * v.y, rotation.y * v.x + rotation.x * v.y)
}

fn global_step(
    mesh: &TriMesh,
    local: &[[Point2; 3]],
    weights: &[[f64; 3]],
    rotations: &[Vector2],
    laplacian: &Laplacian,
    anchor: &Point2,
) -> Vec<Point2> {
    let n = mesh.vertices.len();
    let mut rhs = [vec![0.0; n], vec![0.0; n]];
    for (f, face) in mesh.faces.iter().enumerate() {
        for (i, weight) in weights[f].iter().enumerate() {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            let pull = rotate(&rotations[f], &(local[f][j] - local[f][k])) * *weight;
            for (axis, rhs) in rhs.iter_mut().enumerate() {
                rhs[face[j]] += pull[axis];
                rhs[face[k]] -= pull[axis];
            }
        }
    }
    let held = [anchor.x, anchor.y].map(|value| vec![value; n]);
    let (x, y) = (laplacian.solve(&rhs[0], &held[0]), laplacian.solve(&rhs[1], &held[1]));
    x.into_iter().zip(y).map(|(x, y)| Point2::new(x, y)).collect()
}

/// The cotangent Laplacian of a mesh, factorised over the vertices that are not fixed.
struct Laplacian {
    edges: Vec<(usize, usize, f64)>,
    /// Position of each free vertex among the unknowns; `None` for fixed ones.
    unknown: Vec<Option<usize>>,
    factor: CholeskyFactor,
    free: usize,
}

impl Laplacian {
    fn new(mesh: &TriMesh, fixed: &[bool]) -> Result<Self, FlattenError> {
        let mut edges = Vec::with_capacity(3 * mesh.faces.len());
        for (face, halves) in mesh.faces.iter().zip(half_cotangents(mesh)) {
            for i in 0..3 {
                edges.push((face[(i + 1) % 3], face[(i + 2) % 3], halves[i]));
            }
        }
        let mut free = 0;
        let unknown: Vec<Option<usize>> = fixed
            .iter()
            .map(|&held| {
                (!held).then(|| {
                    free += 1;
                    free - 1
                })
            })
            .collect();
        let inner = edges.iter().filter_map(|&(i, j, _)| Some((unknown[i]?, unknown[j]?)));
        let pattern = CholeskyPattern::new(free, inner.map(|(i, j)| (i.max(j), i.min(j))));
        let mut values = vec![0.0; pattern.entries()];
        for &(i, j, w) in &edges {
            for end in [unknown[i], unknown[j]].into_iter().flatten() {
                values[pattern.diagonal(end)] += w;
            }
            if let (Some(i), Some(j)) = (unknown[i], unknown[j]) {
                values[pattern.slot(i.max(j), i.min(j))] -= w;
            }
        }
        let factor = pattern.factor(&values).ok_or(FlattenError::Degenerate)?;
        Ok(Self { edges, unknown, factor, free })
    }

    /// `L u = rhs` at free vertices, `u = held` at fixed ones. All slices are #V.
    fn solve(&self, rhs: &[f64], held: &[f64]) -> Vec<f64> {
        let mut reduced = vec![0.0; self.free];
        for (value, unknown) in rhs.iter().zip(&self.unknown) {
            if let Some(i) = unknown {
                reduced[*i] = *value;
            }
        }
        for &(i, j, w) in &self.edges {
            match (self.unknown[i], self.unknown[j]) {
                (Some(free), None) => reduced[free] += w * held[j],
                (None, Some(free)) => reduced[free] += w * held[i],
                _ => (),
            }
        }
        self.factor.solve_in_place(&mut reduced);
        self.unknown.iter().zip(held).map(|(unknown, value)| unknown.map_or(*value, |i| reduced[i])).collect()
    }

    /// `L u` at all vertices.
    fn apply(&self, u: &[f64]) -> Vec<f64> {
        let mut result = vec![0.0; u.len()];
        for &(i, j, w) in &self.edges {
            result[i] += w * (u[i] - u[j]);
            result[j] += w * (u[j] - u[i]);
        }
        result
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point3;

    fn cycle(mesh: &TriMesh) -> Vec<usize> {
        crate::geometry::topology::disk(&mesh.faces).unwrap().boundary
    }

    /// A polar mesh of a surface of revolution given by (radius, height) over the arc length from the pole.
    fn cap(rings: usize, sectors: usize, profile: impl Fn(f64) -> (f64, f64)) -> TriMesh {
        let mut vertices = vec![Point3::new(0.0, 0.0, profile(0.0).1)];
        for ring in 1..=rings {
            let (r, z) = profile(ring as f64 / rings as f64);
            for s in 0..sectors {
                let phi = 2.0 * PI * (s as f64 + 0.5 * (ring % 2) as f64) / sectors as f64;
                vertices.push(Point3::new(r * phi.cos(), r * phi.sin(), z));
            }
        }
        let at = |ring: usize, s: usize| 1 + (ring - 1) * sectors + s % sectors;
        let mut faces: Vec<[usize; 3]> = (0..sectors).map(|s| [0, at(1, s), at(1, s + 1)]).collect();
        for ring in 1..rings {
            for s in 0..sectors {
                // Rings are turned by half a sector against each other, alternately.
                let shift = ring % 2;
                let (a, b) = (at(ring, s), at(ring, s + 1));
                let (c, d) = (at(ring + 1, s + shift), at(ring + 1, s + 1 + shift));
                faces.extend([[a, c, b], [b, c, d]]);
            }
        }
        TriMesh { vertices, faces }
    }

    #[test]
    fn stretch_ratio_of_spherical_caps_is_stereographic() {
        // The conformal flattening of a cap of opening angle alpha has scales 1 / (1 + cos theta).
        for alpha in [0.5, 1.0, PI / 2.0] {
            let mesh = cap(40, 96, |t| ((t * alpha).sin(), (t * alpha).cos()));
            let ratio = ConformalScale::solve(&mesh, &cycle(&mesh)).unwrap().ratio();
            let exact = 2.0 / (1.0 + alpha.cos());
            // Second order in the mesh size of 1/40.
            assert!((ratio / exact - 1.0).abs() < 2e-3, "{alpha}: {ratio} {exact}");
        }
    }

    #[test]
    fn a_cone_free_developable_surface_keeps_its_lengths() {
        // A cylinder patch is developable: the flattening is an isometry of every triangle.
        let n = 12;
        let vertices: Vec<Point3> = (0..n * n)
            .map(|i| ((i % n) as f64 * 0.1, (i / n) as f64 * 0.1))
            .map(|(s, y)| Point3::new(s.cos(), y, s.sin()))
            .collect();
        let mut faces = Vec::new();
        for j in 0..n - 1 {
            for i in 0..n - 1 {
                let a = j * n + i;
                faces.push([a, a + 1, a + n + 1]);
                faces.push([a, a + n + 1, a + n]);
            }
        }
        let mesh = TriMesh { vertices, faces };
        let scale = ConformalScale::solve(&mesh, &cycle(&mesh)).unwrap();
        assert!((scale.ratio() - 1.0).abs() < 1e-12);
        let flat = flatten(&mesh, &scale).unwrap();
        for face in &mesh.faces {
            for i in 0..3 {
                let (u, v) = (face[i], face[(i + 1) % 3]);
                let length = (mesh.vertices[u] - mesh.vertices[v]).norm();
                let laid = (flat.points[u] - flat.points[v]).norm();
                assert!((length - laid).abs() < 1e-9, "{length} {laid}");
            }
        }
    }

    #[test]
    fn a_dome_is_flattened_with_small_distortion_and_no_fold() {
        let mesh = cap(30, 64, |t| ((t * 0.8).sin(), (t * 0.8).cos()));
        let scale = ConformalScale::solve(&mesh, &cycle(&mesh)).unwrap();
        let flat = flatten(&mesh, &scale).unwrap();
        let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
        for face in &mesh.faces {
            for i in 0..3 {
                let (u, v) = (face[i], face[(i + 1) % 3]);
                let stretch =
                    (flat.points[u] - flat.points[v]).norm() / (mesh.vertices[u] - mesh.vertices[v]).norm();
                least = least.min(stretch);
                most = most.max(stretch);
            }
        }
        // Equal-boundary conformal scaling would spread over 2/(1+cos 0.8) = 1.18; rigidity halves the worst.
        assert!(least > 0.93 && most < 1.10, "{least} {most}");
    }
}
