//! Lines, tokens and numbers of text formats, from bytes that need not be UTF-8.

use super::error::{MAX_COORDINATE, Problem};
use crate::geometry::Point3;

/// The lines of a text with their numbers, counted from 1. Lines end with LF, CR LF or CR.
#[derive(Debug, Clone)]
pub struct Lines<'a> {
    rest: &'a [u8],
    number: usize,
}

impl<'a> Lines<'a> {
    /// All lines of `bytes`.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes, number: 0 }
    }

    /// What follows the lines taken so far.
    pub fn rest(&self) -> &'a [u8] {
        self.rest
    }

    /// Number of the line taken last; 0 before the first.
    pub fn number(&self) -> usize {
        self.number
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = (usize, &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        if self.rest.is_empty() {
            return None;
        }
        let end = self.rest.iter().position(|&b| b == b'\n' || b == b'\r').unwrap_or(self.rest.len());
        let (line, tail) = self.rest.split_at(end);
        let ending = if tail.starts_with(b"\r\n") { 2 } else { tail.len().min(1) };
        self.rest = &tail[ending..];
        self.number += 1;
        Some((self.number, line))
    }
}

/// The tokens of a line, separated by white space.
pub fn tokens(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(|b| b.is_ascii_whitespace()).filter(|token| !token.is_empty())
}

/// A token for a message: shortened, control characters escaped.
pub fn quote(token: &[u8]) -> String {
    const MAX_SHOWN: usize = 40;
    let text = String::from_utf8_lossy(&token[..token.len().min(4 * MAX_SHOWN)]).into_owned();
    let mut shown: String = text.chars().take(MAX_SHOWN).flat_map(char::escape_debug).collect();
    if text.chars().count() > MAX_SHOWN {
        shown.push('…');
    }
    shown
}

/// The number that `token` writes, which may be NaN or infinite.
pub fn number(token: &[u8]) -> Result<f64, Problem> {
    std::str::from_utf8(token)
        .ok()
        .and_then(|text| text.parse().ok())
        .ok_or_else(|| Problem::NotANumber { token: quote(token) })
}

/// The coordinate that `token` writes: finite and within [`MAX_COORDINATE`], never -0.
pub fn coordinate(token: &[u8]) -> Result<f64, Problem> {
    let value = number(token)?;
    if !value.is_finite() {
        return Err(Problem::NotFinite { token: quote(token) });
    }
    checked(value)
}

/// The point at `coordinates`, each of them finite and within [`MAX_COORDINATE`], never -0.
pub fn point(coordinates: [f64; 3]) -> Result<Point3, Problem> {
    let [x, y, z] = coordinates;
    Ok(Point3::new(checked(x)?, checked(y)?, checked(z)?))
}

fn checked(value: f64) -> Result<f64, Problem> {
    if !value.is_finite() {
        return Err(Problem::NotFinite { token: value.to_string() });
    }
    if value.abs() > MAX_COORDINATE {
        return Err(Problem::TooFar { value });
    }
    // Turns -0 into 0 and leaves every other number as it is.
    Ok(value + 0.0)
}

/// Checks that a face has three corners or more and names no vertex twice. `first` is the index of the first
/// vertex in the file's own numbering.
pub fn check_face(face: &[usize], first: usize) -> Result<(), Problem> {
    if face.len() < 3 {
        return Err(Problem::FaceTooSmall { corners: face.len() });
    }
    let mut sorted = face.to_vec();
    sorted.sort_unstable();
    match sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(Problem::RepeatedVertex { vertex: pair[0] + first }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_with_lf_crlf_or_cr() {
        let lines: Vec<_> = Lines::new(b"a\nb\r\nc\rd\n\ne").collect();
        let expected: [(usize, &[u8]); 6] = [(1, b"a"), (2, b"b"), (3, b"c"), (4, b"d"), (5, b""), (6, b"e")];
        assert_eq!(lines, expected);
    }

    #[test]
    fn quoted_tokens_are_short_and_printable() {
        assert_eq!(quote(b"abc"), "abc");
        assert_eq!(quote(b"a\x1b[31m\0"), "a\\u{1b}[31m\\0");
        assert_eq!(quote(&[b'x'; 1000]).chars().count(), 41);
        assert!(!quote(&[0xff; 1000]).is_empty());
    }

    #[test]
    fn coordinates_lose_the_sign_of_zero_and_nothing_else() {
        assert!(coordinate(b"-0.0").unwrap().is_sign_positive());
        assert_eq!(coordinate(b"-1.5e-300").unwrap(), -1.5e-300);
        assert_eq!(coordinate(b"-1e9").unwrap(), -1e9);
        assert_eq!(coordinate(b"1.0000001e9"), Err(Problem::TooFar { value: 1.0000001e9 }));
        for token in [&b"nan"[..], b"inf", b"-Infinity", b"1e400"] {
            assert!(matches!(coordinate(token), Err(Problem::NotFinite { .. })));
        }
        for token in [&b"1,5"[..], b"", b"0x10", b"1.2.3", b"\xff"] {
            assert!(matches!(coordinate(token), Err(Problem::NotANumber { .. })));
        }
    }
}
