//! Sound input that cannot be made: exit status 2, the true reason, and nothing left behind.

mod peers;
mod program;

use program::{Mesh, STEEL, job, listing, run};

/// Runs `make` on job.toml and target.obj in a fresh folder; it must be refused with these words.
fn refuses(name: &str, job: &str, target: &[u8], says: &[&str]) {
    let folder = peers::fresh_folder(&format!("refused-{name}"));
    std::fs::write(folder.join("job.toml"), job).unwrap();
    std::fs::write(folder.join("target.obj"), target).unwrap();
    let before = listing(&folder);
    let run = run(&folder, ["make", "job.toml"]);
    assert_eq!((run.status, run.stdout.as_str()), (2, ""), "{name}: {}", run.stderr);
    assert!(run.stderr.starts_with("refused: "), "{}", run.stderr);
    for part in says {
        assert!(run.stderr.contains(part), "{name}: {part:?} is not in {}", run.stderr);
    }
    assert!(listing(&folder) == before, "{name}: files changed");
}

fn shared(mesh: &str, says: &[&str]) {
    let Some(file) = peers::shared(&format!("meshes/{mesh}.obj")) else { return };
    let text = job("open = \"target.obj\"\nsize_mm = 300.0", "pieces = [30, 30]", STEEL);
    refuses(mesh, &text, &std::fs::read(file).unwrap(), says);
}

#[test]
fn a_face_stretches_too_much() {
    shared(
        "face",
        &[
            "target.obj: flattening the target stretches some places 510.",
            "worst near (",
            "--feasibility-only --map",
        ],
    );
}

#[test]
fn a_sphere_is_closed() {
    shared(
        "choi_sphere",
        &["target.obj: the mesh is a closed surface of genus 0 (like a sphere)", "cut it open"],
    );
}

#[test]
fn a_ring_is_an_annulus() {
    shared("cmc1", &["target.obj: the mesh is an annulus with 2 boundary loops (of 32 and 32 edges)"]);
}

#[test]
fn peaks_are_out_of_reach() {
    shared(
        "choi_peaks",
        &["the largest distance from the target is", "edges, more than the limit of", "farthest off near ("],
    );
}

fn bump() -> Vec<u8> {
    Mesh::bump([100.0, 80.0], 12.0, [8, 6]).obj().into_bytes()
}

#[test]
fn pieces_without_room_for_hinges() {
    let text = job("open = \"target.obj\"", "piece_mm = 2.0", STEEL);
    refuses(
        "small-pieces",
        &text,
        &bump(),
        &["sides of 2.000 mm", "0.550 mm apart", "at least 2.200 mm", "larger pieces"],
    );
}

#[test]
fn a_part_larger_than_the_sheet_names_the_scale_that_fits() {
    let pattern = "pieces = [10, 8]";
    let fabrication = format!("{STEEL}\nsheet_mm = [60.0, 60.0]");
    let text = job("open = \"target.obj\"", pattern, &fabrication);
    refuses(
        "large",
        &text,
        &bump(),
        &["the part measures", "50.00 x 50.00 mm", "scale the target by at most 0."],
    );
    // The scale that it names does fit, but for a hundredth: another size is another optimum.
    let folder = peers::fresh_folder("refused-large-scaled");
    std::fs::write(folder.join("target.obj"), bump()).unwrap();
    std::fs::write(folder.join("job.toml"), &text).unwrap();
    let message = run(&folder, ["make", "job.toml"]).stderr;
    let scale: String =
        message.split("by at most ").nth(1).unwrap().chars().take_while(|c| *c != ',').collect();
    let size = 100.0 * 0.99 * scale.parse::<f64>().unwrap();
    let target = format!("open = \"target.obj\"\nsize_mm = {size:?}");
    std::fs::write(folder.join("scaled.toml"), job(&target, pattern, &fabrication)).unwrap();
    program::made(&folder, "scaled.toml", "out");
}

#[test]
fn hinges_that_the_profile_cannot_turn_fail_unless_allowed() {
    let steel = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("profiles/steel-304-0.5mm.toml");
    let steel = std::fs::read_to_string(steel).unwrap();
    // At some 90 degrees 0.8 mm is enough for the strips beside the ligament, but not for 40 % strain.
    let short = steel.replacen("max_length_mm = 2.0", "max_length_mm = 0.8", 1);
    assert_ne!(steel, short);
    let folder = peers::fresh_folder("refused-short");
    std::fs::write(folder.join("short.toml"), short).unwrap();
    std::fs::write(folder.join("target.obj"), bump()).unwrap();
    let text = job("open = \"target.obj\"", "pieces = [10, 8]", "profile = \"short.toml\"");
    std::fs::write(folder.join("job.toml"), text).unwrap();
    let before = listing(&folder);
    let refused = run(&folder, ["make", "job.toml"]);
    assert_eq!((refused.status, refused.stdout.as_str()), (2, ""), "{}", refused.stderr);
    for part in ["hinges fail; hinge ", "% is above the limit of 40.0 %", "--allow-failing-hinges"] {
        assert!(refused.stderr.contains(part), "{part:?} is not in {}", refused.stderr);
    }
    assert!(listing(&folder) == before);
    let allowed = run(&folder, ["make", "job.toml", "--allow-failing-hinges", "-o", "out"]);
    assert_eq!((allowed.status, allowed.stderr.as_str()), (0, ""));
    let csv = std::fs::read_to_string(folder.join("out/hinges.csv")).unwrap();
    assert!(csv.lines().skip(1).any(|row| row.contains(",fail,")), "the verdict stays");
}
