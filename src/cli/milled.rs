//! The milling program that `make` and `fabricate` write alike, and what is said of it.

use serde_json::{Value, json};

use super::Failure;
use super::results::Results;
use crate::fabrication::plan::CutOptions;
use crate::fabrication::product::Product;
use crate::machine::{Header, Machine};
use crate::milling::path::CLEARANCE;
use crate::milling::sweep::Figures;
use crate::milling::toolpath::Contour;
use crate::pipeline::Clock;
use crate::pipeline::mill::{Milled, Order, mill};
use crate::profile::Tool;

/// The verified program of a sheet that is milled, from one of its runs on (counted from 0); `None` of what a laser cuts and of what is no sheet.
///
/// # Errors
/// Nothing that the machine can do, or a program that leaves something else than the part.
pub fn milled(
    results: &Results,
    machine: Option<&Machine>,
    options: &CutOptions,
    first_run: usize,
    clock: &mut Clock,
) -> Result<Option<Milled>, Failure> {
    let (Product::Sheet(sheet), Some(machine)) = (results.product, machine) else { return Ok(None) };
    let (Some(solids), Some(plan)) = (results.extras.solids, results.extras.plan) else { return Ok(None) };
    let profile = results.profile;
    let Some(mut tool) = profile.tool else { return Ok(None) };
    if let Some(wish) = &options.tabs {
        (tool.tabs, tool.tab_width) = (wish.count, wish.width);
    }
    let header = Header {
        job: results.name.to_owned(),
        profile: profile.name.clone(),
        tool: tool_words(&tool, profile.cut.kerf),
        stock: format!("{} x {} mm, {}", profile.sheet.width, profile.sheet.height, profile.material.name),
        notes: Vec::new(),
        hash: results.design_hash().map_err(|error| Failure::BadInput(error.to_string()))?,
        spindle_rpm: tool.spindle,
        first_run,
    };
    let order =
        Order { sheet, part: &solids.part, profile, tool: &tool, copies: &plan.report.copies, machine };
    let milled = clock.run("mill", |_| mill(&order, &header));
    milled.map(Some).map_err(|error| Failure::NotMakeable(error.to_string()))
}

fn tool_words(tool: &Tool, diameter: f64) -> String {
    let flutes = if tool.flutes == 1.0 { "1 flute".to_owned() } else { format!("{} flutes", tool.flutes) };
    format!("{diameter} mm, {flutes}, edges {} mm long, out {} mm", tool.flute_length, tool.stickout)
}

/// The `mill` block of `hinges.json`.
pub fn object(milled: &Milled, machine: &Machine) -> Value {
    let Figures { gouge, leftover, widths, centre, rapid, shank, moves, cut, bodies, loose } = milled.figures;
    let stats = &milled.program.stats;
    let tabs = milled.planned.tabs.iter();
    let tabs =
        tabs.map(|tab| json!({ "at_mm": [tab.at.x, tab.at.y], "reach_mm": tab.reach, "top_mm": tab.top }));
    json!({
        "machine": machine.name,
        "first_run": stats.restarts.first().map_or(0, |first| first.run),
        "files": milled.program.files.iter().map(|(name, _)| name).collect::<Vec<_>>(),
        "tabs": tabs.collect::<Vec<_>>(),
        "runs": stats.runs,
        "blocks": stats.motions,
        "time_s": { "total": stats.cut_seconds + stats.air_seconds, "cutting": stats.cut_seconds, "between": stats.air_seconds },
        "turned_deg": stats.turned.map(f64::to_degrees),
        "largest_swing_deg": stats.largest_swing.to_degrees(),
        "retreats": stats.retreats,
        "gouge_mm": gouge,
        "leftover_mm": leftover,
        "ligament_width_mm": widths,
        "ligament_centre_mm": centre,
        "rapid_height_mm": rapid.is_finite().then_some(rapid),
        "shank_height_mm": shank,
        "moves": moves,
        "cut_mm": cut,
        "bodies": bodies,
        "loose_scraps": loose,
    })
}

/// Lines for the summary.
pub fn lines((milled, machine): (&Milled, &Machine)) -> String {
    let (stats, figures) = (&milled.program.stats, &milled.figures);
    let walls = if machine.follows_axes() { "along the hinges' axes" } else { "upright: three axes" };
    format!(
        "  milled on {}, walls {walls}: {} openings and borders, {} blocks, {}\n  \
         in simulation {:.3} mm of gouge, {:.3} mm left on walls, ligaments {:.3} to {:.3} mm wide and {:.3} mm off at any depth\n",
        machine.name,
        stats.runs,
        stats.motions,
        time(stats.cut_seconds + stats.air_seconds),
        figures.gouge,
        figures.leftover,
        figures.widths[0],
        figures.widths[1],
        figures.centre,
    )
}

/// Hours and minutes.
fn time(seconds: f64) -> String {
    let minutes = (seconds / 60.0).round() as u64;
    if minutes >= 60 { format!("{} h {} min", minutes / 60, minutes % 60) } else { format!("{minutes} min") }
}

/// `setup.txt`: what the person at the machine needs to know.
pub fn setup(milled: &Milled, results: &Results, machine: &Machine) -> String {
    let (profile, stats) = (results.profile, &milled.program.stats);
    let Some(tool) = &profile.tool else { return String::new() };
    let path = &milled.planned.path;
    let deepest =
        path.runs.iter().flat_map(|run| &run.blocks).map(|block| block.to.tip.z).fold(0.0, f64::min);
    let borders = path.runs.iter().filter(|run| run.contour == Contour::Border).count();
    let files: Vec<&str> = milled.program.files.iter().map(|(name, _)| name.as_str()).collect();
    let [low, high] = stats.bounds;
    let tilt = machine.setup.fixture.angle().to_degrees();
    let mut text =
        format!("Set-up sheet: {}, profile {}, machine {}\n\n", results.name, profile.name, machine.name);
    let mut row = |label: &str, value: String| text += &format!("{label:<14} {value}\n");
    row("Program", files.join(", "));
    let sheet = &profile.sheet;
    row(
        "Stock",
        format!("{}, {} x {} x {} mm", profile.material.name, sheet.width, sheet.height, sheet.thickness),
    );
    row("Zero", "lower left corner of the stock, on top of it; x along its lower edge".to_owned());
    row("Tool", format!("T{}: {}", machine.setup.tool_number, tool_words(tool, profile.cut.kerf)));
    row(
        "",
        format!("{} turns/min clockwise, {} mm/min, down {} mm/min", tool.spindle, tool.feed, tool.plunge),
    );
    row(
        "Wedge",
        if tilt > 0.0 {
            format!("{tilt:.2} degrees under the stock")
        } else {
            "none, the stock lies flat".to_owned()
        },
    );
    row("Cuts in", format!("x {:.1} to {:.1}, y {:.1} to {:.1} mm", low.x, high.x, low.y, high.y));
    row(
        "Spoilboard",
        format!(
            "the tip goes {:.2} mm below the stock: at least {:.1} mm thick",
            -deepest - sheet.thickness,
            2.0 - deepest - sheet.thickness
        ),
    );
    row(
        "Workholding",
        "vacuum or tape over the whole area; no clamp within the cuts and the holder's reach".to_owned(),
    );
    let last = if borders == 1 { "the border".to_owned() } else { format!("{borders} borders") };
    row("Order", format!("{} openings, then {last}", stats.runs - borders));
    row(
        "Comes loose",
        match milled.figures.loose {
            0 => "nothing before the border".to_owned(),
            count => format!("{count} scraps of windows, before the border: take them out at a stop"),
        },
    );
    row(
        "Tabs",
        format!(
            "{} of {} x {} mm: cut them by hand",
            milled.planned.tabs.len(),
            tool.tab_width,
            tool.tab_height
        ),
    );
    row(
        "Height",
        format!(
            "{CLEARANCE} mm above the stock before and after each cut, {} mm between",
            machine.setup.safe_height
        ),
    );
    row(
        "Time",
        format!(
            "{} ({} of it cutting), without acceleration",
            time(stats.cut_seconds + stats.air_seconds),
            time(stats.cut_seconds)
        ),
    );
    text += "\nAfter a broken tool begin again at the run that it broke in: kirimorph fabricate . --from-run RUN writes the rest.\n";
    for restart in &stats.restarts {
        let start = path.runs[restart.run].start.tip;
        text += &format!(
            "  run {:>4}  {} line {:>7}  at x {:.2}, y {:.2}\n",
            restart.run + 1,
            files[restart.file],
            restart.line,
            start.x,
            start.y
        );
    }
    text
}
