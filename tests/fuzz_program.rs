//! The program itself with random arguments over real and damaged files: it always ends with 0, 1 or 2, in time, and leaves
//! whole files or none.
#![cfg(unix)]

mod fuzzing;
mod program;

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use fuzzing::{LONGEST, Random, first, folder, mutate, seconds, seed};
use program::{Mesh, STEEL, job};

/// The share of the time for this file.
const SHARE: f64 = 0.2;

/// Address space of one run, KiB: far more than these inputs are worth.
const MEMORY: &str = "4000000";

/// Commands with what they need; words in capitals are replaced.
const COMMANDS: [&[&str]; 19] = [
    &["make", "JOB", "-o", "OUT"],
    &["make", "JOB", "-o", "OUT", "--allow-failing-hinges"],
    &["make", "JOB", "-o", "OUT", "--json"],
    &["make", "JOB", "--dry-run"],
    &["design", "JOB", "--feasibility-only"],
    &["design", "JOB", "--feasibility-only", "--map", "FILE"],
    &["design", "JOB", "-o", "FILE"],
    &["check", "DESIGN", "-p", "PROFILE", "-w", "NUMBER"],
    &["fabricate", "DESIGN", "-p", "PROFILE", "-o", "OUT"],
    &[
        "fabricate",
        "DESIGN",
        "-p",
        "PROFILE",
        "--dry-run",
        "--sheet-mm",
        "NUMBER",
        "NUMBER",
        "--kerf-mm",
        "NUMBER",
    ],
    &["fabricate", "DESIGN", "-p", "PROFILE", "-o", "OUT", "--copies", "NUMBER", "--tabs", "NUMBER"],
    &["verify", "DESIGN", "--all"],
    &["import", "--closed", "MESH", "--open", "MESH", "-o", "FILE", "--size-mm", "NUMBER"],
    &["export", "DESIGN", "--obj-pair", "OUT"],
    &["export", "DESIGN", "-o", "OUT", "--format", "stl,glb", "--thickness-mm", "NUMBER"],
    &["snap", "DESIGN", "-p", "PROFILE"],
    &[
        "fabricate",
        "DESIGN",
        "-p",
        "PROFILE",
        "-o",
        "OUT",
        "--order",
        "heat",
        "--cool-s",
        "NUMBER",
        "--leads",
        "arc",
    ],
    &["new", "MESH", "-o", "FILE", "--size-mm", "NUMBER"],
    &["coupon", "-p", "PROFILE", "-o", "OUT"],
];

/// What stands where a path or a name is asked for.
const ODD: [&str; 14] = [
    "",
    ".",
    "..",
    "/",
    "-",
    "--",
    "missing",
    "/dev/null",
    "/dev/full",
    "/proc/self/mem",
    "in/../out",
    "a\nb",
    "%s(\"'",
    "-o",
];

const NUMBERS: [&str; 14] = [
    "0",
    "-1",
    "1",
    "2",
    "100",
    "1e308",
    "-1e308",
    "nan",
    "inf",
    "5e-324",
    "18446744073709551616",
    "0.05",
    "x",
    "",
];

/// The files that are damaged, below the folder of a run.
const DAMAGED: [&str; 12] = [
    "job.toml",
    "bump.obj",
    "bump.stl",
    "bump.ply",
    "steel.toml",
    "made/design.json",
    "made/cut.dxf",
    "made/cut.svg",
    "made/hinges.json",
    "milled/mill.ngc",
    "milled/hinges.json",
    "milled/part.stl",
];

/// Sound files of every kind.
fn prepare(folder: &Path) {
    let mesh = Mesh::bump([100.0, 80.0], 12.0, [6, 5]);
    fs::write(folder.join("bump.obj"), mesh.obj()).unwrap();
    fs::write(folder.join("bump.stl"), mesh.triangles().stl_bytes()).unwrap();
    fs::write(folder.join("bump.ply"), mesh.ply()).unwrap();
    let steel = Path::new(env!("CARGO_MANIFEST_DIR")).join("profiles/steel-304-0.5mm.toml");
    fs::copy(steel, folder.join("steel.toml")).unwrap();
    let target = "open = \"bump.obj\"";
    fs::write(folder.join("job.toml"), job(target, "pieces = [5, 4]", STEEL)).unwrap();
    let cap = Mesh::bump([144.0, 144.0], 0.0, [16, 16]);
    let cap = cap.moved(|[x, y, _]| [x, y, 5.4 * (2.0 - (x / 72.0).powi(2) - (y / 72.0).powi(2))]);
    fs::write(folder.join("cap.obj"), cap.obj()).unwrap();
    let nylon = "profile = \"nylon-6-5mm\"\nsheet_mm = [160.0, 160.0]";
    let cells = "pieces = [3, 3]\nphi_deg = 16.0\na = 0.38\nb = 0.38";
    let mill = job("open = \"cap.obj\"", cells, nylon).replace("rotating-rectangles", "bistable");
    fs::write(folder.join("mill.toml"), mill).unwrap();
    program::made(folder, "job.toml", "made");
    program::made(folder, "mill.toml", "milled");
}

/// One word of a command.
fn word(kind: &str, random: &mut Random) -> String {
    let usual: &[&str] = match kind {
        "JOB" => &["job.toml", "job.toml", "mill.toml"],
        "OUT" => &["out", "deep/out"],
        "FILE" => &["file.json", "file.svg", "deep/file.html", "made/new.json"],
        "DESIGN" => &["made", "made/design.json", "milled"],
        "PROFILE" => &["./steel.toml", "steel-304-0.5mm", "nylon-6-5mm", "nitrile-rubber-2mm"],
        "MESH" => &["bump.obj", "bump.stl", "bump.ply", "made/part.stl"],
        "NUMBER" => return (*random.of(&NUMBERS)).to_owned(),
        _ => return kind.to_owned(),
    };
    let odd = random.below(12) == 0;
    (*if odd { random.of(&ODD) } else { random.of(usual) }).to_owned()
}

/// A command with its words, now and then one too many, one too few or out of order.
fn arguments(random: &mut Random) -> Vec<String> {
    let mut words: Vec<String> = random.of(&COMMANDS).iter().map(|kind| word(kind, random)).collect();
    if random.below(6) == 0 {
        let [a, b] = [random.below(words.len()), random.below(words.len())];
        match random.below(3) {
            0 => words.swap(a, b),
            1 => drop(words.remove(a)),
            _ => words.insert(a, (*random.of(&ODD)).to_owned()),
        }
    }
    // Where a run as root may write, these would be lost.
    words.retain(|word| !word.contains('\0'));
    words
}

/// Runs the program; what takes too long is asked to stop, and must.
fn ended(folder: &Path, arguments: &[String], stderr: &Path) -> Result<ExitStatus, String> {
    let limited = format!("ulimit -v {MEMORY}; exec \"$0\" \"$@\"");
    let mut child = Command::new("sh")
        .args(["-c", &limited, env!("CARGO_BIN_EXE_kirimorph")])
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(File::create(stderr).unwrap())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    let mut asked = false;
    loop {
        if let Some(status) = child.try_wait().unwrap() {
            return Ok(status);
        }
        if begun.elapsed() > LONGEST && !asked {
            asked = Command::new("kill").arg(child.id().to_string()).status().unwrap().success();
        }
        if begun.elapsed() > 2 * LONGEST {
            child.kill().unwrap();
            child.wait().unwrap();
            return Err("does not end, and does not stop when asked to".to_owned());
        }
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// Links what is in one folder into another, with folders: the program never writes into a file that is there.
fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let to = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy(&entry.path(), &to);
        } else {
            fs::hard_link(entry.path(), &to).unwrap();
        }
    }
}

/// Everything below a folder.
fn below(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut open = vec![folder.to_owned()];
    while let Some(at) = open.pop() {
        for path in fs::read_dir(&at).into_iter().flatten().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                open.push(path.clone());
            }
            found.push(path);
        }
    }
    found
}

/// What a run left that it must not leave.
fn left_over(folder: &Path, success: bool) -> Option<String> {
    let is_hidden =
        |path: &PathBuf| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
    if let Some(path) = below(folder).into_iter().find(is_hidden) {
        return Some(format!("left {}", path.display()));
    }
    for out in ["out", "deep/out"] {
        let names = below(&folder.join(out));
        if !success && names.iter().any(|path| !path.ends_with("design.partial.json")) {
            return Some(format!("failed and left {names:?}"));
        }
    }
    None
}

#[test]
fn the_program_ends_well_whatever_it_is_given() {
    let base = folder("program");
    let sound = base.join("sound");
    fs::create_dir(&sound).unwrap();
    prepare(&sound);
    let seeds: Vec<Vec<u8>> = DAMAGED.iter().map(|name| fs::read(sound.join(name)).unwrap()).collect();
    let start = Instant::now();
    let time = Duration::from_secs_f64(seconds() * SHARE);
    let (mut runs, mut by_status) = (0, [0; 3]);
    for number in first().. {
        if start.elapsed() > time && runs > 0 {
            break;
        }
        let mut random = Random::new(seed() ^ number.wrapping_mul(0x9e37_79b9_7f4a_7c15));
        let work = base.join("work");
        let _ = fs::remove_dir_all(&work);
        copy(&sound, &work);
        for _ in 0..random.below(3) {
            let at = random.below(DAMAGED.len());
            let bytes = mutate(&seeds[at], &seeds, &mut random);
            let _ = fs::remove_file(work.join(DAMAGED[at]));
            fs::write(work.join(DAMAGED[at]), bytes).unwrap();
        }
        let arguments = arguments(&mut random);
        let stderr = base.join("stderr");
        let what = match ended(&work, &arguments, &stderr) {
            Err(what) => Some(what),
            Ok(status) => match status.code() {
                Some(code @ 0..=2) => {
                    by_status[code as usize] += 1;
                    left_over(&work, code == 0)
                }
                _ => Some(format!("{status}")),
            },
        };
        if let Some(what) = what {
            panic!(
                "run {number}, {arguments:?} in {}: {what}; {}; again with KIRIMORPH_FUZZ_SEED={} KIRIMORPH_FUZZ_FIRST={number}",
                work.display(),
                String::from_utf8_lossy(&fs::read(stderr).unwrap()),
                seed()
            );
        }
        runs += 1;
    }
    println!(
        "the program: {runs} runs in {:.1} s, by exit status {by_status:?}",
        start.elapsed().as_secs_f64()
    );
}
