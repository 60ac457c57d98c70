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
use cut_keys::CutKeys;
use progress::Reporting;
use results::Leaving;

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
    Make {
        /// The job file (TOML).
        job: PathBuf,
        /// Folder for the results [default: out/NAME, NAME being the job file's].
        #[arg(short, long)]
        output: Option<PathBuf>,
        /// Write the files even where a hinge fails; its verdict stays "fail".
        #[arg(long)]
        allow_failing_hinges: bool,
        /// Do everything and tell its figures, but write nothing.
        #[arg(long, conflicts_with = "output")]
        dry_run: bool,
        #[command(flatten)]
        optimisation: Optimisation,
        #[command(flatten)]
        reporting: Reporting,
    },
    /// Design the pattern alone, or predict whether the target can be reached.
    #[command(after_help = help::DESIGN)]
    Design {
        /// The job file (TOML).
        job: PathBuf,
        /// File for the design [default: out/NAME.design.json, NAME being the job file's].
        #[arg(short, long, conflicts_with = "feasibility_only")]
        output: Option<PathBuf>,
        /// Print what the target asks of the pattern, and design nothing: exit status 2 if it is out of reach.
        #[arg(long)]
        feasibility_only: bool,
        /// Draw where the target asks for how much stretch, as FILE.svg or FILE.html.
        #[arg(long, value_name = "FILE")]
        map: Option<PathBuf>,
        #[command(flatten)]
        optimisation: Optimisation,
        #[command(flatten)]
        reporting: Reporting,
    },
    /// Check the hinges of a design against a profile: prints the worst ones.
    #[command(after_help = help::CHECK)]
    Check {
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
    },
    /// Lay out a design for a profile: from a design.json to checked files for the laser or the mill, and the hinge placement report.
    #[command(after_help = help::FABRICATE)]
    Fabricate {
        /// A design.json, or a folder that holds one.
        design: PathBuf,
        /// A profile's name or file.
        #[arg(short, long)]
        profile: String,
        /// Folder for the results.
        #[arg(short, long, required_unless_present = "dry_run")]
        output: Option<PathBuf>,
        /// Write the files even where a hinge fails; its verdict stays "fail".
        #[arg(long)]
        allow_failing_hinges: bool,
        /// Do everything and tell its figures, but write nothing.
        #[arg(long, conflicts_with = "output")]
        dry_run: bool,
        #[command(flatten)]
        keys: CutKeys,
        /// What mills the sheet: a machine's name or file [default: linuxcnc-xyzbc-trt].
        #[arg(long)]
        machine: Option<String>,
        /// Begin the milling program with this run of setup.txt, as after a broken tool.
        #[arg(long, value_name = "RUN", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
        from_run: u32,
        #[command(flatten)]
        reporting: Reporting,
    },
    /// Read the cut files or the milling program of a folder back, cut them on paper and measure what is left.
    #[command(after_help = help::VERIFY)]
    Verify {
        /// A folder with design.json and cut.dxf, cut.svg, or with a milling program and part.stl.
        folder: PathBuf,
        /// A profile's name or file [default: the one that hinges.json of the folder names].
        #[arg(short, long)]
        profile: Option<String>,
        /// A machine's name or file [default: the one that hinges.json of the folder names].
        #[arg(long)]
        machine: Option<String>,
        /// List every fault, not only the first ones of each kind.
        #[arg(long)]
        all: bool,
    },
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
    Coupon {
        /// A profile's name or file.
        #[arg(short, long)]
        profile: String,
        /// Folder for the files [default: out/coupon-PROFILE].
        #[arg(short, long)]
        output: Option<PathBuf>,
    },
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

impl Command {
    /// Whether the command tells everything in events.
    fn tells_events(&self) -> bool {
        match self {
            Self::Make { reporting, .. }
            | Self::Design { reporting, .. }
            | Self::Fabricate { reporting, .. } => reporting.json,
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
        Command::Make { job, output, allow_failing_hinges, dry_run, optimisation, reporting } => {
            make::run(&job, output, [allow_failing_hinges, dry_run], &optimisation, &reporting)
        }
        Command::Design { job, output, feasibility_only, map, optimisation, reporting } => {
            design::run(&design::Options { job, output, feasibility_only, map, optimisation, reporting })
        }
        Command::Check { design, profile, worst, allow_failing_hinges } => {
            check::run(&design, &profile, worst, allow_failing_hinges)
        }
        Command::Fabricate {
            design,
            profile,
            output,
            allow_failing_hinges,
            dry_run,
            keys,
            machine,
            from_run,
            reporting,
        } => {
            let mill = (machine.as_deref(), from_run as usize - 1);
            let folder = output.unwrap_or_default();
            let leaving = Leaving { folder: &folder, allow_failing: allow_failing_hinges, dry_run };
            fabricate::run(&design, &profile, &leaving, &keys, mill, &reporting)
        }
        Command::Verify { folder, profile, machine, all } => {
            verify::run(&folder, profile.as_deref(), machine.as_deref(), all)
        }
        Command::Coupon { profile, output } => coupon::run(&profile, output),
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
