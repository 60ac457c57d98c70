//! The words of each controller. What to do was decided before; here it is only written down.
//!
//! Lengths and angles have a fixed number of digits, zeros at the end cut off but for one; no exponent, no
//! negative zero. Words that do not change are left out, except at the beginning of a run. No line reaches
//! 250 characters. Comments hold letters, digits and a few signs, so that no name of a user's can become a
//! word.

mod comments;
mod fanuc;
mod haas;
mod heidenhain;
mod iso;
mod linuxcnc;
mod siemens;

use super::kinematics::Angles;
use super::plan::{Move, Stand};
use super::profile::{Dialect, Machine};
use super::program::{Header, Stats};
use crate::milling::toolpath::{Contour, Toolpath};

/// What a program's head tells.
pub(super) struct Facts<'a> {
    pub machine: &'a Machine,
    pub header: &'a Header,
    pub stats: &'a Stats,
    pub toolpath: &'a Toolpath,
    /// Which of how many files, from 0.
    pub file: usize,
    pub files: usize,
    /// Where the tool comes down before the first run, angles zero.
    pub home: Stand,
}

/// One line that moves an axis: only the words that change.
struct Block {
    rapid: bool,
    xyz: Vec<(char, String)>,
    /// Angles, or the components of a vector.
    turns: Vec<(&'static str, String)>,
    feed: Option<String>,
}

/// A controller's language.
trait Words {
    /// A line that the controller does not act on.
    fn comment(&self, text: &str) -> String;
    /// From the first line to the tool above the first run, the spindle turning, the tip held.
    fn head(&self, facts: &Facts, comments: Vec<String>) -> Vec<String>;
    /// The line before a run.
    fn mark(&self, run: usize, text: &str) -> String;
    /// A line that moves.
    fn block(&self, block: &Block) -> String;
    /// From the tool above the last run, angles at whole turns, to the last line.
    fn foot(&self, facts: &Facts) -> Vec<String>;
    /// Digits of a feed.
    fn feed_decimals(&self) -> usize {
        3
    }
    /// Whether each line begins with its number.
    fn numbers_lines(&self) -> bool {
        false
    }
}

fn words(machine: &Machine) -> Box<dyn Words> {
    let vectors = machine.dialect.writes_vectors();
    match machine.dialect {
        Dialect::LinuxCnc => Box::new(linuxcnc::LinuxCnc),
        Dialect::FanucAngles | Dialect::FanucVectors => Box::new(fanuc::Fanuc { vectors }),
        Dialect::Haas => Box::new(haas::Haas),
        Dialect::SiemensAngles | Dialect::SiemensVectors => Box::new(siemens::Siemens { vectors }),
        Dialect::HeidenhainTcpm => Box::new(heidenhain::Heidenhain { m128: false }),
        Dialect::HeidenhainM128 => Box::new(heidenhain::Heidenhain { m128: true }),
    }
}

/// How a program's file name ends.
pub(super) fn ending(dialect: Dialect) -> &'static str {
    match dialect {
        Dialect::LinuxCnc => "ngc",
        Dialect::FanucAngles | Dialect::FanucVectors | Dialect::Haas => "nc",
        Dialect::HeidenhainTcpm | Dialect::HeidenhainM128 => "h",
        Dialect::SiemensAngles | Dialect::SiemensVectors => "mpf",
    }
}

/// Bytes that moves take, written from a fresh start.
pub(super) fn size(machine: &Machine, moves: &[Move]) -> usize {
    let words = words(machine);
    let mut modal = Modal::default();
    let number = if words.numbers_lines() { 8 } else { 0 };
    let lines = moves.iter().filter_map(|step| modal.block(machine, words.as_ref(), step));
    lines.map(|block| words.block(&block).len() + 1 + number).sum()
}

/// What the controller remembers from line to line.
#[derive(Default)]
struct Modal {
    /// Whether the next block says everything again.
    fresh: bool,
    xyz: [String; 3],
    turns: Vec<String>,
    feed: String,
    angles: Angles,
}

impl Modal {
    /// The words of a move that are new; `None` where the numbers as written move nothing.
    fn block(&mut self, machine: &Machine, words: &dyn Words, step: &Move) -> Option<Block> {
        let xyz = lengths(machine, &step.to);
        let turns = turns(machine, &step.to);
        let moves_tip = xyz != self.xyz;
        let vector_changes = turns.iter().map(|(_, value)| value).ne(self.turns.iter());
        if !moves_tip && !vector_changes {
            return None;
        }
        let changed = |i: usize| self.fresh || self.xyz[i] != xyz[i];
        let mut block = Block { rapid: step.rapid, xyz: Vec::new(), turns: Vec::new(), feed: None };
        block.xyz.extend((0..3).filter(|&i| changed(i)).map(|i| (['X', 'Y', 'Z'][i], xyz[i].clone())));
        for (i, (word, value)) in turns.iter().enumerate() {
            // A vector has all its components: what is left out is zero.
            let whole = machine.dialect.writes_vectors();
            if self.fresh || whole || self.turns.get(i) != Some(value) {
                block.turns.push((*word, value.clone()));
            }
        }
        let feed = feed(machine, words, step, moves_tip, self.angles);
        // In inverse time every block has its own; after a rapid block feed is said again.
        if !step.rapid && (feed != self.feed || inverse_time(machine)) {
            block.feed = Some(feed.clone());
        }
        self.feed = if step.rapid { String::new() } else { feed };
        self.fresh = false;
        self.xyz = xyz;
        self.turns = turns.into_iter().map(|(_, value)| value).collect();
        self.angles = step.to.angles;
        Some(block)
    }
}

/// Whether feeds are one over the block's minutes: in joint coordinates no speed is the tip's.
fn inverse_time(machine: &Machine) -> bool {
    machine.rotary.is_some() && !machine.tcp
}

/// The program's coordinates: on the table with the tip held, else of the joints, both from the program's
/// zero.
fn lengths(machine: &Machine, at: &Stand) -> [String; 3] {
    let place = if inverse_time(machine) {
        machine.joints(&at.tip, at.angles) - machine.setup.zero
    } else {
        machine.setup.fixture * at.tip.coords
    };
    [0, 1, 2].map(|i| number(place[i], machine.output.decimals))
}

fn turns(machine: &Machine, at: &Stand) -> Vec<(&'static str, String)> {
    let Some(rotary) = &machine.rotary else { return Vec::new() };
    let decimals = machine.output.angle_decimals;
    if machine.dialect.writes_vectors() {
        let axis = rotary.axis(at.angles);
        let names =
            if machine.dialect == Dialect::FanucVectors { ["I", "J", "K"] } else { ["A3", "B3", "C3"] };
        return (0..3).map(|i| (names[i], number(axis[i], decimals))).collect();
    }
    let names = rotary.table.letters().map(letter);
    let angles = [at.angles.tilt, at.angles.turn];
    (0..2).map(|i| (names[i], number(angles[i].to_degrees(), decimals))).collect()
}

fn letter(axis: char) -> &'static str {
    match axis {
        'A' => "A",
        'B' => "B",
        _ => "C",
    }
}

fn feed(machine: &Machine, words: &dyn Words, step: &Move, moves_tip: bool, before: Angles) -> String {
    let positive = |value: f64, decimals: usize| number(value.max(10f64.powi(-(decimals as i32))), decimals);
    let decimals = words.feed_decimals();
    if inverse_time(machine) {
        // A block shorter than 6 us takes that long.
        return positive(60.0 / step.seconds.max(6e-6), 4);
    }
    if moves_tip {
        return positive(step.feed, decimals);
    }
    // Where the tip stays, controllers take the feed for degrees a minute.
    let [tilt, turn] = [step.to.angles.tilt - before.tilt, step.to.angles.turn - before.turn];
    positive(tilt.hypot(turn).to_degrees() * 60.0 / step.seconds.max(1e-6), decimals)
}

/// A number without exponent or negative zero, at least one digit after the point.
fn number(value: f64, decimals: usize) -> String {
    let mut text = format!("{value:.decimals$}");
    let whole = text.find('.').map_or(text.len(), |point| point + 2);
    while text.len() > whole && text.ends_with('0') {
        text.pop();
    }
    if text.starts_with('-') && text.chars().all(|digit| matches!(digit, '-' | '0' | '.')) {
        text.remove(0);
    }
    text
}

/// Writes one program.
pub(super) struct Writer<'a> {
    facts: &'a Facts<'a>,
    words: Box<dyn Words>,
    modal: Modal,
    lines: Vec<String>,
    motions: usize,
}

impl<'a> Writer<'a> {
    pub fn new(facts: &'a Facts<'a>) -> Self {
        let words = words(facts.machine);
        Self { facts, words, modal: Modal::default(), lines: Vec::new(), motions: 0 }
    }

    pub fn head(&mut self) {
        let comments = comments::head(self.facts);
        let comments = comments.iter().map(|text| self.words.comment(text)).collect();
        self.lines = self.words.head(self.facts, comments);
        let (machine, home) = (self.facts.machine, &self.facts.home);
        let turns = turns(machine, home).into_iter().map(|(_, value)| value).collect();
        self.modal = Modal { xyz: lengths(machine, home), turns, angles: home.angles, ..Modal::default() };
        // Coordinates have another meaning since the head's last line: the first block says all of them.
        self.modal.fresh = true;
    }

    /// The line before a run; its number, from 1.
    pub fn mark(&mut self, run: usize, count: usize, contour: Contour) -> usize {
        let what = if contour == Contour::Border { "border" } else { "opening" };
        let text = format!("run {} of {count}, {what}", run + 1);
        self.lines.push(self.words.mark(run + 1, &text));
        // The first block of a run has all words.
        self.modal.fresh = true;
        self.modal.feed.clear();
        self.lines.len()
    }

    pub fn moves(&mut self, moves: &[Move]) {
        for step in moves {
            if let Some(block) = self.modal.block(self.facts.machine, self.words.as_ref(), step) {
                self.lines.push(self.words.block(&block));
                self.motions += 1;
            }
        }
    }

    pub fn foot(&mut self) {
        self.lines.extend(self.words.foot(self.facts));
    }

    /// Blocks that move an axis, but for head and foot.
    pub fn motions(&self) -> usize {
        self.motions
    }

    pub fn text(self) -> String {
        let numbered = self.words.numbers_lines();
        let mut text = String::new();
        let mut number = 0;
        for line in &self.lines {
            debug_assert!(line.len() < 250 && line.is_ascii());
            // An indented line goes on with the one before.
            if numbered && !line.starts_with(' ') {
                text.push_str(&format!("{number} "));
                number += 1;
            }
            text.push_str(line);
            text.push('\n');
        }
        text
    }
}

#[cfg(test)]
mod tests;
