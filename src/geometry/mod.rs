//! Surfaces as meshes: reading, checking, closest points, flattening. Knows meshes, not kirigami.

/// A point in space, millimetres.
pub type Point3 = nalgebra::Point3<f64>;
/// A vector in space, millimetres.
pub type Vector3 = nalgebra::Vector3<f64>;
/// A point in a plane.
pub type Point2 = nalgebra::Point2<f64>;
/// A vector in a plane.
pub type Vector2 = nalgebra::Vector2<f64>;

pub mod mesh;

pub mod read;

pub mod topology;

pub mod triangulate;

pub mod closest;

pub mod boundary;

pub mod cotangent;

pub mod flatten;

pub mod rotation;

mod union_find;
