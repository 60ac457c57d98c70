//! Covers a flattened target with the pattern's grid of square open cells.
//!
//! Where the outline has four corners and opposite sides of similar length, the grid follows the outline: its
//! four sides lie on the four sides of the target. Otherwise a straight grid covers the outline's smallest
//! bounding rectangle, and cells that lie outside by more than a sixth are left away. The user may choose
//! otherwise ([`Boundary`]).

use super::corners::{SIDE_RATIO, four_corners};
use super::piece_mesh::PieceMesh;
use crate::geometry::{Point2, Vector2};

mod frame;

#[cfg(test)]
mod tests;

mod trimmed;

use frame::Frame;

pub use frame::stretched;
use trimmed::trimmed;

/// What the user asks of the grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PieceSize {
    /// Number of cells along the two sides of the flattening's bounding rectangle.
    Counts([usize; 2]),
    /// Mean side of a closed piece, millimetres.
    Edge(f64),
}

/// How the pattern meets the target's outline.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Boundary {
    /// The grid's four sides lie on the outline's four sides and glide along them.
    Glide,
    /// As [`Boundary::Glide`], and the sheet's four corners stay on the outline's four corners.
    FixedCorners,
    /// A straight grid of whole cells, whatever the outline.
    Trimmed,
}

impl PieceSize {
    /// Pieces twice as large.
    pub fn coarser(self) -> Self {
        match self {
            Self::Counts(counts) => Self::Counts(counts.map(|n| n.div_ceil(2))),
            Self::Edge(edge) => Self::Edge(2.0 * edge),
        }
    }
}

/// Dimensions of the model cell (section 2.1), with the gap between hinge points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModelCell {
    /// Sides of the open cell: w and w, for rotating pieces.
    pub open: [f64; 2],
    /// Sides of the closed cell: a = w / m1 + gap / 2 and b = w / m2 + gap / 2.
    pub closed: [f64; 2],
}

impl ModelCell {
    /// The model cell with open side `open`, open-state stretches `m1`, `m2` and a gap.
    pub fn from_open(open: f64, stretches: [f64; 2], gap: f64) -> Self {
        Self { open: [open; 2], closed: stretches.map(|m| open / m + gap / 2.0) }
    }

    /// The model cell whose closed sides have this mean. With 1/m1 + 1/m2 = sqrt 2 the mean is
    /// w / sqrt 2 + gap / 2.
    pub fn from_edge(edge: f64, stretches: [f64; 2], gap: f64) -> Self {
        let mean_ratio = stretches.iter().map(|m| 0.5 / m).sum::<f64>();
        Self::from_open((edge - gap / 2.0) / mean_ratio, stretches, gap)
    }

    /// The open cell's sides over the closed one's.
    pub fn stretches(&self) -> [f64; 2] {
        [0, 1].map(|i| self.open[i] / self.closed[i])
    }

    /// Mean side of the closed cell: the asked edge length.
    pub fn edge(&self) -> f64 {
        0.5 * (self.closed[0] + self.closed[1])
    }
}

/// A grid laid over a flattened target.
#[derive(Debug, Clone)]
pub struct Cover {
    /// Which cells there are and how they connect.
    pub mesh: PieceMesh,
    /// Place of each corner on the grid: (column, row).
    pub places: Vec<[f64; 2]>,
    /// Each corner in the plane of the flattening.
    pub corners: Vec<Point2>,
    /// Each piece's centre in the plane of the flattening.
    pub centres: Vec<Point2>,
    /// Dimensions of a cell.
    pub cell: ModelCell,
    /// Mean side of the closed pieces that is asked for, millimetres: of the cell where all pieces are cells.
    pub asked_edge: f64,
    /// How the grid meets the outline.
    pub boundary: Boundary,
    /// The fixed corners, each with the index of its point of the outline; none where corners are free.
    pub tips: Vec<(usize, usize)>,
}

/// Why no grid can be laid.
#[derive(Debug, Clone, thiserror::Error)]
pub enum CoverError {
    /// The outline is not what the asked boundary needs.
    #[error(
        "the target's outline does not have four corners with opposite sides of similar length (within {:.0} %), \
         which boundary = \"{asked}\" needs: leave [pattern] boundary out, or say \"trimmed\"",
        100.0 * (SIDE_RATIO - 1.0)
    )]
    NotFourCorners {
        /// The word in the job file.
        asked: &'static str,
    },
    /// Too few pieces.
    #[error(
        "the pattern would have {pieces} pieces; at least 2 x 2 must fit on the target: ask for more or smaller pieces"
    )]
    TooFew {
        /// Pieces that fit.
        pieces: usize,
    },
    /// Too many pieces.
    #[error("the pattern would have about {pieces:.0} pieces, more than {limit}: ask for larger pieces")]
    TooMany {
        /// Pieces asked for.
        pieces: f64,
        /// Most that are accepted.
        limit: usize,
    },
    /// The gap eats the cell.
    #[error(
        "bistable cells of {:.2} x {:.2} mm are too small for slits that pass hinges {:.3} mm away (half of ligament plus kerf): \
         cells of at least {:.2} x {:.2} mm are needed; ask for larger ones, scale the target up, or choose a smaller phi_deg, \
         a or b", .cell[0], .cell[1], .gap / 2.0, .least[0], .least[1]
    )]
    CellTooSmall {
        /// Sides A and B.
        cell: [f64; 2],
        /// Twice the distance of a hinge from the slit that passes it.
        gap: f64,
        /// Least sides A and B.
        least: [f64; 2],
    },
    /// The gap eats the piece.
    #[error(
        "pieces with sides of {edge:.3} mm are too small for hinges that stand {gap:.3} mm apart (ligament plus kerf): sides of at least {least:.3} mm are needed; ask for larger pieces or scale the target up{}",
        if *edge < 0.25 * least { OTHER_UNITS } else { "" }
    )]
    GapTooWide {
        /// Mean side of a closed piece.
        edge: f64,
        /// Gap between the hinge points of a corner.
        gap: f64,
        /// Least mean side.
        least: f64,
    },
}

/// What may be wrong with a target whose size is far off.
pub(crate) const OTHER_UNITS: &str =
    "; a mesh is taken to be in millimetres unless the job's [target] says units or size_mm";

/// Most pieces that are accepted.
pub const MOST_PIECES: usize = 1_000_000;

/// A piece side must be at least this many gaps long: the hinge polygon then keeps three quarters of its
/// side.
const LEAST_SIDE_IN_GAPS: f64 = 4.0;

fn check_gap(cell: &ModelCell, gap: f64) -> Result<(), CoverError> {
    let least = LEAST_SIDE_IN_GAPS * gap;
    if cell.open.iter().any(|&side| side <= 0.0) || cell.closed.iter().any(|&side| side < least) {
        return Err(CoverError::GapTooWide { edge: cell.edge(), gap, least });
    }
    Ok(())
}

impl Cover {
    /// Checks that the closed cells have room for a gap between the hinge points of their corners.
    ///
    /// # Errors
    /// [`CoverError::GapTooWide`].
    pub fn check_gap(&self, gap: f64) -> Result<(), CoverError> {
        check_gap(&self.cell, gap)
    }
}

/// Of the four directions of an outline's smallest bounding rectangle the one that comes nearest to `first`.
pub fn grid_axis(outline: &[Point2], first: &Vector2) -> Vector2 {
    Frame::smallest_rectangle(outline, first).axis
}

/// Lays the grid. `outline` is the flattened boundary, counter-clockwise; `first` the direction in the plane
/// that the grid's first axis should come nearest to; `boundary` the asked boundary, `None` for the one that fits
/// the outline: gliding where it has four corners, else trimmed.
///
/// # Errors
/// [`CoverError`] where too few or too many pieces fit, the pieces are too small for the gap, or the outline is not
/// what the asked boundary needs.
pub fn cover(
    outline: &[Point2],
    first: &Vector2,
    size: PieceSize,
    stretches: [f64; 2],
    gap: f64,
    boundary: Option<Boundary>,
) -> Result<Cover, CoverError> {
    let frame = Frame::smallest_rectangle(outline, first);
    let open = match size {
        PieceSize::Counts([nx, ny]) => (frame.size.x / nx as f64).max(frame.size.y / ny as f64),
        PieceSize::Edge(edge) => ModelCell::from_edge(edge, stretches, gap).open[0],
    };
    let cell = ModelCell::from_open(open, stretches, gap);
    check_gap(&cell, gap)?;
    let wanted = frame.size.x * frame.size.y / (open * open);
    if wanted > MOST_PIECES as f64 {
        return Err(CoverError::TooMany { pieces: wanted, limit: MOST_PIECES });
    }
    let sides = match boundary {
        Some(Boundary::Trimmed) => None,
        _ => four_corners(outline, &frame.axis),
    };
    let cover = match (sides, boundary) {
        (Some(sides), _) => {
            let counts = fitted_counts(&sides, size, open, area(outline));
            let cells = f64::from(counts[0] * counts[1]);
            let cell = match size {
                PieceSize::Counts(_) => ModelCell::from_open((area(outline) / cells).sqrt(), stretches, gap),
                PieceSize::Edge(_) => cell,
            };
            let boundary = boundary.unwrap_or(Boundary::Glide);
            let mut cover = fitted(&sides, counts, cell, boundary);
            if boundary == Boundary::FixedCorners {
                cover.tips = tips(&cover.places, counts, &sides, outline);
            }
            cover
        }
        (None, Some(Boundary::Glide)) => return Err(CoverError::NotFourCorners { asked: "glide" }),
        (None, Some(Boundary::FixedCorners)) => {
            return Err(CoverError::NotFourCorners { asked: "fixed-corners" });
        }
        (None, _) => trimmed(outline, &frame, cell),
    };
    let pieces = cover.mesh.pieces.len();
    if pieces < 4 { Err(CoverError::TooFew { pieces }) } else { Ok(cover) }
}

/// Cells along the two directions of a grid that follows the outline: what the user asked for, unless cells
/// would then be far from square; else as many as make their mean area that of the wanted cell.
fn fitted_counts(sides: &[Vec<Point2>; 4], size: PieceSize, open: f64, area: f64) -> [i32; 2] {
    let lengths = [0, 1].map(|i| 0.5 * (length(&sides[i]) + length(&sides[i + 2])));
    if let PieceSize::Counts([nx, ny]) = size {
        let aspect = (lengths[0] / nx as f64) / (lengths[1] / ny as f64);
        if aspect.ln().abs() < MOST_ASPECT.ln() {
            return [nx as i32, ny as i32];
        }
    }
    let bulge = (area / (lengths[0] * lengths[1])).sqrt();
    lengths.map(|length| ((bulge * length / open).round() as i32).max(2))
}

/// Asked counts are taken as they are if the cells' sides then differ by less than this factor.
const MOST_ASPECT: f64 = 1.15;

/// A grid whose sides follow the four sides of the outline: a Coons patch over equal divisions of the sides.
fn fitted(sides: &[Vec<Point2>; 4], [nx, ny]: [i32; 2], cell: ModelCell, boundary: Boundary) -> Cover {
    let cells: Vec<[i32; 2]> = (0..ny).flat_map(|j| (0..nx).map(move |i| [i, j])).collect();
    let patch = |x: f64, y: f64| {
        let (s, t) = (x / f64::from(nx), y / f64::from(ny));
        let bottom = along(&sides[0], s).coords;
        let right = along(&sides[1], t).coords;
        let top = along(&sides[2], 1.0 - s).coords;
        let left = along(&sides[3], 1.0 - t).coords;
        let [c00, c10, c11, c01] = sides.each_ref().map(|side| side[0].coords);
        let bilinear = (c00 * (1.0 - s) + c10 * s) * (1.0 - t) + (c01 * (1.0 - s) + c11 * s) * t;
        Point2::from(bottom * (1.0 - t) + top * t + left * (1.0 - s) + right * s - bilinear)
    };
    build(&cells, patch, cell, boundary)
}

/// The four corners of a grid that follows the outline, each with its point of the outline: the start of a side.
fn tips(
    places: &[[f64; 2]],
    counts: [i32; 2],
    sides: &[Vec<Point2>; 4],
    outline: &[Point2],
) -> Vec<(usize, usize)> {
    let [nx, ny] = counts.map(f64::from);
    let ends = [[0.0, 0.0], [nx, 0.0], [nx, ny], [0.0, ny]];
    let pair = |(end, side): (&[f64; 2], &Vec<Point2>)| {
        let corner = places.iter().position(|place| place == end)?;
        Some((corner, outline.iter().position(|p| *p == side[0])?))
    };
    ends.iter().zip(sides).filter_map(pair).collect()
}

fn build(cells: &[[i32; 2]], at: impl Fn(f64, f64) -> Point2, cell: ModelCell, boundary: Boundary) -> Cover {
    let (mesh, positions) = PieceMesh::from_cells(cells);
    let corners = positions.iter().map(|&[i, j]| at(f64::from(i), f64::from(j))).collect();
    let centres = cells.iter().map(|&[i, j]| at(f64::from(i) + 0.5, f64::from(j) + 0.5)).collect();
    let places = positions.iter().map(|place| place.map(f64::from)).collect();
    Cover { mesh, places, corners, centres, cell, asked_edge: cell.edge(), boundary, tips: Vec::new() }
}

fn length(line: &[Point2]) -> f64 {
    line.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum()
}

/// The point of a polyline at a fraction of its length.
fn along(line: &[Point2], fraction: f64) -> Point2 {
    let mut left = fraction.clamp(0.0, 1.0) * length(line);
    for pair in line.windows(2) {
        let step = (pair[1] - pair[0]).norm();
        if left <= step {
            return pair[0] + (pair[1] - pair[0]) * (left / step.max(f64::MIN_POSITIVE));
        }
        left -= step;
    }
    line[line.len() - 1]
}

/// Area of a counter-clockwise polygon.
fn area(polygon: &[Point2]) -> f64 {
    let n = polygon.len();
    (0..n).map(|i| 0.5 * polygon[i].coords.perp(&polygon[(i + 1) % n].coords)).sum()
}
