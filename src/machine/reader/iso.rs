//! LinuxCNC, Fanuc and Haas: letters with numbers.

use nalgebra::Vector3;

use super::controller::{Controller, FeedMode, Target};
use super::{Motion, ReadError, each_line, error, number};
use crate::machine::profile::{Dialect, Machine};

pub(super) fn read(text: &str, machine: &Machine) -> Result<Vec<Motion>, ReadError> {
    let mut reader = Reader { controller: Controller::new(machine), output: None };
    each_line(text, |line, content| reader.line(line, content))?;
    if !reader.controller.ended {
        return Err(error(text.lines().count(), "", "the program does not end with M2 or M30".into()));
    }
    Ok(reader.controller.motions)
}

struct Reader<'a> {
    controller: Controller<'a>,
    /// The analog output that was set last, until `M66` takes it over.
    output: Option<(f64, f64)>,
}

/// The words of one line.
#[derive(Default)]
struct Line {
    words: Vec<(char, f64)>,
}

impl Line {
    fn take(&mut self, letter: char) -> Option<f64> {
        let at = self.words.iter().position(|(name, _)| *name == letter)?;
        Some(self.words.remove(at).1)
    }

    fn needs(&mut self, letter: char) -> Result<f64, String> {
        self.take(letter).ok_or_else(|| format!("{letter} is missing"))
    }
}

/// Words of a line without its comments.
fn words(content: &str) -> Result<Line, String> {
    let mut line = Line::default();
    let mut rest = content.trim();
    while let Some(letter) = rest.chars().next() {
        if letter == '(' {
            let end = rest.find(')').ok_or("the comment does not end")?;
            rest = rest[end + 1..].trim_start();
            continue;
        }
        if !letter.is_ascii_alphabetic() {
            return Err(format!("'{letter}' is no word"));
        }
        let tail = rest[1..].trim_start();
        let end = tail.find(|c: char| !(c.is_ascii_digit() || matches!(c, '.' | '-' | '+')));
        let (digits, tail) = tail.split_at(end.unwrap_or(tail.len()));
        line.words.push((letter.to_ascii_uppercase(), number(digits)?));
        rest = tail.trim_start();
    }
    Ok(line)
}

impl Reader<'_> {
    fn line(&mut self, line: usize, content: &str) -> Result<(), String> {
        let fanuc = self.controller.machine.dialect != Dialect::LinuxCnc;
        if content.trim().is_empty() || (fanuc && content.trim() == "%") {
            return Ok(());
        }
        let mut words = words(content)?;
        words.take('N');
        if fanuc {
            words.take('O');
        }
        if !words.words.is_empty() && self.controller.ended {
            return Err("a line after the program's end".into());
        }
        if let Some(speed) = words.take('S') {
            self.controller.speed = speed;
        }
        words.take('T');
        let feed = words.take('F');
        self.controller.feed = feed.or(self.controller.feed);
        let mut machine = false;
        while let Some(code) = words.take('G') {
            // Codes have at most one decimal.
            let tenths = (code * 10.0).round();
            if (tenths - code * 10.0).abs() > 1e-6 {
                return Err(format!("G{code} is not known"));
            }
            machine |= tenths as i64 == 530;
            self.preparatory(tenths as i64, &mut words)?;
        }
        while let Some(code) = words.take('M') {
            self.auxiliary(code, &mut words)?;
        }
        let target = self.target(&mut words, machine)?;
        if let Some((letter, value)) = words.words.first() {
            return Err(format!("{letter}{value} is not known here"));
        }
        let Some(target) = target else { return Ok(()) };
        let inverse = self.controller.feed_mode == FeedMode::InverseTime;
        if inverse && self.controller.rapid == Some(false) && feed.is_none() {
            return Err("inverse time without its own F".into());
        }
        self.controller.go(line, target)
    }

    fn preparatory(&mut self, tenths: i64, words: &mut Line) -> Result<(), String> {
        let dialect = self.controller.machine.dialect;
        match tenths {
            0 => self.controller.rapid = Some(true),
            10 => self.controller.rapid = Some(false),
            40 => {
                words.take('P').or_else(|| words.take('X')).ok_or("a dwell without its time")?;
            }
            200 => self.controller.unit = 25.4,
            210 => self.controller.unit = 1.0,
            170 | 400 | 530 | 540..=590 | 800 | 900 => {}
            640 => {
                words.take('P');
                words.take('Q');
            }
            930 => self.controller.feed_mode = FeedMode::InverseTime,
            940 => self.controller.feed_mode = FeedMode::PerMinute,
            490 => {
                self.controller.hold_tip(false)?;
                self.controller.length = false;
            }
            430 => self.length(words)?,
            434 if dialect == Dialect::FanucAngles => self.length_and_tip(words)?,
            435 if dialect == Dialect::FanucVectors => {
                if words.needs('Q')? != 0.0 {
                    return Err("a tool leant against its vector".into());
                }
                self.length_and_tip(words)?;
            }
            2340 if dialect == Dialect::Haas => self.length_and_tip(words)?,
            _ => return Err(format!("G{} is not known", tenths as f64 / 10.0)),
        }
        Ok(())
    }

    fn length(&mut self, words: &mut Line) -> Result<(), String> {
        let register = words.needs('H')?;
        let tool = self.controller.machine.setup.tool_number;
        if register != f64::from(tool) {
            return Err(format!("H{register} is not the length of tool {tool}"));
        }
        self.controller.length = true;
        Ok(())
    }

    fn length_and_tip(&mut self, words: &mut Line) -> Result<(), String> {
        self.length(words)?;
        self.controller.hold_tip(true)
    }

    fn auxiliary(&mut self, code: f64, words: &mut Line) -> Result<(), String> {
        let linuxcnc = self.controller.machine.dialect == Dialect::LinuxCnc;
        match code as u32 {
            68 if linuxcnc => self.output = Some((words.needs('E')?, words.needs('Q')?)),
            66 if linuxcnc => {
                words.needs('E')?;
                words.needs('L')?;
                let (output, value) = self.output.take().ok_or("M66 without M68 before it")?;
                let [pin, on, off] = self.controller.machine.output.switch.map(f64::from);
                if output != pin || (value != on && value != off) {
                    return Err(format!("E{output} Q{value} switches nothing on this machine"));
                }
                self.controller.hold_tip(value == on)?;
            }
            common if f64::from(common) == code && self.controller.auxiliary(common) => {}
            _ => return Err(format!("M{code} is not known")),
        }
        Ok(())
    }

    /// What the axis words ask for; `None` where there are none.
    fn target(&self, words: &mut Line, machine: bool) -> Result<Option<Target>, String> {
        let mut target = Target { machine, ..Target::default() };
        let before = words.words.len();
        target.xyz = ['X', 'Y', 'Z'].map(|letter| words.take(letter));
        target.turns = self.controller.letters().map(|letter| letter.and_then(|letter| words.take(letter)));
        if self.controller.machine.dialect == Dialect::FanucVectors && self.controller.tcp {
            let vector = ['I', 'J', 'K'].map(|letter| words.take(letter));
            if vector.iter().any(Option::is_some) {
                // What is left out is zero.
                let [i, j, k] = vector.map(|part| part.unwrap_or(0.0));
                target.vector = Some(Vector3::new(i, j, k));
            }
            if target.turns.iter().any(Option::is_some) {
                return Err("an angle in a program of vectors".into());
            }
        }
        Ok((words.words.len() < before).then_some(target))
    }
}
