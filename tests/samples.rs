//! The sample targets are what their generators make. `UPDATE_SAMPLES=1` writes them anew.

use std::f64::consts::{FRAC_PI_2, PI};
use std::fmt::Write;
use std::path::Path;

/// A surface over u and v from -1 to 1, as quads, in millimetres.
fn graph(title: &str, cells: [usize; 2], point: impl Fn(f64, f64) -> [f64; 3]) -> String {
    let [nx, ny] = cells;
    let mut text = format!("# {title}; made by tests/samples.rs\n");
    let at = |k: usize, n: usize| 2.0 * k as f64 / n as f64 - 1.0;
    for (j, i) in (0..=ny).flat_map(|j| (0..=nx).map(move |i| (j, i))) {
        let [x, y, z] = point(at(i, nx), at(j, ny)).map(|c| (c * 1e6).round() / 1e6 + 0.0);
        writeln!(text, "v {x:.6} {y:.6} {z:.6}").unwrap();
    }
    for (j, i) in (0..ny).flat_map(|j| (0..nx).map(move |i| (j, i))) {
        let a = 1 + j * (nx + 1) + i;
        writeln!(text, "f {} {} {} {}", a, a + 1, a + nx + 2, a + nx + 1).unwrap();
    }
    text
}

/// A round hill of height 1 and radius about 1.
fn hill(x: f64, y: f64) -> f64 {
    (-x * x - y * y).exp()
}

/// An undulating carpet without symmetry, in the manner of the roof over a courtyard.
fn roof(u: f64, v: f64) -> [f64; 3] {
    let z = 32.0 * hill((u - 0.35) / 0.53, (v - 0.2) / 0.53)
        + 24.0 * hill((u + 0.5) / 0.45, (v + 0.35) / 0.45)
        - 16.0 * hill((u + 0.05) / 0.35, (v + 0.1) / 0.35)
        + 12.0 * u * v;
    [150.0 * u + 6.0 * v * v, 120.0 * v - 5.0 * u * u * u, z]
}

/// Where the map's sample takes a point of its closed sheet: stretched more along than across, and vaulted.
fn mapped(u: f64, v: f64) -> [f64; 3] {
    let x = 138.0 * u + 10.0 * (PI * u).sin() / PI * (1.0 + 0.5 * v);
    let y = 99.2 * v - 4.8 * (PI * v).sin() / PI + 4.0 * u * u;
    [x, y, 22.0 * (1.0 - u * u) * (1.0 - 0.5 * v * v)]
}

/// Every sample's file and what belongs in it.
fn samples() -> Vec<(&'static str, String)> {
    let dome = |u: f64, v: f64| [150.0 * u, 150.0 * v, 90.0 * (FRAC_PI_2 * u).cos() * (FRAC_PI_2 * v).cos()];
    let vault =
        |u: f64, v: f64| [110.0 * u, 90.0 * v, 36.0 * (1.0 - u * u) * (1.0 - 0.35 * v) - 12.0 * v * v];
    let paraboloid = |u: f64, v: f64| [127.0 * u, 102.0 * v, 45.0 - 27.0 * (u * u + v * v)];
    let knoll =
        |u: f64, v: f64| [130.0 * u, 130.0 * v, 10.0 * (1.0 + (PI * u).cos()) * (1.0 + (PI * v).cos())];
    // For bistable sheets.
    let flat = |u: f64, v: f64| {
        [240.0 * u * (1.0 + 0.05 * v) + 9.6 * v * v, 240.0 * v * (1.0 + 0.04 * u) - 12.0 * u * u, 0.0]
    };
    let cap = |u: f64, v: f64| [240.0 * u, 240.0 * v, 38.4 * (2.0 - u * u - v * v)];
    let saddle = |u: f64, v: f64| [240.0 * u, 240.0 * v, 48.0 * (u * u - v * v)];
    let sphere = |u: f64, v: f64| {
        let [x, y] = [(0.35 * u).tan(), (0.35 * v).tan()];
        let radius = 598.0 / (1.0 + x * x + y * y).sqrt();
        [radius * x, radius * y, radius - 598.0]
    };
    let wave = |u: f64, v: f64| [240.0 * u, 240.0 * v, 19.2 * (1.2 * u + 0.3).sin() * v.cos()];
    let shallow = |u: f64, v: f64| [200.0 * u, 200.0 * v, 12.0 * (u * u - v * v)];
    vec![
        ("snap-expanded.obj", graph("a saddle of 400 mm x 400 mm, 24 mm high", [30, 30], shallow)),
        ("snap-flat.obj", graph("a sheet of about 480 mm x 480 mm whose sides bend", [30, 30], flat)),
        ("snap-dome.obj", graph("a dome of 480 mm x 480 mm, 77 mm high", [30, 30], cap)),
        ("snap-saddle.obj", graph("a saddle of 480 mm x 480 mm, 96 mm high", [30, 30], saddle)),
        ("snap-sphere.obj", graph("a patch of a sphere of radius 598 mm", [30, 30], sphere)),
        ("snap-wave.obj", graph("where the points of snap-sphere.obj go", [30, 30], wave)),
        ("dome.obj", graph("a dome of 300 mm x 300 mm, 90 mm high", [40, 40], dome)),
        ("closing.obj", graph("a vault of 220 mm x 180 mm", [36, 30], vault)),
        ("roof-closed.obj", graph("a paraboloid of 254 mm x 204 mm", [32, 26], paraboloid)),
        ("roof.obj", graph("an undulating roof of 300 mm x 240 mm", [40, 32], roof)),
        ("variable.obj", graph("a knoll of 260 mm x 260 mm, 40 mm high", [40, 40], knoll)),
        ("map-closed.obj", graph("a sheet of 200 mm x 160 mm", [36, 30], |u, v| [100.0 * u, 80.0 * v, 0.0])),
        ("map.obj", graph("where the points of map-closed.obj go", [36, 30], mapped)),
    ]
}

#[test]
fn samples_are_what_their_generators_make() {
    for (name, made) in samples() {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples").join(name);
        if std::env::var_os("UPDATE_SAMPLES").is_some() {
            std::fs::write(&file, &made).unwrap();
        }
        assert!(std::fs::read_to_string(&file).unwrap() == made, "samples/{name}: run with UPDATE_SAMPLES=1");
        assert!(made.len() < 150_000, "samples/{name} has {} bytes", made.len());
    }
}
