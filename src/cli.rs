//! The command line: the only place that opens output files and prints.
//!
//! Exit status: 0 made; 1 bad input, profile or usage; 2 not makeable, not reached, interrupted, a hinge that fails, or cut
//! files that are not what the design asks for.

mod check;
mod coupon;
mod cut_keys;
mod design;
mod events;
mod export;
mod fabricate;
mod figures;
mod import;
mod interrupt;
mod make;
mod map;
mod milled;
mod morphs;
mod open_state;
mod partial;
mod progress;
mod results;
mod verify;
mod verify_mill;
mod snap;
mod setup_sheet;
mod solids;
mod help;
mod library;
mod new;
mod pages;
mod paint;
mod table;

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};
use clap_complete::Shell;

use crate::pipeline::PipelineError;

/// Flat sheets with cut patterns that morph into surfaces: design, hinges, files for laser and mill.
#[derive(Debug, Parser)]
#[command(version, about, long_about = None, after_help = help::MAIN)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Do everything: from a job file to checked files for the laser or the mill, and the hinge placement report.
    #[command(after_help = help::MAKE)]
    Make(make::Arguments),
    /// Design the pattern alone, or predict whether the target can be reached.
    #[command(after_help = help::DESIGN)]
    Design(design::Arguments),
    /// Check the hinges of a design against a profile: prints the worst ones.
    #[command(after_help = help::CHECK)]
    Check(check::Arguments),
    /// Lay out a design for a profile: from a design.json to checked files for the laser or the mill, and the hinge placement report.
    #[command(after_help = help::FABRICATE)]
    Fabricate(fabricate::Arguments),
    /// Read the cut files or the milling program of a folder back, cut them on paper and measure what is left.
    #[command(after_help = help::VERIFY)]
    Verify(verify::Arguments),
    /// Take over a design made elsewhere: pieces in two states become a design.json.
    #[command(after_help = help::IMPORT)]
    Import(import::Arguments),
    /// Write a design for other programs.
    #[command(after_help = help::EXPORT)]
    Export(export::Arguments),
    /// Follow a sheet between its states: energy, barrier, strain, and whether it is bistable.
    #[command(after_help = help::SNAP)]
    Snap(snap::Arguments),
    /// Make a test piece that tells the kerf and the ligaments that your machine really makes.
    #[command(after_help = help::COUPON)]
    Coupon(coupon::Arguments),
    /// Write a job file to begin with, for a surface of yours.
    #[command(after_help = help::NEW)]
    New(new::Arguments),
    /// List the profiles (material, sheet, process and ligament), or print one to copy and change.
    #[command(after_help = help::PROFILES)]
    Profiles {
        /// Print this one's file.
        name: Option<String>,
    },
    /// List the machines for milling, or print one to copy and change.
    #[command(after_help = help::MACHINES)]
    Machines {
        /// Print this one's file.
        name: Option<String>,
    },
    /// Print completions of commands and options for a shell.
    #[command(after_help = help::COMPLETIONS)]
    Completions {
        /// The shell.
        shell: Shell,
    },
    /// Write manual pages, one for each command.
    #[command(after_help = help::MAN)]
    Man {
        /// Folder for the pages; other files in it stay.
        #[arg(short, long, default_value = "out/man")]
        output: PathBuf,
    },
}

/// How the optimisation is run.
#[derive(Debug, Clone, clap::Args)]
struct Optimisation {
    /// Go on from the design.partial.json that an interrupted run left in the results' folder. Job, target and
    /// profile must be the same; so is the result.
    #[arg(long)]
    resume: bool,
    /// Start even where the optimisation needs more memory than is free.
    #[arg(long)]
    ignore_memory: bool,
}

/// Whether the results are kept.
#[derive(Debug, Clone, Copy, clap::Args)]
struct Keeping {
    /// Write the files even where a hinge fails; its verdict stays "fail".
    #[arg(long)]
    allow_failing_hinges: bool,
    /// Do everything and tell its figures, but write nothing.
    #[arg(long, conflicts_with = "output")]
    dry_run: bool,
}

impl Command {
    /// Whether the command tells everything in events.
    fn tells_events(&self) -> bool {
        match self {
            Self::Make(make::Arguments { reporting, .. })
            | Self::Design(design::Arguments { reporting, .. })
            | Self::Fabricate(fabricate::Arguments { reporting, .. }) => reporting.json,
            _ => false,
        }
    }
}

/// How a command ends.
enum Failure {
    /// Exit status 1.
    BadInput(String),
    /// Exit status 2.
    NotMakeable(String),
    /// Exit status 2: somebody asked to stop.
    Interrupted(String),
}

impl Failure {
    fn bad_input(error: impl std::fmt::Display) -> Self {
        Self::BadInput(error.to_string())
    }

    /// The exit status, how the message begins, and the message.
    fn parts(self) -> (u8, &'static str, String) {
        match self {
            Self::BadInput(message) => (1, "error", message),
            Self::NotMakeable(message) => (2, "refused", message),
            Self::Interrupted(message) => (2, "interrupted", message),
        }
    }
}

impl From<PipelineError> for Failure {
    fn from(error: PipelineError) -> Self {
        if error.is_bad_input() { Self::bad_input(error) } else { Self::NotMakeable(error.to_string()) }
    }
}

/// All commands and options, as help texts, man pages, completions and `docs/commands` tell them.
pub fn command() -> clap::Command {
    Arguments::command()
}

/// Runs the program with these arguments and returns its exit status.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let arguments = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        Err(error) => {
            // Help and version are no errors; a usage error is 1, where clap says 2. Nothing can be done
            // about a closed pipe.
            let _ = error.print();
            return if error.use_stderr() { ExitCode::from(1) } else { ExitCode::SUCCESS };
        }
    };
    let events = arguments.command.tells_events();
    match dispatch(arguments.command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            let (status, word, message) = failure.parts();
            if events {
                events::error(word, &message, status);
            }
            anstream::eprintln!("{}: {message}", paint::error(word));
            ExitCode::from(status)
        }
    }
}

/// Hands a command its options.
fn dispatch(command: Command) -> Result<(), Failure> {
    match command {
        Command::Make(arguments) => make::run(&arguments),
        Command::Design(arguments) => design::run(&arguments),
        Command::Check(arguments) => check::run(&arguments),
        Command::Fabricate(arguments) => fabricate::run(&arguments),
        Command::Verify(arguments) => verify::run(&arguments),
        Command::Coupon(arguments) => coupon::run(&arguments),
        Command::Import(arguments) => import::run(&arguments),
        Command::Export(arguments) => export::run(&arguments),
        Command::Snap(arguments) => snap::run(&arguments),
        Command::New(arguments) => new::run(&arguments),
        Command::Profiles { name } => library::profiles(name.as_deref()),
        Command::Machines { name } => library::machines(name.as_deref()),
        Command::Completions { shell } => {
            pages::completions(shell);
            Ok(())
        }
        Command::Man { output } => pages::man(&output),
    }
}

/// Prints to standard output, with colours where they are wanted; a reader that has gone away is no error.
fn print(text: &str) {
    use std::io::Write;
    let _ = anstream::stdout().lock().write_all(text.as_bytes());
}
