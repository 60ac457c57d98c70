//! The milling tool: what it is and how it is used.

use std::f64::consts::PI;

use serde::Deserialize;
use toml::Spanned;

use crate::toml_source::{Limits, TomlError, TomlSource};

pub(crate) const TOOL_RADIUS: Limits = Limits::new(
    0.05,
    5.0,
    "mm",
    "the thinnest end mills have 0.1 mm diameter; beyond 10 mm no hinge is left",
);
const FEED: Limits = Limits::new(
    1.0,
    20_000.0,
    "mm/min",
    "along the path; thin tools break above some metres a minute and rub below a few millimetres",
);
const STEP_DOWN: Limits =
    Limits::new(0.01, 25.0, "mm", "how deep the tool goes in one pass: about its radius in a full groove");
const SPINDLE: Limits = Limits::new(100.0, 200_000.0, "rpm", "air bearings end at 200000 rpm");
const FLUTES: Limits = Limits::new(1.0, 12.0, "", "cutting edges of an end mill");
const CHIP_LOAD: Limits =
    Limits::new(0.0005, 1.0, "mm", "a tooth takes microns of steel to some tenths of plastic");
const RAMP: Limits =
    Limits::new(0.1, 45.0, "degrees", "the slope at which the tool goes down along a groove");
const FLUTE_LENGTH: Limits = Limits::new(0.1, 200.0, "mm", "the cutting edges' length from the tip");
const DIAMETER: Limits = Limits::new(0.1, 300.0, "mm", "of what follows the cutting edges");
const STICKOUT: Limits = Limits::new(0.5, 500.0, "mm", "from the tip to the holder's face");
const BREAKTHROUGH: Limits =
    Limits::new(0.0, 5.0, "mm", "below the sheet, into the spoilboard; the tilt of the tool is added");
const PASSES: Limits = Limits::new(0.0, 10.0, "", "at full depth, after the last step");
const TABS: Limits = Limits::new(0.0, 1000.0, "", "bridges that hold the part in the stock");
const TAB_WIDTH: Limits = Limits::new(0.1, 100.0, "mm", "a bridge that can be cut by hand");
const TAB_HEIGHT: Limits = Limits::new(0.05, 25.0, "mm", "a bridge that can be cut by hand");

/// By how much, relative, feed may differ from spindle speed times teeth times chip load.
const FEED_PLAY: f64 = 0.02;

/// A cylindrical end mill and how it is used; its diameter is the groove's width.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tool {
    /// Turns per minute, clockwise.
    pub spindle: f64,
    /// Cutting edges.
    pub flutes: f64,
    /// Feed along the path, mm/min.
    pub feed: f64,
    /// Feed where the groove is already cut at that depth, mm/min: on the way back along it.
    pub retrace: f64,
    /// Feed along the tool's axis, mm/min.
    pub plunge: f64,
    /// Depth of a pass, millimetres.
    pub step_down: f64,
    /// Slope of the way down into a pass, radians.
    pub ramp: f64,
    /// Length of the cutting edges from the tip, millimetres.
    pub flute_length: f64,
    /// Radius of the shank behind them, millimetres.
    pub shank_radius: f64,
    /// From the tip to the holder, millimetres.
    pub stickout: f64,
    /// Radius of the holder, millimetres.
    pub holder_radius: f64,
    /// How far below the sheet the tip goes besides what its tilt asks for, millimetres.
    pub breakthrough: f64,
    /// Passes at full depth after the last step.
    pub finish_passes: usize,
    /// Bridges on the border.
    pub tabs: usize,
    /// Their width, millimetres.
    pub tab_width: f64,
    /// Their height above the sheet's lower face, millimetres.
    pub tab_height: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawTool {
    pub radius_mm: Spanned<f64>,
    pub min_web_mm: Spanned<f64>,
    spindle_rpm: Spanned<f64>,
    flutes: Spanned<f64>,
    chip_load_mm: Spanned<f64>,
    feed_mm_per_min: Spanned<f64>,
    retrace_mm_per_min: Option<Spanned<f64>>,
    plunge_mm_per_min: Spanned<f64>,
    step_down_mm: Spanned<f64>,
    ramp_deg: Spanned<f64>,
    flute_length_mm: Spanned<f64>,
    shank_diameter_mm: Spanned<f64>,
    stickout_mm: Spanned<f64>,
    holder_diameter_mm: Spanned<f64>,
    breakthrough_mm: Spanned<f64>,
    finish_passes: Spanned<f64>,
    tabs: Spanned<f64>,
    tab_width_mm: Spanned<f64>,
    tab_height_mm: Spanned<f64>,
}

pub(super) fn tool(source: &TomlSource, raw: &RawTool, thickness: f64) -> Result<Tool, TomlError> {
    let whole = |value: &Spanned<f64>, limits: &Limits| {
        let number = source.number(value, limits)?;
        if number.fract() == 0.0 {
            return Ok(number);
        }
        Err(source.value_error(value.span(), "not a whole number", "a count: 1, 2, 3"))
    };
    let feed = source.number(&raw.feed_mm_per_min, &FEED)?;
    let retrace = raw.retrace_mm_per_min.as_ref().map(|value| source.number(value, &FEED)).transpose()?;
    let tool = Tool {
        spindle: source.number(&raw.spindle_rpm, &SPINDLE)?,
        flutes: whole(&raw.flutes, &FLUTES)?,
        feed,
        retrace: retrace.unwrap_or(feed),
        plunge: source.number(&raw.plunge_mm_per_min, &FEED)?,
        step_down: source.number(&raw.step_down_mm, &STEP_DOWN)?,
        ramp: source.number(&raw.ramp_deg, &RAMP)? * PI / 180.0,
        flute_length: source.number(&raw.flute_length_mm, &FLUTE_LENGTH)?,
        shank_radius: 0.5 * source.number(&raw.shank_diameter_mm, &DIAMETER)?,
        stickout: source.number(&raw.stickout_mm, &STICKOUT)?,
        holder_radius: 0.5 * source.number(&raw.holder_diameter_mm, &DIAMETER)?,
        breakthrough: source.number(&raw.breakthrough_mm, &BREAKTHROUGH)?,
        finish_passes: whole(&raw.finish_passes, &PASSES)? as usize,
        tabs: whole(&raw.tabs, &TABS)? as usize,
        tab_width: source.number(&raw.tab_width_mm, &TAB_WIDTH)?,
        tab_height: source.number(&raw.tab_height_mm, &TAB_HEIGHT)?,
    };
    check(source, raw, &tool, thickness)?;
    Ok(tool)
}

/// The rules between the tool's numbers.
fn check(source: &TomlSource, raw: &RawTool, tool: &Tool, thickness: f64) -> Result<(), TomlError> {
    let wanted = tool.spindle * tool.flutes * source.number(&raw.chip_load_mm, &CHIP_LOAD)?;
    if (tool.feed / wanted - 1.0).abs() > FEED_PLAY {
        let what = format!("not spindle_rpm x flutes x chip_load_mm = {wanted:.1} mm/min");
        return Err(source.value_error(raw.feed_mm_per_min.span(), &what, "change one of the four"));
    }
    if let Some(retrace) = raw.retrace_mm_per_min.as_ref().filter(|_| tool.retrace < tool.feed) {
        let what = format!("too small: allowed is at least feed_mm_per_min = {}", tool.feed);
        return Err(source.value_error(retrace.span(), &what, "leave the key out to go back at the feed"));
    }
    let needed = thickness + tool.breakthrough;
    if tool.flute_length < needed {
        let what = format!("too short: the sheet and the breakthrough below it take {needed} mm");
        return Err(source.value_error(raw.flute_length_mm.span(), &what, "take a longer tool"));
    }
    if tool.stickout < tool.flute_length {
        let what = format!("too short: allowed is at least flute_length_mm = {}", tool.flute_length);
        return Err(source.value_error(raw.stickout_mm.span(), &what, "the holder grips behind the edges"));
    }
    if tool.tab_height >= thickness {
        let what = format!("too large: allowed is less than the sheet's thickness, {thickness} mm");
        return Err(source.value_error(raw.tab_height_mm.span(), &what, "a tab is a bridge, not a wall"));
    }
    Ok(())
}
