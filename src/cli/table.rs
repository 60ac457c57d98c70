//! Tables on the terminal.

use super::paint;

/// Lines of cells under their headings, columns aligned to the left, two spaces apart.
pub fn table<const N: usize>(headings: [&str; N], rows: &[[String; N]]) -> String {
    let width = |i: usize| {
        let cells = rows.iter().map(|row| row[i].chars().count());
        cells.chain([headings[i].chars().count()]).max().unwrap_or(0)
    };
    let widths: [usize; N] = std::array::from_fn(width);
    let line = |cells: [&str; N]| {
        let padded = cells.iter().zip(widths).map(|(cell, width)| format!("{cell:<width$}"));
        padded.collect::<Vec<_>>().join("  ").trim_end().to_owned() + "\n"
    };
    let mut text = paint::heading(line(headings).trim_end()) + "\n";
    text.extend(rows.iter().map(|row| line(row.each_ref().map(String::as_str))));
    text
}

/// Labels and values, indented, the values in one column.
pub fn labelled<L: AsRef<str>>(rows: &[(L, String)]) -> String {
    let width = rows.iter().map(|(label, _)| label.as_ref().len()).max().unwrap_or(0);
    rows.iter().map(|(label, value)| format!("  {:<width$}  {value}\n", label.as_ref())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_as_wide_as_their_widest_cell() {
        let rows =
            [["a".to_owned(), "øøøø".to_owned(), String::new()], ["abc".into(), "b".into(), "c".into()]];
        let text = table(["x", "yy", "z"], &rows);
        assert_eq!(
            anstream::adapter::strip_str(&text).to_string(),
            "x    yy    z\na    øøøø\nabc  b     c\n"
        );
    }
}
