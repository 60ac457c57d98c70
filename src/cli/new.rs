//! `kirimorph new`: a job file to begin with.

use std::fs::OpenOptions;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use super::{Failure, print};
use crate::geometry::mesh::PolyMesh;
use crate::geometry::read::read_mesh;
use crate::job::Units;
use crate::profile::{self, Profile};

/// The flags.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The surface that the opened sheet is to take on: OBJ, STL or PLY.
    mesh: PathBuf,
    /// The job file to write, which must not exist [default: NAME.toml in this folder, NAME being the mesh's].
    #[arg(short, long, value_name = "JOB.toml")]
    output: Option<PathBuf>,
    /// A profile's name or file.
    #[arg(short, long, default_value = "steel-304-0.5mm")]
    profile: String,
    /// Unit of the mesh's coordinates.
    #[arg(long, value_enum, default_value = "mm")]
    units: Unit,
    /// Scale so that the surface's largest extent along x, y or z is this.
    #[arg(long)]
    size_mm: Option<f64>,
}

#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum Unit {
    Mm,
    Cm,
    M,
    In,
}

impl Unit {
    /// As job files write it, and the unit.
    fn parts(self) -> (&'static str, Units) {
        match self {
            Self::Mm => ("mm", Units::Millimetres),
            Self::Cm => ("cm", Units::Centimetres),
            Self::M => ("m", Units::Metres),
            Self::In => ("in", Units::Inches),
        }
    }
}

/// Pieces along the longer side of a sheet that has room for as many.
const PIECES: f64 = 34.0;

/// Smallest side of a piece, in distances of the two hinges at a corner: the samples have 12 to 16.
const SMALLEST_PIECE: f64 = 12.0;

/// With fewer pieces along the longest side the surface is hardly met.
const FEWEST_PIECES: f64 = 6.0;

/// Writes the job file, unless there is one.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mesh = read_mesh(&arguments.mesh).map_err(Failure::bad_input)?;
    let profile = profile::load(&arguments.profile, Path::new(".")).map_err(Failure::bad_input)?;
    if let Some(size) = arguments.size_mm.filter(|size| !(size.is_finite() && *size > 0.0)) {
        return Err(Failure::BadInput(format!("--size-mm is {size}: it must be a number above 0")));
    }
    let name = || PathBuf::from(arguments.mesh.with_extension("toml").file_name().unwrap_or_default());
    let job = arguments.output.clone().unwrap_or_else(name);
    let extents = extents(&mesh, arguments);
    let largest = extents.into_iter().fold(0.0, f64::max);
    let piece = piece_side(&profile, largest);
    let text = text(arguments, &from_job(&arguments.mesh, &job)?, extents, piece);
    leave(&job, &text)?;
    let shown = job.display();
    print(&format!(
        "{shown}: {} faces, {} mm, pieces of {piece} mm\nNext: kirimorph design {shown} --feasibility-only, then \
         kirimorph make {shown}\n",
        mesh.faces.len(),
        extents.map(|extent| format!("{extent:.1}")).join(" x "),
    ));
    if largest < FEWEST_PIECES * piece {
        print(&format!(
            "That is small for {}, whose pieces want {piece} mm: look at units and size_mm in the job.\n",
            profile.name
        ));
    }
    Ok(())
}

/// Extents of the target along x, y and z, millimetres.
fn extents(mesh: &PolyMesh, arguments: &Arguments) -> [f64; 3] {
    let own: [f64; 3] = std::array::from_fn(|i| {
        let along = mesh.vertices.iter().map(|vertex| vertex[i]);
        let (least, most) =
            along.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), x| (least.min(x), most.max(x)));
        (most - least).max(0.0)
    });
    let largest = own.into_iter().fold(0.0, f64::max);
    let scale = match arguments.size_mm {
        Some(size) if largest > 0.0 => size / largest,
        _ => arguments.units.parts().1.millimetres(),
    };
    own.map(|extent| extent * scale)
}

/// Side of a piece for a target of this size, in half millimetres.
fn piece_side(profile: &Profile, largest: f64) -> f64 {
    let side = (largest / PIECES).max(SMALLEST_PIECE * profile.hinge_gap());
    (2.0 * side).ceil() / 2.0
}

/// The path of the mesh as the job file is to say it: relative where the mesh lies below the job's folder.
fn from_job(mesh: &Path, job: &Path) -> Result<String, Failure> {
    let fault = |error| Failure::BadInput(format!("{}: {error}", mesh.display()));
    let mesh = mesh.canonicalize().map_err(fault)?;
    let folder = std::path::absolute(job).map_err(fault)?;
    let folder = folder.parent().unwrap_or(Path::new("/"));
    let folder = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
    let path = mesh.strip_prefix(&folder).unwrap_or(&mesh);
    let text = path.to_str().ok_or_else(|| {
        Failure::BadInput(format!(
            "{}: a job file is UTF-8 text and this path is not; rename it",
            path.display()
        ))
    })?;
    Ok(toml::Value::String(text.to_owned()).to_string())
}

fn text(arguments: &Arguments, mesh: &str, [x, y, z]: [f64; 3], piece: f64) -> String {
    let unit = arguments.units.parts().0;
    let size = match arguments.size_mm {
        Some(size) => format!("size_mm = {size:?}"),
        None => "# size_mm = 300.0".to_owned(),
    };
    let profile = toml::Value::String(arguments.profile.clone());
    let text = format!(
        "# A job for kirimorph, begun by kirimorph new. Lines that begin with # say what else there is.\n\
         \n\
         [target]\n\
         open = {mesh}  # the surface that the opened sheet takes on; {x:.1} x {y:.1} x {z:.1} mm\n\
         closed = \"flat\"  # the sheet as it is cut\n\
         units = \"{unit}\"  # of the mesh: mm, cm, m, in\n\
         {size}  # scales the surface so that its largest extent is this\n\
         \n\
         [pattern]\n\
         kind = \"rotating-rectangles\"  # or \"bistable\", sheets that snap\n\
         piece_mm = {piece:?}  # side of a piece; or pieces = [30, 30], how many along and across\n\
         # opening = \"variable\"  # pieces turn only as far as the surface asks\n\
         # alignment = \"principal\"  # lays the grid along the directions of most and least stretch\n\
         \n\
         [fabrication]\n\
         profile = {profile}  # kirimorph profiles lists them\n\
         # kerf_mm = 0.05  # yours: kirimorph coupon --profile PROFILE says how to measure it\n\
         # sheet_mm = [600.0, 400.0]  # size of your stock\n"
    );
    text.lines().map(in_column).collect()
}

/// The line with the comment behind its value at a common column.
fn in_column(line: &str) -> String {
    match line.rsplit_once("  # ") {
        Some((value, comment)) => format!("{value:<38}# {comment}\n"),
        None => format!("{line}\n"),
    }
}

fn leave(job: &Path, text: &str) -> Result<(), Failure> {
    let fault = |error: std::io::Error| match error.kind() {
        ErrorKind::AlreadyExists => Failure::BadInput(format!(
            "{} is there already and is not replaced; name another file with -o",
            job.display()
        )),
        _ => Failure::BadInput(format!("{} cannot be written: {error}", job.display())),
    };
    let mut file = OpenOptions::new().write(true).create_new(true).open(job).map_err(fault)?;
    file.write_all(text.as_bytes()).map_err(|error| {
        // Half a job is of no use, and stands in the way of the next attempt.
        let _ = std::fs::remove_file(job);
        fault(error)
    })
}
