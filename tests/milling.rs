//! Milled sheets, made as a user makes them: every machine's program passes its own verification, LinuxCNC's interpreter and
//! shapely mill the same part from it, and programs with faults are found.

mod peers;
mod program;

use std::fmt::Write;
use std::path::{Path, PathBuf};

use program::{Run, run};
use serde_json::Value;

/// A cap of 144 mm x 144 mm, 11 mm high.
fn cap() -> String {
    let mut text = String::new();
    let at = |k: i32| f64::from(k) / 8.0 - 1.0;
    for (j, i) in (0..=16).flat_map(|j| (0..=16).map(move |i| (j, i))) {
        let (u, v) = (at(i), at(j));
        writeln!(text, "v {} {} {}", 72.0 * u, 72.0 * v, 5.4 * (2.0 - u * u - v * v)).unwrap();
    }
    for (j, i) in (0..16).flat_map(|j| (0..16).map(move |i| (j, i))) {
        let a = 1 + j * 17 + i;
        writeln!(text, "f {} {} {} {}", a, a + 1, a + 18, a + 17).unwrap();
    }
    text
}

const BISTABLE: &str = "kind = \"bistable\"\npieces = [3, 3]\nphi_deg = 16.0\na = 0.38\nb = 0.38";

fn job(pattern: &str, fabrication: &str) -> String {
    format!(
        "[target]\nopen = \"cap.obj\"\nclosed = \"flat\"\n[pattern]\n{pattern}\n[fabrication]\nsheet_mm = [160.0, 160.0]\n{fabrication}\n"
    )
}

/// A folder with a job, and what `make` says.
fn made(name: &str, job: &str) -> (PathBuf, Run) {
    let folder = peers::fresh_folder(&format!("milling-{name}"));
    std::fs::write(folder.join("cap.obj"), cap()).unwrap();
    std::fs::write(folder.join("job.toml"), job).unwrap();
    let done = run(&folder, ["make", "job.toml", "-o", "out"]);
    (folder, done)
}

fn read(file: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(file).unwrap()).unwrap()
}

fn names(folder: &Path) -> Vec<String> {
    let name = |entry: std::io::Result<std::fs::DirEntry>| entry.unwrap().file_name().into_string().unwrap();
    let mut names: Vec<String> = std::fs::read_dir(folder).unwrap().map(name).collect();
    names.sort();
    names
}

/// Poses of the tool on the table as LinuxCNC's interpreter and kinematics have them; `None` without either.
fn poses(folder: &Path) -> Option<PathBuf> {
    let mut oracle = peers::oracle("rs274_poses.py")?;
    let file = |name: &str| std::fs::File::create(folder.join(name)).unwrap();
    std::fs::write(folder.join("canonical"), peers::rs274(folder, "out/mill.ngc")?).unwrap();
    let machine = kirimorph::machine::load("linuxcnc-xyzbc-trt", Path::new(".")).unwrap();
    let rotary = machine.rotary.unwrap();
    let place = |p: kirimorph::geometry::Point3| format!("{},{},{}", p.x, p.y, p.z);
    let done = oracle
        .args(["xyzbc-trt", "1"])
        .args([machine.setup.zero, rotary.turn_centre, rotary.tilt_centre].map(place))
        .stdin(std::fs::File::open(folder.join("canonical")).unwrap())
        .stdout(file("poses"))
        .status();
    assert!(done.unwrap().success());
    Some(folder.join("poses"))
}

/// What shapely mills from an interpreter's poses is the part.
fn check_milled_by_others(folder: &Path) {
    let Some(poses) = poses(folder) else { return };
    let Some(mut oracle) = peers::oracle("milled.py") else { return };
    let done = oracle.arg(poses).arg(folder.join("out")).args(["0.5", "5.0", "0.0"]).output().unwrap();
    let found: Value = serde_json::from_slice(&done.stdout)
        .unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&done.stderr)));
    for height in found["heights"].as_array().unwrap() {
        // Their tool is round at every height: where it leans by 0.1 it is 0.0025 mm wider.
        assert!(height["lost_mm"].as_f64().unwrap() <= 0.01, "{found}");
        assert!(height["left_mm"].as_f64().unwrap() <= 0.02, "{found}");
        assert_eq!(height["bodies"], 1, "{found}");
    }
}

/// A dry run tells what a run would take, and leaves nothing.
fn check_dry_run(folder: &Path) {
    let before = program::listing(folder);
    let arguments = ["fabricate", "out", "-p", "nylon-6-5mm", "--sheet-mm", "160", "160", "--dry-run"];
    let dry = run(folder, arguments);
    assert_eq!(dry.status, 0, "{}", dry.stderr);
    for words in ["way down", "back in cut grooves", "axes turn", "above the stock", "nothing was written"] {
        assert!(dry.stdout.contains(words), "{words}: {}", dry.stdout);
    }
    assert!(!dry.stdout.contains("Files in"), "{}", dry.stdout);
    let told = run(folder, arguments.into_iter().chain(["--json"]));
    let event: Value = serde_json::from_str(told.stdout.lines().last().unwrap()).unwrap();
    assert_eq!((&event["dry_run"], &event["files"]), (&true.into(), &Value::Array(Vec::new())));
    assert!(event["folder"].is_null());
    let made = &read(&folder.join("out/hinges.json"))["mill"];
    for key in ["machine", "runs", "blocks", "moves"] {
        assert_eq!(event["mill"][key], made[key], "{key}");
    }
    assert!(program::listing(folder) == before);
    assert_eq!(run(folder, arguments.into_iter().chain(["-o", "other"])).status, 1);
    assert_eq!(run(folder, ["fabricate", "out", "-p", "nylon-6-5mm"]).status, 1);
}

/// What is left to do after a broken tool is a program of its own.
fn check_rest(folder: &Path) {
    let arguments = [
        "fabricate",
        "out",
        "-p",
        "nylon-6-5mm",
        "--sheet-mm",
        "160",
        "160",
        "--from-run",
        "9",
        "-o",
        "rest",
    ];
    let rest = run(folder, arguments);
    assert_eq!(rest.status, 0, "{}", rest.stderr);
    assert_eq!(read(&folder.join("rest/hinges.json"))["mill"]["first_run"], 8);
    assert_eq!(run(folder, ["verify", "rest"]).status, 0);
}

#[test]
fn a_bistable_cap_is_milled_on_every_machine() {
    let (folder, done) = made("cap", &job(BISTABLE, "profile = \"nylon-6-5mm\""));
    assert_eq!(done.status, 0, "{}", done.stderr);
    assert!(
        done.stdout.contains("milled on linuxcnc-xyzbc-trt, walls along the hinges' axes"),
        "{}",
        done.stdout
    );
    let expected = [
        "design.json",
        "hinges.csv",
        "hinges.json",
        "mill.ngc",
        "morph.glb",
        "open.stl",
        "part.stl",
        "preview.svg",
        "report.html",
        "setup.txt",
        "snap.json",
        "snap.svg",
        "timings.json",
        "toolpath.svg",
    ];
    assert_eq!(names(&folder.join("out")), expected);
    let text = std::fs::read_to_string(folder.join("out/hinges.json")).unwrap();
    let breaches =
        peers::schema_breaches("milling-schema", "hinges.schema.json", std::slice::from_ref(&text));
    assert!(breaches.is_none_or(|found| found.iter().all(Vec::is_empty)));
    let mill = &read(&folder.join("out/hinges.json"))["mill"];
    assert!(
        mill["gouge_mm"].as_f64().unwrap() <= 0.01 && mill["leftover_mm"].as_f64().unwrap() <= 0.02,
        "{mill}"
    );
    assert_eq!((&mill["bodies"], &mill["loose_scraps"]), (&1.into(), &0.into()));
    check_milled_by_others(&folder);
    let verified = run(&folder, ["verify", "out"]);
    assert_eq!(verified.status, 0, "{}", verified.stderr);
    check_dry_run(&folder);
    check_rest(&folder);
    // Not every spindle turns as fast: fewer turns, larger chips.
    let profile =
        std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("profiles/nylon-6-5mm.toml"));
    let slow = profile.unwrap().replace("spindle_rpm = 20000.0", "spindle_rpm = 12000.0");
    std::fs::write(folder.join("slow.toml"), slow.replace("chip_load_mm = 0.015", "chip_load_mm = 0.025"))
        .unwrap();
    for machine in kirimorph::machine::names() {
        let out = format!("out-{machine}");
        let arguments =
            ["fabricate", "out", "-p", "slow.toml", "--machine", &machine, "--sheet-mm", "160", "160"];
        let done = run(&folder, arguments.into_iter().chain(["-o", &out]));
        assert_eq!(done.status, 0, "{machine}: {}", done.stderr);
        let verified = run(&folder, ["verify", &out, "-p", "slow.toml"]);
        assert_eq!(verified.status, 0, "{machine}: {}", verified.stderr);
        let upright = machine.ends_with("xyz");
        assert_eq!(done.stdout.contains("walls upright"), upright, "{machine}: {}", done.stdout);
    }
    check_short_turns(&folder);
}

/// Where the table turns only so far the tool leaves its cut, turns back, and goes on, even in the border.
fn check_short_turns(folder: &Path) {
    let profiles = Path::new(env!("CARGO_MANIFEST_DIR")).join("profiles/machines");
    let machine = std::fs::read_to_string(profiles.join("linuxcnc-xyzbc-trt.toml")).unwrap();
    let short = machine.replace("c_deg = [-36000.0, 36000.0]", "c_deg = [-200.0, 200.0]");
    assert!(short != machine);
    std::fs::write(folder.join("short.toml"), short).unwrap();
    let sheet = ["--sheet-mm", "160", "160"];
    let arguments = ["fabricate", "out", "-p", "slow.toml", "--machine", "short.toml", "-o", "out-short"];
    let done = run(folder, arguments.into_iter().chain(sheet));
    assert_eq!(done.status, 0, "{}", done.stderr);
    let mill = &read(&folder.join("out-short/hinges.json"))["mill"];
    assert!(mill["retreats"].as_u64().unwrap() > 0 && mill["bodies"] == 1, "{mill}");
    let verified = run(folder, ["verify", "out-short", "-p", "slow.toml", "--machine", "short.toml"]);
    assert_eq!(verified.status, 0, "{}", verified.stderr);
    let program = std::fs::read_to_string(folder.join("out-short/mill.ngc")).unwrap();
    // The last run is the border; the tool leaves it on the way.
    let border = program.rsplit_once("border)").unwrap().1;
    assert!(border.lines().filter(|line| line.starts_with("G0 ")).count() > 4, "{border}");
}

#[test]
fn rotating_pieces_have_a_pass_for_each_wall_and_copies_their_own_runs() {
    let pattern = "kind = \"rotating-rectangles\"\npieces = [4, 4]";
    let sheet = "profile = \"nylon-6-conditioned-5mm\"\ncopies = 2\nsheet_mm = [300.0, 160.0]\ntabs = 3";
    let job = job(pattern, sheet).replace("sheet_mm = [160.0, 160.0]\n", "");
    let (folder, done) = made("rotating", &job);
    assert_eq!(done.status, 0, "{}", done.stderr);
    let mill = &read(&folder.join("out/hinges.json"))["mill"];
    assert_eq!(mill["tabs"].as_array().unwrap().len(), 6);
    let verified = run(&folder, ["verify", "out"]);
    assert_eq!(verified.status, 0, "{}", verified.stderr);
}

#[test]
fn the_sample_of_quarter_turns_is_milled() {
    let folder = peers::fresh_folder("milling-dome");
    let samples = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples");
    let done = run(&folder, ["make", samples.join("nylon-dome.toml").to_str().unwrap(), "-o", "out"]);
    assert_eq!(done.status, 0, "{}", done.stderr);
    let report = read(&folder.join("out/hinges.json"));
    let angle = |hinge: &Value| hinge["angle_deg"].as_f64().unwrap();
    assert!(
        report["hinges"]
            .as_array()
            .unwrap()
            .iter()
            .all(|hinge| hinge["verdict"] != "fail" && angle(hinge) > 80.0)
    );
    assert!(report["mill"]["ligament_centre_mm"].as_f64().unwrap() <= 0.005, "{}", report["mill"]);
    let machine = samples.join("machines/bc-trunnion-wedge.toml");
    let verified = run(&folder, ["verify", "out", "--machine", machine.to_str().unwrap()]);
    assert_eq!(verified.status, 0, "{}", verified.stderr);
}

/// The sample with a corner of six pieces, twice as high: the axes of the three hinges there lean by 9 degrees towards each
/// other. The polygon between them is wider than a laser's, so that the axis can turn from one to the next.
#[test]
fn a_corner_of_six_pieces_is_milled_where_its_axes_lean_towards_each_other() {
    let folder = peers::fresh_folder("milling-six");
    let samples = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples");
    let mesh = std::fs::read_to_string(samples.join("star.obj")).unwrap();
    let higher = mesh.lines().fold(String::new(), |mut text, line| {
        match line.strip_prefix("v ").map(|point| point.rsplit_once(' ').unwrap()) {
            Some((xy, z)) => writeln!(text, "v {xy} {}", 2.0 * z.parse::<f64>().unwrap()).unwrap(),
            None => writeln!(text, "{line}").unwrap(),
        }
        text
    });
    std::fs::write(folder.join("star.obj"), higher).unwrap();
    let machine = samples.join("machines/bc-trunnion-wedge.toml");
    let job = format!(
        "[target]\nopen = \"star.obj\"\nclosed = \"flat\"\nsize_mm = 640.0\n\
         [pattern]\nkind = \"rotating-rectangles\"\npiece_mesh = \"star.obj\"\n\
         [fabrication]\nprofile = \"nylon-6-conditioned-5mm\"\nmachine = {machine:?}\nsheet_mm = [900.0, 900.0]\n"
    );
    std::fs::write(folder.join("job.toml"), job).unwrap();
    let done = run(&folder, ["make", "job.toml", "-o", "out"]);
    assert_eq!(done.status, 0, "{}", done.stderr);
    let report = read(&folder.join("out/hinges.json"));
    let hinges = report["hinges"].as_array().unwrap();
    let steep = hinges.iter().filter(|hinge| hinge["tilt_deg"].as_f64().unwrap() > 9.0).count();
    assert_eq!(steep, 3);
    for hinge in hinges {
        assert_eq!(hinge["verdict"], "ok", "{hinge}");
        assert!(hinge["centre_offset_mm"].as_f64().unwrap() < 1e-3, "{hinge}");
    }
    assert!(report["mill"]["ligament_centre_mm"].as_f64().unwrap() <= 0.005, "{}", report["mill"]);
    let verified = run(&folder, ["verify", "out", "--machine", machine.to_str().unwrap()]);
    assert_eq!(verified.status, 0, "{}", verified.stderr);
}

#[test]
fn faults_of_programs_are_found() {
    let (folder, done) = made("faults", &job(BISTABLE, "profile = \"nylon-6-5mm\""));
    assert_eq!(done.status, 0, "{}", done.stderr);
    let program = folder.join("out/mill.ngc");
    let text = std::fs::read_to_string(&program).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let deep = |line: &&str| line.starts_with("G1 X") && line.contains(" B") && !line.contains('Z');
    let at = lines.iter().rposition(deep).unwrap();
    let changed = |change: &dyn Fn(usize, &str) -> Option<String>| -> String {
        let lines = lines.iter().enumerate().filter_map(|(i, line)| change(i, line));
        lines.map(|line| line + "\n").collect()
    };
    let word = |line: &str, letter: char, change: &dyn Fn(f64) -> f64| -> String {
        let words = line.split(' ').map(|word| match word.strip_prefix(letter) {
            Some(number) if !line.starts_with('(') => {
                number.parse().map_or(word.to_owned(), |value: f64| format!("{letter}{:.5}", change(value)))
            }
            _ => word.to_owned(),
        });
        words.collect::<Vec<_>>().join(" ")
    };
    let everywhere = |letter: char, change: &'static dyn Fn(f64) -> f64| {
        changed(&|_, line| Some(word(line, letter, change)))
    };
    let faults: [(&str, String, &str); 8] = [
        ("the tilt's sign", everywhere('B', &|b| -b), "into the part"),
        ("as fast in the material as back in the groove", text.replace("F300.0", "F900.0"), "feed"),
        ("inches", text.replace("G21", "G20"), ""),
        (
            "a turn too many",
            changed(&|i, line| Some(if i == at { word(line, 'C', &|c| c + 360.0) } else { line.into() })),
            "",
        ),
        (
            "a rapid move at depth",
            changed(&|i, line| Some(if i == at { line.replace("G1 ", "G0 ") } else { line.into() })),
            "rapid",
        ),
        (
            "a missing pass",
            changed(&|i, line| (!(i > 40 && i < 120 && line.starts_with("G1"))).then(|| line.into())),
            "",
        ),
        ("the spindle stands", text.replace("M3", "M5"), ""),
        ("another design", text.replace("fnv1a64:", "fnv1a64:0"), "another design"),
    ];
    for (fault, text, says) in faults {
        std::fs::write(&program, text).unwrap();
        let verified = run(&folder, ["verify", "out"]);
        assert!(verified.status > 0, "{fault} passes: {}", verified.stdout);
        assert!(verified.stderr.contains(says), "{fault}: {}", verified.stderr);
    }
}

#[test]
fn what_the_machine_or_the_tool_cannot_do_is_refused_with_numbers() {
    let small = "profile = \"nylon-6-5mm\"\nmachine = \"small.toml\"";
    let (folder, _) = made("refused", &job(BISTABLE, "profile = \"steel-304-0.5mm\""));
    let machine = std::fs::read_to_string(
        Path::new(env!("CARGO_MANIFEST_DIR")).join("profiles/machines/linuxcnc-xyzbc-trt.toml"),
    );
    let machine = machine.unwrap().replace("x_mm = [-300.0, 300.0]", "x_mm = [-30.0, 30.0]");
    std::fs::write(folder.join("small.toml"), machine).unwrap();
    std::fs::write(folder.join("job.toml"), job(BISTABLE, small)).unwrap();
    let done = run(&folder, ["make", "job.toml", "-o", "small"]);
    assert_eq!(done.status, 2, "{}", done.stderr);
    assert!(
        done.stderr.contains("travels from -30 to 30 mm") && !folder.join("small").exists(),
        "{}",
        done.stderr
    );
    let profile =
        std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("profiles/nylon-6-5mm.toml"));
    let short = profile.unwrap().replace("flute_length_mm = 6.0", "flute_length_mm = 5.11");
    std::fs::write(folder.join("short.toml"), short).unwrap();
    std::fs::write(folder.join("job.toml"), job(BISTABLE, "profile = \"short.toml\"")).unwrap();
    let done = run(&folder, ["make", "job.toml", "-o", "short"]);
    assert_eq!(done.status, 2, "{}", done.stderr);
    assert!(done.stderr.contains("cutting edges are 5.11 mm long"), "{}", done.stderr);
}
