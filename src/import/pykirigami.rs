//! The three text files of PyKirigami (Q. Jiang, G. P. T. Choi, 2025).
//!
//! `vertices.txt` and `target.txt` hold a piece per line, as x y z of one corner after the other: the first state and
//! the state that it moves to. `constraints.txt` holds a hinge per line: piece, corner, piece, corner, and in newer
//! files the kind of joint, which is not looked at. Everything counts from 0. Empty lines are passed over.

use std::path::Path;

use super::error::ImportError;
use super::source::{Constraint, Source};
use crate::geometry::Point3;
use crate::geometry::read::read_file;
use crate::geometry::read::text::{Lines, coordinate, quote, tokens};

/// The pieces of the closed state.
pub const CLOSED: &str = "vertices.txt";
/// The pieces of the open state.
pub const OPEN: &str = "target.txt";
/// The hinges.
pub const CONSTRAINTS: &str = "constraints.txt";

/// Reads the files of a folder.
///
/// # Errors
/// The file, the line and the value that are wrong.
pub fn read_pykirigami(folder: &Path) -> Result<Source, ImportError> {
    let [closed_path, open_path] = [CLOSED, OPEN].map(|name| folder.join(name));
    let (closed, open) = (read_pieces(&closed_path)?, read_pieces(&open_path)?);
    let pieces = |lines: &[(usize, Vec<Point3>)]| lines.iter().map(|(_, piece)| piece.clone()).collect();
    if closed.len() != open.len() {
        let what = format!("holds {} pieces, but {CLOSED} holds {}", open.len(), closed.len());
        return Err(ImportError::File { path: open_path, what });
    }
    for (piece, ((_, closed), (line, open))) in closed.iter().zip(&open).enumerate() {
        if closed.len() != open.len() {
            let what = format!("piece {piece} has {} corners, in {CLOSED} {}", open.len(), closed.len());
            return Err(ImportError::Line { path: open_path, line: *line, what });
        }
    }
    let closed: Vec<Vec<Point3>> = pieces(&closed);
    let constraints = read_constraints(&folder.join(CONSTRAINTS), &closed)?;
    Ok(Source { closed, open: pieces(&open), constraints: Some(constraints) })
}

/// The pieces with the numbers of their lines.
fn read_pieces(path: &Path) -> Result<Vec<(usize, Vec<Point3>)>, ImportError> {
    let bytes = read_file(path)?;
    let mut pieces = Vec::new();
    for (line, text) in Lines::new(&bytes) {
        let wrong = |what: String| ImportError::Line { path: path.to_owned(), line, what };
        let numbers: Vec<f64> = tokens(text)
            .map(|token| coordinate(token).map_err(|problem| wrong(problem.to_string())))
            .collect::<Result<_, _>>()?;
        if numbers.is_empty() {
            continue;
        }
        if !numbers.len().is_multiple_of(3) || numbers.len() < 9 {
            return Err(wrong(format!(
                "{} numbers; a piece has x y z of three corners or more: the line may be cut short",
                numbers.len()
            )));
        }
        pieces.push((line, numbers.chunks_exact(3).map(|p| Point3::new(p[0], p[1], p[2])).collect()));
    }
    if pieces.is_empty() {
        return Err(ImportError::File { path: path.to_owned(), what: "holds no pieces".to_owned() });
    }
    Ok(pieces)
}

fn read_constraints(path: &Path, pieces: &[Vec<Point3>]) -> Result<Vec<Constraint>, ImportError> {
    let bytes = read_file(path)?;
    let mut constraints = Vec::new();
    for (line, text) in Lines::new(&bytes) {
        let wrong = |what: String| ImportError::Line { path: path.to_owned(), line, what };
        let index = |token: &[u8]| {
            let number = std::str::from_utf8(token).ok().and_then(|text| text.parse::<usize>().ok());
            number.ok_or_else(|| wrong(format!("`{}` is not an index, 0 or more", quote(token))))
        };
        let numbers: Vec<usize> = tokens(text).map(index).collect::<Result<_, _>>()?;
        let (pieces_of, corners) = match numbers[..] {
            [] => continue,
            [j, a, k, b] | [j, a, k, b, _] => ([j, k], [a, b]),
            _ => {
                let count = numbers.len();
                return Err(wrong(format!("{count} numbers; a hinge has piece corner piece corner [kind]")));
            }
        };
        for (piece, corner) in pieces_of.into_iter().zip(corners) {
            let Some(found) = pieces.get(piece) else {
                let last = pieces.len() - 1;
                return Err(wrong(format!("there is no piece {piece}; pieces run from 0 to {last}")));
            };
            if corner >= found.len() {
                let last = found.len() - 1;
                return Err(wrong(format!(
                    "piece {piece} has no corner {corner}; its corners run from 0 to {last}"
                )));
            }
        }
        if pieces_of[0] == pieces_of[1] {
            return Err(wrong(format!("joins piece {} with itself", pieces_of[0])));
        }
        let place = format!("{}, line {line}", path.display());
        constraints.push(Constraint { pieces: pieces_of, corners, place });
    }
    Ok(constraints)
}
