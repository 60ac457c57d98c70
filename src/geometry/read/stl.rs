//! STL, binary and ASCII: triangles without connectivity.
//!
//! Corners at exactly the same position become one vertex; nothing is joined by a tolerance, because the two
//! sides of a slit may be arbitrarily close. Triangles of which two corners coincide exactly are left out: they
//! cover nothing, and without them their neighbours join. Normals, colours and names are passed over.
//!
//! `stl_io` reads the binary form. It reads ASCII as well, but stops after the first `solid` block and takes a
//! binary file for ASCII when its header says `solid`, so the ASCII form and the decision are made here.

use std::collections::HashMap;
use std::io::Cursor;

use super::error::{InvalidMeshFile, Place, Problem};
use super::text::{Lines, coordinate, point, quote, tokens};
use crate::geometry::Point3;
use crate::geometry::mesh::PolyMesh;

/// Bytes of the binary form before the count of triangles.
const HEADER_BYTES: usize = 80;
/// Bytes of the binary form before the first triangle.
const PREFIX_BYTES: usize = HEADER_BYTES + 4;
/// Bytes of a triangle in the binary form: normal, three corners, attribute.
const TRIANGLE_BYTES: usize = 50;

/// Reads an STL file's content.
///
/// # Errors
/// Names the line of an ASCII file or the triangle of a binary one, the value and the limit.
pub fn parse(bytes: &[u8]) -> Result<PolyMesh, InvalidMeshFile> {
    let triangles = if is_ascii(bytes) { parse_ascii(bytes)? } else { parse_binary(bytes)? };
    let mesh = weld(&triangles);
    if mesh.faces.is_empty() {
        return Err(Place::File.error(Problem::NoFaces));
    }
    Ok(mesh)
}

/// The count of triangles that a binary file states.
fn stated_count(bytes: &[u8]) -> Option<u32> {
    let count = bytes.get(HEADER_BYTES..PREFIX_BYTES)?;
    Some(u32::from_le_bytes(count.try_into().ok()?))
}

/// Size of a binary file with `count` triangles. Fits: 2^32 * 50 < 2^38.
fn binary_size(count: u32) -> u64 {
    PREFIX_BYTES as u64 + u64::from(count) * TRIANGLE_BYTES as u64
}

/// Whether the content is the ASCII form. A header that says `solid` proves nothing, since many programs write
/// it into binary files; but these hold zero bytes, in the count alone up to 2^24 triangles, and text does not.
fn is_ascii(bytes: &[u8]) -> bool {
    let says_solid =
        bytes.trim_ascii_start().get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    says_solid && !bytes.contains(&0)
}

fn parse_binary(bytes: &[u8]) -> Result<Vec<[Point3; 3]>, InvalidMeshFile> {
    let Some(count) = stated_count(bytes) else {
        let expected = "`solid` or an 84-byte binary header".to_owned();
        return Err(Place::File.error(Problem::Truncated { expected }));
    };
    if binary_size(count) > bytes.len() as u64 {
        let problem = Problem::CountTooLarge { count: u64::from(count), what: "triangles".to_owned() };
        return Err(Place::File.error(problem));
    }
    let surplus = bytes.len() - binary_size(count) as usize;
    if surplus > 0 {
        return Err(Place::File.error(Problem::TrailingBytes { bytes: surplus, what: "triangles" }));
    }
    // An empty header, so that `stl_io` does not take the content for ASCII.
    let mut plain = bytes.to_vec();
    plain[..HEADER_BYTES].fill(0);
    let mut cursor = Cursor::new(plain);
    let failed = |_| Place::File.error(Problem::Truncated { expected: "a triangle".to_owned() });
    let mut triangles = Vec::with_capacity(count as usize);
    for (index, triangle) in stl_io::create_stl_reader(&mut cursor).map_err(failed)?.enumerate() {
        let place = Place::Triangle(index + 1);
        let [a, b, c] = triangle.map_err(failed)?.vertices;
        let corner = |v: stl_io::Vertex| point(v.0.map(f64::from)).map_err(|problem| place.error(problem));
        triangles.push([corner(a)?, corner(b)?, corner(c)?]);
    }
    Ok(triangles)
}

/// The facets of all `solid` blocks.
fn parse_ascii(bytes: &[u8]) -> Result<Vec<[Point3; 3]>, InvalidMeshFile> {
    let mut statements = Statements { lines: Lines::new(bytes) };
    let mut triangles = Vec::new();
    while let Some((line, words)) = statements.next() {
        require(line, &words, b"solid", "`solid`")?;
        loop {
            let (line, words) = statements.require_next("`facet` or `endsolid`")?;
            if words[0].eq_ignore_ascii_case(b"endsolid") {
                break;
            }
            require(line, &words, b"facet", "`facet` or `endsolid`")?;
            triangles.push(statements.facet()?);
        }
    }
    Ok(triangles)
}

/// Line `line` must begin with `keyword`.
fn require(line: usize, words: &[&[u8]], keyword: &[u8], expected: &str) -> Result<(), InvalidMeshFile> {
    if words[0].eq_ignore_ascii_case(keyword) {
        return Ok(());
    }
    let problem = Problem::Unexpected { expected: expected.to_owned(), found: quote(words[0]) };
    Err(Place::Line(line).error(problem))
}

/// The lines of an ASCII file that are not blank, as words.
struct Statements<'a> {
    lines: Lines<'a>,
}

impl<'a> Statements<'a> {
    fn next(&mut self) -> Option<(usize, Vec<&'a [u8]>)> {
        self.lines.find_map(|(line, text)| {
            let words: Vec<_> = tokens(text).collect();
            (!words.is_empty()).then_some((line, words))
        })
    }

    fn require_next(&mut self, expected: &str) -> Result<(usize, Vec<&'a [u8]>), InvalidMeshFile> {
        let end = Place::Line(self.lines.number());
        self.next().ok_or_else(|| end.error(Problem::Truncated { expected: expected.to_owned() }))
    }

    /// The three corners of a facet, from behind its first line to its `endfacet`.
    fn facet(&mut self) -> Result<[Point3; 3], InvalidMeshFile> {
        self.keyword(b"outer", "`outer loop`")?;
        let corners = [self.vertex()?, self.vertex()?, self.vertex()?];
        self.keyword(b"endloop", "`endloop` after three vertices")?;
        self.keyword(b"endfacet", "`endfacet`")?;
        Ok(corners)
    }

    fn keyword(&mut self, keyword: &[u8], expected: &str) -> Result<(), InvalidMeshFile> {
        let (line, words) = self.require_next(expected)?;
        require(line, &words, keyword, expected)
    }

    fn vertex(&mut self) -> Result<Point3, InvalidMeshFile> {
        let expected = "one of the three `vertex` lines of a facet";
        let (line, words) = self.require_next(expected)?;
        require(line, &words, b"vertex", expected)?;
        let place = Place::Line(line);
        let [_, x, y, z] = words[..] else {
            return Err(place.error(Problem::CoordinateCount { found: words.len() - 1 }));
        };
        let read = |word| coordinate(word).map_err(|problem| place.error(problem));
        Ok(Point3::new(read(x)?, read(y)?, read(z)?))
    }
}

/// One vertex per position, in order of first use. Positions must not contain -0.
fn weld(triangles: &[[Point3; 3]]) -> PolyMesh {
    let mut mesh = PolyMesh::default();
    let mut vertex_at: HashMap<[u64; 3], usize> = HashMap::new();
    for triangle in triangles {
        let [a, b, c] = triangle.map(|corner| {
            let key = [corner.x.to_bits(), corner.y.to_bits(), corner.z.to_bits()];
            *vertex_at.entry(key).or_insert_with(|| {
                mesh.vertices.push(corner);
                mesh.vertices.len() - 1
            })
        });
        if a != b && b != c && c != a {
            mesh.faces.push(vec![a, b, c]);
        }
    }
    mesh
}

#[cfg(test)]
mod tests;
