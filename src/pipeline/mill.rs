//! From a checked sheet to a verified milling program: path, program, and the program read back and milled on paper.

use kurbo::Vec2;
use nalgebra::Vector3;

use crate::fabrication::fabricate::Fabrication;
use crate::geometry::mesh::TriMesh;
use crate::machine::{self, Header, Machine, MachineError, Motion, Program, pose_at};
use crate::milling::error::MillingError;
use crate::milling::path::{Planned, Work, path};
use crate::milling::sweep::finding::{Finding, Trouble};
use crate::milling::sweep::{Figures, Move, Neck, Wanted, inspect};
use crate::milling::toolpath::{Pose, Rate};
use crate::profile::{Profile, Tool};
use crate::solid::Walls;
use crate::solid::loft::joined;
use crate::solid::strokes::Strokes;

/// Turns of a rotary axis beyond this within a move, radians, are looked at step by step: a turn too many is seen as the cut
/// that it makes. Below it a program's moves were divided so that the axis turns evenly.
const LOOK: f64 = 0.6;

/// Rounding of angles, radians.
const SWING_PLAY: f64 = 1e-5;

/// How the walls of a sheet stand.
pub fn walls(profile: &Profile) -> Walls {
    if profile.cut.ruled { Walls::Ruled } else { Walls::Vertical }
}

/// A verified program.
#[derive(Debug, Clone, PartialEq)]
pub struct Milled {
    /// The path and its tabs.
    pub planned: Planned,
    /// The tool, with the job's tabs.
    pub tool: Tool,
    /// The program's files, and what they take.
    pub program: Program,
    /// What the program leaves, as it was read back.
    pub figures: Figures,
}

/// Why there is no program.
#[derive(Debug, thiserror::Error)]
pub enum MillError {
    /// No path.
    #[error(transparent)]
    Path(#[from] MillingError),
    /// The machine cannot take it.
    #[error(transparent)]
    Machine(#[from] MachineError),
    /// The reader refuses it.
    #[error("{0}: the program cannot be read back: {1}")]
    Read(String, machine::ReadError),
    /// It leaves something else than the part.
    #[error("the program is not written, for what it leaves is not the part:\n{}", told(.0))]
    Unsafe(Vec<Finding>),
}

/// How many findings are told.
const TOLD: usize = 12;

fn told(findings: &[Finding]) -> String {
    let mut lines: Vec<String> = findings.iter().take(TOLD).map(|finding| format!("  {finding}")).collect();
    if findings.len() > TOLD {
        lines.push(format!("  and {} more", findings.len() - TOLD));
    }
    lines.join("\n")
}

/// What is milled.
#[derive(Debug, Clone, Copy)]
pub struct Order<'a> {
    /// The sheet, laid out.
    pub sheet: &'a Fabrication,
    /// The finished part.
    pub part: &'a TriMesh,
    /// The profile that it was laid out for.
    pub profile: &'a Profile,
    /// Its tool, with the job's tabs.
    pub tool: &'a Tool,
    /// Where each copy lies, from the sheet's own coordinates.
    pub copies: &'a [Vec2],
    /// What takes the program.
    pub machine: &'a Machine,
}

/// Makes the program of a sheet and holds it against the finished part.
///
/// # Errors
/// No path, nothing that the machine can do, or a program that leaves something else than the part.
pub fn mill(order: &Order, header: &Header) -> Result<Milled, MillError> {
    let Order { sheet, part, profile, tool, copies, machine } = *order;
    let planned = plan(sheet, profile, tool, machine)?.copied(copies);
    let program = machine::post(&planned.path, machine, header)?;
    let necks: Vec<Neck> =
        sheet.hinges.iter().map(|row| Neck::new(row, walls(profile) == Walls::Vertical)).collect();
    let wanted = Wanted {
        part: &copied(part, copies),
        copies: copies.len(),
        necks: &necks.iter().flat_map(|neck| copies.iter().map(|by| neck.moved(*by))).collect::<Vec<_>>(),
        stock: sheet.layout.sheet,
        thickness: profile.sheet.thickness,
        radius: 0.5 * profile.cut.kerf,
        tool,
        tabs: &planned.tabs,
    };
    let (figures, findings) = measure(&program.files, header.first_run, machine, &wanted)?;
    if !findings.is_empty() {
        return Err(MillError::Unsafe(findings));
    }
    Ok(Milled { planned, tool: *tool, program, figures })
}

/// A part as often as it is made.
pub fn copied(part: &TriMesh, copies: &[Vec2]) -> TriMesh {
    joined(copies.iter().map(|by| {
        let mut copy = part.clone();
        copy.vertices.iter_mut().for_each(|vertex| *vertex += Vector3::new(by.x, by.y, 0.0));
        copy
    }))
}

/// The path of a sheet's tool on a machine.
fn plan(
    sheet: &Fabrication,
    profile: &Profile,
    tool: &Tool,
    machine: &Machine,
) -> Result<Planned, MillingError> {
    let mut strokes = Strokes::new(&sheet.layout.paths, &sheet.hinges, 0.5 * profile.cut.kerf);
    if walls(profile) == Walls::Vertical {
        strokes.upright();
    }
    let work = Work { strokes: &strokes, hinges: &sheet.hinges, tool, thickness: profile.sheet.thickness };
    path(&work, &|a, b| air(machine, a, b))
}

/// Time from above one place to above another, minutes: the slowest axis, by the shorter of both branches.
fn air(machine: &Machine, a: &Pose, b: &Pose) -> f64 {
    let linear = (b.tip - a.tip).norm() / machine.rapid;
    let Some(rotary) = &machine.rotary else { return linear };
    let angles = |axis: &Vector3<f64>| rotary.branches(&(machine.setup.fixture * axis));
    let turn = |a: f64, b: f64| {
        let way = (b - a).rem_euclid(std::f64::consts::TAU);
        way.min(std::f64::consts::TAU - way)
    };
    let upright =
        |pose: &Pose| rotary.is_upright(&(machine.setup.fixture * pose.axis.as_ref()), rotary.upright);
    let mut least = f64::INFINITY;
    for from in angles(a.axis.as_ref()) {
        for to in angles(b.axis.as_ref()) {
            // The axis on top may stand anywhere under an upright tool.
            let on_top = if upright(a) || upright(b) { 0.0 } else { turn(from.turn, to.turn) };
            least = least.min((to.tilt - from.tilt).abs().max(on_top) / rotary.rapid);
        }
    }
    linear.max(least)
}

/// Reads a program back and measures what it leaves. One that begins at a later run than the first is to leave what that run
/// found: only what it does is judged, not what it leaves.
///
/// # Errors
/// A file that the reader refuses.
pub fn measure(
    files: &[(String, String)],
    first_run: usize,
    machine: &Machine,
    wanted: &Wanted,
) -> Result<(Figures, Vec<Finding>), MillError> {
    let mut moves = Vec::new();
    let mut swings = Vec::new();
    for (name, text) in files {
        let motions = machine::read(text, machine).map_err(|error| MillError::Read(name.clone(), error))?;
        for motion in &motions {
            swings.extend(swing(motion, machine, moves.len()));
            moves.extend(looked_at(motion, machine));
        }
    }
    let (figures, mut findings) = inspect(&moves, wanted);
    findings.extend(swings);
    if first_run > 0 {
        findings.retain(|finding| finding.trouble.is_of_a_move());
    }
    Ok((figures, findings))
}

/// An axis that turns further in one block of a cut than the machine's profile lets it.
fn swing(motion: &Motion, machine: &Machine, step: usize) -> Option<Finding> {
    let (rotary, [from, to]) = (machine.rotary.as_ref()?, motion.angles?);
    let value = (to.tilt - from.tilt).abs().max((to.turn - from.turn).abs());
    let cuts = !motion.rapid && motion.from.tip.z.min(motion.pose.tip.z) < 0.0;
    let (at, limit) = (motion.pose.tip, rotary.max_swing);
    let found = Finding { trouble: Trouble::Jump, at, value, limit, hinge: None, step: Some(step) };
    (cuts && value > limit + SWING_PLAY).then_some(found)
}

/// A move of a program as moves of a tool that turns evenly.
fn looked_at(motion: &Motion, machine: &Machine) -> Vec<Move> {
    let turned = motion.angles.map_or(0.0, |[a, b]| (b.tilt - a.tilt).abs().max((b.turn - a.turn).abs()));
    let looks = (turned / LOOK).ceil().clamp(1.0, 1e4) as usize;
    let length = (motion.pose.tip - motion.from.tip).norm();
    // Where the tip is not held the feed is that of the axes: the tip's is its way by the time.
    let feed =
        if motion.tcp || motion.angles.is_none() { motion.feed } else { 60.0 * length / motion.seconds };
    let rate = if motion.rapid { Rate::Rapid } else { Rate::Feed(feed) };
    let at = |look: usize| match look {
        0 => motion.from,
        look if look == looks => motion.pose,
        look => pose_at(motion, machine, look as f64 / looks as f64),
    };
    (0..looks).map(|look| Move { from: at(look), to: at(look + 1), rate, spindle: motion.spindle }).collect()
}
