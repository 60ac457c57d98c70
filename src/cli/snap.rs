//! `kirimorph snap`: the energy of a sheet on its way between its states.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::check::{design_file, without_repeated};
use super::progress::{Reporter, Reporting};
use super::table::labelled;
use super::{Failure, print};
use crate::fabrication::hinge_table::planned_rows;
use crate::output::whole_file::write_whole;
use crate::output::{design_json, snap_report};
use crate::profile;
use crate::snap::assess::assess;

/// The flags.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// A design.json, or a folder that holds one.
    design: PathBuf,
    /// A profile's name or file.
    #[arg(short, long)]
    profile: String,
    /// File for the result: FILE.json with everything, FILE.csv with the path alone.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Draw energy and torque as FILE.svg.
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
}

/// Computes the snap, prints its figures and writes what is asked for.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments { design, profile, output, plot } = arguments;
    for (file, endings) in [(output, &["json", "csv"][..]), (plot, &["svg"][..])] {
        let Some(file) = file else { continue };
        if !endings.iter().any(|ending| has_ending(file, ending)) {
            let endings = endings.join(" or .");
            return Err(Failure::BadInput(format!(
                "{}: the file's name must end in .{endings}",
                file.display()
            )));
        }
    }
    let file = design_file(design);
    let design = without_repeated(design_json::read(&file).map_err(Failure::bad_input)?);
    if design.hinges.is_empty() {
        let text =
            format!("{}: the design has no hinges, so nothing holds or turns its pieces", file.display());
        return Err(Failure::BadInput(text));
    }
    let profile = profile::load(profile, Path::new(".")).map_err(Failure::bad_input)?;
    let mut reporter = Reporter::new(&Reporting::default());
    reporter.say("snap: following the sheet there and back");
    let snap = assess(&design, &planned_rows(&design, &profile), &profile);
    drop(reporter);
    if let Some(path) = output {
        let text = if has_ending(path, "csv") {
            snap_report::csv(&snap)
        } else {
            format!("{:#}\n", snap_report::object(&snap, &profile.name))
        };
        write(path, |out| out.write_all(text.as_bytes()))?;
    }
    if let Some(path) = plot {
        let title = format!("{}, {}", file.display(), profile.name);
        write(path, |out| snap_report::write_plot(&snap, &title, out))?;
    }
    print(&labelled(&snap_report::figures(&snap)));
    Ok(())
}

fn has_ending(file: &Path, ending: &str) -> bool {
    file.extension().is_some_and(|found| found.eq_ignore_ascii_case(ending))
}

fn write(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Failure> {
    write_whole(path, |out| write(out))
        .map_err(|error: io::Error| Failure::BadInput(format!("{}: {error}", path.display())))
}
