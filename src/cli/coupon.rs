//! `kirimorph coupon`: a test piece that tells the kerf and the ligaments that a machine really makes.

use std::path::{Path, PathBuf};

use super::results::WriteError;
use super::{Failure, print};
use crate::fabrication::coupon::{Coupon, Measure, coupon};
use crate::output::dxf::{self, DxfVersion};
use crate::output::folder::OutputFolder;
use crate::output::svg;
use crate::profile::{self, Process, Profile};
use crate::verify::{Files, faults, verify_coupon};

/// What is written.
const FILES: [&str; 3] = ["coupon.dxf", "coupon.svg", "coupon.txt"];

/// The flags.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// A profile's name or file.
    #[arg(short, long)]
    profile: String,
    /// Folder for the files [default: out/coupon-PROFILE].
    #[arg(short, long)]
    output: Option<PathBuf>,
}

/// Writes the coupon's files and prints how to measure it.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let profile = profile::load(&arguments.profile, Path::new(".")).map_err(Failure::bad_input)?;
    if profile.process == Process::Milling {
        return Err(Failure::BadInput(format!(
            "the profile {} is for milling, and the coupon tells a laser's kerf: measure the tool, or take a profile for a laser",
            profile.name
        )));
    }
    let folder =
        arguments.output.clone().unwrap_or_else(|| Path::new("out").join(format!("coupon-{}", profile.name)));
    let coupon = coupon(&profile).map_err(|error| Failure::NotMakeable(error.to_string()))?;
    let steps = steps(&coupon, &profile);
    let found = leave(&coupon, &profile, &steps, &folder)
        .map_err(|error| Failure::BadInput(format!("cannot write the coupon: {error}")))?;
    if !found.is_empty() {
        return Err(Failure::NotMakeable(format!(
            "the coupon's files are wrong, so none was left:\n{found}"
        )));
    }
    print(&format!("{steps}Files in {}: {}\n", folder.display(), FILES.join(", ")));
    Ok(())
}

/// Writes the files, reads them back and leaves them, unless something is wrong with them, which is returned.
fn leave(coupon: &Coupon, profile: &Profile, steps: &str, folder: &Path) -> Result<String, WriteError> {
    use std::io::Write;
    let out = OutputFolder::create_of(folder, |name| FILES.contains(&name))?;
    let comments = [
        format!("kirimorph {}, test coupon for profile {}", env!("CARGO_PKG_VERSION"), profile.name),
        format!("millimetres; kerf {} mm already applied: cut on the line", profile.cut.kerf),
    ];
    out.write::<WriteError>(FILES[0], |file| {
        Ok(dxf::write(&coupon.layout, DxfVersion::R2000, &comments, file)?)
    })?;
    out.write::<WriteError>(FILES[1], |file| Ok(svg::write(&coupon.layout, &comments, file)?))?;
    out.write::<WriteError>(FILES[2], |file| Ok(file.write_all(steps.as_bytes())?))?;
    let [dxf, svg] = [out.read(FILES[0])?, out.read(FILES[1])?];
    let wrong = verify_coupon(Files { dxf: &dxf, svg: &svg }, &coupon.features, profile)?;
    if wrong.is_empty() {
        out.finish()?;
    }
    Ok(faults(&wrong, usize::MAX))
}

/// How to measure it, and where the result goes.
fn steps(coupon: &Coupon, profile: &Profile) -> String {
    let kerf = profile.cut.kerf;
    let [width, height] = coupon.size;
    let list = |measure: Measure| {
        let mut features: Vec<_> =
            coupon.features.iter().filter(|feature| feature.measure == measure).collect();
        features.dedup_by(|a, b| a.name == b.name);
        let texts: Vec<String> =
            features.iter().map(|feature| format!("{} {:.3}", feature.name, feature.nominal)).collect();
        texts.join(", ")
    };
    format!(
        "Coupon for {}, drawn for a kerf of {kerf} mm.\n\
         Cut it from the stock that you will use, as you will cut it.\n\
         1. Kerf. Measure the sides of the holes (mm: {})\n\
         \x20  and the outside ({width:.3} x {height:.3}) with a caliper, in x and y, each in three places.\n\
         \x20  True kerf = {kerf} + (measured - nominal) of a hole,\n\
         \x20  and = {kerf} + (nominal - measured) of the outside. Take the mean of all.\n\
         2. Check. The slots (mm: {}) take feeler gauges\n\
         \x20  up to their width plus the kerf's error; S1 is one groove. If x and y differ by more than 0.02 mm,\n\
         \x20  have the machine's beam and axes adjusted first.\n\
         3. Ligaments (mm: {}).\n\
         \x20  Measure each under a microscope at its narrowest: nominal less (true kerf - {kerf}) is right.\n\
         \x20  Note the narrowest that is whole on both sides and not discoloured through.\n\
         4. Bend the flaps as far as your hinges turn. Note the narrowest that holds.\n\
         Enter the true kerf as [laser] kerf_mm of the profile (or [fabrication] kerf_mm of one job), the narrowest\n\
         whole ligament as [laser] min_web_mm, and one that holds, or wider, as [ligament] width_mm. Then cut the\n\
         coupon again: all should be nominal within 0.01 mm.\n",
        profile.name,
        list(Measure::Hole),
        list(Measure::Slot),
        list(Measure::Ligament),
    )
}
