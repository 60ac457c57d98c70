//! The milling program that `make` and `fabricate` write alike, and what is said of it.

use serde_json::{Value, json};

use super::Failure;
use super::results::{Extras, design_hash};
use crate::fabrication::plan::CutOptions;
use crate::fabrication::product::Product;
use crate::machine::{Header, Machine};
use crate::milling::sweep::Figures;
use crate::milling::toolpath::{Contour, Kind};
use crate::output::design_json::DesignFile;
use crate::pipeline::Clock;
use crate::pipeline::mill::{Milled, Order, mill};
use crate::profile::{Profile, Tool};

/// The verified program of a sheet that is milled, from one of its runs on (counted from 0); `None` of what a laser cuts and of what is no sheet.
///
/// # Errors
/// Nothing that the machine can do, or a program that leaves something else than the part.
pub fn milled(
    (product, file): (&Product, &DesignFile),
    extras: &Extras,
    profile: &Profile,
    options: &CutOptions,
    first_run: usize,
    clock: &mut Clock,
) -> Result<Option<Milled>, Failure> {
    let Extras { solids: Some(solids), plan: Some(plan), machine: Some(machine), .. } = extras else {
        return Ok(None);
    };
    let Product::Sheet(sheet) = product else { return Ok(None) };
    let Some(mut tool) = profile.tool else { return Ok(None) };
    if let Some(wish) = &options.tabs {
        (tool.tabs, tool.tab_width) = (wish.count, wish.width);
    }
    let header = Header {
        job: file.provenance.job.to_owned(),
        profile: profile.name.clone(),
        tool: tool_words(&tool, profile.cut.kerf),
        stock: format!("{} x {} mm, {}", profile.sheet.width, profile.sheet.height, profile.material.name),
        notes: Vec::new(),
        hash: design_hash(file).map_err(|error| Failure::BadInput(error.to_string()))?,
        spindle_rpm: tool.spindle,
        first_run,
    };
    let order =
        Order { sheet, part: &solids.part, profile, tool: &tool, copies: &plan.report.copies, machine };
    let milled = clock.run("mill", |_| mill(&order, &header));
    milled.map(Some).map_err(|error| Failure::NotMakeable(error.to_string()))
}

/// The tool in words.
pub fn tool_words(tool: &Tool, diameter: f64) -> String {
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
    let borders = borders(milled);
    let border = if borders == 1 { "the border".to_owned() } else { format!("{borders} borders") };
    format!(
        "  milled on {}, walls {walls}: {} openings, then {border}, {} blocks, {}\n  \
         in simulation {:.3} mm of gouge, {:.3} mm left on walls, ligaments {:.3} to {:.3} mm wide and {:.3} mm off at any depth\n",
        machine.name,
        stats.runs.saturating_sub(borders),
        stats.motions,
        time(stats.cut_seconds + stats.air_seconds),
        figures.gouge,
        figures.leftover,
        figures.widths[0],
        figures.widths[1],
        figures.centre,
    )
}

/// How many runs go around a part.
pub fn borders(milled: &Milled) -> usize {
    milled.planned.path.runs.iter().filter(|run| run.contour == Contour::Border).count()
}

/// What a dry run tells of a program besides: label and value.
pub fn statistics((milled, machine): (&Milled, &Machine)) -> Vec<(String, String)> {
    let stats = &milled.program.stats;
    let bytes: usize = milled.program.files.iter().map(|(_, text)| text.len()).sum();
    let names: Vec<&str> = milled.program.files.iter().map(|(name, _)| name.as_str()).collect();
    let mut rows =
        vec![("program".to_owned(), format!("{}, {:.1} MB", names.join(", "), 1e-6 * bytes as f64))];
    rows.extend(
        ways(milled).into_iter().map(|(what, way)| (what.to_owned(), format!("{:.2} m", 1e-3 * way))),
    );
    let between = time(stats.air_seconds);
    rows.push(("time".to_owned(), format!("{} in runs, {between} between them", time(stats.cut_seconds))));
    if machine.rotary.is_some() {
        let [tilt, turn] = stats.turned.map(f64::to_degrees);
        let swing = stats.largest_swing.to_degrees();
        rows.extend([
            (
                "axes turn".to_owned(),
                format!("{tilt:.0} and {turn:.0} deg in all, {swing:.1} at most in a block"),
            ),
            ("retreats".to_owned(), stats.retreats.to_string()),
        ]);
    }
    let [low, high] = stats.bounds;
    rows.push((
        "tip".to_owned(),
        format!(
            "x {:.2} to {:.2}, y {:.2} to {:.2}, z {:.2} to {:.2} mm",
            low.x, high.x, low.y, high.y, low.z, high.z
        ),
    ));
    let Figures { rapid, shank, .. } = milled.figures;
    rows.push((
        "above the stock".to_owned(),
        format!("rapid moves {rapid:.2} mm, shank and holder {shank:.2} mm"),
    ));
    rows
}

/// How long the tip's way is, by what it does, millimetres.
fn ways(milled: &Milled) -> [(&'static str, f64); 5] {
    let kinds = [
        ("way down", Kind::Ramp),
        ("rough passes", Kind::Rough),
        ("back in cut grooves", Kind::Retrace),
        ("last passes", Kind::Finish),
        ("in and out", Kind::Approach),
    ];
    let mut ways = kinds.map(|(what, _)| (what, 0.0));
    for run in &milled.planned.path.runs {
        let mut at = run.start.tip;
        for block in &run.blocks {
            let kind = if block.kind == Kind::Retract { Kind::Approach } else { block.kind };
            let place = kinds.iter().position(|(_, other)| *other == kind);
            ways[place.unwrap_or(0)].1 += (block.to.tip - at).norm();
            at = block.to.tip;
        }
    }
    ways
}

/// Hours and minutes, in words.
pub fn time(seconds: f64) -> String {
    let minutes = (seconds / 60.0).round() as u64;
    if minutes >= 60 { format!("{} h {} min", minutes / 60, minutes % 60) } else { format!("{minutes} min") }
}
