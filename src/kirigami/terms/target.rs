//! The term that holds points to the target: to its surface, its boundary, or a place beside the boundary.

use super::PointAt;
use crate::geometry::{Point3, Vector3};
use crate::kirigami::control_mesh::Target;
use crate::solver::Term;
use rayon::prelude::*;

/// What a point of a state is held to. Within the plane that this gives it may glide.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Hold {
    /// The target's surface: c_prox, the distance to the tangent plane at the nearest point.
    Surface,
    /// The target's boundary, measured outwards along the surface.
    Boundary,
    /// A plane given by a point (millimetres) and a unit normal.
    Plane(Point3, Vector3),
    /// Such a plane as long as the point is not outside the target's boundary, and the boundary where it is.
    Inside(Point3, Vector3),
}

impl Hold {
    /// What pins a point to a place (millimetres): three planes at right angles, whose squared distances add up to the
    /// point's own.
    pub fn pins(place: Point3) -> [Self; 3] {
        [Vector3::x(), Vector3::y(), Vector3::z()].map(|normal| Self::Plane(place, normal))
    }
}

/// Keeps points in space near what they are held to. One residual per point.
pub struct Held<'a> {
    name: &'static str,
    points: Vec<(PointAt, Hold)>,
    unknowns: Vec<usize>,
    target: &'a Target,
    /// Millimetres per unit of length of the unknowns.
    scale: f64,
    feet: Vec<Foot>,
}

/// The plane that a point is held to at present.
#[derive(Clone, Copy)]
struct Foot {
    normal: Vector3,
    /// Distance of the plane from the origin along the normal.
    offset: f64,
    /// The triangle of the surface in which the nearest point lies, for the next search.
    triangle: usize,
}

impl<'a> Held<'a> {
    /// Points in space, each with what it is held to.
    pub fn new(
        name: &'static str,
        points: impl IntoIterator<Item = (PointAt, Hold)>,
        target: &'a Target,
        scale: f64,
    ) -> Self {
        let points: Vec<(PointAt, Hold)> = points.into_iter().collect();
        let unknowns = points.iter().flat_map(|(p, _)| p.indices()).collect();
        let feet = vec![Foot { normal: Vector3::zeros(), offset: 0.0, triangle: 0 }; points.len()];
        Self { name, points, unknowns, target, scale, feet }
    }
}

impl Term for Held<'_> {
    fn name(&self) -> &'static str {
        self.name
    }
    fn blocks(&self) -> usize {
        self.points.len()
    }
    fn rows(&self, _: usize) -> usize {
        1
    }
    fn unknowns(&self, b: usize) -> &[usize] {
        &self.unknowns[3 * b..3 * b + 3]
    }
    fn evaluate(&self, b: usize, x: &[f64], residuals: &mut [f64], jacobian: &mut [f64]) {
        let Foot { normal, offset, .. } = &self.feet[b];
        residuals[0] = self.points[b].0.read(x).dot(normal) - offset;
        jacobian.copy_from_slice(normal.as_slice());
    }
    fn refresh(&mut self, x: &[f64]) {
        let Self { points, feet, target, scale, .. } = self;
        points.par_iter().zip(feet.par_iter_mut()).with_min_len(256).for_each(|((point, hold), foot)| {
            let here = Point3::from(point.read(x) * *scale);
            let (at, normal) = plane(hold, target, &here, &mut foot.triangle);
            (foot.normal, foot.offset) = (normal, at.coords.dot(&normal) / *scale);
        });
    }
}

/// The plane that a point at `here` is held to: a point of it and its unit normal. `triangle` is where its nearest point on
/// the surface was last, and is.
fn plane(hold: &Hold, target: &Target, here: &Point3, triangle: &mut usize) -> (Point3, Vector3) {
    let boundary = || {
        let found = target.boundary.closest(here);
        (found.point, found.conormal)
    };
    match hold {
        Hold::Plane(at, normal) => (*at, *normal),
        Hold::Surface => {
            let found = target.surface.closest_from(here, *triangle);
            *triangle = found.triangle;
            (found.point, found.normal)
        }
        Hold::Boundary => boundary(),
        Hold::Inside(at, normal) => {
            let (foot, conormal) = boundary();
            if (here - foot).dot(&conormal) > 0.0 { (foot, conormal) } else { (*at, *normal) }
        }
    }
}
