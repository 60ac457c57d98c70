//! Every reader under random damage: no panic, no hang, no memory beyond what the file is worth.

mod fuzzing;
mod peers;
mod program;
mod squares;

use std::collections::BTreeMap;
use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use fuzzing::{folder, fuzz};
use kirimorph::fabrication::fabricate::{fabricate, ligament_lengths};
use kirimorph::geometry::Point3;
use kirimorph::geometry::flatten::{ConformalScale, flatten};
use kirimorph::geometry::read::{MeshFormat, parse_mesh, polylines};
use kirimorph::geometry::topology::check_disk;
use kirimorph::geometry::triangulate::triangulate;
use kirimorph::import::{self, Options, Size, import};
use kirimorph::job::read_job;
use kirimorph::kirigami::design::State;
use kirimorph::machine::{self, Header, Machine};
use kirimorph::milling::toolpath::{Block, Contour, Kind, Pose, Rate, Run, Toolpath};
use kirimorph::output::design_json;
use kirimorph::output::{exchange, partial_json};
use kirimorph::pipeline::{Clock, PipelineError, Progress, design};
use kirimorph::profile::{self, Profile};
use kirimorph::verify::{Files, ONE_PART, Wanted, verify};
use nalgebra::{Unit, Vector3};
use program::{Mesh, STEEL, job};
use squares::Squares;

/// The share of the time that one of the targets here has; the rest is for the command line.
const SHARE: f64 = 1.0 / 20.0;

fn steel() -> Profile {
    profile::load("steel-304-0.5mm", Path::new(".")).unwrap()
}

fn bump(cells: [usize; 2]) -> Mesh {
    Mesh::bump([100.0, 80.0], 12.0, cells)
}

/// A folder with a small job and its results in `out`.
static MADE: LazyLock<PathBuf> = LazyLock::new(|| {
    let folder = folder("made");
    fs::write(folder.join("bump.obj"), bump([8, 6]).obj()).unwrap();
    fs::write(folder.join("job.toml"), job("open = \"bump.obj\"", "pieces = [6, 5]", STEEL)).unwrap();
    program::made(&folder, "job.toml", "out");
    folder
});

fn made(name: &str) -> Vec<u8> {
    fs::read(MADE.join("out").join(name)).unwrap()
}

fn texts(texts: &[&str]) -> Vec<Vec<u8>> {
    texts.iter().map(|text| text.as_bytes().to_vec()).collect()
}

#[test]
fn obj() {
    let full = "mtllib a.mtl\no part\nv 0 0 0 1 0.5 0.5\nv 1 0 0\nv 0 1 0.5\nv 1 1 0 1.0\nvt 0 0\nvn 0 0 1\n\
                g a b\nusemtl m\ns off\nf 1/1/1 2//1 3/1 \\\n  4\nl 1 2 -1\nf -1 -2 -3\n";
    let seeds = texts(&[full, &bump([3, 2]).obj()]);
    fuzz("obj", SHARE, &seeds, |bytes| {
        let _ = parse_mesh(bytes, MeshFormat::Obj);
        let _ = polylines::parse(bytes);
    });
}

#[test]
fn stl() {
    let mesh = bump([3, 2]).triangles();
    let seeds = [mesh.stl_bytes(), mesh.stl_text().into_bytes()];
    fuzz("stl", SHARE, &seeds, |bytes| drop(parse_mesh(bytes, MeshFormat::Stl)));
}

/// A mesh as binary PLY with a list before and a value after the indices.
fn binary_ply(big: bool) -> Vec<u8> {
    let mesh = bump([3, 2]);
    let order = if big { "big" } else { "little" };
    let mut bytes = format!(
        "ply\nformat binary_{order}_endian 1.0\ncomment c\nelement vertex {}\nproperty float x\nproperty double y\n\
         property float z\nproperty list uchar short extra\nelement face {}\n\
         property list uchar int vertex_indices\nproperty uchar red\nend_header\n",
        mesh.vertices.len(),
        mesh.faces.len()
    )
    .into_bytes();
    let f32 = |c: f64| if big { (c as f32).to_be_bytes() } else { (c as f32).to_le_bytes() };
    for [x, y, z] in &mesh.vertices {
        bytes.extend(f32(*x));
        bytes.extend(if big { y.to_be_bytes() } else { y.to_le_bytes() });
        bytes.extend(f32(*z));
        bytes.extend([1, 0, 7]);
    }
    for face in &mesh.faces {
        bytes.push(face.len() as u8);
        let index = |v: &usize| if big { (*v as i32).to_be_bytes() } else { (*v as i32).to_le_bytes() };
        bytes.extend(face.iter().flat_map(index));
        bytes.push(9);
    }
    bytes
}

#[test]
fn ply() {
    let seeds = [bump([3, 2]).ply().into_bytes(), binary_ply(false), binary_ply(true)];
    fuzz("ply", SHARE, &seeds, |bytes| drop(parse_mesh(bytes, MeshFormat::Ply)));
}

/// What follows on the reading of a mesh: topology, triangles, flattening.
#[test]
fn surfaces() {
    let seeds = texts(&[&bump([4, 3]).obj(), &bump([3, 3]).triangles().obj()]);
    fuzz("surfaces", SHARE, &seeds, |bytes| {
        let Ok(mesh) = parse_mesh(bytes, MeshFormat::Obj) else { return };
        if mesh.faces.len() > 2000 {
            return;
        }
        let Ok(disk) = check_disk(&mesh) else { return };
        let Ok(surface) = triangulate(&mesh, 1.0) else { return };
        let number = |vertex: &usize| surface.vertex_of.binary_search(vertex).unwrap();
        let cycle: Vec<usize> = disk.boundary.iter().map(number).collect();
        let Ok(scale) = ConformalScale::solve(&surface.mesh, &cycle) else { return };
        if let Ok(flat) = flatten(&surface.mesh, &scale, 2.0) {
            assert!(flat.points.iter().all(|p| p.x.is_finite() && p.y.is_finite()));
        }
    });
}

#[test]
fn jobs() {
    let folder = folder("jobs-files");
    for entry in fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("samples")).unwrap() {
        let path = entry.unwrap().path();
        if path.is_file() {
            fs::copy(&path, folder.join(path.file_name().unwrap())).unwrap();
        }
    }
    let is_job = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "toml");
    let mut jobs: Vec<PathBuf> = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    jobs.retain(is_job);
    jobs.sort();
    let seeds: Vec<Vec<u8>> = jobs.iter().map(|path| fs::read(path).unwrap()).collect();
    let file = folder.join("changed.toml");
    fuzz("jobs", SHARE, &seeds, |bytes| {
        fs::write(&file, bytes).unwrap();
        let _ = read_job(&file).map_err(|error| error.to_string());
    });
}

#[test]
fn profiles() {
    let source = |name: &String| profile::source(name, Path::new(".")).unwrap().text.into_bytes();
    let seeds: Vec<Vec<u8>> = profile::names().iter().map(source).collect();
    fuzz("profiles", SHARE, &seeds, |bytes| {
        let text = String::from_utf8_lossy(bytes);
        let _ = profile::parse(&text, "p", "p.toml").map_err(|error| error.to_string());
    });
}

#[test]
fn machines() {
    let source = |name: &String| machine::source(name, Path::new(".")).unwrap().text.into_bytes();
    let seeds: Vec<Vec<u8>> = machine::names().iter().map(source).collect();
    fuzz("machines", SHARE, &seeds, |bytes| {
        let text = String::from_utf8_lossy(bytes);
        let _ = machine::profile::parse(&text, "m", "m.toml").map_err(|error| error.to_string());
    });
}

#[test]
fn designs() {
    fuzz("designs", SHARE, &[made("design.json")], |bytes| {
        design_json::parse_report(bytes);
        let Ok(design) = design_json::parse(bytes).map_err(|error| error.to_string()) else { return };
        assert_eq!(design_json::check(&design), Ok(()));
        for state in [State::Closed, State::Open] {
            exchange::write_obj(&design, state, Vec::new()).unwrap();
        }
    });
}

/// Designs that can be read are laid out, or refused in words.
#[test]
fn layouts() {
    let steel = steel();
    fuzz("layouts", SHARE, &[made("design.json")], |bytes| {
        let Ok(design) = design_json::parse(bytes) else { return };
        let Ok(lengths) = ligament_lengths(&design, &steel) else { return };
        let _ = fabricate(&design, &steel, &lengths).map_err(|error| error.to_string());
    });
}

#[test]
fn interrupted_designs() {
    let job = read_job(&MADE.join("job.toml")).unwrap();
    let mut steps = 0;
    let mut watch = |progress: &Progress| {
        steps += usize::from(progress.stage == "stage-3");
        if steps > 3 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let Err(PipelineError::Interrupted { reached: Some(reached), .. }) =
        design(&job, &mut Clock::new(&mut watch))
    else {
        panic!("not interrupted")
    };
    let hashes = BTreeMap::from([("job".to_owned(), "0123".to_owned())]);
    let mut seed = Vec::new();
    let kirimorph::pipeline::Partial { stage, pieces, journal } = &*reached;
    let partial = partial_json::Partial { stage, pieces, journal, hashes: &hashes };
    partial_json::write(&partial, &mut seed).unwrap();
    let file = folder("interrupted-file").join("design.partial.json");
    fuzz("interrupted", SHARE, &[seed], |bytes| {
        fs::write(&file, bytes).unwrap();
        let _ = partial_json::read(&file, &hashes).map_err(|error| error.to_string());
    });
}

const OPTIONS: Options = Options { size: Size::Extent(100.0), tolerance: None, gap: 0.0, max_strain: 1e-2 };

#[test]
fn imports_of_pykirigami() {
    let design = Squares::new([3, 2], 10.0, 0.4);
    let out = folder("pykirigami-file");
    let seed = {
        let parsed = design_json::parse(&made("design.json")).unwrap();
        let mut constraints = Vec::new();
        exchange::write_pykirigami_constraints(&parsed, &mut constraints).unwrap();
        let states = [State::Closed, State::Open].map(|state| {
            let mut text = Vec::new();
            exchange::write_pykirigami_state(&parsed, state, &mut text).unwrap();
            text
        });
        [&states[0][..], b"====", &states[1], b"====", &constraints].concat()
    };
    let plain = format!("{}===={}====0 1 1 0\n", squares::rows(&design.closed), squares::rows(&design.open));
    fuzz("pykirigami", SHARE, &[seed, plain.into_bytes()], |bytes| {
        let text = String::from_utf8_lossy(bytes);
        let mut parts = text.split("====");
        for name in [import::CLOSED, import::OPEN, import::CONSTRAINTS] {
            fs::write(out.join(name), parts.next().unwrap_or_default()).unwrap();
        }
        let Ok(source) = import::read_pykirigami(&out).map_err(|error| error.to_string()) else { return };
        let _ = import(source, &OPTIONS).map_err(|error| error.to_string());
    });
}

#[test]
fn imports_of_pieces() {
    let piece = |x: f64, rotation: &str| {
        format!(
            "{{\"polygon\": [[{x}, 0, 0], [{}, 0, 0], [{}, 10, 0], [{x}, 10, 0]], \"rotation\": {rotation}, \
             \"translation\": [0.5, 0, 0]}}",
            x + 10.0,
            x + 10.0
        )
    };
    let rows = [
        piece(0.0, "[1, 0, 0, 0]"),
        piece(10.0, "[[0, -1, 0], [1, 0, 0], [0, 0, 1]]"),
        piece(20.0, "[0.8, 0, 0, 0.6]"),
    ];
    let seed = format!("{{\"version\": 1, \"state\": \"closed\", \"pieces\": [{}]}}", rows.join(",\n"));
    let file = folder("pieces-file").join("pieces.json");
    fuzz("pieces", SHARE, &[seed.into_bytes()], |bytes| {
        fs::write(&file, bytes).unwrap();
        let Ok(source) = import::read_pieces_json(&file).map_err(|error| error.to_string()) else { return };
        let _ = import(source, &OPTIONS).map_err(|error| error.to_string());
    });
}

#[test]
fn cut_files() {
    let design = design_json::parse(&made("design.json")).unwrap();
    let (dxf, svg, steel) = (made("cut.dxf"), made("cut.svg"), steel());
    let wanted = Wanted { design: &design, profile: &steel, hash: "0", copies: &ONE_PART, tabs: None };
    for (name, seed) in [("dxf", &dxf), ("svg", &svg)] {
        fuzz(name, SHARE, std::slice::from_ref(seed), |bytes| {
            let files = match name {
                "dxf" => Files { dxf: bytes, svg: &svg },
                _ => Files { dxf: &dxf, svg: bytes },
            };
            let _ = verify(files, wanted).map_err(|error| error.to_string());
        });
    }
}

fn pose([x, y, z]: [f64; 3], [i, j]: [f64; 2]) -> Pose {
    Pose { tip: Point3::new(x, y, z), axis: Unit::new_normalize(Vector3::new(i, j, 1.0)) }
}

/// Two slots; the axis turns by some degrees where the machine can turn.
fn slots(machine: &Machine) -> Toolpath {
    let tilt = if machine.rotary.is_some() { 0.06 } else { 0.0 };
    let run = |x: f64, tilt: f64| {
        let poses = [-1.0, 0.0, 1.0].map(|t: f64| pose([x + 5.0 * t, 30.0, -5.2], [tilt * t, 0.5 * tilt]));
        let mut blocks = vec![Block { to: poses[0], rate: Rate::Feed(100.0), kind: Kind::Ramp }];
        blocks.extend(poses[1..].iter().map(|&to| Block { to, rate: Rate::Feed(300.0), kind: Kind::Finish }));
        blocks.push(Block { to: poses[2].lifted(6.0), rate: Rate::Feed(800.0), kind: Kind::Retract });
        Run { contour: Contour::Opening, start: poses[0].lifted(6.0), blocks }
    };
    Toolpath { radius: 0.5, thickness: 5.0, runs: vec![run(20.0, tilt), run(40.0, 0.0)] }
}

#[test]
fn programs() {
    let names = machine::names();
    let machines = names.iter().map(|name| machine::load(name, Path::new(".")).unwrap());
    let machines: Vec<(String, Machine)> = names.iter().cloned().zip(machines).collect();
    let header = Header { job: "a (job)".into(), spindle_rpm: 12_000.0, ..Header::default() };
    // The first line says which machine is to read the rest.
    let seed = |(name, machine): &(String, Machine)| {
        let program = machine::post(&slots(machine), machine, &header).unwrap();
        let text: String = program.files.iter().map(|(_, text)| text.as_str()).collect();
        format!("{name}\n{text}").into_bytes()
    };
    let seeds: Vec<Vec<u8>> = machines.iter().map(seed).collect();
    fuzz("programs", SHARE, &seeds, |bytes| {
        let text = String::from_utf8_lossy(bytes);
        let (first, rest) = text.split_once('\n').unwrap_or(("", &text));
        let known = machines.iter().find(|(name, _)| name == first).unwrap_or(&machines[0]);
        let _ = machine::read(rest, &known.1).map_err(|error| error.to_string());
    });
}
