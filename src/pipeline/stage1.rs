//! Stage 1: from the targets to grids, and where both states begin.
//!
//! Every grid is laid over a part of the plane. What part, and how the two states come from there, is all that tells the
//! cases apart:
//!
//! | closed | open | the grid lies over | closed state | open state |
//! | :-- | :-- | :-- | :-- | :-- |
//! | flat | mesh | the open target laid flat | regular grid | lifted into the target |
//! | mesh | flat | the closed target laid flat, stretched to the open size | lifted | regular grid |
//! | mesh | free | likewise | lifted | the closed target, enlarged |
//! | mesh | mesh | the open target laid flat | lifted into the closed target laid flat likewise | lifted |
//! | any, variable opening | mesh | the closed sheet | as it is, or lifted | lifted |

use super::aims::{Aim, Aims, Outline, surface};
use super::error::PipelineError;
use super::meshed::{aligned, from_file};
use super::surfaces::{LaidFlat, TargetMesh, Targets, first_axis};
use crate::geometry::flatten::{Flattening, conformal_points};
use crate::geometry::mesh::TriMesh;
use crate::geometry::{Point2, Vector2};
use crate::job::{Grid, Job, Kind, Opening, Shape};
use crate::kirigami::bistable::grid::cover_cells;
use crate::kirigami::control_mesh::{Layout, Layouts, LinearMap};
use crate::kirigami::cover::{Cover, CoverError, ModelCell, PieceSize, cover, grid_axis, stretched};
use crate::kirigami::design::State;
use crate::kirigami::levels::{COARSEST, COARSEST_CELLS, Level};
use crate::solver;

/// Where Stages 2 and 3 begin.
pub(super) struct Begun {
    /// The grids, the coarsest first.
    pub levels: Vec<Level>,
    pub layouts: Layouts,
    pub aims: Aims,
    /// Largest over smallest scale of the conformal flattening of the target that decides.
    pub ratio: f64,
    pub reports: Vec<solver::Report>,
}

/// Lays grids into the targets of a job.
///
/// # Errors
/// Targets that cannot be laid flat or curve too much, too few or too many pieces, pieces too small for their hinges, a
/// closed target that is too small.
pub(super) fn begin(job: &Job, targets: Targets) -> Result<Begun, PipelineError> {
    let size = match &job.pattern.grid {
        Grid::Regular(size) => *size,
        Grid::Aligned(size) => return aligned(job, *size, targets),
        Grid::Mesh(file) => return from_file(job, file, targets),
    };
    let correspond = targets.correspond;
    match (targets.closed, targets.open) {
        (None, Some(open)) if job.pattern.opening == Opening::Variable => variable(job, size, open),
        (None, Some(open)) => opening(job, size, open),
        (Some(closed), None) => closing(job, size, closed),
        (Some(closed), Some(open)) if correspond => map(job, size, closed, open),
        (Some(closed), Some(open)) => between(job, size, closed, open),
        (None, None) => unreachable!("the job reader asks for a mesh"),
    }
}

/// A flat closed sheet that opens to a surface.
fn opening(job: &Job, size: PieceSize, open: TargetMesh) -> Result<Begun, PipelineError> {
    let flat = open.lay_flat()?;
    let first = first_axis(&open.mesh, &flat.points);
    let outline = open.outline(&flat.points);
    let levels = grids(job, size, |size, gap| lay(job, &outline, &first, size, gap))?;
    let lift = LinearMap::new(open.mesh.clone(), &flat.points);
    let layouts = Layouts { closed: Layout::Grid, open: Layout::Lifted(lift) };
    Ok(begun(levels, layouts, Aims { closed: Aim::Plane, open: surface(open, Outline::Held) }, &flat))
}

/// A closed sheet on a surface that opens flat, or to whatever its pieces make of it.
fn closing(job: &Job, size: PieceSize, closed: TargetMesh) -> Result<Begun, PipelineError> {
    let flat = closed.lay_flat()?;
    let first = first_axis(&closed.mesh, &flat.points);
    let axis = grid_axis(&closed.outline(&flat.points), &first);
    let lay_stretched = |size, gap, by: [f64; 2]| {
        let points: Vec<Point2> = flat.points.iter().map(|p| stretched(p, &axis, by)).collect();
        lay(job, &closed.outline(&points), &axis, size, gap)
    };
    // The closed cells have the gap in them: the open state is larger by a little less than the stretches, by how much
    // depends on the size of the pieces. Each round brings the factors nearer by the gap's part of a piece.
    let by = |size, gap| -> Result<[f64; 2], CoverError> {
        let mut by = job.pattern.stretches;
        for _ in 0..ROUNDS {
            by = lay_stretched(size, gap, by)?.cell.stretches();
        }
        Ok(by)
    };
    let levels = grids(job, size, |size, gap| lay_stretched(size, gap, by(size, gap)?))?;
    let by = levels[levels.len() - 1].cover.cell.stretches();
    let points: Vec<Point2> = flat.points.iter().map(|p| stretched(p, &axis, by)).collect();
    let open = match job.target.open {
        Shape::Free => {
            let factor = (by[0] * by[1]).sqrt();
            let mut larger = closed.mesh.clone();
            larger.vertices.iter_mut().for_each(|p| *p *= factor);
            Layout::Lifted(LinearMap::new(larger, &points))
        }
        _ => Layout::Grid,
    };
    let layouts = Layouts { closed: Layout::Lifted(LinearMap::new(closed.mesh.clone(), &points)), open };
    let free = matches!(job.target.open, Shape::Free);
    let open = if free { Aim::Free } else { Aim::Plane };
    Ok(begun(levels, layouts, Aims { closed: surface(closed, Outline::Held), open }, &flat))
}

/// Rounds in which the size of the open sheet is found.
const ROUNDS: usize = 4;

/// Two surfaces. The open one decides where the border lies; the closed sheet may cover a part of its target.
fn between(job: &Job, size: PieceSize, closed: TargetMesh, open: TargetMesh) -> Result<Begun, PipelineError> {
    let (flat, closed_flat) = (open.lay_flat()?, closed.lay_flat()?);
    let first = first_axis(&open.mesh, &flat.points);
    let outline = open.outline(&flat.points);
    let levels = grids(job, size, |size, gap| lay(job, &outline, &first, size, gap))?;
    let finest = &levels[levels.len() - 1].cover;
    let by = finest.cell.stretches();
    let placed = middle_to_middle(&closed, &closed_flat.points, &open.mesh, &flat.points, by);
    fits(&closed, &placed, finest, by, &middle(&open.mesh, &flat.points))?;
    let layouts = Layouts {
        closed: Layout::Lifted(LinearMap::new(closed.mesh.clone(), &placed)),
        open: Layout::Lifted(LinearMap::new(open.mesh.clone(), &flat.points)),
    };
    let ratio = flat.ratio.max(closed_flat.ratio);
    let aims = Aims { closed: surface(closed, Outline::Left), open: surface(open, Outline::Held) };
    Ok(Begun { ratio, ..begun(levels, layouts, aims, &flat) })
}

/// The closed target laid flat, stretched and put onto the open one laid flat: middle to middle, and the direction of x
/// to that of x.
pub(super) fn middle_to_middle(
    closed: &TargetMesh,
    closed_flat: &[Point2],
    open: &TriMesh,
    open_flat: &[Point2],
    by: [f64; 2],
) -> Vec<Point2> {
    let (first_closed, first) = (first_axis(&closed.mesh, closed_flat), first_axis(open, open_flat));
    let (from, to) = (middle(&closed.mesh, closed_flat), middle(open, open_flat));
    let place = |p: &Point2| {
        let along = (p - from).dot(&first_closed) * by[0];
        let across = first_closed.perp(&(p - from)) * by[1];
        to + first * along + Vector2::new(-first.y, first.x) * across
    };
    closed_flat.iter().map(place).collect()
}

/// The middle of the area of a mesh laid flat.
fn middle(mesh: &TriMesh, flat: &[Point2]) -> Point2 {
    let (mut sum, mut total) = (Vector2::zeros(), 0.0);
    for face in &mesh.faces {
        let [a, b, c] = face.map(|v| flat[v]);
        let area = (b - a).perp(&(c - a));
        sum += (a.coords + b.coords + c.coords) * (area / 3.0);
        total += area;
    }
    Point2::from(sum / total)
}

/// Checks that a grid lies inside the closed target laid flat about `middle`, but for half a cell.
fn fits(
    closed: &TargetMesh,
    placed: &[Point2],
    cover: &Cover,
    by: [f64; 2],
    middle: &Point2,
) -> Result<(), PipelineError> {
    let map = LinearMap::new(closed.mesh.clone(), placed);
    // The corner that is farthest beyond the target if that is so many times as large.
    let farthest = |factor: f64| {
        let far =
            cover.corners.iter().map(|p| (factor * map.distance(&(middle + (p - middle) / factor)), *p));
        far.fold((0.0, Point2::origin()), |a, b| if b.0 > a.0 { b } else { a })
    };
    let most = 0.5 * cover.cell.open[0].max(cover.cell.open[1]);
    let (beyond, at) = farthest(1.0);
    if beyond <= most {
        return Ok(());
    }
    let mut needed = 1.0;
    while needed < LARGEST_FACTOR && farthest(needed).0 > most {
        needed *= 1.02;
    }
    let target: f64 = closed.mesh.area();
    let sheet = cover.mesh.pieces.len() as f64 * cover.cell.closed[0] * cover.cell.closed[1];
    let factor = ROOM * needed;
    let beyond = beyond / (by[0] * by[1]).sqrt();
    Err(PipelineError::TooSmall { path: closed.path.clone(), at, beyond, sheet, target, factor })
}

/// Larger factors are not looked for.
const LARGEST_FACTOR: f64 = 1e4;

/// How much larger than just large enough a target should be: pieces move beyond their grid.
const ROOM: f64 = 1.15;

/// Two meshes whose vertices correspond: the user's map.
fn map(job: &Job, size: PieceSize, closed: TargetMesh, open: TargetMesh) -> Result<Begun, PipelineError> {
    let flat = closed.lay_flat()?;
    let first = first_axis(&closed.mesh, &flat.points);
    let outline = closed.outline(&flat.points);
    let levels =
        grids(job, size, |size, gap| sheet_grid(job, &outline, &first, size, gap, open.mesh.area()))?;
    let planar = closed.is_planar();
    let layouts = Layouts {
        closed: if planar {
            Layout::Scaled(1.0)
        } else {
            Layout::Lifted(LinearMap::new(closed.mesh.clone(), &flat.points))
        },
        open: Layout::Lifted(LinearMap::new(open.mesh.clone(), &flat.points)),
    };
    let closed = if planar { Aim::Plane } else { surface(closed, Outline::Left) };
    Ok(begun(levels, layouts, Aims { closed, open: surface(open, Outline::Held) }, &flat))
}

/// A flat closed sheet that opens by different amounts: its outline is the conformal flattening, in which every place
/// is stretched alike in all directions, at the size at which no place needs more than the full opening.
fn variable(job: &Job, size: PieceSize, open: TargetMesh) -> Result<Begun, PipelineError> {
    let scale = open.conformal_scale()?;
    let ratio = scale.ratio();
    let conformal = conformal_points(&open.mesh, &scale);
    let most = scale.stretches(&open.mesh).iter().map(|s| s.principal[0]).fold(0.0, f64::max);
    let lay = |size, gap: f64, room: f64| {
        let by = most / (MOST_OPENING * room);
        let points: Vec<Point2> = conformal.iter().map(|p| p * by).collect();
        let first = first_axis(&open.mesh, &points);
        let outline = open.outline(&points);
        Ok((sheet_grid(job, &outline, &first, size, gap, open.mesh.area())?, points))
    };
    // Hinge polygons are narrower than their cells by half a gap: that much of the stretch is missing.
    let fitted = |size, gap: f64| -> Result<(Cover, Vec<Point2>), CoverError> {
        let mut room = 1.0;
        for _ in 0..ROUNDS {
            let side = lay(size, gap, room)?.0.cell.edge();
            room = 1.0 - gap / (2.0 * side);
        }
        lay(size, gap, room)
    };
    let levels = grids(job, size, |size, gap| Ok(fitted(size, gap)?.0))?;
    let (_, points) = fitted(size, job.pattern.gap)?;
    let lift = LinearMap::new(open.mesh.clone(), &points);
    let layouts = Layouts { closed: Layout::Scaled(1.0), open: Layout::Lifted(lift) };
    let aims = Aims { closed: Aim::Plane, open: surface(open, Outline::Held) };
    Ok(Begun { levels, layouts, aims, ratio, reports: Vec::new() })
}

/// The largest stretch asked for of squares that open by different amounts: a little less than sqrt 2, where they are
/// fully open and a further turn closes them again.
pub(super) const MOST_OPENING: f64 = 0.985 * std::f64::consts::SQRT_2;

/// A grid of squares, or of bistable cells, over a closed sheet that opens to `open_area`.
fn sheet_grid(
    job: &Job,
    outline: &[Point2],
    first: &Vector2,
    size: PieceSize,
    gap: f64,
    open_area: f64,
) -> Result<Cover, CoverError> {
    if let Kind::Bistable(cell) = &job.pattern.kind {
        return cover_cells(outline, first, size, cell, gap, job.pattern.boundary, State::Closed);
    }
    let mut cover = cover(outline, first, size, [1.0; 2], 0.0, job.pattern.boundary)?;
    let side = cover.cell.open[0];
    let sheet = cover.mesh.pieces.len() as f64 * side * side;
    cover.cell = ModelCell { open: [side * (open_area / sheet).sqrt(); 2], closed: [side; 2] };
    cover.asked_edge = side;
    cover.check_gap(gap)?;
    Ok(cover)
}

/// Lays a grid over an outline whose open cells fill it, with the job's stretches.
fn lay(
    job: &Job,
    outline: &[Point2],
    first: &Vector2,
    size: PieceSize,
    gap: f64,
) -> Result<Cover, CoverError> {
    match &job.pattern.kind {
        Kind::RotatingRectangles => {
            cover(outline, first, size, job.pattern.stretches, gap, job.pattern.boundary)
        }
        Kind::Bistable(cell) => {
            cover_cells(outline, first, size, cell, gap, job.pattern.boundary, State::Open)
        }
    }
}

/// Lays the grid that the job asks for, and coarser ones to begin with: the coarsest first.
fn grids(
    job: &Job,
    size: PieceSize,
    lay: impl Fn(PieceSize, f64) -> Result<Cover, CoverError>,
) -> Result<Vec<Level>, CoverError> {
    let (mut size, mut gap) = (size, job.pattern.gap);
    let mut levels = vec![Level { cover: lay(size, gap)?, gap }];
    let coarsest = match job.pattern.kind {
        Kind::RotatingRectangles => COARSEST,
        Kind::Bistable(_) => COARSEST_CELLS,
    };
    while levels[levels.len() - 1].cover.mesh.pieces.len() > coarsest {
        (size, gap) = (size.coarser(), 2.0 * gap);
        // Large pieces may not fit a narrow target.
        let Ok(cover) = lay(size, gap) else { break };
        levels.push(Level { cover, gap });
    }
    levels.reverse();
    Ok(levels)
}

pub(super) fn begun(levels: Vec<Level>, layouts: Layouts, aims: Aims, flat: &LaidFlat) -> Begun {
    Begun { levels, layouts, aims, ratio: flat.ratio, reports: flattening_reports(&flat.flattening) }
}

/// The rounds of the flattening in the form of the other stages' reports: first those that make it rigid, with the
/// energy, then those that lower the worst stretch, with its ratio.
fn flattening_reports(flat: &Flattening) -> Vec<solver::Report> {
    let report = |term, values: &[f64], settled| solver::Report {
        terms: vec![String::from(term)],
        iterations: values
            .iter()
            .filter(|value| value.is_finite())
            .map(|value| solver::Iteration { energies: vec![*value], damping: 0.0 })
            .collect(),
        next_damping: 0.0,
        termination: if settled {
            solver::Termination::Stagnation
        } else {
            solver::Termination::IterationLimit
        },
    };
    let mut reports = vec![report("arap", &flat.energies, flat.settled)];
    if flat.ratios.len() > 1 {
        reports.push(report("worst-stretch-ratio", &flat.ratios, true));
    }
    reports
}
