//! Aligned remeshing: pieces whose sides follow the principal stretch directions of a map (section 4.3 names it
//! as future work).
//!
//! ```text
//! SurfaceMap ──> Principal ──> cross field ──> combed, cut open ──> coordinates ──> cells ──> Aligned
//!    map            map           field              comb            fit, seams    atlas, extract   pieces
//! ```
//!
//! Cells are squares (or the rectangles asked for) on the open surface, as far as lines that follow given
//! directions can be equally far apart. Where the directions turn around a place by a part of a circle, the field
//! is singular: there a piece has three or five corners. Around every inner corner four pieces meet, and
//! the pieces form a disk, so that they can always alternate.
//!
//! Knows meshes and grids, not kirigami.

use crate::geometry::Vector2;
use crate::geometry::topology::{Defect, NotADisk};

pub mod map;

mod links;

mod field;

mod comb;

mod seams;

mod least_squares;

mod fit;

mod atlas;

mod extract;

mod tidy;

mod pieces;

#[cfg(test)]
mod tests;

use comb::Combed;
use field::{Smoothness, Wishes};
use fit::{Grid, Sizes};
use links::Links;
pub use map::{Principal, SurfaceMap};
pub use pieces::{Aligned, Alignment, Piece, Side};

/// What the grid is to be like.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Sides of the open cell along the direction of the largest stretch and across it, millimetres.
    pub cell: [f64; 2],
    /// How the grid meets the outline.
    pub outline: Outline,
    /// Length over which directions are evened out, in mean cell sides. Detail that is smaller than a cell cannot be
    /// followed.
    pub smoothing: f64,
    /// Weight of the cells' sizes against their directions, above 0 and at most 1. Small values follow the directions
    /// and let the sizes vary; 1 weighs both alike.
    pub size_weight: f64,
    /// Whether pieces of three and five corners may appear.
    pub singular: Singular,
    /// Most pieces that are accepted.
    pub most_pieces: usize,
}

/// How the grid meets the outline.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outline {
    /// Grid lines lie on it. For outlines with four corners; others get singular pieces.
    Followed,
    /// Whole cells, without those that lie outside by more than a sixth.
    Trimmed,
}

/// What becomes of singular places of the field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Singular {
    /// Pieces of three or five corners.
    Pieces,
    /// The field is smoothed until there are none.
    Smoothed,
    /// An error that names them.
    Refused,
}

impl Options {
    /// Square cells of this side, millimetres, and what goes with them by default.
    pub fn square(side: f64) -> Self {
        Self {
            cell: [side; 2],
            outline: Outline::Trimmed,
            smoothing: 1.0,
            size_weight: 0.05,
            singular: Singular::Pieces,
            most_pieces: 1_000_000,
        }
    }
}

/// Why there is no aligned mesh. Indices count from 0, messages from 1.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RemeshError {
    /// The two meshes are not of one size.
    #[error(
        "the two meshes of the map must have the same triangles: the closed one has {} vertices and {} triangles, \
         the open one {} and {}; export both from the same mesh",
        .closed[0], .closed[1], .open[0], .open[1]
    )]
    Counts {
        /// Vertices and triangles.
        closed: [usize; 2],
        /// Vertices and triangles.
        open: [usize; 2],
    },
    /// A triangle differs.
    #[error(
        "the two meshes of the map must have the same triangles in the same order: triangle {} is {:?} in the closed \
         one and {:?} in the open one (vertices from 1)",
        .face + 1, .closed.map(|v| v + 1), .open.map(|v| v + 1)
    )]
    Differs {
        /// Which.
        face: usize,
        /// Its vertices.
        closed: [usize; 3],
        /// Its vertices.
        open: [usize; 3],
    },
    /// The meshes are no disk.
    #[error(transparent)]
    NotADisk(#[from] NotADisk),
    /// A triangle has no area.
    #[error("triangle {} of the {state} mesh has no area: a map needs triangles; remesh it there", .face + 1)]
    NoArea {
        /// Which.
        face: usize,
        /// "closed" or "open".
        state: &'static str,
    },
    /// A triangle is folded over.
    #[error(
        "the map folds: triangle {} of the {state} mesh lies on its neighbour; give a map without folds",
        .face + 1
    )]
    Folded {
        /// Which.
        face: usize,
        /// "closed" or "open".
        state: &'static str,
    },
    /// An option is out of range.
    #[error("{name} of the aligned mesh is {value}; it must be {allowed}")]
    Option {
        /// Which.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it may be.
        allowed: &'static str,
    },
    /// Triangles are too thin to compute with.
    #[error("the mesh is too uneven for an aligned grid: its triangles are too thin; remesh it more evenly")]
    Degenerate,
    /// The directions are singular where they may not be.
    #[error(
        "the stretch directions turn around {} ({}): no regular grid follows them; allow pieces of three and five \
         corners, or smoothing, or cut the target there",
        count(.places.len()), list(.places)
    )]
    Singular {
        /// Where: vertex, and quarters of a turn.
        places: Vec<(usize, i32)>,
    },
    /// The coordinates fold over.
    #[error(
        "no grid of this size follows the stretch directions: it folds over at {} triangles, first at triangle {}{}; \
         ask for smaller cells or more smoothing",
        .triangles.len(), .triangles[0] + 1, beside(.places)
    )]
    GridFolds {
        /// Where.
        triangles: Vec<usize>,
        /// Singular places: vertex, and quarters of a turn.
        places: Vec<(usize, i32)>,
    },
    /// Too few pieces.
    #[error(
        "the aligned mesh would have {pieces} pieces; at least 4 must fit on the target: ask for smaller cells"
    )]
    TooFew {
        /// Pieces that fit.
        pieces: usize,
    },
    /// Too many pieces.
    #[error("the aligned mesh would have about {pieces:.0} pieces, more than {limit}: ask for larger cells")]
    TooMany {
        /// Pieces asked for.
        pieces: f64,
        /// Most that are accepted.
        limit: usize,
    },
    /// The pieces do not form a disk.
    #[error(
        "the pieces of the aligned mesh do not form a disk ({0}): ask for smaller cells or more smoothing"
    )]
    PiecesNotADisk(Defect),
}

fn count(places: usize) -> String {
    if places == 1 { "one place".to_owned() } else { format!("{places} places") }
}

fn list(places: &[(usize, i32)]) -> String {
    let mut words: Vec<String> = places
        .iter()
        .take(5)
        .map(|(vertex, index)| format!("vertex {} by {}/4 of a turn", vertex + 1, index))
        .collect();
    if places.len() > words.len() {
        words.push(format!("{} more", places.len() - words.len()));
    }
    words.join(", ")
}

fn beside(places: &[(usize, i32)]) -> String {
    if places.is_empty() { String::new() } else { format!(" (the directions turn around {})", list(places)) }
}

/// Width of the skirt beyond the boundary that trimmed cells may reach into, in cells: the corner of a square that
/// loses a sixth of its area to a straight cut across lies 0.41 outside.
const TRIMMED_SKIRT: f64 = 0.42;

/// Width where the grid follows the boundary: room for rounding.
const FOLLOWED_SKIRT: f64 = 1e-3;

/// Weight of the boundary where it is followed: the field leaves it by less than a tenth of a degree.
const BOUNDARY: f64 = 1e4;

/// Smoothing length, in cells, that gives up the map's directions where the boundary is followed.
const GIVEN_UP: f64 = 1e5;

/// How often smoothing is doubled at most.
const DOUBLINGS: u32 = 6;

/// Lays a quad-dominant mesh over the open surface of a map, its edges along the principal stretch directions.
///
/// # Errors
/// See [`RemeshError`].
pub fn align(map: &SurfaceMap, options: &Options) -> Result<Aligned, RemeshError> {
    check(map, options)?;
    let links = Links::new(map.open());
    let principal = map.principal();
    let side = (options.cell[0] * options.cell[1]).sqrt();
    let smoothness = Smoothness::new(&links, &principal);
    let doublings = if options.singular == Singular::Refused { 0 } else { DOUBLINGS };
    let mut smoothings: Vec<f64> = (0..=doublings).map(|k| options.smoothing * f64::from(1 << k)).collect();
    if options.singular == Singular::Smoothed {
        smoothings.push(f64::INFINITY);
    }
    let mut failed = None;
    for smoothing in smoothings {
        let length = smoothing.min(GIVEN_UP);
        let crosses = match options.outline {
            // The boundary's weight against the field's smoothness stays the same.
            Outline::Followed => {
                smoothness.field(Wishes { length: length * side, boundary: BOUNDARY * length * length })
            }
            Outline::Trimmed if smoothing.is_infinite() => smoothness.smoothest(),
            Outline::Trimmed => {
                smoothness.field(Wishes { length: length * side, boundary: field::FAINT_BOUNDARY })
            }
        };
        let crosses = crosses.ok_or(RemeshError::Degenerate)?;
        let combed = comb::comb(map.open(), &links, &crosses, map.boundary());
        match attempt(map, &links, &principal, &combed, options) {
            Ok(aligned) => return Ok(Aligned { smoothing, ..aligned }),
            Err(error @ (RemeshError::Degenerate | RemeshError::TooFew { .. })) => return Err(error),
            Err(error) => _ = failed.get_or_insert(error),
        }
    }
    Err(failed.expect("a failed attempt"))
}

fn check(map: &SurfaceMap, options: &Options) -> Result<(), RemeshError> {
    let bad = |name, value, allowed| Err(RemeshError::Option { name, value, allowed });
    if let Some(&side) = options.cell.iter().find(|side| !(side.is_finite() && **side > 0.0)) {
        return bad("the cell's side", side, "above 0");
    }
    if !(options.smoothing.is_finite() && options.smoothing > 0.0) {
        return bad("smoothing", options.smoothing, "above 0");
    }
    if !(options.size_weight > 0.0 && options.size_weight <= 1.0) {
        return bad("the weight of sizes", options.size_weight, "above 0 and at most 1");
    }
    let pieces = map.area() / (options.cell[0] * options.cell[1]);
    if pieces > options.most_pieces as f64 {
        return Err(RemeshError::TooMany { pieces, limit: options.most_pieces });
    }
    Ok(())
}

fn attempt(
    map: &SurfaceMap,
    links: &Links,
    principal: &[Principal],
    combed: &Combed,
    options: &Options,
) -> Result<Aligned, RemeshError> {
    let places = combed.singular.clone();
    // Two corners make no piece, and seven are more than any pattern has use for.
    let impossible = places.iter().any(|(_, index)| !(-2..=1).contains(index));
    if impossible || (options.singular != Singular::Pieces && !places.is_empty()) {
        return Err(RemeshError::Singular { places });
    }
    let followed = options.outline == Outline::Followed;
    let sizes = Sizes { cell: options.cell, length_weight: options.size_weight, boundary: followed };
    let grid = fit::fit(map.open(), links, combed, principal, sizes).ok_or(RemeshError::Degenerate)?;
    if !grid.folded.is_empty() {
        return Err(RemeshError::GridFolds { triangles: grid.folded, places });
    }
    let skirt = if followed { FOLLOWED_SKIRT } else { TRIMMED_SKIRT };
    let free = !followed && places.is_empty();
    let shifts = if free { centred(&grid) } else { vec![Vector2::zeros()] };
    let mut best: Option<Aligned> = None;
    let mut last = RemeshError::TooFew { pieces: 0 };
    for shift in shifts {
        let atlas = atlas::Atlas::new(map, links, combed, &grid, skirt, shift);
        let source = pieces::Source { map, principal, atlas: &atlas };
        match pieces::pieces(&source, !followed) {
            Ok(found) if best.as_ref().is_none_or(|best| found.covered > best.covered * (1.0 + 1e-9)) => {
                best = Some(found);
            }
            Ok(_) => (),
            Err(error) => last = error,
        }
    }
    best.ok_or(last)
}

/// The four shifts that put a corner or the middle of a cell, in either direction, in the middle of a grid.
fn centred(grid: &Grid) -> Vec<Vector2> {
    let points = || grid.uv.iter().flatten();
    let low = points().fold(Vector2::repeat(f64::INFINITY), |low, p| low.inf(p));
    let high = points().fold(Vector2::repeat(f64::NEG_INFINITY), |high, p| high.sup(p));
    let middle = (low + high) * 0.5;
    [[0.0, 0.0], [0.5, 0.5], [0.5, 0.0], [0.0, 0.5]].map(|[x, y]| Vector2::new(x, y) - middle).to_vec()
}
