//! Problems of section 3.5 of the paper: regular grids laid into two surfaces, taken through Stages 2 and 3 with fixed
//! numbers of steps. Lengths are in mean edges.
#![allow(dead_code)] // Not everyone asks for everything.

use std::f64::consts::{PI, SQRT_2};
use std::ops::ControlFlow;
use std::time::Instant;

use kirimorph::geometry::flatten::{ConformalScale, flatten};
use kirimorph::geometry::mesh::TriMesh;
use kirimorph::geometry::topology::disk;
use kirimorph::geometry::{Point2, Point3, Vector2, Vector3};
use kirimorph::kirigami::control_mesh::{ControlMesh, Goal, Goals, LinearMap, Target};
use kirimorph::kirigami::cover::{Cover, ModelCell, PieceSize, cover};
use kirimorph::kirigami::design::{Design, Hinge, PatternKind, Piece};
use kirimorph::kirigami::filled::open_surface;
use kirimorph::kirigami::pattern::{Opening, Pattern, initial_pattern};
use kirimorph::kirigami::pattern_terms::{hard_terms, soft_terms};
use kirimorph::kirigami::phases::Phase;
use kirimorph::kirigami::piece_mesh::Edge;
use kirimorph::kirigami::quality::{coverage, triangles};
use kirimorph::kirigami::{pattern, stage2, stage3};
use kirimorph::solver::{Coupling, Options, Precision, Report, Step, System, Weighted};

/// Steps of Stage 2, of the soft and of the hard phase of Stage 3.
pub const STEPS: usize = 10;

/// A pair of surfaces with regular grids laid into them.
pub struct Problem {
    pub cover: Cover,
    pub open: Target,
    /// `None`: the closed state is a flat sheet.
    pub closed: Option<Target>,
    /// Where both control meshes begin.
    start: ControlMesh,
}

/// Weights of both stages, and the soft phase's course: (steps, factor of closeness and shape, factor of fairness).
pub struct Course {
    pub stage2: stage2::Weights,
    pub stage3: stage3::Weights,
    pub soft: Vec<(usize, f64, f64)>,
    /// Coupling of Stage 3's fairness.
    pub coupling: Coupling,
    /// Precision of Stage 2's factorisation; that of Stage 3's soft phase is single.
    pub precision: Precision,
    /// Whether phases also end when a step lowers the energy by less than a hundredth (the hard one: by less than half,
    /// or at rounding level).
    pub stagnation: bool,
}

impl Course {
    /// The paper's: nothing but proximity and fairness, at 0.01.
    pub fn paper() -> Self {
        let (prox, fair) = (0.01, 0.01);
        Self {
            stage2: stage2::Weights { orth: 1.0, geom: 1.0, prox, fair, boundary: 0.0, corners: 0.0 },
            stage3: stage3::Weights {
                prox,
                fair,
                boundary: 0.0,
                opening: 0.0,
                rectangles: 0.0,
                sides: 0.0,
                corners: 0.0,
                widths: 0.0,
            },
            soft: vec![(STEPS, 1.0, 1.0)],
            coupling: Coupling::Full,
            precision: Precision::Double,
            stagnation: false,
        }
    }

    /// The program's: its weights, with the boundary held and fairness phasing out.
    pub fn ours() -> Self {
        Self {
            stage2: stage2::Weights::default(),
            stage3: stage3::Weights::default(),
            soft: vec![(5, 1.0, 1.0), (3, 2.0, 0.2), (2, 2.0, 0.04)],
            coupling: Coupling::ByPlace,
            precision: Precision::Single,
            stagnation: false,
        }
    }

    /// The program's, stopping on stagnation.
    pub fn to_stagnation() -> Self {
        Self { soft: vec![(STEPS, 1.0, 0.1), (STEPS, 0.5, 0.01)], stagnation: true, ..Self::ours() }
    }

    fn options(&self, iterations: usize, precision: Precision, damping: f64) -> Options {
        // Without stagnation closest points, new after each step, may raise the energy: that must not stop it either.
        let energy_tolerance = if self.stagnation { 1e-2 } else { f64::NEG_INFINITY };
        Options { iterations, energy_tolerance, precision, damping, ..Options::default() }
    }

    fn hard_options(&self) -> Options {
        let options = self.options(STEPS, Precision::Double, 1e-6);
        if !self.stagnation {
            return options;
        }
        Options { energy_tolerance: 0.5, energy_floor: 1e-24, ..options }
    }
}

/// A grid of m x m quads split into triangles, over u, v in -1..1, moved into space by `place`.
fn sheet(m: usize, place: impl Fn(f64, f64) -> [f64; 3]) -> TriMesh {
    let at = |i: usize| 2.0 * i as f64 / m as f64 - 1.0;
    let vertices = (0..(m + 1) * (m + 1)).map(|k| place(at(k % (m + 1)), at(k / (m + 1))).into()).collect();
    let mut faces = Vec::new();
    for j in 0..m {
        for i in 0..m {
            let a = j * (m + 1) + i;
            faces.extend([[a, a + 1, a + m + 2], [a, a + m + 2, a + m + 1]]);
        }
    }
    TriMesh { vertices, faces }
}

/// The mesh, scaled to this area.
fn of_area(mut mesh: TriMesh, wanted: f64) -> TriMesh {
    let area = |face: &[usize; 3]| {
        let [a, b, c] = face.map(|v| mesh.vertices[v]);
        0.5 * (b - a).cross(&(c - a)).norm()
    };
    let scale = (wanted / mesh.faces.iter().map(area).sum::<f64>()).sqrt();
    mesh.vertices.iter_mut().for_each(|p| *p *= scale);
    mesh
}

/// A surface with an n x n grid in it: where the grid's corners and centres lie, and the surface as a target.
fn laid(mesh: TriMesh, n: usize) -> (Cover, Vec<Point3>, Target) {
    let cycle = disk(&mesh.faces).unwrap().boundary;
    let scale = ConformalScale::solve(&mesh, &cycle).unwrap();
    let flat = flatten(&mesh, &scale, f64::INFINITY).unwrap().points;
    let outline: Vec<Point2> = cycle.iter().map(|&v| flat[v]).collect();
    let first: Vector2 = flat[1] - flat[0];
    let mut cover = cover(&outline, &first, PieceSize::Counts([n, n]), [SQRT_2; 2], 0.0, None).unwrap();
    assert_eq!(cover.mesh.pieces.len(), n * n, "the grid follows the outline");
    cover.cell = ModelCell::from_edge(1.0, [SQRT_2; 2], 0.0);
    let lift = LinearMap::new(mesh.clone(), &flat);
    let points = cover.corners.iter().chain(&cover.centres).map(|p| lift.apply(p)).collect();
    (cover, points, Target::new(mesh, &cycle))
}

/// Fine reference meshes, as the paper has them.
const CELLS: usize = 96;

/// White vertices, then black ones, of each state.
fn control_mesh(cover: &Cover, mut closed: Vec<Point3>, mut open: Vec<Point3>) -> ControlMesh {
    let closed_centres = closed.split_off(cover.mesh.corner_count);
    let open_centres = open.split_off(cover.mesh.corner_count);
    ControlMesh { closed_corners: closed, closed_centres, open_corners: open, open_centres }
}

impl Problem {
    /// A flat sheet of n x n pieces to a dome whose height is a quarter of its span.
    pub fn dome(n: usize) -> Self {
        let dome = sheet(CELLS, |u, v| [u, v, 0.5 * (0.5 * PI * u).cos() * (0.5 * PI * v).cos()]);
        let (cover, open_points, open) = laid(of_area(dome, 2.0 * (n * n) as f64), n);
        let grid = |i: f64| i - 0.5 * n as f64;
        let corners = cover.places.iter().map(|&[i, j]| Point3::new(grid(i), grid(j), 0.0));
        let centre = |piece: &Vec<usize>| {
            let [i, j] = cover.places[piece[0]];
            Point3::new(grid(i) + 0.5, grid(j) + 0.5, 0.0)
        };
        let closed_points = corners.chain(cover.mesh.pieces.iter().map(centre)).collect();
        let start = control_mesh(&cover, closed_points, open_points);
        Self { cover, open, closed: None, start }
    }

    /// A paraboloid of n x n pieces to a gently waved roof.
    pub fn paraboloid_to_roof(n: usize) -> Self {
        let pieces = (n * n) as f64;
        let paraboloid = sheet(CELLS, |u, v| [u, v, 0.15 * (2.0 - u * u - v * v)]);
        let wave = |u: f64, v: f64| 0.12 * (1.0 - v * v) + 0.06 * (1.5 * PI * u).cos() + 0.03 * u * v;
        let roof = sheet(CELLS, |u, v| [u, v, wave(u, v)]);
        let (closed_cover, closed_points, closed) = laid(of_area(paraboloid, pieces), n);
        let (cover, open_points, open) = laid(of_area(roof, 2.0 * pieces), n);
        assert_eq!(closed_cover.mesh, cover.mesh);
        let start = control_mesh(&cover, closed_points, open_points);
        Self { cover, open, closed: Some(closed), start }
    }

    fn goals(&self) -> Goals<'_> {
        let surface = |target| Goal::Surface { target, outline: true };
        Goals {
            closed: self.closed.as_ref().map_or(Goal::Plane, surface),
            open: surface(&self.open),
            guides: &[],
        }
    }
}

/// Energies by name (with their weights) at the start of a stage and after each step.
pub type Energies = Vec<Vec<(String, f64)>>;

/// Sum of the energies of one moment whose names begin so.
pub fn energy(row: &[(String, f64)], name: &str) -> f64 {
    row.iter().filter(|(term, _)| term.starts_with(name)).map(|(_, energy)| energy).sum()
}

/// What was computed.
pub struct Solved {
    /// Of Stage 2, the soft and the hard phase of Stage 3: energies, seconds, reason for stopping.
    pub stages: [(Energies, f64, &'static str); 3],
    /// Vertices of each piece in the closed and in the open state.
    pub pieces: Vec<[Vec<Point3>; 2]>,
}

fn minimize(system: &mut System, mut terms: Vec<Weighted>, x: &mut [f64], options: &Options) -> Report {
    system.minimize(&mut terms, x, options, &mut |_: &Step| ControlFlow::Continue(()))
}

fn energies(report: &Report) -> Energies {
    let row = |energies: &Vec<f64>| report.terms.iter().cloned().zip(energies.iter().copied()).collect();
    report.iterations.iter().map(|iteration| row(&iteration.energies)).collect()
}

/// Runs Stage 2 and both phases of Stage 3.
pub fn solve(problem: &Problem, course: &Course) -> Solved {
    let clock = Instant::now();
    let (report, control) = second(problem, course);
    let second = (energies(&report), clock.elapsed().as_secs_f64(), report.termination.reason());
    let ([soft, hard], pattern) = third(problem, course, &control);
    let mesh = &problem.cover.mesh;
    let closed = |&e: &usize| pattern.closed_hinge(mesh, e);
    let open = |&e: &usize| pattern.open[e];
    let piece = |owned: &Vec<usize>| [owned.iter().map(closed).collect(), owned.iter().map(open).collect()];
    Solved { stages: [second, soft, hard], pieces: mesh.owned.iter().map(piece).collect() }
}

/// Stage 2. Returns the control meshes.
fn second(problem: &Problem, course: &Course) -> (Report, ControlMesh) {
    let Problem { cover, start, .. } = problem;
    let goals = problem.goals();
    let at = stage2::Unknowns::new(&cover.mesh, &goals);
    let mut x = at.pack(start, 1.0);
    let terms = stage2::terms(
        &stage2::Problem { cover, goals, gap: 0.0, cells: stage2::Cells::Rotating, weights: &course.stage2 },
        start,
        &at,
    );
    let mut system = System::new(at.places(cover));
    let report = minimize(&mut system, terms, &mut x, &course.options(STEPS, course.precision, 1e-4));
    (report, at.unpack(&x, 1.0))
}

/// Stage 3 from the model cells. Returns its two phases and the pattern.
fn third(
    problem: &Problem,
    course: &Course,
    control: &ControlMesh,
) -> ([(Energies, f64, &'static str); 2], Pattern) {
    let cover = &problem.cover;
    let goals = problem.goals();
    let at = pattern::Unknowns::new(&cover.mesh, &goals);
    let clock = Instant::now();
    let mut pattern = initial_pattern(cover, control, 0.0, Opening::Full);
    let start = pattern.clone();
    let stage3 = stage3::Problem { cover, goals, gap: 0.0, weights: &course.stage3 };
    let mut x = at.pack(&start, 1.0);
    let mut system = System::new(at.places(cover));
    let (mut soft, mut reason) = (Energies::new(), "");
    for &(steps, factor, fair) in &course.soft {
        let phase = Phase { soft: factor, fair, options: course.options(steps, Precision::Single, 1e-4) };
        let mut terms = hard_terms(&cover.mesh, &at, &pattern, 1.0);
        terms.extend(soft_terms(&stage3, [&start; 2], &at, &phase, course.coupling));
        let report = minimize(&mut system, terms, &mut x, &phase.options);
        // A later phase begins where the one before it ended: that row is known.
        soft.extend(energies(&report).split_off(usize::from(!soft.is_empty())));
        reason = report.termination.reason();
    }
    let soft = (soft, clock.elapsed().as_secs_f64(), reason);
    let clock = Instant::now();
    let mut system = System::new(at.places(cover));
    let terms = hard_terms(&cover.mesh, &at, &pattern, 1.0);
    let report = minimize(&mut system, terms, &mut x, &course.hard_options());
    let hard = (energies(&report), clock.elapsed().as_secs_f64(), report.termination.reason());
    at.unpack(&x, 1.0, &mut pattern);
    ([soft, hard], pattern)
}

/// What shows that a pattern is one: nothing of it comes from the optimiser's residuals.
#[derive(Debug)]
pub struct Figures {
    /// Mean side of the closed pieces; 1 was asked for.
    pub mean_edge: f64,
    /// Eq. (7) over all vertex pairs of each piece at mean edge 1.
    pub e_isom: f64,
    /// Eq. (8) over all pairs of pieces' vertices that should coincide, in both states.
    pub e_match: f64,
    /// Largest distance of an open vertex from the open target, and of a point of that from the open pattern with holes
    /// filled, in edges.
    pub coverage: [f64; 2],
    /// Largest distance of a closed vertex from the closed target, in edges; 0 in the plane.
    pub closed_distance: f64,
    /// Largest signed volume, open minus closed, over a cubed edge.
    pub volume: f64,
    /// Largest distance of a piece's vertex from the plane of the three others, in edges, closed and open.
    pub planarity: [f64; 2],
}

/// Measures a pattern from its pieces' vertices.
pub fn figures(problem: &Problem, solved: &Solved) -> Figures {
    let side = |p: &[Point3]| (0..4).map(|i| (p[i] - p[(i + 1) % 4]).norm()).sum::<f64>();
    let sides: f64 = solved.pieces.iter().map(|[closed, _]| side(closed)).sum();
    let mean_edge = sides / (4 * solved.pieces.len()) as f64;
    let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
    let vertices = |state: usize| solved.pieces.iter().flat_map(move |piece| &piece[state]);
    let off = |target: &Target, state| {
        largest(&mut vertices(state).map(|p| target.surface.distance(p))) / mean_edge
    };
    let mesh = &problem.cover.mesh;
    let piece = |([closed, open], corners): (&[Vec<Point3>; 2], &Vec<usize>)| Piece {
        corners: corners.clone(),
        closed: closed.clone(),
        open: open.clone(),
    };
    // Only which vertices hinges join counts here.
    let hinge = |(e, edge): (usize, &Edge)| {
        let pieces = [edge.piece, edge.neighbour?];
        let vertices = pieces.map(|piece| mesh.vertex_of(piece, e));
        Some(Hinge { pieces, vertices, point: Point3::origin(), axis: Vector3::z(), angle: 0.0 })
    };
    let design = Design {
        pattern: PatternKind::RotatingRectangles,
        sheet_state: None,
        gap: 0.0,
        corners: Vec::new(),
        pieces: solved.pieces.iter().zip(&mesh.pieces).map(piece).collect(),
        hinges: mesh.edges.iter().enumerate().filter_map(hinge).collect(),
    };
    let filled = triangles(&open_surface(&design));
    let volume = |p: &[Point3]| (p[1] - p[0]).cross(&(p[2] - p[0])).dot(&(p[3] - p[0]));
    let height = |p: &[Point3]| (volume(p) / (p[1] - p[0]).cross(&(p[2] - p[0])).norm()).abs();
    let heights = |state: usize| largest(&mut solved.pieces.iter().map(|p| height(&p[state]))) / mean_edge;
    let twist = |p: &[Vec<Point3>; 2]| (volume(&p[1]) - volume(&p[0])).abs() / mean_edge.powi(3);
    Figures {
        mean_edge,
        e_isom: e_isom(&solved.pieces, mean_edge),
        e_match: e_match(problem, &solved.pieces),
        coverage: [off(&problem.open, 1), coverage(filled, &problem.open) / mean_edge],
        closed_distance: problem.closed.as_ref().map_or(0.0, |target| off(target, 0)),
        volume: largest(&mut solved.pieces.iter().map(twist)),
        planarity: [heights(0), heights(1)],
    }
}

fn e_isom(pieces: &[[Vec<Point3>; 2]], mean_edge: f64) -> f64 {
    let mut sum = 0.0;
    for [closed, open] in pieces {
        for i in 0..closed.len() {
            for j in i + 1..closed.len() {
                let error = (closed[i] - closed[j]).norm_squared() - (open[i] - open[j]).norm_squared();
                sum += (error / mean_edge.powi(2)).powi(2);
            }
        }
    }
    sum
}

fn e_match(problem: &Problem, pieces: &[[Vec<Point3>; 2]]) -> f64 {
    let mesh = &problem.cover.mesh;
    let mut sum = 0.0;
    // Closed: all pieces around a corner. Open: the two pieces at a hinge.
    let mut first: Vec<Option<Point3>> = vec![None; mesh.corner_count];
    for (owned, [closed, _]) in mesh.owned.iter().zip(pieces) {
        for (&edge, p) in owned.iter().zip(closed) {
            let there = first[mesh.edges[edge].hinge_corner].get_or_insert(*p);
            sum += (*p - *there).norm_squared().powi(2);
        }
    }
    for (e, edge) in mesh.edges.iter().enumerate() {
        if let Some(k) = edge.neighbour {
            let [p, q] = [edge.piece, k].map(|piece| pieces[piece][1][mesh.vertex_of(piece, e)]);
            sum += (p - q).norm_squared().powi(2);
        }
    }
    sum
}
