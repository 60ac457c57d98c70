//! The problem that is measured: a grid of pieces on a dome as high as 15 % of its span.
#![allow(dead_code)] // Each measurement asks for a part.

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::time::Instant;

use kirimorph::geometry::flatten::{ConformalScale, Flattening, flatten};
use kirimorph::geometry::mesh::TriMesh;
use kirimorph::geometry::topology::disk;
use kirimorph::geometry::{Point2, Point3, Vector2};
use kirimorph::job::{Job, read_job};
use kirimorph::kirigami::control_mesh::{ControlMesh, Goals, Layout, Layouts, LinearMap, Target, stage1};
use kirimorph::kirigami::cover::{Cover, PieceSize, cover};
use kirimorph::kirigami::pattern::{Opening, Pattern, Unknowns, initial_pattern};
use kirimorph::kirigami::pattern_terms::{hard_terms, soft_terms};
use kirimorph::kirigami::phases::{Phase, soft_precision};
use kirimorph::kirigami::stage2::{self, stage2};
use kirimorph::kirigami::stage3::{self, Regime, stage3};
use kirimorph::solver::{Coupling, Journal, Options, Precision, Run, Step, Weighted};

/// Pieces along a side; the last only where the environment variable [`LARGE`] is set.
const SIDES: [usize; 3] = [34, 100, 316];

/// Set it to measure 100,000 pieces too.
const LARGE: &str = "KIRIMORPH_BENCH_LARGE";

/// Millimetres of a piece, and between the two hinge points of a corner.
const PIECE: f64 = 10.0;
const GAP: f64 = 0.55;

/// What is added to the diagonal of the matrices that are factorised, as damping does.
pub const SHIFT: f64 = 1e-4;

/// Pieces along a side of what is to be measured.
pub fn sides() -> &'static [usize] {
    if is_large() { &SIDES } else { &SIDES[..2] }
}

/// Whether 100,000 pieces are asked for.
pub fn is_large() -> bool {
    std::env::var_os(LARGE).is_some()
}

/// Which terms of Stage 3 there are.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Terms {
    /// All, fully coupled.
    Soft,
    /// All, fairness coupled by place.
    SoftByPlace,
    /// Isometry and planarity.
    Hard,
}

impl Terms {
    /// All kinds.
    pub const ALL: [Self; 3] = [Self::Soft, Self::SoftByPlace, Self::Hard];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Soft => "soft, fully coupled",
            Self::SoftByPlace => "soft, by place",
            Self::Hard => "hard",
        }
    }
}

/// A grid on the dome, with all that the stages need.
pub struct Problem {
    pub side: usize,
    pub mesh: TriMesh,
    pub scale: ConformalScale,
    pub target: Target,
    pub cover: Cover,
    pub control: ControlMesh,
    pub start: Pattern,
    stage3: stage3::Weights,
}

impl Problem {
    /// `side` by `side` pieces, on about as many triangles.
    pub fn new(side: usize) -> Self {
        let mesh = dome(side as f64 * PIECE, (side as f64 / 2.0_f64.sqrt()) as usize);
        let cycle = disk(&mesh.faces).unwrap().boundary;
        let scale = ConformalScale::solve(&mesh, &cycle).unwrap();
        let Flattening { points, .. } = flatten(&mesh, &scale, f64::INFINITY).unwrap();
        let outline: Vec<Point2> = cycle.iter().map(|&v| points[v]).collect();
        let stretches = [std::f64::consts::SQRT_2; 2];
        let counts = PieceSize::Counts([side; 2]);
        let cover = cover(&outline, &Vector2::x(), counts, stretches, GAP, None).unwrap();
        let open = Layout::Lifted(LinearMap::new(mesh.clone(), &points));
        let control = stage1(&cover, &Layouts { closed: Layout::Grid, open });
        let start = initial_pattern(&cover, &control, GAP, Opening::Full);
        let target = Target::new(mesh.clone(), &cycle);
        Self { side, mesh, scale, target, cover, control, start, stage3: stage3::Weights::default() }
    }

    /// Number of pieces.
    pub fn pieces(&self) -> usize {
        self.cover.mesh.pieces.len()
    }

    /// A place of each unknown of Stage 3.
    pub fn places(&self) -> Vec<[f64; 2]> {
        self.at().places(&self.cover)
    }

    /// The unknowns of Stage 3 at its start.
    pub fn unknowns(&self) -> Vec<f64> {
        self.at().pack(&self.start, self.cover.cell.edge())
    }

    fn at(&self) -> Unknowns {
        Unknowns::new(&self.cover.mesh, &Goals::opening(&self.target))
    }

    /// The terms of Stage 3.
    pub fn terms(&self, which: Terms) -> Vec<Weighted<'_>> {
        let Self { cover, target, start, stage3: weights, .. } = self;
        let at = self.at();
        let mut terms = hard_terms(&cover.mesh, &at, start, cover.cell.edge());
        let coupling = if which == Terms::SoftByPlace { Coupling::ByPlace } else { Coupling::Full };
        if which != Terms::Hard {
            let problem = stage3::Problem { cover, goals: Goals::opening(target), gap: GAP, weights };
            let phase = Phase { soft: 1.0, fair: 1.0, options: fixed(1) };
            terms.extend(soft_terms(&problem, [start; 2], &at, &phase, coupling));
        }
        terms
    }

    /// The distance term of Stage 3 alone: one residual per open hinge.
    pub fn held(&self) -> Vec<Weighted<'_>> {
        let terms = self.terms(Terms::Soft).into_iter();
        terms.filter(|weighted| weighted.term.name() == "prox").collect()
    }

    /// Makes so many steps of Stage 2; returns the seconds of each.
    pub fn stage2(&self, steps: usize) -> Vec<f64> {
        let Self { cover, target, control, .. } = self;
        let weights = stage2::Weights::default();
        let goals = Goals::opening(target);
        let problem =
            stage2::Problem { cover, goals, gap: GAP, cells: stage2::Cells::Rotating, weights: &weights };
        clocked(|run| {
            let options = Options { precision: soft_precision(self.pieces()), ..fixed(steps) };
            stage2(&problem, control, &options, "stage-2", run);
        })
        .swap_remove(0)
    }

    /// Makes so many soft steps of Stage 3 and so many hard ones; returns the seconds of each.
    pub fn stage3(&self, coupling: Coupling, steps: usize) -> [Vec<f64>; 2] {
        let Self { cover, target, start, stage3: weights, .. } = self;
        let soft = Options { precision: Precision::Single, ..fixed(steps) };
        let hard = Options { damping: 1e-6, ..fixed(steps) };
        let phases = vec![
            Phase { soft: 1.0, fair: 1.0, options: soft },
            Phase { soft: 0.0, fair: 0.0, options: hard },
        ];
        let regime = Regime { phases, coupling };
        let problem = stage3::Problem { cover, goals: Goals::opening(target), gap: GAP, weights };
        let seconds = clocked(|run| {
            stage3(&problem, start.clone(), start, &regime, "stage-3", run);
        });
        seconds.try_into().expect("two phases")
    }
}

/// A fixed number of steps.
fn fixed(iterations: usize) -> Options {
    Options { iterations, energy_tolerance: 0.0, ..Options::default() }
}

/// Runs minimisations and returns the seconds of each one's steps.
fn clocked(work: impl FnOnce(&mut Run)) -> Vec<Vec<f64>> {
    let mut times: Vec<Vec<Instant>> = Vec::new();
    let watch = &mut |step: &Step| {
        if step.iteration == 0 {
            times.push(Vec::new());
        }
        times.last_mut().expect("begun at step 0").push(Instant::now());
        ControlFlow::Continue(())
    };
    work(&mut Run { journal: &mut Journal::default(), watch });
    let seconds = |pair: &[Instant]| (pair[1] - pair[0]).as_secs_f64();
    times.iter().map(|times| times.windows(2).map(seconds).collect()).collect()
}

/// A dome over a square: z = height cos(pi x / 2) cos(pi y / 2) for x, y from -1 to 1, `cells` by `cells` quads
/// split in two.
fn dome(span: f64, cells: usize) -> TriMesh {
    let n = cells + 1;
    let vertex = |k: usize| {
        let [x, y] = [k % n, k / n].map(|i| 2.0 * i as f64 / cells as f64 - 1.0);
        let z = 0.15 * span * [x, y].map(|t| (std::f64::consts::FRAC_PI_2 * t).cos()).iter().product::<f64>();
        Point3::new(0.5 * span * x, 0.5 * span * y, z)
    };
    let cell = |k: usize| {
        let a = k / cells * n + k % cells;
        let [b, c, d] = [a + 1, a + 1 + n, a + n];
        [[a, b, c], [a, c, d]]
    };
    TriMesh { vertices: (0..n * n).map(vertex).collect(), faces: (0..cells * cells).flat_map(cell).collect() }
}

/// A job for the whole program: the sample dome with `side` by `side` pieces.
pub fn job(side: usize) -> Job {
    let target = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("samples/dome.obj");
    let text = format!(
        "[target]\nopen = {target:?}\nclosed = \"flat\"\nsize_mm = {:.1}\n\
         [pattern]\nkind = \"rotating-rectangles\"\npieces = [{side}, {side}]\n\
         [fabrication]\nprofile = \"steel-304-0.5mm\"\nsheet_mm = [10000.0, 10000.0]\n",
        side as f64 * PIECE
    );
    let file = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("bench-{side}.toml"));
    std::fs::write(&file, text).unwrap();
    read_job(&file).unwrap()
}
