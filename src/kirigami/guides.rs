//! What guides a state that has no target (section 4.1 of the paper): places of the closed sheet that shall come near
//! points or curves in the open state.
//!
//! A place of the closed sheet is a point of a rigid piece. Its weights over three vertices of that piece are the same in
//! both states, so the open point is as linear in the unknowns as a hinge point is.

use super::design::{Design, State};
use super::filled::open_surface;
use super::pattern::{Pattern, Unknowns};
use super::piece_mesh::PieceMesh;
use super::terms::Guided;
use crate::geometry::closest::ClosestPoints;
use crate::geometry::mesh::TriMesh;
use crate::geometry::rotation::nearest_rotation;
use crate::geometry::{Point3, Vector3, bounds};
use nalgebra::Matrix3;

/// A guide, millimetres.
#[derive(Debug, Clone, PartialEq)]
pub struct Guide {
    /// Places of the closed sheet, in the frame of the closed state.
    pub places: Vec<Point3>,
    /// Where they shall be, in the frame of the open state.
    pub aim: GuideAim,
    /// Weight beside that of others.
    pub weight: f64,
}

/// Where guided places shall be.
#[derive(Debug, Clone, PartialEq)]
pub enum GuideAim {
    /// At this point.
    Point(Point3),
    /// Anywhere on these polylines, each of two points or more. Those with ends go on straight beyond them: how long
    /// the line of the sheet becomes is not the guide's to say.
    Curves(Vec<Vec<Point3>>),
}

/// The nearest point of an aim.
#[derive(Debug, Clone, Copy)]
pub struct Foot {
    /// It.
    pub point: Point3,
    /// The unit direction of the curve there.
    pub along: Option<Vector3>,
}

impl GuideAim {
    /// The nearest point.
    pub fn nearest(&self, p: &Point3) -> Foot {
        match self {
            Self::Point(point) => Foot { point: *point, along: None },
            Self::Curves(curves) => {
                let feet = curves.iter().flat_map(|curve| feet(curve, p));
                let distance = |foot: &Foot| (foot.point - p).norm_squared();
                feet.min_by(|a, b| distance(a).total_cmp(&distance(b))).expect("a curve has two points")
            }
        }
    }
}

/// The nearest points of the segments of a polyline.
fn feet<'a>(curve: &'a [Point3], p: &'a Point3) -> impl Iterator<Item = Foot> + 'a {
    let (last, ring) = (curve.len() - 2, curve[0] == curve[curve.len() - 1]);
    curve.windows(2).enumerate().filter_map(move |(i, ends)| {
        let side = ends[1] - ends[0];
        let along = side.try_normalize(0.0)?;
        let low = if i == 0 && !ring { f64::NEG_INFINITY } else { 0.0 };
        let high = if i == last && !ring { f64::INFINITY } else { side.norm() };
        let t = (p - ends[0]).dot(&along).clamp(low, high);
        Some(Foot { point: ends[0] + along * t, along: Some(along) })
    })
}

/// A point of a piece: three of its vertices by their numbers in the piece, with weights of sum 1.
struct Spot {
    piece: usize,
    vertices: [usize; 3],
    weights: [f64; 3],
}

impl Spot {
    /// Where it is, from the vertices of its piece.
    fn point(&self, vertex: impl Fn(usize) -> Point3) -> Point3 {
        let terms = self.vertices.iter().zip(self.weights).map(|(&v, weight)| vertex(v).coords * weight);
        Point3::from(terms.sum::<Vector3>())
    }
}

/// The closed pieces of a pattern.
fn closed_pieces(mesh: &PieceMesh, pattern: &Pattern) -> Vec<Vec<Point3>> {
    let closed = |owned: &Vec<usize>| owned.iter().map(|&e| pattern.closed_hinge(mesh, e)).collect();
    mesh.owned.iter().map(closed).collect()
}

/// The points of closed pieces nearest to places.
fn spots(pieces: &[Vec<Point3>], places: &[Point3]) -> Vec<Spot> {
    let mut mesh = TriMesh { vertices: Vec::new(), faces: Vec::new() };
    let mut owners = Vec::new();
    for (piece, vertices) in pieces.iter().enumerate() {
        let first = mesh.vertices.len();
        mesh.vertices.extend(vertices);
        for i in 1..vertices.len() - 1 {
            mesh.faces.push([first, first + i, first + i + 1]);
            owners.push((piece, [0, i, i + 1]));
        }
    }
    let nearest = ClosestPoints::new(mesh);
    let spot = |place: &Point3| {
        let found = nearest.closest(place);
        let (piece, vertices) = owners[found.triangle];
        Spot { piece, vertices, weights: found.barycentric }
    };
    places.iter().map(spot).collect()
}

/// Moves the open state rigidly to where it is nearest to its guides. Minimisation would bend pieces near the guides
/// before it moves the whole sheet.
pub fn settle(guides: &[Guide], mesh: &PieceMesh, pattern: &mut Pattern) {
    let closed = closed_pieces(mesh, pattern);
    let spots: Vec<(Spot, &Guide)> = guides
        .iter()
        .flat_map(|guide| spots(&closed, &guide.places).into_iter().map(move |spot| (spot, guide)))
        .collect();
    // The nearest points of curves change as the sheet moves.
    let rounds = if spots.is_empty() { 0 } else { SETTLING_ROUNDS };
    for _ in 0..rounds {
        let points = spots.iter().map(|(spot, guide)| {
            let open = |vertex: usize| pattern.open[mesh.owned[spot.piece][vertex]];
            let here = spot.point(open);
            (here, guide.aim.nearest(&here).point, guide.weight)
        });
        let (from, to, turn) = rigid_motion(&points.collect::<Vec<_>>());
        pattern.open.iter_mut().for_each(|p| *p = to + turn * (*p - from));
    }
}

/// Rounds of [`settle`]; each brings a sheet several times nearer.
const SETTLING_ROUNDS: usize = 10;

/// The rotation about the first point, and then the translation from the first point to the second, that take points to
/// others best; the third entries are weights. About axes that the points leave open there is no rotation.
fn rigid_motion(points: &[(Point3, Point3, f64)]) -> (Point3, Point3, Matrix3<f64>) {
    /// Rotations that lower the squared distances by less than this part of the points' spread are left out.
    const OPEN: f64 = 1e-6;
    let weight: f64 = points.iter().map(|(_, _, weight)| weight).sum();
    let mean = |of: fn(&(Point3, Point3, f64)) -> Point3| {
        Point3::from(points.iter().map(|p| of(p).coords * p.2).sum::<Vector3>() / weight)
    };
    let (from, to) = (mean(|p| p.0), mean(|p| p.1));
    let covariance: Matrix3<f64> =
        points.iter().map(|(p, q, w)| (q - to) * (p - from).transpose() * *w).sum();
    let spread: f64 = points.iter().map(|(p, _, w)| (p - from).norm_squared() * w).sum();
    (from, to, nearest_rotation(&(covariance + Matrix3::identity() * (OPEN * spread).max(f64::EPSILON))))
}

/// The terms that pull the open state to its guides, each with the guide's weight. The points of the pieces are those
/// nearest to the guided places now.
pub fn guide_terms<'a>(
    guides: &'a [Guide],
    mesh: &PieceMesh,
    at: &Unknowns,
    pattern: &Pattern,
    scale: f64,
) -> Vec<(Guided<'a>, f64)> {
    let pieces = closed_pieces(mesh, pattern);
    let term = |guide: &'a Guide| {
        let points = spots(&pieces, &guide.places).into_iter().map(|spot| {
            let edges = spot.vertices.map(|vertex| mesh.owned[spot.piece][vertex]);
            (edges.map(|edge| at.open(edge)), spot.weights)
        });
        (Guided::new(points, &guide.aim, scale), guide.weight)
    };
    guides.iter().map(term).collect()
}

/// How near a guide was reached, millimetres.
#[derive(Debug, Clone, PartialEq)]
pub struct Reach {
    /// Whether it is a curve's.
    pub curve: bool,
    /// How many places it guides.
    pub places: usize,
    /// Largest distance of a guided place from its aim.
    pub distance: f64,
    /// Mean distance.
    pub mean_distance: f64,
}

/// What an open state without a target covers, and how near its guides were reached; millimetres.
#[derive(Debug, Clone, PartialEq)]
pub struct OpenState {
    /// Area, holes filled.
    pub area: f64,
    /// The corners of its bounding box.
    pub bounds: [Point3; 2],
    /// In the guides' order.
    pub guides: Vec<Reach>,
}

/// Measures the open state of a design. Nothing here trusts the optimiser.
pub fn measure_open(design: &Design, guides: &[Guide]) -> OpenState {
    let surface = open_surface(design);
    let area = |face: &Vec<usize>| {
        let [origin, around @ ..] = &face[..] else { return 0.0 };
        let from = surface.vertices[*origin];
        let spoke = |v: usize| surface.vertices[v] - from;
        let sum: Vector3 = around.windows(2).map(|pair| spoke(pair[0]).cross(&spoke(pair[1]))).sum();
        0.5 * sum.norm()
    };
    let closed: Vec<Vec<Point3>> = design.pieces.iter().map(|piece| piece.closed.clone()).collect();
    let reach = |guide: &Guide| {
        let distance = |spot: Spot| {
            let open = design.pieces[spot.piece].vertices(State::Open);
            let here = spot.point(|vertex| open[vertex]);
            (guide.aim.nearest(&here).point - here).norm()
        };
        let distances: Vec<f64> = spots(&closed, &guide.places).into_iter().map(distance).collect();
        Reach {
            curve: matches!(guide.aim, GuideAim::Curves(_)),
            places: distances.len(),
            distance: distances.iter().copied().fold(0.0, f64::max),
            mean_distance: distances.iter().sum::<f64>() / distances.len() as f64,
        }
    };
    let (low, high) = bounds(&surface.vertices);
    OpenState {
        area: surface.faces.iter().map(area).sum(),
        bounds: [low, high].map(Point3::from),
        guides: guides.iter().map(reach).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_foot_on_a_curve_is_the_nearest_point_and_ends_go_on_straight() {
        let p = Point3::new;
        let bent = GuideAim::Curves(vec![vec![p(0.0, 0.0, 0.0), p(2.0, 0.0, 0.0), p(2.0, 2.0, 0.0)]]);
        let ring = GuideAim::Curves(vec![vec![
            p(0.0, 0.0, 0.0),
            p(2.0, 0.0, 0.0),
            p(2.0, 2.0, 0.0),
            p(0.0, 0.0, 0.0),
        ]]);
        for (aim, from, to) in [
            (&bent, p(1.0, 0.3, 1.0), p(1.0, 0.0, 0.0)),
            (&bent, p(-3.0, 0.3, 1.0), p(-3.0, 0.0, 0.0)),
            (&bent, p(2.5, 7.0, 0.0), p(2.0, 7.0, 0.0)),
            (&bent, p(2.5, -0.25, 0.0), p(2.0, 0.0, 0.0)),
            (&ring, p(-3.0, -0.3, 1.0), p(0.0, 0.0, 0.0)),
            (&GuideAim::Point(p(5.0, 6.0, 7.0)), p(1.0, 1.0, 1.0), p(5.0, 6.0, 7.0)),
        ] {
            assert!((aim.nearest(&from).point - to).norm() < 1e-12, "{from}");
        }
        assert_eq!(bent.nearest(&p(2.5, 1.0, 0.0)).along, Some(Vector3::y()));
    }

    #[test]
    fn a_spot_moves_with_its_piece() {
        let square = |x: f64| {
            [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[u, v]| Point3::new(x + u, v, 0.0)).to_vec()
        };
        let places = [Point3::new(1.7, 0.9, 0.2), Point3::new(0.25, 0.5, 0.0)];
        let found = spots(&[square(0.0), square(1.1)], &places);
        assert_eq!([found[0].piece, found[1].piece], [1, 0]);
        // Any rigid motion: here y becomes z.
        let moved = |p: &Point3| Point3::new(-p.x, p.z, p.y) + Vector3::new(3.0, 2.0, 1.0);
        let pieces = [square(0.0), square(1.1)];
        for (spot, place) in found.iter().zip(&places) {
            let piece = &pieces[spot.piece];
            let there = spot.point(|v| moved(&piece[v]));
            let flat = Point3::new(place.x, place.y, 0.0);
            assert!((there - moved(&flat)).norm() < 1e-12);
        }
    }
}
