//! How a job wants its sheet cut: keys of `[fabrication]`.

use super::fabrication::{RawFabrication, dxf_version, override_kerf, override_sheet};
use crate::fabrication::plan::{CutOptions, CutOrder, LeadShape, Leads, Pierce, TabWish};
use crate::output::dxf::DxfVersion;
use crate::profile::Profile;
use crate::toml_source::{Limits, TomlError, TomlSource};

const COPIES: Limits = Limits::new(1.0, 10_000.0, "", "parts on one sheet");
const SPACING: Limits = Limits::new(0.01, 1000.0, "mm", "between the burned edges of two parts");
const COOL: Limits = Limits::new(0.0, 3600.0, "s", "a thin sheet is cool after some seconds");
/// How long hinges rest in the order "heat", seconds.
const COOL_DEFAULT: f64 = 10.0;
const COOL_WITHIN: Limits = Limits::new(0.0, 1000.0, "mm", "how near a cut comes that heats a hinge");
const LEAD: Limits =
    Limits::new(0.1, 50.0, "mm", "from the pierced hole to the cut; holes are a few kerfs wide");
/// Length of leads, millimetres.
const LEAD_DEFAULT: f64 = 2.0;
const TABS: Limits = Limits::new(1.0, 1000.0, "", "three or four hold a part");
const TAB: Limits = Limits::new(0.01, 50.0, "mm", "what is left at a tab; you break it by hand");
const PASSES: Limits = Limits::new(1.0, 1000.0, "", "how often the beam follows each cut");

pub(super) fn cut_options(
    source: &TomlSource,
    raw: &RawFabrication,
    profile: &Profile,
) -> Result<CutOptions, TomlError> {
    let mut options = CutOptions::default();
    if let Some(value) = &raw.copies {
        options.copies = source.count(value, &COPIES)?;
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
        options.passes = source.count(value, &PASSES)?;
    }
    let places = [("slit-end", Pierce::SlitEnd), ("mid-slit", Pierce::MidSlit), ("scrap", Pierce::Scrap)];
    options.pierce = source.optional_word(raw.pierce.as_ref(), &places)?.unwrap_or(options.pierce);
    if let (Pierce::MidSlit, Some(value)) = (options.pierce, &raw.pierce)
        && dxf_version(source, raw)? == DxfVersion::R12
    {
        let help = "an R12 file holds lines, not paths, so the two halves of a slit would be read as one; take dxf = \"r2000\"";
        return Err(source.value_error(value.span(), "not possible with dxf = \"r12\"", help));
    }
    let heat = source.optional_word(raw.order.as_ref(), &[("travel", false), ("heat", true)])? == Some(true);
    let cool = source.optional(raw.cool_s.as_ref(), &COOL)?;
    let within = source.optional(raw.cool_mm.as_ref(), &COOL_WITHIN)?;
    if heat {
        options.order = CutOrder::Heat { cool: cool.unwrap_or(COOL_DEFAULT), within };
    }
    options.leads = leads(source, raw, options.pierce)?;
    options.tabs = tabs(source, raw, profile)?;
    for (value, counts, wanted) in [
        (&raw.cool_s, heat, "order = \"heat\""),
        (&raw.cool_mm, heat, "order = \"heat\""),
        (&raw.lead_mm, options.leads.is_some(), "leads = \"line\" or \"arc\""),
        (&raw.tab_mm, options.tabs.is_some(), "tabs"),
    ] {
        if let Some(value) = value.as_ref().filter(|_| !counts) {
            let help = format!("leave it out, or give {wanted} too");
            return Err(source.value_error(value.span(), "without effect here", help));
        }
    }
    if raw.engrave.as_ref().is_some_and(|engrave| *engrave.get_ref()) {
        options.engrave = Some(part_name(source.file));
    }
    Ok(options)
}

/// To pierce in scrap is to have leads.
fn leads(source: &TomlSource, raw: &RawFabrication, pierce: Pierce) -> Result<Option<Leads>, TomlError> {
    let shapes = [("none", None), ("line", Some(LeadShape::Line)), ("arc", Some(LeadShape::Arc))];
    let length = source.optional(raw.lead_mm.as_ref(), &LEAD)?.unwrap_or(LEAD_DEFAULT);
    let shape = match (source.optional_word(raw.leads.as_ref(), &shapes)?, &raw.leads) {
        (Some(None), Some(value)) if pierce == Pierce::Scrap => {
            let help = "the beam comes from scrap by a lead: \"line\" or \"arc\"; or take another pierce";
            return Err(source.value_error(value.span(), "not possible with pierce = \"scrap\"", help));
        }
        (Some(Some(LeadShape::Arc)), Some(value)) if dxf_version(source, raw)? == DxfVersion::R12 => {
            let help = "an ARC of an R12 file has no direction, so the beam may come from the wrong end; take \"line\" or dxf = \"r2000\"";
            return Err(source.value_error(value.span(), "not possible with dxf = \"r12\"", help));
        }
        (Some(shape), _) => shape,
        (None, _) => (pierce == Pierce::Scrap).then_some(LeadShape::Line),
    };
    Ok(shape.map(|shape| Leads { shape, length }))
}

fn tabs(source: &TomlSource, raw: &RawFabrication, profile: &Profile) -> Result<Option<TabWish>, TomlError> {
    let least = profile.cut.min_web;
    let width = source.optional(raw.tab_mm.as_ref(), &TAB)?.unwrap_or(least);
    if let Some(value) = raw.tab_mm.as_ref().filter(|_| width < least) {
        let what = format!("too small: allowed is at least the profile's min_web_mm = {least}");
        return Err(source.value_error(value.span(), &what, "what stands between two grooves burns away"));
    }
    let Some(value) = &raw.tabs else { return Ok(None) };
    Ok(Some(TabWish { count: source.count(value, &TABS)?, width }))
}

/// A file's name without its ending.
fn part_name(file: &str) -> String {
    std::path::Path::new(file).file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

/// What keys of `[fabrication]` say that stand alone, without a job; those of the profile's own numbers are put into it.
/// `text`: a TOML table.
///
/// # Errors
/// As in a job file.
pub fn cut_keys(text: &str, profile: &mut Profile) -> Result<(DxfVersion, CutOptions), TomlError> {
    let text = format!("profile = {}\n{text}", toml::Value::from(profile.name.as_str()));
    let source = TomlSource { file: "the options of the command line", text: &text };
    let raw: RawFabrication = source.parse()?;
    override_kerf(&source, &raw, profile)?;
    override_sheet(&source, &raw, profile)?;
    Ok((dxf_version(&source, &raw)?, cut_options(&source, &raw, profile)?))
}
