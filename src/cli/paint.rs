//! Colours on a terminal. What is printed goes through `anstream`, which takes them out where nobody wants them: in
//! files and pipes, with `NO_COLOR` set, on dumb terminals; `CLICOLOR_FORCE=1` keeps them.

use anstyle::{AnsiColor, Style};

const BOLD: Style = Style::new().bold();
const RED: Style = AnsiColor::Red.on_default().bold();
const YELLOW: Style = AnsiColor::Yellow.on_default();
const GREEN: Style = AnsiColor::Green.on_default();

/// A heading.
pub fn heading(text: &str) -> String {
    painted(BOLD, text)
}

/// What an error message begins with.
pub fn error(word: &str) -> String {
    painted(RED, word)
}

/// What a warning begins with.
pub fn warning(word: &str) -> String {
    painted(YELLOW, word)
}

/// A table of hinges with its heading and its verdicts in colour.
pub fn hinges(table: &str) -> String {
    let mut lines = table.split_inclusive('\n');
    let heading = lines.next().map(heading_line).unwrap_or_default();
    heading + &lines.map(verdict).collect::<String>()
}

fn heading_line(line: &str) -> String {
    match line.strip_suffix('\n') {
        // Without hinges to list the first line is the summary.
        Some(text) if text.contains("  verdict") => heading(text) + "\n",
        _ => line.to_owned(),
    }
}

/// A line of the table: the first column that is a verdict is painted.
fn verdict(line: &str) -> String {
    let found = [("fail", RED), ("warn", YELLOW), ("ok", GREEN)].into_iter().find_map(|(word, style)| {
        let at = line.find(&format!("  {word}  "))? + 2;
        Some((at, word, style))
    });
    match found {
        Some((at, word, style)) => {
            format!("{}{}{}", &line[..at], painted(style, word), &line[at + word.len()..])
        }
        None => line.to_owned(),
    }
}

fn painted(style: Style, text: &str) -> String {
    format!("{style}{text}{style:#}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_painted_is_the_same_text() {
        let table = "id  verdict  why\n 1  fail     30 %; ok  \n 2  ok       \nno hinge  \n";
        let painted = hinges(table);
        assert_eq!(anstream::adapter::strip_str(&painted).to_string(), table);
        assert!(painted.contains("\u{1b}[1m\u{1b}[31mfail\u{1b}[0m     30 %; ok  \n"), "{painted:?}");
        assert!(painted.contains("\u{1b}[32mok\u{1b}[0m  "), "{painted:?}");
        assert_eq!(hinges("no hinges\n"), "no hinges\n");
    }
}
