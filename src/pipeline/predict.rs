//! What is to be expected of a job, before anything is optimised.

use super::clock::Clock;
use super::error::PipelineError;
use super::surfaces::{Targets, read_targets};
use crate::geometry::Point2;
use crate::geometry::flatten::{ConformalScale, FlattenError, conformal_points, flatten};
use crate::geometry::mesh::TriMesh;
use crate::geometry::stretch::{Stretch, stretches};
use crate::job::Job;
use crate::kirigami::feasibility::{EASY_RATIO, Feasibility, Verdict, feasibility};

/// What a target asks for, and what is needed to draw it.
pub struct Prediction {
    /// The numbers.
    pub feasibility: Feasibility,
    /// The target, millimetres.
    pub mesh: TriMesh,
    /// #V points of its flattening; the conformal one where the map of Stage 1 folds over.
    pub flat: Vec<Point2>,
    /// The face of the file, counted from 1, that the worst triangle is part of.
    pub worst_face: usize,
}

/// Reads the target, lays it flat as Stage 1 does and says what the pattern can do with it; nothing is optimised. Of two
/// targets it is the open one.
///
/// # Errors
/// A mesh that cannot be used.
pub fn predict(job: &Job, clock: &mut Clock) -> Result<Prediction, PipelineError> {
    let targets = clock.run("read", |_| read_targets(&job.target))?;
    let closing = targets.open.is_none();
    let Targets { open, closed, .. } = targets;
    let target = open.or(closed).expect("the job reader asks for a mesh");
    let mesh = &target.mesh;
    clock.run("feasibility", |_| {
        let scale =
            ConformalScale::solve(mesh, &target.cycle).map_err(|error| target.flatten_error(error))?;
        let (flat, stretched, folded) = match flatten(mesh, &scale, EASY_RATIO) {
            Ok(flat) => {
                let stretched = stretches(mesh, &flat.points);
                (flat.points, stretched, false)
            }
            Err(FlattenError::Folded { .. }) => (conformal_points(mesh, &scale), scale.stretches(mesh), true),
            Err(error) => return Err(target.flatten_error(error)),
        };
        let opening = if closing { stretched.iter().map(reversed).collect() } else { stretched };
        let mut feasibility = feasibility(mesh, &opening, scale.ratio());
        if folded {
            feasibility.verdict = Verdict::Beyond;
        }
        let worst_face = target.face_of[feasibility.worst.triangle] + 1;
        Ok(Prediction { feasibility, mesh: mesh.clone(), flat, worst_face })
    })
}

/// The stretch the other way: from the surface to the plane.
fn reversed(stretch: &Stretch) -> Stretch {
    let [most, least] = stretch.principal;
    let direction = nalgebra::Vector2::new(-stretch.direction.y, stretch.direction.x);
    Stretch { principal: [1.0 / least, 1.0 / most], direction, area: stretch.area }
}
