//! `kirimorph check`: the worst hinges of a design.

use std::path::{Path, PathBuf};

use super::{Failure, print};
use crate::fabrication::fabricate::{fabricate, ligament_lengths};
use crate::fabrication::hinge_table::{HingeRow, Verdict};
use crate::output::{design_json, hinge_report};
use crate::profile;

/// Reads a design, lays it out for the profile, and prints its worst hinges.
pub fn run(design: &Path, profile: &str, worst: usize, allow_failing: bool) -> Result<(), Failure> {
    let file = design_file(design);
    let design = design_json::read(&file).map_err(Failure::bad_input)?;
    let profile = profile::load(profile, Path::new(".")).map_err(Failure::bad_input)?;
    let fabrication = ligament_lengths(&design, &profile)
        .and_then(|lengths| fabricate(&design, &profile, &lengths))
        .map_err(|error| Failure::NotMakeable(format!("{}: {error}", file.display())))?;
    print(&hinge_report::table(&fabrication.hinges, worst));
    refuse_failing(&fabrication.hinges, allow_failing)
}

/// The file of a design that may be named by its folder.
pub fn design_file(design: &Path) -> PathBuf {
    if design.is_dir() { design.join("design.json") } else { design.to_owned() }
}

/// An error where a hinge fails, unless that is allowed.
pub fn refuse_failing(hinges: &[HingeRow], allow: bool) -> Result<(), Failure> {
    let failing: Vec<&HingeRow> = hinges.iter().filter(|row| row.verdict == Verdict::Fail).collect();
    match failing.first() {
        Some(first) if !allow => Err(Failure::NotMakeable(format!(
            "{} of {} hinges fail; hinge {} at ({:.2}, {:.2}) mm: {}; use larger pieces or a target of less curvature, or \
             pass --allow-failing-hinges",
            failing.len(),
            hinges.len(),
            first.id,
            first.point.x,
            first.point.y,
            first.reason
        ))),
        _ => Ok(()),
    }
}
