//! Surfaces as meshes: reading, checking, closest points, flattening. Knows meshes, not kirigami.

/// A point in space, millimetres.
pub type Point3 = nalgebra::Point3<f64>;
/// A vector in space, millimetres.
pub type Vector3 = nalgebra::Vector3<f64>;
/// A point in a plane.
pub type Point2 = nalgebra::Point2<f64>;
/// A vector in a plane.
pub type Vector2 = nalgebra::Vector2<f64>;

/// The mean of points.
pub fn centroid(points: &[Point3]) -> Point3 {
    Point3::from(points.iter().map(|p| p.coords).sum::<Vector3>() / points.len() as f64)
}

/// The least and the largest coordinates of points; empty where there are none.
pub fn bounds<'a>(points: impl IntoIterator<Item = &'a Point3>) -> (Vector3, Vector3) {
    let empty = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
    points.into_iter().fold(empty, |(low, high), p| (low.inf(&p.coords), high.sup(&p.coords)))
}

pub mod mesh;

pub mod read;

pub mod topology;

pub mod triangulate;

pub mod closest;

pub mod boundary;

pub mod cotangent;

mod laplacian;

pub mod stretch;

pub mod flatten;

pub mod rotation;

pub mod coincidence;

pub mod plane;

pub mod union_find;
