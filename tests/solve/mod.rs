//! All three stages on a disk, without files.
#![allow(dead_code)] // Not every test asks for everything.

use std::ops::ControlFlow;

use kirimorph::geometry::flatten::{ConformalScale, flatten};
use kirimorph::geometry::mesh::TriMesh;
use kirimorph::geometry::topology::disk;
use kirimorph::geometry::{Point2, Vector2};
use kirimorph::kirigami::control_mesh::{Goals, Layout, Layouts, LinearMap, Target};
use kirimorph::kirigami::cover::{Cover, PieceSize, cover};
use kirimorph::kirigami::design::Design;
use kirimorph::kirigami::hinges;
use kirimorph::kirigami::levels::{Climb, Level, Reached};
use kirimorph::kirigami::pattern::{Opening, Pattern, initial_pattern};
use kirimorph::kirigami::quality::{Quality, measure};
use kirimorph::kirigami::rotating::Rotating;
use kirimorph::kirigami::{stage2, stage3};
use kirimorph::solver::{Journal, Report, Run, Step};

/// What the stages made.
pub struct Solved {
    pub cover: Cover,
    pub target: Target,
    pub gap: f64,
    pub stretch_ratio: f64,
    /// Where Stage 3 began, and where it ended.
    pub start: Pattern,
    pub pattern: Pattern,
    pub reports: [Vec<Report>; 2],
}

impl Solved {
    /// A pattern's design and its measures.
    pub fn measured(&self, pattern: &Pattern) -> (Design, Quality) {
        let goals = Goals::opening(&self.target);
        let mesh = &self.cover.mesh;
        let design = hinges::design(mesh, pattern, self.gap, goals.sheet_state());
        let quality = measure(&design, &goals, self.cover.cell.edge(), self.stretch_ratio);
        (design, quality)
    }
}

/// Lays one grid and optimises it. `first` gives the grid's first direction from the flattened vertices.
pub fn solve(
    mesh: &TriMesh,
    counts: [usize; 2],
    stretches: [f64; 2],
    gap: f64,
    first: impl Fn(&[Point2]) -> Vector2,
) -> Solved {
    let cycle = disk(&mesh.faces).unwrap().boundary;
    let scale = ConformalScale::solve(mesh, &cycle).unwrap();
    let flat = flatten(mesh, &scale, f64::INFINITY).unwrap().points;
    let outline: Vec<Point2> = cycle.iter().map(|&v| flat[v]).collect();
    let cover = cover(&outline, &first(&flat), PieceSize::Counts(counts), stretches, gap, None).unwrap();
    let target = Target::new(mesh.clone(), &cycle);
    let mut levels = vec![Level { cover, gap }];
    let weights = (stage2::Weights::default(), stage3::Weights::default());
    let open = Layout::Lifted(LinearMap::new(mesh.clone(), &flat));
    let climb = Climb {
        levels: &levels,
        layouts: &Layouts { closed: Layout::Grid, open },
        family: Rotating {
            goals: Goals::opening(&target),
            opening: Opening::Full,
            stage2: &weights.0,
            stage3: &weights.1,
        },
    };
    let run = &mut Run { journal: &mut Journal::default(), watch: &mut |_: &Step| ControlFlow::Continue(()) };
    let (control, second) = climb.stage2(run);
    let start = initial_pattern(&levels[0].cover, &control, gap, Opening::Full);
    let Reached { pattern, reports: third, .. } = climb.stage3(control, run);
    let Level { cover, .. } = levels.pop().unwrap();
    let stretch_ratio = scale.ratio();
    Solved { cover, target, gap, stretch_ratio, start, pattern, reports: [vec![second], third] }
}
