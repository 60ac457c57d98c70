//! How good verification is: every sample's machine files are spoiled in many places at random, and every spoiled one must be
//! found out. `cargo test --release --test mutations -- --nocapture` prints how many of each kind were tried.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use kirimorph::fabrication::fabricate::Fabrication;
use kirimorph::fabrication::layout::{CutKind, CutLayout, CutPath, PathVertex};
use kirimorph::fabrication::product::Product;
use kirimorph::job::{Job, read_job};
use kirimorph::machine::{Header, Machine};
use kirimorph::milling::sweep::{Neck, Wanted as WantedPart};
use kirimorph::output::dxf::{self, DxfVersion};
use kirimorph::output::svg;
use kirimorph::pipeline::mill::{Milled, Order, measure, mill, walls};
use kirimorph::pipeline::{self, Clock, Progress};
use kirimorph::profile::{Process, Profile};
use kirimorph::solid::{ThickSheet, thicken};
use kirimorph::verify::{Fault, Files, ONE_PART, Wanted, hash_comment, verify};
use kurbo::{Point, Vec2};
use rayon::prelude::*;

const HASH: &str = "fnv1a64:0123456789abcdef";
/// How far cuts are spoiled, millimetres: less than a laser's operator would see.
const BY: f64 = 0.1;
/// Places that are spoiled per kind of fault and sample.
const PLACES: u64 = 3;

/// A pseudo-random sequence (splitmix64).
struct Dice(u64);

impl Dice {
    fn below(&mut self, limit: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % limit.max(1) as u64) as usize
    }

    /// The index of any cut of a kind.
    fn cut(&mut self, layout: &CutLayout, kind: CutKind) -> Option<usize> {
        let all: Vec<usize> = (0..layout.paths.len()).filter(|&i| layout.paths[i].kind == kind).collect();
        (!all.is_empty()).then(|| all[self.below(all.len())])
    }
}

struct Sample {
    name: String,
    job: Job,
    sheet: Fabrication,
}

/// The samples that are cut from a sheet by this process.
fn samples(process: Process) -> Vec<Sample> {
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

/// What a fault does to a layout; `None` where the sheet has nothing to spoil in that way.
type Spoil = fn(&mut CutLayout, &Sample, &mut Dice) -> Option<()>;

/// Kinds of faults that do not always change what is left, and how many in ten are caught at least.
const OFTEN_LASER: &[(&str, usize)] =
    &[("a corner moved", 6), ("bar shifted", 8), ("slit shifted", 9), ("slit too short", 8)];
const OFTEN_MILL: &[(&str, usize)] =
    &[("a coordinate off", 5), ("a pass missing", 7), ("a turn too many", 5)];

const LASER_FAULTS: [(&str, Spoil); 18] = [
    ("slit too long", |layout, _, dice| {
        let slit = dice.cut(layout, CutKind::Slit)?;
        lengthened(&mut layout.paths[slit], BY);
        Some(())
    }),
    ("slit too short", |layout, _, dice| {
        let slit = dice.cut(layout, CutKind::Slit)?;
        lengthened(&mut layout.paths[slit], -BY);
        Some(())
    }),
    ("slit shifted", |layout, _, dice| shifted(layout, CutKind::Slit, dice)),
    ("bar shifted", |layout, _, dice| shifted(layout, CutKind::Relief, dice)),
    ("window shifted", |layout, _, dice| shifted(layout, CutKind::Window, dice)),
    ("slit missing", |layout, _, dice| missing(layout, CutKind::Slit, dice)),
    ("bar missing", |layout, _, dice| missing(layout, CutKind::Relief, dice)),
    ("window missing", |layout, _, dice| missing(layout, CutKind::Window, dice)),
    ("border missing", |layout, _, dice| missing(layout, CutKind::Border, dice)),
    ("any cut twice", |layout, _, dice| {
        let cut = dice.below(layout.paths.len());
        layout.paths.insert(0, layout.paths[cut].clone());
        Some(())
    }),
    ("a corner moved", |layout, _, dice| {
        let cut = dice.below(layout.paths.len());
        let vertices = &mut layout.paths[cut].vertices;
        let corner = dice.below(vertices.len());
        vertices[corner].point += BY * Vec2::from_angle(0.7);
        Some(())
    }),
    ("ligament cut through", |layout, sample, dice| {
        let hinges = &sample.sheet.design.hinges;
        let at = hinges[dice.below(hinges.len())].point;
        let profile = &sample.job.fabrication.profile;
        // Across whatever way the ligament lies.
        let reach = 1.5 * (profile.ligament.width + profile.cut.kerf);
        for angle in [0.0, std::f64::consts::FRAC_PI_2] {
            let along = reach * Vec2::from_angle(angle);
            let at = Point::new(at.x, at.y);
            layout.paths.insert(0, slit(&[at - along, at + along]));
        }
        Some(())
    }),
    ("a cut too many in a piece", |layout, sample, dice| {
        let pieces = &sample.sheet.design.pieces;
        let piece = &pieces[dice.below(pieces.len())];
        let state = if sample.sheet.design.sheet_state == Some(kirimorph::kirigami::design::State::Open) {
            &piece.open
        } else {
            &piece.closed
        };
        let sum = state.iter().fold(Vec2::ZERO, |sum, p| sum + Vec2::new(p.x, p.y));
        let middle = (sum / state.len() as f64).to_point();
        layout.paths.insert(0, slit(&[middle, middle + Vec2::new(1.0, 0.3)]));
        Some(())
    }),
    ("border in inches", |layout, _, dice| {
        let border = dice.cut(layout, CutKind::Border)?;
        moved(&mut layout.paths[border], |p| (p.to_vec2() / 25.4).to_point());
        Some(())
    }),
    ("border not last", |layout, _, dice| {
        let turned = 1 + dice.below(layout.paths.len() - 1);
        layout.paths.rotate_right(turned);
        Some(())
    }),
    ("a layer moved", |layout, _, dice| {
        let kind = layout.paths[dice.below(layout.paths.len())].kind;
        let by = BY * Vec2::from_angle(dice.below(6) as f64);
        layout.paths.iter_mut().filter(|path| path.kind == kind).for_each(|path| moved(path, |p| p + by));
        Some(())
    }),
    ("all of it too large", |layout, _, dice| {
        let scale = 1.0 + 1e-3 * (1 + dice.below(5)) as f64;
        layout.paths.iter_mut().for_each(|path| moved(path, |p| (scale * p.to_vec2()).to_point()));
        Some(())
    }),
    ("all of it mirrored", |layout, _, dice| {
        let at = 100.0 + dice.below(100) as f64;
        for path in &mut layout.paths {
            path.vertices.iter_mut().for_each(|vertex| vertex.bulge = -vertex.bulge);
            moved(path, |p| Point::new(2.0 * at - p.x, p.y));
        }
        Some(())
    }),
];

fn slit(points: &[Point]) -> CutPath {
    let vertices = points.iter().map(|&point| PathVertex { point, bulge: 0.0 }).collect();
    CutPath { kind: CutKind::Slit, vertices, closed: false }
}

fn moved(path: &mut CutPath, by: impl Fn(Point) -> Point) {
    path.vertices.iter_mut().for_each(|vertex| vertex.point = by(vertex.point));
}

fn lengthened(path: &mut CutPath, by: f64) {
    let last = path.vertices.len() - 1;
    let along = (path.vertices[last].point - path.vertices[last - 1].point).normalize();
    path.vertices[last].point += by * along;
}

fn shifted(layout: &mut CutLayout, kind: CutKind, dice: &mut Dice) -> Option<()> {
    let cut = dice.cut(layout, kind)?;
    let vertices = &layout.paths[cut].vertices;
    let along = (vertices[1].point - vertices[0].point).normalize();
    // A bar is where its slit ends: along itself it may not move, nor a slit across itself.
    let by = BY * if kind == CutKind::Relief { along } else { along.turn_90() };
    moved(&mut layout.paths[cut], |p| p + by);
    Some(())
}

fn missing(layout: &mut CutLayout, kind: CutKind, dice: &mut Dice) -> Option<()> {
    let cut = dice.cut(layout, kind)?;
    layout.paths.remove(cut);
    Some(())
}

/// What verification says of files written from a layout.
fn faults(sample: &Sample, layout: &CutLayout) -> Vec<Fault> {
    let (mut dxf, mut svg) = (Vec::new(), Vec::new());
    dxf::write(layout, DxfVersion::R2000, &[hash_comment(HASH)], &mut dxf).unwrap();
    svg::write(layout, &[hash_comment(HASH)], &mut svg).unwrap();
    let wanted = Wanted {
        design: &sample.sheet.design,
        profile: &sample.job.fabrication.profile,
        hash: HASH,
        copies: &ONE_PART,
        tabs: None,
    };
    verify(Files { dxf: &dxf, svg: &svg }, wanted).unwrap().faults
}

/// Adds up what was tried and prints it. All of a kind have to be caught, but of those in `often`, which do not always change
/// what is left: a slit's end within the groove of its bar, a corner moved along its own line, a rough pass whose ground the
/// next one clears, a turn of an upright tool or above the stock. Of these it is so many in ten at least.
fn told(tried: Vec<(String, String, bool)>, often: &[(&str, usize)]) {
    let mut counts: BTreeMap<&str, [usize; 2]> = BTreeMap::new();
    for (_, fault, caught) in &tried {
        let count = counts.entry(fault).or_default();
        *count = [count[0] + 1, count[1] + usize::from(*caught)];
    }
    for (fault, [all, caught]) in &counts {
        println!("{fault:<40} {caught:>4} of {all:>4}");
    }
    let missed: Vec<_> = tried.iter().filter(|(.., caught)| !caught).collect();
    println!("{} of {} caught, missed: {missed:#?}", tried.len() - missed.len(), tried.len());
    for (fault, [all, caught]) in counts {
        let of_ten = often.iter().find(|(name, _)| *name == fault).map_or(10, |(_, of_ten)| *of_ten);
        assert!(10 * caught >= of_ten * all, "{fault}: {caught} of {all}");
    }
}

#[test]
fn every_fault_in_the_laser_files_of_any_sample_is_caught() {
    let samples = samples(Process::Laser);
    assert!(samples.len() >= 10, "{}", samples.len());
    let all: Vec<(usize, usize, u64)> = (0..samples.len())
        .flat_map(|s| (0..LASER_FAULTS.len()).flat_map(move |f| (0..PLACES).map(move |place| (s, f, place))))
        .collect();
    // What is known of an unharmed sheet, its hinge report tells.
    let known: Vec<Vec<Fault>> =
        samples.par_iter().map(|sample| faults(sample, &sample.sheet.layout)).collect();
    assert!(known.iter().flatten().all(|fault| fault.hinge.is_some()), "{known:?}");
    let tried = all.into_par_iter().filter_map(|(s, f, place)| {
        let (sample, (fault, spoil)) = (&samples[s], LASER_FAULTS[f]);
        let mut dice = Dice(1000 * (100 * s + f) as u64 + place);
        let mut layout = sample.sheet.layout.clone();
        spoil(&mut layout, sample, &mut dice)?;
        let caught = faults(sample, &layout).iter().any(|fault| !known[s].contains(fault));
        Some((format!("{}, {place}", sample.name), fault.to_owned(), caught))
    });
    told(tried.collect(), OFTEN_LASER);
}

/// What a fault does to the lines of a program.
type SpoilLines = fn(&mut Vec<String>, &mut Dice) -> Option<()>;

const MILL_FAULTS: [(&str, SpoilLines); 9] = [
    ("a pass missing", |lines, dice| {
        let at = dice.below(lines.len() - 60);
        let cuts: Vec<usize> = (at..lines.len()).filter(|&i| is_cut(&lines[i])).take(40).collect();
        cuts.iter().rev().for_each(|&i| _ = lines.remove(i));
        (cuts.len() == 40).then_some(())
    }),
    ("a coordinate off", |lines, dice| {
        let letter = ['X', 'Y'][dice.below(2)];
        changed(lines, letter, dice, &|value| value + 0.3)
    }),
    ("too deep", |lines, dice| changed(lines, 'Z', dice, &|value| value - 20.0)),
    ("tilt off", |lines, dice| changed(lines, 'B', dice, &|value| value + 8.0)),
    ("a turn too many", |lines, dice| changed(lines, 'C', dice, &|value| value + 360.0)),
    ("a cut as a rapid move", |lines, dice| {
        let at = any(lines, dice, &is_cut)?;
        lines[at] = lines[at].replacen("G1 ", "G0 ", 1);
        Some(())
    }),
    ("too fast", |lines, dice| {
        let at = any(lines, dice, &|line| is_cut(line) && line.contains(" F300.0"))?;
        lines[at] = lines[at].replace(" F300.0", " F400.0");
        Some(())
    }),
    ("the spindle stands", |lines, _| {
        lines.iter_mut().for_each(|line| *line = line.replace("M3", "M5"));
        Some(())
    }),
    ("tilted the other way", |lines, _| {
        let at: Vec<usize> = (0..lines.len()).filter(|&i| is_cut(&lines[i])).collect();
        at.iter().for_each(|&i| lines[i] = word(&lines[i], 'B', &|value| -value).unwrap_or(lines[i].clone()));
        Some(())
    }),
];

/// Deep in the stock: neither on the way there nor back.
fn is_cut(line: &str) -> bool {
    line.starts_with("G1 X") && line.contains(" B")
}

fn any(lines: &[String], dice: &mut Dice, wanted: &dyn Fn(&str) -> bool) -> Option<usize> {
    let all: Vec<usize> = (0..lines.len()).filter(|&i| wanted(&lines[i])).collect();
    (!all.is_empty()).then(|| all[dice.below(all.len())])
}

/// A line with a changed word; `None` where it has none of that letter.
fn word(line: &str, letter: char, change: &dyn Fn(f64) -> f64) -> Option<String> {
    let mut found = false;
    let words: Vec<String> = line
        .split(' ')
        .map(|word| match word.strip_prefix(letter).and_then(|number| number.parse::<f64>().ok()) {
            Some(value) => {
                found = true;
                format!("{letter}{:.5}", change(value))
            }
            None => word.to_owned(),
        })
        .collect();
    found.then(|| words.join(" "))
}

fn changed(lines: &mut [String], letter: char, dice: &mut Dice, change: &dyn Fn(f64) -> f64) -> Option<()> {
    let at = any(lines, dice, &|line| is_cut(line) && word(line, letter, &|v| v).is_some())?;
    lines[at] = word(&lines[at], letter, change)?;
    Some(())
}

/// A sample's program with what it is held against.
struct Program<'a> {
    sample: &'a Sample,
    machine: &'a Machine,
    thick: ThickSheet,
    necks: Vec<Neck>,
    milled: Milled,
}

fn program(sample: &Sample) -> Program<'_> {
    let profile: &Profile = &sample.job.fabrication.profile;
    let (machine, tool) = (sample.job.fabrication.machine.as_ref().unwrap(), profile.tool.unwrap());
    let thick = thicken(&sample.sheet, profile.sheet.thickness, walls(profile)).unwrap();
    let order = Order {
        sheet: &sample.sheet,
        part: &thick.part,
        profile,
        tool: &tool,
        copies: &[Vec2::ZERO],
        machine,
    };
    let header = Header { hash: HASH.to_owned(), spindle_rpm: tool.spindle, ..Header::default() };
    let milled = mill(&order, &header).unwrap();
    let necks = sample.sheet.hinges.iter().map(|row| Neck::new(row, false)).collect();
    Program { sample, machine, thick, necks, milled }
}

impl Program<'_> {
    fn text(&self) -> &str {
        let [(_, text)] = self.milled.program.files.as_slice() else { panic!("more than one file") };
        text
    }

    /// Whether a changed program is refused.
    fn refuses(&self, text: String) -> bool {
        let profile = &self.sample.job.fabrication.profile;
        let wanted = WantedPart {
            part: &self.thick.part,
            copies: 1,
            necks: &self.necks,
            stock: [profile.sheet.width, profile.sheet.height],
            thickness: profile.sheet.thickness,
            radius: 0.5 * profile.cut.kerf,
            tool: &self.milled.tool,
            tabs: &self.milled.planned.tabs,
        };
        let found = measure(&[("mill.ngc".to_owned(), text)], 0, self.machine, &wanted);
        found.map_or(true, |(_, findings)| !findings.is_empty())
    }
}

#[test]
fn every_fault_in_the_programs_of_any_sample_is_caught() {
    let samples = samples(Process::Milling);
    assert!(samples.len() >= 3, "{}", samples.len());
    let programs: Vec<Program> = samples.par_iter().map(program).collect();
    let all: Vec<(usize, usize)> =
        (0..programs.len()).flat_map(|p| (0..MILL_FAULTS.len()).map(move |f| (p, f))).collect();
    let tried = all.into_par_iter().filter_map(|(p, f)| {
        let (program, (fault, spoil)) = (&programs[p], MILL_FAULTS[f]);
        let mut lines: Vec<String> = program.text().lines().map(str::to_owned).collect();
        spoil(&mut lines, &mut Dice(f as u64))?;
        let refused = program.refuses(lines.join("\n") + "\n");
        Some((program.sample.name.clone(), fault.to_owned(), refused))
    });
    for program in &programs {
        assert!(!program.refuses(program.text().to_owned()), "{}", program.sample.name);
    }
    told(tried.collect(), OFTEN_MILL);
}
