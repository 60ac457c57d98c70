//! TOML files that people write: reading them, and errors that point at the place.
//!
//! In: a file and a serde structure with `deny_unknown_fields`. Out: the structure, or a [`TomlError`] whose text
//! shows file, line, the line itself with a caret under the offending value, what is allowed and why. Job and
//! profile share this module, so all their errors look alike. Nothing here knows a key by name.

use std::fmt;
use std::io::Read;
use std::ops::{Range, RangeInclusive};
use std::path::{Path, PathBuf};

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};
use serde::de::DeserializeOwned;
use thiserror::Error;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

mod shelf;

pub use shelf::{Shelf, ShelfError, TomlFile};

/// Longest TOML file that is read, bytes. A profile has 2 kB; a mesh given by mistake is told at once.
const MAX_BYTES: u64 = 1 << 20;

/// A TOML file could not be used.
#[derive(Debug, Error)]
pub enum TomlError {
    /// The file cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the operating system says.
        source: std::io::Error,
    },
    /// A directory stands where the file should.
    #[error("{} is a directory; name the TOML file in it", path.display())]
    Directory {
        /// The directory.
        path: PathBuf,
    },
    /// The file is longer than any such file should be.
    #[error("{} has more than {MAX_BYTES} bytes; a TOML file of this program has a few thousand", path.display())]
    TooLong {
        /// The file.
        path: PathBuf,
    },
    /// The bytes are not UTF-8 text.
    #[error("{}, line {line}: not UTF-8 text; save the file as UTF-8", path.display())]
    NotUtf8 {
        /// The file.
        path: PathBuf,
        /// Line of the first bad byte, from 1.
        line: usize,
    },
    /// The text breaks a rule at a known place.
    #[error("{0}")]
    Invalid(Box<Diagnostic>),
}

/// A rule that the text breaks, and where. Displayed as several lines of plain text with a caret.
#[derive(Debug, Clone, PartialEq)]
pub struct Diagnostic {
    /// File name as the user gave it.
    pub file: String,
    /// Line of the offending value, from 1.
    pub line: usize,
    /// Column of the offending value in characters, from 1.
    pub column: usize,
    /// Dotted path of the key (`laser.kerf_mm`); empty where the text is not TOML at all.
    pub key: String,
    /// What is wrong, with the value and the limit.
    pub message: String,
    /// The reason or the remedy; may be empty.
    pub help: String,
    text: String,
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// The range of a number and why it ends there.
#[derive(Debug, Clone, PartialEq)]
pub struct Limits {
    /// Allowed values, in the key's unit.
    pub range: RangeInclusive<f64>,
    /// The unit for messages; empty for pure numbers.
    pub unit: &'static str,
    /// One sentence on what the range rests on.
    pub reason: &'static str,
}

impl Limits {
    /// Allowed values `min` to `max`, both included.
    pub const fn new(min: f64, max: f64, unit: &'static str, reason: &'static str) -> Self {
        Self { range: min..=max, unit, reason }
    }
}

impl fmt::Display for Limits {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} to {}", self.range.start(), self.range.end())?;
        if self.unit.is_empty() { Ok(()) } else { write!(f, " {}", self.unit) }
    }
}

/// Reads a text file.
///
/// # Errors
/// The file is missing, a directory, a device or pipe, which may never end, longer than 1 MiB or not UTF-8.
pub fn read_text(path: &Path) -> Result<String, TomlError> {
    let read_error = |source| TomlError::Read { path: path.to_owned(), source };
    let kind = std::fs::metadata(path).map_err(read_error)?.file_type();
    if kind.is_dir() {
        return Err(TomlError::Directory { path: path.to_owned() });
    }
    if !kind.is_file() {
        return Err(read_error(std::io::Error::other("it is a device or pipe; name a file")));
    }
    let mut bytes = Vec::new();
    let file = std::fs::File::open(path).map_err(read_error)?;
    file.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(read_error)?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(TomlError::TooLong { path: path.to_owned() });
    }
    String::from_utf8(bytes).map_err(|error| {
        let good = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let line = 1 + good.iter().filter(|&&byte| byte == b'\n').count();
        TomlError::NotUtf8 { path: path.to_owned(), line }
    })
}

/// A TOML text with the name it is known by.
#[derive(Debug, Clone, Copy)]
pub struct TomlSource<'a> {
    /// File name for messages.
    pub file: &'a str,
    /// The whole text.
    pub text: &'a str,
}

/// Two values; a list, because a list that is too long fits an array of two without a word.
pub type Pair<T> = Spanned<Vec<Spanned<T>>>;

impl<'a> TomlSource<'a> {
    /// Reads the structure `T`.
    ///
    /// # Errors
    /// Syntax errors, unknown keys, missing keys and wrong types, as `toml` and serde word them.
    pub fn parse<T: DeserializeOwned>(&self) -> Result<T, TomlError> {
        toml::from_str(self.text).map_err(|error| {
            let message = error.message().replace("unknown field", "unknown key");
            let message = message.replace("missing field", "missing key");
            self.error(error.span().unwrap_or(0..0), message, "")
        })
    }

    /// An error at the bytes `span` of the text. A span that reaches over several lines is cut to its first.
    pub fn error(
        &self,
        span: Range<usize>,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> TomlError {
        let (message, help) = (message.into(), help.into());
        let place = Place::of(self.text, &span);
        let annotation = AnnotationKind::Primary.span(place.in_line.clone());
        let snippet =
            Snippet::source(place.content).path(self.file).line_start(place.line).annotation(annotation);
        let mut report = Level::ERROR.no_name().primary_title(message.as_str()).element(snippet);
        if !help.is_empty() {
            report = report.element(Level::HELP.message(help.as_str()));
        }
        let text = Renderer::plain().render(&[report]);
        TomlError::Invalid(Box::new(Diagnostic {
            file: self.file.to_owned(),
            line: place.line,
            column: 1 + place.content[..place.in_line.start].chars().count(),
            key: self.key_at(span.start),
            message,
            help,
            text,
        }))
    }

    /// The number, if it is finite and within its limits.
    ///
    /// # Errors
    /// It is not; the message has the value as written, the range and the reason.
    pub fn number(&self, value: &Spanned<f64>, limits: &Limits) -> Result<f64, TomlError> {
        let number = *value.get_ref();
        if limits.range.contains(&number) {
            return Ok(number);
        }
        let what = if number.is_finite() { "out of range" } else { "not a finite number" };
        Err(self.value_error(value.span(), &format!("{what}: allowed is {limits}"), limits.reason))
    }

    /// As [`TomlSource::number`], for a key that may be absent.
    ///
    /// # Errors
    /// As [`TomlSource::number`].
    pub fn optional(&self, value: Option<&Spanned<f64>>, limits: &Limits) -> Result<Option<f64>, TomlError> {
        value.map(|value| self.number(value, limits)).transpose()
    }

    /// The whole number, if it is within its limits.
    ///
    /// # Errors
    /// As [`TomlSource::number`].
    pub fn count(&self, value: &Spanned<i64>, limits: &Limits) -> Result<usize, TomlError> {
        // Beyond 2^53 the conversion rounds, far outside of the limits.
        Ok(self.number(&Spanned::new(value.span(), *value.get_ref() as f64), limits)? as usize)
    }

    /// The two entries of a list.
    ///
    /// # Errors
    /// It has more or fewer.
    pub fn pair<'v, T>(&self, value: &'v Pair<T>) -> Result<[&'v Spanned<T>; 2], TomlError> {
        if let [first, second] = value.get_ref().as_slice() {
            return Ok([first, second]);
        }
        let values = match value.get_ref().len() {
            1 => "1 value".to_owned(),
            number => format!("{number} values"),
        };
        let what = format!("{values}: allowed are two");
        Err(self.value_error(value.span(), &what, "one for each direction of the sheet"))
    }

    /// The meaning of one of a few words; `help` says what they decide.
    ///
    /// # Errors
    /// It is none of them; the message lists them.
    pub fn word<T: Copy>(
        &self,
        value: &Spanned<String>,
        words: &[(&str, T)],
        help: &str,
    ) -> Result<T, TomlError> {
        if let Some((_, meaning)) = words.iter().find(|(word, _)| word == value.get_ref()) {
            return Ok(*meaning);
        }
        let allowed: Vec<String> = words.iter().map(|(word, _)| format!("\"{word}\"")).collect();
        Err(self.value_error(value.span(), &format!("not known: allowed is {}", allowed.join(", ")), help))
    }

    /// As [`TomlSource::word`], for a key that may be absent.
    ///
    /// # Errors
    /// As [`TomlSource::word`].
    pub fn optional_word<T: Copy>(
        &self,
        value: Option<&Spanned<String>>,
        words: &[(&str, T)],
    ) -> Result<Option<T>, TomlError> {
        value.map(|value| self.word(value, words, "")).transpose()
    }

    /// An error "`key` = value is ..." at a value.
    pub fn value_error(&self, span: Range<usize>, what: &str, help: impl Into<String>) -> TomlError {
        let written = self.text.get(span.clone()).unwrap_or_default();
        let message = format!("{} = {} is {what}", self.key_at(span.start), shortened(written));
        self.error(span, message, help)
    }

    /// The dotted path of the key whose name or value stands at byte `position`; empty if none does.
    fn key_at(&self, position: usize) -> String {
        let Ok(root) = DeTable::parse(self.text) else { return String::new() };
        let mut path = Vec::new();
        if find_key(root.get_ref(), position, &mut path) { path.join(".") } else { String::new() }
    }
}

/// Appends to `path` the keys that lead to `position`, innermost last. False, and nothing appended, if none does.
fn find_key<'t>(table: &'t DeTable<'_>, position: usize, path: &mut Vec<&'t str>) -> bool {
    for (key, value) in table.iter() {
        path.push(key.get_ref());
        // A table's own span is its header only, so its keys are searched in any case.
        let inside = match value.get_ref() {
            DeValue::Table(inner) => find_key(inner, position, path),
            // An array of tables: its keys have the array's path.
            DeValue::Array(items) => items
                .iter()
                .any(|item| item.get_ref().as_table().is_some_and(|inner| find_key(inner, position, path))),
            _ => false,
        };
        if inside || value.span().contains(&position) || key.span().contains(&position) {
            return true;
        }
        path.pop();
    }
    false
}

/// At most 40 characters of a value as written: a caret shows the rest.
fn shortened(written: &str) -> String {
    match written.char_indices().nth(40) {
        Some((end, _)) => format!("{}...", &written[..end]),
        None => written.to_owned(),
    }
}

/// One line of a text and a range of bytes in it, on character boundaries.
struct Place<'a> {
    line: usize,
    content: &'a str,
    in_line: Range<usize>,
}

impl<'a> Place<'a> {
    fn of(text: &'a str, span: &Range<usize>) -> Self {
        let start = char_boundary(text, span.start);
        let line_start = text[..start].rfind('\n').map_or(0, |newline| newline + 1);
        let content = text[line_start..].split('\n').next().unwrap_or_default();
        let content = content.strip_suffix('\r').unwrap_or(content);
        let from = (start - line_start).min(content.len());
        let to = char_boundary(content, span.end.saturating_sub(line_start));
        let line = 1 + text[..line_start].matches('\n').count();
        Self { line, content, in_line: from..to.max(from) }
    }
}

/// The last character boundary of `text` at or before byte `position`.
fn char_boundary(text: &str, position: usize) -> usize {
    let mut boundary = position.min(text.len());
    while !text.is_char_boundary(boundary) {
        boundary -= 1;
    }
    boundary
}

#[cfg(test)]
pub(crate) mod corruption;

#[cfg(test)]
mod tests;
