//! The keys of bistable patterns: the proportions of the model cell, checked against inequalities (3).

use toml::Spanned;

use super::pattern::RawPattern;
use super::{Shape, Target};
use crate::kirigami::bistable::cell::{BistableCell, Miss};
use crate::toml_source::{Limits, TomlError, TomlSource};

const SIDE: Limits =
    Limits::new(1e-3, 1e3, "", "a proportion of the cell; its size comes from pieces or piece_mm");
const PHI: Limits =
    Limits::new(1.0, 44.0, "deg", "at 45 degrees or more no rectangle is left, at 0 nothing snaps");

/// The cell that takes the place of what a job leaves out: DESIGN 2.3.
const DEFAULT: ([f64; 2], [f64; 2], f64) = ([1.0, 1.0], [0.42, 0.42], 18.0);

/// Reads the cell of a bistable pattern, and refuses what does not go with one.
pub(super) fn bistable(
    source: &TomlSource,
    raw: &RawPattern,
    target: &Target,
) -> Result<BistableCell, TomlError> {
    let given = |span: Option<std::ops::Range<usize>>, key| span.map(|span| (span, key));
    let clashes = [
        given(raw.stretches.as_ref().map(Spanned::span), "stretches"),
        given(raw.opening.as_ref().map(Spanned::span), "opening"),
        given(raw.alignment.as_ref().map(Spanned::span), "alignment"),
        given(raw.control_mesh.as_ref().map(Spanned::span), "control_mesh"),
        given(raw.piece_mesh.as_ref().map(Spanned::span), "piece_mesh"),
    ];
    if let Some((span, key)) = clashes.into_iter().flatten().next() {
        let help = "bistable sheets have regular grids whose stretches follow from a, b, A, B and phi_deg";
        return Err(source.error(span, format!("{key} does not go with kind = \"bistable\""), help));
    }
    if target.open == Shape::Free {
        let help = "both states of a bistable sheet need a target: \"flat\" or a mesh file";
        return Err(source.value_error(raw.kind.span(), "not possible with open = \"free\"", help));
    }
    let side = |value: &Option<Spanned<f64>>, default| {
        Ok(source.optional(value.as_ref(), &SIDE)?.unwrap_or(default))
    };
    let (cell, rectangle, phi) = DEFAULT;
    let cell = BistableCell {
        cell: [side(&raw.cell_a, cell[0])?, side(&raw.cell_b, cell[1])?],
        rectangle: [side(&raw.side_a, rectangle[0])?, side(&raw.side_b, rectangle[1])?],
        phi: source.optional(raw.phi_deg.as_ref(), &PHI)?.unwrap_or(phi).to_radians(),
        gap: 0.0,
    };
    match cell.misses().first() {
        None => Ok(cell),
        Some(miss) => Err(misses(source, raw, &cell, miss)),
    }
}

/// Refuses the keys of bistable cells in other patterns.
pub(super) fn only_bistable(source: &TomlSource, raw: &RawPattern) -> Result<(), TomlError> {
    let keys = [
        (&raw.cell_a, "A"),
        (&raw.cell_b, "B"),
        (&raw.side_a, "a"),
        (&raw.side_b, "b"),
        (&raw.phi_deg, "phi_deg"),
    ];
    match keys.into_iter().find_map(|(value, key)| Some((value.as_ref()?.span(), key))) {
        None => Ok(()),
        Some((span, key)) => {
            let what = format!("{key} does not go with kind = \"rotating-rectangles\"");
            Err(source.error(
                span,
                what,
                "it is a dimension of bistable cells: kind = \"bistable\", or leave it out",
            ))
        }
    }
}

/// Inequality (3) that does not hold: which side misses which edge, by how much, and what would fit.
fn misses(source: &TomlSource, raw: &RawPattern, cell: &BistableCell, miss: &Miss) -> TomlError {
    let (long, other) = (("a", "left and right"), ("b", "top and bottom"));
    let ((side, edges), (limited, _)) = if miss.side == 0 { (long, other) } else { (other, long) };
    let key = [&raw.side_a, &raw.side_b][1 - miss.side];
    let span = key.as_ref().or(raw.phi_deg.as_ref()).map_or(raw.kind.span(), Spanned::span);
    let what = format!(
        "inequality (3) does not hold: the rectangle's sides {side}, prolonged, miss the cell's {edges} edges by {:.4}",
        miss.beyond
    );
    let fitting = |phi: f64| BistableCell { phi: phi.to_radians(), ..*cell }.misses().is_empty();
    let smaller = (10..440)
        .rev()
        .map(|tenths| f64::from(tenths) / 10.0)
        .find(|&phi| phi < cell.phi.to_degrees() && fitting(phi));
    let angle = smaller.map_or(String::new(), |phi| format!(", or phi_deg = {phi:.1}"));
    let size = if miss.bound > 0.0 {
        format!(
            "{limited} must be less than {:.4}: for example {limited} = {:.3}{angle}",
            miss.bound,
            0.9 * miss.bound
        )
    } else {
        format!("no {limited} fits this phi_deg{angle}")
    };
    source.error(span, what, size)
}
