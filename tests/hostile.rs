//! Sound-looking input that is not, and places that cannot be written: words, no harm.

mod peers;
mod program;

use std::fmt::Write;
use std::path::{Path, PathBuf};

use program::{FILES, Mesh, Run, STEEL, job, listing, run};

fn bump() -> Mesh {
    Mesh::bump([100.0, 80.0], 12.0, [8, 6])
}

fn job_on(target: &str, more: &str) -> String {
    job(&format!("open = \"{target}\"{more}"), "pieces = [6, 5]", STEEL)
}

/// A folder with a sound job.
fn sound(name: &str) -> PathBuf {
    let folder = peers::fresh_folder(&format!("hostile-{name}"));
    std::fs::write(folder.join("target.obj"), bump().obj()).unwrap();
    std::fs::write(folder.join("job.toml"), job_on("target.obj", "")).unwrap();
    folder
}

/// Runs the program, which must refuse with this status and these words, and change nothing.
fn refused(folder: &Path, arguments: &[&str], status: i32, says: &[&str]) {
    program::refused(folder, arguments, status, says);
}

/// The message on a mesh in a job.
fn mesh_refused(name: &str, obj: &str, more: &str, status: i32, says: &[&str]) {
    let folder = sound(name);
    std::fs::write(folder.join("target.obj"), obj).unwrap();
    std::fs::write(folder.join("job.toml"), job_on("target.obj", more)).unwrap();
    refused(&folder, &["make", "job.toml"], status, says);
}

fn scaled(by: f64) -> String {
    bump().moved(|v| v.map(|c| c * by)).obj()
}

#[test]
fn coordinates_at_the_ends_of_the_numbers() {
    mesh_refused("huge", &scaled(1e306), "", 1, &["target.obj: line 1", "beyond the limit"]);
    mesh_refused("denormal", &scaled(1e-320), "", 1, &["target.obj: face 1", "no area"]);
    mesh_refused("denormal-sized", &scaled(1e-320), "\nsize_mm = 100.0", 1, &["target.obj: "]);
    // Small but honest: with a size it is a surface like any other.
    let folder = sound("small");
    std::fs::write(folder.join("target.obj"), scaled(1e-6)).unwrap();
    std::fs::write(folder.join("job.toml"), job_on("target.obj", "\nsize_mm = 100.0")).unwrap();
    program::made(&folder, "job.toml", "out");
}

#[test]
fn meshes_in_other_units() {
    // In metres everything is too small for hinges, in microns too large for the stock.
    mesh_refused("metres", &scaled(1e-3), "", 2, &["too small for hinges", "units"]);
    mesh_refused("microns", &scaled(1e3), "", 2, &["the part measures", "units"]);
}

#[test]
fn meshes_whose_faces_do_not_meet() {
    let mesh = bump();
    // Every face with vertices of its own, as STL has them: an OBJ file that is meant so says it by equal coordinates.
    let mut soup = Mesh { vertices: Vec::new(), faces: Vec::new() };
    for face in &mesh.faces {
        let first = soup.vertices.len();
        soup.vertices.extend(face.iter().map(|&v| mesh.vertices[v]));
        soup.faces.push((first..soup.vertices.len()).collect());
    }
    mesh_refused("soup", &soup.obj(), "", 1, &["target.obj: ", "48 components", "weld"]);
    // A T-junction: one side of an inner edge has a vertex more, which is a slit in the surface.
    let mut torn = mesh.clone();
    let [a, b] = [mesh.faces[20][0], mesh.faces[20][1]];
    let middle = [0, 1, 2].map(|k| 0.5 * (mesh.vertices[a][k] + mesh.vertices[b][k]));
    torn.vertices.push(middle);
    let new = torn.vertices.len() - 1;
    torn.faces[20].insert(1, new);
    mesh_refused("t-junction", &torn.obj(), "", 2, &["target.obj: ", "boundary loops"]);
}

/// A bump of 2 * `side`^2 triangles.
fn large(side: usize) -> String {
    let mut text = String::new();
    let at = |i: usize| 2.0 * i as f64 / side as f64 - 1.0;
    for (j, i) in (0..=side).flat_map(|j| (0..=side).map(move |i| (j, i))) {
        let (u, v) = (at(i), at(j));
        writeln!(text, "v {} {} {}", 50.0 * u, 50.0 * v, 6.0 * (2.0 - u * u - v * v)).unwrap();
    }
    for (j, i) in (0..side).flat_map(|j| (0..side).map(move |i| (j, i))) {
        let a = 1 + j * (side + 1) + i;
        let [b, c, d] = [a + 1, a + side + 2, a + side + 1];
        writeln!(text, "f {a} {b} {c}\nf {a} {c} {d}").unwrap();
    }
    text
}

/// With `KIRIMORPH_FUZZ_SECONDS` at 600 or more a million triangles, else a tenth of that.
#[test]
fn a_mesh_of_a_million_triangles_is_made() {
    let long = std::env::var("KIRIMORPH_FUZZ_SECONDS").ok().and_then(|text| text.parse::<u64>().ok());
    let side = if long.is_some_and(|seconds| seconds >= 600) { 708 } else { 224 };
    let folder = sound("million");
    std::fs::write(folder.join("target.obj"), large(side)).unwrap();
    let begun = std::time::Instant::now();
    program::made(&folder, "job.toml", "out");
    println!("{} triangles: {:.1} s", 2 * side * side, begun.elapsed().as_secs_f64());
}

#[test]
fn toml_that_goes_deep() {
    let folder = sound("deep");
    for (name, text) in [
        ("lists.toml", format!("a = {}", "[".repeat(100_000))),
        ("tables.toml", format!("a = {}", "{a = ".repeat(100_000))),
        ("keys.toml", format!("{}a = 1", "a.".repeat(100_000))),
        ("headers.toml", format!("[{}a]", "a.".repeat(100_000))),
    ] {
        std::fs::write(folder.join(name), text).unwrap();
        refused(&folder, &["make", name], 1, &[name]);
        refused(&folder, &["check", "out", "-p", &format!("./{name}")], 1, &[]);
    }
    let json = "[".repeat(1_000_000);
    std::fs::write(folder.join("design.json"), &json).unwrap();
    refused(&folder, &["check", ".", "-p", "steel-304-0.5mm"], 1, &["design.json"]);
}

/// The fuzzer doubled a part of the border's path a hundred times, with arcs to a place far away: a minute, 5 GB.
#[test]
fn a_cut_file_that_goes_over_its_border_a_hundred_times() {
    let folder = sound("retraced");
    let out = program::made(&folder, "job.toml", "out");
    let svg = std::fs::read_to_string(out.join("cut.svg")).unwrap();
    let line = svg.lines().find(|line| line.contains("class=\"border\"")).unwrap();
    let data = line.split("d=\"").nth(1).unwrap().split(" Z").next().unwrap();
    let far = " A0.275,0.275 0 0 0 5.353002,9262";
    for (way, times, says) in [
        ("", 500, "nearly everywhere"),
        (" A0.275,0.275 0 0 0 500,500", 500, "nearly everywhere"),
        (far, 100, "far outside of the stock"),
        (far, 2000, "has room for"),
    ] {
        let again = data.replace('M', " L") + way;
        let changed = format!("{data}{}", again.repeat(times));
        std::fs::write(out.join("cut.svg"), svg.replacen(data, &changed, 1)).unwrap();
        let begun = std::time::Instant::now();
        let verified = run(&folder, ["verify", "out"]);
        assert!(begun.elapsed().as_secs() < 10, "{way}: {:?}", begun.elapsed());
        assert!(verified.status == 2 && verified.stderr.contains(says), "{way}: {}", verified.stderr);
    }
}

#[test]
fn messages_name_files_as_the_user_did() {
    let folder = sound("names");
    std::fs::create_dir(folder.join("jobs")).unwrap();
    std::fs::write(folder.join("jobs/bad.obj"), "v 0 0 x\n").unwrap();
    std::fs::write(folder.join("jobs/job.toml"), job_on("bad.obj", "")).unwrap();
    let absolute = folder.display().to_string();
    for (arguments, starts) in [
        (["make", "jobs/job.toml"], "error: jobs/bad.obj: line 1"),
        (["make", "./jobs/job.toml"], "error: ./jobs/bad.obj: line 1"),
    ] {
        let run = run(&folder, arguments);
        assert!(run.stderr.starts_with(starts) && !run.stderr.contains(&absolute), "{}", run.stderr);
    }
}

#[cfg(unix)]
mod unix {
    use super::*;
    use std::os::unix::fs::symlink;

    fn names(folder: &Path) -> Vec<String> {
        let entries = std::fs::read_dir(folder).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn links_are_followed_and_stay() {
        let folder = sound("links");
        std::fs::rename(folder.join("target.obj"), folder.join("real.obj")).unwrap();
        symlink("real.obj", folder.join("target.obj")).unwrap();
        std::fs::create_dir_all(folder.join("deep/real")).unwrap();
        symlink("deep/real", folder.join("out")).unwrap();
        program::made(&folder, "job.toml", "out");
        program::made(&folder, "job.toml", "out/.");
        assert!(folder.join("out").is_symlink());
        assert_eq!(names(&folder.join("deep/real")), FILES);
        assert_eq!(names(&folder.join("deep")), ["real"]);
        // A file's link likewise.
        std::fs::write(folder.join("deep/old.json"), "old").unwrap();
        symlink("deep/old.json", folder.join("d.json")).unwrap();
        let designed = run(&folder, ["design", "job.toml", "-o", "d.json"]);
        assert_eq!(designed.status, 0, "{designed:?}");
        assert!(folder.join("d.json").is_symlink() && !folder.join("deep/old.json").is_symlink());
        assert!(std::fs::metadata(folder.join("deep/old.json")).unwrap().len() > 1000);
        // What leads nowhere is named.
        symlink("nowhere", folder.join("lost")).unwrap();
        let lost = run(&folder, ["make", "job.toml", "-o", "lost"]);
        assert!(
            lost.status == 1 && lost.stderr.contains("lost: this is a link that leads nowhere"),
            "{lost:?}"
        );
        symlink("loop", folder.join("loop")).unwrap();
        assert_eq!(run(&folder, ["make", "job.toml", "-o", "loop"]).status, 1);
        assert_eq!(run(&folder, ["design", "job.toml", "-o", "loop"]).status, 1);
    }

    #[test]
    fn devices_and_pipes_are_no_files() {
        let folder = sound("devices");
        for output in ["/dev/null", "/dev/full", "/dev/stdout"] {
            let made = run(&folder, ["design", "job.toml", "-o", output]);
            assert!(made.status == 1 && made.stderr.contains("device or pipe"), "{output}: {made:?}");
            refused(&folder, &["make", "job.toml", "-o", output], 1, &[output, "name a"]);
        }
        assert!(!std::fs::metadata("/dev/null").unwrap().is_file());
        // Told before the work, which this job would not get through: its part is larger than the stock.
        std::fs::write(folder.join("large.toml"), job_on("target.obj", "\nsize_mm = 5000.0")).unwrap();
        refused(&folder, &["design", "large.toml", "-o", "large.json"], 2, &["scale the target by at most"]);
        refused(&folder, &["design", "large.toml", "-o", "."], 1, &["this is a folder"]);
        refused(&folder, &["design", "large.toml", "--map", "/dev/null/map.svg"], 1, &["map.svg"]);
        // A file that never ends.
        symlink("/dev/zero", folder.join("zero.obj")).unwrap();
        std::fs::write(folder.join("zero.toml"), job_on("zero.obj", "")).unwrap();
        let made = run(&folder, ["make", "zero.toml"]);
        assert!(made.status == 1 && made.stderr.contains("device or pipe"), "{made:?}");
        // A pipe into which nobody writes.
        assert!(
            std::process::Command::new("mkfifo").arg(folder.join("pipe.toml")).status().unwrap().success()
        );
        let steel = "steel-304-0.5mm";
        for arguments in
            [&["make", "pipe.toml"][..], &["design", "pipe.toml"], &["check", "pipe.toml", "-p", steel]]
        {
            refused(&folder, arguments, 1, &["pipe.toml", "device or pipe"]);
        }
        let out = program::made(&folder, "job.toml", "out");
        for name in ["cut.dxf", "cut.svg", "hinges.json", "design.json"] {
            let file = out.join(name);
            let bytes = std::fs::read(&file).unwrap();
            std::fs::remove_file(&file).unwrap();
            symlink("/dev/zero", &file).unwrap();
            let verified = run(&folder, ["verify", "out"]);
            assert!(verified.status == 1 && verified.stderr.contains(name), "{verified:?}");
            std::fs::remove_file(&file).unwrap();
            std::fs::write(&file, bytes).unwrap();
        }
        let resumed = folder.join("out/design.partial.json");
        symlink("/dev/zero", resumed).unwrap();
        let resumed = run(&folder, ["make", "job.toml", "-o", "out", "--resume"]);
        assert!(resumed.status == 1 && resumed.stderr.contains("design.partial.json"), "{resumed:?}");
    }

    /// Runs a shell command as the first user of a name space of its own, with a file system of its own on `disk`; `None`
    /// where the system does not allow that.
    fn on_own_disk(folder: &Path, options: &str, then: &str) -> Option<Run> {
        let mount = format!("mount -t tmpfs -o {options} none disk || exit 77; {then}");
        let run = program::finish(
            std::process::Command::new("unshare")
                .args(["-rm", "sh", "-c", &mount, env!("CARGO_BIN_EXE_kirimorph")])
                .current_dir(folder),
        );
        if run.status == 77 || run.stderr.contains("unshare failed") {
            eprintln!("skipped: no file system of its own: {}", run.stderr);
            return None;
        }
        Some(run)
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn a_full_disk_leaves_what_was_there() {
        let folder = sound("full-disk");
        std::fs::create_dir(folder.join("disk")).unwrap();
        let then = "mkdir disk/out; echo old > disk/out/design.json; \"$0\" make job.toml -o disk/out; echo $?; \
                    ls -A disk disk/out; cat disk/out/design.json; \"$0\" design job.toml -o disk/d.json; echo $?; ls -A disk";
        let Some(run) = on_own_disk(&folder, "size=24k", then) else { return };
        assert_eq!(run.stdout, "1\ndisk:\nout\n\ndisk/out:\ndesign.json\nold\n1\nout\n", "{}", run.stderr);
        assert!(
            run.stderr.contains("cannot write the results") && run.stderr.contains("o space left"),
            "{run:?}"
        );
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn a_read_only_disk_is_named() {
        let folder = sound("read-only-disk");
        std::fs::create_dir(folder.join("disk")).unwrap();
        let then = "\"$0\" make job.toml -o disk/out; echo $?; \"$0\" design job.toml -o disk/d.json; echo $?; ls -A disk";
        let Some(run) = on_own_disk(&folder, "ro", then) else { return };
        assert_eq!(run.stdout, "1\n1\n", "{}", run.stderr);
        assert_eq!(run.stderr.matches("Read-only file system").count(), 2, "{}", run.stderr);
    }
}

/// Runs that end at about the same time leave the files of one of them.
#[test]
fn two_runs_into_one_folder() {
    let folder = sound("two");
    let more = std::fs::read_to_string(folder.join("job.toml")).unwrap().replace("[6, 5]", "[5, 4]");
    std::fs::write(folder.join("other.toml"), more).unwrap();
    let wanted = ["job.toml", "other.toml"].map(|job| {
        let out = program::made(&folder, job, &format!("alone-{job}"));
        std::fs::read(out.join("cut.dxf")).unwrap()
    });
    for _ in 0..3 {
        let start = |job: &str| {
            let mut command = program::command(&folder);
            command.args(["make", job, "-o", "out", "--quiet"]).spawn().unwrap()
        };
        for mut run in ["job.toml", "other.toml", "job.toml"].map(start) {
            assert!(run.wait().unwrap().success());
        }
        let out = folder.join("out");
        let cut = std::fs::read(out.join("cut.dxf")).unwrap();
        assert!(wanted.contains(&cut));
        let verified = run(&folder, ["verify", "out"]);
        assert_eq!(verified.status, 0, "{verified:?}");
        assert_eq!(listing(&out).len(), FILES.len());
        let others = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name());
        assert!(others.into_iter().all(|name| !name.to_string_lossy().starts_with('.')), "something is left");
    }
}
