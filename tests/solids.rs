//! The solids that a run leaves, as others read them.

mod peers;
mod program;

use std::path::{Path, PathBuf};

use program::{asked, design, made, number, run};
use serde_json::{Value, json};

fn sample(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("samples").join(name)
}

/// The last event of a run of a sample.
fn result(folder: &Path, name: &str) -> Value {
    let job = sample(&format!("{name}.toml"));
    let run = run(folder, ["make", job.to_str().unwrap(), "-o", "out", "--json"]);
    assert_eq!(run.status, 0, "{}", run.stderr);
    serde_json::from_str(run.stdout.lines().last().unwrap()).unwrap()
}

#[test]
fn solids_of_samples_are_watertight_and_what_the_cuts_leave() {
    for (name, moved, thickness) in
        [("dome", "open.stl", 0.5), ("closing", "closed.stl", 0.5), ("star", "open.stl", 0.5)]
    {
        let folder = peers::fresh_folder(&format!("solids-{name}"));
        let event = result(&folder, name);
        let out = folder.join("out");
        let pieces = design(&out)["pieces"].as_array().unwrap().len();
        let files = event["files"].as_array().unwrap();
        assert!(files.contains(&json!("part.stl")) && files.contains(&json!(moved)), "{event}");
        let told = number(&event["solids"], "volume_mm3");
        assert!(number(&event["solids"], "axis_error_mm") < 0.05);
        assert!(number(&event["solids"], "overlap_mm") < 0.01, "{event}");
        let Some(found) = asked(peers::oracle("solids.py"), &[&out, &moved, &thickness.to_string()]) else {
            continue;
        };
        for (key, bodies) in [("part", 1), ("moved", pieces)] {
            let solid = &found[key];
            assert_eq!(
                [&solid["watertight"], &solid["winding"]],
                [&json!(true); 2],
                "{name}, {key}: {solid}"
            );
            assert_eq!(solid["bodies"], bodies, "{name}, {key}");
            assert!(number(solid, "least_area") > 0.0, "{name}, {key}: {solid}");
        }
        // Single precision; and outlines to a micrometre beside cuts with two sides.
        assert!((number(&found["part"], "volume") / told - 1.0).abs() < 1e-6, "{name}: {found} {told}");
        let slack = 2.0 * 1e-3 * number(&found, "cut_length");
        let burned = number(&found, "burned_area");
        assert!((told / thickness - burned).abs() < slack, "{name}: {found} {told}");
        for section in found["sections"].as_array().unwrap() {
            assert_eq!(
                (&section["valid"], &section["bodies"]),
                (&json!(true), &json!(1)),
                "{name}: {section}"
            );
            assert!((number(section, "area") / (told / thickness) - 1.0).abs() < 1e-6, "{name}: {section}");
        }
        assert_eq!(found["height"], json!([-0.5 * thickness, 0.5 * thickness]));
        // Outlines are not symmetric about the middle of the hinge points, but nearly.
        assert!(number(&found, "centre_offset") < 1.0, "{name}: {found}");
        // Pieces are what is left of the part without its ligaments.
        let share = number(&found["moved"], "volume") / told;
        assert!((0.9..1.0).contains(&share), "{name}: {share}");
    }
}

#[test]
fn a_design_without_a_flat_state_has_no_part_and_says_so() {
    let folder = peers::fresh_folder("solids-roof");
    let event = result(&folder, "roof");
    assert!(event["solids"].is_null());
    assert!(event["remark"].as_str().unwrap().contains("no part.stl"), "{event}");
    assert!(!folder.join("out/part.stl").exists());
}

#[test]
fn a_sheet_too_thick_to_open_is_refused_with_the_pieces_and_the_depth() {
    let folder = peers::fresh_folder("solids-thick");
    let job = sample("dome.toml");
    made(&folder, job.to_str().unwrap(), "thin");
    let thin =
        std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("profiles/steel-304-0.5mm.toml"))
            .unwrap();
    let thick = thin.replace("thickness_mm = 0.5", "thickness_mm = 20.0");
    assert_ne!(thin, thick);
    std::fs::write(folder.join("thick.toml"), thick).unwrap();
    let run = run(
        &folder,
        ["fabricate", "thin/design.json", "--profile", "thick.toml", "-o", "out", "--allow-failing-hinges"],
    );
    assert_eq!(run.status, 2, "{run:?}");
    for part in [
        "thick pieces [",
        "overlap by",
        "in the open state",
        "0.510 mm may pass (0.500 mm of it",
        "take a thinner sheet",
    ] {
        assert!(run.stderr.contains(part), "{}", run.stderr);
    }
    assert!(!folder.join("out").exists());
}
