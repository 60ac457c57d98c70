//! The job file as a whole and its targets: the keys, the range of each number with the reason, and what is refused in
//! words.

use std::path::{Path, PathBuf};

use serde::Deserialize;
use toml::Spanned;

use super::fabrication::{RawFabrication, check_sheet_state, fabrication};
use super::guide::{RawGuide, guides};
use super::pattern::{RawPattern, pattern};
use super::solver::{RawSolver, solver};
use super::{Job, JobError, Kind, Shape, Target, Units};
use crate::toml_source::{Limits, TomlError, TomlSource};

const SIZE: Limits =
    Limits::new(1.0, 10_000.0, "mm", "the largest extent of the target: a coin to a roof panel");

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

/// Reads and checks the text of a job file that lies in `folder`; `file` stands in messages.
pub(super) fn parse(text: &str, file: &str, folder: PathBuf) -> Result<Job, JobError> {
    let source = TomlSource { file, text };
    let raw: RawJob = source.parse()?;
    let target = target(&source, &raw.target, &folder)?;
    let guides = guides(&source, &raw.guide, &target, &folder)?;
    // Before the pattern, whose gap follows from the profile.
    let fabrication = fabrication(&source, &raw.fabrication, &folder)?;
    let hinge_gap = fabrication.profile.hinge_gap();
    let pattern = pattern(&source, &raw.pattern, raw.target.cuts.as_ref(), &target, &folder, hinge_gap)?;
    check_sheet_state(&source, &raw.fabrication, &target)?;
    let solver = solver(&source, &raw.solver, pattern.opening, pattern.kind != Kind::RotatingRectangles)?;
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
    let words =
        [("mm", Units::Millimetres), ("cm", Units::Centimetres), ("m", Units::Metres), ("in", Units::Inches)];
    let units = source.optional_word(raw.units.as_ref(), &words)?;
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
