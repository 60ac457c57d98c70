//! `kirimorph check`: the worst hinges of a design.

use std::path::{Path, PathBuf};

use super::progress::{Reporter, Reporting};
use super::{Failure, paint, print};
use crate::fabrication::fabricate::{Fabrication, fabricate, ligament_lengths};
use crate::fabrication::hinge_table::{HingeRow, Verdict, planned_rows};
use crate::kirigami::design::{Design, PatternKind, State};
use crate::kirigami::improve::Slits;
use crate::kirigami::repeated::without_repeated_corners;
use crate::output::{design_json, hinge_report};
use crate::profile::{self, Profile};

/// The flags.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// A design.json, or a folder that holds one.
    design: PathBuf,
    /// A profile's name or file.
    #[arg(short, long)]
    profile: String,
    /// How many hinges to print.
    #[arg(short, long, default_value_t = 10)]
    worst: usize,
    /// Succeed even where a hinge fails.
    #[arg(long)]
    allow_failing_hinges: bool,
}

/// Reads a design, lays it out for the profile, and prints its worst hinges.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments { design, profile, worst, allow_failing_hinges } = arguments;
    let file = design_file(design);
    let design = without_repeated(design_json::read(&file).map_err(Failure::bad_input)?);
    let profile = profile::load(profile, Path::new(".")).map_err(Failure::bad_input)?;
    let mut reporter = Reporter::new(&Reporting::default());
    reporter.say("check: laying the sheet out");
    let laid_out = lay_out(&design, &profile);
    drop(reporter);
    let fabrication = laid_out.map_err(|reason| {
        print("Cannot be laid out; the hinges as they would have to be:\n");
        print(&paint::hinges(&hinge_report::table(&planned_rows(&design, &profile), *worst)));
        Failure::NotMakeable(format!("{}: {reason}", file.display()))
    })?;
    print(&paint::hinges(&hinge_report::table(&fabrication.hinges, *worst)));
    refuse_failing(&fabrication.hinges, *allow_failing_hinges)
}

/// Lays a design out; the error says why it cannot be cut from a flat sheet.
pub fn lay_out(design: &Design, profile: &Profile) -> Result<Fabrication, String> {
    if design.sheet_state.is_none() {
        return Err(
            "neither state is flat, so there is no sheet to cut: hinges, axes and solids are all that this \
                    design has (kirimorph check, export)"
                .to_owned(),
        );
    }
    let imported = design.pattern == PatternKind::Imported && design.sheet_state == Some(State::Closed);
    if let Some(hinge) = imported.then(|| Slits::new(design).unclosed(design)).flatten() {
        let [j, k] = design.hinges[hinge].pieces;
        return Err(format!(
            "the sides of pieces {j} and {k} do not lie on each other beside hinge {hinge}: in the closed state this \
             slit is not closed, and the layout cuts closed slits only; close the slits in the program that made the \
             design, or state its --gap-mm on import"
        ));
    }
    let lengths = ligament_lengths(design, profile).map_err(|error| error.to_string())?;
    fabricate(design, profile, &lengths).map_err(|error| error.to_string())
}

/// The design without corners that nearly coincide in a piece, which no cut can tell apart; says where there were some.
pub fn without_repeated(design: Design) -> Design {
    let (simple, pieces) = without_repeated_corners(&design);
    for piece in pieces {
        let word = paint::warning("warning");
        anstream::eprintln!("{word}: piece {piece} has two corners that nearly coincide: laid out as one");
    }
    simple
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
