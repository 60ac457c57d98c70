//! `morph.glb` read back as any reader does, and held against the design; the Khronos validator's verdict.

mod peers;
mod program;
mod squares;

use std::path::{Path, PathBuf};

use kirimorph::geometry::{Point3, Vector3};
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use program::{Mesh, STEEL, asked, design, job, made, number, refused, run};
use serde_json::{Value, json};
use squares::{GRID, PAIR, Squares, write_pair};

/// A file as its header, document and bytes say.
struct Glb {
    document: Value,
    bytes: Vec<u8>,
}

impl Glb {
    fn read(file: &Path) -> Self {
        let all = std::fs::read(file).unwrap();
        let word = |at: usize| u32::from_le_bytes(all[at..at + 4].try_into().unwrap()) as usize;
        assert_eq!((&all[..4], word(4), word(8)), (&b"glTF"[..], 2, all.len()));
        let length = word(12);
        assert_eq!(&all[16..20], b"JSON");
        let document = serde_json::from_slice(&all[20..20 + length]).unwrap();
        assert_eq!(
            (&all[24 + length..28 + length], word(20 + length)),
            (&b"BIN\0"[..], all.len() - 28 - length)
        );
        Self { document, bytes: all[28 + length..].to_vec() }
    }

    /// The numbers of an accessor, `n` to an element.
    fn numbers(&self, accessor: &Value) -> Vec<Vec<f64>> {
        let accessor = &self.document["accessors"][index(accessor)];
        let view = &self.document["bufferViews"][index(&accessor["bufferView"])];
        let n = match accessor["type"].as_str().unwrap() {
            "SCALAR" => 1,
            "VEC3" => 3,
            "VEC4" => 4,
            other => panic!("{other}"),
        };
        let start = index(&view["byteOffset"]) + index(&accessor["byteOffset"]);
        let number = |i: usize| match accessor["componentType"].as_u64().unwrap() {
            5126 => f64::from(f32::from_le_bytes(self.bytes[start + 4 * i..][..4].try_into().unwrap())),
            5123 => f64::from(u16::from_le_bytes(self.bytes[start + 2 * i..][..2].try_into().unwrap())),
            other => panic!("{other}"),
        };
        (0..index(&accessor["count"])).map(|i| (0..n).map(|k| number(n * i + k)).collect()).collect()
    }

    fn vertices(&self, mesh: usize) -> Vec<Point3> {
        let primitive = &self.document["meshes"][mesh]["primitives"][0];
        self.numbers(&primitive["attributes"]["POSITION"]).iter().map(|p| point(p)).collect()
    }

    /// Volume of a mesh, cubic metres, by its triangles.
    fn volume(&self, mesh: usize) -> f64 {
        let vertices = self.vertices(mesh);
        let indices = self.numbers(&self.document["meshes"][mesh]["primitives"][0]["indices"]);
        let corner = |i: usize| vertices[indices[i][0] as usize].coords;
        (0..indices.len()).step_by(3).map(|i| corner(i).dot(&corner(i + 1).cross(&corner(i + 2))) / 6.0).sum()
    }

    /// The transform of a node at a key of the animation.
    fn pose(&self, node: usize, key: usize) -> Isometry3<f64> {
        let animation = &self.document["animations"][0];
        let output = |path: &str| {
            let channels = animation["channels"].as_array().unwrap();
            let channel =
                channels.iter().find(|c| c["target"] == json!({ "node": node, "path": path })).unwrap();
            let sampler = &animation["samplers"][index(&channel["sampler"])];
            self.numbers(&sampler["output"])[key].clone()
        };
        let (t, q) = (output("translation"), output("rotation"));
        let rotation = Quaternion::new(q[3], q[0], q[1], q[2]);
        assert!((rotation.norm() - 1.0).abs() < 1e-6);
        Isometry3::from_parts(Translation3::new(t[0], t[1], t[2]), UnitQuaternion::from_quaternion(rotation))
    }

    fn times(&self) -> Vec<f64> {
        let input = &self.document["animations"][0]["samplers"][0]["input"];
        self.numbers(input).iter().map(|t| t[0]).collect()
    }

    /// At rest.
    fn translation(&self, node: usize) -> Vector3 {
        let t: Vec<f64> = self.document["nodes"][node]["translation"]
            .as_array()
            .unwrap()
            .iter()
            .map(|c| c.as_f64().unwrap())
            .collect();
        Vector3::new(t[0], t[1], t[2])
    }
}

fn index(value: &Value) -> usize {
    value.as_u64().unwrap() as usize
}

fn point(p: &[f64]) -> Point3 {
    Point3::new(p[0], p[1], p[2])
}

/// A point of the design, millimetres, where glTF has it: metres, y up.
fn up(p: &Value) -> Point3 {
    let [x, y, z] = [0, 1, 2].map(|k| p[k].as_f64().unwrap());
    Point3::new(x / 1e3, z / 1e3, -y / 1e3)
}

/// Single precision of half a metre, twice: 0.0001 mm.
const ROUNDING: f64 = 1e-7;

/// Every piece stands where the design has it, in both states, by the animation's first and last key.
fn check_ends(glb: &Glb, design: &Value, sheet: &str) {
    let times = glb.times();
    assert_eq!((times.len(), times[0]), (25, 0.0));
    assert!(times.windows(2).all(|pair| pair[1] > pair[0]));
    let pieces = design["pieces"].as_array().unwrap();
    let children = glb.document["nodes"][0]["children"].as_array().unwrap();
    assert_eq!(children.len(), pieces.len());
    for (i, piece) in pieces.iter().enumerate() {
        let rest = glb.translation(1 + i);
        for (state, key) in [("closed", 0), ("open", 24)] {
            let pose = glb.pose(1 + i, key);
            let points = piece[sheet].as_array().unwrap().iter().zip(piece[state].as_array().unwrap());
            for (from, to) in points {
                let moved = pose * (up(from) - rest);
                assert!((moved - up(to)).norm() < ROUNDING, "piece {i}, {state}: {moved} {}", up(to));
            }
        }
    }
}

/// Hinge points part by no more than this share of an edge on the way, and axes are carried by their pieces.
fn check_way(glb: &Glb, design: &Value, most: f64) -> f64 {
    let count = design["pieces"].as_array().unwrap().len();
    let edge = number(&design["report"], "mean_edge_mm") / 1e3;
    let mut worst = 0.0_f64;
    for key in 0..25 {
        let poses: Vec<Isometry3<f64>> = (0..count).map(|i| glb.pose(1 + i, key)).collect();
        for hinge in design["hinges"].as_array().unwrap() {
            let at = up(&hinge["point"]);
            let [j, k] = [0, 1].map(|end| {
                let piece = index(&hinge["pieces"][end]);
                poses[piece] * (at - glb.translation(1 + piece))
            });
            worst = worst.max((k - j).norm() / edge);
        }
    }
    assert!(worst < most, "{worst}");
    let hinge = &design["hinges"][7];
    let node = &glb.document["nodes"][1 + count + 7];
    let piece = index(&hinge["pieces"][0]);
    let parent = &glb.document["nodes"][1 + piece]["children"];
    assert!(parent.as_array().unwrap().contains(&json!(1 + count + 7)), "{node}");
    let rest = glb.translation(1 + piece) + glb.translation(1 + count + 7);
    assert!((rest - up(&hinge["point"]).coords).norm() < ROUNDING);
    let q: Vec<f64> = node["rotation"].as_array().unwrap().iter().map(|c| c.as_f64().unwrap()).collect();
    let along = UnitQuaternion::from_quaternion(Quaternion::new(q[3], q[0], q[1], q[2])) * Vector3::y();
    assert!((along - (up(&hinge["axis"]).coords * 1e3)).norm() < 1e-8);
    worst
}

/// No error and no warning; `None` without the validator.
fn validated(files: &[PathBuf]) -> Option<Vec<Value>> {
    let arguments: Vec<&dyn AsRef<std::ffi::OsStr>> =
        files.iter().map(|f| f as &dyn AsRef<std::ffi::OsStr>).collect();
    let found = asked(peers::packaged("gltf_check.cjs"), &arguments)?;
    for (found, file) in found.as_array().unwrap().iter().zip(files) {
        let counts = ["errors", "warnings", "infos"].map(|key| &found[key]);
        assert_eq!(counts, [&json!(0); 3], "{}: {found}", file.display());
        assert_eq!((&found["version"], &found["animations"]), (&json!("2.0"), &json!(1)), "{found}");
    }
    Some(found.as_array().unwrap().clone())
}

#[test]
fn a_dome_moves_from_its_sheet_to_its_open_state() {
    let folder = peers::fresh_folder("morph_dome");
    let mesh = Mesh::bump([120.0, 120.0], 30.0, [12, 12]);
    std::fs::write(folder.join("bump.obj"), mesh.obj()).unwrap();
    std::fs::write(folder.join("dome.toml"), job("open = \"bump.obj\"", "pieces = [8, 8]", STEEL)).unwrap();
    let told = run(&folder, ["make", "dome.toml", "-o", "out", "--json"]);
    assert_eq!(told.status, 0, "{}", told.stderr);
    let event: Value = serde_json::from_str(told.stdout.lines().last().unwrap()).unwrap();
    let out = folder.join("out");
    assert!(event["files"].as_array().unwrap().contains(&json!("morph.glb")));
    let (glb, made) = (Glb::read(&out.join("morph.glb")), design(&out));
    check_ends(&glb, &made, "closed");
    let worst = check_way(&glb, &made, 0.03);
    // What the program says of the way is what the file shows, but for single precision.
    assert!((worst - number(&event["morph"], "strain")).abs() < 1e-4, "{worst} {}", event["morph"]);
    assert_eq!(event["morph"]["collisions_sought"], json!(true));
    // A piece is as large as its hinge polygon but for gaps and notches, and 0.5 mm thick.
    let pieces = made["pieces"].as_array().unwrap().len();
    let all: f64 = (0..pieces).map(|piece| glb.volume(piece)).sum();
    let sheet = number(&event["solids"], "volume_mm3") / 1e9;
    assert!(all < sheet && all > 0.93 * sheet, "{all} {sheet}");
    assert!((0..pieces).all(|piece| {
        let heights: Vec<f64> = glb.vertices(piece).iter().map(|p| p.y).collect();
        heights.iter().all(|y| (y.abs() - 0.25e-3).abs() < 1e-9)
    }));
    let Some(found) = validated(&[out.join("morph.glb")]) else { return };
    assert_eq!(found[0]["materials"], 3);
}

#[test]
fn a_sheet_that_is_cut_open_and_one_without_a_flat_state() {
    let folder = peers::fresh_folder("morph_states");
    let mesh = Mesh::bump([120.0, 120.0], 20.0, [12, 12]);
    std::fs::write(folder.join("bump.obj"), mesh.obj()).unwrap();
    let closing = job("", "pieces = [8, 8]", STEEL)
        .replace("closed = \"flat\"", "closed = \"bump.obj\"\nopen = \"flat\"");
    std::fs::write(folder.join("closing.toml"), closing).unwrap();
    let out = made(&folder, "closing.toml", "closing");
    let (glb, open) = (Glb::read(&out.join("morph.glb")), design(&out));
    assert_eq!(open["sheet_state"], "open");
    check_ends(&glb, &open, "open");
    check_way(&glb, &open, 0.05);
    let mut files = vec![out.join("morph.glb")];
    // The same again is the same to the byte; fabricate writes it too.
    let read = |folder: PathBuf| std::fs::read(folder.join("morph.glb")).unwrap();
    let again = made(&folder, "closing.toml", "again");
    assert!(read(out.clone()) == read(again));
    let laid = run(&folder, ["fabricate", "closing", "--profile", "steel-304-0.5mm", "-o", "laid"]);
    assert_eq!(laid.status, 0, "{}", laid.stderr);
    files.push(folder.join("laid/morph.glb"));
    check_ends(&Glb::read(&files[1]), &design(&folder.join("laid")), "open");
    let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples/roof.toml");
    let roof = made(&folder, sample.to_str().unwrap(), "roof");
    let glb = Glb::read(&roof.join("morph.glb"));
    check_ends(&glb, &design(&roof), "closed");
    files.push(roof.join("morph.glb"));
    validated(&files);
}

#[test]
fn squares_of_another_program_are_exported_and_turn_alike() {
    let folder = peers::fresh_folder("morph_squares");
    let turn = 0.6;
    write_pair(&folder, &Squares::new(GRID, 12.0, turn));
    assert_eq!(run(&folder, PAIR).status, 0);
    let flags = ["export", "d.json", "--format", "glb,obj,stl", "--thickness-mm", "2", "-o", "out"];
    let told = run(&folder, flags);
    assert_eq!((told.status, told.stderr.as_str()), (0, ""));
    let mut names: Vec<_> =
        std::fs::read_dir(folder.join("out")).unwrap().map(|e| e.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(
        (names.len(), &names[0], &names[1], &names[2]),
        (15, &"closed.obj".into(), &"morph.glb".into(), &"open.obj".into())
    );
    let file = folder.join("out/morph.glb");
    let glb = Glb::read(&file);
    let text = std::fs::read(folder.join("d.json")).unwrap();
    let squares: Value = serde_json::from_slice(&text).unwrap();
    check_ends(&glb, &squares, "closed");
    for piece in 0..12 {
        // Each of three sides is rounded to single precision.
        assert!((glb.volume(piece) / (12.0 * 12.0 * 2.0 * 1e-9) - 1.0).abs() < 3e-7);
        for key in 0..25 {
            // About the upward axis, which is y; a quarter of the way is a quarter of the turn.
            let sense = if (piece % 4 + piece / 4) % 2 == 0 { 1.0 } else { -1.0 };
            let angle = sense * turn * key as f64 / 24.0;
            let expected = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), angle);
            assert!(glb.pose(1 + piece, key).rotation.angle_to(&expected) < 1e-4, "{piece} {key}");
        }
    }
    validated(&[file]);
    let bare = &flags[..4];
    refused(&folder, &[bare, &["-o", "new"]].concat(), 1, &["--thickness-mm"]);
    refused(&folder, &[bare, &["-o", "new", "--thickness-mm", "0"]].concat(), 1, &["is 0", "above 0"]);
    refused(&folder, &["export", "d.json", "-o", "new"], 1, &["--format"]);
}
