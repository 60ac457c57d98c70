//! The poses on the way: minima between the two states, in the design's frames.

use super::gauge::Gauge;
use super::{STEPS, place};
use crate::fabrication::states::motions;
use crate::geometry::Point3;
use crate::geometry::plane::Plane;
use crate::geometry::rotation::RigidMotion;
use crate::kirigami::design::{Design, State};
use crate::snap::ligament::{Ligament, Spring};
use crate::snap::sheet::Sheet;

/// Heights below this part of a sheet's size are flat.
const FLAT: f64 = 1e-6;
/// Stiffness against pieces that tilt about the directions across a hinge's axis, by that against parting hinge points: the
/// square of this part of an edge. Softer axes leave several positions of nearly the same energy, between which the way jumps;
/// stiffer ones trade a tilt that nobody sees for points that part.
const LEVER: f64 = 0.15;

/// The way that was found.
pub struct Way {
    /// One list of poses per step, from the closed to the open state.
    pub poses: Vec<Vec<RigidMotion>>,
    /// See [`super::Morph::jump`].
    pub jump: f64,
}

/// The poses on the way from the closed to the open state.
///
/// They are sought from the open state on: a flat sheet that bulges leaves its closed state as a root does, upwards or
/// downwards, and arrives there on one way alone.
pub fn poses(design: &Design) -> Way {
    let closed = vertices(design, State::Closed);
    let open = vertices(design, State::Open);
    let edge = design.mean_edge();
    let sheet = Sheet::new(design, &vec![alike(edge); design.hinges.len()]);
    // Bulging begins with the root of the turn: so that heights grow evenly, the turn goes with the square of the way.
    let power = if is_flat(&closed) && !is_flat(&open) { 2 } else { 1 };
    let openings: Vec<f64> = (0..=STEPS).rev().map(|i| place(i).powi(power)).collect();
    let mut way = sheet.way(&openings);
    way.reverse();
    let gauge = Gauge::new(closed.clone(), &open);
    let to_closed = from_sheet(design);
    let moved = |poses: &[RigidMotion]| -> Vec<Point3> {
        let pieces = design.pieces.iter().zip(poses);
        pieces.flat_map(|(piece, pose)| piece.closed.iter().map(|p| pose.apply(p))).collect()
    };
    let mut jump = 0.0;
    let placed = |(i, mut poses): (usize, Vec<RigidMotion>)| {
        let points = moved(&poses);
        let whole = gauge.place(&points, place(i));
        if i == 0 {
            let ends = points.iter().zip(&closed);
            jump = ends.map(|(p, q)| (whole.apply(p) - q).norm() / edge).fold(0.0, f64::max);
        }
        poses.iter_mut().zip(&to_closed).for_each(|(pose, first)| *pose = whole.after(pose).after(first));
        poses
    };
    let mut poses: Vec<Vec<RigidMotion>> = way.into_iter().enumerate().map(placed).collect();
    let still = vec![RigidMotion::identity(); design.pieces.len()];
    [poses[0], poses[STEPS]] = match design.sheet_state {
        Some(State::Open) => [to_closed, still],
        _ => [still, motions(design)],
    };
    Way { poses, jump }
}

/// A ligament that is as stiff in all directions, and not at all about its axis.
fn alike(edge: f64) -> Ligament {
    let tilt = (LEVER * edge).powi(2);
    let spring = Spring { bending: 0.0, axial: 1.0, shear: 1.0, lift: 1.0, twist: tilt, tilt };
    Ligament {
        spring,
        effective_length: edge,
        reach: 0.0,
        unit_force: 1.0,
        unit_moment: 1.0,
        yield_strain: 1.0,
    }
}

fn is_flat(points: &[Point3]) -> bool {
    let plane = Plane::fit(points);
    let size = points.iter().map(|p| (p - plane.point).norm()).fold(0.0, f64::max);
    points.iter().all(|p| plane.distance(p).abs() < FLAT * size)
}

/// The motion of every piece from the sheet state to the closed one.
fn from_sheet(design: &Design) -> Vec<RigidMotion> {
    match design.sheet_state {
        Some(State::Open) => motions(design),
        _ => vec![RigidMotion::identity(); design.pieces.len()],
    }
}

fn vertices(design: &Design, state: State) -> Vec<Point3> {
    design.pieces.iter().flat_map(|piece| piece.vertices(state).iter().copied()).collect()
}
