//! What a program says about itself.

use super::Facts;
use crate::machine::profile::Machine;

/// Longest text of a user's in a comment.
const LONGEST: usize = 100;

/// Letters, digits and a few signs of a text; what else it has becomes `_`.
///
/// No parenthesis, per cent sign, semicolon or line break is left: nothing can end the comment or be taken
/// for a word.
pub(super) fn sanitised(text: &str) -> String {
    let plain = |letter: char| {
        letter.is_ascii_alphanumeric()
            || matches!(letter, ' ' | '.' | ',' | '-' | '_' | ':' | '/' | '+' | '=')
    };
    text.chars().take(LONGEST).map(|letter| if plain(letter) { letter } else { '_' }).collect()
}

/// The lines of the head, each with a label of ours in front: LinuxCNC acts on comments that begin with words
/// like MSG.
pub(super) fn head(facts: &Facts) -> Vec<String> {
    let Facts { machine, header, stats, toolpath, .. } = facts;
    let [low, high] = stats.bounds;
    let mut lines = vec![
        format!("made by: kirimorph {}", env!("CARGO_PKG_VERSION")),
        format!("job: {}", sanitised(&header.job)),
        format!("design.json {}", sanitised(&header.hash)),
        format!("profile: {}", sanitised(&header.profile)),
        format!("machine: {}", sanitised(&machine.name)),
        format!(
            "tool: T{}, cylinder of {:.3} mm diameter, {:.0} turns/min, {}",
            machine.setup.tool_number,
            2.0 * toolpath.radius,
            header.spindle_rpm,
            sanitised(&header.tool)
        ),
        format!("stock: {:.3} mm thick, {}", toolpath.thickness, sanitised(&header.stock)),
        "zero: lower left corner of the stock, on top of it".to_owned(),
    ];
    lines.extend(header.notes.iter().map(|note| format!("note: {}", sanitised(note))));
    lines.extend(place(machine));
    lines.push(format!(
        "tip in cuts: X {:.3} to {:.3}, Y {:.3} to {:.3}, Z {:.3} to {:.3}",
        low.x, high.x, low.y, high.y, low.z, high.z
    ));
    let seconds = stats.cut_seconds + stats.air_seconds;
    lines.push(format!(
        "time: {}, {} of it cutting, without acceleration and tool change",
        clock(seconds),
        clock(stats.cut_seconds)
    ));
    lines.push(format!("runs: {}, begun at run {}", stats.runs, header.first_run + 1));
    if facts.files > 1 {
        lines.push(format!("file: {} of {}, to be run in order", facts.file + 1, facts.files));
    }
    lines
}

/// What the numbers rest on where they are joint coordinates, and how the stock lies.
fn place(machine: &Machine) -> Vec<String> {
    let mut lines = Vec::new();
    let zero = machine.setup.zero;
    lines.push(format!("work offset, machine coordinates: X {:.3} Y {:.3} Z {:.3}", zero.x, zero.y, zero.z));
    if let Some(rotary) = machine.rotary.as_ref().filter(|_| !machine.tcp) {
        let [tilt, turn] = rotary.table.letters();
        for (letter, at) in [(tilt, rotary.tilt_centre), (turn, rotary.turn_centre)] {
            lines.push(format!("axis {letter} goes through X {:.3} Y {:.3} Z {:.3}", at.x, at.y, at.z));
        }
        lines.push("these must be the machine's: they are in every number below".to_owned());
    }
    if let Some((axis, angle)) = machine.setup.fixture.axis_angle() {
        let angle = (axis.x + axis.y) * angle.to_degrees();
        let name = if axis.x != 0.0 { "X" } else { "Y" };
        lines.push(format!("wedge under the stock: turned by {angle:.3} degrees about {name} at zero"));
    }
    lines
}

fn clock(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    format!("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60)
}
