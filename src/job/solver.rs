//! The `[solver]` table: weights of the optimisation's terms, for those who know what they do.

use serde::Deserialize;
use toml::Spanned;

use crate::kirigami::bistable::optimise;
use crate::kirigami::pattern::Opening;
use crate::kirigami::{stage2, stage3};
use crate::toml_source::{Limits, TomlError, TomlSource};

/// Weights of the two optimised stages; keys left out keep their defaults.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Solver {
    /// `[solver.stage-2]`
    pub stage2: stage2::Weights,
    /// `[solver.stage-3]` of rotating pieces.
    pub stage3: stage3::Weights,
    /// `[solver.stage-3]` of bistable sheets.
    pub bistable: optimise::Weights,
}

impl Solver {
    /// The defaults. Where the opening varies there is no constant mean stretch to ask for, and the paper leaves out
    /// fairness: it would make openings alike. Bistable cells may differ, so that Stage 2 keeps them even rather than equal:
    /// with the weights of rotating pieces cells in the middle of a dome would shrink to nothing.
    pub fn of(opening: Opening, bistable: bool) -> Self {
        let mut solver = Self::default();
        if bistable {
            solver.stage2 = stage2::Weights { geom: 0.01, fair: 0.01, ..solver.stage2 };
        }
        if opening == Opening::Variable {
            solver.stage2.geom = 0.0;
            solver.stage3 = stage3::Weights { fair: 0.0, opening: 0.0, sides: 0.0, ..solver.stage3 };
        }
        solver
    }
}

const WEIGHT: Limits = Limits::new(
    0.0,
    1.0e6,
    "",
    "a weight is a factor of squares at mean edge 1, beside 1 for the conditions that must hold; beyond a million \
     rounding drowns those",
);

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct RawSolver {
    #[serde(rename = "stage-2", default)]
    stage2: RawStage2,
    #[serde(rename = "stage-3", default)]
    stage3: RawStage3,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct RawStage2 {
    orth: Option<Spanned<f64>>,
    geom: Option<Spanned<f64>>,
    prox: Option<Spanned<f64>>,
    boundary: Option<Spanned<f64>>,
    corners: Option<Spanned<f64>>,
    fair: Option<Spanned<f64>>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct RawStage3 {
    prox: Option<Spanned<f64>>,
    boundary: Option<Spanned<f64>>,
    corners: Option<Spanned<f64>>,
    fair: Option<Spanned<f64>>,
    opening: Option<Spanned<f64>>,
    rectangles: Option<Spanned<f64>>,
    sides: Option<Spanned<f64>>,
    widths: Option<Spanned<f64>>,
    shape: Option<Spanned<f64>>,
}

type Entry<'a> = (&'static str, &'a mut f64, &'a Option<Spanned<f64>>);

/// The weights with the file's in place of the defaults.
pub(super) fn solver(
    source: &TomlSource,
    raw: &RawSolver,
    opening: Opening,
    bistable: bool,
) -> Result<Solver, TomlError> {
    let mut solver = Solver::of(opening, bistable);
    let (weights2, weights3, snapping) = (&mut solver.stage2, &mut solver.stage3, &mut solver.bistable);
    let (raw2, raw3) = (&raw.stage2, &raw.stage3);
    let common: [Entry; 6] = [
        ("orth", &mut weights2.orth, &raw2.orth),
        ("geom", &mut weights2.geom, &raw2.geom),
        ("prox", &mut weights2.prox, &raw2.prox),
        ("boundary", &mut weights2.boundary, &raw2.boundary),
        ("corners", &mut weights2.corners, &raw2.corners),
        ("fair", &mut weights2.fair, &raw2.fair),
    ];
    let rotating: [Entry; 5] = [
        ("fair", &mut weights3.fair, &raw3.fair),
        ("opening", &mut weights3.opening, &raw3.opening),
        ("rectangles", &mut weights3.rectangles, &raw3.rectangles),
        ("sides", &mut weights3.sides, &raw3.sides),
        ("widths", &mut weights3.widths, &raw3.widths),
    ];
    let shape: [Entry; 1] = [("shape", &mut snapping.shape, &raw3.shape)];
    let of_both: [Entry; 3] = if bistable {
        [
            ("prox", &mut snapping.prox, &raw3.prox),
            ("boundary", &mut snapping.boundary, &raw3.boundary),
            ("corners", &mut snapping.corners, &raw3.corners),
        ]
    } else {
        [
            ("prox", &mut weights3.prox, &raw3.prox),
            ("boundary", &mut weights3.boundary, &raw3.boundary),
            ("corners", &mut weights3.corners, &raw3.corners),
        ]
    };
    let foreign: &[Entry] = if bistable { &rotating } else { &shape };
    if let Some((key, _, Some(value))) = foreign.iter().find(|(_, _, value)| value.is_some()) {
        let help = "bistable sheets have prox, boundary, corners and shape, rotating pieces all but shape";
        return Err(source.error(
            value.span(),
            format!("{key} is no weight of this pattern's stage 3"),
            help,
        ));
    }
    for (_, weight, value) in common.into_iter().chain(rotating).chain(shape).chain(of_both) {
        if let Some(value) = source.optional(value.as_ref(), &WEIGHT)? {
            *weight = value;
        }
    }
    Ok(solver)
}
