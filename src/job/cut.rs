//! How a job wants its sheet cut: keys of `[fabrication]`.

use toml::Spanned;

use super::read::RawFabrication;
use crate::fabrication::plan::CutOptions;
use crate::profile::Profile;
use crate::toml_source::{Limits, TomlError, TomlSource};

const COPIES: Limits = Limits::new(1.0, 10_000.0, "", "parts on one sheet");
const SPACING: Limits = Limits::new(0.01, 1000.0, "mm", "between the burned edges of two parts");
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
        let least = profile.laser.min_web;
        if options.spacing < least {
            let what = format!("too small: allowed is at least the profile's min_web_mm = {least}");
            return Err(source.value_error(value.span(), &what, "what stands between two parts burns away"));
        }
    }
    if let Some(value) = &raw.passes {
        options.passes = count(source, value, &PASSES)?;
    }
    Ok(options)
}

fn count(source: &TomlSource, value: &Spanned<i64>, limits: &Limits) -> Result<usize, TomlError> {
    // Beyond 2^53 the conversion rounds, far outside of the limits.
    Ok(source.number(&Spanned::new(value.span(), *value.get_ref() as f64), limits)? as usize)
}
