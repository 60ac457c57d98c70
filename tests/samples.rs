//! The sample targets are what their generators make. `UPDATE_SAMPLES=1` writes them anew.

use std::f64::consts::FRAC_PI_2;
use std::fmt::Write;
use std::path::Path;

/// A dome over a square: z = height cos(pi x / 2) cos(pi y / 2) for x, y from -1 to 1, as quads, in millimetres.
fn dome(span: f64, height: f64, cells: usize) -> String {
    let mut text = format!("# a dome of {span} mm x {span} mm, {height} mm high; made by tests/samples.rs\n");
    for j in 0..=cells {
        for i in 0..=cells {
            let at = |k: usize| 2.0 * k as f64 / cells as f64 - 1.0;
            let (x, y) = (at(i), at(j));
            let z = height * (FRAC_PI_2 * x).cos() * (FRAC_PI_2 * y).cos();
            writeln!(text, "v {:.6} {:.6} {:.6}", 0.5 * span * x, 0.5 * span * y, z + 0.0).unwrap();
        }
    }
    for j in 0..cells {
        for i in 0..cells {
            let a = 1 + j * (cells + 1) + i;
            writeln!(text, "f {} {} {} {}", a, a + 1, a + cells + 2, a + cells + 1).unwrap();
        }
    }
    text
}

#[test]
fn the_dome_is_what_its_generator_makes() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples/dome.obj");
    let made = dome(300.0, 90.0, 40);
    if std::env::var_os("UPDATE_SAMPLES").is_some() {
        std::fs::write(&file, &made).unwrap();
    }
    assert!(std::fs::read_to_string(&file).unwrap() == made, "samples/dome.obj: run with UPDATE_SAMPLES=1");
}
