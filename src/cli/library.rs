//! `kirimorph profiles` and `kirimorph machines`: what is built in and in the user's folder.

use std::path::Path;

use super::table::table;
use super::{Failure, print};
use crate::machine::profile::{Dialect, Machine, Table};
use crate::profile::{Ligament, Process, Profile, Shape};
use crate::toml_source::{ShelfError, TomlFile};
use crate::{machine, profile};

/// Lists the profiles, or prints one as it can be copied.
pub fn profiles(name: Option<&str>) -> Result<(), Failure> {
    let here = Path::new(".");
    let Some(name) = name else {
        let headings = ["profile", "material", "sheet, mm", "process", "ligament, mm", "from"];
        return list(headings, &profile::names(), |name| {
            Ok(profile_row(&profile::load(name, here)?, &profile::source(name, here)?))
        });
    };
    print(&profile::source(name, here).map_err(Failure::bad_input)?.text);
    Ok(())
}

/// Lists the machines, or prints one as it can be copied.
pub fn machines(name: Option<&str>) -> Result<(), Failure> {
    let here = Path::new(".");
    let Some(name) = name else {
        let headings = ["machine", "control", "table", "tool's tip held by", "from"];
        return list(headings, &machine::names(), |name| {
            Ok(machine_row(&machine::load(name, here)?, &machine::source(name, here)?))
        });
    };
    print(&machine::source(name, here).map_err(Failure::bad_input)?.text);
    Ok(())
}

/// Prints a row for every name; files of the user's folder that cannot be used are told after all the others.
fn list<const N: usize>(
    headings: [&str; N],
    names: &[String],
    row: impl Fn(&str) -> Result<[String; N], ShelfError>,
) -> Result<(), Failure> {
    let (mut rows, mut faults) = (Vec::new(), Vec::new());
    for name in names {
        match row(name) {
            Ok(row) => rows.push(row),
            Err(error) => faults.push(error.to_string()),
        }
    }
    print(&table(headings, &rows));
    if faults.is_empty() { Ok(()) } else { Err(Failure::BadInput(faults.join("\n"))) }
}

fn profile_row(profile: &Profile, file: &TomlFile) -> [String; 6] {
    let sheet = &profile.sheet;
    let kerf = profile.cut.kerf;
    [
        profile.name.clone(),
        profile.material.name.clone(),
        format!("{} x {} x {}", sheet.width, sheet.height, sheet.thickness),
        match profile.process {
            Process::Laser => format!("laser, kerf {kerf} mm"),
            Process::Milling => format!("milling, tool {kerf} mm"),
        },
        ligament_words(&profile.ligament),
        from(file),
    ]
}

fn ligament_words(ligament: &Ligament) -> String {
    let width = ligament.width;
    match ligament.shape {
        Shape::Beam(beam) => format!("beam, {width} wide, {} to {} long", beam.min_length, beam.max_length),
        Shape::Rounded(beam) => {
            format!("rounded, {width} wide, {} to {} long", beam.min_length, beam.max_length)
        }
        Shape::Notch { extra_length } => format!("notch, {width} wide, drawn out by {extra_length}"),
    }
}

fn machine_row(machine: &Machine, file: &TomlFile) -> [String; 5] {
    let control = match machine.dialect {
        Dialect::LinuxCnc => "LinuxCNC",
        Dialect::FanucAngles => "Fanuc, angles",
        Dialect::FanucVectors => "Fanuc, vectors",
        Dialect::HeidenhainTcpm => "Heidenhain, TCPM",
        Dialect::HeidenhainM128 => "Heidenhain, M128",
        Dialect::SiemensAngles => "Siemens, angles",
        Dialect::SiemensVectors => "Siemens, vectors",
        Dialect::Haas => "Haas",
    };
    let (axes, tip) = match machine.rotary.as_ref().map(|rotary| rotary.table) {
        Some(table) => (axes(table), if machine.tcp { "the control" } else { "nobody: joints, G93" }),
        None => ("three axes".to_owned(), "(walls upright)"),
    };
    [machine.name.clone(), control.to_owned(), axes, tip.to_owned(), from(file)]
}

fn axes(table: Table) -> String {
    let [tilts, turns] = table.letters();
    format!("{turns} on {tilts}")
}

fn from(file: &TomlFile) -> String {
    file.path.as_ref().map_or("built in".to_owned(), |path| path.display().to_string())
}
