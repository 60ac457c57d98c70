//! The profile file: its keys, the range of each number with the reason, and the rules between numbers.

use serde::Deserialize;
use toml::Spanned;

use super::machine::{RawMachine, machine};
use super::{Laser, Ligament, Material, Profile, Sheet};
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
const MIN_WEB: Limits = Limits::new(
    0.01,
    50.0,
    "mm",
    "thinner strips burn away; a wider demand than 50 mm leaves no room for pieces",
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
    laser: RawLaser,
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
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawLigament {
    width_mm: Spanned<f64>,
    min_length_mm: Spanned<f64>,
    max_length_mm: Spanned<f64>,
    root_compliance: Spanned<f64>,
}

/// Reads and checks the text of a profile. `name` becomes the profile's name, `file` stands in messages.
///
/// # Errors
/// Syntax, unknown, missing or mistyped keys, numbers that are not finite or out of range, numbers that
/// contradict each other, another version than 1, another process than a laser.
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
    if raw.process.get_ref() != "laser" {
        let help = "this version makes laser-cut sheets only";
        return Err(source.value_error(raw.process.span(), "not supported: allowed is \"laser\"", help));
    }
    let profile = Profile {
        name: name.to_owned(),
        sheet: sheet(&source, &raw.sheet)?,
        material: material(&source, &raw.material)?,
        laser: laser(&source, &raw.laser)?,
        ligament: ligament(&source, &raw.ligament)?,
        machine: raw.machine.as_ref().map(|raw| machine(&source, raw)).transpose()?,
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
        endurance_strain: source.optional(raw.endurance_strain.as_ref(), &ENDURANCE_STRAIN)?,
        coffin_manson,
    })
}

fn laser(source: &TomlSource, raw: &RawLaser) -> Result<Laser, TomlError> {
    Ok(Laser {
        kerf: source.number(&raw.kerf_mm, &KERF)?,
        min_web: source.number(&raw.min_web_mm, &MIN_WEB)?,
        cutting_speed: source.number(&raw.cutting_speed_mm_per_s, &CUTTING_SPEED)?,
    })
}

fn ligament(source: &TomlSource, raw: &RawLigament) -> Result<Ligament, TomlError> {
    Ok(Ligament {
        width: source.number(&raw.width_mm, &LIGAMENT_WIDTH)?,
        min_length: source.number(&raw.min_length_mm, &FREE_LENGTH)?,
        max_length: source.number(&raw.max_length_mm, &FREE_LENGTH)?,
        root_compliance: source.number(&raw.root_compliance, &ROOT_COMPLIANCE)?,
    })
}

/// The rules between numbers. Each is `smaller <= larger`; the caret stands under the value to change first.
fn check_relations(source: &TomlSource, raw: &RawProfile, profile: &Profile) -> Result<(), TomlError> {
    let Profile { sheet, material, laser, ligament, .. } = profile;
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
    let burnt = "a web narrower than the groove beside it burns away: raise laser.min_web_mm";
    at_most(&raw.laser.kerf_mm, laser.min_web, "laser.min_web_mm", burnt)?;
    let web = "the ligament is itself a web between two cuts: raise ligament.width_mm";
    at_most(&raw.laser.min_web_mm, ligament.width, "ligament.width_mm", web)?;
    let empty = "no free length lies between the two";
    at_most(&raw.ligament.min_length_mm, ligament.max_length, "ligament.max_length_mm", empty)
}
