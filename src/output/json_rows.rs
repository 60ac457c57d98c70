//! JSON for people and programs: long lists with one row per line.

use std::io::{self, Write};

use serde::Serialize;

/// Writes `"key": [`, then one row per line, two spaces deeper than `indent`, then `]`; no comma or line end follows.
pub(super) fn write_rows<T: Serialize>(
    out: &mut impl Write,
    indent: &str,
    key: &str,
    rows: impl Iterator<Item = T>,
) -> io::Result<()> {
    write!(out, "{indent}\"{key}\": [")?;
    let mut empty = true;
    for row in rows {
        write!(out, "{}\n{indent}  ", if empty { "" } else { "," })?;
        serde_json::to_writer(&mut *out, &row)?;
        empty = false;
    }
    if empty { write!(out, "]") } else { write!(out, "\n{indent}]") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(rows: &[[f64; 2]]) -> String {
        let mut bytes = Vec::new();
        write_rows(&mut bytes, "  ", "rows", rows.iter()).unwrap();
        String::from_utf8(bytes).unwrap()
    }

    #[test]
    fn one_row_a_line() {
        assert_eq!(
            text(&[[0.5, -1e-20], [3.0, 4.0]]),
            "  \"rows\": [\n    [0.5,-1e-20],\n    [3.0,4.0]\n  ]"
        );
        assert_eq!(text(&[]), "  \"rows\": []");
    }
}
