//! Programs and data outside the crate that tests measure us with: shared by the integration tests.
//!
//! Where one is missing a test skips itself with a line on standard error, but under `CI=true` it fails: there
//! nothing may pass unseen.

// Each test file uses its own part.
#![allow(dead_code)]

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The Python interpreter with the packages of `tests/oracle/requirements.txt`, made by `tests/run`.
pub fn python() -> Option<PathBuf> {
    present(root().join("target/peers/bin/python"), "run tests/run, which sets it up")
}

/// A file of the shared data beside the repository, for example `shared("meshes/pillow_1.obj")`.
pub fn shared(path: &str) -> Option<PathBuf> {
    present(root().join("../shared").join(path), "put the shared data beside the repository")
}

/// A program of `tests/oracle` ready to take arguments.
pub fn oracle(program: &str) -> Option<Command> {
    let mut command = Command::new(python()?);
    command.arg(root().join("tests/oracle").join(program));
    Some(command)
}

/// What LinuxCNC's stand-alone interpreter, from the search path, makes of a program in a folder: its canonical motions.
///
/// Once in some dozens of runs that interpreter ends at its start without a word, whatever the program: then it is asked again.
/// What it says of a program counts at once.
pub fn rs274(folder: &Path, program: &str) -> Option<String> {
    let rs274 = in_search_path("rs274", "run tests/run as root on Debian, or install LinuxCNC")?;
    // The length stays out: rs274 alone reads the table in inches.
    std::fs::write(folder.join("tool.tbl"), "T1 P1 Z0 D1\n").unwrap();
    let mut command = Command::new(rs274);
    command.args(["-g", "-t", "tool.tbl", program]).current_dir(folder).stdin(Stdio::null());
    let mut ran = command.output().unwrap();
    for _ in 0..3 {
        if ran.status.success() || !ran.stdout.is_empty() || !ran.stderr.is_empty() {
            break;
        }
        ran = command.output().unwrap();
    }
    let canonical = String::from_utf8_lossy(&ran.stdout).into_owned();
    assert!(
        ran.status.success(),
        "{program}: {}\n{canonical}\n{}",
        ran.status,
        String::from_utf8_lossy(&ran.stderr)
    );
    Some(canonical)
}

fn in_search_path(program: &str, remedy: &str) -> Option<PathBuf> {
    let folders = std::env::var_os("PATH").unwrap_or_default();
    let found = std::env::split_paths(&folders).map(|folder| folder.join(program)).find(|path| path.exists());
    present(found.unwrap_or_else(|| PathBuf::from(program)), remedy)
}

/// A program of `tests/oracle` for Node.js, ready to take arguments.
pub fn node(program: &str) -> Option<Command> {
    let mut command =
        Command::new(in_search_path("node", "run tests/run as root on Debian, or install Node.js")?);
    command.arg(root().join("tests/oracle").join(program));
    Some(command)
}

/// The same for a program that drives the browser.
pub fn browser(program: &str) -> Option<Command> {
    let chromium = in_search_path("chromium", NODE_REMEDY)?;
    let mut command = packaged(program)?;
    command.env("CHROMIUM", chromium);
    Some(command)
}

const NODE_REMEDY: &str = "run tests/run as root on Debian, which sets it up";

/// The same for a program that uses packages of `tests/oracle/node`.
pub fn packaged(program: &str) -> Option<Command> {
    let modules = present(root().join("target/peers/node/node_modules"), NODE_REMEDY)?;
    let mut command = node(program)?;
    command.env("NODE_PATH", modules);
    Some(command)
}

/// The bundle of three.js that `tests/run` made from the lock of `src/output/report/three`.
pub fn three() -> Option<PathBuf> {
    present(root().join("target/peers/three/three.min.js"), "run tests/run, which makes it with npm")
}

/// A fresh empty folder for one test, inside the build folder.
pub fn fresh_folder(test: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(test);
    if folder.exists() {
        std::fs::remove_dir_all(&folder).unwrap();
    }
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// Where each text breaks a schema of `docs`, or `None` without Python.
pub fn schema_breaches(test: &str, schema: &str, texts: &[String]) -> Option<Vec<Vec<String>>> {
    let mut oracle = oracle("schema_check.py")?;
    let folder = fresh_folder(test);
    let files: Vec<PathBuf> = (0..texts.len()).map(|i| folder.join(format!("{i}.json"))).collect();
    files.iter().zip(texts).for_each(|(file, text)| std::fs::write(file, text).unwrap());
    let schema = root().join("docs").join(schema);
    let output = oracle.arg(schema).args(&files).output().unwrap();
    let breaches = serde_json::from_slice(&output.stdout);
    Some(breaches.unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr))))
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn present(path: PathBuf, remedy: &str) -> Option<PathBuf> {
    if path.exists() {
        return Some(path);
    }
    let missing = format!("{} is missing: {remedy}", path.display());
    if std::env::var("CI").is_ok_and(|value| value == "true") {
        panic!("{missing}");
    }
    eprintln!("skipped: {missing}");
    None
}
