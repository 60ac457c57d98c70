//! The same job gives the same bytes, wherever and whenever it runs; and `check` says of a design what `make` said.

mod peers;
mod program;

use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use program::{FILES, STAGES, STEEL, command, finish, job, listing, made, number, run, sample_dome};
use serde_json::Value;

fn write_dome(folder: &Path) {
    std::fs::write(folder.join("dome.obj"), sample_dome()).unwrap();
    std::fs::write(folder.join("job.toml"), job("open = \"dome.obj\"", "pieces = [24, 24]", STEEL)).unwrap();
}

/// Runs the job of a folder twice, in other surroundings, and compares the files.
fn same_bytes(folder: &Path) {
    let elsewhere = folder.join("elsewhere");
    std::fs::create_dir(&elsewhere).unwrap();
    let first = finish(
        command(folder)
            .env("TZ", "UTC")
            .env("LANG", "C")
            .env("LC_ALL", "C")
            .args(["make", "job.toml", "-o", "one"]),
    );
    let second = finish(
        command(&elsewhere)
            .env("TZ", "Asia/Kathmandu")
            .env("LANG", "de_DE.UTF-8")
            .env("LC_ALL", "de_DE.UTF-8")
            .env("HOME", "/nonexistent")
            .env("RAYON_NUM_THREADS", "1")
            .args(["make", "../job.toml", "--output", "a b/two"]),
    );
    assert_eq!((first.status, second.status), (0, 0), "{}{}", first.stderr, second.stderr);
    let places = [folder.join("one"), elsewhere.join("a b/two")];
    for name in FILES {
        let [one, two] = places.each_ref().map(|place| std::fs::read(place.join(name)).unwrap());
        if name == "timings.json" {
            check_timings(&one);
            check_timings(&two);
        } else {
            assert!(one == two, "{name} differs");
        }
    }
    // What is printed differs in the name of the folder alone.
    assert_eq!(first.stdout.replace("Files in one", ""), second.stdout.replace("Files in a b/two", ""));
}

fn check_timings(bytes: &[u8]) {
    let timings: Value = serde_json::from_slice(bytes).unwrap();
    let stages = timings["stages"].as_array().unwrap();
    let names: Vec<&str> = stages.iter().map(|stage| stage["name"].as_str().unwrap()).collect();
    assert_eq!(names, STAGES);
    assert!(stages.iter().all(|stage| number(stage, "seconds") >= 0.0));
    assert_eq!(timings.as_object().unwrap().len(), 1);
}

#[test]
fn the_dome_is_made_the_same_twice() {
    let folder = peers::fresh_folder("determinism-dome");
    write_dome(&folder);
    same_bytes(&folder);
}

#[test]
fn a_trimmed_grid_is_made_the_same_twice() {
    let Some(target) = peers::shared("meshes/6-sub-lifted.obj") else { return };
    let folder = peers::fresh_folder("determinism-trimmed");
    std::fs::copy(target, folder.join("target.obj")).unwrap();
    let text = job("open = \"target.obj\"\nsize_mm = 300.0", "pieces = [30, 30]", STEEL);
    std::fs::write(folder.join("job.toml"), text).unwrap();
    same_bytes(&folder);
}

#[test]
fn designs_do_not_depend_on_the_number_of_threads() {
    let folder = peers::fresh_folder("determinism-threads");
    std::fs::write(folder.join("dome.obj"), sample_dome()).unwrap();
    // Enough for several levels, many independent subtrees, and closest points in more than one batch.
    std::fs::write(folder.join("job.toml"), job("open = \"dome.obj\"", "pieces = [40, 40]", STEEL)).unwrap();
    let designs = ["1", "2", "3"].map(|threads| {
        let file = format!("with-{threads}.json");
        let mut command = command(&folder);
        let run = finish(command.env("RAYON_NUM_THREADS", threads).args(["design", "job.toml", "-o", &file]));
        assert_eq!(run.status, 0, "{threads} threads: {}", run.stderr);
        std::fs::read(folder.join(file)).unwrap()
    });
    assert!(designs[0].len() > 100_000);
    assert!(designs[1] == designs[0], "two threads differ from one");
    assert!(designs[2] == designs[0], "three threads differ from one");
}

/// A folder with the dome's results in `out`, made once for all tests below.
static DOME: LazyLock<PathBuf> = LazyLock::new(|| {
    let folder = peers::fresh_folder("determinism-check");
    write_dome(&folder);
    made(&folder, "job.toml", "out");
    folder
});

#[test]
fn check_prints_the_worst_hinges() {
    for (design, count) in [("out", 10), ("out/design.json", 3), ("out", 0), ("out", 5000)] {
        let run = run(&DOME, ["check", design, "-p", "steel-304-0.5mm", "-w", &count.to_string()]);
        assert_eq!((run.status, run.stderr.as_str()), (0, ""));
        // A header, the rows, a summary.
        let rows = run.stdout.lines().filter(|line| line.contains("single deployment")).count();
        assert_eq!(rows, count.min(1104), "{}", run.stdout);
        assert!(run.stdout.lines().count() <= rows + 2, "{}", run.stdout);
        assert!(run.stdout.lines().last().unwrap().starts_with("1104 hinges: 1104 ok, 0 warn, 0 fail"));
    }
}

/// Writes the steel profile with a changed line beside the results.
fn changed_profile(name: &str, find: &str, replace: &str) {
    let steel = Path::new(env!("CARGO_MANIFEST_DIR")).join("profiles/steel-304-0.5mm.toml");
    let text = std::fs::read_to_string(steel).unwrap();
    let changed = text.replacen(find, replace, 1);
    assert_ne!(text, changed);
    std::fs::write(DOME.join(name), changed).unwrap();
}

#[test]
fn check_refuses_hinges_that_fail() {
    changed_profile("short.toml", "max_length_mm = 2.0", "max_length_mm = 0.8");
    changed_profile("brittle.toml", "strain_limit = 0.40", "strain_limit = 0.20");
    let arguments = ["check", "out", "-w", "4", "-p", "short.toml"];
    let refused = run(&DOME, arguments);
    assert_eq!(refused.status, 2, "{refused:?}");
    assert!(
        refused.stderr.starts_with("refused: 1104 of 1104 hinges fail; hinge 0 at "),
        "{}",
        refused.stderr
    );
    assert_eq!(refused.stdout.lines().filter(|line| line.contains("  fail  ")).count(), 4, "{refused:?}");
    let allowed = run(&DOME, arguments.iter().copied().chain(["--allow-failing-hinges"]));
    assert_eq!((allowed.status, allowed.stderr.as_str()), (0, ""));
    assert_eq!(allowed.stdout, refused.stdout);
    // Half the strain takes twice the length, which this profile allows.
    let brittle = run(&DOME, ["check", "out", "-p", "brittle.toml"]);
    assert_eq!((brittle.status, brittle.stderr.as_str()), (0, ""), "{brittle:?}");
}

#[test]
fn check_names_faulty_designs() {
    let folder = peers::fresh_folder("determinism-garbage");
    let sound = std::fs::read_to_string(DOME.join("out/design.json")).unwrap();
    let files = [
        ("garbage.json", "\u{1}\u{2}garbage".to_owned()),
        ("half.json", sound[..sound.len() / 2].to_owned()),
        ("empty.json", String::new()),
        ("other.json", "{\"version\": 1}".to_owned()),
        ("nan.json", sound.replacen("\"gap_mm\": 0.55", "\"gap_mm\": NaN", 1)),
        ("range.json", sound.replacen("\"pieces\": [", "\"pieces\": [7000, ", 1)),
    ];
    for (name, content) in files {
        std::fs::write(folder.join(name), content).unwrap();
        let run = run(&folder, ["check", name, "-p", "steel-304-0.5mm"]);
        assert_eq!((run.status, run.stdout.as_str()), (1, ""), "{name}: {run:?}");
        assert!(run.stderr.starts_with("error: ") && run.stderr.contains(name), "{name}: {}", run.stderr);
        assert!(!run.stderr.contains("panicked"), "{}", run.stderr);
    }
    for (design, profile) in [("none", "steel-304-0.5mm"), (".", "steel-304-0.5mm"), ("out", "steal")] {
        let at: &Path = if design == "out" { &DOME } else { &folder };
        let run = run(at, ["check", design, "-p", profile]);
        assert_eq!((run.status, run.stdout.as_str()), (1, ""), "{design}: {run:?}");
    }
}

#[test]
fn usage_errors_are_bad_input() {
    let folder = peers::fresh_folder("determinism-usage");
    for arguments in
        [&[][..], &["make"], &["cut", "job.toml"], &["make", "a.toml", "--fast"], &["check", "x"]]
    {
        let run = run(&folder, arguments);
        assert_eq!((run.status, run.stdout.as_str()), (1, ""), "{arguments:?}");
        assert!(run.stderr.contains("Usage: kirimorph"), "{}", run.stderr);
    }
    for arguments in [["--help"], ["--version"]] {
        let run = run(&folder, arguments);
        assert_eq!((run.status, run.stderr.as_str()), (0, ""));
    }
    let profiles = run(&folder, ["profiles"]);
    assert_eq!(profiles.status, 0);
    for name in ["steel-304-0.5mm", "nitrile-rubber-2mm"] {
        assert!(profiles.stdout.contains(name));
    }
}

#[test]
fn all_files_but_the_times_are_the_same_whatever_the_threads_the_time_zone_and_the_language() {
    let folder = peers::fresh_folder("determinism-surroundings");
    std::fs::write(folder.join("dome.obj"), sample_dome()).unwrap();
    let laser = job("open = \"dome.obj\"", "pieces = [10, 10]", STEEL);
    std::fs::write(folder.join("laser.toml"), laser).unwrap();
    let mill = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples/nylon-dome.toml");
    for (kind, job) in [("laser", Path::new("laser.toml")), ("mill", &mill)] {
        let surroundings = [("1", "Asia/Kathmandu", "C"), ("3", "America/St_Johns", "de_DE.UTF-8")];
        let [one, other] = surroundings.map(|(threads, zone, language)| {
            let mut command = command(&folder);
            command.env("RAYON_NUM_THREADS", threads).env("TZ", zone).env("LC_ALL", language);
            let out = format!("{kind}-{threads}");
            let run = finish(command.arg("make").arg(job).args(["-o", &out]));
            assert_eq!(run.status, 0, "{kind}, {threads} threads: {}", run.stderr);
            let mut files = listing(&folder.join(&out));
            files.remove(&folder.join(&out).join("timings.json")).unwrap();
            files
                .into_iter()
                .map(|(path, bytes)| (path.file_name().unwrap().to_owned(), bytes))
                .collect::<Vec<_>>()
        });
        assert!(one.len() > 8, "{kind}");
        for (a, b) in one.iter().zip(&other) {
            assert!(a == b, "{kind}: {:?} differs", a.0);
        }
        assert_eq!(one.len(), other.len());
    }
}
