//! `kirimorph verify` as a user runs it: on folders that `make` left, unharmed and harmed.

mod peers;
mod program;

use std::fs;
use std::path::{Path, PathBuf};

use program::{Run, made, run};

fn sample_file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("samples").join(format!("{name}.toml"))
}

/// Runs `verify`, which must end so.
fn verified(folder: &Path, arguments: &[&str], status: i32) -> Run {
    let run = run(folder, ["verify", "out"].iter().chain(arguments));
    assert_eq!(run.status, status, "{arguments:?}: {run:?}");
    run
}

#[test]
fn the_command_prints_a_table_and_names_every_fault() {
    let folder = peers::fresh_folder("verify-command");
    let out = made(&folder, sample_file("dome").to_str().unwrap(), "out");
    let table = verified(&folder, &[], 0).stdout;
    for line in ["SLIT ", "bodies ", "ligament width ", "safe join tolerance "] {
        assert!(table.contains(line), "{table}");
    }
    verified(&folder, &["--profile", "steel-304-0.5mm"], 0);
    // Another kerf than the files were made for.
    let hinges = fs::read_to_string(out.join("hinges.json")).unwrap();
    fs::write(out.join("hinges.json"), hinges.replacen("\"kerf_mm\": 0.05", "\"kerf_mm\": 0.12", 1)).unwrap();
    let refused = verified(&folder, &[], 2);
    assert!(
        refused.stderr.contains("the ligament is 0.430 mm wide")
            && refused.stderr.contains("more like these")
    );
    assert_eq!(verified(&folder, &["--all"], 2).stderr.matches("mm wide").count(), 1104);
    // Without the report the profile must be named.
    fs::remove_file(out.join("hinges.json")).unwrap();
    assert!(verified(&folder, &[], 1).stderr.contains("--profile"));
    verified(&folder, &["--profile", "steel-304-0.5mm"], 0);
    // Another design.
    let design = fs::read_to_string(out.join("design.json")).unwrap();
    fs::write(out.join("design.json"), format!("{design} ")).unwrap();
    let refused = verified(&folder, &["--profile", "steel-304-0.5mm"], 2);
    assert_eq!(
        refused.stderr.matches("was made from a design with the hash").count(),
        2,
        "{}",
        refused.stderr
    );
    fs::write(out.join("design.json"), design).unwrap();
    fs::remove_file(out.join("cut.svg")).unwrap();
    assert!(
        verified(&folder, &["--profile", "steel-304-0.5mm"], 1).stderr.contains("cut.svg cannot be read")
    );
}

#[test]
fn the_papers_model_without_a_gap_passes_and_tells_how_far_its_ligaments_are_off() {
    let folder = peers::fresh_folder("verify-no-gap");
    let mut job = fs::read_to_string(sample_file("dome")).unwrap();
    let target = sample_file("dome").with_extension("obj");
    job = job.replace("\"dome.obj\"", &format!("{:?}", target.to_str().unwrap()));
    job = job.replace("[pattern]", "[pattern]\ngap_mm = 0.0");
    fs::write(folder.join("flat.toml"), job).unwrap();
    made(&folder, "flat.toml", "out");
    let table = verified(&folder, &[], 0).stdout;
    // Half of ligament and kerf.
    assert!(
        table.lines().any(|line| line.contains("off its hinge") && line.contains("0.2750 mm")),
        "{table}"
    );
}

#[test]
fn copies_are_verified_each_and_their_faults_are_found() {
    let folder = std::env::temp_dir().join(format!("kirimorph-copies-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let job = program::job("open = \"dome.obj\"\nsize_mm = 60", "pieces = [4, 4]", program::STEEL);
    std::fs::write(folder.join("dome.obj"), program::sample_dome()).unwrap();
    let with = |more: &str| std::fs::write(folder.join("job.toml"), format!("{job}{more}\n")).unwrap();
    with("copies = 400");
    program::refused(
        &folder,
        &["make", "job.toml", "-o", "many"],
        2,
        &["400 copies of", "do, ", "in each of"],
    );
    with("copies = 3\nspacing_mm = 2");
    let out = made(&folder, "job.toml", "out");
    let verified = run(&folder, ["verify", "out"]);
    assert_eq!(verified.status, 0, "{verified:?}");
    assert!(verified.stdout.contains("bodies                  3"), "{}", verified.stdout);
    let report: serde_json::Value =
        serde_json::from_slice(&std::fs::read(out.join("hinges.json")).unwrap()).unwrap();
    assert_eq!(report["cut"]["copies_mm"].as_array().unwrap().len(), 3);
    // One copy elsewhere than the report says; one more than there is.
    for (from, to, says) in [
        ("\"copies_mm\":[[0.0,0.0],[", "\"copies_mm\":[[0.0,0.0],[1", "lies in none of the copies"),
        ("\"copies_mm\":[[0.0,0.0],", "\"copies_mm\":[[0.0,0.0],[200.0,200.0],", "there must be 4"),
    ] {
        let text = std::fs::read_to_string(out.join("hinges.json")).unwrap();
        assert!(text.contains(from), "{text}");
        let other = folder.join("other");
        std::fs::create_dir_all(&other).unwrap();
        for name in ["design.json", "cut.dxf", "cut.svg"] {
            std::fs::copy(out.join(name), other.join(name)).unwrap();
        }
        std::fs::write(other.join("hinges.json"), text.replacen(from, to, 1)).unwrap();
        let found = run(&folder, ["verify", "other"]);
        assert!(found.status == 2 && found.stderr.contains(says), "{found:?}");
    }
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn other_piercing_and_order_pass_as_well() {
    let folder = std::env::temp_dir().join(format!("kirimorph-pierce-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let job = program::job("open = \"dome.obj\"\nsize_mm = 100", "pieces = [8, 8]", program::STEEL);
    std::fs::write(folder.join("dome.obj"), program::sample_dome()).unwrap();
    for more in [
        "pierce = \"mid-slit\"",
        "order = \"heat\"",
        "pierce = \"mid-slit\"\norder = \"heat\"\ncool_s = 30\npasses = 3",
    ] {
        std::fs::write(folder.join("job.toml"), format!("{job}{more}\n")).unwrap();
        made(&folder, "job.toml", "out");
        let verified = run(&folder, ["verify", "out"]);
        assert_eq!(verified.status, 0, "{more}: {verified:?}");
    }
    std::fs::remove_dir_all(folder).unwrap();
}
