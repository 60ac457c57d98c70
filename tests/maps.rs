//! Maps of the user's: two meshes whose vertices correspond decide where the sheet opens, and by how much.

mod peers;
mod program;

use std::path::Path;

use program::{Mesh, STEEL, json_file, number, refused, run, sample};

/// Writes the job of a map between two meshes.
fn map_job(folder: &Path, closed: &Mesh, open: &Mesh, pattern: &str) {
    std::fs::write(folder.join("closed.obj"), closed.obj()).unwrap();
    std::fs::write(folder.join("open.obj"), open.obj()).unwrap();
    let text = format!(
        "[target]\nclosed = \"closed.obj\"\nopen = \"open.obj\"\n[pattern]\nkind = \"rotating-rectangles\"\n{pattern}\n\
         opening = \"variable\"\n[fabrication]\n{STEEL}\n"
    );
    std::fs::write(folder.join("job.toml"), text).unwrap();
}

fn flat(span: [f64; 2], cells: [usize; 2]) -> Mesh {
    Mesh::bump(span, 0.0, cells)
}

#[test]
fn a_sheet_that_is_stretched_evenly_opens_by_the_closed_form() {
    // Section 2.2 of the design notes with m1 = m2 = m: cos t = (2 m + sqrt(8 - 4 m^2)) / 4.
    let folder = peers::fresh_folder("case-even");
    let sheet = flat([160.0, 160.0], [8, 8]);
    for m in [1.1_f64, 1.2, 1.35] {
        map_job(&folder, &sheet, &sheet.moved(|p| p.map(|c| m * c)), "pieces = [12, 12]\ngap_mm = 0.0");
        let run = run(&folder, ["design", "job.toml", "-o", "design.json"]);
        assert_eq!((run.status, run.stderr.as_str()), (0, ""), "{m}");
        let design = json_file(&folder.join("design.json"));
        let turn = ((2.0 * m + (8.0 - 4.0 * m * m).sqrt()) / 4.0).acos().to_degrees();
        let hinges = design["hinges"].as_array().unwrap();
        let off =
            hinges.iter().map(|hinge| (number(hinge, "angle_deg") - 2.0 * turn).abs()).fold(0.0, f64::max);
        // Every cell is the same: rounding is all that is left.
        assert!(off <= 1e-9, "{m}: {off}");
    }
}

#[test]
fn what_is_to_be_expected_is_said_for_every_case() {
    let folder = peers::fresh_folder("case-feasibility");
    let figure = |text: &str, label: &str| -> Vec<f64> {
        let row = text.lines().find_map(|line| line.trim().strip_prefix(label)).unwrap();
        row.split_whitespace().filter_map(|word| word.parse().ok()).collect()
    };
    let predicted = |job: &Path| {
        let run = run(&folder, ["design".as_ref(), job.as_os_str(), "--feasibility-only".as_ref()]);
        assert_eq!((run.status, run.stderr.as_str()), (0, ""), "{}", run.stdout);
        run.stdout
    };
    for name in ["closing", "roof", "variable", "map"] {
        let text = predicted(&sample(&format!("{name}.toml")));
        assert!(text.starts_with(&format!("{name}: easy")), "{text}");
    }
    // A map's stretches are its own, whatever they are.
    let sheet = flat([200.0, 160.0], [10, 8]);
    map_job(&folder, &sheet, &sheet.moved(|[x, y, z]| [1.5 * x, 1.15 * y, z]), "pieces = [12, 10]");
    let text = predicted(&folder.join("job.toml"));
    assert_eq!(figure(&text, "opening stretches"), [1.15, 1.5], "{text}");
    assert_eq!(figure(&text, "area within reach"), [100.0], "{text}");
    map_job(&folder, &sheet, &sheet.moved(|[x, y, z]| [3.5 * x, 1.15 * y, z]), "pieces = [12, 10]");
    refused_prediction(&folder);
    map_job(&folder, &sheet, &sheet.moved(|[x, y, z]| [0.8 * x, 0.8 * y, z]), "pieces = [12, 10]");
    refused_prediction(&folder);
}

/// A prediction that says how it stands, and refuses.
fn refused_prediction(folder: &Path) {
    let run = run(folder, ["design", "job.toml", "--feasibility-only"]);
    assert_eq!(run.status, 2, "{run:?}");
    assert!(run.stdout.starts_with("job: beyond") && run.stderr.contains("out of reach"), "{run:?}");
}

#[test]
fn a_map_with_a_fold_is_named_and_refused() {
    let folder = peers::fresh_folder("case-fold");
    let sheet = flat([200.0, 160.0], [10, 8]).triangles();
    let mut folded = sheet.moved(|[x, y, z]| [1.3 * x, 1.3 * y, z]);
    // A vertex in the middle is pushed beyond its right neighbour: the triangles between them turn over.
    folded.vertices[48][0] += 45.0;
    for (closed, open, name) in [(&sheet, &folded, "open.obj"), (&folded, &sheet, "closed.obj")] {
        map_job(&folder, closed, open, "pieces = [12, 10]");
        for arguments in
            [&["make", "job.toml", "-o", "out"][..], &["design", "job.toml", "--feasibility-only"]]
        {
            refused(&folder, arguments, 1, &[name, "folds over at face ", "turned over"]);
        }
    }
}
