//! The whole program, run as a user runs it, and the folders it works in: shared by the integration tests.

// Each test file uses its own part.
#![allow(dead_code)]

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

/// The files of one run, sorted.
pub const FILES: [&str; 11] = [
    "cut.dxf",
    "cut.svg",
    "design.json",
    "hinges.csv",
    "hinges.json",
    "morph.glb",
    "open.stl",
    "part.stl",
    "preview.svg",
    "report.html",
    "timings.json",
];

/// The same of a sheet that is cut open.
pub const OPEN_SHEET_FILES: [&str; 11] = [
    "closed.stl",
    "cut.dxf",
    "cut.svg",
    "design.json",
    "hinges.csv",
    "hinges.json",
    "morph.glb",
    "part.stl",
    "preview.svg",
    "report.html",
    "timings.json",
];

/// The same of a design without a flat state.
pub const ASSEMBLY_FILES: [&str; 9] = [
    "design.json",
    "hinges.csv",
    "hinges.json",
    "morph.glb",
    "pieces-closed.stl",
    "pieces-open.stl",
    "preview.svg",
    "report.html",
    "timings.json",
];

/// The stages of a sheet for a laser, in their order.
pub const STAGES: [&str; 11] = [
    "read",
    "stage-1",
    "stage-2",
    "stage-3",
    "fabrication",
    "solids",
    "morph",
    "plan",
    "feasibility",
    "output",
    "verify",
];

/// How a run of the program ended.
#[derive(Debug)]
pub struct Run {
    /// Exit status; -1 where a signal ended it.
    pub status: i32,
    pub stdout: String,
    pub stderr: String,
}

/// The program, in a folder.
pub fn command(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_kirimorph"));
    command.current_dir(folder);
    command
}

/// Runs the program in a folder.
pub fn run<S: AsRef<OsStr>>(folder: &Path, arguments: impl IntoIterator<Item = S>) -> Run {
    finish(command(folder).args(arguments))
}

/// Runs a command to its end.
pub fn finish(command: &mut Command) -> Run {
    let output = command.output().unwrap();
    let text = |bytes| String::from_utf8(bytes).expect("output in UTF-8");
    Run {
        status: output.status.code().unwrap_or(-1),
        stdout: text(output.stdout),
        stderr: text(output.stderr),
    }
}

/// Runs the program, which must succeed, and returns what it prints on both streams.
pub fn succeeds(folder: &Path, arguments: &[&str]) -> String {
    let run = run(folder, arguments);
    assert_eq!(run.status, 0, "{arguments:?}: {}", run.stderr);
    run.stdout + &run.stderr
}

/// Runs a job that must succeed and returns its folder.
pub fn made(folder: &Path, job: &str, out: &str) -> PathBuf {
    let run = run(folder, ["make", job, "-o", out]);
    assert_eq!(run.status, 0, "{job}: {}", run.stderr);
    assert_eq!(run.stderr, "", "{job}");
    folder.join(out)
}

/// Runs the program, which must fail with this status and message and change nothing in its folder.
pub fn refused(folder: &Path, arguments: &[&str], status: i32, says: &[&str]) {
    let before = listing(folder);
    let run = run(folder, arguments);
    assert_eq!(run.status, status, "{arguments:?}: {run:?}");
    assert!(run.stderr.starts_with(if status == 1 { "error: " } else { "refused: " }), "{}", run.stderr);
    assert_eq!(run.stdout, "");
    for part in says {
        assert!(run.stderr.contains(part), "{part:?} is not in {}", run.stderr);
    }
    assert!(listing(folder) == before, "files changed: {}", run.stderr);
    if std::env::var_os("SHOW_MESSAGES").is_some() {
        println!("{}", run.stderr);
    }
}

/// The values of a JSON file.
pub fn json_file(file: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(file).unwrap()).unwrap()
}

/// A file of the folder `samples`.
pub fn sample(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("samples").join(name)
}

/// Runs a test program of `tests/oracle`, which prints one line of JSON; `None` where it is missing.
pub fn asked(program: Option<Command>, arguments: &[&dyn AsRef<OsStr>]) -> Option<Value> {
    let mut program = program?;
    let run = finish(program.args(arguments.iter().map(|argument| argument.as_ref())));
    assert_eq!(run.status, 0, "{program:?}: {}{}", run.stdout, run.stderr);
    Some(serde_json::from_str(&run.stdout).unwrap())
}

/// Everything below a folder by path: the bytes of files, `None` for what is no file.
pub type Listing = BTreeMap<PathBuf, Option<Vec<u8>>>;

/// Lists a folder with all that is below.
pub fn listing(folder: &Path) -> Listing {
    let mut found = BTreeMap::new();
    let mut open = vec![folder.to_owned()];
    while let Some(at) = open.pop() {
        for entry in std::fs::read_dir(&at).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path.clone());
            }
            // Pipes and devices have no end.
            let content = path.is_file().then(|| std::fs::read(&path).unwrap());
            found.insert(path, content);
        }
    }
    found
}

/// A number of a JSON file, or a panic that names it.
pub fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("{key} is {}", value[key]))
}

/// `design.json` of a folder.
pub fn design(folder: &Path) -> Value {
    json_file(&folder.join("design.json"))
}

/// All coordinates of a design's corners and pieces, millimetres.
pub fn coordinates(design: &Value) -> Vec<f64> {
    fn numbers(value: &Value, into: &mut Vec<f64>) {
        match value {
            Value::Array(values) => values.iter().for_each(|value| numbers(value, into)),
            value => into.push(value.as_f64().unwrap()),
        }
    }
    let mut all = Vec::new();
    numbers(&design["corners"], &mut all);
    for piece in design["pieces"].as_array().unwrap() {
        numbers(&piece["closed"], &mut all);
        numbers(&piece["open"], &mut all);
    }
    all
}

/// Largest difference between two equally long lists of numbers.
pub fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// The text of a job file with the usual three sections.
pub fn job(target: &str, pattern: &str, fabrication: &str) -> String {
    format!(
        "[target]\n{target}\nclosed = \"flat\"\n\n[pattern]\nkind = \"rotating-rectangles\"\n{pattern}\n\n\
         [fabrication]\n{fabrication}\n"
    )
}

/// The steel profile, as a line of a job file.
pub const STEEL: &str = "profile = \"steel-304-0.5mm\"";

/// A small mesh to write into files.
#[derive(Clone)]
pub struct Mesh {
    pub vertices: Vec<[f64; 3]>,
    pub faces: Vec<Vec<usize>>,
}

impl Mesh {
    /// A bump over a rectangle of `span` mm, higher on one side so that no mirror or turn maps it to itself; quads.
    pub fn bump(span: [f64; 2], height: f64, cells: [usize; 2]) -> Self {
        let [nx, ny] = cells;
        let vertex = |i: usize, j: usize| {
            let (u, v) = (2.0 * i as f64 / nx as f64 - 1.0, 2.0 * j as f64 / ny as f64 - 1.0);
            let z = height * (1.0 - 0.5 * u * u - 0.5 * v * v) * (1.0 + 0.3 * u + 0.15 * v);
            [0.5 * span[0] * u, 0.5 * span[1] * v, z]
        };
        let face = |i: usize, j: usize| {
            let a = j * (nx + 1) + i;
            vec![a, a + 1, a + nx + 2, a + nx + 1]
        };
        Self {
            vertices: (0..=ny).flat_map(|j| (0..=nx).map(move |i| vertex(i, j))).collect(),
            faces: (0..ny).flat_map(|j| (0..nx).map(move |i| face(i, j))).collect(),
        }
    }

    /// The mesh of an OBJ file that holds nothing but `v x y z` and `f a b c ...`.
    pub fn from_obj(text: &str) -> Self {
        fn numbers<T: std::str::FromStr<Err: std::fmt::Debug>>(line: &str) -> Vec<T> {
            line.split_whitespace().skip(1).map(|word| word.parse().unwrap()).collect()
        }
        let lines = |start: &'static str| text.lines().filter(move |line| line.starts_with(start));
        Self {
            vertices: lines("v ").map(|line| numbers(line).try_into().unwrap()).collect(),
            faces: lines("f ").map(|line| numbers::<usize>(line).iter().map(|i| i - 1).collect()).collect(),
        }
    }

    /// Quads split in two.
    pub fn triangles(&self) -> Self {
        let fan = |face: &Vec<usize>| -> Vec<Vec<usize>> {
            (2..face.len()).map(|i| vec![face[0], face[i - 1], face[i]]).collect()
        };
        Self { vertices: self.vertices.clone(), faces: self.faces.iter().flat_map(fan).collect() }
    }

    /// Each vertex moved.
    pub fn moved(&self, by: impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        Self { vertices: self.vertices.iter().map(|&v| by(v)).collect(), faces: self.faces.clone() }
    }

    /// All faces the other way round.
    pub fn inside_out(&self) -> Self {
        let turned = |face: &Vec<usize>| face.iter().rev().copied().collect();
        Self { vertices: self.vertices.clone(), faces: self.faces.iter().map(turned).collect() }
    }

    /// Vertices and faces in another order, faces begun elsewhere.
    pub fn renumbered(&self) -> Self {
        // A step that shares no factor with the count visits all.
        let shuffled = |count: usize| {
            let step = (count / 3..).find(|step| gcd(*step, count) == 1).unwrap();
            (0..count).map(move |i| (i * step + 5) % count)
        };
        let order: Vec<usize> = shuffled(self.vertices.len()).collect();
        let mut number = vec![0; order.len()];
        order.iter().enumerate().for_each(|(new, &old)| number[old] = new);
        let face = |at: usize| {
            let mut face: Vec<usize> = self.faces[at].iter().map(|&v| number[v]).collect();
            let places = face.len();
            face.rotate_left(at % places);
            face
        };
        Self {
            vertices: order.iter().map(|&old| self.vertices[old]).collect(),
            faces: shuffled(self.faces.len()).map(face).collect(),
        }
    }

    /// OBJ with all digits.
    pub fn obj(&self) -> String {
        let mut text = String::new();
        for [x, y, z] in &self.vertices {
            writeln!(text, "v {x:?} {y:?} {z:?}").unwrap();
        }
        for face in &self.faces {
            let indices: Vec<String> = face.iter().map(|v| (v + 1).to_string()).collect();
            writeln!(text, "f {}", indices.join(" ")).unwrap();
        }
        text
    }

    /// ASCII PLY with all digits.
    pub fn ply(&self) -> String {
        let mut text = format!(
            "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\n\
             element face {}\nproperty list uchar int vertex_indices\nend_header\n",
            self.vertices.len(),
            self.faces.len()
        );
        for [x, y, z] in &self.vertices {
            writeln!(text, "{x:?} {y:?} {z:?}").unwrap();
        }
        for face in &self.faces {
            let indices: Vec<String> = face.iter().map(usize::to_string).collect();
            writeln!(text, "{} {}", face.len(), indices.join(" ")).unwrap();
        }
        text
    }

    /// ASCII STL of a triangle mesh; the normals, which readers ignore, are zero.
    pub fn stl_text(&self) -> String {
        let mut text = String::from("solid target\n");
        for face in &self.faces {
            text += "facet normal 0 0 0\n outer loop\n";
            for &v in face {
                let [x, y, z] = self.vertices[v].map(|c| c as f32);
                writeln!(text, "  vertex {x:?} {y:?} {z:?}").unwrap();
            }
            text += " endloop\nendfacet\n";
        }
        text + "endsolid target\n"
    }

    /// Binary STL of a triangle mesh.
    pub fn stl_bytes(&self) -> Vec<u8> {
        let mut bytes = vec![b' '; 80];
        bytes.extend(u32::try_from(self.faces.len()).unwrap().to_le_bytes());
        for face in &self.faces {
            let corners = face.iter().flat_map(|&v| self.vertices[v]);
            let numbers = [0.0; 3].into_iter().chain(corners);
            bytes.extend(numbers.flat_map(|number| (number as f32).to_le_bytes()));
            bytes.extend([0, 0]);
        }
        bytes
    }
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// The text of the sample target.
pub fn sample_dome() -> String {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("samples/dome.obj")).unwrap()
}
