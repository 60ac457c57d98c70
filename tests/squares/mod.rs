//! Rotating squares in the plane, whose two states are known in closed form: shared by the tests of import and export.

// Each test file uses its own part.
#![allow(dead_code)]

use std::fmt::Write;
use std::path::Path;

/// Columns and rows of [`squares`].
pub const GRID: [usize; 2] = [4, 3];

/// Imports what [`write_pair`] writes.
pub const PAIR: [&str; 7] = ["import", "--closed", "a.obj", "--open", "b.obj", "-o", "d.json"];

/// One state: the corners of each piece.
pub type State = Vec<Vec<[f64; 3]>>;

/// Both states of a design.
#[derive(Clone)]
pub struct Squares {
    pub closed: State,
    pub open: State,
}

impl Squares {
    /// `columns` by `rows` squares of side `side`, each turned by `turn` radians in the open state, neighbours in
    /// opposite senses: hinges turn by twice that. Rows follow each other; corners run counter-clockwise from the lower
    /// left.
    pub fn new([columns, rows]: [usize; 2], side: f64, turn: f64) -> Self {
        let state = |turn: f64| {
            let pitch = side * (turn.cos() + turn.sin());
            let square = |i: usize, j: usize| {
                let turn = if (i + j).is_multiple_of(2) { turn } else { -turn };
                [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]].map(|[x, y]| {
                    let (x, y) = (side * x, side * y);
                    [
                        pitch * i as f64 + x * turn.cos() - y * turn.sin(),
                        pitch * j as f64 + x * turn.sin() + y * turn.cos(),
                        0.0,
                    ]
                })
            };
            (0..rows).flat_map(|j| (0..columns).map(move |i| square(i, j).to_vec())).collect()
        };
        Self { closed: state(0.0), open: state(turn) }
    }

    /// Number of hinges: one for each pair of neighbours.
    pub fn hinges([columns, rows]: [usize; 2]) -> usize {
        columns * (rows - 1) + rows * (columns - 1)
    }
}

/// Each point moved.
pub fn moved(state: &State, by: impl Fn([f64; 3]) -> [f64; 3]) -> State {
    state.iter().map(|piece| piece.iter().map(|&p| by(p)).collect()).collect()
}

/// OBJ with vertices of their own for each face.
pub fn obj(state: &State) -> String {
    let mut text = String::new();
    let mut count = 0;
    for piece in state {
        for [x, y, z] in piece {
            writeln!(text, "v {x:?} {y:?} {z:?}").unwrap();
        }
        let corners: Vec<String> = (1..=piece.len()).map(|k| (count + k).to_string()).collect();
        writeln!(text, "f {}", corners.join(" ")).unwrap();
        count += piece.len();
    }
    text
}

/// A state as PyKirigami writes it.
pub fn rows(state: &State) -> String {
    let row = |piece: &Vec<[f64; 3]>| {
        let numbers: Vec<String> = piece.iter().flatten().map(|c| format!("{c:?}")).collect();
        numbers.join(" ") + "\n"
    };
    state.iter().map(row).collect()
}

/// Twelve squares of 12 mm that turn by 40 degrees.
pub fn squares() -> Squares {
    Squares::new(GRID, 12.0, 40_f64.to_radians())
}

/// Both states as a.obj and b.obj.
pub fn write_pair(folder: &Path, design: &Squares) {
    std::fs::write(folder.join("a.obj"), obj(&design.closed)).unwrap();
    std::fs::write(folder.join("b.obj"), obj(&design.open)).unwrap();
}
