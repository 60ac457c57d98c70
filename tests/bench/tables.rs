//! Prints the tables of docs/benchmarks.md.

mod problem;

use std::ops::ControlFlow;
use std::time::Instant;

use kirimorph::pipeline::{Clock, Progress, design};
use kirimorph::solver::Coupling;
use kirimorph::solver::cholesky::CholeskyPattern;
use kirimorph::solver::dense::Real;
use kirimorph::solver::multifrontal::Factor;
use kirimorph::solver::normal_equations::NormalEquations;
use problem::{Problem, SHIFT, Terms, job, sides};

/// Seconds per step of Ceres 2.1 with SuiteSparse on 2 cores at about 1,150, 10,000 and 100,000 pieces, measured
/// elsewhere: Stage 2, Stage 3 soft, Stage 3 hard.
const CERES: [[f64; 3]; 3] = [[0.10, 0.081, 0.033], [1.6, 1.4, 0.49], [26.0, 44.0, 11.6]];

/// Steps that the minimum is taken of; two where each takes seconds.
const STEPS: [usize; 3] = [10, 4, 2];

/// Beyond this number of pieces a side the other solver's factor of the fully coupled terms may not fit into memory.
const MOST_FOR_PEER: usize = 100;

fn main() {
    // `cargo test --all-targets` runs this too, with another argument, and means a build that works.
    if !std::env::args().any(|argument| argument == "--bench") {
        return;
    }
    let problems: Vec<Problem> = sides().iter().map(|&side| Problem::new(side)).collect();
    steps(&problems);
    factorisations(&problems);
    designs();
}

fn steps(problems: &[Problem]) {
    println!("\nSeconds per step, least of several\n");
    println!("| pieces | step of | kirimorph | Ceres 2.1 | ratio |\n|---:|---|---:|---:|---:|");
    for ((problem, [second, soft, hard]), &steps) in problems.iter().zip(CERES).zip(&STEPS) {
        let row = |name: &str, seconds: &[f64], ceres: f64| {
            let least = least(seconds.iter().copied());
            let (pieces, ratio) = (problem.pieces(), ceres / least);
            println!("| {pieces} | {name} | {least:.4} | {ceres} | {ratio:.1} |");
        };
        row("Stage 2", &problem.stage2(steps), second);
        let [by_place, _] = problem.stage3(Coupling::ByPlace, steps);
        let [full, alone] = problem.stage3(Coupling::Full, steps);
        row("Stage 3, soft, fully coupled", &full, soft);
        row("Stage 3, soft, by place", &by_place, soft);
        row("Stage 3, hard", &alone, hard);
    }
}

/// The same matrices, factorised by faer's supernodal method under approximate-minimum-degree order, and by ours.
fn factorisations(problems: &[Problem]) {
    let (one, all) = (pool(1), rayon::current_num_threads());
    println!("\nSeconds per factorisation of the same matrix, least of several\n");
    println!(
        "| pieces | matrix | unknowns | faer, f64, 1 thread | ours, f64, 1 thread | ratio | ours, f64, {all} threads \
         | ours, f32, {all} threads | Gflop/s f64 | factor f64, MB |\n|---:|---|---:|---:|---:|---:|---:|---:|---:|---:|"
    );
    for problem in problems {
        let (places, x) = (problem.places(), problem.unknowns());
        for which in Terms::ALL {
            let mut terms = problem.terms(which);
            terms.iter_mut().for_each(|weighted| weighted.term.refresh(&x));
            let mut equations = NormalEquations::new(&places, &terms);
            equations.assemble(&terms, &x);
            let fits = which != Terms::Soft || problem.side <= MOST_FOR_PEER;
            let mut peer = fits.then(|| by_peer(&equations));
            let (mut double, mut again, mut single) =
                (ours::<f64>(&equations), ours::<f64>(&equations), ours::<f32>(&equations));
            let [peer, ours, on_all, single] = alternately([
                &mut || peer.iter_mut().for_each(|peer| one.install(peer)),
                &mut || one.install(&mut double),
                &mut again,
                &mut single,
            ]);
            let [peer, ratio] = match fits {
                true => [format!("{peer:.4}"), format!("{:.1}", peer / ours)],
                false => ["-", "-"].map(String::from),
            };
            let fronts = &equations.pattern.fronts;
            println!(
                "| {} | {} | {} | {peer} | {ours:.4} | {ratio} | {on_all:.4} | {single:.4} | {:.0} | {:.0} |",
                problem.pieces(),
                which.name(),
                places.len(),
                1e-9 * fronts.work / on_all,
                8e-6 * fronts.factor_size as f64
            );
        }
    }
}

fn pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap()
}

/// A factorisation by our method.
fn ours<T: Real>(equations: &NormalEquations) -> impl FnMut() + Send {
    let mut factor = Factor::<T>::default();
    move || assert!(factor.factorise(&equations.pattern, &equations.values, SHIFT))
}

/// A factorisation by faer's.
fn by_peer(equations: &NormalEquations) -> impl FnMut() + Send {
    let ours = &equations.pattern;
    let n = ours.size();
    let order = &ours.fronts.order;
    // By unknowns, so that the other solver knows nothing of our order.
    let entries = || {
        (0..n).flat_map(|column| {
            ours.column(column).iter().map(move |&row| {
                let [u, v] = [row as usize, column].map(|position| order[position] as usize);
                (u.max(v), u.min(v))
            })
        })
    };
    let pattern = CholeskyPattern::new(n, entries());
    let mut values = vec![0.0; pattern.entries()];
    entries().zip(&equations.values).for_each(|((u, v), value)| values[pattern.slot(u, v)] = *value);
    (0..n).for_each(|u| values[pattern.diagonal(u)] += SHIFT);
    move || assert!(pattern.factor(&values).is_some())
}

/// Least seconds of each piece of work. They take turns for some seconds, so that other load meets all of them.
fn alternately<const N: usize>(mut work: [&mut dyn FnMut(); N]) -> [f64; N] {
    let begin = Instant::now();
    let mut seconds = [f64::INFINITY; N];
    let mut rounds = 0;
    // In the first round memory is laid out.
    while rounds < 2 || (rounds < 50 && begin.elapsed().as_secs_f64() < 3.0) {
        for (work, least) in work.iter_mut().zip(&mut seconds) {
            let start = Instant::now();
            work();
            *least = least.min(start.elapsed().as_secs_f64());
        }
        rounds += 1;
    }
    seconds
}

fn least(seconds: impl IntoIterator<Item = f64>) -> f64 {
    seconds.into_iter().fold(f64::INFINITY, f64::min)
}

fn designs() {
    println!(
        "\nSeconds of the whole design, from the job to the measured pattern; best of three, once from 100,000\n"
    );
    println!(
        "| pieces | read | Stage 1 | Stage 2 | Stage 3 | all | growth exponent |\n|---:|---:|---:|---:|---:|---:|---:|"
    );
    let mut before: Option<(f64, f64)> = None;
    for &side in sides() {
        let job = job(side);
        let times = if side > MOST_FOR_PEER { 1 } else { 3 };
        let runs = (0..times).map(|_| {
            let mut watch = |_: &Progress| ControlFlow::Continue(());
            let mut clock = Clock::new(&mut watch);
            let start = Instant::now();
            let designed = design(&job, &mut clock).unwrap_or_else(|error| panic!("{error}"));
            (start.elapsed().as_secs_f64(), clock.timings.0, designed.design.pieces.len())
        });
        let (all, stages, pieces) = runs.min_by(|a, b| a.0.total_cmp(&b.0)).expect("at least one run");
        let exponent = before.map_or(String::from("-"), |(count, seconds)| {
            format!("{:.2}", (all / seconds).ln() / (pieces as f64 / count).ln())
        });
        before = Some((pieces as f64, all));
        let stages: Vec<String> = stages.iter().map(|(_, seconds)| format!("{seconds:.3}")).collect();
        println!("| {pieces} | {} | {all:.2} | {exponent} |", stages.join(" | "));
    }
}
