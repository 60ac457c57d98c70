//! The keys of `[pattern]`: which pieces there are, and how they open.

use std::f64::consts::SQRT_2;
use std::ops::Range;
use std::path::Path;

use serde::Deserialize;
use toml::Spanned;

use super::bistable::{bistable, only_bistable};
use super::read::mesh_path;
use super::{Boundary, Cuts, Grid, Kind, Opening, Pattern, PatternFile, PieceSize, Reading, Shape, Target};
use crate::toml_source::{Limits, Pair, TomlError, TomlSource};

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

/// The pattern of a job; `hinge_gap` is what the profile's ligaments ask for, millimetres.
pub(super) fn pattern(
    source: &TomlSource,
    raw: &Spanned<RawPattern>,
    cuts: Option<&Spanned<String>>,
    target: &Target,
    folder: &Path,
    hinge_gap: f64,
) -> Result<Pattern, TomlError> {
    let keys = raw.get_ref();
    let kind = kind(source, keys, target)?;
    let grid = grid(source, raw, cuts, folder)?;
    let stretches = match &kind {
        Kind::RotatingRectangles => stretches(source, keys.stretches.as_ref())?,
        Kind::Bistable(cell) => cell.stretches(),
    };
    let boundary = boundary(source, keys.boundary.as_ref())?;
    let opening = opening(source, keys, target)?;
    let gap = source.optional(keys.gap_mm.as_ref(), &GAP)?.unwrap_or(hinge_gap);
    Ok(Pattern { kind, grid, stretches, opening, boundary, gap })
}

fn kind(source: &TomlSource, raw: &RawPattern, target: &Target) -> Result<Kind, TomlError> {
    let words = [("rotating-rectangles", false), ("bistable", true)];
    if source.word(&raw.kind, &words, "")? {
        return Ok(Kind::Bistable(bistable(source, raw, target)?));
    }
    only_bistable(source, raw)?;
    Ok(Kind::RotatingRectangles)
}

fn opening(source: &TomlSource, raw: &RawPattern, target: &Target) -> Result<Opening, TomlError> {
    let words = [("full", Opening::Full), ("variable", Opening::Variable)];
    let Some(value) = &raw.opening else { return Ok(Opening::Full) };
    let opening = source.word(value, &words, "")?;
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
fn grid(
    source: &TomlSource,
    raw: &Spanned<RawPattern>,
    cuts: Option<&Spanned<String>>,
    folder: &Path,
) -> Result<Grid, TomlError> {
    let pattern = raw.get_ref();
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
            if let Some(cuts) = cuts {
                let help = "cuts run between the pieces of a mesh of your own: add [pattern] control_mesh or piece_mesh";
                return Err(source.error(cuts.span(), "cuts need control_mesh or piece_mesh", help));
            }
            let size = pieces(source, raw)?;
            let aligned =
                source.optional_word(pattern.alignment.as_ref(), &[("grid", false), ("principal", true)])?;
            return Ok(if aligned == Some(true) { Grid::Aligned(size) } else { Grid::Regular(size) });
        }
    };
    let given = |span: Option<Range<usize>>, key: &'static str| span.map(|span| (span, key));
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
    let cuts = match cuts {
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
            let [x, y] = source.pair(counts)?;
            Ok(PieceSize::Counts([source.count(x, &PIECES)?, source.count(y, &PIECES)?]))
        }
    }
}

/// The stretches, scaled onto 1/m1 + 1/m2 = sqrt 2; equal ones by default.
fn stretches(source: &TomlSource, value: Option<&Pair<f64>>) -> Result<[f64; 2], TomlError> {
    let Some(value) = value else { return Ok([SQRT_2, SQRT_2]) };
    let [first, second] = source.pair(value)?;
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
    source.optional_word(value, &words)
}
