//! Heidenhain conversational: numbered lines, `L` with signed coordinates.

use super::controller::{Controller, Target};
use super::{Motion, ReadError, each_line, error, number};
use crate::machine::profile::{Dialect, Machine};

pub(super) fn read(text: &str, machine: &Machine) -> Result<Vec<Motion>, ReadError> {
    let mut reader = Reader { controller: Controller::new(machine), next: 0, closed: false };
    each_line(text, |line, content| reader.line(line, content))?;
    if !reader.controller.ended || !reader.closed {
        let what = "the program does not end with M30 and END PGM";
        return Err(error(text.lines().count(), "", what.into()));
    }
    Ok(reader.controller.motions)
}

struct Reader<'a> {
    controller: Controller<'a>,
    /// Number of the next line.
    next: usize,
    closed: bool,
}

impl Reader<'_> {
    fn line(&mut self, line: usize, content: &str) -> Result<(), String> {
        if content.starts_with(' ') {
            // The end of a cycle that goes over two lines.
            return if content.trim().starts_with("Q339=") { Ok(()) } else { Err("not known".into()) };
        }
        let (head, rest) = content.split_once(' ').ok_or("a line has a number and words")?;
        if head.parse() != Ok(self.next) {
            return Err(format!("the line should have the number {}", self.next));
        }
        self.next += 1;
        if self.closed {
            return Err("a line after the program's end".into());
        }
        let code = rest.split(';').next().unwrap_or_default().trim();
        let words: Vec<&str> = code.split_whitespace().collect();
        let tcpm = self.controller.machine.dialect == Dialect::HeidenhainTcpm;
        match words.as_slice() {
            [] => Ok(()),
            ["BEGIN", "PGM", _, unit] => self.unit(unit),
            ["END", "PGM", ..] => {
                self.closed = true;
                Ok(())
            }
            _ if self.controller.ended => Err("a line after M30".into()),
            ["BLK", "FORM", ..] | ["CYCL", "DEF", "247" | "9.0" | "9.1", ..] => Ok(()),
            ["TOOL", "CALL", number, "Z", speed] => self.tool(number, speed),
            ["FUNCTION", "TCPM", "F", "TCP", "AXIS", "POS", "PATHCTRL", "AXIS"] if tcpm => {
                self.controller.hold_tip(true)
            }
            ["FUNCTION", "RESET", "TCPM"] if tcpm => self.controller.hold_tip(false),
            ["M128"] if !tcpm => self.controller.hold_tip(true),
            ["M129"] if !tcpm => self.controller.hold_tip(false),
            ["M127"] => Ok(()),
            ["L", words @ ..] => self.straight(line, words),
            [word] => self.auxiliary(word),
            _ => Err("not known".into()),
        }
    }

    fn unit(&mut self, unit: &str) -> Result<(), String> {
        self.controller.unit = match unit {
            "MM" => 1.0,
            "INCH" => 25.4,
            _ => return Err(format!("\"{unit}\" is no unit")),
        };
        Ok(())
    }

    fn tool(&mut self, given: &str, speed: &str) -> Result<(), String> {
        let tool = self.controller.machine.setup.tool_number;
        if number(given)? != f64::from(tool) {
            return Err(format!("the machine's tool is {tool}"));
        }
        self.controller.speed = number(speed.strip_prefix('S').ok_or("S is missing")?)?;
        self.controller.length = true;
        Ok(())
    }

    fn straight(&mut self, line: usize, words: &[&str]) -> Result<(), String> {
        let mut target = Target::default();
        let mut rapid = false;
        for word in words {
            let mut characters = word.chars();
            let letter = characters.next().unwrap_or_default();
            let rest = characters.as_str();
            let axis = self.controller.letters().iter().position(|name| *name == Some(letter));
            match (letter, axis) {
                _ if *word == "FMAX" => rapid = true,
                _ if *word == "R0" => {}
                _ if *word == "M91" => target.machine = true,
                ('X' | 'Y' | 'Z', _) => target.xyz[letter as usize - 'X' as usize] = Some(signed(rest)?),
                (_, Some(axis)) => target.turns[axis] = Some(signed(rest)?),
                ('F', _) => self.controller.feed = Some(number(rest)?),
                _ => return Err(format!("\"{word}\" is not known here")),
            }
        }
        self.controller.rapid = Some(rapid);
        self.controller.go(line, target)
    }

    fn auxiliary(&mut self, word: &str) -> Result<(), String> {
        let code = word.strip_prefix('M').and_then(|code| code.parse().ok());
        match code {
            Some(code) if code != 6 && self.controller.auxiliary(code) => Ok(()),
            _ => Err(format!("\"{word}\" is not known here")),
        }
    }
}

/// A coordinate, with its sign.
fn signed(text: &str) -> Result<f64, String> {
    if !text.starts_with(['+', '-']) {
        return Err(format!("\"{text}\" has no sign"));
    }
    number(text)
}
