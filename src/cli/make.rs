//! `kirimorph make`: the main job, its files and its summary.

use std::path::{Path, PathBuf};

use super::partial::Resumable;
use super::progress::{Reporting, watched};
use super::results::{
    Extras, Leaving, Results, cut_lines, design_file, dry_run_lines, event, head, no_cut_file, outcome,
};
use super::table::labelled;
use super::{Failure, Optimisation, events, figures, map, milled, morphs, print, solids};
use crate::fabrication::product::Product;
use crate::fabrication::states::other_name;
use crate::job::{Fabrication, Job, Kind, read_job};
use crate::kirigami::design::State;
use crate::machine::Machine;
use crate::output::design_json::{self, Provenance};
use crate::output::folder::MILL_FILES;
use crate::output::report::Seen;
use crate::output::{partial_json, snap_report};
use crate::pipeline::mill::Milled;
use crate::pipeline::{Clock, Made, limits, make, source_hashes};
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
    leaving.check()?;
    let input = Input { job: &job, file: job_file, name: &name };
    let unused_partial = !optimisation.resume && folder.join(partial_json::FILE_NAME).exists();
    let partial = Resumable::new(&job, job_file, &folder);
    let (made, extras) = watched(reporting, |clock| {
        partial.begin(optimisation, clock)?;
        let made = make(&job, clock).map_err(|error| partial.failure(error))?;
        let extras = finish(&made, &input, &leaving, clock)?;
        Ok((made, extras))
    })?;
    if reporting.json {
        events::tell(&result_event(&made, &extras, &input, &leaving));
    } else if !reporting.quiet {
        print(&summary(&made, &extras, &input, &leaving, unused_partial));
    }
    Ok(())
}

/// Everything that is made of a job besides, and the files.
fn finish<'a>(
    made: &Made,
    input: &Input<'a>,
    leaving: &Leaving,
    clock: &mut Clock,
) -> Result<Extras<'a>, Failure> {
    let (job, product) = (input.job, &made.product);
    let Fabrication { profile, dxf, cut, machine } = &job.fabrication;
    let mut extras = Extras::new(product, profile, cut, machine.as_ref(), leaving.allow_failing, clock)?;
    extras.snap = snapping(made, job, clock);
    let map = map::figure(job, clock);
    let (target, hashes) = (input.target_name(), source_hashes(job, input.file));
    let provenance = Provenance { job: input.name, target: &target, hashes: &hashes };
    let file = design_file(product, &made.quality, &made.stages, provenance);
    extras.milled = milled::milled((product, &file), &extras, profile, cut, 0, clock)?;
    let results = Results {
        file,
        product,
        outcome: &outcome("made", product.hinges()),
        extras: &extras,
        seen: Seen { targets: &made.targets, map: map.as_deref(), morph: None },
        limits: &limits(job),
        profile,
        dxf: *dxf,
        figures: &figures::of_job(product, &made.quality),
    };
    results.leave(leaving, clock)?;
    Ok(extras)
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

/// The last event: what `fabricate` tells, and how the design fits its targets and snaps.
fn result_event(made: &Made, extras: &Extras, input: &Input, leaving: &Leaving) -> serde_json::Value {
    let mut event = event(&made.product, &made.quality, extras, leaving);
    let profile = &input.job.fabrication.profile.name;
    event["snap"] = extras.snap.as_ref().map(|snap| snap_report::object(snap, profile)).into();
    event["closed"] = design_json::fit_object(&made.quality, State::Closed);
    event["open"] = design_json::fit_object(&made.quality, State::Open);
    event["cut_file"] = matches!(made.product, Product::Sheet(_)).into();
    event["remark"] = remark(made, input).into();
    event
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
    /// The job's own.
    file: &'a Path,
    name: &'a str,
}

impl Input<'_> {
    /// The file names of the target meshes.
    fn target_name(&self) -> String {
        let name = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        self.job.target.meshes().into_iter().map(name).collect::<Vec<_>>().join(", ")
    }
}

fn summary(made: &Made, extras: &Extras, input: &Input, leaving: &Leaving, unused_partial: bool) -> String {
    let Extras { solids: thick, moving, plan, .. } = extras;
    let (hinges, milled) = (made.product.hinges(), extras.milled());
    let figures = figures::of_job(&made.product, &made.quality);
    let mut text = head(input.name, &outcome("made", hinges), &figures, hinges);
    text += &milled.map_or_else(|| cut_lines(plan.as_ref()), milled::lines);
    text += &thick.as_ref().map(solids::summary).unwrap_or_default();
    text += &morphs::summary(moving.as_ref(), hinges.len());
    text += &snap_lines(extras.snap.as_ref(), input, leaving);
    if leaving.dry_run {
        return text + &dry_run_lines(milled);
    }
    if unused_partial {
        text += "The design.partial.json of an interrupted run gave way to this result, made from the beginning.\n";
    }
    text += &files_listed(&made.product, extras, leaving.folder);
    text + &remark(made, input).map(|remark| remark + "\n").unwrap_or_default()
}

/// How a bistable sheet snaps, or why that is not told.
fn snap_lines(snap: Option<&Snap>, input: &Input, leaving: &Leaving) -> String {
    match (snap, &input.job.pattern.kind) {
        (Some(snap), _) => {
            format!("Snap, by the model of docs/snap.md:\n{}", labelled(&snap_report::figures(snap)))
        }
        (None, Kind::Bistable(_)) => format!(
            "The snap of more than {MOST_HINGES} hinges takes minutes and was left out: kirimorph snap {} -p PROFILE\n",
            leaving.folder.join("design.json").display()
        ),
        (None, Kind::RotatingRectangles) => String::new(),
    }
}

/// The files, and what they are for.
fn files_listed(product: &Product, extras: &Extras, folder: &Path) -> String {
    let mut text = format!("Files in {}:\n", folder.display());
    match product {
        Product::Sheet(sheet) => {
            let other = other_name(&sheet.design);
            let [files, words] = cut_words(extras.milled());
            let solids = format!("part.stl, {other}.stl");
            text += &format!("  {files:<26}  {words}\n");
            text += &format!("  {solids:<26}  the part as a solid, and its pieces in the {other} state\n");
        }
        Product::Assembly(_) => {
            text += "  pieces-closed.stl, pieces-open.stl   solids of the pieces in both states\n";
        }
    }
    if extras.snap.is_some() {
        text += "  snap.json, snap.svg         energy and torque on the way between the states\n";
    }
    if extras.moving.is_some() {
        text += "  morph.glb                   the pieces on their way between the states, for 3D viewers\n";
    }
    text + "  report.html                 look at this first, in a browser\n\
            \x20 preview.svg                 the same on one page, to print\n\
            \x20 hinges.csv, hinges.json     the hinge placement report\n\
            \x20 design.json, timings.json   the design with its figures, and the times\n"
}
