//! The keys of `[fabrication]` that choose the profile and change its numbers.

use std::path::Path;

use serde::Deserialize;
use toml::Spanned;

use super::cut::cut_options;
use super::machine::machine;
use super::{DxfVersion, Fabrication, JobError, Shape, Target};
use crate::profile::{self, KERF, Process, Profile, SHEET_SIDE, TOOL_RADIUS};
use crate::toml_source::{Limits, Pair, ShelfError, TomlError, TomlSource};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawFabrication {
    profile: Spanned<String>,
    sheet_mm: Option<Pair<f64>>,
    kerf_mm: Option<Spanned<f64>>,
    process: Option<Spanned<String>>,
    pub machine: Option<Spanned<String>>,
    dxf: Option<Spanned<String>>,
    pub copies: Option<Spanned<i64>>,
    pub spacing_mm: Option<Spanned<f64>>,
    pub passes: Option<Spanned<i64>>,
    pub pierce: Option<Spanned<String>>,
    pub order: Option<Spanned<String>>,
    pub cool_s: Option<Spanned<f64>>,
    pub cool_mm: Option<Spanned<f64>>,
    pub leads: Option<Spanned<String>>,
    pub lead_mm: Option<Spanned<f64>>,
    pub tabs: Option<Spanned<i64>>,
    pub tab_mm: Option<Spanned<f64>>,
    pub engrave: Option<Spanned<bool>>,
    sheet_state: Option<Spanned<String>>,
}

pub(super) fn fabrication(
    source: &TomlSource,
    raw: &RawFabrication,
    folder: &Path,
) -> Result<Fabrication, JobError> {
    let dxf = dxf_version(source, raw)?;
    let mut profile = load_profile(source, &raw.profile, folder)?;
    check_process(source, raw, &profile)?;
    override_kerf(source, raw, &mut profile)?;
    override_sheet(source, raw, &mut profile)?;
    let cut = cut_options(source, raw, &profile)?;
    let machine = machine(source, raw, folder, &profile)?;
    if let Some(machine) = &machine {
        profile.cut.ruled &= machine.follows_axes();
    }
    Ok(Fabrication { profile, dxf, cut, machine })
}

pub(super) fn dxf_version(source: &TomlSource, raw: &RawFabrication) -> Result<DxfVersion, TomlError> {
    let versions = [("r2000", DxfVersion::R2000), ("r12", DxfVersion::R12)];
    Ok(source.optional_word(raw.dxf.as_ref(), &versions)?.unwrap_or_default())
}

fn load_profile(source: &TomlSource, name: &Spanned<String>, folder: &Path) -> Result<Profile, JobError> {
    profile::load(name.get_ref(), folder).map_err(|error| match error {
        ShelfError::UnknownName { known, .. } => {
            let help = format!("there are {}; or give the path of a TOML file", known.join(", "));
            source.value_error(name.span(), "not the name of a profile", help).into()
        }
        ShelfError::Toml(TomlError::Read { path, source: reason }) => {
            let what = format!("not readable as a profile: {reason}");
            let help = format!("looked at {}; paths are relative to the job file", path.display());
            source.value_error(name.span(), &what, help).into()
        }
        faulty => JobError::Profile { file: source.file.to_owned(), source: faulty },
    })
}

/// The sheet is the state that is "flat": the other one is a surface of its own. A job may say so.
pub(super) fn check_sheet_state(
    source: &TomlSource,
    raw: &RawFabrication,
    target: &Target,
) -> Result<(), TomlError> {
    let words = [("closed", &target.closed), ("open", &target.open)];
    let Some(value) = &raw.sheet_state else { return Ok(()) };
    match source.word(value, &words, "")? {
        Shape::Flat => Ok(()),
        Shape::Free | Shape::Mesh(_) => {
            let state = value.get_ref();
            let what = format!("not possible: {state} is not \"flat\" in this job's [target]");
            let help = format!(
                "the sheet is cut in the state that is \"flat\": {state} = \"flat\", or leave the key out"
            );
            Err(source.value_error(value.span(), &what, help))
        }
    }
}

/// A job may repeat what its profile says.
fn check_process(source: &TomlSource, raw: &RawFabrication, profile: &Profile) -> Result<(), TomlError> {
    let words = [("laser", Process::Laser), ("milling", Process::Milling)];
    let Some(value) = &raw.process else { return Ok(()) };
    if source.word(value, &words, "")? == profile.process {
        return Ok(());
    }
    let what = format!("not the process of the profile {}", profile.name);
    Err(source.value_error(value.span(), &what, "leave the key out, or take another profile"))
}

pub(super) fn override_kerf(
    source: &TomlSource,
    raw: &RawFabrication,
    profile: &mut Profile,
) -> Result<(), TomlError> {
    let Some(value) = &raw.kerf_mm else { return Ok(()) };
    if profile.process == Process::Milling {
        let radius = TOOL_RADIUS.range;
        let limits = Limits::new(2.0 * radius.start(), 2.0 * radius.end(), "mm", "the tool's diameter");
        profile.cut.kerf = source.number(value, &limits)?;
        return Ok(());
    }
    profile.cut.kerf = source.number(value, &KERF)?;
    if profile.cut.kerf > profile.cut.min_web {
        let what =
            format!("too large: allowed is at most the profile's min_web_mm = {}", profile.cut.min_web);
        return Err(source.value_error(
            value.span(),
            &what,
            "a web narrower than the groove beside it burns away",
        ));
    }
    Ok(())
}

pub(super) fn override_sheet(
    source: &TomlSource,
    raw: &RawFabrication,
    profile: &mut Profile,
) -> Result<(), TomlError> {
    let Some(value) = &raw.sheet_mm else { return Ok(()) };
    let [width, height] = source.pair(value)?;
    for side in [width, height] {
        let margins = 2.0 * profile.sheet.margin;
        if source.number(side, &SHEET_SIDE)? <= margins {
            let what = format!("too small: allowed is more than the profile's two margins, {margins} mm");
            return Err(source.value_error(side.span(), &what, "the margins leave nothing to cut"));
        }
    }
    [profile.sheet.width, profile.sheet.height] = [*width.get_ref(), *height.get_ref()];
    Ok(())
}
