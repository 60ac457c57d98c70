//! `setup.txt`: what the person at the mill needs to know.

use super::milled::{borders, time, tool_words};
use super::results::Results;
use crate::machine::{Machine, Restart};
use crate::milling::path::CLEARANCE;
use crate::pipeline::mill::Milled;

/// Spoilboard below the deepest cut, millimetres.
const SPOILBOARD: f64 = 2.0;

/// The text.
pub fn setup(milled: &Milled, results: &Results, machine: &Machine) -> String {
    let mut text = format!(
        "Set-up sheet: {}, profile {}, machine {}\n\n",
        results.name(),
        results.profile.name,
        machine.name
    );
    for (label, value) in rows(milled, results, machine) {
        text += &format!("{label:<14} {value}\n");
    }
    text += &format!("\n{AGAIN}\n");
    restarts(milled).iter().for_each(|line| text += &format!("  {line}\n"));
    text
}

/// What to do after a broken tool.
pub const AGAIN: &str = "After a broken tool begin again at the run that it broke in: kirimorph fabricate ... --from-run RUN writes \
                         the rest.";

/// Label and value of all but the places to begin again.
pub fn rows(milled: &Milled, results: &Results, machine: &Machine) -> Vec<(&'static str, String)> {
    set_up(milled, results, machine).into_iter().chain(cutting(milled, machine)).collect()
}

/// Stock, zero, tool, workholding.
fn set_up(milled: &Milled, results: &Results, machine: &Machine) -> Vec<(&'static str, String)> {
    let (sheet, tool, names) = (&results.profile.sheet, &milled.tool, &milled.program.files);
    let blocks = milled.planned.path.runs.iter().flat_map(|run| &run.blocks);
    let below = -blocks.map(|block| block.to.tip.z).fold(0.0, f64::min) - sheet.thickness;
    let material = &results.profile.material.name;
    let [low, high] = milled.program.stats.bounds;
    let tilt = machine.setup.fixture.angle().to_degrees();
    let wedge = match tilt > 0.0 {
        true => format!("{tilt:.2} degrees under the stock"),
        false => "none, the stock lies flat".to_owned(),
    };
    let tool_named = tool_words(tool, results.profile.cut.kerf);
    let files: Vec<&str> = names.iter().map(|(name, _)| name.as_str()).collect();
    vec![
        ("Program", files.join(", ")),
        ("Stock", format!("{material}, {} x {} x {} mm", sheet.width, sheet.height, sheet.thickness)),
        ("Zero", "lower left corner of the stock, on top of it; x along its lower edge".to_owned()),
        ("Tool", format!("T{}: {tool_named}", machine.setup.tool_number)),
        (
            "Speeds",
            format!(
                "{} turns/min clockwise, {} mm/min, back in a cut groove {}, down {}",
                tool.spindle, tool.feed, tool.retrace, tool.plunge
            ),
        ),
        ("Wedge", wedge),
        ("Cuts in", format!("x {:.1} to {:.1}, y {:.1} to {:.1} mm", low.x, high.x, low.y, high.y)),
        (
            "Spoilboard",
            format!(
                "the tip goes {below:.2} mm below the stock: at least {:.1} mm thick",
                below + SPOILBOARD
            ),
        ),
        (
            "Workholding",
            "vacuum or tape over the whole area; no clamp within the cuts and the holder's reach".to_owned(),
        ),
    ]
}

/// Order, what comes loose, time.
fn cutting(milled: &Milled, machine: &Machine) -> Vec<(&'static str, String)> {
    let (stats, tool) = (&milled.program.stats, &milled.tool);
    let borders = borders(milled);
    let last = if borders == 1 { "the border".to_owned() } else { format!("{borders} borders") };
    let loose = match milled.figures.loose {
        0 => "nothing before the border".to_owned(),
        count => format!("{count} scraps of windows, before the border: take them out at a stop"),
    };
    let (total, in_cuts) = (time(stats.cut_seconds + stats.air_seconds), time(stats.cut_seconds));
    let tabs = milled.planned.tabs.len();
    let safe = machine.setup.safe_height;
    vec![
        ("Order", format!("{} openings, then {last}", stats.runs.saturating_sub(borders))),
        ("Comes loose", loose),
        ("Tabs", format!("{tabs} of {} x {} mm: cut them by hand", tool.tab_width, tool.tab_height)),
        ("Height", format!("{CLEARANCE} mm above the stock before and after each cut, {safe} mm between")),
        ("Time", format!("{total} ({in_cuts} of it cutting), without acceleration")),
    ]
}

/// Where each run begins.
pub fn restarts(milled: &Milled) -> Vec<String> {
    let line = |restart: &Restart| {
        let start = milled.planned.path.runs[restart.run].start.tip;
        let name = &milled.program.files[restart.file].0;
        let (run, line) = (restart.run + 1, restart.line);
        format!("run {run:>4}  {name} line {line:>7}  at x {:.2}, y {:.2}", start.x, start.y)
    };
    milled.program.stats.restarts.iter().map(line).collect()
}
