//! From coarse to fine: the pattern of larger pieces is the start for that of smaller ones.
//!
//! A pattern of few pieces finds the shape of the whole sheet cheaply. How far its pieces have moved from the
//! Stage 1 map is a smooth function on the flattened target; added to the Stage 1 map of the finer grid it gives
//! a start that is wrong in details only, and these are found in a few steps.

use super::control_mesh::{ControlMesh, Layouts, LinearMap, stage1};
use super::cover::Cover;
use super::design::Design;
use super::phases;
use crate::geometry::mesh::TriMesh;
use crate::geometry::{Point3, Vector3};
use crate::solver::{Report, Run, Step, Termination};

/// A grid with the gap between its hinge points.
pub struct Level {
    /// The grid.
    pub cover: Cover,
    /// Distance between the two hinge points of a corner, millimetres: the same part of a piece at all levels.
    pub gap: f64,
}

/// Grids of more pieces than this begin from a coarser one.
pub const COARSEST: usize = 400;

/// The same of bistable cells, each of which has three pieces: larger ones do not follow what smaller ones can.
pub const COARSEST_CELLS: usize = 900;

/// What Stage 3 begins from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Beginning {
    /// Model pieces on control meshes: much is to be found.
    Model,
    /// A pattern of larger pieces: only details are.
    Coarser,
}

/// A kind of pattern: what the way from coarse to fine has to know of it.
pub trait Family {
    /// A pattern over a grid.
    type Pattern: Clone;

    /// Stage 2: control meshes of the right local dimensions. `name` is that of the minimisation in the journal.
    fn stage2(&self, level: &Level, start: &ControlMesh, name: &str, run: &mut Run) -> (ControlMesh, Report);

    /// The pattern of control meshes.
    fn start(&self, level: &Level, control: &ControlMesh) -> Self::Pattern;

    /// Stage 3. Border points are held to where they are in `border`. Returns the pattern with one report per phase.
    fn stage3(
        &self,
        level: &Level,
        start: Self::Pattern,
        border: &Self::Pattern,
        beginning: Beginning,
        name: &str,
        run: &mut Run,
    ) -> (Self::Pattern, Vec<Report>);

    /// Most steps of Stage 3 on a level.
    fn most_steps(&self, level: &Level, beginning: Beginning) -> usize;

    /// How far the pattern over a grid has moved since `first`.
    fn displacement(&self, cover: &Cover, first: &Self::Pattern, pattern: &Self::Pattern) -> Displacement;

    /// Unlike gaps, as [`Climb::space`] has them: puts the hinge points `halves` from their corners, in the design's order of
    /// hinges, and makes the pieces congruent again.
    fn space(
        &self,
        level: &Level,
        pattern: Self::Pattern,
        halves: &[f64],
        run: &mut Run,
    ) -> (Self::Pattern, Vec<Report>);

    /// The pieces and hinges of a pattern.
    fn design(&self, level: &Level, pattern: &Self::Pattern) -> Design;
}

/// What all levels have in common.
pub struct Climb<'a, F> {
    /// The grids, the coarsest first.
    pub levels: &'a [Level],
    /// Where Stage 1 puts the two states.
    pub layouts: &'a Layouts,
    /// The kind of pattern.
    pub family: F,
}

/// How far the optimisation has come.
pub struct Reached<P> {
    /// Which of the levels.
    pub level: usize,
    /// Its pattern.
    pub pattern: P,
    /// Of all phases of all levels.
    pub reports: Vec<Report>,
}

/// A pattern whose hard phase begins or ends with more than this, in sums of squared residuals, says nothing about finer
/// ones: it was torn, or far from the target.
const SOUND: [f64; 2] = [1e-2, 1e-6];

/// Rounds in which the hinge points follow the angles and axes that they change.
const SPACING_ROUNDS: usize = 4;

/// A level that has been optimised.
struct Done<P> {
    number: usize,
    /// The pattern of the Stage 1 map.
    first: P,
    pattern: P,
}

impl<F: Family> Climb<'_, F> {
    /// Optimises the control meshes of the coarsest grid.
    pub fn stage2(&self, run: &mut Run) -> (ControlMesh, Report) {
        let watch = &mut |step: &Step| (run.watch)(&Step { later: self.most_steps_from(0), ..*step });
        let start = stage1(&self.levels[0].cover, self.layouts);
        self.family.stage2(&self.levels[0], &start, "stage-2", &mut Run { journal: run.journal, watch })
    }

    /// Optimises the patterns of all grids, one after the other, beginning with the control meshes of the first.
    pub fn stage3(&self, control: ControlMesh, run: &mut Run) -> Reached<F::Pattern> {
        let mut reports = Vec::new();
        let mut model = Some(control);
        let mut done: Option<Done<F::Pattern>> = None;
        for (number, level) in self.levels.iter().enumerate() {
            let map = stage1(&level.cover, self.layouts);
            let first = self.family.start(level, &map);
            let (control, beginning) = match (model.take(), &done) {
                (None, Some(below)) if is_sound(&reports) => {
                    (self.refined(below, &map, &level.cover), Beginning::Coarser)
                }
                (Some(control), _) => (control, Beginning::Model),
                _ => {
                    let name = format!("stage-2/{number}");
                    let (control, report) = self.family.stage2(level, &map, &name, run);
                    reports.push(report);
                    (control, Beginning::Model)
                }
            };
            let begin = self.family.start(level, &control);
            // Borders of trimmed grids are held to where the Stage 1 map has them, except where that was improved.
            let border = if number == 0 { begin.clone() } else { first.clone() };
            let later = self.most_steps_from(number + 1);
            let watch = &mut |step: &Step| (run.watch)(&Step { later: step.later + later, ..*step });
            let mut run = Run { journal: run.journal, watch };
            let name = format!("stage-3/{number}");
            let (pattern, more) = self.family.stage3(level, begin, &border, beginning, &name, &mut run);
            reports.extend(more);
            done = Some(Done { number, first, pattern });
            if reports.last().is_some_and(|report| report.termination == Termination::Interrupted) {
                break;
            }
        }
        let Done { number: level, pattern, .. } = done.expect("at least one level");
        Reached { level, pattern, reports }
    }

    /// Hinge points that stand apart by what each of them needs: the last step of the optimisation.
    ///
    /// Stages 2 and 3 know one gap for all corners. What a hinge needs, half of its gap as `halves` gives it for a design in
    /// the order of its hinges (mm), depends on its own angle and axis, which are known only then; it differs little from
    /// the common gap. So the points are moved there, and the pieces are made congruent again, with nothing else to decide.
    /// Angles and axes change by less still. Where `halves` knows nothing the pattern stays.
    pub fn space(
        &self,
        level: usize,
        mut pattern: F::Pattern,
        halves: &dyn Fn(&Design) -> Option<Vec<f64>>,
        run: &mut Run,
    ) -> (F::Pattern, Vec<Report>) {
        let level = &self.levels[level];
        let mut reports = Vec::new();
        for round in 0..SPACING_ROUNDS {
            let Some(halves) = halves(&self.family.design(level, &pattern)) else { break };
            let later = (SPACING_ROUNDS - 1 - round) * phases::hard().options.iterations;
            let watch = &mut |step: &Step| (run.watch)(&Step { phase: round, later, ..*step });
            let more;
            (pattern, more) =
                self.family.space(level, pattern, &halves, &mut Run { journal: run.journal, watch });
            reports.extend(more);
            if reports.last().is_some_and(|report| report.termination == Termination::Interrupted) {
                break;
            }
        }
        (pattern, reports)
    }

    /// Most steps of Stage 3 on this level and all finer ones.
    fn most_steps_from(&self, number: usize) -> usize {
        let levels = self.levels.iter().enumerate().skip(number);
        let beginning = |i| if i > 0 { Beginning::Coarser } else { Beginning::Model };
        levels.map(|(i, level)| self.family.most_steps(level, beginning(i))).sum()
    }

    /// The start of a level: its Stage 1 map, displaced as the pattern of a coarser level is.
    fn refined(&self, below: &Done<F::Pattern>, map: &ControlMesh, fine: &Cover) -> ControlMesh {
        let coarse = &self.levels[below.number].cover;
        let moved = self.family.displacement(coarse, &below.first, &below.pattern);
        let mut control = map.clone();
        displace(coarse, &moved, fine, &mut control);
        control
    }
}

/// Whether the last minimisation had little to mend and ended near zero.
fn is_sound(reports: &[Report]) -> bool {
    let Some(Report { iterations, .. }) = reports.last() else { return false };
    let ends = [iterations.first(), iterations.last()];
    ends.iter().zip(SOUND).all(|(end, most)| end.is_some_and(|end| end.total() < most))
}

/// How far the pieces of a grid have moved from the Stage 1 map: per piece the mean over points around it, in which its
/// turning cancels.
pub struct Displacement {
    /// In the closed state.
    pub closed: Vec<Vector3>,
    /// In the open state.
    pub open: Vec<Vector3>,
}

/// The mean displacement of each piece, from `before` to `after`; `of` gives the points of each.
pub(super) fn mean_displacement<'a>(
    of: impl Iterator<Item = &'a Vec<usize>>,
    before: &[Point3],
    after: &[Point3],
) -> Vec<Vector3> {
    let mean = |of: &Vec<usize>| of.iter().map(|&i| after[i] - before[i]).sum::<Vector3>() / of.len() as f64;
    of.map(mean).collect()
}

/// Adds the displacement of a coarse pattern to the Stage 1 map of a finer one. Between the centres of pieces it is
/// linear, beyond them constant.
fn displace(coarse: &Cover, moved: &Displacement, fine: &Cover, control: &mut ControlMesh) {
    // The triangulation joins the centres of the pieces around each inner corner.
    let around = coarse.mesh.pieces_around();
    let closed_fans = around.iter().zip(&coarse.mesh.fans).filter(|(_, fan)| fan.closed);
    let fan = |around: &Vec<usize>| -> Vec<[usize; 3]> {
        (1..around.len() - 1).map(|i| [around[0], around[i], around[i + 1]]).collect()
    };
    let faces: Vec<[usize; 3]> = closed_fans.flat_map(|(around, _)| fan(around)).collect();
    let map = |values: &[Vector3]| {
        let vertices = values.iter().map(|d| Point3::from(*d)).collect();
        LinearMap::new(TriMesh { vertices, faces: faces.clone() }, &coarse.centres)
    };
    let (closed, open) = (map(&moved.closed), map(&moved.open));
    for (i, at) in fine.corners.iter().enumerate() {
        control.closed_corners[i] += closed.apply_nearest(at).coords;
        control.open_corners[i] += open.apply_nearest(at).coords;
    }
}

#[cfg(test)]
mod tests {
    use super::super::cover::{PieceSize, cover};
    use super::super::pattern::{Opening, hinge_offsets, initial_pattern};
    use super::super::rotating::displacement;
    use super::*;
    use crate::geometry::{Point2, Vector2};
    use crate::kirigami::control_mesh::Layout;
    use std::f64::consts::SQRT_2;

    /// The grid over a flat rectangle, and its Stage 1 map: the identity.
    fn flat(counts: [usize; 2]) -> (Cover, ControlMesh) {
        let outline = [[0.0, 0.0], [60.0, 0.0], [60.0, 40.0], [0.0, 40.0]].map(|[x, y]| Point2::new(x, y));
        let cover =
            cover(&outline, &Vector2::x(), PieceSize::Counts(counts), [SQRT_2; 2], 0.0, None).unwrap();
        let vertices = outline.iter().map(|p| Point3::new(p.x, p.y, 0.0)).collect();
        let lift = LinearMap::new(TriMesh { vertices, faces: vec![[0, 1, 2], [0, 2, 3]] }, &outline);
        let layouts = Layouts { closed: Layout::Grid, open: Layout::Lifted(lift) };
        let control = stage1(&cover, &layouts);
        (cover, control)
    }

    /// A linear displacement of the open state.
    fn shift(p: &Point3) -> Vector3 {
        Vector3::new(0.02 * p.x - 0.01 * p.y, 0.03 * p.y, 0.05 * p.x + 0.02 * p.y + 1.0)
    }

    #[test]
    fn a_linear_displacement_is_carried_over_exactly_inside() {
        let (coarse, first) = flat([6, 4]);
        let first = initial_pattern(&coarse, &first, 0.0, Opening::Full);
        let mut pattern = first.clone();
        pattern.open.iter_mut().for_each(|p| *p += shift(p));
        // Closed corners scale with the flattened ones.
        pattern.corners.iter_mut().for_each(|p| *p += p.coords * 0.1);
        let moved = displacement(&coarse, &first, &pattern);
        let (fine, start) = flat([12, 8]);
        let mut control = start.clone();
        displace(&coarse, &moved, &fine, &mut control);
        let cell = coarse.cell.open[0];
        let mut inside = 0;
        for (i, at) in fine.corners.iter().enumerate() {
            // Beyond the outermost centres the displacement is constant.
            let hull = Point2::new(
                at.x.clamp(0.5 * cell, 60.0 - 0.5 * cell),
                at.y.clamp(0.5 * cell, 40.0 - 0.5 * cell),
            );
            let expected = start.open_corners[i] + shift(&Point3::new(hull.x, hull.y, 0.0));
            assert!((control.open_corners[i] - expected).norm() < 1e-9, "{at}");
            inside += usize::from((hull - at).norm() < 1e-9);
            let closed = start.closed_corners[i] + 0.1 * hull.coords.push(0.0) / SQRT_2;
            assert!((control.closed_corners[i] - closed).norm() < 1e-9, "{at}");
        }
        assert_eq!(inside, 11 * 7);
    }

    #[test]
    fn a_pattern_that_has_not_moved_leaves_the_map_of_stage_1() {
        let (coarse, first) = flat([4, 3]);
        let pattern = initial_pattern(&coarse, &first, 0.0, Opening::Full);
        assert_eq!(pattern.offsets, hinge_offsets(&coarse.mesh, &pattern.corners, 0.0));
        let moved = displacement(&coarse, &pattern, &pattern);
        let (fine, start) = flat([8, 6]);
        let mut control = start.clone();
        displace(&coarse, &moved, &fine, &mut control);
        assert_eq!(control, start);
    }
}
