//! `kirimorph make`: the main job, its files and its summary.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::check::refuse_failing;
use super::progress::{Reporter, Reporting};
use super::results::{Extras, Leaving, Results, cut_lines, dry_run_lines, no_cut_file, outcome, plan};
use super::{
    Failure, Optimisation, events, interrupt, map, milled, morphs, open_state, partial, print, solids,
};
use crate::fabrication::product::Product;
use crate::fabrication::states::other_name;
use crate::job::{Job, Kind, read_job};
use crate::kirigami::design::State;
use crate::kirigami::quality::{Fit, Quality};
use crate::machine::Machine;
use crate::memory;
use crate::output::folder::{MILL_FILES, OutputFolder};
use crate::output::report::Seen;
use crate::output::{design_json, hinge_report, partial_json, snap_report};
use crate::pipeline::mill::Milled;
use crate::pipeline::{Clock, Made, Progress, limits, make, source_hashes};
use crate::snap::assess::{Snap, assess};

/// Runs the job and writes its results, all or none.
pub fn run(
    job_file: &Path,
    output: Option<PathBuf>,
    [allow_failing, dry_run]: [bool; 2],
    optimisation: &Optimisation,
    reporting: &Reporting,
) -> Result<(), Failure> {
    let job = read_job(job_file).map_err(Failure::bad_input)?;
    let name = job_file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let folder = output.unwrap_or_else(|| Path::new("out").join(&name));
    let leaving = Leaving { folder: &folder, allow_failing, dry_run };
    if !dry_run {
        OutputFolder::check(&folder).map_err(Failure::bad_input)?;
    }
    let hashes = partial::hashes(&job, job_file);
    let unused_partial = !optimisation.resume && folder.join(partial_json::FILE_NAME).exists();
    interrupt::listen();
    let mut reporter = Reporter::new(reporting);
    let mut watch = |progress: &Progress| {
        reporter.show(progress);
        interrupt::flow()
    };
    let mut clock = Clock::new(&mut watch);
    if optimisation.resume {
        clock.journal = partial::journal(&folder, &hashes)?;
    }
    clock.memory = if optimisation.ignore_memory { None } else { memory::free() };
    let made = make(&job, &mut clock).map_err(|error| partial::failure(error, &folder, &hashes))?;
    refuse_failing(made.product.hinges(), allow_failing)?;
    let thick = clock.run("solids", |_| solids::solids(&made.product, &job.fabrication.profile))?;
    let moving = clock.run("morph", |_| morphs::moving(&made.product, &job.fabrication.profile))?;
    let plan = plan(&made.product, &job.fabrication.profile, &job.fabrication.cut, &mut clock)?;
    let input = Input { job: &job, name: &name };
    let snap = snapping(&made, &job, &mut clock);
    let map = map::figure(&job, &mut clock);
    let mut extras = Extras {
        solids: thick.as_ref(),
        snap: snap.as_ref(),
        moving: moving.as_ref(),
        plan: plan.as_ref(),
        milled: None,
        seen: Seen { targets: &made.targets, map: map.as_deref(), morph: None },
    };
    let fabrication = &job.fabrication;
    let (target, hashes, shown) = (input.target_name(), source_hashes(&job, job_file), figures(&made));
    let mut results = Results {
        name: &name,
        target: &target,
        hashes: &hashes,
        product: &made.product,
        outcome: &outcome("made", made.product.hinges()),
        extras,
        quality: &made.quality,
        limits: &limits(&job),
        stages: &made.stages,
        profile: &fabrication.profile,
        dxf: fabrication.dxf,
        figures: &shown,
    };
    let milled = milled::milled(&results, fabrication.machine.as_ref(), &fabrication.cut, 0, &mut clock)?;
    extras.milled = milled.as_ref().zip(fabrication.machine.as_ref());
    results.extras = extras;
    results.leave(&leaving, &mut clock)?;
    drop(reporter);
    if reporting.json {
        events::tell(&result_event(&made, extras, &input, &leaving));
    } else if !reporting.quiet {
        print(&summary(&made, extras, &input, &leaving, unused_partial));
    }
    Ok(())
}

/// With more hinges the way of a whole sheet takes minutes.
const MOST_HINGES: usize = 3000;

/// How a bistable sheet snaps, where it is small enough to be followed.
fn snapping(made: &Made, job: &Job, clock: &mut Clock) -> Option<Snap> {
    let design = made.product.design();
    let followed = matches!(job.pattern.kind, Kind::Bistable(_)) && design.hinges.len() <= MOST_HINGES;
    let assess = || assess(design, made.product.hinges(), &job.fabrication.profile);
    followed.then(|| clock.run("snap", |_| assess()))
}

/// The last event: figures under their names in design.json, and the files.
fn result_event(made: &Made, extras: Extras, input: &Input, leaving: &Leaving) -> serde_json::Value {
    let Extras { solids: thick, snap, moving, plan, milled, .. } = extras;
    let product = &made.product;
    let hinges = hinge_report::summary(product.hinges());
    let figures: BTreeMap<&str, f64> = design_json::figures(&made.quality).into();
    serde_json::json!({
        "event": "result",
        "status": 0,
        "dry_run": leaving.dry_run,
        "folder": leaving.folder(),
        "files": leaving.files(product, extras),
        "snap": snap.map(|snap| snap_report::object(snap, &input.job.fabrication.profile.name)),
        "pieces": product.design().pieces.len(),
        "hinges": product.hinges().len(),
        "hinges_to_look_at": hinges.as_ref().map_or(0, |summary| summary.warn),
        "max_strain": hinges.as_ref().map(|summary| summary.worst_strain.value),
        "figures": figures,
        "closed": design_json::fit_object(&made.quality, State::Closed),
        "open": design_json::fit_object(&made.quality, State::Open),
        "cut_file": matches!(product, Product::Sheet(_)),
        "solids": thick.map(solids::event),
        "morph": moving.map(morphs::event),
        "cut": plan.map(|plan| hinge_report::cut_object(&plan.report)),
        "mill": milled.map(|(milled, machine)| milled::object(milled, machine)),
        "remark": remark(made, input),
    })
}

/// The files that are cut by, and what they are for.
fn cut_words(milled: Option<(&Milled, &Machine)>) -> [String; 2] {
    match milled {
        None => ["cut.dxf, cut.svg".into(), "for the laser; cut on the line, the kerf is applied".into()],
        Some((milled, machine)) => {
            let names = milled.program.files.iter().map(|(name, _)| name.as_str());
            let names: Vec<&str> = names.chain(MILL_FILES).collect();
            [names.join(", "), format!("for {}: program, its picture, set-up sheet", machine.name)]
        }
    }
}

/// What is to be said of a result that has no cut file.
fn remark(made: &Made, input: &Input) -> Option<String> {
    matches!(made.product, Product::Assembly(_)).then(|| no_cut_file(&input.job.fabrication.profile.name))
}

/// What the results were made from.
struct Input<'a> {
    job: &'a Job,
    name: &'a str,
}

impl Input<'_> {
    /// The file names of the target meshes.
    fn target_name(&self) -> String {
        let name = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        self.job.target.meshes().into_iter().map(name).collect::<Vec<_>>().join(", ")
    }
}

/// The figures by which a person judges the result: label and value, short enough for one line of the
/// preview.
fn figures(made: &Made) -> Vec<(String, String)> {
    let Made { product, quality, .. } = made;
    let hinges = product.hinges();
    let angles = hinges.iter().map(|row| row.angle.to_degrees());
    let (least, most) = angles.fold((f64::INFINITY, 0.0_f64), |(l, m), a| (l.min(a), m.max(a)));
    let tilt = hinges.iter().map(|row| row.tilt.to_degrees()).fold(0.0, f64::max);
    let mut rows = vec![
        ("pieces, hinges", format!("{}, {}", product.design().pieces.len(), hinges.len())),
        ("mean edge", format!("{:.3} mm", quality.mean_edge)),
        ("asked edge", format!("{:.3} mm", quality.asked_edge)),
        ("length error", format!("{:.1e} relative", quality.max_length_error)),
        ("bending", format!("{:.1e} edges", quality.planarity)),
    ];
    rows.extend(fit_rows(quality));
    if quality.closed_step_max > 0.0 {
        rows.push(("step at closed hinges", format!("{:.3} mm", quality.closed_step_max)));
    }
    rows.extend([
        ("area expansion", format!("{:.3}", quality.area_expansion)),
        ("target's stretch", format!("{:.3}", quality.stretch_ratio)),
        ("hinge angles", format!("{least:.1} to {most:.1} deg")),
        ("largest tilt", format!("{tilt:.1} deg")),
    ]);
    let rows = rows.into_iter().map(|(label, value)| (label.to_owned(), value));
    rows.chain(open_state::figures(quality)).collect()
}

/// How the design fits its targets: one column, or where both states have a target one for each.
fn fit_rows(quality: &Quality) -> Vec<(&'static str, String)> {
    let cell = std::f64::consts::SQRT_2 * quality.mean_edge;
    let both = |figure: &dyn Fn(&Fit) -> String| match quality.fits.as_slice() {
        [(_, fit)] => figure(fit),
        fits => fits
            .iter()
            .map(|(state, fit)| format!("{} {}", design_json::state_name(*state), figure(fit)))
            .collect::<Vec<_>>()
            .join(", "),
    };
    let both_states = quality.fits.len() > 1;
    let boundary = |fit: &Fit| match fit.held {
        true if both_states => format!("{:.2} mm", fit.boundary_max),
        true => format!("{:.2} mm ({:.2} pieces)", fit.boundary_max, fit.boundary_max / cell),
        false => String::from("free"),
    };
    let mut rows = vec![
        ("off the target", both(&|fit| format!("{:.3} mm", fit.distance_max))),
        ("off, of diagonal", both(&|fit| format!("{:.1e}", fit.distance_max / fit.target_diagonal))),
        ("boundary gap", both(&boundary)),
        ("piece centres off", both(&|fit| format!("{:.3} mm", fit.sagitta_max))),
    ];
    if quality.fits.iter().any(|(_, fit)| !fit.held) {
        rows.push(("area covered", both(&|fit| format!("{:.0} %", 100.0 * fit.covered))));
    }
    rows
}

fn summary(made: &Made, extras: Extras, input: &Input, leaving: &Leaving, unused_partial: bool) -> String {
    let folder = leaving.folder;
    let Extras { solids: thick, snap, moving, plan, milled, .. } = extras;
    let figures = figures(made);
    let width = figures.iter().map(|(label, _)| label.len()).max().unwrap_or(0);
    let hinges = hinge_report::summary(made.product.hinges());
    let mut text = format!("{}: {}\n", input.name, outcome("made", made.product.hinges()));
    for (label, value) in &figures {
        text += &format!("  {label:<width$}  {value}\n");
    }
    if let Some(summary) = hinges {
        text += &format!("  {summary}\n");
    }
    text += &milled.map_or_else(|| cut_lines(plan), milled::lines);
    if let Some(thick) = thick {
        text += &solids::summary(thick);
    }
    text += &morphs::summary(moving, made.product.hinges().len());
    if let Some(snap) = snap {
        let figures = snap_report::figures(snap);
        let width = figures.iter().map(|(label, _)| label.len()).max().unwrap_or(0);
        text += "Snap, by the model of docs/snap.md:\n";
        figures.iter().for_each(|(label, value)| text += &format!("  {label:<width$}  {value}\n"));
    } else if matches!(input.job.pattern.kind, Kind::Bistable(_)) {
        text += &format!(
            "The snap of more than {MOST_HINGES} hinges takes minutes and was left out: kirimorph snap {} -p PROFILE\n",
            folder.join("design.json").display()
        );
    }
    if leaving.dry_run {
        return text + &dry_run_lines(milled);
    }
    if unused_partial {
        text += "The design.partial.json of an interrupted run gave way to this result, made from the beginning.\n";
    }
    text += &format!("Files in {}:\n", folder.display());
    let files = match &made.product {
        Product::Sheet(sheet) => {
            let other = other_name(&sheet.design);
            let [files, words] = cut_words(milled);
            format!(
                "  {files:<26}  {words}\n\
                 \x20 {:<26}  the part as a solid, and its pieces in the {other} state\n",
                format!("part.stl, {other}.stl")
            )
        }
        Product::Assembly(_) => {
            "  pieces-closed.stl, pieces-open.stl   solids of the pieces in both states\n".to_owned()
        }
    };
    text += &files;
    if snap.is_some() {
        text += "  snap.json, snap.svg         energy and torque on the way between the states\n";
    }
    if moving.is_some() {
        text += "  morph.glb                   the pieces on their way between the states, for 3D viewers\n";
    }
    text += "  report.html                 look at this first, in a browser\n\
             \x20 preview.svg                 the same on one page, to print\n\
             \x20 hinges.csv, hinges.json     the hinge placement report\n\
             \x20 design.json, timings.json   the design with its figures, and the times\n";
    if let Some(remark) = self::remark(made, input) {
        text += &format!("{remark}\n");
    }
    text
}
