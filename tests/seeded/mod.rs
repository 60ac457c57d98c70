//! Seeded faults: what they have in common, whatever machine the files are for.

pub mod laser;
pub mod laser_faults;
pub mod mill;
pub mod mill_faults;

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use kirimorph::fabrication::fabricate::Fabrication;
use kirimorph::fabrication::layout::{CutKind, CutLayout};
use kirimorph::fabrication::product::Product;
use kirimorph::job::{Job, read_job};
use kirimorph::pipeline::{self, Clock, Progress};
use kirimorph::profile::Process;
use kurbo::Point;
use rayon::prelude::*;

pub const HASH: &str = "fnv1a64:0123456789abcdef";
/// What is left of a sheet or a stock may differ by so much from what should be left, millimetres: less is no fault.
pub const EQUIVALENT: f64 = 0.02;
/// So many places are tried for each one at which a fault changes what is left.
const DRAWS: u64 = 12;

/// A pseudo-random sequence (splitmix64).
pub struct Dice(u64);

impl Dice {
    pub fn below(&mut self, limit: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % limit.max(1) as u64) as usize
    }

    /// The index of any cut of a kind.
    pub fn cut(&mut self, layout: &CutLayout, kind: CutKind) -> Option<usize> {
        let all: Vec<usize> = (0..layout.paths.len()).filter(|&i| layout.paths[i].kind == kind).collect();
        (!all.is_empty()).then(|| all[self.below(all.len())])
    }
}

pub struct Sample {
    pub name: String,
    pub job: Job,
    pub sheet: Fabrication,
}

/// The samples that are cut from a sheet by this process.
pub fn samples(process: Process) -> Vec<Sample> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples");
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(folder).unwrap().map(|file| file.unwrap().path()).collect();
    files.retain(|file| file.extension().is_some_and(|ending| ending == "toml"));
    files.sort();
    let made = |file: &PathBuf| {
        let job = read_job(file).unwrap();
        if job.fabrication.profile.process != process {
            return None;
        }
        let mut watch = |_: &Progress| ControlFlow::Continue(());
        let name = file.file_stem().unwrap().to_str().unwrap().to_owned();
        match pipeline::make(&job, &mut Clock::new(&mut watch)).unwrap().product {
            Product::Sheet(sheet) => Some(Sample { name, job, sheet }),
            Product::Assembly(_) => None,
        }
    };
    files.par_iter().filter_map(made).collect()
}

/// What became of a spoiled file.
pub enum Spoiled {
    /// Verification refuses it.
    Caught,
    /// It does not, and what is left differs by so much, millimetres.
    Missed(f64),
}

/// One place of a sample at which a kind of fault was seeded.
pub struct Tried {
    pub place: String,
    pub fault: &'static str,
    /// How many of the spoiled files leave the same.
    equivalent: usize,
    /// `None` where all of them do.
    caught: Option<Result<(), f64>>,
}

/// Seeds a fault until it changes what is left. `spoil`: `None` where there is nothing to spoil in that way.
pub fn tried(
    place: String,
    fault: &'static str,
    seed: u64,
    spoil: impl Fn(&mut Dice) -> Option<Spoiled>,
) -> Option<Tried> {
    let mut tried = Tried { place, fault, equivalent: 0, caught: None };
    for draw in 0..DRAWS {
        match spoil(&mut Dice(DRAWS * seed + draw))? {
            Spoiled::Missed(off) if off <= EQUIVALENT => tried.equivalent += 1,
            Spoiled::Missed(off) => tried.caught = Some(Err(off)),
            Spoiled::Caught => tried.caught = Some(Ok(())),
        }
        if tried.caught.is_some() {
            break;
        }
    }
    Some(tried)
}

/// Adds up what was tried and prints it. All have to be caught.
pub fn told(tried: &[Tried]) {
    let mut counts: BTreeMap<&str, [usize; 3]> = BTreeMap::new();
    for one in tried {
        let [all, caught, equivalent] = counts.entry(one.fault).or_default();
        *all += usize::from(one.caught.is_some());
        *caught += usize::from(one.caught == Some(Ok(())));
        *equivalent += one.equivalent;
    }
    println!("{:<40} caught  of   beside which leave the same", "");
    for (fault, [all, caught, equivalent]) in &counts {
        println!("{fault:<40} {caught:>5} {all:>5} {equivalent:>5}");
    }
    let sum = |which: usize| counts.values().map(|count| count[which]).sum::<usize>();
    println!("{} of {} caught, {} leave the same", sum(1), sum(0), sum(2));
    for one in tried.iter().filter(|one| one.caught.is_none()) {
        println!("{}, {}: no place found in {DRAWS} that changes what is left", one.place, one.fault);
    }
    let missed: Vec<String> = tried
        .iter()
        .filter_map(|one| {
            let off = one.caught?.err()?;
            Some(format!("{}, {}: what is left is {off:.3} mm off", one.place, one.fault))
        })
        .collect();
    assert!(missed.is_empty(), "{missed:#?}");
    // Each kind was seeded somewhere.
    assert!(counts.values().all(|[all, ..]| *all > 0), "{counts:?}");
}

/// Distance from a point to the nearest of some straight lines; infinite without any.
pub fn distance(point: Point, lines: &[[Point; 2]]) -> f64 {
    let to_line = |[from, to]: &[Point; 2]| {
        let way = *to - *from;
        let length = way.hypot2();
        let part = if length > 0.0 { ((point - *from).dot(way) / length).clamp(0.0, 1.0) } else { 0.0 };
        from.lerp(*to, part).distance(point)
    };
    lines.iter().map(to_line).fold(f64::INFINITY, f64::min)
}

/// Places on a line, at most `step` apart.
pub fn places([from, to]: [Point; 2], step: f64) -> impl Iterator<Item = Point> {
    let count = (from.distance(to) / step).ceil().max(1.0) as usize;
    (0..=count).map(move |i| from.lerp(to, i as f64 / count as f64))
}
