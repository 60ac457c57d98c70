//! Designs of other programs that cannot be taken over: the exit status, a message that says what and where, and nothing
//! written.

mod peers;
mod program;
mod squares;

use program::refused;
use squares::{PAIR, Squares, moved, obj, rows, squares, write_pair};

/// A pair that must be refused.
fn pair_refused(name: &str, design: &Squares, status: i32, says: &[&str]) {
    let folder = peers::fresh_folder(&format!("import-bad-{name}"));
    write_pair(&folder, design);
    refused(&folder, &PAIR, status, says);
}

#[test]
fn pieces_that_do_not_belong_together_are_named() {
    let good = squares();
    let mut apart = good.clone();
    let more = Squares::new([2, 1], 12.0, 0.7);
    apart.closed.extend(moved(&more.closed, |[x, y, z]| [x + 100.0, y, z]));
    apart.open.extend(moved(&more.open, |[x, y, z]| [x + 200.0, y, z]));
    pair_refused("apart", &apart, 1, &["not connected", "2 parts", "pieces 12, 13"]);
    let mut alone = good.clone();
    alone.open = moved(&alone.open, |[x, y, z]| [2.0 * x + 1e-3 * y, y * y, z]);
    pair_refused(
        "no-hinges",
        &Squares {
            open: good
                .open
                .iter()
                .enumerate()
                .map(|(i, piece)| piece.iter().map(|[x, y, z]| [x + 50.0 * i as f64, *y, *z]).collect())
                .collect(),
            ..good.clone()
        },
        1,
        &["no hinges"],
    );
    let mut stretched = good.clone();
    stretched.open = moved(&good.open, |[x, y, z]| [1.05 * x, y, z]);
    pair_refused("not-rigid", &stretched, 2, &["not rigid", "--max-strain", "in all 12 pieces"]);
    // Piece 0 turns counter-clockwise: its hinges are its lower and upper right corners. Its free corners are reflected
    // across the line through these.
    let mut mirrored = good.clone();
    let [p, q] = [good.open[0][1], good.open[0][2]];
    let along = [q[0] - p[0], q[1] - p[1]].map(|c| c / 12.0);
    for corner in [0, 3] {
        let [x, y, _] = good.open[0][corner];
        let reach = (x - p[0]) * along[0] + (y - p[1]) * along[1];
        let foot = [p[0] + reach * along[0], p[1] + reach * along[1]];
        mirrored.open[0][corner] = [2.0 * foot[0] - x, 2.0 * foot[1] - y, 0.0];
    }
    pair_refused("mirrored", &mirrored, 2, &["piece 0: turned over", "mirror image"]);
    let mut flat = good.clone();
    for corner in 0..4 {
        flat.closed[5][corner][1] = flat.closed[5][0][1];
    }
    pair_refused("no-area", &flat, 1, &["piece 5 has no area in the closed state"]);
}

#[test]
fn faces_that_differ_are_named() {
    let good = squares();
    let folder = peers::fresh_folder("import-bad-faces");
    write_pair(&folder, &good);
    let open = obj(&good.open);
    let without_last = open.trim_end().rsplit_once('\n').unwrap().0.to_owned();
    let with_triangle = open.replace("f 9 10 11 12", "f 9 10 11");
    let with_twice = open.replace("f 9 10 11 12", "f 9 10 11 9");
    let with_nan = open.replacen("v ", "v nan ", 1);
    let missing = open.replace("f 9 10 11 12", "f 9 10 11 1200");
    for (content, says) in [
        (without_last, ["b.obj has 11", "same faces"]),
        (with_triangle, ["face 3 has 4 corners", "3 in b.obj"]),
        (with_twice, ["b.obj: line 15", "twice"]),
        (with_nan, ["b.obj: line 1", "not finite"]),
        (missing, ["b.obj: line 15", "1200"]),
        (String::new(), ["b.obj", "empty"]),
    ] {
        std::fs::write(folder.join("b.obj"), content).unwrap();
        refused(&folder, &PAIR, 1, &says);
    }
    std::fs::remove_file(folder.join("b.obj")).unwrap();
    refused(&folder, &PAIR, 1, &["b.obj", "cannot be read"]);
}

#[test]
fn options_out_of_range_are_named() {
    let folder = peers::fresh_folder("import-bad-options");
    write_pair(&folder, &squares());
    for (option, value) in [
        ("--size-mm", "0"),
        ("--size-mm", "nan"),
        ("--scale", "-1"),
        ("--tolerance-mm", "0"),
        ("--tolerance-mm", "5"),
        ("--max-strain", "0"),
        ("--gap-mm", "-1"),
    ] {
        let flag = format!("{option}={value}");
        let start = if option == "--scale" { "the scale" } else { option };
        refused(&folder, &[&PAIR[..], &[&flag]].concat(), 1, &[start, "must"]);
    }
    refused(&folder, &[&PAIR[..], &["--scale", "1e12"]].concat(), 1, &["after scaling", "--units"]);
}

#[test]
fn faults_of_pykirigamis_files_are_named() {
    let good = squares();
    let folder = peers::fresh_folder("import-bad-pykirigami");
    std::fs::create_dir(folder.join("py")).unwrap();
    let hinges = "0 1 1 0 1\n";
    let write = |closed: &str, open: &str, constraints: &str| {
        for (name, text) in [("vertices.txt", closed), ("target.txt", open), ("constraints.txt", constraints)]
        {
            std::fs::write(folder.join("py").join(name), text).unwrap();
        }
    };
    let (closed, open) = (rows(&good.closed), rows(&good.open));
    let short = open.split_once('\n').unwrap().1;
    let cut = &closed[..closed.len() - 30];
    for (closed, open, constraints, says) in [
        (closed.as_str(), short, hinges, ["target.txt: holds 11 pieces", "12"]),
        (cut, open.as_str(), hinges, ["vertices.txt, line 12", "cut short"]),
        (&closed, &open.replacen(' ', " NaN ", 1), hinges, ["target.txt, line 1", "not finite"]),
        (&closed, &open.replacen(' ', " x ", 1), hinges, ["target.txt, line 1", "not a number"]),
        (&closed, &open, "0 1 1 0 1\n3 1 12 0 1\n", ["constraints.txt, line 2", "no piece 12"]),
        (&closed, &open, "0 1 1 4 1\n", ["constraints.txt, line 1", "piece 1 has no corner 4"]),
        (&closed, &open, "0 1 -1 0 1\n", ["constraints.txt, line 1", "`-1` is not an index"]),
        (&closed, &open, "0 1 1\n", ["constraints.txt, line 1", "3 numbers"]),
        (&closed, &open, "2 1 2 0 1\n", ["constraints.txt, line 1", "piece 2 with itself"]),
        (&closed, &open, "0 2 1 3 1\n", ["constraints.txt, line 1", "in the open state"]),
        (&closed, &open, hinges, ["not connected", "11 parts"]),
        (&closed, &open, "", ["there are no hinges", "tolerance"]),
    ] {
        write(closed, open, constraints);
        refused(&folder, &["import", "--pykirigami", "py", "-o", "d.json"], 1, &says);
    }
    std::fs::remove_file(folder.join("py/constraints.txt")).unwrap();
    refused(&folder, &["import", "--pykirigami", "py", "-o", "d.json"], 1, &["constraints.txt"]);
}
