//! From a path to the program's files: order, size, restart points, and what they take.

use super::dialect::{self, Facts};
use super::error::MachineError;
use super::plan::{Move, Stand, check_travel, home_above, link, run_moves};
use super::profile::Machine;
use super::rotary::{self, Station};
use crate::geometry::Point3;
use crate::milling::toolpath::{Contour, Toolpath};

/// What the program says about itself, and what the path does not know.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Header {
    /// The job's name.
    pub job: String,
    /// The material profile.
    pub profile: String,
    /// The tool, in words.
    pub tool: String,
    /// The stock, in words.
    pub stock: String,
    /// Further lines: fixture, workholding.
    pub notes: Vec<String>,
    /// Hash of `design.json`.
    pub hash: String,
    /// Turns of the spindle a minute.
    pub spindle_rpm: f64,
    /// The run to begin with, from 0: a program after a broken tool.
    pub first_run: usize,
}

/// A program in one file or, for small memories, several that are run one after the other.
#[derive(Debug, Clone, PartialEq)]
pub struct Program {
    /// Name and text of each.
    pub files: Vec<(String, String)>,
    /// What it takes.
    pub stats: Stats,
}

/// What a program takes. Times leave out acceleration, the tool change and every override.
#[derive(Debug, Clone, PartialEq)]
pub struct Stats {
    /// Runs.
    pub runs: usize,
    /// Blocks that move an axis.
    pub motions: usize,
    /// Length of the tip's path in runs, millimetres.
    pub cut_length: f64,
    /// Time in runs, seconds.
    pub cut_seconds: f64,
    /// Time from run to run, seconds.
    pub air_seconds: f64,
    /// Retreats within runs.
    pub retreats: usize,
    /// Sum of all turns of the axis that tilts and of the one it carries, radians.
    pub turned: [f64; 2],
    /// Largest turn of an axis in one block of a run, radians.
    pub largest_swing: f64,
    /// Least and largest coordinate of the tip in runs, part's frame.
    pub bounds: [Point3; 2],
    /// Where each run begins.
    pub restarts: Vec<Restart>,
}

/// Where a run begins, and may begin again.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Restart {
    /// The run, from 0: what [`Header::first_run`] takes.
    pub run: usize,
    /// The file, counted in [`Program::files`].
    pub file: usize,
    /// The line in it, from 1.
    pub line: usize,
}

/// A run ready to be written.
struct Section {
    /// Counted in the path.
    run: usize,
    contour: Contour,
    start: Stand,
    moves: Vec<Move>,
}

impl Section {
    fn end(&self) -> Stand {
        self.moves.last().map_or(self.start, |last| last.to)
    }
}

/// The program for a path.
///
/// # Errors
/// What [`MachineError`] says: poses, limits and speeds that the machine does not have.
pub fn post(toolpath: &Toolpath, machine: &Machine, header: &Header) -> Result<Program, MachineError> {
    let [least, largest] = machine.spindle.range;
    if !(least..=largest).contains(&header.spindle_rpm) {
        return Err(MachineError::Spindle { rpm: header.spindle_rpm, range: machine.spindle.range });
    }
    let count = toolpath.runs.len();
    if header.first_run >= count {
        return Err(MachineError::NoRun { first: header.first_run + 1, count });
    }
    let solved = rotary::solve(toolpath, machine)?;
    let (sections, retreats) = sections(toolpath, machine, &solved[header.first_run..], header.first_run)?;
    let mut stats = empty(sections.len(), retreats);
    for section in &sections {
        add_section(&mut stats, section);
    }
    let parts = split(machine, &sections)?;
    for part in &parts {
        let starts = std::iter::once(part.home).chain(part.sections.iter().map(Section::end));
        for (from, moves) in starts.zip(&part.links) {
            add_link(&mut stats, from, moves);
        }
        stats.air_seconds += machine.spindle.start_seconds;
    }
    let mut files = Vec::with_capacity(parts.len());
    let (mut restarts, mut motions) = (Vec::with_capacity(sections.len()), 0);
    for (index, part) in parts.iter().enumerate() {
        let [file, of] = [index, parts.len()];
        let facts = Facts { machine, header, stats: &stats, toolpath, file, files: of, home: part.home };
        let mut writer = dialect::Writer::new(&facts);
        writer.head();
        for (offset, link) in part.links.iter().enumerate() {
            writer.moves(link);
            if let Some(section) = part.sections.get(offset) {
                let line = writer.mark(section.run, count, section.contour);
                restarts.push(Restart { run: section.run, file: index, line });
                writer.moves(&section.moves);
            }
        }
        writer.foot();
        motions += writer.motions();
        let name = match parts.len() {
            1 => format!("mill.{}", dialect::ending(machine.dialect)),
            _ => format!("mill-{:02}.{}", index + 1, dialect::ending(machine.dialect)),
        };
        files.push((name, writer.text()));
    }
    (stats.restarts, stats.motions) = (restarts, motions);
    Ok(Program { files, stats })
}

fn sections(
    toolpath: &Toolpath,
    machine: &Machine,
    solved: &[Vec<Station>],
    first: usize,
) -> Result<(Vec<Section>, usize), MachineError> {
    let mut retreats = 0;
    let mut sections = Vec::with_capacity(solved.len());
    for (run, stations) in (first..).zip(solved) {
        let (moves, more) = run_moves(machine, run, stations)?;
        retreats += more;
        let start = Stand { tip: stations[0].pose.tip, angles: stations[0].arrive };
        sections.push(Section { run, contour: toolpath.runs[run].contour, start, moves });
    }
    Ok((sections, retreats))
}

/// One file: sections, and the links before each and after the last.
struct Part<'a> {
    home: Stand,
    sections: &'a [Section],
    links: Vec<Vec<Move>>,
}

/// Divides the runs among files: as many in each as fit.
fn split<'a>(machine: &Machine, sections: &'a [Section]) -> Result<Vec<Part<'a>>, MachineError> {
    let Some(limit) = machine.output.max_bytes else { return Ok(vec![part(machine, sections)?]) };
    let mut parts = Vec::new();
    let mut rest = sections;
    while !rest.is_empty() {
        let mut size = HEAD_BYTES;
        let mut taken = 0;
        for (index, section) in rest.iter().enumerate() {
            // Link moves are few; a generous share for each keeps the estimate above the truth.
            let bytes = dialect::size(machine, &section.moves) + LINK_BYTES;
            if size + bytes > limit {
                break;
            }
            (size, taken) = (size + bytes, index + 1);
        }
        if taken == 0 {
            let bytes = HEAD_BYTES + LINK_BYTES + dialect::size(machine, &rest[0].moves);
            return Err(MachineError::Memory { run: rest[0].run + 1, bytes, limit });
        }
        parts.push(part(machine, &rest[..taken])?);
        rest = &rest[taken..];
    }
    Ok(parts)
}

/// Bytes set aside for the words before and after all runs, and for the way to a run.
const HEAD_BYTES: usize = 6000;
const LINK_BYTES: usize = 1000;

fn part<'a>(machine: &Machine, sections: &'a [Section]) -> Result<Part<'a>, MachineError> {
    let home = Stand { angles: super::Angles::default(), ..home_above(machine, &sections[0].start) };
    let last = &sections[sections.len() - 1];
    // From the height of tool changes the tool comes down, and goes up to it again.
    for (run, stand) in [(sections[0].run, home), (last.run, home_above(machine, &last.end()))] {
        check_travel(machine, run + 1, &stand, machine.setup.home_z)?;
    }
    let mut links = Vec::with_capacity(sections.len() + 1);
    let mut at = home;
    for section in sections {
        links.push(link(machine, section.run, at, section.start)?);
        at = section.end();
    }
    links.push(link(machine, last.run, at, home_above(machine, &at))?);
    Ok(Part { home, sections, links })
}

fn empty(runs: usize, retreats: usize) -> Stats {
    let [low, high] = [f64::INFINITY, f64::NEG_INFINITY];
    Stats {
        runs,
        motions: 0,
        cut_length: 0.0,
        cut_seconds: 0.0,
        air_seconds: 0.0,
        retreats,
        turned: [0.0; 2],
        largest_swing: 0.0,
        bounds: [Point3::new(low, low, low), Point3::new(high, high, high)],
        restarts: Vec::new(),
    }
}

fn add_section(stats: &mut Stats, section: &Section) {
    let mut at = section.start;
    stats.bounds = [stats.bounds[0].inf(&at.tip), stats.bounds[1].sup(&at.tip)];
    for step in &section.moves {
        let turned = [step.to.angles.tilt - at.angles.tilt, step.to.angles.turn - at.angles.turn];
        for (sum, turn) in stats.turned.iter_mut().zip(turned) {
            *sum += turn.abs();
        }
        if step.cutting {
            stats.cut_length += (step.to.tip - at.tip).norm();
            stats.cut_seconds += step.seconds;
            stats.largest_swing = stats.largest_swing.max(turned[0].abs()).max(turned[1].abs());
            stats.bounds = [stats.bounds[0].inf(&step.to.tip), stats.bounds[1].sup(&step.to.tip)];
        } else {
            stats.air_seconds += step.seconds;
        }
        at = step.to;
    }
}

fn add_link(stats: &mut Stats, from: Stand, moves: &[Move]) {
    let mut at = from.angles;
    for step in moves {
        let to = step.to.angles;
        stats.turned[0] += (to.tilt - at.tilt).abs();
        stats.turned[1] += (to.turn - at.turn).abs();
        stats.air_seconds += step.seconds;
        at = to;
    }
}
