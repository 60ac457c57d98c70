//! The profile file: its keys, the range of each number with the reason, and the rules between numbers.

use serde::Deserialize;
use toml::Spanned;

use super::machine::{RawMachine, machine};
use super::tool::{RawTool, TOOL_RADIUS, tool};
use super::{Beam, Cut, Ligament, Material, Pole, Process, Profile, Shape, Sheet};
use crate::toml_source::{Limits, TomlError, TomlSource};

pub(crate) const SHEET_SIDE: Limits =
    Limits::new(50.0, 10_000.0, "mm", "a laser bed holds a sheet of some centimetres to some metres");
const MARGIN: Limits = Limits::new(0.0, 500.0, "mm", "clamps and sheet edge need millimetres, not metres");
const THICKNESS: Limits =
    Limits::new(0.02, 25.0, "mm", "foil is at least 0.02 mm; beyond 25 mm no beam cuts hinges");
const YOUNGS_MODULUS: Limits =
    Limits::new(0.1, 1.0e6, "MPa", "soft rubber has about 0.5 MPa, tungsten carbide about 700000 MPa");
const YIELD_STRAIN: Limits = Limits::new(
    1.0e-5,
    2.0,
    "",
    "a plain ratio, not per cent: metals yield near 0.002, rubber recovers up to about 1",
);
const STRAIN_LIMIT: Limits =
    Limits::new(1.0e-4, 5.0, "", "a plain ratio, not per cent: 0.4 is 40 %; above 5 no sheet material holds");
const ELONGATION: Limits = Limits::new(
    1.0e-3,
    10.0,
    "",
    "a plain ratio, not per cent: 0.4 is 40 %; the most ductile rubber reaches about 8",
);
const ENDURANCE_STRAIN: Limits = Limits::new(
    1.0e-6,
    1.0,
    "",
    "a strain amplitude as a plain ratio: metals last for ever below about 0.001",
);
const COFFIN_MANSON_COEFFICIENT: Limits =
    Limits::new(0.01, 5.0, "", "about the true strain at fracture: 0.1 to 1 for metals");
const COFFIN_MANSON_EXPONENT: Limits =
    Limits::new(-0.9, -0.3, "", "life falls as strain grows: metals have -0.5 to -0.7");
pub(crate) const KERF: Limits = Limits::new(
    0.005,
    2.0,
    "mm",
    "a focused beam burns a groove of at least 0.005 mm; above 2 mm it is no laser's",
);
const EXTRA_LENGTH: Limits =
    Limits::new(0.0, 50.0, "mm", "straight length beside the notch's round: 0 is none, 50 is no hinge");
const MIN_WEB: Limits = Limits::new(
    0.01,
    50.0,
    "mm",
    "thinner strips burn away; a wider demand than 50 mm leaves no room for pieces",
);
const HEAT_AFFECTED: Limits = Limits::new(
    0.0,
    5.0,
    "mm",
    "beside a laser's groove it is some hundredths to some tenths of a millimetre",
);
const POLE_OFFSET: Limits = Limits::new(
    -0.5,
    0.5,
    "",
    "a part of the ligament's length, towards the groove that passes: 0 is its centre, an arc of 90 degrees has 0.137",
);
const CUTTING_SPEED: Limits = Limits::new(
    0.01,
    5000.0,
    "mm/s",
    "over all passes together; scanners reach 5000 mm/s, slow cuts 0.01 mm/s",
);
const LIGAMENT_WIDTH: Limits =
    Limits::new(0.02, 50.0, "mm", "a hinge is a strip between two cuts, narrower than a piece");
const FREE_LENGTH: Limits = Limits::new(
    0.02,
    100.0,
    "mm",
    "the relief bar that frees a ligament must fit between two hinges of a piece",
);
const ROOT_COMPLIANCE: Limits =
    Limits::new(0.0, 3.0, "", "both roots together add up to about 1.25 widths to an elastic beam");

#[derive(Deserialize)]
struct VersionOnly {
    version: Spanned<i64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawProfile {
    #[serde(rename = "version")]
    _version: i64,
    process: Spanned<String>,
    sheet: RawSheet,
    material: RawMaterial,
    laser: Option<RawLaser>,
    tool: Option<RawTool>,
    ligament: RawLigament,
    machine: Option<RawMachine>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawSheet {
    width_mm: Spanned<f64>,
    height_mm: Spanned<f64>,
    margin_mm: Spanned<f64>,
    thickness_mm: Spanned<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawMaterial {
    name: Spanned<String>,
    youngs_modulus_mpa: Spanned<f64>,
    conditioned_modulus_mpa: Option<Spanned<f64>>,
    yield_strain: Spanned<f64>,
    strain_limit: Spanned<f64>,
    elongation: Spanned<f64>,
    endurance_strain: Option<Spanned<f64>>,
    coffin_manson_coefficient: Option<Spanned<f64>>,
    coffin_manson_exponent: Option<Spanned<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawLaser {
    kerf_mm: Spanned<f64>,
    min_web_mm: Spanned<f64>,
    cutting_speed_mm_per_s: Spanned<f64>,
    heat_affected_mm: Option<Spanned<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawLigament {
    shape: Option<Spanned<String>>,
    width_mm: Spanned<f64>,
    min_length_mm: Option<Spanned<f64>>,
    max_length_mm: Option<Spanned<f64>>,
    root_compliance: Option<Spanned<f64>>,
    extra_length_mm: Option<Spanned<f64>>,
    pole_offset: Option<Spanned<RawPole>>,
}

#[derive(Deserialize)]
#[serde(untagged, expecting = "not a part of the length, as 0.0, nor \"ideal-arc\"")]
enum RawPole {
    Part(f64),
    Word(String),
}

/// Reads and checks the text of a profile. `name` becomes the profile's name, `file` stands in messages.
///
/// # Errors
/// Syntax, unknown, missing or mistyped keys, numbers that are not finite or out of range, numbers that
/// contradict each other, another version than 1, a process other than a laser or milling or without its table.
pub fn parse(text: &str, name: &str, file: &str) -> Result<Profile, TomlError> {
    let source = TomlSource { file, text };
    let VersionOnly { version } = source.parse()?;
    if *version.get_ref() != 1 {
        let help = "write `version = 1`, or use the release of kirimorph that the profile was made for";
        return Err(source.value_error(
            version.span(),
            "not a version that this program reads: allowed is 1",
            help,
        ));
    }
    let raw: RawProfile = source.parse()?;
    let words = [("laser", Process::Laser), ("milling", Process::Milling)];
    let process = source.word(&raw.process, &words, "what cuts the sheet")?;
    let sheet = sheet(&source, &raw.sheet)?;
    let thickness = sheet.thickness;
    let profile = Profile {
        name: name.to_owned(),
        process,
        material: material(&source, &raw.material)?,
        cut: cut(&source, &raw, process, &sheet)?,
        sheet,
        ligament: ligament(&source, &raw.ligament)?,
        machine: raw.machine.as_ref().map(|raw| machine(&source, raw)).transpose()?,
        tool: raw.tool.as_ref().map(|raw| tool(&source, raw, thickness)).transpose()?,
    };
    check_relations(&source, &raw, &profile)?;
    Ok(profile)
}

fn sheet(source: &TomlSource, raw: &RawSheet) -> Result<Sheet, TomlError> {
    Ok(Sheet {
        width: source.number(&raw.width_mm, &SHEET_SIDE)?,
        height: source.number(&raw.height_mm, &SHEET_SIDE)?,
        margin: source.number(&raw.margin_mm, &MARGIN)?,
        thickness: source.number(&raw.thickness_mm, &THICKNESS)?,
    })
}

fn material(source: &TomlSource, raw: &RawMaterial) -> Result<Material, TomlError> {
    if raw.name.get_ref().trim().is_empty() {
        return Err(source.value_error(raw.name.span(), "empty", "reports print this name"));
    }
    let coefficient = source.optional(raw.coffin_manson_coefficient.as_ref(), &COFFIN_MANSON_COEFFICIENT)?;
    let exponent = source.optional(raw.coffin_manson_exponent.as_ref(), &COFFIN_MANSON_EXPONENT)?;
    let given = raw.coffin_manson_coefficient.as_ref().or(raw.coffin_manson_exponent.as_ref());
    let coffin_manson = match (coefficient, exponent, given) {
        (Some(coefficient), Some(exponent), _) => Some([coefficient, exponent]),
        (_, _, Some(given)) => {
            let help = "give both coffin_manson_coefficient and coffin_manson_exponent, or neither";
            return Err(source.value_error(given.span(), "half of a pair", help));
        }
        _ => None,
    };
    Ok(Material {
        name: raw.name.get_ref().clone(),
        youngs_modulus: source.number(&raw.youngs_modulus_mpa, &YOUNGS_MODULUS)?,
        yield_strain: source.number(&raw.yield_strain, &YIELD_STRAIN)?,
        strain_limit: source.number(&raw.strain_limit, &STRAIN_LIMIT)?,
        elongation: source.number(&raw.elongation, &ELONGATION)?,
        conditioned_modulus: source.optional(raw.conditioned_modulus_mpa.as_ref(), &YOUNGS_MODULUS)?,
        endurance_strain: source.optional(raw.endurance_strain.as_ref(), &ENDURANCE_STRAIN)?,
        coffin_manson,
    })
}

/// The groove, from the table of the process.
fn cut(source: &TomlSource, raw: &RawProfile, process: Process, sheet: &Sheet) -> Result<Cut, TomlError> {
    match (process, &raw.laser, &raw.tool) {
        (Process::Laser, Some(laser), None) => Ok(Cut {
            kerf: source.number(&laser.kerf_mm, &KERF)?,
            min_web: source.number(&laser.min_web_mm, &MIN_WEB)?,
            speed: source.number(&laser.cutting_speed_mm_per_s, &CUTTING_SPEED)?,
            ruled: false,
            heat_affected: source.optional(laser.heat_affected_mm.as_ref(), &HEAT_AFFECTED)?,
        }),
        (Process::Milling, None, Some(tool)) => {
            let used = self::tool(source, tool, sheet.thickness)?;
            // Both walls of a groove have their own pass at every depth.
            let passes = 2.0 * ((sheet.thickness / used.step_down).ceil() + used.finish_passes as f64);
            Ok(Cut {
                kerf: 2.0 * source.number(&tool.radius_mm, &TOOL_RADIUS)?,
                min_web: source.number(&tool.min_web_mm, &MIN_WEB)?,
                speed: used.feed / 60.0 / passes,
                // Unless the machine has three axes.
                ruled: true,
                heat_affected: None,
            })
        }
        (Process::Laser, ..) => {
            let what = "not what the other tables are for: a laser has a table [laser] and no table [tool]";
            Err(source.value_error(
                raw.process.span(),
                what,
                "give the one table that belongs to the process",
            ))
        }
        (Process::Milling, ..) => {
            let what = "not what the other tables are for: milling has a table [tool] and no table [laser]";
            Err(source.value_error(
                raw.process.span(),
                what,
                "give the one table that belongs to the process",
            ))
        }
    }
}

fn ligament(source: &TomlSource, raw: &RawLigament) -> Result<Ligament, TomlError> {
    let word = raw.shape.as_ref().map_or("beam", |shape| shape.get_ref().as_str());
    let foreign = |key: &Spanned<f64>| {
        let what = format!("not for the shape \"{word}\"");
        Err(source.value_error(key.span(), &what, "a beam has a range of lengths, a notch extra_length_mm"))
    };
    let shape = match word {
        "notch" => {
            let beam = [&raw.min_length_mm, &raw.max_length_mm, &raw.root_compliance];
            if let Some(key) = beam.into_iter().find_map(Option::as_ref) {
                return foreign(key);
            }
            let extra = source.optional(raw.extra_length_mm.as_ref(), &EXTRA_LENGTH)?;
            Shape::Notch { extra_length: extra.unwrap_or(0.0) }
        }
        "beam" | "rounded" => {
            if let Some(key) = &raw.extra_length_mm {
                return foreign(key);
            }
            let beam = beam(source, raw)?;
            if word == "beam" { Shape::Beam(beam) } else { Shape::Rounded(beam) }
        }
        _ => {
            let span = raw.shape.as_ref().map_or(0..0, Spanned::span);
            let what = "not known: allowed is \"beam\", \"notch\", \"rounded\"";
            return Err(source.value_error(span, what, "how the ligament gets its length"));
        }
    };
    let pole = raw.pole_offset.as_ref().map_or(Ok(Pole::Part(0.0)), |value| pole(source, value))?;
    Ok(Ligament { width: source.number(&raw.width_mm, &LIGAMENT_WIDTH)?, shape, pole })
}

fn pole(source: &TomlSource, value: &Spanned<RawPole>) -> Result<Pole, TomlError> {
    match value.get_ref() {
        RawPole::Part(part) => {
            Ok(Pole::Part(source.number(&Spanned::new(value.span(), *part), &POLE_OFFSET)?))
        }
        RawPole::Word(word) if word == "ideal-arc" => Ok(Pole::IdealArc),
        RawPole::Word(_) => {
            let what = "not known: allowed is a part of the length or \"ideal-arc\"";
            Err(source.value_error(value.span(), what, POLE_OFFSET.reason))
        }
    }
}

fn beam(source: &TomlSource, raw: &RawLigament) -> Result<Beam, TomlError> {
    let number = |value: &Option<Spanned<f64>>, name: &str, limits: &Limits| match value {
        Some(value) => source.number(value, limits),
        None => {
            let help = "a beam between relief bars needs min_length_mm, max_length_mm and root_compliance";
            Err(source.value_error(raw.width_mm.span(), &format!("without {name} beside it"), help))
        }
    };
    Ok(Beam {
        min_length: number(&raw.min_length_mm, "min_length_mm", &FREE_LENGTH)?,
        max_length: number(&raw.max_length_mm, "max_length_mm", &FREE_LENGTH)?,
        root_compliance: number(&raw.root_compliance, "root_compliance", &ROOT_COMPLIANCE)?,
    })
}

/// The rules between numbers. Each is `smaller <= larger`; the caret stands under the value to change first.
fn check_relations(source: &TomlSource, raw: &RawProfile, profile: &Profile) -> Result<(), TomlError> {
    let Profile { sheet, material, cut, ligament, .. } = profile;
    let at_most = |value: &Spanned<f64>, limit: f64, named: &str, help: &str| {
        if *value.get_ref() <= limit {
            return Ok(());
        }
        Err(source.value_error(
            value.span(),
            &format!("too large: allowed is at most {named} = {limit}"),
            help,
        ))
    };
    let half_side = sheet.width.min(sheet.height) / 2.0;
    if sheet.margin >= half_side {
        let what =
            format!("too large: allowed is less than half of the sheet's shorter side, {half_side} mm");
        return Err(source.value_error(
            raw.sheet.margin_mm.span(),
            &what,
            "the margin leaves nothing to cut",
        ));
    }
    let beyond = "a hinge planned for more strain than the material's elongation at break tears";
    at_most(&raw.material.strain_limit, material.elongation, "material.elongation", beyond)?;
    let order = "a material yields before it breaks";
    at_most(&raw.material.yield_strain, material.elongation, "material.elongation", order)?;
    if let Some(endurance) = &raw.material.endurance_strain {
        let order = "strain that yields the material in each cycle does tire it";
        at_most(endurance, material.yield_strain, "material.yield_strain", order)?;
    }
    if let Some(modulus) = &raw.material.conditioned_modulus_mpa {
        let softer = "moisture softens a plastic";
        at_most(modulus, material.youngs_modulus, "material.youngs_modulus_mpa", softer)?;
    }
    if let Some(laser) = &raw.laser {
        let burnt = "a web narrower than the groove beside it burns away: raise laser.min_web_mm";
        at_most(&laser.kerf_mm, cut.min_web, "laser.min_web_mm", burnt)?;
    }
    let web = "the ligament is itself a web between two cuts: raise ligament.width_mm";
    let min_web = raw.laser.as_ref().map(|laser| &laser.min_web_mm);
    let min_web = min_web.or(raw.tool.as_ref().map(|tool| &tool.min_web_mm));
    min_web.map_or(Ok(()), |value| at_most(value, ligament.width, "ligament.width_mm", web))?;
    if let (Shape::Beam(beam) | Shape::Rounded(beam), Some(least)) =
        (ligament.shape, &raw.ligament.min_length_mm)
    {
        let empty = "no free length lies between the two";
        at_most(least, beam.max_length, "ligament.max_length_mm", empty)?;
    }
    Ok(())
}
