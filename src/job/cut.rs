//! How a job wants its sheet cut: keys of `[fabrication]`.

use toml::Spanned;

use super::read::{RawFabrication, choice};
use crate::fabrication::plan::{CutOptions, CutOrder, Pierce};
use crate::profile::Profile;
use crate::toml_source::{Limits, TomlError, TomlSource};

const COPIES: Limits = Limits::new(1.0, 10_000.0, "", "parts on one sheet");
const SPACING: Limits = Limits::new(0.01, 1000.0, "mm", "between the burned edges of two parts");
const COOL: Limits = Limits::new(0.0, 3600.0, "s", "a thin sheet is cool after some seconds");
/// How long hinges rest in the order "heat", seconds.
const COOL_DEFAULT: f64 = 10.0;
const PASSES: Limits = Limits::new(1.0, 1000.0, "", "how often the beam follows each cut");

pub(super) fn cut_options(
    source: &TomlSource,
    raw: &RawFabrication,
    profile: &Profile,
) -> Result<CutOptions, TomlError> {
    let mut options = CutOptions::default();
    if let Some(value) = &raw.copies {
        options.copies = count(source, value, &COPIES)?;
    }
    if let Some(value) = &raw.spacing_mm {
        options.spacing = source.number(value, &SPACING)?;
        let least = profile.cut.min_web;
        if options.spacing < least {
            let what = format!("too small: allowed is at least the profile's min_web_mm = {least}");
            return Err(source.value_error(value.span(), &what, "what stands between two parts burns away"));
        }
    }
    if let Some(value) = &raw.passes {
        options.passes = count(source, value, &PASSES)?;
    }
    let places = [("slit-end", Pierce::SlitEnd), ("mid-slit", Pierce::MidSlit)];
    options.pierce = choice(source, raw.pierce.as_ref(), &places)?.unwrap_or(options.pierce);
    let heat = choice(source, raw.order.as_ref(), &[("travel", false), ("heat", true)])? == Some(true);
    let cool = source.optional(raw.cool_s.as_ref(), &COOL)?;
    if heat {
        options.order = CutOrder::Heat(cool.unwrap_or(COOL_DEFAULT));
    }
    Ok(options)
}

fn count(source: &TomlSource, value: &Spanned<i64>, limits: &Limits) -> Result<usize, TomlError> {
    // Beyond 2^53 the conversion rounds, far outside of the limits.
    Ok(source.number(&Spanned::new(value.span(), *value.get_ref() as f64), limits)? as usize)
}
