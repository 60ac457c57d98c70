//! Runs that are killed at any moment: the folder holds the old results or the new ones, whole.
#![cfg(unix)]

mod peers;
mod program;

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use program::{FILES, Listing, Mesh, STEEL, command, job, listing, run};

/// A folder with two jobs on one target.
fn jobs(name: &str) -> PathBuf {
    let folder = peers::fresh_folder(&format!("killed-{name}"));
    let mesh = Mesh::bump([100.0, 80.0], 12.0, [8, 6]);
    std::fs::write(folder.join("target.obj"), mesh.obj()).unwrap();
    for (file, pieces) in [("old.toml", "pieces = [5, 4]"), ("new.toml", "pieces = [6, 5]")] {
        std::fs::write(folder.join(file), job("open = \"target.obj\"", pieces, STEEL)).unwrap();
    }
    folder
}

/// The files of a folder by name, without the one that differs between runs.
fn results(folder: &Path) -> Listing {
    let files = listing(folder).into_iter().map(|(path, bytes)| (path.file_name().unwrap().into(), bytes));
    files.filter(|(path, _)| path != Path::new("timings.json")).collect()
}

fn start(folder: &Path, job: &str) -> Child {
    let mut command = command(folder);
    command.args(["make", job, "-o", "out"]).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
}

#[test]
fn a_killed_run_leaves_the_old_results_or_the_new_ones() {
    let folder = jobs("kill");
    let [old, new] = ["old", "new"].map(|name| {
        let out = program::made(&folder, &format!("{name}.toml"), &format!("whole-{name}"));
        results(&out)
    });
    let begun = Instant::now();
    program::made(&folder, "new.toml", "out");
    let takes = begun.elapsed();
    let (mut left_old, mut left_new) = (0, 0);
    for round in 0..20 {
        program::made(&folder, "old.toml", "out");
        let mut child = start(&folder, "new.toml");
        // Moments that lie closer to the end, where the writing is.
        let part = 1.0 - (f64::from(round) / 20.0).powi(2);
        std::thread::sleep(takes.mul_f64(1.05 * part));
        let _ = child.kill();
        child.wait().unwrap();
        let found = results(&folder.join("out"));
        assert!(found == old || found == new, "round {round}: {:?}", found.keys());
        assert_eq!(run(&folder, ["verify", "out"]).status, 0);
        *(if found == old { &mut left_old } else { &mut left_new }) += 1;
    }
    println!("old results {left_old} times, new ones {left_new} times");
    // The next run clears away whatever killed ones left beside the folder.
    program::made(&folder, "new.toml", "out");
    let entries = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name());
    let left: Vec<_> = entries.filter(|name| name.to_string_lossy().starts_with('.')).collect();
    assert!(left.is_empty(), "{left:?}");
}

/// Killed where it must not happen: between the last file and the moment when the folder takes its place.
#[test]
fn folders_change_places_in_one_step() {
    let folder = jobs("exchange");
    program::made(&folder, "old.toml", "out");
    let mut child = start(&folder, "new.toml");
    let out = folder.join("out/design.json");
    let begun = Instant::now();
    let mut looks = 0_u64;
    while child.try_wait().unwrap().is_none() {
        for _ in 0..1000 {
            assert!(out.exists(), "for a moment there were no results");
            looks += 1;
        }
        assert!(begun.elapsed() < Duration::from_secs(60));
    }
    assert!(child.wait().unwrap().success() && looks > 0);
    assert_eq!(listing(&folder.join("out")).len(), FILES.len());
}

#[test]
fn a_terminal_that_closes_is_like_an_interruption() {
    let folder = jobs("hangup");
    let mesh = Mesh::bump([200.0, 180.0], 30.0, [20, 20]);
    std::fs::write(folder.join("target.obj"), mesh.obj()).unwrap();
    std::fs::write(folder.join("long.toml"), job("open = \"target.obj\"", "pieces = [40, 40]", STEEL))
        .unwrap();
    for signal in ["-HUP", "-TERM", "-INT"] {
        let mut child = start(&folder, "long.toml");
        std::thread::sleep(Duration::from_millis(700));
        assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap().success());
        let status = child.wait().unwrap();
        assert_eq!(status.code(), Some(2), "{signal}: {status}");
        let out = folder.join("out");
        let left: Vec<PathBuf> = if out.exists() { listing(&out).into_keys().collect() } else { Vec::new() };
        assert!(left.iter().all(|path| path.ends_with("design.partial.json")), "{signal}: {left:?}");
    }
}
