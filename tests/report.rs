//! `report.html` as a reader meets it, in a real browser.

mod peers;
mod program;
#[path = "report_space/mod.rs"]
mod space;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use kirimorph::fabrication::mechanics::{self, StrainClass};
use kirimorph::output::report;
use kirimorph::profile;
use program::{Mesh, STEEL, asked, design, job, made, number, run};
use serde_json::{Value, json};

/// Most bytes of the default sample's page.
const WEIGHT: u64 = 2_000_000;

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
}

/// Opens pages; `None` without a browser. The first page is opened in a browser without WebGL besides.
fn visited(pages: &[PathBuf]) -> Option<Vec<Value>> {
    let arguments: Vec<&dyn AsRef<std::ffi::OsStr>> =
        pages.iter().map(|page| page as &dyn AsRef<std::ffi::OsStr>).collect();
    let found = asked(peers::browser("report_page.cjs"), &arguments)?;
    let mut found = found.as_array().unwrap().clone();
    let without = found.pop().unwrap();
    assert_eq!(without["complaints"], json!([]));
    assert!(without["says"].as_str().unwrap().contains("no WebGL 2"), "{without}");
    assert_eq!(without["figure"], false);
    assert!(number(&without, "rows") > 10.0);
    Some(found)
}

fn hinges(folder: &Path) -> Vec<Value> {
    let text = std::fs::read(folder.join("hinges.json")).unwrap();
    let file: Value = serde_json::from_slice(&text).unwrap();
    file["hinges"].as_array().unwrap().clone()
}

/// What every page must do, whatever it shows.
fn check(found: &Value, folder: &Path) {
    let place = folder.display();
    assert_eq!(found["complaints"], json!([]), "{place}");
    assert_eq!(found["requests"], json!([]), "{place}");
    assert_eq!(found["foreign"], 0, "{place}: a script of another");
    assert_eq!(found["unnamed"], json!([]), "{place}");
    let hinges = hinges(folder);
    check_verdict(found, &hinges);
    check_table(found, &hinges);
    check_picking(found, &hinges);
    let sheet = &found["sheet"];
    let [start, near, back] = ["start", "near", "back"].map(|key| numbers(&sheet[key]));
    assert!(near[2] < 0.7 * start[2] && near[0] > start[0], "{sheet}");
    assert_eq!(start, back);
    assert_eq!(sheet["hidden"], 1);
    let of_class = |class: &str| hinges.iter().filter(|hinge| hinge["strain_class"] == class).count();
    let counts = ["elastic", "plastic low-cycle", "beyond elongation"].map(of_class);
    assert_eq!(sheet["dots"], json!(counts), "{place}");
    assert!(number(found, "rows_present") < 60.0, "{place}: rows out of sight exist");
    space::check(&found["space"], &hinges, &design(folder), found["job"].as_str().unwrap());
}

fn count(hinges: &[Value], verdict: &str) -> usize {
    hinges.iter().filter(|hinge| hinge["verdict"] == verdict).count()
}

fn check_verdict(found: &Value, hinges: &[Value]) {
    let [ok, warn, fail] = ["ok", "warn", "fail"].map(|verdict| count(hinges, verdict));
    let level = if fail > 0 {
        "fail"
    } else if warn > 0 {
        "warn"
    } else {
        "ok"
    };
    assert_eq!(found["verdict"][0], level);
    let says = found["verdict"][1].as_str().unwrap();
    assert!(says.contains(&format!("{} hinges: {ok} ok, {warn} warn, {fail} fail", hinges.len())), "{says}");
}

fn check_table(found: &Value, hinges: &[Value]) {
    let sorting = &found["sorting"];
    // Worst first: by verdict, strain, id.
    let rank = |hinge: &Value| ["ok", "warn", "fail"].iter().position(|v| hinge["verdict"] == *v).unwrap();
    let mut order: Vec<usize> = (0..hinges.len()).collect();
    order.sort_by(|&a, &b| {
        let by_strain = number(&hinges[b], "strain").total_cmp(&number(&hinges[a], "strain"));
        rank(&hinges[b]).cmp(&rank(&hinges[a])).then(by_strain).then(a.cmp(&b))
    });
    let first = numbers(&sorting["first"]);
    assert!(first.len() >= 10);
    assert!(first.iter().zip(&order).all(|(&shown, &id)| shown == id as f64), "{first:?} {order:?}");
    let angle = |id: &f64| number(&hinges[*id as usize], "angle_deg");
    for (key, sense) in [("by_angle", -1.0), ("by_angle_up", 1.0)] {
        let shown = numbers(&sorting[key]);
        let rising = |pair: &[f64]| sense * (angle(&pair[1]) - angle(&pair[0])) >= -1e-7;
        assert!(shown.windows(2).all(rising), "{key}: {shown:?}");
        let extreme = (0..hinges.len()).map(|id| sense * angle(&(id as f64))).fold(f64::INFINITY, f64::min);
        assert!((sense * angle(&shown[0]) - extreme).abs() < 1e-7);
    }
    assert_eq!(sorting["aria_sort"], json!(["angle", "descending"]));
    let filtering = &found["filtering"];
    for verdict in ["ok", "warn", "fail"] {
        assert_eq!(filtering["counts"][verdict], count(hinges, verdict), "{filtering}");
    }
    let at_piece_3 = hinges.iter().filter(|hinge| hinge["pieces"].as_array().unwrap().contains(&json!(3)));
    assert_eq!(filtering["of_piece_3"], at_piece_3.count());
    assert_eq!((&filtering["one"], &filtering["none"]), (&json!([7]), &json!([])));
}

fn check_picking(found: &Value, hinges: &[Value]) {
    let picking = &found["picking"];
    let ring_is_at = |ring: &Value, id: &Value| {
        assert_eq!((&ring["hinge"], &ring["visible"]), (id, &json!(true)), "{picking}");
        numbers(&ring["at"])
    };
    let clicked = &picking["clicked"];
    ring_is_at(&picking["ring"], clicked);
    assert_eq!(picking["marked"], json!([clicked]));
    let hinge = &hinges[clicked.as_u64().unwrap() as usize];
    let [j, k] = [0, 1].map(|i| &hinge["pieces"][i]);
    assert_eq!(picking["detail"], format!("Hinge {clicked}, between pieces {j} and {k}"));
    let drawn = numbers(&picking["drawn"][0]);
    // The browser keeps these in single precision, the page writes 8 decimals.
    assert!((drawn[0] - number(hinge, "length_mm")).abs() < 1e-5, "{picking}");
    assert!((drawn[1] - number(hinge, "width_mm")).abs() < 1e-5, "{picking}");
    ring_is_at(&picking["entered"], &picking["two_down"]);
    assert_ne!(picking["two_down"], picking["clicked"]);
    assert_eq!(picking["end"], hinges.len() + 1);
    assert_ne!(picking["other"]["hinge"], picking["entered"]["hinge"]);
    ring_is_at(&picking["on_sheet"], &picking["two_down"]);
}

/// The first column of `rows` that begins with `name`, and its cell in `column`.
fn cell(rows: &Value, name: &str, column: usize) -> String {
    let row = rows.as_array().unwrap().iter().find(|row| row[0] == name).unwrap_or_else(|| panic!("{rows}"));
    row[column].as_str().unwrap().to_owned()
}

/// "a % to b %".
fn strains(text: &str) -> Vec<f64> {
    text.split(" to ").map(|part| part.trim_end_matches(" %").parse().unwrap()).collect()
}

#[test]
fn a_dome_of_steel_whose_job_is_named_like_markup() {
    let folder = peers::fresh_folder("report_dome");
    let name = "<script>alert(1)<b>&amp;\"'";
    let mesh = Mesh::bump([120.0, 120.0], 30.0, [12, 12]);
    std::fs::write(folder.join("bump.obj"), mesh.obj()).unwrap();
    std::fs::write(folder.join(format!("{name}.toml")), job("open = \"bump.obj\"", "pieces = [8, 8]", STEEL))
        .unwrap();
    let out = made(&folder, &format!("{name}.toml"), "out");
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert!(!page.contains("<script>alert"));
    let fabricated =
        run(&out, ["fabricate", "design.json", "--profile", "steel-304-0.5mm", "-o", "../again"]);
    assert_eq!(fabricated.status, 0, "{}", fabricated.stderr);
    let again = folder.join("again");
    let Some(found) = visited(&[out.join("report.html"), again.join("report.html")]) else { return };
    check(&found[0], &out);
    check(&found[1], &again);
    for found in &found {
        assert_eq!(found["job"], name);
    }
    assert_eq!(found[0]["title"], format!("{name}: report"));
    assert!(found[0]["verdict"][1].as_str().unwrap().starts_with(&format!("{name}: made")));
    assert!(found[1]["verdict"][1].as_str().unwrap().starts_with(&format!("{name}: laid out")));
    // A fifth of the width strains a fifth once plastic: to the two decimals that are shown.
    let what_if = &found[0]["what_if"];
    let [made, narrow] = [1, 2].map(|column| strains(&cell(&what_if["narrow"], "strain", column)));
    assert!(made.iter().zip(&narrow).all(|(made, narrow)| (made / 5.0 - narrow).abs() < 0.011), "{what_if}");
    assert_eq!(what_if["made"], what_if["again"]);
    assert!(what_if["note"].as_str().unwrap().contains("show these values"));
}

#[test]
fn every_sample_has_a_page_that_loads() {
    let folder = peers::fresh_folder("report_samples");
    let samples = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples");
    // One of each kind; tests/cases.rs makes the others.
    let names = ["dome", "closing", "roof", "snap-dome", "rubber", "formfinding"];
    let pages: Vec<PathBuf> = names
        .iter()
        .map(|name| {
            let out = folder.join(name);
            let job = samples.join(format!("{name}.toml"));
            let run = run(&folder, [Path::new("make"), &job, Path::new("-o"), &out]);
            assert_eq!(run.status, 0, "{name}: {}", run.stderr);
            out.join("report.html")
        })
        .collect();
    pages.iter().for_each(|page| space::check_poses(page.parent().unwrap()));
    let dome = std::fs::metadata(&pages[0]).unwrap().len();
    assert!(dome <= WEIGHT, "{dome} bytes");
    let Some(found) = visited(&pages) else { return };
    for (found, page) in found.iter().zip(&pages) {
        check(found, page.parent().unwrap());
    }
}

#[test]
fn twenty_thousand_hinges_stay_smooth() {
    let folder = peers::fresh_folder("report_large");
    let mesh = Mesh::bump([120.0, 120.0], 30.0, [12, 12]);
    std::fs::write(folder.join("bump.obj"), mesh.obj()).unwrap();
    std::fs::write(folder.join("small.toml"), job("open = \"bump.obj\"", "pieces = [12, 12]", STEEL))
        .unwrap();
    let out = made(&folder, "small.toml", "out");
    let large = folder.join("report.html");
    let many: [&dyn AsRef<std::ffi::OsStr>; 3] = [&out.join("report.html"), &"20000", &large];
    let Some(count) = asked(peers::node("many_pieces.cjs"), &many) else { return };
    let Some(found) = visited(&[large]) else { return };
    let found = &found[0];
    assert_eq!(found["complaints"], json!([]));
    assert_eq!(found["picking"]["rows"], count.as_u64().unwrap() + 1);
    assert!(number(found, "rows_present") < 60.0);
    // The best of several counts: beside the others the processor draws the view in space, and other tests run.
    let best = |values: &Value| numbers(values).into_iter().fold(f64::INFINITY, f64::min);
    assert!(number(found, "seconds") < 60.0, "{}", found["seconds"]);
    assert!(best(&found["scroll_ms"]) < 1000.0, "{}", found["scroll_ms"]);
    let space = &found["space"];
    // What the page does itself, with other tests beside it; the drawing is the graphics card's, here again the processor's.
    assert!(best(&space["pace"]["busy"]) < 150.0, "{space}");
}

#[test]
fn the_bundle_of_three_js_is_what_its_lock_makes() {
    let Some(made) = peers::three() else { return };
    let kept = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/output/report/three/three.min.js");
    let [made, kept] = [made, kept].map(|file| std::fs::read(file).unwrap());
    assert!(made == kept, "npm ci && npm run bundle in src/output/report/three makes another file");
}

#[test]
fn the_pages_formulas_are_those_of_the_program() {
    let folder = peers::fresh_folder("report_formulas");
    let mut cases = Vec::new();
    for mut profile in profile::embedded() {
        for width in [1.0, 0.3, 2.2] {
            profile.ligament.width *= width;
            profile.sheet.thickness *= 1.7 * width;
            for (length, degrees) in
                [(1.0, 0.05), (1.07, 2.0), (1.3, 11.0), (1.5, 36.5), (2.1, 88.0), (3.0, 110.0), (1.05, 170.0)]
            {
                cases.push((profile.clone(), length, f64::to_radians(degrees)));
            }
        }
    }
    let list =
        cases.iter().map(|(p, l, a)| json!({ "profile": report::mechanics(p), "length": l, "angle": a }));
    let file = folder.join("cases.json");
    std::fs::write(&file, Value::from_iter(list).to_string()).unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/output/report/mechanics.js");
    let Some(found) = asked(peers::node("mechanics_check.cjs"), &[&script, &file]) else { return };
    let found = found.as_array().unwrap();
    assert_eq!(found.len(), cases.len());
    let mut classes = BTreeMap::new();
    for (found, (profile, length, angle)) in found.iter().zip(&cases) {
        let load = mechanics::assess(profile, *length, *angle);
        let near =
            |found: f64, wanted: f64| assert!((found / wanted - 1.0).abs() < 1e-12, "{found} {wanted}");
        near(number(found, "strain"), load.strain);
        near(number(found, "effective"), load.effective_length);
        near(number(found, "springback"), mechanics::springback(profile, *length, *angle));
        let class = [StrainClass::Elastic, StrainClass::PlasticLowCycle, StrainClass::BeyondElongation];
        assert_eq!(class[number(found, "class") as usize], load.class);
        assert_eq!(found["torque"].is_null(), load.torque.is_none());
        if let Some(torque) = load.torque {
            near(number(found, "torque"), torque);
        }
        assert_eq!(found["fatigue"], load.fatigue.to_string());
        match mechanics::required_length(profile, *angle) {
            Ok(needed) => near(number(&found["required"], "length"), needed),
            Err(_) => assert_eq!(found["required"]["enough"], false),
        }
        *classes.entry(load.class).or_insert(0) += 1;
    }
    assert_eq!(classes.len(), 3, "all classes occur: {classes:?}");
}
