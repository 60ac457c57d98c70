//! Measures of a design: how rigid, how flat, how near to the target, how large.
//!
//! Nothing here trusts the optimiser: all figures come from the coordinates of the design.

use super::control_mesh::{Goal, Goals, Target};
use super::design::{Design, PatternKind, Piece, State};
use super::filled::{closed_surface, open_surface};
use super::guides::OpenState;
use crate::geometry::closest::ClosestPoints;
use crate::geometry::mesh::{PolyMesh, TriMesh};
use crate::geometry::plane::doubled_area;
use crate::geometry::topology::disk;
use crate::geometry::triangulate::triangulate;
use crate::geometry::{Vector3, bounds, centroid};

/// What was reached. Lengths in millimetres unless said otherwise.
#[derive(Debug, Clone, PartialEq)]
pub struct Quality {
    /// Eq. (7) over all vertex pairs of each piece, for a mean edge of 1.
    pub e_isom: f64,
    /// Largest relative difference between a distance in the two states.
    pub max_length_error: f64,
    /// Largest distance of a piece's vertex from the piece's plane in either state, in mean edges.
    pub planarity: f64,
    /// Largest distance of a hinge point or free vertex from the target.
    pub distance_max: f64,
    /// Largest distance of a piece's centre from the target: what flat pieces cost on a curved surface.
    pub sagitta_max: f64,
    /// Largest distance of a point of the target (vertices and face centres) from the pattern, holes filled; states that
    /// need not cover their target do not count.
    pub coverage_max: f64,
    /// Largest distance between the target's boundary and the pattern's, either way; states whose border is not held to
    /// the boundary do not count.
    pub boundary_max: f64,
    /// Diagonal of the target's bounding box.
    pub target_diagonal: f64,
    /// These figures state by state, for those that have a target; above stand the larger ones.
    pub fits: Vec<(State, Fit)>,
    /// Largest distance between two closed vertices at a corner along the sheet's normal.
    pub closed_step_max: f64,
    /// Mean distance between neighbouring corners of the closed sheet.
    pub mean_edge: f64,
    /// The mean edge that was asked for.
    pub asked_edge: f64,
    /// Area of the open pattern, holes filled, over the area of the closed sheet.
    pub area_expansion: f64,
    /// Largest over smallest stretch of the target's conformal flattening.
    pub stretch_ratio: f64,
    /// What the open state covers, where it has no target. The pipeline measures it: it knows the guides.
    pub open_state: Option<OpenState>,
}

/// How a state fits its target, millimetres; see [`Quality`].
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs)] // The names are those of Quality.
pub struct Fit {
    pub distance_max: f64,
    pub sagitta_max: f64,
    pub coverage_max: f64,
    pub boundary_max: f64,
    pub target_diagonal: f64,
    /// Whether the pattern's border is held to the target's boundary; else it may cover the target in part.
    pub held: bool,
    /// Area of the pattern, slits or holes filled, over the target's.
    pub covered: f64,
}

/// Limits that a design must keep to be made. Those in edges and cells scale with the pattern.
#[derive(Debug, Clone, PartialEq)]
pub struct Limits {
    /// For [`Quality::max_length_error`].
    pub length_error: f64,
    /// For [`Quality::planarity`], in edges.
    pub planarity: f64,
    /// For [`Quality::distance_max`], in mean edges.
    pub distance_edges: f64,
    /// For [`Quality::coverage_max`] and [`Quality::boundary_max`], in sides of an open cell (sqrt 2 edges).
    pub boundary_cells: f64,
    /// For the relative difference of mean and asked edge.
    pub edge_deviation: f64,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            length_error: 1e-8,
            planarity: 1e-4,
            distance_edges: 0.1,
            boundary_cells: 2.0,
            edge_deviation: 0.1,
        }
    }
}

/// A limit that a design breaks.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{what} is {}{unit}, more than the limit of {}{unit}: {remedy}", figure(*.value), figure(*.limit))]
pub struct Shortfall {
    /// Which figure.
    pub what: &'static str,
    /// What was reached.
    pub value: f64,
    /// What is allowed.
    pub limit: f64,
    /// Unit of both.
    pub unit: &'static str,
    /// What the user can do.
    pub remedy: &'static str,
}

/// A figure with three digits, as a person writes it.
fn figure(value: f64) -> String {
    if value.abs() >= 1e-3 { format!("{value:.3}") } else { format!("{value:.1e}") }
}

/// Measures a design against its goals.
pub fn measure(design: &Design, goals: &Goals, asked_edge: f64, stretch_ratio: f64) -> Quality {
    let mean_edge = design.mean_edge();
    let (e_isom, max_length_error) = length_errors(design, mean_edge);
    let surfaces = [closed_surface(design), open_surface(design)];
    let areas = surfaces.each_ref().map(|surface| triangles(surface).area());
    let states = [State::Closed, State::Open].into_iter().zip(&surfaces);
    let fits: Vec<(State, Fit)> = states
        .filter_map(|(state, surface)| Some((state, fit(design, state, surface, goals.of(state))?)))
        .collect();
    let largest = |figure: fn(&Fit) -> f64| fits.iter().map(|(_, fit)| figure(fit)).fold(0.0, worse);
    let held = |figure: fn(&Fit) -> f64| {
        fits.iter().filter(|(_, fit)| fit.held).map(|(_, fit)| figure(fit)).fold(0.0, worse)
    };
    Quality {
        e_isom,
        max_length_error,
        planarity: planarity(design) / mean_edge,
        distance_max: largest(|fit| fit.distance_max),
        sagitta_max: largest(|fit| fit.sagitta_max),
        coverage_max: held(|fit| fit.coverage_max),
        boundary_max: held(|fit| fit.boundary_max),
        target_diagonal: largest(|fit| fit.target_diagonal),
        fits,
        closed_step_max: closed_step(design),
        mean_edge,
        asked_edge,
        area_expansion: areas[1] / areas[0],
        stretch_ratio,
        open_state: None,
    }
}

/// The larger of two figures. Whatever is not a number must show.
fn worse(a: f64, b: f64) -> f64 {
    if b.is_nan() || b > a { b } else { a }
}

/// How a state, its slits or holes filled, fits its target. Nothing where it has none.
fn fit(design: &Design, state: State, surface: &PolyMesh, goal: Goal) -> Option<Fit> {
    let target = goal.target()?;
    let largest = |distances: &mut dyn Iterator<Item = f64>| distances.fold(0.0, f64::max);
    let vertices = design.pieces.iter().flat_map(|piece| piece.vertices(state));
    let centres = design.pieces.iter().map(|piece| centroid(piece.vertices(state)));
    let filled = triangles(surface);
    let (low, high) = bounds(&target.surface.mesh().vertices);
    Some(Fit {
        distance_max: largest(&mut vertices.map(|p| target.surface.distance(p))),
        sagitta_max: largest(&mut centres.map(|p| target.surface.distance(&p))),
        boundary_max: boundary_distance(surface, &filled, target),
        target_diagonal: (high - low).norm(),
        held: goal.outline().is_some(),
        covered: filled.area() / target.surface.mesh().area(),
        coverage_max: coverage(filled, target),
    })
}

/// Measures a design that has no target: all figures that would compare with one are NaN.
pub fn measure_alone(design: &Design) -> Quality {
    let mean_edge = design.mean_edge();
    let (e_isom, max_length_error) = length_errors(design, mean_edge);
    Quality {
        e_isom,
        max_length_error,
        planarity: planarity(design) / mean_edge,
        distance_max: f64::NAN,
        sagitta_max: f64::NAN,
        coverage_max: f64::NAN,
        boundary_max: f64::NAN,
        target_diagonal: f64::NAN,
        fits: Vec::new(),
        closed_step_max: closed_step(design),
        mean_edge,
        asked_edge: f64::NAN,
        area_expansion: f64::NAN,
        stretch_ratio: f64::NAN,
        open_state: None,
    }
}

impl Quality {
    /// The limits that are broken, in order of importance.
    pub fn shortfalls(&self, limits: &Limits) -> Vec<Shortfall> {
        const FIT: &str = "the target asks for more stretch than the pattern has; cut it into parts, or use smaller \
                           pieces";
        const COVER: &str = "the outline has tips or necks that whole pieces do not reach (three pieces wide at \
                             least); round or widen them, use smaller pieces, choose another [pattern] \
                             boundary, or cut the target into parts";
        const SIZE: &str = "pieces of this size do not fit the target; ask for smaller ones, or other counts";
        const RIGID: &str =
            "the pieces cannot be the same in both states; use smaller pieces or a less curved target";
        let cell = std::f64::consts::SQRT_2 * self.mean_edge;
        let rows = [
            ("the largest relative length error", self.max_length_error, limits.length_error, "", RIGID),
            ("the largest bending of a piece", self.planarity, limits.planarity, " edges", RIGID),
            (
                "the largest distance from the target",
                self.distance_max / self.mean_edge,
                limits.distance_edges,
                " edges",
                FIT,
            ),
            (
                "the largest gap between the pattern and the target's outline",
                worse(self.coverage_max, self.boundary_max) / cell,
                limits.boundary_cells,
                " pieces",
                COVER,
            ),
            (
                "the deviation of the mean edge from the asked one",
                (self.mean_edge / self.asked_edge - 1.0).abs(),
                limits.edge_deviation,
                "",
                SIZE,
            ),
        ];
        rows.into_iter()
            // A figure that is not a number is no success.
            .filter(|&(_, value, limit, ..)| value.is_nan() || value > limit)
            .map(|(what, value, limit, unit, remedy)| Shortfall { what, value, limit, unit, remedy })
            .collect()
    }
}

/// Largest distance of a point of the target (vertices and face centres) from a pattern, given as triangles.
pub fn coverage(pattern: TriMesh, target: &Target) -> f64 {
    let mesh = target.surface.mesh();
    let corners = mesh.vertices.iter().copied();
    let samples = corners.chain(mesh.faces.iter().map(|face| centroid(&face.map(|v| mesh.vertices[v]))));
    let pattern = ClosestPoints::new(pattern);
    samples.map(|p| pattern.distance(&p)).fold(0.0, f64::max)
}

/// Largest distance between two closed hinge points of a corner along the mean normal of the pieces around it; on a
/// bistable sheet between any two vertices there.
fn closed_step(design: &Design) -> f64 {
    let mut normals = vec![Vector3::zeros(); design.corners.len()];
    for piece in &design.pieces {
        piece.corners.iter().for_each(|&corner| normals[corner] += doubled_area(&piece.closed));
    }
    // Least and largest height at each corner.
    let mut heights = vec![(f64::INFINITY, f64::NEG_INFINITY); design.corners.len()];
    let mut add = |piece: &Piece, vertex: usize| {
        let corner = piece.corners[vertex];
        let normal = normals[corner].try_normalize(0.0).unwrap_or_default();
        let height = (piece.closed[vertex] - design.corners[corner]).dot(&normal);
        let (low, high) = heights[corner];
        heights[corner] = (low.min(height), high.max(height));
    };
    if design.pattern == PatternKind::Bistable {
        // Pieces that pass a T-junction or meet at a crossing lie in planes of their own.
        design.pieces.iter().for_each(|piece| (0..piece.corners.len()).for_each(|vertex| add(piece, vertex)));
    } else {
        design.hinges.iter().for_each(|hinge| add(&design.pieces[hinge.pieces[0]], hinge.vertices[0]));
    }
    heights.iter().map(|(low, high)| high - low).filter(|step| step.is_finite()).fold(0.0, f64::max)
}

/// E_isom at mean edge 1, and the largest relative length error.
fn length_errors(design: &Design, mean_edge: f64) -> (f64, f64) {
    let (mut energy, mut worst) = (0.0, 0.0_f64);
    for piece in &design.pieces {
        for i in 0..piece.closed.len() {
            for j in i + 1..piece.closed.len() {
                let closed = (piece.closed[i] - piece.closed[j]).norm();
                let open = (piece.open[i] - piece.open[j]).norm();
                energy += ((closed * closed - open * open) / mean_edge.powi(2)).powi(2);
                // Corners that coincide have no length to be relative to.
                let length = if closed > 0.0 { closed } else { mean_edge };
                worst = worst.max(((closed - open) / length).abs());
            }
        }
    }
    (energy, worst)
}

/// Largest distance of a vertex from the plane of its piece that fits best, in either state.
fn planarity(design: &Design) -> f64 {
    let mut worst = 0.0_f64;
    for piece in &design.pieces {
        for points in [&piece.closed, &piece.open] {
            let middle = centroid(points);
            let scatter: nalgebra::Matrix3<f64> =
                points.iter().map(|p| (p - middle) * (p - middle).transpose()).sum();
            let eigen = scatter.symmetric_eigen();
            let normal = eigen.eigenvectors.column(eigen.eigenvalues.imin()).into_owned();
            worst = points.iter().map(|p| (p - middle).dot(&normal).abs()).fold(worst, f64::max);
        }
    }
    worst
}

/// Faces as triangles: fans for quads, which are nearly flat and convex, else without overlap.
pub fn triangles(mesh: &PolyMesh) -> TriMesh {
    if mesh.faces.iter().any(|face| face.len() > 4)
        && let Ok(surface) = triangulate(mesh, 1.0)
    {
        // The triangles in the numbers of the polygons' vertices; the middles of warped faces come after them.
        let known = surface.vertex_of.len();
        let mut vertices = mesh.vertices.clone();
        let name = |v: usize| if v < known { surface.vertex_of[v] } else { mesh.vertices.len() + v - known };
        vertices.extend(surface.mesh.vertices.iter().skip(known));
        return TriMesh { vertices, faces: surface.mesh.faces.iter().map(|face| face.map(name)).collect() };
    }
    let fan = |face: &Vec<usize>| -> Vec<[usize; 3]> {
        (1..face.len() - 1).map(|i| [face[0], face[i], face[i + 1]]).collect()
    };
    TriMesh { vertices: mesh.vertices.clone(), faces: mesh.faces.iter().flat_map(fan).collect() }
}

/// Largest distance between the boundary of the filled pattern and the target's, measured from the vertices
/// of each to the other's curve.
fn boundary_distance(filled: &PolyMesh, triangles: &TriMesh, target: &Target) -> f64 {
    let Ok(border) = disk(&filled.faces) else { return f64::NAN };
    let curve = crate::geometry::boundary::BoundaryCurve::new(triangles, &border.boundary);
    let from_pattern = curve.points.iter().map(|p| (target.boundary.closest(p).point - p).norm());
    let to_pattern = target.boundary.points.iter().map(|p| (curve.closest(p).point - p).norm());
    from_pattern.chain(to_pattern).fold(0.0, f64::max)
}
