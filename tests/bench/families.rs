//! Bistable sheets beside rotating rectangles of as many unknowns: `cargo bench --bench families`.
//!
//! Whole runs of `kirimorph design` on the same dome, one after the other; the ratio of seconds per unknown is what counts.

use std::fmt::Write;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

/// Cells along a side of the bistable sheet, and pieces along a side of the other with nearly as many unknowns.
const SIDES: [[usize; 2]; 3] = [[24, 40], [48, 80], [100, 166]];

/// The best of so many runs counts.
const RUNS: usize = 3;

fn main() {
    let folder = std::env::temp_dir().join(format!("kirimorph-families-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("dome.obj"), dome(60)).unwrap();
    println!("Best of {RUNS} runs of `kirimorph design`, dome of a fifth of its span.\n");
    println!("| bistable cells | pieces | unknowns | s | rotating pieces | unknowns | s | per unknown |");
    println!("| --: | --: | --: | --: | --: | --: | --: | --: |");
    for [cells, pieces] in SIDES {
        // 25 mm cells and 15 mm pieces: the same sheet.
        let size = 25 * cells;
        let bistable = design(&folder, size, "bistable", cells, "phi_deg = 16\na = 0.38\nb = 0.38");
        let rotating = design(&folder, size, "rotating-rectangles", pieces, "");
        // Bistable: 4 corners and the grid's one in the plane and 4 hinges in space per cell. Rotating: one corner in the
        // plane and 2 hinges in space per piece. Borders add little.
        let unknowns = [22 * cells * cells, 8 * pieces * pieces];
        let each = [bistable.1 / unknowns[0] as f64, rotating.1 / unknowns[1] as f64];
        println!(
            "| {} | {} | {} | {:.2} | {} | {} | {:.2} | {:.2} |",
            cells * cells,
            bistable.0,
            unknowns[0],
            bistable.1,
            rotating.0,
            unknowns[1],
            rotating.1,
            each[0] / each[1],
        );
    }
    std::fs::remove_dir_all(folder).unwrap();
}

/// Runs a job and returns its number of pieces and the best seconds.
fn design(folder: &Path, size: usize, kind: &str, side: usize, more: &str) -> (usize, f64) {
    let job = format!(
        "[target]\nopen = \"dome.obj\"\nclosed = \"flat\"\nsize_mm = {size}.0\n[pattern]\nkind = \"{kind}\"\n\
         pieces = [{side}, {side}]\n{more}\n[fabrication]\nprofile = \"steel-304-0.5mm\"\n\
         sheet_mm = [4000.0, 4000.0]\n"
    );
    std::fs::write(folder.join("job.toml"), job).unwrap();
    let mut best = f64::INFINITY;
    for _ in 0..RUNS {
        let start = Instant::now();
        let run = Command::new(env!("CARGO_BIN_EXE_kirimorph"))
            .current_dir(folder)
            .args(["design", "job.toml", "-o", "design.json"])
            .output()
            .unwrap();
        best = best.min(start.elapsed().as_secs_f64());
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    }
    let text = std::fs::read_to_string(folder.join("design.json")).unwrap();
    let design: serde_json::Value = serde_json::from_str(&text).unwrap();
    (design["pieces"].as_array().unwrap().len(), best)
}

/// A cap of a sphere over a square, a fifth of the span high, in `n` by `n` quads: OBJ text.
fn dome(n: usize) -> String {
    // Over the unit square's inner circle: half the span c = 0.5, height h = 0.2, radius (c^2 + h^2) / 2h.
    let radius = (0.25 + 0.04) / 0.4;
    let at = |i: usize| i as f64 / n as f64 - 0.5;
    let mut text = String::new();
    for j in 0..=n {
        for i in 0..=n {
            let (x, y) = (at(i), at(j));
            let z = f64::sqrt(radius * radius - x * x - y * y) - (radius - 0.2);
            writeln!(text, "v {x} {y} {z}").unwrap();
        }
    }
    for j in 0..n {
        for i in 0..n {
            let v = j * (n + 1) + i + 1;
            writeln!(text, "f {v} {} {} {}", v + 1, v + n + 2, v + n + 1).unwrap();
        }
    }
    text
}
