//! `design.partial.json`, version 1: how far an interrupted optimisation came, and all that it needs to go
//! on.
//!
//! The pieces are there for people and programs to look at: millimetres, like those of `design.json`, but not
//! yet congruent in their two states. What counts are the minimisations ([`Entry`]), whose unknowns and
//! energies read back exactly. The same state gives the same bytes.

use std::collections::BTreeMap;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};

use super::json_rows::write_rows;
use super::whole_file::read_regular;
use crate::kirigami::design::Piece;
use crate::solver::journal::Entry;
use crate::solver::{Iteration, Report, Termination};

/// The file's name in the output folder.
pub const FILE_NAME: &str = "design.partial.json";

/// The version of the format that is written and read.
pub const VERSION: u64 = 1;

/// The program that writes the file, and the only one that goes on from it: another version may take other
/// steps.
const PROGRAM: &str = concat!("kirimorph ", env!("CARGO_PKG_VERSION"));

/// Unknowns in one line of the file.
const UNKNOWNS_PER_LINE: usize = 12;

/// Everything that goes into the file.
#[derive(Debug, Clone, Copy)]
pub struct Partial<'a> {
    /// The stage that was broken off.
    pub stage: &'a str,
    /// The pieces as they are.
    pub pieces: &'a [Piece],
    /// The minimisations so far.
    pub journal: &'a [Entry],
    /// Hashes of all that decides about the result, by name.
    pub hashes: &'a BTreeMap<String, String>,
}

/// Why the state cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum PartialError {
    /// No such file, or it cannot be read.
    #[error("{} cannot be read: {source}; without --resume the job starts from its beginning", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// Not the format's text.
    #[error("{}: {source}; without --resume the job starts from its beginning", path.display())]
    Json {
        /// The file.
        path: PathBuf,
        /// What is wrong, with line and column.
        source: serde_json::Error,
    },
    /// Another version of format or program, another job, or a state that contradicts itself.
    #[error("{}: {what}; without --resume the job starts from its beginning", path.display())]
    Unfit {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        what: String,
    },
}

/// Writes the file.
///
/// # Errors
/// A number that is not finite, before anything is written, or the error of `out`.
pub fn write<W: Write>(partial: &Partial, out: W) -> io::Result<()> {
    let numbers = partial.journal.iter().flat_map(|entry| {
        let iterations = entry.report.iterations.iter().flat_map(|row| &row.energies);
        entry.unknowns.iter().chain(iterations).chain([&entry.report.next_damping])
    });
    if numbers.into_iter().any(|number| !number.is_finite()) {
        return Err(io::Error::other("the state so far is not finite: there is nothing to go on from"));
    }
    let mut out = BufWriter::new(out);
    let (phase, iteration) = reached(partial);
    writeln!(out, "{{\n  \"version\": {VERSION},\n  \"converged\": false,\n  \"program\": \"{PROGRAM}\",")?;
    writeln!(out, "  \"units\": \"mm\",\n  \"stage\": \"{}\",", partial.stage)?;
    writeln!(out, "  \"phase\": {phase},\n  \"iteration\": {iteration},")?;
    writeln!(out, "  \"hashes\": {},", serde_json::to_string(partial.hashes)?)?;
    write_rows(&mut out, "  ", "pieces", partial.pieces.iter().map(PieceRow::new))?;
    write!(out, ",\n  \"minimisations\": [")?;
    for (i, Entry { stage, report, unknowns }) in partial.journal.iter().enumerate() {
        write!(out, "{}\n    {{\n      \"stage\": \"{stage}\",", if i == 0 { "" } else { "," })?;
        writeln!(out, "\n      \"stopped\": \"{}\",", report.termination.reason())?;
        writeln!(out, "      \"next_damping\": {:?},", report.next_damping)?;
        writeln!(out, "      \"terms\": {},", serde_json::to_string(&report.terms)?)?;
        write_rows(&mut out, "      ", "iterations", report.iterations.iter().map(IterationRow::new))?;
        writeln!(out, ",")?;
        write_rows(&mut out, "      ", "unknowns", unknowns.chunks(UNKNOWNS_PER_LINE))?;
        write!(out, "\n    }}")?;
    }
    writeln!(out, "\n  ]\n}}")?;
    out.flush()
}

/// Phase of the last stage, from 0, and steps made in it.
fn reached(partial: &Partial) -> (usize, usize) {
    let Some(last) = partial.journal.last() else { return (0, 0) };
    let phases = partial.journal.iter().filter(|entry| entry.stage == last.stage).count();
    (phases - 1, last.report.iterations.len().saturating_sub(1))
}

/// Reads the minimisations of the file at `path`, if it belongs to the job with these `hashes`.
///
/// # Errors
/// See [`PartialError`]; every message names the file.
pub fn read(path: &Path, hashes: &BTreeMap<String, String>) -> Result<Vec<Entry>, PartialError> {
    let bytes = read_regular(path).map_err(|source| PartialError::Io { path: path.to_owned(), source })?;
    parse(&bytes, path, hashes)
}

fn parse(bytes: &[u8], path: &Path, hashes: &BTreeMap<String, String>) -> Result<Vec<Entry>, PartialError> {
    let json = |source| PartialError::Json { path: path.to_owned(), source };
    let unfit = |what| PartialError::Unfit { path: path.to_owned(), what };
    // The version first: another version's keys are no errors of this one's.
    let head: Head = serde_json::from_slice(bytes).map_err(json)?;
    if head.version != VERSION {
        return Err(unfit(format!(
            "version {} of the format; this program reads version {VERSION}",
            head.version
        )));
    }
    if head.program != PROGRAM {
        return Err(unfit(format!("written by {:?}, this is {PROGRAM}", head.program)));
    }
    let file: FileText = serde_json::from_slice(bytes).map_err(json)?;
    if file.converged || file.units != "mm" {
        return Err(unfit("not an interrupted design in millimetres".to_owned()));
    }
    if let Some((name, _)) = hashes.iter().find(|(name, hash)| file.hashes.get(*name) != Some(*hash)) {
        return Err(unfit(format!("the {name} has changed since")));
    }
    let count = file.minimisations.len();
    let entry = |(i, text): (usize, MinimisationText)| {
        text.entry(i + 1 == count).map_err(|what| unfit(format!("minimisation {i} {what}")))
    };
    file.minimisations.into_iter().enumerate().map(entry).collect()
}

#[derive(Deserialize)]
struct Head {
    version: u64,
    program: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileText {
    #[serde(rename = "version")]
    _version: IgnoredAny,
    converged: bool,
    #[serde(rename = "program")]
    _program: IgnoredAny,
    units: String,
    #[serde(rename = "stage")]
    _stage: IgnoredAny,
    #[serde(rename = "phase")]
    _phase: IgnoredAny,
    #[serde(rename = "iteration")]
    _iteration: IgnoredAny,
    hashes: BTreeMap<String, String>,
    #[serde(rename = "pieces")]
    _pieces: IgnoredAny,
    minimisations: Vec<MinimisationText>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MinimisationText {
    stage: String,
    stopped: String,
    next_damping: f64,
    terms: Vec<String>,
    iterations: Vec<IterationRow>,
    unknowns: Vec<Vec<f64>>,
}

impl MinimisationText {
    /// The entry; the error says what is wrong with it. Only the last one may be interrupted.
    fn entry(self, last: bool) -> Result<Entry, String> {
        let reason = |termination: &Termination| termination.reason() == self.stopped;
        let Some(termination) = Termination::ALL.into_iter().find(reason) else {
            return Err(format!("stopped for an unknown reason, {:?}", self.stopped));
        };
        let unknowns: Vec<f64> = self.unknowns.into_iter().flatten().collect();
        if termination == Termination::Interrupted && !last {
            return Err("is interrupted, but others follow".to_owned());
        }
        if self.iterations.is_empty() || (last && unknowns.is_empty()) {
            return Err("has no iterations or no unknowns".to_owned());
        }
        let terms = self.terms.len();
        if let Some(row) = self.iterations.iter().find(|row| row.energies.len() != terms) {
            return Err(format!("has {} energies for {terms} terms", row.energies.len()));
        }
        let iterations = self
            .iterations
            .into_iter()
            .map(|row| Iteration { energies: row.energies, damping: row.damping })
            .collect();
        let report = Report { terms: self.terms, iterations, next_damping: self.next_damping, termination };
        Ok(Entry { stage: self.stage, report, unknowns })
    }
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct IterationRow {
    energies: Vec<f64>,
    damping: f64,
}

impl IterationRow {
    fn new(iteration: &Iteration) -> Self {
        Self { energies: iteration.energies.clone(), damping: iteration.damping }
    }
}

#[derive(Serialize)]
struct PieceRow {
    closed: Vec<[f64; 3]>,
    open: Vec<[f64; 3]>,
}

impl PieceRow {
    fn new(piece: &Piece) -> Self {
        let [closed, open] =
            [&piece.closed, &piece.open].map(|points| points.iter().map(|&p| p.into()).collect());
        Self { closed, open }
    }
}

#[cfg(test)]
mod tests;
