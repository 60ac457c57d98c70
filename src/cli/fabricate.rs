//! `kirimorph fabricate`: from a design to the files of `make`.

use std::collections::BTreeMap;
use std::path::Path;

use super::check::{design_file, lay_out, without_repeated};
use super::cut_keys::CutKeys;
use super::progress::{Reporting, watched};
use super::results::{self, Extras, Leaving, Results, cut_lines, dry_run_lines, event, head, outcome};
use super::{Failure, events, figures, milled, morphs, print, solids};
use crate::fabrication::plan::CutOptions;
use crate::fabrication::product::Product;
use crate::job::{DEFAULT_MACHINE, cut_keys};
use crate::kirigami::quality::{Limits, Quality, measure_alone};
use crate::machine::{self, Machine};
use crate::output::design_json::{self, Origin, Provenance, parse_report};
use crate::output::dxf::DxfVersion;
use crate::output::report::Seen;
use crate::pipeline::{Clock, fingerprint};
use crate::profile::{self, Process, Profile};

/// Lays a design out and writes the results, all or none.
pub fn run(
    design: &Path,
    profile: &str,
    leaving: &Leaving,
    keys: &CutKeys,
    (machine, first_run): (Option<&str>, usize),
    reporting: &Reporting,
) -> Result<(), Failure> {
    let file = design_file(design);
    let bytes = design_json::read_bytes(&file).map_err(Failure::bad_input)?;
    let design = design_json::parse(&bytes)
        .map_err(|error| Failure::BadInput(format!("{}: {error}", file.display())))?;
    let design = without_repeated(design);
    let mut profile = profile::load(profile, Path::new(".")).map_err(Failure::bad_input)?;
    let (dxf, options) = cut_keys(&keys.table(), &mut profile).map_err(Failure::bad_input)?;
    let machine = machine_of(&mut profile, machine)?;
    leaving.check()?;
    let order =
        Order { profile: &profile, dxf, options, machine: machine.as_ref(), first_run, leaving: *leaving };
    let (product, origin, extras) = watched(reporting, |clock| {
        let product = clock
            .run("fabrication", |_| lay_out(&design, &profile).map(Product::Sheet))
            .map_err(|reason| Failure::NotMakeable(format!("{}: {reason}", file.display())))?;
        let origin = origin(&bytes, &file, &product);
        let extras = order.finish(&product, &origin, clock)?;
        Ok((product, origin, extras))
    })?;
    if reporting.json {
        events::tell(&event(&product, &origin.quality, &extras, leaving));
    } else if !reporting.quiet {
        print(&summary(&product, &origin, &extras, leaving));
    }
    Ok(())
}

/// What is to be made of a design.
struct Order<'a> {
    profile: &'a Profile,
    dxf: DxfVersion,
    options: CutOptions,
    machine: Option<&'a Machine>,
    /// Of the milling program, from 0.
    first_run: usize,
    leaving: Leaving<'a>,
}

impl<'a> Order<'a> {
    /// Everything that is made of the laid-out design, and the files.
    fn finish(&self, product: &Product, origin: &Origin, clock: &mut Clock) -> Result<Extras<'a>, Failure> {
        let Self { profile, dxf, machine, first_run, leaving, .. } = *self;
        // A part is engraved with the name of its own job.
        let engrave = self.options.engrave.as_ref().map(|_| origin.job.clone());
        let options = CutOptions { engrave, ..self.options.clone() };
        let mut extras = Extras::new(product, profile, &options, machine, leaving.allow_failing, clock)?;
        clock.go_on(|| None).map_err(|error| Failure::Interrupted(error.to_string()))?;
        let Origin { job, target, hashes, quality, stages } = origin;
        let file = results::design_file(product, quality, stages, Provenance { job, target, hashes });
        extras.milled = milled::milled((product, &file), &extras, profile, &options, first_run, clock)?;
        let results = Results {
            file,
            product,
            outcome: &outcome("laid out", product.hinges()),
            extras: &extras,
            seen: Seen::default(),
            // The edge that was asked for is no concern of a design that exists.
            limits: &Limits { edge_deviation: f64::INFINITY, ..Limits::default() },
            profile,
            dxf,
            figures: &figures::of_layout(product, quality),
        };
        results.leave(&leaving, clock)?;
        Ok(extras)
    }
}

/// The machine that mills a sheet; the profile's walls stand as it can cut them.
fn machine_of(profile: &mut Profile, name: Option<&str>) -> Result<Option<Machine>, Failure> {
    if profile.process == Process::Laser {
        return match name {
            None => Ok(None),
            Some(_) => Err(Failure::BadInput(format!(
                "--machine is for milling, and the profile {} for a laser: leave it out",
                profile.name
            ))),
        };
    }
    let machine =
        machine::load(name.unwrap_or(DEFAULT_MACHINE), Path::new(".")).map_err(Failure::bad_input)?;
    profile.cut.ruled &= machine.follows_axes();
    Ok(Some(machine))
}

/// What the design tells of itself, with the figures of the coordinates that are written and the design's own hash.
fn origin(bytes: &[u8], file: &Path, product: &Product) -> Origin {
    let mut origin = parse_report(bytes).unwrap_or_else(|| unknown_origin(file, product));
    origin.quality = measured_anew(&origin.quality, product);
    origin.hashes.insert("design".to_owned(), fingerprint(bytes));
    origin
}

/// Of a design without a report of ours: its file's name, and its own measures.
fn unknown_origin(file: &Path, product: &Product) -> Origin {
    Origin {
        job: file.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        target: "unknown".to_owned(),
        hashes: BTreeMap::new(),
        quality: measure_alone(product.design()),
        stages: Vec::new(),
    }
}

/// What compares with the target stays as it was reported; the rest is measured on the coordinates that are written.
fn measured_anew(reported: &Quality, product: &Product) -> Quality {
    let own = measure_alone(product.design());
    Quality {
        e_isom: own.e_isom,
        max_length_error: own.max_length_error,
        planarity: own.planarity,
        mean_edge: own.mean_edge,
        closed_step_max: own.closed_step_max,
        ..reported.clone()
    }
}

fn summary(product: &Product, origin: &Origin, extras: &Extras, leaving: &Leaving) -> String {
    let Extras { solids: thick, moving, plan, .. } = extras;
    let (hinges, milled) = (product.hinges(), extras.milled());
    let figures = figures::of_layout(product, &origin.quality);
    let mut text = head(&origin.job, &outcome("laid out", hinges), &figures, hinges);
    text += &thick.as_ref().map(solids::summary).unwrap_or_default();
    text += &morphs::summary(moving.as_ref(), hinges.len());
    text += &milled.map_or_else(|| cut_lines(plan.as_ref()), milled::lines);
    if leaving.dry_run {
        return text + &dry_run_lines(milled);
    }
    text + &format!("Files in {}\n", leaving.folder.display())
}
