//! `kirimorph fabricate`: from a design to the files of `make`.

use std::collections::BTreeMap;
use std::path::Path;

use super::check::{design_file, lay_out, refuse_failing, without_repeated};
use super::cut_keys::CutKeys;
use super::progress::{Reporter, Reporting};
use super::results::{Extras, Leaving, Results, cut_lines, dry_run_lines, outcome, plan};
use super::{Failure, events, interrupt, milled, morphs, print, solids};
use crate::fabrication::product::Product;
use crate::job::{DEFAULT_MACHINE, cut_keys};
use crate::kirigami::quality::{Limits, Quality, measure_alone};
use crate::machine::{self, Machine};
use crate::output::design_json::{self, Origin, parse_report};
use crate::output::folder::OutputFolder;
use crate::output::hinge_report;
use crate::output::report::Seen;
use crate::pipeline::{Clock, Progress, fingerprint};
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
    let (dxf, mut options) = cut_keys(&keys.table(), &mut profile).map_err(Failure::bad_input)?;
    let machine = machine_of(&mut profile, machine)?;
    if !leaving.dry_run {
        OutputFolder::check(leaving.folder).map_err(Failure::bad_input)?;
    }
    interrupt::listen();
    let mut reporter = Reporter::new(reporting);
    let mut watch = |progress: &Progress| {
        reporter.show(progress);
        interrupt::flow()
    };
    let mut clock = Clock::new(&mut watch);
    let product = clock
        .run("fabrication", |_| lay_out(&design, &profile).map(Product::Sheet))
        .map_err(|reason| Failure::NotMakeable(format!("{}: {reason}", file.display())))?;
    refuse_failing(product.hinges(), leaving.allow_failing)?;
    let thick = clock.run("solids", |_| solids::solids(&product, &profile))?;
    let moving = clock.run("morph", |_| morphs::moving(&product, &profile))?;
    let origin = origin(&bytes, &file, &product);
    options.engrave = options.engrave.map(|_| origin.job.clone());
    let plan = plan(&product, &profile, &options, &mut clock)?;
    let mut extras = Extras {
        solids: thick.as_ref(),
        snap: None,
        moving: moving.as_ref(),
        plan: plan.as_ref(),
        milled: None,
        seen: Seen::default(),
    };
    clock.go_on(|| None).map_err(|error| Failure::Interrupted(error.to_string()))?;
    let quality = &origin.quality;
    let figures = figures(&product, quality);
    // The edge that was asked for is no concern of a design that exists.
    let limits = Limits { edge_deviation: f64::INFINITY, ..Limits::default() };
    let mut results = Results {
        name: &origin.job,
        target: &origin.target,
        hashes: &origin.hashes,
        product: &product,
        outcome: &outcome("laid out", product.hinges()),
        extras,
        quality,
        limits: &limits,
        stages: &origin.stages,
        profile: &profile,
        dxf,
        figures: &figures,
    };
    let milled = milled::milled(&results, machine.as_ref(), &options, first_run, &mut clock)?;
    extras.milled = milled.as_ref().zip(machine.as_ref());
    results.extras = extras;
    results.leave(leaving, &mut clock)?;
    drop(reporter);
    if reporting.json {
        events::tell(&event(&product, extras, quality, leaving));
    } else if !reporting.quiet {
        print(&summary(&origin.job, &product, extras, &figures, leaving));
    }
    Ok(())
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

/// Label and value, for the preview and the terminal.
fn figures(product: &Product, quality: &Quality) -> Vec<(String, String)> {
    let hinges = product.hinges();
    let angles = hinges.iter().map(|row| row.angle.to_degrees());
    let (least, most) = angles.fold((f64::INFINITY, 0.0_f64), |(l, m), a| (l.min(a), m.max(a)));
    let tilt = hinges.iter().map(|row| row.tilt.to_degrees()).fold(0.0, f64::max);
    let mut rows = vec![
        ("pieces, hinges", format!("{}, {}", product.design().pieces.len(), hinges.len())),
        ("mean edge", format!("{:.3} mm", quality.mean_edge)),
        ("length error", format!("{:.1e} relative", quality.max_length_error)),
        ("bending", format!("{:.1e} edges", quality.planarity)),
    ];
    if quality.distance_max.is_finite() {
        rows.push(("off the target", format!("{:.3} mm", quality.distance_max)));
    }
    rows.push(("hinge angles", format!("{least:.1} to {most:.1} deg")));
    rows.push(("largest tilt", format!("{tilt:.1} deg")));
    rows.into_iter().map(|(label, value)| (label.to_owned(), value)).collect()
}

fn event(product: &Product, extras: Extras, quality: &Quality, leaving: &Leaving) -> serde_json::Value {
    let Extras { solids: thick, moving, plan, milled, .. } = extras;
    let hinges = hinge_report::summary(product.hinges());
    let figures: BTreeMap<&str, f64> = design_json::figures(quality).into();
    serde_json::json!({
        "event": "result",
        "status": 0,
        "dry_run": leaving.dry_run,
        "folder": leaving.folder(),
        "files": leaving.files(product, extras),
        "pieces": product.design().pieces.len(),
        "hinges": product.hinges().len(),
        "hinges_to_look_at": hinges.as_ref().map_or(0, |summary| summary.warn),
        "max_strain": hinges.as_ref().map(|summary| summary.worst_strain.value),
        "figures": figures,
        "solids": thick.map(solids::event),
        "morph": moving.map(morphs::event),
        "cut": plan.map(|plan| hinge_report::cut_object(&plan.report)),
        "mill": milled.map(|(milled, machine)| milled::object(milled, machine)),
    })
}

fn summary(
    name: &str,
    product: &Product,
    Extras { solids: thick, moving, plan, milled, .. }: Extras,
    figures: &[(String, String)],
    leaving: &Leaving,
) -> String {
    let width = figures.iter().map(|(label, _)| label.len()).max().unwrap_or(0);
    let mut text = format!("{name}: {}\n", outcome("laid out", product.hinges()));
    for (label, value) in figures {
        text += &format!("  {label:<width$}  {value}\n");
    }
    if let Some(summary) = hinge_report::summary(product.hinges()) {
        text += &format!("  {summary}\n");
    }
    if let Some(thick) = thick {
        text += &solids::summary(thick);
    }
    text += &morphs::summary(moving, product.hinges().len());
    text += &milled.map_or_else(|| cut_lines(plan), milled::lines);
    if leaving.dry_run {
        return text + &dry_run_lines(milled);
    }
    text + &format!("Files in {}\n", leaving.folder.display())
}
