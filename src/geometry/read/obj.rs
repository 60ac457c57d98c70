//! Wavefront OBJ: vertices and polygons.
//!
//! Faces of all objects and groups are joined, and vertices keep the file's numbering: vertex `i` of the mesh is
//! vertex `i + 1` of the file, likewise faces. Texture coordinates, normals, materials, points, curves and
//! free-form surfaces are passed over, and so are the lines that [`super::polylines`] reads.

use std::borrow::Cow;

use super::error::{InvalidMeshFile, Place, Problem};
use super::text::{Lines, check_face, coordinate, quote, tokens};
use crate::geometry::Point3;
use crate::geometry::mesh::PolyMesh;

/// Reads an OBJ file's content.
///
/// # Errors
/// Names the line, the value and the limit.
pub fn parse(bytes: &[u8]) -> Result<PolyMesh, InvalidMeshFile> {
    let mut mesh = PolyMesh::default();
    let mut face_lines = Vec::new();
    let mut lines = Lines::new(bytes);
    while let Some((line, statement)) = next_statement(&mut lines) {
        let place = Place::Line(line);
        let mut words = tokens(&statement);
        let Some(keyword) = words.next() else { continue };
        match keyword {
            b"v" => mesh.vertices.push(vertex(words).map_err(|problem| place.error(problem))?),
            // `fo` is the name that faces had in old files.
            b"f" | b"fo" => {
                let face = face(words, mesh.vertices.len()).map_err(|problem| place.error(problem))?;
                mesh.faces.push(face);
                face_lines.push(line);
            }
            _ if keyword[0].is_ascii_alphabetic() => {}
            _ => {
                let expected = "a statement such as `v` or `f`".to_owned();
                return Err(place.error(Problem::Unexpected { expected, found: quote(keyword) }));
            }
        }
    }
    finish(mesh, &face_lines)
}

/// Checks what can be checked only when all vertices are known: a face may precede its vertices.
fn finish(mesh: PolyMesh, face_lines: &[usize]) -> Result<PolyMesh, InvalidMeshFile> {
    let count = mesh.vertices.len();
    if count == 0 {
        return Err(Place::File.error(Problem::NoVertices));
    }
    if mesh.faces.is_empty() {
        return Err(Place::File.error(Problem::NoFaces));
    }
    for (face, &line) in mesh.faces.iter().zip(face_lines) {
        if let Some(&vertex) = face.iter().find(|&&vertex| vertex >= count) {
            let index = i64::try_from(vertex).map_or(i64::MAX, |vertex| vertex.saturating_add(1));
            let problem = Problem::IndexOutOfRange { index, first: 1, last: count as i64 };
            return Err(Place::Line(line).error(problem));
        }
    }
    Ok(mesh)
}

/// The next statement without its comment, and the number of its first line. A backslash at the end of a line
/// joins the next one, but not from within a comment, where it may end the name of a folder.
pub(super) fn next_statement<'a>(lines: &mut Lines<'a>) -> Option<(usize, Cow<'a, [u8]>)> {
    let (first, line) = lines.next()?;
    let (mut statement, mut continues) = split_line(line);
    if !continues {
        return Some((first, Cow::Borrowed(statement)));
    }
    let mut joined = Vec::new();
    loop {
        joined.extend_from_slice(statement);
        joined.push(b' ');
        if !continues {
            break;
        }
        let Some((_, line)) = lines.next() else { break };
        (statement, continues) = split_line(line);
    }
    Some((first, Cow::Owned(joined)))
}

/// A line without comment and continuation mark, and whether it had the latter.
fn split_line(line: &[u8]) -> (&[u8], bool) {
    if let Some(comment) = line.iter().position(|&b| b == b'#') {
        return (&line[..comment], false);
    }
    match line.trim_ascii_end() {
        [statement @ .., b'\\'] => (statement, true),
        statement => (statement, false),
    }
}

/// A vertex: x y z, after which a weight or a colour or both may follow.
pub(super) fn vertex<'a>(words: impl Iterator<Item = &'a [u8]>) -> Result<Point3, Problem> {
    const MAX_NUMBERS: usize = 7;
    let mut position = [0.0; 3];
    let mut found = 0;
    for word in words {
        let value = coordinate(word)?;
        if let Some(slot) = position.get_mut(found) {
            *slot = value;
        }
        found += 1;
    }
    if !(3..=MAX_NUMBERS).contains(&found) {
        return Err(Problem::CoordinateCount { found });
    }
    Ok(Point3::from(position))
}

/// A face whose corners are `v`, `v/vt`, `v//vn` or `v/vt/vn`, after `preceding` vertices.
fn face<'a>(words: impl Iterator<Item = &'a [u8]>, preceding: usize) -> Result<Vec<usize>, Problem> {
    let face: Vec<usize> = words.map(|word| corner(word, preceding)).collect::<Result<_, _>>()?;
    check_face(&face, 1)?;
    Ok(face)
}

/// The vertex of a corner, counted from 0. Negative indices count back from the last vertex before the face.
pub(super) fn corner(word: &[u8], preceding: usize) -> Result<usize, Problem> {
    let digits = word.split(|&b| b == b'/').next().unwrap_or(word);
    let index: i64 = std::str::from_utf8(digits)
        .ok()
        .and_then(|text| text.parse().ok())
        .ok_or_else(|| Problem::NotAnIndex { token: quote(word) })?;
    match index {
        0 => Err(Problem::IndexOutOfRange { index, first: 1, last: preceding as i64 }),
        1.. => usize::try_from(index - 1).map_err(|_| Problem::NotAnIndex { token: quote(word) }),
        _ => usize::try_from(index.unsigned_abs())
            .ok()
            .and_then(|back| preceding.checked_sub(back))
            .ok_or(Problem::BeforeFirst { index, preceding }),
    }
}

#[cfg(test)]
mod tests;
