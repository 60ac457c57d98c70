//! `kirimorph verify` of a milled sheet: the program read back and milled on paper, held against `part.stl`.

use std::path::Path;

use kurbo::{Point, Vec2};
use serde::Deserialize;

use super::Failure;
use crate::fabrication::fabricate::ligament_lengths;
use crate::fabrication::mechanics::pole_offset;
use crate::geometry::mesh::TriMesh;
use crate::geometry::read::{MeshFormat, parse_mesh};
use crate::kirigami::design::{Design, State};
use crate::machine;
use crate::milling::path::Tab;
use crate::milling::sweep::finding::Finding;
use crate::milling::sweep::{Figures, Neck, Wanted};
use crate::output::folder::PART;
use crate::output::whole_file::read_regular;
use crate::pipeline::mill::{copied, measure};
use crate::profile::Profile;

/// The `mill` block of `hinges.json`, as far as it is needed.
#[derive(Debug, Deserialize)]
pub struct Told {
    machine: String,
    #[serde(default)]
    first_run: usize,
    files: Vec<String>,
    tabs: Vec<ToldTab>,
}

#[derive(Debug, Deserialize)]
struct ToldTab {
    at_mm: [f64; 2],
    reach_mm: f64,
    top_mm: f64,
}

/// What the program is held against.
pub struct Sheet<'a> {
    /// The design as it lies on the sheet, and the hash of its file.
    pub design: &'a Design,
    /// The hash of its file.
    pub hash: &'a str,
    /// The profile as it was applied.
    pub profile: &'a Profile,
    /// Where the copies lie.
    pub copies: &'a [Vec2],
}

/// What was measured, as text, and what is wrong.
///
/// # Errors
/// Files that cannot be read or are another design's, a machine or profile that does not fit them.
pub fn measured(
    folder: &Path,
    told: &Told,
    machine: Option<&str>,
    sheet: &Sheet,
) -> Result<(String, Vec<Finding>), Failure> {
    let profile = sheet.profile;
    let Some(tool) = &profile.tool else {
        let says =
            "is not for milling, but the folder holds a milling program: name the right one with --profile";
        return Err(Failure::BadInput(format!("the profile {} {says}", profile.name)));
    };
    let machine = machine::load(machine.unwrap_or(&told.machine), Path::new(".")).map_err(|error| {
        Failure::BadInput(format!("{error}; if it is a file of yours, name it with --machine"))
    })?;
    let files = programs(folder, &told.files, sheet.hash)?;
    let part = copied(&part(folder)?, sheet.copies);
    let necks = necks(sheet, machine.follows_axes());
    let tabs: Vec<Tab> = told
        .tabs
        .iter()
        .map(|tab| Tab { at: Point::new(tab.at_mm[0], tab.at_mm[1]), reach: tab.reach_mm, top: tab.top_mm })
        .collect();
    let wanted = Wanted {
        part: &part,
        copies: sheet.copies.len(),
        necks: &necks,
        stock: [profile.sheet.width, profile.sheet.height],
        thickness: profile.sheet.thickness,
        radius: 0.5 * profile.cut.kerf,
        tool,
        tabs: &tabs,
    };
    let (figures, findings) = measure(&files, told.first_run, &machine, &wanted)
        .map_err(|error| Failure::BadInput(format!("{}: {error}", folder.display())))?;
    let (names, folder) = (told.files.join(", "), folder.display());
    Ok((format!("{folder}: {names} on {}\n{}", machine.name, table(&figures)), findings))
}

/// The files of the program, each with its name; they must be of the design whose hash this is.
fn programs(folder: &Path, names: &[String], hash: &str) -> Result<Vec<(String, String)>, Failure> {
    let read = |name: &String| {
        let file = folder.join(name);
        // A name from a file is no path.
        let plain = Path::new(name).file_name().is_some_and(|plain| plain.to_str() == Some(name));
        let text = if plain {
            read_regular(&file).and_then(|bytes| String::from_utf8(bytes).map_err(std::io::Error::other))
        } else {
            Err(std::io::ErrorKind::InvalidInput.into())
        };
        let text = text.map_err(|error| {
            Failure::BadInput(format!("{} cannot be read: {error}; make the files again", file.display()))
        })?;
        if !text.contains(hash) {
            return Err(Failure::NotMakeable(format!(
                "{}: was made from another design than design.json, whose hash is {hash}; make the files again",
                file.display()
            )));
        }
        Ok((name.clone(), text))
    };
    names.iter().map(read).collect()
}

/// The finished part that the folder holds.
fn part(folder: &Path) -> Result<TriMesh, Failure> {
    let file = folder.join(PART);
    let bad =
        |reason: String| Failure::BadInput(format!("{}: {reason}; make the files again", file.display()));
    let bytes = read_regular(&file).map_err(|error| bad(error.to_string()))?;
    let mesh = parse_mesh(&bytes, MeshFormat::Stl).map_err(|error| bad(error.to_string()))?;
    let faces = mesh.faces.iter().filter_map(|face| <[usize; 3]>::try_from(face.as_slice()).ok()).collect();
    Ok(TriMesh { vertices: mesh.vertices, faces })
}

/// The ligaments that the design asks for.
fn necks(sheet: &Sheet, follows: bool) -> Vec<Neck> {
    let Sheet { design, profile, copies, .. } = *sheet;
    let closed = design.sheet_state == Some(State::Closed);
    let lengths = ligament_lengths(design, profile).unwrap_or_default();
    // Hinges that are closer together than ligaments and grooves need cannot have them on their points.
    let told = if closed { (0.5 * (profile.hinge_gap() - design.gap)).max(0.0) } else { 0.0 };
    let neck = |id: usize| {
        let hinge = &design.hinges[id];
        let lean = if follows { Vec2::new(hinge.axis.x, hinge.axis.y) / hinge.axis.z } else { Vec2::ZERO };
        let pole = lengths.get(id).map_or(0.0, |&length| pole_offset(profile, length, hinge.angle));
        let at = Point::new(hinge.point.x, hinge.point.y);
        Neck {
            id,
            at,
            lean,
            width: profile.ligament.width,
            beside: if closed { pole.abs() } else { 0.0 },
            told,
        }
    };
    (0..design.hinges.len()).flat_map(|id| copies.iter().map(move |by| neck(id).moved(*by))).collect()
}

fn table(figures: &Figures) -> String {
    let Figures { gouge, leftover, widths, centre, rapid, shank, moves, cut, loose, .. } = figures;
    let rows = [
        ("moves", format!("{moves}, {:.1} m in the material", 1e-3 * cut)),
        ("into the part", format!("{gouge:.4} mm")),
        ("left on walls", format!("{leftover:.4} mm")),
        ("ligaments", format!("{:.4} to {:.4} mm wide at any depth", widths[0], widths[1])),
        ("off their axes", format!("{centre:.4} mm at any depth")),
        ("rapid moves", format!("at least {rapid:.2} mm above the stock")),
        ("shank, holder", format!("at least {shank:.2} mm above the stock")),
        ("loose scraps", format!("{loose} before the border")),
    ];
    rows.into_iter().map(|(label, value)| format!("  {label:<14}  {value}\n")).collect()
}

/// The first `shown` of what is wrong.
pub fn list(findings: &[Finding], shown: usize) -> String {
    let mut lines: Vec<String> = findings.iter().take(shown).map(|finding| format!("  {finding}")).collect();
    if findings.len() > shown {
        lines.push(format!("  and {} more: add --all", findings.len() - shown));
    }
    lines.join("\n")
}
