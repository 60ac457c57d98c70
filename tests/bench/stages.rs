//! Criterion benchmarks of the parts of the optimisation, and of the whole: see docs/benchmarks.md.

mod problem;

use std::hint::black_box;
use std::ops::ControlFlow;
use std::time::Duration;

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, criterion_group, criterion_main};
use kirimorph::geometry::Point3;
use kirimorph::geometry::flatten::flatten;
use kirimorph::pipeline::{Clock, Progress, design};
use kirimorph::solver::Coupling;
use kirimorph::solver::dense::Real;
use kirimorph::solver::multifrontal::Factor;
use kirimorph::solver::normal_equations::NormalEquations;
use problem::{Problem, Terms, job, sides};

/// Beyond this number of pieces a side whole stages are left to the tables, which run them once.
const MOST_FOR_STAGES: usize = 100;

fn stages(criterion: &mut Criterion) {
    for &side in sides() {
        let problem = Problem::new(side);
        let mut group = criterion.benchmark_group(format!("{} pieces", problem.pieces()));
        group.sample_size(10).warm_up_time(Duration::from_millis(300));
        group.measurement_time(Duration::from_secs(2));
        closest_points(&mut group, &problem);
        group.bench_function("ARAP flattening", |b| {
            b.iter(|| black_box(flatten(&problem.mesh, &problem.scale, f64::INFINITY).unwrap()));
        });
        for which in Terms::ALL {
            linear_algebra(&mut group, &problem, which);
        }
        if side <= MOST_FOR_STAGES {
            whole_stages(&mut group, &problem);
        }
    }
}

fn closest_points(group: &mut BenchmarkGroup<WallTime>, problem: &Problem) {
    // A tenth of a piece off the surface, as patterns are.
    let queries: Vec<Point3> = problem.start.open.iter().map(|p| Point3::new(p.x, p.y, p.z + 1.0)).collect();
    group.bench_function("closest points, one thread", |b| {
        b.iter(|| {
            let points = queries.iter().map(|query| problem.target.surface.closest(query).point.z);
            black_box(points.sum::<f64>())
        });
    });
    let x = problem.unknowns();
    let mut held = problem.held();
    group.bench_function("refresh of the distance term", |b| b.iter(|| held[0].term.refresh(black_box(&x))));
}

fn linear_algebra(group: &mut BenchmarkGroup<WallTime>, problem: &Problem, which: Terms) {
    let name = which.name();
    let (places, x) = (problem.places(), problem.unknowns());
    let mut terms = problem.terms(which);
    terms.iter_mut().for_each(|weighted| weighted.term.refresh(&x));
    group.bench_function(format!("analysis ({name})"), |b| {
        b.iter(|| black_box(NormalEquations::new(&places, &terms).pattern.entries()));
    });
    let mut equations = NormalEquations::new(&places, &terms);
    group.bench_function(format!("assembly ({name})"), |b| {
        b.iter(|| black_box(equations.assemble(&terms, &x)));
    });
    factorisation::<f64>(group, &equations, &format!("{name}, f64"));
    factorisation::<f32>(group, &equations, &format!("{name}, f32"));
}

fn factorisation<T: Real>(group: &mut BenchmarkGroup<WallTime>, equations: &NormalEquations, name: &str) {
    let NormalEquations { pattern, values, gradient, .. } = equations;
    let mut factor = Factor::<T>::default();
    group.bench_function(format!("factorisation ({name})"), |b| {
        b.iter(|| assert!(factor.factorise(pattern, values, problem::SHIFT)));
    });
    assert!(factor.factorise(pattern, values, problem::SHIFT));
    let mut solution = gradient.clone();
    group.bench_function(format!("triangular solve ({name})"), |b| {
        b.iter(|| {
            solution.copy_from_slice(gradient);
            factor.solve(pattern, &mut solution);
        });
    });
}

/// As the paper counts: 10 steps of Stage 2; 10 soft and 10 hard steps of Stage 3. And the program's own course.
fn whole_stages(group: &mut BenchmarkGroup<WallTime>, problem: &Problem) {
    group.bench_function("Stage 2, 10 steps", |b| b.iter(|| problem.stage2(10)));
    group.bench_function("Stage 3, 10 + 10 steps", |b| b.iter(|| problem.stage3(Coupling::Full, 10)));
    group.bench_function("Stage 3 by place, 10 + 10 steps", |b| {
        b.iter(|| problem.stage3(Coupling::ByPlace, 10));
    });
    let job = job(problem.side);
    group.bench_function("whole design", |b| {
        b.iter(|| {
            let mut watch = |_: &Progress| ControlFlow::Continue(());
            assert!(design(&job, &mut Clock::new(&mut watch)).is_ok());
        });
    });
}

criterion_group!(benches, stages);
criterion_main!(benches);
