//! What the program is built from, as `cargo metadata` tells it without a network: licences, sources, versions that occur twice,
//! and dependencies that nothing uses. Advisories need a database from the network: `cargo deny check advisories` where there is
//! one (`deny.toml`).

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::Command;

use serde_json::Value;

/// Licences under which the whole may be passed on as we do.
const LICENCES: [&str; 6] = ["MIT", "Apache-2.0", "BSD-3-Clause", "Zlib", "Unlicense", "Unicode-3.0"];

/// Packages in more than one version, each for a reason that is not ours to change.
const TWICE: [&str; 8] = [
    "equator",        // faer, and nano-gemm below it
    "equator-macro",  // the same
    "glam",           // one for each that nalgebra can convert to; none is compiled
    "itertools",      // criterion, dxf
    "num-traits",     // dxf's enum_primitive wants 0.1
    "syn",            // derive macros of several ages
    "thiserror",      // faer's sysctl, on other systems
    "thiserror-impl", // the same
];

fn metadata() -> Value {
    let done = Command::new(env!("CARGO"))
        .args(["metadata", "--locked", "--offline", "--format-version", "1"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    serde_json::from_slice(&done.stdout).unwrap()
}

fn packages(metadata: &Value) -> &Vec<Value> {
    metadata["packages"].as_array().unwrap()
}

fn text<'a>(package: &'a Value, key: &str) -> &'a str {
    package[key].as_str().unwrap_or_default()
}

/// Whether a licence expression can be met: one of what `OR` offers, all of what `AND` joins.
fn met(expression: &str) -> bool {
    let expression = expression.replace('/', " OR ").replace(['(', ')'], " ");
    let all = expression.split(" AND ");
    all.into_iter().all(|part| part.split(" OR ").any(|licence| LICENCES.contains(&licence.trim())))
}

#[test]
fn licences_allow_what_we_do_and_all_comes_from_the_registry() {
    assert!(met("MIT OR GPL-3.0") && met("(MIT OR Apache-2.0) AND Unicode-3.0") && met("Unlicense/MIT"));
    assert!(!met("GPL-3.0-only") && !met("MIT AND GPL-3.0-only") && !met(""));
    let metadata = metadata();
    for package in packages(&metadata) {
        let name = text(package, "name");
        assert!(met(text(package, "license")), "{name}: {}", package["license"]);
        let source = text(package, "source");
        assert!(name == "kirimorph" || source.starts_with("registry+"), "{name}: {source}");
    }
}

#[test]
fn no_package_comes_twice_without_a_reason_and_every_reason_is_needed() {
    let metadata = metadata();
    let mut versions: BTreeMap<&str, usize> = BTreeMap::new();
    packages(&metadata).iter().for_each(|package| *versions.entry(text(package, "name")).or_default() += 1);
    let twice: Vec<&str> =
        versions.into_iter().filter(|(_, count)| *count > 1).map(|(name, _)| name).collect();
    assert_eq!(twice, TWICE);
}

#[test]
fn the_stated_rust_is_at_least_what_dependencies_ask_for() {
    let number =
        |version: &str| -> Vec<u32> { version.split('.').map(|part| part.parse().unwrap()).collect() };
    let metadata = metadata();
    let own = packages(&metadata).iter().find(|package| text(package, "name") == "kirimorph").unwrap();
    let stated = number(text(own, "rust_version"));
    for package in packages(&metadata) {
        let asked = text(package, "rust_version");
        assert!(asked.is_empty() || number(asked) <= stated, "{}: {asked}", text(package, "name"));
    }
}

/// The stated version is the one that all of these tests are run with where they count.
#[test]
fn the_stated_rust_is_the_one_that_ci_builds_with() {
    let told = Command::new("rustc").arg("--version").output().unwrap().stdout;
    let told = String::from_utf8(told).unwrap();
    let used = told.split(' ').nth(1).unwrap();
    let stated = env!("CARGO_PKG_RUST_VERSION");
    if std::env::var_os("CI").is_none_or(|value| value != "true") {
        println!("skipped: built with {used}, {stated} is stated, and only with CI=true they must agree");
        return;
    }
    assert!(
        used.starts_with(&format!("{stated}.")),
        "{stated} is stated but {used} builds: state what is tested"
    );
}

/// All Rust code below a folder.
fn code(folder: &Path) -> String {
    let mut all = String::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            all += &code(&path);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            all += &std::fs::read_to_string(path).unwrap();
        }
    }
    all
}

#[test]
fn every_dependency_is_used() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let [src, tests] = ["src", "tests"].map(|folder| code(&root.join(folder)));
    let metadata = metadata();
    let own = packages(&metadata).iter().find(|package| text(package, "name") == "kirimorph").unwrap();
    let mut unused = BTreeSet::new();
    for dependency in own["dependencies"].as_array().unwrap() {
        let name = text(dependency, "name").replace('-', "_");
        let used =
            |code: &str| [format!("{name}::"), format!("use {name};")].iter().any(|word| code.contains(word));
        let found = if dependency["kind"] == "dev" { used(&tests) } else { used(&src) };
        if !found {
            unused.insert(name);
        }
    }
    assert!(unused.is_empty(), "{unused:?}");
}
