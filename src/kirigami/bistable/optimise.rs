//! Stage 3 of bistable sheets: pieces that are the same in both states (section 3.4).
//!
//! Isometry and flatness are hard, closeness is soft, there is no fairness. A weak shape term keeps the rectangles where the
//! model has them in cells whose corners are free: without it pieces at the border become slivers. The unknowns are the
//! corners of rectangles and of the border in the unexpanded state, the hinges and free vertices of the expanded one, and
//! the cells' inner corners, which only the shape term knows.

use super::cell::BistableCell;
use super::fit::{bilinear, edge_of_cell, exit_share, fitted, handed};
use super::mesh::{BistableMesh, Passing, Role, Vertex};
use super::pattern::BistablePattern;
use crate::geometry::{Point2, Point3};
use crate::kirigami::control_mesh::Goals;
use crate::kirigami::cover::Cover;
use crate::kirigami::design::State;
use crate::kirigami::levels::Beginning;
use crate::kirigami::phases::{Phase, hard, run_phases};
use crate::kirigami::stage2::held;
use crate::kirigami::terms::{ClosedVertex, Isometry, LinearTerm, PieceAt, Planarity, PointAt};
use crate::solver::{Coupling, Options, Report, Run, System, Term, Weighted};

/// Weights of the soft terms, for cells of mean side 1. Isometry and flatness have weight 1.
#[derive(Debug, Clone, PartialEq)]
pub struct Weights {
    /// Closeness to the target.
    pub prox: f64,
    /// Distance to the target's boundary.
    pub boundary: f64,
    /// Distance of fixed corners from the outline's.
    pub corners: f64,
    /// Rectangles where the model has them in their cells.
    pub shape: f64,
}

impl Default for Weights {
    fn default() -> Self {
        Self { prox: 0.3, boundary: 0.1, corners: 0.3, shape: 1.0 }
    }
}

/// What Stage 3 works on.
#[derive(Clone, Copy)]
pub struct Problem<'a> {
    /// The cells.
    pub cover: &'a Cover,
    /// Their combinatorics.
    pub mesh: &'a BistableMesh,
    /// The model of each cell, in millimetres.
    pub models: &'a [BistableCell],
    /// Twice the distance of a hinge from the slit that passes it, millimetres.
    pub gap: f64,
    /// What the states are held to.
    pub goals: Goals<'a>,
    /// Weights.
    pub weights: &'a Weights,
    /// Where border points are held to, where no grid follows the outline.
    pub border: &'a BistablePattern,
}

/// Where the points stand among the unknowns.
struct Unknowns {
    /// For each corner of the sheet its number among the unknown ones.
    slot: Vec<Option<usize>>,
    /// Likewise for the corners of the grid: those of the border are corners of the sheet.
    grid_slot: Vec<usize>,
    /// Number of unknown points of the unexpanded state.
    closed_count: usize,
    closed_dimension: usize,
    open_dimension: usize,
}

impl Unknowns {
    fn new(mesh: &BistableMesh, goals: &Goals) -> Self {
        let mut closed_count = 0;
        let mut next = || {
            closed_count += 1;
            closed_count - 1
        };
        let slot: Vec<Option<usize>> =
            (0..mesh.corner_count).map(|corner| (!mesh.is_meeting(corner)).then(&mut next)).collect();
        let grid_slot =
            mesh.outline.iter().map(|own| own.and_then(|own| slot[own]).unwrap_or_else(&mut next));
        Self {
            grid_slot: grid_slot.collect(),
            slot,
            closed_count,
            closed_dimension: goals.closed.dimension(),
            open_dimension: goals.open.dimension(),
        }
    }

    fn closed_at(&self, slot: usize) -> PointAt {
        PointAt { start: self.closed_dimension * slot, dimension: self.closed_dimension }
    }

    /// A corner of the sheet that is not a crossing inside it.
    fn corner(&self, corner: usize) -> PointAt {
        self.closed_at(self.slot[corner].expect("crossings inside the sheet are no unknowns"))
    }

    fn open(&self, i: usize) -> PointAt {
        let start = self.closed_dimension * self.closed_count + self.open_dimension * i;
        PointAt { start, dimension: self.open_dimension }
    }

    /// The unknowns of a pattern and of the grid's corners; or anything else that has points in these places.
    fn pack(&self, pattern: &BistablePattern, grid: &[Point3], scale: f64) -> Vec<f64> {
        let mut closed = vec![Point3::origin(); self.closed_count];
        for (point, slot) in grid.iter().zip(&self.grid_slot) {
            closed[*slot] = *point;
        }
        for (point, slot) in pattern.corners.iter().zip(&self.slot) {
            if let Some(slot) = slot {
                closed[*slot] = *point;
            }
        }
        let closed =
            closed.iter().flat_map(|p| p.iter().take(self.closed_dimension).copied().collect::<Vec<_>>());
        let open =
            pattern.open.iter().flat_map(|p| p.iter().take(self.open_dimension).copied().collect::<Vec<_>>());
        closed.chain(open).map(|value| value / scale).collect()
    }

    fn unpack(&self, x: &[f64], scale: f64, pattern: &mut BistablePattern) {
        for (point, slot) in pattern.corners.iter_mut().zip(&self.slot) {
            if let Some(slot) = slot {
                *point = self.closed_at(*slot).point(x, scale);
            }
        }
        for (i, point) in pattern.open.iter_mut().enumerate() {
            *point = self.open(i).point(x, scale);
        }
    }

    /// A place of each unknown on the grid, for the order of elimination.
    fn places(&self, problem: &Problem) -> Vec<[f64; 2]> {
        let Problem { cover, mesh, models, .. } = problem;
        let grid: Vec<Point3> = cover.places.iter().map(|[x, y]| Point3::new(*x, *y, 0.0)).collect();
        let pattern = fitted(models, &cover.mesh, mesh, &grid, &grid);
        // Packed with one unknown per point, the list holds the points' coordinates.
        let flat = |dimension: [usize; 2]| {
            let each = Self {
                slot: self.slot.clone(),
                grid_slot: self.grid_slot.clone(),
                closed_dimension: 2,
                open_dimension: 2,
                ..*self
            };
            let both = each.pack(&pattern, &grid, 1.0);
            let (closed, open) = both.split_at(2 * self.closed_count);
            let repeat = |points: &[f64], times: usize| -> Vec<[f64; 2]> {
                points.chunks_exact(2).flat_map(|p| vec![[p[0], p[1]]; times]).collect()
            };
            [repeat(closed, dimension[0]), repeat(open, dimension[1])].concat()
        };
        flat([self.closed_dimension, self.open_dimension])
    }
}

/// Soft phases whose weights phase out, and the hard one: isometry and flatness alone. From a coarser pattern
/// only details remain to be found.
pub fn phases(beginning: Beginning) -> Vec<Phase> {
    // Factors of the soft terms, most iterations, and the relative decrease below which a phase ends.
    const FROM_MODEL: [(f64, usize, f64); 3] = [(1.0, 20, 1e-3), (0.1, 12, 1e-3), (0.01, 12, 1e-3)];
    const FROM_COARSER: [(f64, usize, f64); 3] = [(1.0, 4, 3e-2), (0.1, 4, 3e-2), (0.01, 3, 3e-2)];
    let soft = match beginning {
        Beginning::Model => FROM_MODEL,
        Beginning::Coarser => FROM_COARSER,
    };
    let soft = soft.map(|(soft, iterations, energy_tolerance)| Phase {
        soft,
        fair: 0.0,
        options: Options { iterations, energy_tolerance, ..Options::default() },
    });
    soft.into_iter().chain([hard()]).collect()
}

/// Optimises a pattern, at first that of the model cells fitted to the control meshes, whose unexpanded `corners` are given
/// too. Returns it with one report per phase; `name` is that of the minimisations in the journal.
pub fn stage3(
    problem: &Problem,
    start: BistablePattern,
    corners: &[Point3],
    phases: &[Phase],
    name: &str,
    run: &mut Run,
) -> (BistablePattern, Vec<Report>) {
    let &Problem { cover, mesh, gap, goals, .. } = problem;
    let scale = cover.cell.edge();
    let at = Unknowns::new(mesh, &goals);
    let mut grid = corners.to_vec();
    let mut pattern = start;
    let mut systems = [(); 2].map(|()| System::new(at.places(problem)));
    let reports = run_phases(phases, run, |phase, run| {
        pattern.settle(mesh, |_| 0.5 * gap);
        let terms = || {
            let mut terms = hard_terms(mesh, &at, &pattern, scale);
            if phase.soft > 0.0 {
                terms.extend(soft_terms(problem, &at, phase.soft));
            }
            terms
        };
        let mut x = at.pack(&pattern, &grid, scale);
        let system = &mut systems[usize::from(phase.soft == 0.0)];
        let report = run.journal.minimize(name, system, terms, &mut x, &phase.options, run.watch);
        at.unpack(&x, scale, &mut pattern);
        for (point, slot) in grid.iter_mut().zip(&at.grid_slot) {
            *point = at.closed_at(*slot).point(&x, scale);
        }
        report
    });
    pattern.cross(mesh);
    (pattern, reports)
}

/// Moves the hinges of a pattern as far from the slits that pass them as `halves` says (mm, per corner), and makes the pieces
/// congruent again.
pub fn space(
    problem: &Problem,
    mut pattern: BistablePattern,
    corners: &[Point3],
    halves: &[f64],
    run: &mut Run,
) -> (BistablePattern, Report) {
    let &Problem { cover, mesh, goals, .. } = problem;
    let scale = cover.cell.edge();
    let at = Unknowns::new(mesh, &goals);
    pattern.settle(mesh, |corner| halves[corner]);
    let mut x = at.pack(&pattern, corners, scale);
    let terms = || hard_terms(mesh, &at, &pattern, scale);
    let mut system = System::new(at.places(problem));
    let report = run.journal.minimize("uneven-gaps", &mut system, terms, &mut x, &hard().options, run.watch);
    at.unpack(&x, scale, &mut pattern);
    pattern.cross(mesh);
    (pattern, report)
}

fn hard_terms(
    mesh: &BistableMesh,
    at: &Unknowns,
    pattern: &BistablePattern,
    scale: f64,
) -> Vec<Weighted<'static>> {
    let vertex = |vertex: &Vertex| {
        let (offset, open) = match vertex.role {
            Role::Hinge => (pattern.offsets[vertex.corner] / scale, vertex.corner),
            Role::Free(open) => (nalgebra::zero(), open),
            Role::Carried => return None,
        };
        Some((ClosedVertex { corner: at.corner(vertex.corner), offset, lift: None }, at.open(open)))
    };
    let piece = |vertices: &Vec<Vertex>| {
        let (closed, open) = vertices.iter().filter_map(vertex).unzip();
        PieceAt { closed, open }
    };
    let pieces: Vec<PieceAt> = mesh.pieces.iter().map(piece).collect();
    let terms: [Box<dyn Term>; 2] = [Box::new(Isometry::new(&pieces)), Box::new(Planarity::new(&pieces))];
    terms.into_iter().map(|term| Weighted { term, weight: 1.0, coupling: Coupling::Full }).collect()
}

/// Closeness, boundary, fixed corners and shape.
fn soft_terms<'a>(problem: &Problem<'a>, at: &Unknowns, factor: f64) -> Vec<Weighted<'a>> {
    let &Problem { cover, mesh, goals, weights, border: start, .. } = problem;
    let mut terms: Vec<(Box<dyn Term + 'a>, f64)> = vec![(Box::new(shape(problem, at)), weights.shape)];
    let by = [weights.prox, weights.boundary, weights.corners];
    let free: Vec<Vertex> =
        mesh.pieces.iter().flatten().filter(|vertex| matches!(vertex.role, Role::Free(_))).copied().collect();
    for state in [State::Open, State::Closed] {
        let points: Vec<PointAt> = match state {
            State::Open => (0..mesh.open_count).map(|i| at.open(i)).collect(),
            State::Closed => (0..mesh.corner_count).filter_map(|c| Some(at.closed_at(at.slot[c]?))).collect(),
        };
        let border: Vec<(PointAt, Point3)> = free
            .iter()
            .map(|vertex| match (state, vertex.role) {
                (State::Open, Role::Free(open)) => (at.open(open), start.open[open]),
                _ => (at.corner(vertex.corner), start.corners[vertex.corner]),
            })
            .collect();
        let tip = |corner: usize| {
            let own = mesh.outline[corner].expect("fixed corners are on the border");
            let vertex = free.iter().find(|vertex| vertex.corner == own).expect("and have a free vertex");
            match (state, vertex.role) {
                (State::Open, Role::Free(open)) => at.open(open),
                _ => at.corner(own),
            }
        };
        let held = held(cover, goals, state, points.into_iter(), border.into_iter(), tip);
        terms
            .extend(held.into_iter().zip(by).map(|(term, weight)| (Box::new(term) as Box<dyn Term>, weight)));
    }
    let asked = terms.into_iter().filter(|(_, weight)| *weight > 0.0);
    asked.map(|(term, weight)| Weighted { term, weight: weight * factor, coupling: Coupling::Full }).collect()
}

/// How far each corner of a rectangle is from where the model has it in its cell, and each exit of a slit from its place on
/// the cell's edge.
fn shape(problem: &Problem, at: &Unknowns) -> LinearTerm {
    let &Problem { cover, mesh, models, .. } = problem;
    let grid = &cover.mesh;
    let block = |corner: usize| {
        let (c, m) = (corner / 4, corner % 4);
        let cell = &models[c];
        let model: Point2 = handed(grid.counter_clockwise[c], m, |i| cell.passing(i));
        let weights = bilinear(model, cell.cell);
        let corners = (0..4).map(|k| (at.closed_at(at.grid_slot[grid.pieces[c][k]]), -weights[k]));
        std::iter::once((at.corner(corner), 1.0)).chain(corners).collect()
    };
    let exit = |(corner, slit): (usize, &Passing)| {
        let out = at.slot[slit.crossing]?;
        let (c, share) = (corner / 4, exit_share(models, grid, corner));
        let [p, q] = edge_of_cell(grid, mesh, slit, c).map(|k| at.closed_at(at.grid_slot[k]));
        Some(vec![(at.closed_at(out), 1.0), (p, share - 1.0), (q, -share)])
    };
    let exits = mesh.passing.iter().enumerate().filter_map(exit);
    let blocks: Vec<Vec<(PointAt, f64)>> = (0..4 * mesh.cells).map(block).chain(exits).collect();
    LinearTerm::new("shape", at.closed_dimension, &blocks)
}
