//! `kirimorph import`: a design made elsewhere becomes a design.json.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::check::without_repeated;
use super::progress::{Reporting, watched};
use super::{Failure, paint, print};
use crate::import::{
    CLOSED, CONSTRAINTS, ImportError, Imported, OPEN, Options, Size, Source, import, read_mesh_pair,
    read_pieces_json, read_pykirigami, reassembled,
};
use crate::kirigami::design::{Design, State};
use crate::kirigami::improve::{self, Slits, improve, largest_move};
use crate::kirigami::quality::{Limits, Quality, measure_alone};
use crate::kirigami::rigidity;
use crate::output::design_json::{self, DesignFile, Provenance, Stage, WriteDesignError};
use crate::output::whole_file::write_whole;
use crate::pipeline::fingerprints;
use crate::profile;

/// The flags.
#[derive(Debug, Args)]
#[command(group = clap::ArgGroup::new("source").required(true).args(["closed", "pykirigami", "pieces"]))]
pub struct Arguments {
    /// The closed state (OBJ or PLY): a face per piece.
    #[arg(long, requires = "open", value_name = "A.obj")]
    closed: Option<PathBuf>,
    /// The open state: the same faces in the same order.
    #[arg(long, requires = "closed", value_name = "B.obj")]
    open: Option<PathBuf>,
    /// A folder with PyKirigami's vertices.txt (closed), target.txt (open) and constraints.txt (hinges).
    #[arg(long, value_name = "DIR")]
    pykirigami: Option<PathBuf>,
    /// Pieces and their motions, as docs/pieces.schema.json describes them.
    #[arg(long, value_name = "FILE.json")]
    pieces: Option<PathBuf>,
    /// File for the design.
    #[arg(short, long, value_name = "design.json")]
    output: PathBuf,
    /// Unit of the coordinates.
    #[arg(long, value_enum, default_value = "mm")]
    units: Units,
    /// Scale so that the sheet's (or, where neither state is flat, the closed state's) largest extent along x, y or z
    /// is this.
    #[arg(long, conflicts_with_all = ["units", "scale"])]
    size_mm: Option<f64>,
    /// Further factor of all lengths.
    #[arg(long, default_value_t = 1.0)]
    scale: f64,
    /// Corners nearer than this in both states are one hinge, after scaling [default: 1e-4 mean sides of the pieces].
    #[arg(long)]
    tolerance_mm: Option<f64>,
    /// Distance between the two hinges of a closed corner, after scaling; designs of other programs have none.
    #[arg(long, default_value_t = 0.0)]
    gap_mm: f64,
    /// Most that a piece may differ between the two states, in mean sides of the pieces.
    #[arg(long, default_value_t = 1e-2)]
    max_strain: f64,
    /// Make the pieces congruent in both states (Stage 3), moving points as little as that takes.
    #[arg(long)]
    improve: bool,
    /// With --improve: move the hinges to where this profile's ligaments stand, to either side of the slits that pass
    /// them. For a flat closed state whose slits are closed.
    #[arg(short, long, requires = "improve", conflicts_with = "gap_mm")]
    profile: Option<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Units {
    Mm,
    Cm,
    M,
    In,
}

impl Units {
    fn millimetres(self) -> f64 {
        match self {
            Self::Mm => 1.0,
            Self::Cm => 10.0,
            Self::M => 1000.0,
            Self::In => 25.4,
        }
    }
}

/// What --improve did.
struct Improvement {
    before: Quality,
    moved: f64,
}

/// Imports, improves where asked to, and writes the design.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let (source, files) = read(arguments).map_err(failure)?;
    let options = Options {
        size: match arguments.size_mm {
            Some(extent) => Size::Extent(extent),
            None => Size::Scale(arguments.scale * arguments.units.millimetres()),
        },
        tolerance: arguments.tolerance_mm,
        gap: arguments.gap_mm,
        max_strain: arguments.max_strain,
    };
    let mut imported = import(source, &options).map_err(failure)?;
    let mut stages = Vec::new();
    let improvement = match arguments.improve {
        false => None,
        true => Some(improved(&mut imported, arguments.profile.as_deref(), &mut stages)?),
    };
    let quality = measure_alone(&imported.design);
    let named: Vec<(&str, &Path)> = files.iter().map(|(name, path)| (*name, path.as_path())).collect();
    let hashes: BTreeMap<String, String> = fingerprints(&named);
    let name = arguments.output.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let target = files.iter().map(|(_, path)| path.file_name().unwrap_or_default().to_string_lossy());
    let design = DesignFile {
        design: &imported.design,
        quality: &quality,
        stages: &stages,
        max_strain: None,
        provenance: Provenance {
            job: &name,
            target: &target.collect::<Vec<_>>().join(", "),
            hashes: &hashes,
        },
    };
    write_whole::<WriteDesignError>(&arguments.output, |out| design_json::write(&design, out))
        .map_err(|error| Failure::BadInput(format!("{}: {error}", arguments.output.display())))?;
    for warning in &imported.warnings {
        anstream::eprintln!("{}: {warning}", paint::warning("warning"));
    }
    print(&summary(&name, &imported, &quality, improvement.as_ref()));
    print(&format!("Design in {}\n", arguments.output.display()));
    Ok(())
}

/// Files by the names of their hashes.
type Files = Vec<(&'static str, PathBuf)>;

/// The pieces, and the files that they come from.
fn read(arguments: &Arguments) -> Result<(Source, Files), ImportError> {
    if let Some(folder) = &arguments.pykirigami {
        let names = [("closed", CLOSED), ("open", OPEN), ("constraints", CONSTRAINTS)];
        let files = names.map(|(name, file)| (name, folder.join(file))).to_vec();
        return Ok((read_pykirigami(folder)?, files));
    }
    if let Some(file) = &arguments.pieces {
        return Ok((read_pieces_json(file)?, vec![("pieces", file.clone())]));
    }
    // The flags come in pairs: clap sees to it.
    let [closed, open] = [&arguments.closed, &arguments.open].map(|path| path.clone().unwrap_or_default());
    Ok((read_mesh_pair(&closed, &open)?, vec![("closed", closed), ("open", open)]))
}

fn failure(error: ImportError) -> Failure {
    if error.is_bad_input() { Failure::bad_input(error) } else { Failure::NotMakeable(error.to_string()) }
}

/// Replaces the design by the improved one.
fn improved(
    imported: &mut Imported,
    profile: Option<&str>,
    stages: &mut Vec<Stage>,
) -> Result<Improvement, Failure> {
    if profile.is_some() {
        // Two hinge points would have to stand apart where there is no side to part them.
        imported.design = without_repeated(imported.design.clone());
    }
    let gap = profile.map(|profile| gap_for(&imported.design, profile)).transpose()?;
    let (before, tolerance) = (measure_alone(&imported.design), imported.tolerance);
    let options = improve::Options { tolerance, gap };
    let (pieces, reports) = watched(&Reporting::default(), |clock| {
        let improved = clock.run("stage-3", |run| improve(&imported.design, &options, run));
        clock.go_on(|| None).map_err(|error| Failure::Interrupted(error.to_string()))?;
        Ok(improved)
    })?;
    let moved = largest_move(&imported.design.pieces, &pieces);
    let gap = gap.unwrap_or(imported.design.gap);
    imported.design = reassembled(&imported.design, pieces, gap, tolerance);
    stages.push(Stage { name: "stage-3", reports });
    let after = measure_alone(&imported.design);
    // Within the limit of our own designs nobody asks where it was.
    let acceptable = before.max_length_error.max(Limits::default().length_error);
    if after.max_length_error.is_nan() || after.max_length_error > acceptable {
        return Err(Failure::NotMakeable(format!(
            "--improve made the largest length error {:.1e} where it was {:.1e}: the pieces cannot be made congruent near \
             where they are; import without --improve",
            after.max_length_error, before.max_length_error
        )));
    }
    imported.misfit = rigidity::worst(&imported.design).expect("a design has pieces");
    Ok(Improvement { before, moved })
}

/// The gap that a profile's ligaments need.
fn gap_for(design: &Design, profile: &str) -> Result<f64, Failure> {
    let profile = profile::load(profile, Path::new(".")).map_err(Failure::bad_input)?;
    if design.sheet_state != Some(State::Closed) {
        return Err(Failure::NotMakeable(
            "--profile: the closed state is not flat, so there is no sheet on which ligaments stand; leave --profile out"
                .to_owned(),
        ));
    }
    match Slits::new(design).unclosed(design) {
        None => Ok(profile.hinge_gap()),
        Some(hinge) => Err(Failure::NotMakeable(format!(
            "--profile: the slit at hinge {hinge}, between pieces {} and {}, is not closed in the closed state, so no \
             ligament can stand beside it; leave --profile out",
            design.hinges[hinge].pieces[0], design.hinges[hinge].pieces[1]
        ))),
    }
}

fn summary(name: &str, imported: &Imported, quality: &Quality, improvement: Option<&Improvement>) -> String {
    let Imported { design, tolerance, misfit, .. } = imported;
    let side = rigidity::mean_piece_side(design);
    let mut text =
        format!("{name}: imported, {} pieces and {} hinges\n", design.pieces.len(), design.hinges.len());
    let rows = [
        ("sheet state", sheet_words(design).to_owned()),
        ("mean side", format!("{side:.4} mm; corners within {tolerance:.1e} mm are one")),
        ("least rigid", format!("piece {}, {:.1e} mean sides off", misfit.piece, misfit.strain)),
        ("length error", format!("{:.1e} relative", quality.max_length_error)),
        ("bending", format!("{:.1e} edges", quality.planarity)),
    ];
    for (label, value) in rows {
        text += &format!("  {label:<12}  {value}\n");
    }
    if let Some(Improvement { before, moved }) = improvement {
        text += &format!(
            "  {:<12}  length error from {:.1e} to {:.1e}, bending from {:.1e} to {:.1e} edges, points moved {} mm \
             at most\n",
            "improved",
            before.max_length_error,
            quality.max_length_error,
            before.planarity,
            quality.planarity,
            if *moved < 1e-3 { format!("{moved:.1e}") } else { format!("{moved:.3}") }
        );
    }
    text
}

fn sheet_words(design: &Design) -> &'static str {
    match design.sheet_state {
        Some(State::Closed) => "closed: it is flat",
        Some(State::Open) => "open: it is flat",
        None => "none: neither state is flat, so there is no sheet to cut",
    }
}
