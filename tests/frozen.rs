//! Designs that earlier programs wrote are read for ever: the files of `tests/frozen` are never changed. A new version of the
//! format adds its own, and either reads the old ones or refuses them by the name of their version.

mod peers;
mod program;

use std::path::{Path, PathBuf};

use program::{coordinates, design, largest_difference, run};
use serde_json::Value;

fn frozen() -> Vec<(String, PathBuf)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/frozen");
    let named = |file: PathBuf| (file.file_stem().unwrap().to_str().unwrap().to_owned(), file);
    let mut files: Vec<_> =
        std::fs::read_dir(folder).unwrap().map(|file| named(file.unwrap().path())).collect();
    files.sort();
    files
}

#[test]
fn designs_of_version_1_are_laid_out_as_they_were_designed() {
    let files = frozen();
    assert_eq!(files.len(), 3);
    for (name, file) in files {
        let folder = peers::fresh_folder(&format!("frozen-{name}"));
        std::fs::copy(&file, folder.join("design.json")).unwrap();
        let profile = if name.contains("bistable") { "nylon-6-5mm" } else { "steel-304-0.5mm" };
        let done = run(&folder, ["fabricate", "design.json", "-p", profile, "-o", "out"]);
        assert_eq!(done.status, 0, "{name}: {}", done.stderr);
        let old: Value = serde_json::from_slice(&std::fs::read(&file).unwrap()).unwrap();
        let new = design(&folder.join("out"));
        let (old_points, new_points) = (coordinates(&old), coordinates(&new));
        assert_eq!(old_points.len(), new_points.len());
        assert!(largest_difference(&old_points, &new_points) < 1e-9, "{name}");
        // Their schema is the one that is documented.
        let texts = [std::fs::read_to_string(&file).unwrap()];
        let breaches = peers::schema_breaches(&format!("frozen-schema-{name}"), "design.schema.json", &texts);
        assert!(breaches.is_none_or(|found| found.iter().all(Vec::is_empty)), "{name}");
        assert_eq!(run(&folder, ["verify", "out"]).status, 0);
    }
}

#[test]
fn designs_of_other_versions_are_refused_by_name() {
    let folder = peers::fresh_folder("frozen-versions");
    for (name, file) in frozen() {
        let text = std::fs::read_to_string(file).unwrap();
        for version in ["0", "2", "17"] {
            let changed = text.replacen("\"version\": 1", &format!("\"version\": {version}"), 1);
            assert!(changed != text, "{name}");
            std::fs::write(folder.join("design.json"), changed).unwrap();
            let done = run(&folder, ["fabricate", "design.json", "-p", "steel-304-0.5mm", "-o", "out"]);
            assert_eq!(done.status, 1, "{name}: {}", done.stderr);
            let says = format!("is version {version} of the design format, this program reads version 1");
            assert!(done.stderr.contains(&says), "{name}: {}", done.stderr);
            assert!(!folder.join("out").exists());
        }
    }
}
