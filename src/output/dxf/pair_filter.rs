//! Mends the dxf crate's output on its way: a DXF is a sequence of pairs of lines, a group code and a value.
//!
//! - R2000: the crate writes table heads without a handle, and AutoCAD then refuses the drawing. Each
//!   `0 TABLE / 2 NAME` gets `5 handle / 330 0`.
//! - R12: the crate writes subclass markers (group 100), which R12 does not know. They are dropped.
//! - Both: dates come from the clock and the time zone, identifiers from chance. They are replaced.

use std::io::{self, Write};

use super::DxfVersion;

/// Header variables that differ from run to run, and what is written for them. The date is 2000-01-01, noon, as
/// a Julian day.
const FIXED: [(&str, &str); 6] = [
    ("$TDCREATE", "2451545.0"),
    ("$TDUCREATE", "2451545.0"),
    ("$TDUPDATE", "2451545.0"),
    ("$TDUUPDATE", "2451545.0"),
    ("$FINGERPRINTGUID", "00000000-0000-0000-0000-000000000000"),
    ("$VERSIONGUID", "00000000-0000-0000-0000-000000000000"),
];

/// What the pair before asks of the next one.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Pending {
    Nothing,
    /// The name of a table follows.
    TableName,
    /// The value of a header variable follows and is replaced.
    Replace(&'static str),
}

/// A writer that passes DXF text on, pair by pair, mended.
pub(super) struct PairFilter<W: Write> {
    out: W,
    version: DxfVersion,
    next_handle: u64,
    /// Bytes since the last line end: the crate writes lines in pieces.
    line: Vec<u8>,
    /// The group code line whose value has not come yet.
    code: Option<String>,
    pending: Pending,
}

impl<W: Write> PairFilter<W> {
    /// A filter that gives table heads the handles from `first_handle` on.
    pub fn new(out: W, version: DxfVersion, first_handle: u64) -> Self {
        let (line, code) = (Vec::new(), None);
        Self { out, version, next_handle: first_handle, line, code, pending: Pending::Nothing }
    }

    /// Ends the output.
    ///
    /// # Errors
    /// If the last line or pair is not complete, or `out` fails.
    pub fn finish(mut self) -> io::Result<()> {
        if !self.line.is_empty() || self.code.is_some() {
            return Err(io::Error::new(io::ErrorKind::UnexpectedEof, "the DXF ends inside a pair"));
        }
        self.out.flush()
    }

    fn end_line(&mut self) -> io::Result<()> {
        let line = String::from_utf8(std::mem::take(&mut self.line))
            .map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error))?;
        let line = line.trim_end_matches('\r').to_string();
        match self.code.take() {
            None => self.code = Some(line),
            Some(code) => self.end_pair(&code, &line)?,
        }
        Ok(())
    }

    fn end_pair(&mut self, code: &str, value: &str) -> io::Result<()> {
        let group = code.trim();
        if group == "100" && self.version == DxfVersion::R12 {
            return Ok(());
        }
        let pending = std::mem::replace(&mut self.pending, Pending::Nothing);
        let value = if let Pending::Replace(fixed) = pending { fixed } else { value };
        write!(self.out, "{code}\r\n{value}\r\n")?;
        match (group, value) {
            ("0", "TABLE") => self.pending = Pending::TableName,
            ("9", name) => {
                if let Some((_, fixed)) = FIXED.iter().find(|(variable, _)| *variable == name) {
                    self.pending = Pending::Replace(fixed);
                }
            }
            ("2", _) if pending == Pending::TableName && self.version == DxfVersion::R2000 => {
                write!(self.out, "  5\r\n{:X}\r\n330\r\n0\r\n", self.next_handle)?;
                self.next_handle += 1;
            }
            _ => {}
        }
        Ok(())
    }
}

impl<W: Write> Write for PairFilter<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        for &byte in bytes {
            if byte == b'\n' {
                self.end_line()?;
            } else {
                self.line.push(byte);
            }
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Runs text through the filter in pieces of `piece` bytes.
    fn filtered(text: &str, version: DxfVersion, piece: usize) -> io::Result<String> {
        let mut out = Vec::new();
        let mut filter = PairFilter::new(&mut out, version, 0x1f);
        for bytes in text.as_bytes().chunks(piece) {
            filter.write_all(bytes)?;
        }
        filter.finish()?;
        Ok(String::from_utf8(out).unwrap())
    }

    const TABLES: &str =
        "  0\r\nTABLE\r\n  2\r\nLAYER\r\n100\r\nAcDbSymbolTable\r\n  0\r\nTABLE\r\n  2\r\nVPORT\r\n";

    #[test]
    fn table_heads_get_handles_in_r2000_whatever_the_pieces() {
        let expected = "  0\r\nTABLE\r\n  2\r\nLAYER\r\n  5\r\n1F\r\n330\r\n0\r\n100\r\nAcDbSymbolTable\r\n  0\r\nTABLE\r\n  2\r\nVPORT\r\n  5\r\n20\r\n330\r\n0\r\n";
        for piece in [1, 2, 3, 7, 1000] {
            assert_eq!(filtered(TABLES, DxfVersion::R2000, piece).unwrap(), expected);
        }
    }

    #[test]
    fn r12_loses_subclass_markers_and_nothing_else() {
        let expected = "  0\r\nTABLE\r\n  2\r\nLAYER\r\n  0\r\nTABLE\r\n  2\r\nVPORT\r\n";
        assert_eq!(filtered(TABLES, DxfVersion::R12, 5).unwrap(), expected);
    }

    #[test]
    fn dates_and_identifiers_are_fixed() {
        let text = "  9\r\n$TDCREATE\r\n 40\r\n2461000.123\r\n  9\r\n$VERSIONGUID\r\n  2\r\nabc\r\n  9\r\n$TDINDWG\r\n 40\r\n0.5\r\n";
        let expected = "  9\r\n$TDCREATE\r\n 40\r\n2451545.0\r\n  9\r\n$VERSIONGUID\r\n  2\r\n00000000-0000-0000-0000-000000000000\r\n  9\r\n$TDINDWG\r\n 40\r\n0.5\r\n";
        assert_eq!(filtered(text, DxfVersion::R2000, 4).unwrap(), expected);
    }

    #[test]
    fn half_a_pair_is_an_error() {
        assert!(filtered("  0\r\n", DxfVersion::R2000, 9).is_err());
        assert!(filtered("  0\r\nEO", DxfVersion::R2000, 9).is_err());
    }
}
