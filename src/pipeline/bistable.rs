//! What bistable cells are asked for beyond their reach is refused before it is optimised.

use super::LEAST_NECK_IN_GAPS;
use super::error::PipelineError;
use crate::job::Job;
use crate::kirigami::bistable::cell::BistableCell;
use crate::kirigami::bistable::fit::asked;
use crate::kirigami::bistable::grid::in_millimetres;
use crate::kirigami::bistable::reach::check;
use crate::kirigami::control_mesh::{Layouts, stage1};
use crate::kirigami::levels::Level;

/// Holds the stretches that the finest grid asks for against what a rectangle with necks can do.
///
/// # Errors
/// More than a few cells beyond.
pub(super) fn check_reach(
    job: &Job,
    proportions: &BistableCell,
    finest: &Level,
    layouts: &Layouts,
) -> Result<(), PipelineError> {
    let Level { cover, gap } = finest;
    let start = stage1(cover, layouts);
    // Pieces become narrower than the map asks: half as much again.
    let neck = 1.5 * LEAST_NECK_IN_GAPS * job.fabrication.profile.hinge_gap();
    let cell = in_millimetres(proportions, cover, *gap);
    Ok(check(&cell, &asked(&cover.mesh, &start.closed_corners, &start.open_corners), neck)?)
}
