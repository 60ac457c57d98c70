//! `kirimorph verify`: the cut files of a folder, read back and measured.

use std::path::Path;

use kurbo::{Point, Vec2};
use serde::Deserialize;

use super::progress::{Reporter, Reporting};
use super::verify_mill::{self, Sheet};
use super::{Failure, print};
use crate::fabrication::layout::Tabs;
use crate::output::design_json;
use crate::output::whole_file::read_regular;
use crate::pipeline::fingerprint;
use crate::profile::{self, Profile};
use crate::verify::{self, Files, ONE_PART, Wanted};

/// How many faults of one check are printed, unless all are asked for.
const SHOWN: usize = 10;

/// Prints what was measured; an error names what is wrong.
pub fn run(folder: &Path, profile: Option<&str>, machine: Option<&str>, all: bool) -> Result<(), Failure> {
    let mut reporter = Reporter::new(&Reporting::default());
    reporter.say("verify: reading the files");
    let file = folder.join("design.json");
    let bytes = design_json::read_bytes(&file).map_err(Failure::bad_input)?;
    let design = design_json::parse(&bytes)
        .map_err(|error| Failure::BadInput(format!("{}: {error}", file.display())))?;
    if design.sheet_state.is_none() {
        let says = "neither state of this design is flat, so it has no cut files to verify";
        return Err(Failure::BadInput(format!("{}: {says}", file.display())));
    }
    let Applied { profile, copies, tabs, mill } = applied(folder, profile)?;
    let shown = if all { usize::MAX } else { SHOWN };
    let hash = fingerprint(&bytes);
    if let Some(told) = &mill {
        reporter.say("verify: milling on paper");
        let sheet = Sheet { design: &design, hash: &hash, profile: &profile, copies: &copies };
        let (table, findings) = verify_mill::measured(folder, told, machine, &sheet)?;
        drop(reporter);
        print(&table);
        let list = verify_mill::list(&findings, shown);
        return judged(folder, findings.len(), "in the program; do not run it", &list);
    }
    let [dxf, svg] = [read(&folder.join("cut.dxf"))?, read(&folder.join("cut.svg"))?];
    let wanted =
        Wanted { design: &design, profile: &profile, hash: &hash, copies: &copies, tabs: tabs.as_ref() };
    reporter.say("verify: cutting on paper");
    let verified = verify::verify(Files { dxf: &dxf, svg: &svg }, wanted)
        .map_err(|error| Failure::BadInput(format!("{}: {error}", folder.display())))?;
    drop(reporter);
    if let Some(figures) = &verified.figures {
        print(&format!(
            "{}: {} pieces, {} hinges, profile {}, kerf {} mm\n{}",
            folder.display(),
            design.pieces.len(),
            design.hinges.len(),
            profile.name,
            profile.cut.kerf,
            verify::table(figures, wanted)
        ));
    }
    let list = verify::faults(&verified.faults, shown);
    judged(folder, verified.faults.len(), "in the cut files; do not cut them", list.trim_end())
}

/// An error where there are faults: how many, where, and their list.
fn judged(folder: &Path, count: usize, place: &str, list: &str) -> Result<(), Failure> {
    let folder = folder.display();
    match count {
        0 => Ok(()),
        1 => Err(Failure::NotMakeable(format!("{folder}: 1 fault {place}\n{list}"))),
        _ => Err(Failure::NotMakeable(format!("{folder}: {count} faults {place}\n{list}"))),
    }
}

fn read(file: &Path) -> Result<Vec<u8>, Failure> {
    read_regular(file).map_err(|error| {
        Failure::BadInput(format!("{} cannot be read: {error}; make the files again", file.display()))
    })
}

/// What `hinges.json` tells of the profile: its name, and what a job may have put in place of its own numbers.
#[derive(Deserialize)]
struct Told {
    profile: String,
    kerf_mm: f64,
    sheet_mm: Option<[f64; 2]>,
    cut: Option<ToldCut>,
    mill: Option<verify_mill::Told>,
}

/// How the sheet is cut.
#[derive(Deserialize)]
struct ToldCut {
    copies_mm: Vec<[f64; 2]>,
    tabs: Option<ToldTabs>,
}

/// What holds the part.
#[derive(Deserialize)]
struct ToldTabs {
    width_mm: f64,
    places_mm: Vec<[f64; 2]>,
}

/// What the files were made for.
struct Applied {
    profile: Profile,
    copies: Vec<Vec2>,
    tabs: Option<Tabs>,
    mill: Option<verify_mill::Told>,
}

/// The profile, with the kerf and the stock that the files were made for, and where the copies lie.
fn applied(folder: &Path, name: Option<&str>) -> Result<Applied, Failure> {
    let file = folder.join("hinges.json");
    let applied = match read_regular(&file) {
        Ok(bytes) => Some(serde_json::from_slice::<Told>(&bytes).map_err(|error| {
            Failure::BadInput(format!("{}: {error}; make the files again, or give --profile", file.display()))
        })?),
        Err(error) if name.is_none() => {
            let says = format!("{} cannot be read: {error}; name the profile with --profile", file.display());
            return Err(Failure::BadInput(says));
        }
        Err(_) => None,
    };
    let name = name.or(applied.as_ref().map(|applied| applied.profile.as_str())).unwrap_or_default();
    let mut profile = profile::load(name, Path::new(".")).map_err(|error| {
        Failure::BadInput(format!("{error}; if it is a file of yours, name it with --profile"))
    })?;
    let (mut copies, mut tabs, mut mill) = (ONE_PART.to_vec(), None, None);
    if let Some(Told { kerf_mm, sheet_mm, cut, mill: told, .. }) = applied {
        mill = told;
        let [width, height] = sheet_mm.unwrap_or([profile.sheet.width, profile.sheet.height]);
        if ![kerf_mm, width, height].iter().all(|size| size.is_finite() && *size > 0.0) {
            let says = "kerf_mm and sheet_mm must be above 0; make the files again";
            return Err(Failure::BadInput(format!("{}: {says}", file.display())));
        }
        profile.cut.kerf = kerf_mm;
        (profile.sheet.width, profile.sheet.height) = (width, height);
        if let Some(cut) = cut {
            copies = cut.copies_mm.into_iter().map(|[x, y]| Vec2::new(x, y)).collect();
            tabs = cut.tabs.map(|ToldTabs { width_mm, places_mm }| Tabs {
                places: places_mm.into_iter().map(|[x, y]| Point::new(x, y)).collect(),
                width: width_mm,
            });
        }
        if copies.is_empty() || !copies.iter().all(|by| by.is_finite()) {
            let says = "cut.copies_mm must hold a place for every copy; make the files again";
            return Err(Failure::BadInput(format!("{}: {says}", file.display())));
        }
    }
    Ok(Applied { profile, copies, tabs, mill })
}
