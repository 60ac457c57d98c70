//! Interrupted jobs go on to the same bytes, and machines can follow the work line by line.

mod peers;
mod program;

use std::io::{BufRead, BufReader, Read};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::LazyLock;

use kirimorph::job::read_job;
use kirimorph::pipeline::{Clock, PipelineError, Progress, design};
use program::{FILES, Listing, Run, STEEL, command, job, listing, made, run, sample_dome};
use serde_json::Value;

const PARTIAL: &str = "design.partial.json";

/// A folder with the dome's job, and its results in `whole`, made without an interruption.
static DOME: LazyLock<PathBuf> = LazyLock::new(|| {
    let folder = dome("interruption-dome");
    made(&folder, "job.toml", "whole");
    folder
});

/// A fresh folder with the dome's job.
fn dome(name: &str) -> PathBuf {
    let folder = peers::fresh_folder(name);
    std::fs::write(folder.join("dome.obj"), sample_dome()).unwrap();
    std::fs::write(folder.join("job.toml"), job("open = \"dome.obj\"", "pieces = [20, 20]", STEEL)).unwrap();
    folder
}

/// Runs the job with events and sends it a signal at the first step of a stage's phase; the program must end
/// with status 2.
fn interrupted(folder: &Path, arguments: &[&str], signal: &str, stage: &str, phase: u64) -> Run {
    let mut program = command(folder)
        .args(["make", "job.toml", "--json"])
        .args(arguments)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdout = String::new();
    let mut sent = false;
    for line in BufReader::new(program.stdout.take().unwrap()).lines() {
        let line = line.unwrap();
        let event: Value = serde_json::from_str(&line).unwrap();
        if !sent && event["event"] == "step" && event["stage"] == stage && event["phase"] == phase {
            let kill = Command::new("kill").args([signal, &program.id().to_string()]).status().unwrap();
            assert!(kill.success());
            sent = true;
        }
        stdout += &format!("{line}\n");
    }
    let mut stderr = String::new();
    program.stderr.take().unwrap().read_to_string(&mut stderr).unwrap();
    let run = Run { status: program.wait().unwrap().code().unwrap_or(-1), stdout, stderr };
    assert!(sent && run.status == 2 && run.stderr.starts_with("interrupted: "), "{run:?}");
    run
}

/// A listing of results by name, without the one file that differs between runs.
fn results(folder: &Path) -> Listing {
    let files =
        listing(folder).into_iter().map(|(path, content)| (path.file_name().unwrap().into(), content));
    files.filter(|(path, _)| path != Path::new("timings.json")).collect()
}

#[test]
#[cfg(unix)]
fn an_interrupted_job_goes_on_to_the_same_bytes() {
    let whole = results(&DOME.join("whole"));
    for (out, signal, stage, phase) in
        [("a", "-INT", "stage-2", 0), ("b", "-TERM", "stage-3", 0), ("c", "-INT", "stage-3", 2)]
    {
        let run = interrupted(&DOME, &["-o", out], signal, stage, phase);
        let last: Value = serde_json::from_str(run.stdout.lines().last().unwrap()).unwrap();
        assert_eq!((&last["event"], &last["kind"]), (&"error".into(), &"interrupted".into()), "{last}");
        let left = listing(&DOME.join(out));
        assert_eq!(left.keys().collect::<Vec<_>>(), [&DOME.join(out).join(PARTIAL)]);
        let partial: Value = serde_json::from_slice(left.values().next().unwrap().as_ref().unwrap()).unwrap();
        assert_eq!((&partial["converged"], &partial["stage"]), (&false.into(), &stage.into()));
        assert_eq!(partial["pieces"].as_array().unwrap().len(), 400);
        // Interrupted again on the way, where there is one.
        if out == "b" {
            interrupted(&DOME, &["-o", out, "--resume"], "-INT", "stage-3", 3);
        }
        let resumed = program::run(&DOME, ["make", "job.toml", "-o", out, "--resume"]);
        assert_eq!((resumed.status, resumed.stderr.as_str()), (0, ""), "{resumed:?}");
        assert!(results(&DOME.join(out)) == whole, "interrupted in phase {phase} of {stage}");
    }
}

#[test]
#[cfg(unix)]
fn a_state_that_does_not_fit_is_refused_and_stays() {
    let folder = dome("interruption-refused");
    let none = run(&folder, ["make", "job.toml", "-o", "out", "--resume"]);
    assert_eq!((none.status, none.stdout.as_str()), (1, ""), "{none:?}");
    assert!(none.stderr.contains("design.partial.json cannot be read"), "{}", none.stderr);
    interrupted(&folder, &["-o", "out"], "-INT", "stage-3", 1);
    let file = folder.join("out").join(PARTIAL);
    let sound = std::fs::read_to_string(&file).unwrap();
    let refused = |says: &str| {
        let before = listing(&folder);
        let run = run(&folder, ["make", "job.toml", "-o", "out", "--resume"]);
        assert_eq!((run.status, run.stdout.as_str()), (1, ""), "{says}: {run:?}");
        assert!(run.stderr.starts_with("error: ") && run.stderr.contains(says), "{says}: {}", run.stderr);
        assert!(run.stderr.contains(PARTIAL) && run.stderr.contains("without --resume"), "{}", run.stderr);
        assert_eq!(listing(&folder), before);
    };
    for (find, replace, says) in [
        ("\"program\": \"kirimorph ", "\"program\": \"kirimorph 7", "written by"),
        ("\"converged\": false", "\"converged\": true", "not an interrupted design"),
        (
            "\"stage\": \"stage-2\",\n      \"stopped\"",
            "\"stage\": \"stage-3\",\n      \"stopped\"",
            "not the one",
        ),
        ("\"unknowns\": [\n", "\"unknowns\": [\n        [0.5],\n", "minimisation 0 of the saved state"),
        ("\"pieces\": [", "\"pieces\": ", "at line"),
    ] {
        assert!(sound.contains(find), "{find}");
        std::fs::write(&file, sound.replacen(find, replace, 1)).unwrap();
        refused(says);
    }
    std::fs::write(&file, &sound).unwrap();
    let text = std::fs::read_to_string(folder.join("job.toml")).unwrap();
    std::fs::write(folder.join("job.toml"), text + "# a remark\n").unwrap();
    refused("the job has changed");
    // From the beginning it goes, and says what becomes of the state.
    let fresh = run(&folder, ["make", "job.toml", "-o", "out"]);
    assert_eq!(fresh.status, 0, "{fresh:?}");
    assert!(
        fresh.stdout.contains("The design.partial.json of an interrupted run gave way"),
        "{}",
        fresh.stdout
    );
    assert!(!file.exists());
    // Earlier results stay beside the state of a later run.
    interrupted(&folder, &["-o", "out"], "-INT", "stage-2", 0);
    assert_eq!(listing(&folder.join("out")).len(), FILES.len() + 1);
}

#[test]
fn events_tell_the_work_in_order() {
    let run = run(&DOME, ["make", "job.toml", "-o", "events", "--json"]);
    assert_eq!((run.status, run.stderr.as_str()), (0, ""));
    assert!(results(&DOME.join("events")) == results(&DOME.join("whole")));
    let events: Vec<Value> = run.stdout.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let (result, events) = events.split_last().unwrap();
    let mut stages = Vec::new();
    let mut steps = 0;
    for event in events {
        match (event["event"].as_str().unwrap(), event["state"].as_str()) {
            ("stage", Some("start")) => stages.push((event["stage"].as_str().unwrap(), false)),
            ("stage", Some("end")) => {
                let last = stages.last_mut().unwrap();
                assert_eq!((event["stage"].as_str().unwrap(), last.1), *last);
                assert!(event["seconds"].as_f64().unwrap() >= 0.0);
                last.1 = true;
            }
            ("step", None) => {
                assert_eq!(stages.last(), Some(&(event["stage"].as_str().unwrap(), false)));
                let energies = event["energies"].as_object().unwrap().values();
                let (sum, energy) =
                    (energies.map(|e| e.as_f64().unwrap()).sum::<f64>(), program::number(event, "energy"));
                // The same numbers, summed in another order.
                assert!((sum - energy).abs() <= 1e-12 * energy, "{sum} {energy}");
                assert!(event["iteration"].as_u64() <= event["limit"].as_u64());
                steps += 1;
            }
            _ => panic!("{event}"),
        }
    }
    let names: Vec<&str> = stages.iter().map(|&(name, over)| if over { name } else { "not over" }).collect();
    assert_eq!(names, program::STAGES);
    let design = program::design(&DOME.join("events"));
    let stages = design["report"]["stages"].as_array().unwrap().iter();
    // Stage 1 is no minimisation of the solver's.
    let rows: usize = stages.skip(1).map(|stage| stage["iterations"].as_array().unwrap().len()).sum();
    assert_eq!(steps, rows, "one event for each row of the report");
    assert_eq!((&result["event"], &result["pieces"]), (&"result".into(), &400.into()));
    for (key, figure) in result["figures"].as_object().unwrap() {
        assert_eq!(figure, &design["report"][key], "{key}");
    }
}

#[test]
fn events_tell_of_errors() {
    let folder = dome("interruption-errors");
    std::fs::write(folder.join("bad.toml"), "[target]\nopen = 7\n").unwrap();
    std::fs::write(folder.join("few.toml"), job("open = \"dome.obj\"", "pieces = [999, 999]", STEEL))
        .unwrap();
    for (job, status, kind) in
        [("bad.toml", 1, "error"), ("none.toml", 1, "error"), ("few.toml", 2, "refused")]
    {
        let run = run(&folder, ["make", job, "--json"]);
        assert_eq!(run.status, status, "{run:?}");
        let last: Value = serde_json::from_str(run.stdout.lines().last().unwrap()).unwrap();
        assert_eq!((&last["event"], &last["status"]), (&"error".into(), &status.into()), "{last}");
        assert_eq!(run.stderr, format!("{kind}: {}\n", last["message"].as_str().unwrap()));
    }
    let both = run(&folder, ["make", "job.toml", "--json", "--quiet"]);
    assert_eq!((both.status, both.stdout.as_str()), (1, ""), "{both:?}");
}

#[test]
fn a_pattern_that_does_not_fit_into_memory_is_refused_before_the_optimisation() {
    let folder = dome("interruption-memory");
    let job = read_job(&folder.join("job.toml")).unwrap();
    let mut stages = Vec::new();
    let mut watch = |progress: &Progress| {
        stages.push(progress.stage);
        ControlFlow::Continue(())
    };
    let mut clock = Clock::new(&mut watch);
    clock.memory = Some(1 << 24);
    let Err(PipelineError::Memory(refused)) = design(&job, &mut clock) else { panic!("not refused") };
    assert_eq!((refused.pieces, refused.free), (400, 1 << 24));
    assert!(refused.most > 0 && refused.most < 400);
    drop(clock);
    assert_eq!(stages, ["read", "read", "stage-1", "stage-1"]);
}
