//! `kirimorph export`: a design for other programs.

use std::io;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::check::design_file;
use super::morphs::polygons;
use super::{Failure, print};
use crate::import::{CLOSED, CONSTRAINTS, OPEN};
use crate::kirigami::design::{Design, State};
use crate::morph::morph;
use crate::output::exchange::{
    piece_solid, write_obj, write_pykirigami_constraints, write_pykirigami_state, write_stl,
};
use crate::output::folder::{MORPH, OutputFolder};
use crate::output::{design_json, glb};

/// The flags.
#[derive(Debug, Args)]
#[command(group = clap::ArgGroup::new("format").required(true).multiple(true).args(["obj_pair", "pykirigami", "stl", "formats"]))]
#[command(group = clap::ArgGroup::new("solid").multiple(true).args(["stl", "formats"]))]
pub struct Arguments {
    /// A design.json, or a folder that holds one.
    design: PathBuf,
    /// Folder for closed.obj and open.obj: a face per piece.
    #[arg(long, value_name = "DIR")]
    obj_pair: Option<PathBuf>,
    /// Folder for PyKirigami's vertices.txt, target.txt and constraints.txt.
    #[arg(long, value_name = "DIR")]
    pykirigami: Option<PathBuf>,
    /// Folder for piece-0000.stl and so on: one solid per piece, its hinge polygon with a thickness.
    #[arg(long, value_name = "DIR", requires = "thickness_mm")]
    stl: Option<PathBuf>,
    /// What to write to the folder of --output: the animated morph.glb, closed.obj and open.obj, or a piece-0000.stl per piece.
    #[arg(long = "format", value_name = "FORMAT", value_enum, value_delimiter = ',', requires = "output")]
    formats: Vec<Format>,
    /// Folder for the files of --format.
    #[arg(short, long, value_name = "DIR", requires = "formats")]
    output: Option<PathBuf>,
    /// Thickness of the solids, half of it to either side of the hinge polygon.
    #[arg(long, requires = "solid")]
    thickness_mm: Option<f64>,
    /// State of the solids [default: the sheet state, or closed where neither is flat].
    #[arg(long, value_enum, requires = "solid")]
    state: Option<StateName>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    Glb,
    Obj,
    Stl,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum StateName {
    Closed,
    Open,
}

const OBJ_PAIR: [&str; 2] = ["closed.obj", "open.obj"];

fn is_obj_pair(name: &str) -> bool {
    OBJ_PAIR.contains(&name)
}

fn is_pykirigami(name: &str) -> bool {
    [CLOSED, OPEN, CONSTRAINTS].contains(&name)
}

fn is_piece(name: &str) -> bool {
    let number = name.strip_prefix("piece-").and_then(|rest| rest.strip_suffix(".stl"));
    number.is_some_and(|digits| !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit()))
}

fn is_of_formats(name: &str) -> bool {
    name == MORPH || is_obj_pair(name) || is_piece(name)
}

/// Writes what is asked for, each folder whole or not at all.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let file = design_file(&arguments.design);
    let design = design_json::read(&file).map_err(Failure::bad_input)?;
    let mut folders: Vec<(OutputFolder, &Path)> = Vec::new();
    if let Some(folder) = &arguments.stl {
        let out = create(folder, is_piece)?;
        stl(&design, state(arguments, &design), thickness(arguments)?, &out, folder)?;
        folders.push((out, folder));
    }
    if let Some(folder) = &arguments.obj_pair {
        let out = create(folder, is_obj_pair)?;
        obj_pair(&design, &out, folder)?;
        folders.push((out, folder));
    }
    if let Some(folder) = &arguments.output {
        let out = create(folder, is_of_formats)?;
        formats(arguments, &design, &out, folder)?;
        folders.push((out, folder));
    }
    if let Some(folder) = &arguments.pykirigami {
        let out = create(folder, is_pykirigami)?;
        out.write(CLOSED, |file| write_pykirigami_state(&design, State::Closed, file))
            .and_then(|()| out.write(OPEN, |file| write_pykirigami_state(&design, State::Open, file)))
            .and_then(|()| out.write(CONSTRAINTS, |file| write_pykirigami_constraints(&design, file)))
            .map_err(|error| unwritten(folder, error))?;
        folders.push((out, folder));
    }
    for (out, folder) in folders {
        out.finish().map_err(Failure::bad_input)?;
        print(&format!("Files in {}\n", folder.display()));
    }
    Ok(())
}

fn create(folder: &Path, is_ours: fn(&str) -> bool) -> Result<OutputFolder, Failure> {
    OutputFolder::create_of(folder, is_ours).map_err(Failure::bad_input)
}

fn unwritten(folder: &Path, error: io::Error) -> Failure {
    Failure::BadInput(format!("{}: {error}", folder.display()))
}

/// The thickness of solids.
fn thickness(arguments: &Arguments) -> Result<f64, Failure> {
    match arguments.thickness_mm {
        Some(thickness) if thickness.is_finite() && thickness > 0.0 => Ok(thickness),
        Some(thickness) => {
            Err(Failure::BadInput(format!("--thickness-mm is {thickness}: it must be a number above 0")))
        }
        None => Err(Failure::BadInput(String::from(
            "--format glb and stl write solids: say how thick they are with --thickness-mm T",
        ))),
    }
}

/// The state of solids that do not move.
fn state(arguments: &Arguments, design: &Design) -> State {
    match arguments.state {
        Some(StateName::Closed) => State::Closed,
        Some(StateName::Open) => State::Open,
        None => design.sheet_state.unwrap_or(State::Closed),
    }
}

/// The files of --format.
fn formats(arguments: &Arguments, design: &Design, out: &OutputFolder, folder: &Path) -> Result<(), Failure> {
    if arguments.formats.contains(&Format::Obj) {
        obj_pair(design, out, folder)?;
    }
    if arguments.formats.contains(&Format::Stl) {
        stl(design, state(arguments, design), thickness(arguments)?, out, folder)?;
    }
    if arguments.formats.contains(&Format::Glb) {
        if design.hinges.is_empty() {
            return Err(Failure::BadInput(String::from(
                "the design has no hinges, so nothing says how its pieces move: leave glb out of --format",
            )));
        }
        let (bodies, morph) = (polygons(design, thickness(arguments)?)?, morph(design, None));
        let scene = glb::Scene { name: "kirimorph", design, bodies: &bodies, morph: &morph };
        out.write(MORPH, |file| glb::write(&scene, file)).map_err(|error| unwritten(folder, error))?;
    }
    Ok(())
}

fn obj_pair(design: &Design, out: &OutputFolder, folder: &Path) -> Result<(), Failure> {
    for (name, state) in OBJ_PAIR.into_iter().zip([State::Closed, State::Open]) {
        out.write(name, |file| write_obj(design, state, file)).map_err(|error| unwritten(folder, error))?;
    }
    Ok(())
}

fn stl(
    design: &Design,
    state: State,
    thickness: f64,
    out: &OutputFolder,
    folder: &Path,
) -> Result<(), Failure> {
    let solids = design.pieces.iter().enumerate().map(|(index, piece)| {
        piece_solid(piece, state, thickness)
            .map_err(|error| Failure::NotMakeable(format!("piece {index} cannot be made a solid: {error}")))
    });
    let solids: Vec<_> = solids.collect::<Result<_, _>>()?;
    for (index, solid) in solids.iter().enumerate() {
        out.write(&format!("piece-{index:04}.stl"), |file| write_stl(solid.iter().copied(), file))
            .map_err(|error| unwritten(folder, error))?;
    }
    Ok(())
}
