//! The header of a PLY file.

use super::super::error::{InvalidMeshFile, Place, Problem};
use super::super::text::{Lines, quote, tokens};
use super::body::{Body, Encoding};

/// The elements in the order in which the body holds them.
pub struct Header {
    pub elements: Vec<Element>,
    /// Number of the line `end_header`.
    pub last_line: usize,
}

/// A table of the body.
pub struct Element {
    pub name: String,
    /// Stated number of records.
    pub count: u64,
    /// The columns.
    pub properties: Vec<Property>,
}

/// A column.
pub struct Property {
    pub name: String,
    pub shape: Shape,
}

/// What a column holds in each record.
#[derive(Clone, Copy)]
pub enum Shape {
    Scalar(Kind),
    /// `count` is an integer kind.
    List {
        count: Kind,
        item: Kind,
    },
}

/// The scalar types.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Kind {
    fn from_name(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    /// Size in the binary forms.
    pub fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    pub fn is_integer(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }
}

/// Reads the header and places a [`Body`] behind it.
pub fn parse(bytes: &[u8]) -> Result<(Header, Body<'_>), InvalidMeshFile> {
    let mut lines = Lines::new(bytes);
    let magic = lines.next().map_or(&b""[..], |(_, text)| text.trim_ascii_end());
    if magic != b"ply" {
        return Err(unexpected(1, "`ply`", magic));
    }
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    while let Some((line, text)) = lines.next() {
        let words: Vec<_> = tokens(text).collect();
        match words[..] {
            [] | [b"comment", ..] | [b"obj_info", ..] => {}
            [b"format", name, b"1.0"] => encoding = Some(encoding_of(line, name)?),
            [b"element", name, count] => {
                let element = element(line, name, count)?;
                let is_read = matches!(name, b"vertex" | b"face");
                if is_read && elements.iter().any(|other| other.name == element.name) {
                    return Err(unexpected(line, "an element that was not stated before", name));
                }
                elements.push(element);
            }
            [b"property", ref words @ ..] => {
                let element =
                    elements.last_mut().ok_or_else(|| unexpected(line, "`element` first", b"property"))?;
                element.properties.push(property(line, words)?);
            }
            [b"end_header"] => {
                let encoding = encoding.ok_or_else(|| unexpected(line, "a `format` line", b"end_header"))?;
                let body = match encoding {
                    Encoding::Ascii => Body::ascii(lines),
                    Encoding::Binary(order) => Body::binary(lines.rest(), order),
                };
                return Ok((Header { elements, last_line: line }, body));
            }
            _ => return Err(unexpected(line, "a line of a PLY 1.0 header", text)),
        }
    }
    let problem = Problem::Truncated { expected: "`end_header`".to_owned() };
    Err(Place::Line(lines.number()).error(problem))
}

fn encoding_of(line: usize, name: &[u8]) -> Result<Encoding, InvalidMeshFile> {
    Encoding::from_name(name)
        .ok_or_else(|| unexpected(line, "ascii, binary_little_endian or binary_big_endian", name))
}

fn element(line: usize, name: &[u8], count: &[u8]) -> Result<Element, InvalidMeshFile> {
    // Anything above is damage: no file that fits in memory holds so many records.
    const MAX_COUNT: u64 = 1 << 62;
    let count = std::str::from_utf8(count)
        .ok()
        .and_then(|text| text.parse().ok())
        .filter(|&count| count <= MAX_COUNT)
        .ok_or_else(|| unexpected(line, "a count of records", count))?;
    Ok(Element { name: quote(name), count, properties: Vec::new() })
}

/// `TYPE NAME` or `list COUNT_TYPE ITEM_TYPE NAME`.
fn property(line: usize, words: &[&[u8]]) -> Result<Property, InvalidMeshFile> {
    let kind = |name: &[u8]| {
        Kind::from_name(name)
            .ok_or_else(|| unexpected(line, "a type (char to uint, float, double, int8 to float64)", name))
    };
    let (name, shape) = match *words {
        [b"list", count, item, name] => {
            let count_kind = kind(count)?;
            if !count_kind.is_integer() {
                return Err(unexpected(line, "an integer type for the length of a list", count));
            }
            (name, Shape::List { count: count_kind, item: kind(item)? })
        }
        [scalar, name] => (name, Shape::Scalar(kind(scalar)?)),
        _ => return Err(unexpected(line, "`property TYPE NAME`", &words.join(&b' '))),
    };
    Ok(Property { name: quote(name), shape })
}

fn unexpected(line: usize, expected: &str, found: &[u8]) -> InvalidMeshFile {
    Place::Line(line).error(Problem::Unexpected { expected: expected.to_owned(), found: quote(found) })
}
