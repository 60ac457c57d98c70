//! The values behind a PLY header, one after the other.

use super::super::error::{InvalidMeshFile, Place, Problem};
use super::super::text::{Lines, number, quote, tokens};
use super::header::{Element, Kind, Shape};

/// How the body is written.
#[derive(Debug, Clone, Copy)]
pub enum Encoding {
    Ascii,
    Binary(ByteOrder),
}

/// Order of the bytes of a number.
#[derive(Debug, Clone, Copy)]
pub enum ByteOrder {
    Little,
    Big,
}

impl Encoding {
    pub fn from_name(name: &[u8]) -> Option<Self> {
        match name {
            b"ascii" => Some(Self::Ascii),
            b"binary_little_endian" => Some(Self::Binary(ByteOrder::Little)),
            b"binary_big_endian" => Some(Self::Binary(ByteOrder::Big)),
            _ => None,
        }
    }
}

/// A cursor over the body. ASCII records take one line each.
pub struct Body<'a> {
    source: Source<'a>,
    place: Place,
}

enum Source<'a> {
    Ascii { lines: Lines<'a>, record: &'a [u8] },
    Binary { rest: &'a [u8], order: ByteOrder },
}

impl<'a> Body<'a> {
    pub fn ascii(lines: Lines<'a>) -> Self {
        Self { place: Place::Line(lines.number()), source: Source::Ascii { lines, record: b"" } }
    }

    pub fn binary(rest: &'a [u8], order: ByteOrder) -> Self {
        Self { place: Place::File, source: Source::Binary { rest, order } }
    }

    /// The line or record that is being read.
    pub fn place(&self) -> &Place {
        &self.place
    }

    /// Checks that the bytes at hand can hold the stated records of `element`.
    pub fn require_room(&self, element: &Element) -> Result<(), InvalidMeshFile> {
        let (room, least_record) = match &self.source {
            // A digit and a separator per value, and the last separator may be missing.
            Source::Ascii { lines, .. } => (lines.rest().len() + 1, 2 * element.properties.len()),
            Source::Binary { rest, .. } => (rest.len(), element.properties.iter().map(least_bytes).sum()),
        };
        if element.count.saturating_mul(least_record as u64) > room as u64 {
            let problem =
                Problem::CountTooLarge { count: element.count, what: format!("{} records", element.name) };
            return Err(Place::File.error(problem));
        }
        Ok(())
    }

    /// Goes to record `index` of `element`.
    pub fn begin(&mut self, element: &Element, index: u64) -> Result<(), InvalidMeshFile> {
        match &mut self.source {
            Source::Ascii { lines, record } => {
                let (line, text) =
                    lines.find(|(_, text)| !text.trim_ascii().is_empty()).ok_or_else(|| {
                        let expected =
                            format!("record {} of {} of {}", index + 1, element.count, element.name);
                        Place::File.error(Problem::Truncated { expected })
                    })?;
                self.place = Place::Line(line);
                *record = text;
            }
            Source::Binary { .. } => self.place = Place::Record { element: element.name.clone(), index },
        }
        Ok(())
    }

    /// Ends a record of `element`: an ASCII line must hold nothing more.
    pub fn end(&self, element: &Element) -> Result<(), InvalidMeshFile> {
        if let Source::Ascii { record, .. } = self.source
            && let Some(token) = tokens(record).next()
        {
            let expected = format!("the end of the {} record", element.name);
            return Err(self.place.error(Problem::Unexpected { expected, found: quote(token) }));
        }
        Ok(())
    }

    /// The next value. Integer kinds give integers; floating ones may be NaN or infinite.
    pub fn value(&mut self, kind: Kind) -> Result<f64, InvalidMeshFile> {
        match &mut self.source {
            Source::Ascii { record, .. } => {
                let text = record.trim_ascii_start();
                let end = text.iter().position(u8::is_ascii_whitespace).unwrap_or(text.len());
                let (token, rest) = text.split_at(end);
                *record = rest;
                ascii_value(token, kind)
            }
            Source::Binary { rest, order } => rest
                .split_at_checked(kind.bytes())
                .map(|(bytes, tail)| {
                    *rest = tail;
                    binary_value(bytes, kind, *order)
                })
                .ok_or(Problem::Truncated { expected: "a value".to_owned() }),
        }
        .map_err(|problem| self.place.error(problem))
    }

    /// The length of a list whose items are of kind `item`; so many items can follow.
    pub fn list_length(&mut self, count: Kind, item: Kind) -> Result<usize, InvalidMeshFile> {
        let length = self.value(count)?;
        let room = match &self.source {
            Source::Ascii { record, .. } => record.len(),
            Source::Binary { rest, .. } => rest.len() / item.bytes(),
        };
        if length < 0.0 {
            let expected = "the length of a list".to_owned();
            return Err(self.place.error(Problem::Unexpected { expected, found: length.to_string() }));
        }
        // At most 32 bits, hence exact.
        let length = length as u64;
        if length > room as u64 {
            let problem = Problem::CountTooLarge { count: length, what: "items of a list".to_owned() };
            return Err(self.place.error(problem));
        }
        Ok(length as usize)
    }

    /// Only white space may follow.
    pub fn require_end(&self) -> Result<(), InvalidMeshFile> {
        let rest = match &self.source {
            Source::Ascii { lines, .. } => lines.rest(),
            Source::Binary { rest, .. } => rest,
        };
        let bytes = rest.trim_ascii().len();
        if bytes > 0 {
            return Err(Place::File.error(Problem::TrailingBytes { bytes, what: "records" }));
        }
        Ok(())
    }
}

/// Fewest bytes of a property in the binary forms: an empty list has its length alone.
fn least_bytes(property: &super::header::Property) -> usize {
    match property.shape {
        Shape::Scalar(kind) => kind.bytes(),
        Shape::List { count, .. } => count.bytes(),
    }
}

fn ascii_value(token: &[u8], kind: Kind) -> Result<f64, Problem> {
    if token.is_empty() {
        let expected = "another value of the record".to_owned();
        return Err(Problem::Unexpected { expected, found: "end of line".to_owned() });
    }
    let value = number(token)?;
    // Wider than any integer kind's own range; indices are compared with the count of vertices later.
    let is_integer = value.fract() == 0.0 && value.abs() <= f64::from(u32::MAX);
    if kind.is_integer() && !is_integer {
        return Err(Problem::Unexpected { expected: "an integer".to_owned(), found: quote(token) });
    }
    Ok(value)
}

/// The number in `bytes`, of which there are `kind.bytes()`.
fn binary_value(bytes: &[u8], kind: Kind, order: ByteOrder) -> f64 {
    let mut word = [0; 8];
    let word = &mut word[..bytes.len()];
    word.copy_from_slice(bytes);
    if matches!(order, ByteOrder::Big) {
        word.reverse();
    }
    let bits = word.iter().rev().fold(0_u64, |bits, &byte| (bits << 8) | u64::from(byte));
    // Truncation to the kind's width is meant: the upper bytes are zero.
    match kind {
        Kind::I8 => f64::from(bits as u8 as i8),
        Kind::U8 => f64::from(bits as u8),
        Kind::I16 => f64::from(bits as u16 as i16),
        Kind::U16 => f64::from(bits as u16),
        Kind::I32 => f64::from(bits as u32 as i32),
        Kind::U32 => f64::from(bits as u32),
        Kind::F32 => f64::from(f32::from_bits(bits as u32)),
        Kind::F64 => f64::from_bits(bits),
    }
}
