//! `kirimorph design`: the design alone, and the prediction with its map.

mod peers;
mod program;

use std::f64::consts::{FRAC_PI_2, PI};
use std::path::Path;

use program::{Mesh, Run, STEEL, coordinates, job, largest_difference, listing, run};

/// Writes a job for a target of 200 mm.
fn write_job(folder: &Path, target: &str) {
    let pieces = "pieces = [10, 10]";
    std::fs::write(folder.join("target.obj"), target).unwrap();
    std::fs::write(folder.join("job.toml"), job("open = \"target.obj\"\nsize_mm = 200.0", pieces, STEEL))
        .unwrap();
}

fn predicted(folder: &Path) -> Run {
    run(folder, ["design", "job.toml", "--feasibility-only"])
}

/// The first number of a row of the table.
fn figure(run: &Run, label: &str) -> f64 {
    let row = run.stdout.lines().find_map(|line| line.trim().strip_prefix(label));
    let row = row.unwrap_or_else(|| panic!("no {label:?} in {}{}", run.stdout, run.stderr));
    row.split_whitespace().next().unwrap().parse().unwrap()
}

/// A cap of the sphere about a pole, up to an angle: rings of triangles.
fn cap(alpha: f64, rings: usize, sectors: usize) -> Mesh {
    let mut vertices = vec![[0.0, 0.0, 1.0]];
    for ring in 1..=rings {
        let theta = alpha * ring as f64 / rings as f64;
        for sector in 0..sectors {
            let phi = 2.0 * PI * (sector as f64 + 0.5 * (ring % 2) as f64) / sectors as f64;
            vertices.push([theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()]);
        }
    }
    let at = |ring: usize, sector: usize| 1 + (ring - 1) * sectors + sector % sectors;
    let mut faces: Vec<Vec<usize>> = (0..sectors).map(|s| vec![0, at(1, s), at(1, s + 1)]).collect();
    for ring in 1..rings {
        for s in 0..sectors {
            let shift = ring % 2;
            let (a, b) = (at(ring, s), at(ring, s + 1));
            let (c, d) = (at(ring + 1, s + shift), at(ring + 1, s + 1 + shift));
            faces.extend([vec![a, c, b], vec![b, c, d]]);
        }
    }
    Mesh { vertices, faces }
}

#[test]
fn numbers_of_caps_are_those_of_cartography() {
    // Conformal with even boundary: scales 1 / (1 + cos theta). Least ratio of any map: alpha / sin alpha
    // (Milnor).
    for (alpha, status, verdict) in [(0.9, 0, "easy"), (FRAC_PI_2, 0, "hard"), (2.1, 2, "beyond")] {
        let folder = peers::fresh_folder(&format!("feasibility-cap-{verdict}"));
        write_job(&folder, &cap(alpha, 30, 72).obj());
        let run = predicted(&folder);
        assert_eq!(run.status, status, "{alpha}: {}{}", run.stdout, run.stderr);
        assert!(run.stdout.starts_with(&format!("job: {verdict}, ")), "{}", run.stdout);
        let conformal = 2.0 / (1.0 + alpha.cos());
        // The mesh has facets of a thirtieth of the cap.
        assert!((figure(&run, "conformal ratio") / conformal - 1.0).abs() < 0.01, "{}", run.stdout);
        let worst = figure(&run, "worst stretch ratio");
        let least = alpha / alpha.sin();
        // An easy cap stays as rigid as possible, which is not the least ratio, but below the conformal one.
        let most = if verdict == "easy" { conformal } else { 1.03 * least };
        assert!(worst > 0.99 * least && worst < most, "{alpha}: {worst} {least}");
        assert_eq!(run.stderr.contains("out of reach"), verdict == "beyond", "{}", run.stderr);
        // The worst place lies on the sphere: its diameter is 200 mm, or more if less than a half is there.
        let row = run.stdout.lines().find(|line| line.contains("worst place")).unwrap();
        let at: Vec<f64> =
            row.split(|c: char| c == ',' || c.is_whitespace()).filter_map(|word| word.parse().ok()).collect();
        let radius = 100.0 / alpha.min(FRAC_PI_2).sin();
        let distance = at.iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!((distance / radius - 1.0).abs() < 0.01, "{at:?} {radius}");
    }
}

#[test]
fn a_rolled_sheet_is_reached_everywhere() {
    let folder = peers::fresh_folder("feasibility-roll");
    let rolled = Mesh::bump([100.0, 80.0], 0.0, [20, 12]).moved(|[x, y, _]| {
        let angle: f64 = x / 60.0;
        [60.0 * angle.sin(), y, 60.0 * angle.cos()]
    });
    write_job(&folder, &rolled.obj());
    let run = predicted(&folder);
    assert_eq!((run.status, run.stderr.as_str()), (0, ""));
    assert!((figure(&run, "worst stretch ratio") - 1.0).abs() < 1e-4);
    assert_eq!(figure(&run, "area within reach"), 100.0);
    assert!(figure(&run, "off full opening, most") < 0.01);
    // Full opening: squares whose sides all grow by sqrt 2.
    assert!((figure(&run, "opening stretches") - 1.414).abs() < 1e-3);
}

#[test]
fn the_prediction_does_not_depend_on_size_place_or_numbers() {
    let bump = Mesh::bump([100.0, 80.0], 45.0, [16, 12]).triangles();
    let others = [
        bump.moved(|[x, y, z]| {
            [25.4 * (0.8 * x - 0.6 * z) + 1e3, 25.4 * y - 7.0, 25.4 * (0.6 * x + 0.8 * z)]
        }),
        bump.renumbered(),
    ];
    let numbers = |mesh: &Mesh, name: &str| {
        let folder = peers::fresh_folder(&format!("feasibility-{name}"));
        write_job(&folder, &mesh.obj());
        let run = predicted(&folder);
        ["worst stretch ratio", "conformal ratio", "area within reach", "off full opening, mean"]
            .map(|label| figure(&run, label))
    };
    let base = numbers(&bump, "base");
    for (other, name) in others.iter().zip(["moved", "renumbered"]) {
        for (a, b) in base.iter().zip(numbers(other, name)) {
            // The last digit printed may round the other way.
            assert!((a - b).abs() < 0.011, "{name}: {a} {b}");
        }
    }
}

#[test]
fn maps_are_whole_documents_and_the_same_twice() {
    let folder = peers::fresh_folder("feasibility-maps");
    write_job(&folder, &cap(1.2, 20, 48).obj());
    for file in ["a.svg", "b.svg", "deep/map.html"] {
        let run = run(&folder, ["design", "job.toml", "--feasibility-only", "--quiet", "--map", file]);
        assert_eq!((run.status, run.stdout.as_str(), run.stderr.as_str()), (0, "", ""));
    }
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).unwrap();
    let (svg, html) = (read("a.svg"), read("deep/map.html"));
    assert!(svg == read("b.svg"), "the map differs between runs");
    for text in ["job: ", "worst", "mm on the flattening", "conformal ratio", "1.41"] {
        assert!(svg.contains(text) && html.contains(text), "{text:?}");
    }
    assert!(svg.starts_with("<svg ") && html.contains("<svg ") && html.trim_end().ends_with("</html>"));
    assert_well_formed(&svg);
    assert_well_formed(html.strip_prefix("<!DOCTYPE html>").unwrap());
    let before = listing(&folder);
    for (map, says) in
        [("map.png", "must end in .svg or .html"), ("deep", "must end in"), ("target.obj/m.svg", "m.svg")]
    {
        let run = run(&folder, ["design", "job.toml", "--feasibility-only", "--map", map]);
        assert_eq!(run.status, 1, "{map}");
        assert!(run.stderr.contains(says), "{map}: {}", run.stderr);
    }
    assert!(listing(&folder) == before, "a refused map left something behind");
}

/// Every tag is closed, in order; no bare `&`.
fn assert_well_formed(xml: &str) {
    let mut open: Vec<&str> = Vec::new();
    for tag in xml.split('<').skip(1) {
        let (tag, rest) = tag.split_once('>').expect("a tag ends");
        assert!(!rest.contains('>') && (!rest.contains('&') || rest.contains(';')), "{rest}");
        // Attributes have their quotes in pairs.
        assert_eq!(tag.matches('"').count() % 2, 0, "{tag}");
        let name = tag.trim_start_matches('/').split(|c: char| c.is_whitespace() || c == '/').next().unwrap();
        match () {
            () if tag.starts_with('/') => assert_eq!(open.pop(), Some(name)),
            () if tag.ends_with('/') => (),
            () => open.push(name),
        }
    }
    assert!(open.is_empty(), "{open:?}");
}

#[test]
fn the_design_is_that_of_make() {
    let folder = peers::fresh_folder("feasibility-design");
    let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples");
    write_job(&folder, &std::fs::read_to_string(sample.join("dome.obj")).unwrap());
    let designed = run(&folder, ["design", "job.toml"]);
    assert_eq!((designed.status, designed.stderr.as_str()), (0, ""));
    let made = program::made(&folder, "job.toml", "made");
    let text = std::fs::read(folder.join("out/job.design.json")).unwrap();
    let ours: serde_json::Value = serde_json::from_slice(&text).unwrap();
    let theirs = program::design(&made);
    assert_eq!(largest_difference(&coordinates(&ours), &coordinates(&theirs)), 0.0);
    assert_eq!(ours["hinges"], theirs["hinges"]);
    let files: Vec<_> = std::fs::read_dir(folder.join("out")).unwrap().collect();
    assert_eq!(files.len(), 1, "a partial file stayed");
}

#[test]
fn shared_meshes_have_the_verdicts_that_are_reached() {
    let expected = [
        ("M2_eq_quad2", 0, "easy", 1.13),
        ("6-sub-lifted", 0, "easy", 1.22),
        ("pillow_1", 0, "easy", 1.28),
        ("choi_paraboloid", 0, "easy", 1.29),
        ("conical1", 0, "hard", 1.72),
        ("hemisphere", 0, "hard", 2.0),
        ("choi_peaks", 0, "hard", 2.66),
        ("face", 2, "beyond", 510.0),
    ];
    for (mesh, status, verdict, conformal) in expected {
        let Some(file) = peers::shared(&format!("meshes/{mesh}.obj")) else { return };
        let folder = peers::fresh_folder(&format!("feasibility-{mesh}"));
        write_job(&folder, &std::fs::read_to_string(file).unwrap());
        let run = predicted(&folder);
        assert_eq!(run.status, status, "{mesh}: {}", run.stderr);
        assert!(run.stdout.contains(&format!(": {verdict}, ")), "{mesh}: {}", run.stdout);
        assert!((figure(&run, "conformal ratio") / conformal - 1.0).abs() < 0.01, "{}", run.stdout);
    }
}
