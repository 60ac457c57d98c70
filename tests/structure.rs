//! The layout of the source: no arrow goes back.

use std::path::{Path, PathBuf};

/// The files below a folder, but for unit tests, which may look at anything.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let code = entries.filter(|path| !path.file_stem().unwrap().to_str().unwrap().ends_with("tests"));
    code.flat_map(|path| if path.is_dir() { sources(&path) } else { vec![path] }).collect()
}

/// The names of top modules that a text uses: `crate::NAME`, and each NAME of `crate::{NAME, NAME::more}`.
fn used(text: &str) -> Vec<&str> {
    let mut names = Vec::new();
    for rest in text.split("crate::").skip(1) {
        let list = rest.strip_prefix('{').map_or([rest].to_vec(), |list| {
            // Commas of inner lists part names that are no top modules.
            list.split_once("};").map_or(list, |(list, _)| list).split(',').collect()
        });
        for name in list {
            let name = name.trim_start();
            names.push(&name[..name.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(name.len())]);
        }
    }
    names
}

#[test]
fn every_module_uses_only_those_listed_above_it() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let lib = std::fs::read_to_string(src.join("lib.rs")).unwrap();
    let modules: Vec<&str> =
        lib.lines().filter_map(|line| line.strip_prefix("pub mod ")?.strip_suffix(';')).collect();
    assert!(modules.len() > 15);
    let place = |name: &str| modules.iter().position(|module| *module == name);
    let mut arrows = 0;
    for file in sources(&src) {
        let own = file.strip_prefix(&src).unwrap().components().next().unwrap();
        let own = Path::new(own.as_os_str()).file_stem().unwrap().to_str().unwrap();
        let Some(own) = place(own) else { continue };
        let Ok(text) = std::fs::read_to_string(&file) else { continue };
        for name in used(&text) {
            let Some(other) = place(name) else { continue };
            assert!(other <= own, "{} uses {name}, which lib.rs lists below it", file.display());
            arrows += usize::from(other < own);
        }
    }
    assert!(arrows > 300, "{arrows}");
}
