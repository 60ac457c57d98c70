//! What the machine takes besides cutting: for estimates of time and cost alone.

use serde::Deserialize;
use toml::Spanned;

use crate::toml_source::{Limits, TomlError, TomlSource};

const RAPID_SPEED: Limits =
    Limits::new(1.0, 20_000.0, "mm/s", "gantries run at 100 to 2000 mm/s between cuts, scanners up to 20000");
const PIERCE_TIME: Limits =
    Limits::new(0.0, 60.0, "s", "foil opens at once; thick plate takes seconds; 60 s no sheet");
const ENGRAVE_SPEED: Limits = Limits::new(
    0.1,
    20_000.0,
    "mm/s",
    "as fast as the beam marks: gantries 20 to 500 mm/s, scanners far more",
);
const HOURLY_RATE: Limits = Limits::new(0.0, 1.0e6, "an hour", "in your currency, all costs of the machine");

/// Speeds and rates of the machine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Machine {
    /// Speed between cuts, millimetres per second.
    pub rapid_speed: f64,
    /// Seconds before the beam moves on at the beginning of a cut.
    pub pierce_time: f64,
    /// Speed along engraved strokes, millimetres per second; `None` where nobody told.
    pub engrave_speed: Option<f64>,
    /// What an hour costs, in the user's currency.
    pub hourly_rate: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawMachine {
    rapid_speed_mm_per_s: Spanned<f64>,
    pierce_time_s: Spanned<f64>,
    engrave_speed_mm_per_s: Option<Spanned<f64>>,
    hourly_rate: Option<Spanned<f64>>,
}

pub(super) fn machine(source: &TomlSource, raw: &RawMachine) -> Result<Machine, TomlError> {
    Ok(Machine {
        rapid_speed: source.number(&raw.rapid_speed_mm_per_s, &RAPID_SPEED)?,
        pierce_time: source.number(&raw.pierce_time_s, &PIERCE_TIME)?,
        engrave_speed: source.optional(raw.engrave_speed_mm_per_s.as_ref(), &ENGRAVE_SPEED)?,
        hourly_rate: source.optional(raw.hourly_rate.as_ref(), &HOURLY_RATE)?,
    })
}
