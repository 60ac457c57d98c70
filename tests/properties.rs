//! What must hold for any input of a kind, tried on random ones; `KIRIMORPH_FUZZ_SEED` gives others.

mod fuzzing;

use std::collections::BTreeMap;
use std::path::Path;

use fuzzing::{Random, seed};
use kirimorph::fabrication::layout::{CutKind, CutPath, PathVertex};
use kirimorph::fabrication::order::{cutting_order, travel};
use kirimorph::fabrication::outline::{area, grooves, stroke};
use kirimorph::geometry::Point3;
use kirimorph::machine::{self, Header, Machine};
use kirimorph::milling::toolpath::{Block, Contour, Kind, Pose, Rate, Run, Toolpath};
use kirimorph::profile;
use kurbo::Point;
use nalgebra::{Unit, Vector3};

const ROUNDS: u64 = 40;

fn randoms() -> impl Iterator<Item = Random> {
    (0..ROUNDS).map(|round| Random::new(seed() ^ (round << 32)))
}

fn point(random: &mut Random) -> Point {
    Point::new(200.0 + 190.0 * random.signed(), 150.0 + 140.0 * random.signed())
}

/// Slits with and without arcs, bars across some of their ends, windows and a border.
fn cuts(random: &mut Random) -> Vec<CutPath> {
    let mut paths = Vec::new();
    let vertex = |point: Point, bulge: f64| PathVertex { point, bulge };
    for _ in 0..1 + random.below(40) {
        let (a, b) = (point(random), point(random));
        let bulge = if random.below(3) == 0 { 0.8 * random.signed() } else { 0.0 };
        paths.push(CutPath {
            kind: CutKind::Slit,
            vertices: vec![vertex(a, bulge), vertex(b, 0.0)],
            closed: false,
        });
        if random.below(2) == 0 {
            let across = (b - a).turn_90().normalize();
            let vertices = vec![vertex(b + across, 0.0), vertex(b - across, 0.0)];
            paths.push(CutPath { kind: CutKind::Relief, vertices, closed: false });
        }
    }
    for _ in 0..random.below(5) {
        let at = point(random);
        let vertices = vec![vertex(at, 1.0), vertex(at + (3.0, 0.0), 1.0)];
        paths.push(CutPath { kind: CutKind::Window, vertices, closed: true });
    }
    let border = [(2.0, 2.0), (398.0, 2.0), (398.0, 298.0), (2.0, 298.0)];
    let vertices = border.iter().map(|&(x, y)| vertex(Point::new(x, y), 0.0)).collect();
    paths.push(CutPath { kind: CutKind::Border, vertices, closed: true });
    paths
}

/// The cuts by kind, length and the sum of their points: neither direction nor start of a cut counts.
fn inventory(paths: &[CutPath]) -> BTreeMap<String, usize> {
    let mut all = BTreeMap::new();
    for path in paths {
        let length: f64 = path.segments(1e-4).iter().map(|[a, b]| a.distance(*b)).sum();
        let ends = if path.closed {
            Point::ORIGIN
        } else {
            let last = path.vertices[path.vertices.len() - 1].point;
            path.vertices[0].point.midpoint(last)
        };
        let key = format!("{:?} {} {length:.4} {:.6} {:.6}", path.kind, path.closed, ends.x, ends.y);
        *all.entry(key).or_insert(0) += 1;
    }
    all
}

fn shuffled(paths: &[CutPath], random: &mut Random) -> Vec<CutPath> {
    let mut left = paths.to_vec();
    std::iter::from_fn(|| (!left.is_empty()).then(|| left.swap_remove(random.below(left.len())))).collect()
}

#[test]
fn every_cut_is_made_once_in_any_order_of_the_input() {
    for mut random in randoms() {
        let paths = cuts(&mut random);
        let ligaments: Vec<Point> = (0..random.below(20)).map(|_| point(&mut random)).collect();
        let order = cutting_order(&paths, &ligaments);
        assert_eq!(inventory(&order), inventory(&paths));
        assert_eq!(order, cutting_order(&paths, &ligaments));
        assert_eq!(order[order.len() - 1].kind, CutKind::Border);
        let other = cutting_order(&shuffled(&paths, &mut random), &ligaments);
        assert_eq!(inventory(&other), inventory(&paths));
        let [one, other] = [travel(&order), travel(&other)];
        assert!(one.length >= one.bound * (1.0 - 1e-9), "{one:?}");
        // The bound is of the cuts, whatever their order. The way is one that a search found.
        assert!((one.bound - other.bound).abs() < 1e-6, "{one:?} {other:?}");
        assert!((one.length / other.length - 1.0).abs() < 0.25, "{one:?} {other:?}");
    }
}

/// The area of grooves, holes taken off, overlaps counted twice.
fn burned(paths: &[CutPath], kerf: f64) -> f64 {
    let shapes = grooves(paths.iter(), kerf, 1e-4);
    shapes.iter().map(|shape| shape.iter().map(|contour| area(contour)).sum::<f64>()).sum()
}

#[test]
fn grooves_are_as_wide_as_the_kerf_wherever_they_lie() {
    for mut random in randoms() {
        let kerf = 10f64.powf(1.5 * random.signed() - 1.0);
        let [a, b] = [point(&mut random), point(&mut random)].map(|p| [p.x, p.y]);
        let length = (a[0] - b[0]).hypot(a[1] - b[1]);
        let one: f64 = stroke(vec![vec![a, b]], kerf, false).iter().map(|shape| area(&shape[0])).sum();
        let wanted = length * kerf + std::f64::consts::PI * kerf * kerf / 4.0;
        // Round ends are chords, and points lie on a grid of less than a millionth.
        let grid = 1e-6 * (length + 1.0);
        assert!(one <= wanted + grid && one > wanted - 0.07 * kerf * kerf - grid, "{one} {wanted}");
        let back: f64 = stroke(vec![vec![b, a]], kerf, false).iter().map(|shape| area(&shape[0])).sum();
        assert!((one - back).abs() < grid, "{one} {back}");
        let paths = cuts(&mut random);
        let slits: Vec<CutPath> = paths.iter().filter(|path| !path.closed).cloned().collect();
        let moved: Vec<CutPath> = slits
            .iter()
            .map(|path| {
                let vertices = path.vertices.iter().map(|v| PathVertex {
                    // A quarter turn and a shift.
                    point: Point::new(500.0 - v.point.y, v.point.x + 3.0),
                    ..*v
                });
                CutPath { vertices: vertices.collect(), ..path.clone() }
            })
            .collect();
        let alone: f64 = slits.iter().map(|path| burned(std::slice::from_ref(path), kerf)).sum();
        let turned: f64 = moved.iter().map(|path| burned(std::slice::from_ref(path), kerf)).sum();
        assert!((alone - turned).abs() < 1e-5 * alone, "{alone} {turned} {kerf}");
    }
}

fn pose([x, y, z]: [f64; 3], [i, j]: [f64; 2]) -> Pose {
    Pose { tip: Point3::new(x, y, z), axis: Unit::new_normalize(Vector3::new(i, j, 1.0)) }
}

/// Slots in random directions, the axis leaning by up to some ten degrees, through the upright now and then.
fn toolpath(machine: &Machine, random: &mut Random) -> Toolpath {
    let lean = if machine.rotary.is_some() { 10f64.powf(random.signed() - 1.6) } else { 0.0 };
    let mut runs = Vec::new();
    for slot in 0..1 + random.below(4) {
        let [x, y] = [30.0 + 30.0 * slot as f64, 50.0 + 20.0 * random.signed()];
        let poses: Vec<Pose> = (0..2 + random.below(4))
            .map(|k| {
                let axis =
                    if random.below(5) == 0 { [0.0; 2] } else { [0, 1].map(|_| lean * random.signed()) };
                pose([x + random.signed(), y + 4.0 * k as f64, -5.2], axis)
            })
            .collect();
        let (first, last) = (poses[0], poses[poses.len() - 1]);
        let mut blocks = vec![Block { to: first, rate: Rate::Feed(100.0), kind: Kind::Ramp }];
        blocks.extend(poses[1..].iter().map(|&to| Block { to, rate: Rate::Feed(300.0), kind: Kind::Finish }));
        blocks.push(Block { to: last.lifted(6.0), rate: Rate::Feed(800.0), kind: Kind::Retract });
        runs.push(Run { contour: Contour::Opening, start: first.lifted(6.0), blocks });
    }
    Toolpath { radius: 0.5, thickness: 5.0, runs }
}

/// How far the nearest motion that comes next is from each pose, millimetres at 5 mm from the tip.
fn worst_match(path: &Toolpath, motions: &[machine::Motion]) -> f64 {
    let mut at = 0;
    let mut worst: f64 = 0.0;
    for pose in path.runs.iter().flat_map(|run| run.blocks.iter().map(|block| block.to)) {
        let off = |motion: &machine::Motion| {
            let axis = 5.0 * (motion.pose.axis.as_ref() - pose.axis.as_ref()).norm();
            axis.max((motion.pose.tip - pose.tip).norm())
        };
        let found = motions[at..].iter().position(|motion| off(motion) < 0.02);
        let Some(found) = found else { return f64::INFINITY };
        at += found;
        // Motions may be shorter than what counts as found.
        while motions.get(at + 1).is_some_and(|next| off(next) < off(&motions[at])) {
            at += 1;
        }
        worst = worst.max(off(&motions[at]));
    }
    worst
}

#[test]
fn random_axes_come_back_from_the_program() {
    let header = Header { spindle_rpm: 12_000.0, ..Header::default() };
    let (mut posted, mut refused) = (0, 0);
    for mut random in randoms() {
        for name in machine::names() {
            let machine = machine::load(&name, Path::new(".")).unwrap();
            let path = toolpath(&machine, &mut random);
            let Ok(program) = machine::post(&path, &machine, &header) else {
                refused += 1;
                continue;
            };
            posted += 1;
            let text: String = program.files.iter().map(|(_, text)| text.as_str()).collect();
            let motions = machine::read(&text, &machine).unwrap_or_else(|error| panic!("{name}: {error}"));
            let worst = worst_match(&path, &motions);
            assert!(worst < 0.0075, "{name}: {worst}\n{path:?}");
        }
    }
    println!("{posted} programs, {refused} refused");
    assert!(posted > 4 * refused, "{posted} {refused}");
}

#[test]
fn toml_numbers_are_read_to_the_last_bit() {
    let text = profile::source("steel-304-0.5mm", Path::new(".")).unwrap().text;
    let line = text.lines().find(|line| line.starts_with("kerf_mm")).unwrap();
    let read = |written: &str| {
        let text = text.replacen(line, &format!("kerf_mm = {written}"), 1);
        profile::parse(&text, "steel", "steel.toml").map(|profile| profile.cut.kerf.to_bits())
    };
    for mut random in randoms() {
        let kerf = 0.055 + 0.045 * random.signed();
        for written in
            [format!("{kerf:?}"), format!("{kerf:e}"), format!("+{kerf:.20}"), format!("{kerf:.30}")]
        {
            assert_eq!(read(&written).unwrap(), kerf.to_bits(), "{written}");
        }
        for written in [format!("-{kerf:?}"), format!("{kerf:?}e999"), format!("{kerf:?}.0"), "nan".into()] {
            assert!(read(&written).is_err(), "{written}");
        }
    }
}
