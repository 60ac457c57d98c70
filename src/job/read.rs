//! The job file's keys, the range of each number with the reason, and what is refused in words.

use std::f64::consts::SQRT_2;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use toml::Spanned;

use super::bistable::{bistable, only_bistable};
use super::cut::cut_options;
use super::guide::{RawGuide, guides};
use super::machine::machine;
use super::solver::{RawSolver, solver};
use super::{
    Boundary, Cuts, DxfVersion, Fabrication, Grid, Job, JobError, Kind, Opening, Pattern, PatternFile,
    PieceSize, Reading, Shape, Target, Units,
};
use crate::profile::{self, KERF, Process, Profile, ProfileError, SHEET_SIDE, TOOL_RADIUS};
use crate::toml_source::{Limits, TomlError, TomlSource};

const SIZE: Limits =
    Limits::new(1.0, 10_000.0, "mm", "the largest extent of the target: a coin to a roof panel");
const PIECE: Limits = Limits::new(0.5, 1000.0, "mm", "the side of a piece: a hinge needs room on it");
const PIECES: Limits = Limits::new(
    2.0,
    2000.0,
    "",
    "a pattern needs two pieces to turn against each other; more than 2000 a side take hours",
);
const STRETCH: Limits =
    Limits::new(0.8, 6.1, "", "1/m1 + 1/m2 = sqrt 2 leaves no fitting second stretch beyond that");
const GAP: Limits = Limits::new(0.0, 100.0, "mm", "ligament width plus slit width; 0 is the paper's model");
/// How far 1/m1 + 1/m2 may be from sqrt 2, relative: four typed digits fit.
const STRETCH_TOLERANCE: f64 = 1.0e-3;

/// Two numbers; a list, because a list that is too long fits an array of two without a word.
type Pair<T> = Spanned<Vec<Spanned<T>>>;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawJob {
    target: RawTarget,
    #[serde(default)]
    guide: Vec<Spanned<RawGuide>>,
    pattern: Spanned<RawPattern>,
    fabrication: RawFabrication,
    #[serde(default)]
    solver: RawSolver,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawTarget {
    open: Spanned<String>,
    closed: Spanned<String>,
    units: Option<Spanned<String>>,
    size_mm: Option<Spanned<f64>>,
    closed_size_mm: Option<Spanned<f64>>,
    cuts: Option<Spanned<String>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawPattern {
    pub kind: Spanned<String>,
    pieces: Option<Pair<i64>>,
    piece_mm: Option<Spanned<f64>>,
    pub control_mesh: Option<Spanned<String>>,
    pub piece_mesh: Option<Spanned<String>>,
    pub alignment: Option<Spanned<String>>,
    pub stretches: Option<Pair<f64>>,
    boundary: Option<Spanned<String>>,
    gap_mm: Option<Spanned<f64>>,
    pub opening: Option<Spanned<String>>,
    #[serde(rename = "A")]
    pub cell_a: Option<Spanned<f64>>,
    #[serde(rename = "B")]
    pub cell_b: Option<Spanned<f64>>,
    #[serde(rename = "a")]
    pub side_a: Option<Spanned<f64>>,
    #[serde(rename = "b")]
    pub side_b: Option<Spanned<f64>>,
    pub phi_deg: Option<Spanned<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawFabrication {
    profile: Spanned<String>,
    sheet_mm: Option<Pair<f64>>,
    kerf_mm: Option<Spanned<f64>>,
    process: Option<Spanned<String>>,
    pub machine: Option<Spanned<String>>,
    dxf: Option<Spanned<String>>,
    pub copies: Option<Spanned<i64>>,
    pub spacing_mm: Option<Spanned<f64>>,
    pub passes: Option<Spanned<i64>>,
    pub pierce: Option<Spanned<String>>,
    pub order: Option<Spanned<String>>,
    pub cool_s: Option<Spanned<f64>>,
    pub cool_mm: Option<Spanned<f64>>,
    pub leads: Option<Spanned<String>>,
    pub lead_mm: Option<Spanned<f64>>,
    pub tabs: Option<Spanned<i64>>,
    pub tab_mm: Option<Spanned<f64>>,
    pub engrave: Option<Spanned<bool>>,
    sheet_state: Option<Spanned<String>>,
}

/// Reads and checks the text of a job file that lies in `folder`; `file` stands in messages.
pub(super) fn parse(text: &str, file: &str, folder: PathBuf) -> Result<Job, JobError> {
    let source = TomlSource { file, text };
    let raw: RawJob = source.parse()?;
    let target = target(&source, &raw.target, &folder)?;
    let guides = guides(&source, &raw.guide, &target, &folder)?;
    let kind = kind(&source, raw.pattern.get_ref(), &target)?;
    let grid = grid(&source, &raw, &folder)?;
    let stretches = match &kind {
        Kind::RotatingRectangles => stretches(&source, raw.pattern.get_ref().stretches.as_ref())?,
        Kind::Bistable(cell) => cell.stretches(),
    };
    let boundary = boundary(&source, raw.pattern.get_ref().boundary.as_ref())?;
    let opening = opening(&source, raw.pattern.get_ref(), &target)?;
    let gap = source.optional(raw.pattern.get_ref().gap_mm.as_ref(), &GAP)?;
    let fabrication = fabrication(&source, &raw.fabrication, &folder)?;
    check_sheet_state(&source, &raw.fabrication, &target)?;
    let gap = gap.unwrap_or(fabrication.profile.hinge_gap());
    let pattern = Pattern { kind, grid, stretches, opening, boundary, gap };
    let solver = solver(&source, &raw.solver, opening, kind != Kind::RotatingRectangles)?;
    Ok(Job { folder, target, guides, pattern, fabrication, solver })
}

fn target(source: &TomlSource, raw: &RawTarget, folder: &Path) -> Result<Target, TomlError> {
    let open = match raw.open.get_ref().as_str() {
        "flat" => Shape::Flat,
        "free" => Shape::Free,
        _ => Shape::Mesh(mesh_path(source, &raw.open, folder)?),
    };
    let closed = match raw.closed.get_ref().as_str() {
        "flat" => Shape::Flat,
        "free" => {
            let help = "form finding opens a given closed sheet: closed = \"PATH\", open = \"free\"";
            return Err(source.value_error(
                raw.closed.span(),
                "not known: allowed is \"flat\" or a mesh file",
                help,
            ));
        }
        _ => Shape::Mesh(mesh_path(source, &raw.closed, folder)?),
    };
    if closed == Shape::Flat && !matches!(open, Shape::Mesh(_)) {
        let help = "one of the two states must be a mesh file; a flat sheet with an outline of your own is a mesh too";
        return Err(source.value_error(raw.open.span(), "not possible where closed = \"flat\"", help));
    }
    if let (Some(size), false) =
        (&raw.closed_size_mm, matches!((&open, &closed), (Shape::Mesh(_), Shape::Mesh(_))))
    {
        let help = "it scales the closed target apart from the open one; with one mesh use size_mm";
        return Err(source.error(size.span(), "closed_size_mm needs two meshes", help));
    }
    let units = choice(
        source,
        raw.units.as_ref(),
        &[
            ("mm", Units::Millimetres),
            ("cm", Units::Centimetres),
            ("m", Units::Metres),
            ("in", Units::Inches),
        ],
    )?;
    Ok(Target {
        open,
        closed,
        units: units.unwrap_or(Units::Millimetres),
        size: source.optional(raw.size_mm.as_ref(), &SIZE)?,
        closed_size: source.optional(raw.closed_size_mm.as_ref(), &SIZE)?,
    })
}

/// The path of a mesh file that exists, as it is said: below the folder as the user named it.
pub(super) fn mesh_path(
    source: &TomlSource,
    value: &Spanned<String>,
    folder: &Path,
) -> Result<PathBuf, TomlError> {
    let path = folder.join(value.get_ref());
    let found = std::fs::metadata(&path);
    let what = match &found {
        Ok(found) if found.is_dir() => "a directory; allowed is a mesh file".to_owned(),
        Ok(found) if found.is_file() => return Ok(path),
        Ok(_) => "a device or pipe; allowed is a mesh file".to_owned(),
        Err(error) => format!("not readable as a mesh file: {error}"),
    };
    Err(source.value_error(
        value.span(),
        &what,
        format!("looked at {}; paths are relative to the job file", path.display()),
    ))
}

fn kind(source: &TomlSource, raw: &RawPattern, target: &Target) -> Result<Kind, TomlError> {
    let words = [("rotating-rectangles", false), ("bistable", true)];
    if choice(source, Some(&raw.kind), &words)? == Some(true) {
        return Ok(Kind::Bistable(bistable(source, raw, target)?));
    }
    only_bistable(source, raw)?;
    Ok(Kind::RotatingRectangles)
}

fn opening(source: &TomlSource, raw: &RawPattern, target: &Target) -> Result<Opening, TomlError> {
    let words = [("full", Opening::Full), ("variable", Opening::Variable)];
    let Some(value) = &raw.opening else { return Ok(Opening::Full) };
    let opening = choice(source, Some(value), &words)?.unwrap_or(Opening::Full);
    if opening == Opening::Variable && !matches!(target.open, Shape::Mesh(_)) {
        let help = "how far each piece opens follows from the open target: open = \"PATH\"";
        return Err(source.value_error(value.span(), "not possible without an open target", help));
    }
    if let (Opening::Variable, Some(stretches)) = (opening, &raw.stretches) {
        let help = "they follow from the map between the two states; leave stretches out";
        return Err(source.error(stretches.span(), "stretches do not go with opening = \"variable\"", help));
    }
    Ok(opening)
}

/// Where the pieces come from: counts, a size, or a mesh file.
fn grid(source: &TomlSource, raw: &RawJob, folder: &Path) -> Result<Grid, TomlError> {
    let pattern = raw.pattern.get_ref();
    let control = Reading::ControlMesh { pieces_at: None };
    let (file, reading) = match (&pattern.control_mesh, &pattern.piece_mesh) {
        (Some(_), Some(second)) => {
            let help =
                "control_mesh has a face for every hinge, piece_mesh one for every piece: give one of them";
            return Err(source.error(second.span(), "pattern has both control_mesh and piece_mesh", help));
        }
        (Some(file), None) => (file, control),
        (None, Some(file)) => (file, Reading::Pieces),
        (None, None) => {
            if let Some(cuts) = &raw.target.cuts {
                let help = "cuts run between the pieces of a mesh of your own: add [pattern] control_mesh or piece_mesh";
                return Err(source.error(cuts.span(), "cuts need control_mesh or piece_mesh", help));
            }
            let size = pieces(source, &raw.pattern)?;
            let aligned =
                choice(source, pattern.alignment.as_ref(), &[("grid", false), ("principal", true)])?;
            return Ok(if aligned == Some(true) { Grid::Aligned(size) } else { Grid::Regular(size) });
        }
    };
    let given = |span: Option<std::ops::Range<usize>>, key: &'static str| span.map(|span| (span, key));
    let clash = [
        given(pattern.pieces.as_ref().map(Spanned::span), "pieces"),
        given(pattern.piece_mm.as_ref().map(Spanned::span), "piece_mm"),
        given(pattern.alignment.as_ref().map(Spanned::span), "alignment"),
        given(pattern.boundary.as_ref().map(Spanned::span), "boundary"),
    ];
    if let Some((span, key)) = clash.into_iter().flatten().next() {
        let help =
            format!("the mesh file says which pieces there are and where the sheet ends; leave {key} out");
        return Err(source.error(span, format!("{key} does not go with a mesh of pieces"), help));
    }
    let cuts = match &raw.target.cuts {
        None => Cuts::None,
        Some(cuts) if cuts.get_ref() == "automatic" => Cuts::Automatic,
        Some(cuts) => Cuts::File(mesh_path(source, cuts, folder)?),
    };
    Ok(Grid::Mesh(PatternFile { path: mesh_path(source, file, folder)?, reading, cuts }))
}

fn pieces(source: &TomlSource, raw: &Spanned<RawPattern>) -> Result<PieceSize, TomlError> {
    let help = "pieces = [30, 30] counts them, piece_mm = 10.0 gives their side";
    match (&raw.get_ref().pieces, &raw.get_ref().piece_mm) {
        (Some(_), Some(side)) => Err(source.error(side.span(), "pattern has both pieces and piece_mm", help)),
        (None, None) => Err(source.error(raw.span(), "pattern has neither pieces nor piece_mm", help)),
        (None, Some(side)) => Ok(PieceSize::Edge(source.number(side, &PIECE)?)),
        (Some(counts), None) => {
            let [x, y] = pair(source, counts)?;
            Ok(PieceSize::Counts([count(source, x)?, count(source, y)?]))
        }
    }
}

fn pair<'a, T>(source: &TomlSource, value: &'a Pair<T>) -> Result<[&'a Spanned<T>; 2], TomlError> {
    if let [first, second] = value.get_ref().as_slice() {
        return Ok([first, second]);
    }
    let values = match value.get_ref().len() {
        1 => "1 value".to_owned(),
        number => format!("{number} values"),
    };
    Err(source.value_error(
        value.span(),
        &format!("{values}: allowed are two"),
        "one for each direction of the sheet",
    ))
}

fn count(source: &TomlSource, value: &Spanned<i64>) -> Result<usize, TomlError> {
    // Beyond 2^53 the conversion rounds, far outside of the limits.
    let number = source.number(&Spanned::new(value.span(), *value.get_ref() as f64), &PIECES)?;
    Ok(number as usize)
}

/// The stretches, scaled onto 1/m1 + 1/m2 = sqrt 2; equal ones by default.
fn stretches(source: &TomlSource, value: Option<&Pair<f64>>) -> Result<[f64; 2], TomlError> {
    let Some(value) = value else { return Ok([SQRT_2, SQRT_2]) };
    let [first, second] = pair(source, value)?;
    let [m1, m2] = [source.number(first, &STRETCH)?, source.number(second, &STRETCH)?];
    let scale = (1.0 / m1 + 1.0 / m2) / SQRT_2;
    if (scale - 1.0).abs() <= STRETCH_TOLERANCE {
        return Ok([m1 * scale, m2 * scale]);
    }
    let what = format!(
        "no pair that rotating rectangles can reach: 1/m1 + 1/m2 = {:.4}, allowed is sqrt 2 = 1.4142 within 0.1 %",
        scale * SQRT_2
    );
    let fitting = (1.0 / (SQRT_2 - 1.0 / m1)).clamp(*STRETCH.range.start(), *STRETCH.range.end());
    Err(source.value_error(second.span(), &what, format!("with m1 = {m1} take m2 = {fitting:.4}")))
}

fn boundary(source: &TomlSource, value: Option<&Spanned<String>>) -> Result<Option<Boundary>, TomlError> {
    let words = [
        ("glide", Boundary::Glide),
        ("fixed-corners", Boundary::FixedCorners),
        ("trimmed", Boundary::Trimmed),
    ];
    choice(source, value, &words)
}

fn fabrication(source: &TomlSource, raw: &RawFabrication, folder: &Path) -> Result<Fabrication, JobError> {
    let dxf = dxf_version(source, raw)?;
    let mut profile = load_profile(source, &raw.profile, folder)?;
    check_process(source, raw, &profile)?;
    override_kerf(source, raw, &mut profile)?;
    override_sheet(source, raw, &mut profile)?;
    let cut = cut_options(source, raw, &profile)?;
    let machine = machine(source, raw, folder, &profile)?;
    if let Some(machine) = &machine {
        profile.cut.ruled &= machine.follows_axes();
    }
    Ok(Fabrication { profile, dxf, cut, machine })
}

pub(super) fn dxf_version(source: &TomlSource, raw: &RawFabrication) -> Result<DxfVersion, TomlError> {
    let versions = [("r2000", DxfVersion::R2000), ("r12", DxfVersion::R12)];
    Ok(choice(source, raw.dxf.as_ref(), &versions)?.unwrap_or_default())
}

fn load_profile(source: &TomlSource, name: &Spanned<String>, folder: &Path) -> Result<Profile, JobError> {
    profile::load(name.get_ref(), folder).map_err(|error| match error {
        ProfileError::UnknownName { known, .. } => {
            let help = format!("there are {}; or give the path of a TOML file", known.join(", "));
            source.value_error(name.span(), "not the name of a profile", help).into()
        }
        ProfileError::Toml(TomlError::Read { path, source: reason }) => {
            let what = format!("not readable as a profile: {reason}");
            let help = format!("looked at {}; paths are relative to the job file", path.display());
            source.value_error(name.span(), &what, help).into()
        }
        faulty => JobError::Profile { file: source.file.to_owned(), source: faulty },
    })
}

/// The sheet is the state that is "flat": the other one is a surface of its own. A job may say so.
fn check_sheet_state(source: &TomlSource, raw: &RawFabrication, target: &Target) -> Result<(), TomlError> {
    let words = [("closed", &target.closed), ("open", &target.open)];
    let Some(value) = &raw.sheet_state else { return Ok(()) };
    match choice(source, Some(value), &words)? {
        Some(Shape::Flat) | None => Ok(()),
        Some(_) => {
            let state = value.get_ref();
            let what = format!("not possible: {state} is not \"flat\" in this job's [target]");
            let help = format!(
                "the sheet is cut in the state that is \"flat\": {state} = \"flat\", or leave the key out"
            );
            Err(source.value_error(value.span(), &what, help))
        }
    }
}

/// A job may repeat what its profile says.
fn check_process(source: &TomlSource, raw: &RawFabrication, profile: &Profile) -> Result<(), TomlError> {
    let words = [("laser", Process::Laser), ("milling", Process::Milling)];
    let (Some(process), Some(value)) = (choice(source, raw.process.as_ref(), &words)?, &raw.process) else {
        return Ok(());
    };
    if process == profile.process {
        return Ok(());
    }
    let what = format!("not the process of the profile {}", profile.name);
    Err(source.value_error(value.span(), &what, "leave the key out, or take another profile"))
}

pub(super) fn override_kerf(
    source: &TomlSource,
    raw: &RawFabrication,
    profile: &mut Profile,
) -> Result<(), TomlError> {
    let Some(value) = &raw.kerf_mm else { return Ok(()) };
    if profile.process == Process::Milling {
        let radius = TOOL_RADIUS.range;
        let limits = Limits::new(2.0 * radius.start(), 2.0 * radius.end(), "mm", "the tool's diameter");
        profile.cut.kerf = source.number(value, &limits)?;
        return Ok(());
    }
    profile.cut.kerf = source.number(value, &KERF)?;
    if profile.cut.kerf > profile.cut.min_web {
        let what =
            format!("too large: allowed is at most the profile's min_web_mm = {}", profile.cut.min_web);
        return Err(source.value_error(
            value.span(),
            &what,
            "a web narrower than the groove beside it burns away",
        ));
    }
    Ok(())
}

pub(super) fn override_sheet(
    source: &TomlSource,
    raw: &RawFabrication,
    profile: &mut Profile,
) -> Result<(), TomlError> {
    let Some(value) = &raw.sheet_mm else { return Ok(()) };
    let [width, height] = pair(source, value)?;
    for side in [width, height] {
        let margins = 2.0 * profile.sheet.margin;
        if source.number(side, &SHEET_SIDE)? <= margins {
            let what = format!("too small: allowed is more than the profile's two margins, {margins} mm");
            return Err(source.value_error(side.span(), &what, "the margins leave nothing to cut"));
        }
    }
    [profile.sheet.width, profile.sheet.height] = [*width.get_ref(), *height.get_ref()];
    Ok(())
}

/// The meaning of one of a few words.
pub(super) fn choice<T: Copy>(
    source: &TomlSource,
    value: Option<&Spanned<String>>,
    words: &[(&str, T)],
) -> Result<Option<T>, TomlError> {
    let Some(value) = value else { return Ok(None) };
    if let Some((_, meaning)) = words.iter().find(|(word, _)| word == value.get_ref()) {
        return Ok(Some(*meaning));
    }
    let allowed: Vec<String> = words.iter().map(|(word, _)| format!("\"{word}\"")).collect();
    Err(source.value_error(value.span(), &format!("not known: allowed is {}", allowed.join(", ")), ""))
}
