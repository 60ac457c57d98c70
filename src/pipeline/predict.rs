//! What is to be expected of a job, before anything is optimised.

use super::clock::Clock;
use super::error::PipelineError;
use super::surfaces::{TargetMesh, Targets, read_targets};
use crate::geometry::Point2;
use crate::geometry::flatten::{ConformalScale, FlattenError, conformal_points, flatten};
use crate::geometry::mesh::TriMesh;
use crate::geometry::stretch::{Stretch, stretches, stretches_between};
use crate::job::{Job, Opening};
use crate::kirigami::feasibility::{EASY_RATIO, Feasibility, Verdict, feasibility, feasibility_of_map};

/// What a target asks for, and what is needed to draw it.
pub struct Prediction {
    /// The numbers.
    pub feasibility: Feasibility,
    /// The target, millimetres.
    pub mesh: TriMesh,
    /// #V points of its flattening; the conformal one where the map of Stage 1 folds over or the opening varies, that of
    /// the closed mesh where two meshes are a map.
    pub flat: Vec<Point2>,
    /// The face of the file, counted from 1, that the worst triangle is part of.
    pub worst_face: usize,
    /// Whether two meshes are a map, whose stretches and sizes are as they are.
    pub is_map: bool,
}

/// Reads the target, lays it flat as Stage 1 does and says what the pattern can do with it; nothing is optimised. Of two
/// targets it is the open one; two meshes with the same faces are a map, whose stretches are taken as they are.
///
/// # Errors
/// A mesh that cannot be used, a map that folds over.
pub fn predict(job: &Job, clock: &mut Clock) -> Result<Prediction, PipelineError> {
    let targets = clock.run("read", |_| read_targets(&job.target))?;
    clock.run("feasibility", |_| match targets {
        Targets { closed: Some(closed), open: Some(open), correspond: true } => of_map(&closed, open),
        Targets { closed, open: Some(open), .. } => {
            let variable = closed.is_none() && job.pattern.opening == Opening::Variable;
            of_target(open, false, variable)
        }
        Targets { closed, open: None, .. } => {
            of_target(closed.expect("the job reader asks for a mesh"), true, false)
        }
    })
}

/// Of one surface, closed or open; where the opening is `variable` it is laid flat conformally.
fn of_target(target: TargetMesh, closing: bool, variable: bool) -> Result<Prediction, PipelineError> {
    let mesh = &target.mesh;
    let scale = ConformalScale::solve(mesh, &target.cycle).map_err(|error| target.flatten_error(error))?;
    let conformal = || (conformal_points(mesh, &scale), scale.stretches(mesh));
    let mut folded = false;
    let (flat, stretched) = if variable {
        conformal()
    } else {
        match flatten(mesh, &scale, EASY_RATIO) {
            Ok(flat) => {
                let stretched = stretches(mesh, &flat.points);
                (flat.points, stretched)
            }
            Err(FlattenError::Folded { .. }) => {
                folded = true;
                conformal()
            }
            Err(error) => return Err(target.flatten_error(error)),
        }
    };
    let opening = if closing { stretched.iter().map(reversed).collect() } else { stretched };
    let mut feasibility = feasibility(mesh, &opening, scale.ratio());
    if folded {
        feasibility.verdict = Verdict::Beyond;
    }
    Ok(prediction(feasibility, target, flat, false))
}

/// Of a map from the closed to the open mesh.
fn of_map(closed: &TargetMesh, open: TargetMesh) -> Result<Prediction, PipelineError> {
    let scale = ConformalScale::solve(&open.mesh, &open.cycle).map_err(|error| open.flatten_error(error))?;
    let flat = closed.lay_flat()?.points;
    let stretched = stretches_between(&closed.mesh, &open.mesh);
    let feasibility = feasibility_of_map(&open.mesh, &stretched, scale.ratio());
    Ok(prediction(feasibility, open, flat, true))
}

fn prediction(feasibility: Feasibility, target: TargetMesh, flat: Vec<Point2>, is_map: bool) -> Prediction {
    let worst_face = target.face_of[feasibility.worst.triangle] + 1;
    Prediction { feasibility, mesh: target.mesh, flat, worst_face, is_map }
}

/// The stretch the other way: from the surface to the plane.
fn reversed(stretch: &Stretch) -> Stretch {
    let [most, least] = stretch.principal;
    let direction = nalgebra::Vector2::new(-stretch.direction.y, stretch.direction.x);
    Stretch { principal: [1.0 / least, 1.0 / most], direction, area: stretch.area }
}
