//! The polylines of a Wavefront OBJ file: its `l` elements.

use std::path::Path;

use super::error::{InvalidMeshFile, Place, Problem, ReadMeshError};
use super::obj::{corner, next_statement, vertex};
use super::text::{Lines, tokens};
use super::{read_file, require_regular_file};
use crate::geometry::Point3;

/// The polylines of a file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Polylines {
    /// All vertices of the file, in its units: vertex `i` is vertex `i + 1` of the file.
    pub vertices: Vec<Point3>,
    /// The polylines, in the file's order.
    pub lines: Vec<Polyline>,
}

/// One `l` element.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Polyline {
    /// Its vertices, two or more.
    pub vertices: Vec<usize>,
    /// The line of the file that it begins in, counted from 1.
    pub line: usize,
}

/// Reads the polylines of the OBJ file at `path`, which may hold faces as well or have no polylines at all.
///
/// # Errors
/// See [`ReadMeshError`]; every message names the file.
pub fn read_polylines(path: &Path) -> Result<Polylines, ReadMeshError> {
    require_regular_file(path)?;
    let bytes = read_file(path)?;
    parse(&bytes).map_err(|invalid| ReadMeshError::Invalid { path: path.into(), invalid })
}

/// Reads the polylines of an OBJ file's content; all other elements are passed over.
///
/// # Errors
/// Names the line, the value and the limit.
pub fn parse(bytes: &[u8]) -> Result<Polylines, InvalidMeshFile> {
    let mut found = Polylines::default();
    let mut lines = Lines::new(bytes);
    while let Some((line, statement)) = next_statement(&mut lines) {
        let fault = |problem| Place::Line(line).error(problem);
        let mut words = tokens(&statement);
        match words.next() {
            Some(b"v") => found.vertices.push(vertex(words).map_err(fault)?),
            Some(b"l") => {
                let preceding = found.vertices.len();
                let vertices: Vec<usize> =
                    words.map(|word| corner(word, preceding)).collect::<Result<_, _>>().map_err(fault)?;
                if vertices.len() < 2 {
                    return Err(fault(Problem::LineTooShort { vertices: vertices.len() }));
                }
                found.lines.push(Polyline { vertices, line });
            }
            _ => {}
        }
    }
    // A polyline may precede its vertices.
    let count = found.vertices.len();
    for Polyline { vertices, line } in &found.lines {
        if let Some(&vertex) = vertices.iter().find(|&&vertex| vertex >= count) {
            let index = i64::try_from(vertex).map_or(i64::MAX, |vertex| vertex.saturating_add(1));
            let problem = Problem::IndexOutOfRange { index, first: 1, last: count as i64 };
            return Err(Place::Line(*line).error(problem));
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polylines_are_read_and_all_else_is_passed_over() {
        let file = b"# cuts\no seam\nv 0 0 0\nv 1 0 0\nv 1 2 0.5\nf 1 2 3\nl 1 2/7 \\\n 3\nl -1 -3\n";
        let Polylines { vertices, lines } = parse(file).unwrap();
        assert_eq!(vertices[2], Point3::new(1.0, 2.0, 0.5));
        let expected =
            [Polyline { vertices: vec![0, 1, 2], line: 7 }, Polyline { vertices: vec![2, 0], line: 9 }];
        assert_eq!(lines, expected);
        assert_eq!(parse(b"v 0 0 0\n").unwrap().lines, []);
    }

    #[test]
    fn faults_name_the_line() {
        let message = |text: &[u8]| parse(text).unwrap_err().to_string();
        assert!(message(b"v 0 0 0\nl 1\n").starts_with("line 2: the polyline has 1 vertex"));
        assert!(message(b"v 0 0 0\nl 1 2\n").contains("vertex 2 is named, but the vertices run from 1 to 1"));
        assert!(message(b"v 0 0\n").starts_with("line 1: a vertex has three coordinates"));
    }
}
