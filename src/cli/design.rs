//! `kirimorph design`: the pattern alone, or what is to be expected of it.

use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

use super::map::{figures, map};
use super::progress::{Reporter, Reporting};
use super::{Failure, Optimisation, events, interrupt, open_state, partial, print};
use crate::job::read_job;
use crate::kirigami::feasibility::{Feasibility, Verdict};
use crate::memory;
use crate::output::design_json::{self, DesignFile, Provenance, WriteDesignError};
use crate::output::partial_json;
use crate::output::stretch_map;
use crate::output::whole_file::write_whole;
use crate::pipeline::{Clock, PipelineError, Prediction, Progress, placed_design, predict, source_hashes};

/// What the user asks for.
pub struct Options {
    /// The job file.
    pub job: PathBuf,
    /// Where the design goes.
    pub output: Option<PathBuf>,
    /// Whether to stop after the prediction.
    pub feasibility_only: bool,
    /// Where the map goes: SVG, or HTML by its ending.
    pub map: Option<PathBuf>,
    /// How the optimisation is run.
    pub optimisation: Optimisation,
    /// What is told on the way.
    pub reporting: Reporting,
}

/// Predicts, where asked for, and designs.
pub fn run(options: &Options) -> Result<(), Failure> {
    let job = read_job(&options.job).map_err(Failure::bad_input)?;
    let name = options.job.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let html = match options.map.as_deref().map(|map| (map, map.extension().unwrap_or_default())) {
        Some((_, ending)) if ending == "html" || ending == "htm" => true,
        Some((map, ending)) if ending != "svg" => {
            let message = format!("{}: the map must end in .svg or .html", map.display());
            return Err(Failure::BadInput(message));
        }
        _ => false,
    };
    let file = options.output.clone().unwrap_or_else(|| Path::new("out").join(format!("{name}.design.json")));
    // What an interrupted run leaves goes beside the design.
    let folder = file.parent().map(|folder| if folder == Path::new("") { Path::new(".") } else { folder });
    let folder = folder.unwrap_or(Path::new(".")).to_owned();
    let partial_hashes = partial::hashes(&job, &options.job);
    interrupt::listen();
    let mut reporter = Reporter::new(&options.reporting);
    let mut watch = |progress: &Progress| {
        reporter.show(progress);
        interrupt::flow()
    };
    let mut clock = Clock::new(&mut watch);
    if options.optimisation.resume {
        clock.journal = partial::journal(&folder, &partial_hashes)?;
    }
    clock.memory = if options.optimisation.ignore_memory { None } else { memory::free() };
    let prediction = if options.feasibility_only || options.map.is_some() {
        Some(predict(&job, &mut clock).map_err(failure)?)
    } else {
        None
    };
    if let (Some(prediction), Some(map)) = (&prediction, &options.map) {
        write_map(prediction, &name, map, html)?;
    }
    if let (Some(prediction), true) = (&prediction, options.feasibility_only) {
        drop(clock);
        drop(reporter);
        return report(prediction, &name, &options.reporting);
    }
    let designed =
        placed_design(&job, &mut clock).map_err(|error| partial::failure(error, &folder, &partial_hashes))?;
    let hashes = source_hashes(&job, &options.job);
    let target = job.target.meshes()[0].to_string_lossy();
    let design = DesignFile {
        design: &designed.design,
        quality: &designed.quality,
        stages: &designed.stages,
        max_strain: None,
        provenance: Provenance { job: &name, target: &target, hashes: &hashes },
    };
    write_whole::<WriteDesignError>(&file, |out| design_json::write(&design, out))
        .map_err(|error| Failure::BadInput(format!("{}: {error}", file.display())))?;
    if options.optimisation.resume {
        // It has served; that it stays is no reason to fail.
        let _ = std::fs::remove_file(folder.join(partial_json::FILE_NAME));
    }
    drop(clock);
    drop(reporter);
    if options.reporting.json {
        let figures: BTreeMap<&str, f64> = design_json::figures(&designed.quality).into();
        events::tell(&serde_json::json!({
            "event": "result", "status": 0, "files": [&file], "pieces": designed.design.pieces.len(),
            "hinges": designed.design.hinges.len(), "figures": figures,
        }));
    } else if !options.reporting.quiet {
        let (pieces, hinges) = (designed.design.pieces.len(), designed.design.hinges.len());
        let quality = &designed.quality;
        let mut text = format!(
            "{name}: designed, {pieces} pieces and {hinges} hinges; off the target {:.3} mm, length error {:.1e}\n",
            quality.distance_max, quality.max_length_error,
        );
        for (label, value) in open_state::figures(quality) {
            text += &format!("  {label}: {value}\n");
        }
        print(&format!("{text}Design in {}\n", file.display()));
    }
    Ok(())
}

fn failure(error: PipelineError) -> Failure {
    if error.is_bad_input() { Failure::bad_input(error) } else { Failure::NotMakeable(error.to_string()) }
}

fn write_map(prediction: &Prediction, name: &str, path: &Path, html: bool) -> Result<(), Failure> {
    let (title, rows) = (format!("{name}: {}", prediction.feasibility.verdict.word()), figures(prediction));
    let map = map(prediction, &title, &rows);
    write_whole::<io::Error>(path, |out| {
        if html { stretch_map::write_html(&map, out) } else { stretch_map::write_svg(&map, out) }
    })
    .map_err(|error| Failure::BadInput(format!("{}: cannot write the map: {error}", path.display())))
}

/// Prints the numbers; a target out of reach is refused.
fn report(prediction: &Prediction, name: &str, reporting: &Reporting) -> Result<(), Failure> {
    let found = &prediction.feasibility;
    if reporting.json {
        let figures: BTreeMap<String, String> = figures(prediction).into_iter().collect();
        events::tell(&serde_json::json!({
            "event": "result",
            "status": if found.verdict == Verdict::Beyond { 2 } else { 0 },
            "verdict": found.verdict.word(),
            "worst_ratio": found.worst_ratio,
            "conformal_ratio": found.conformal_ratio,
            "figures": figures,
        }));
    } else if !reporting.quiet {
        let mut text = format!("{name}: {}, {}\n", found.verdict.word(), meaning(found.verdict));
        for (label, value) in figures(prediction) {
            text += &format!("  {label:<24}  {value}\n");
        }
        print(&text);
    }
    if found.verdict != Verdict::Beyond {
        return Ok(());
    }
    let Feasibility { worst, worst_ratio, conformal_ratio, range: [low, high], .. } = found;
    let at = format!(
        "face {} near ({:.2}, {:.2}, {:.2}) mm",
        prediction.worst_face, worst.at.x, worst.at.y, worst.at.z
    );
    if prediction.is_map {
        return Err(Failure::NotMakeable(format!(
            "{name}: out of reach: the map stretches lengths {low:.3} to {high:.3} times; turning pieces stretch by 1 at \
             least and by less than 3, and by 1.41 in both directions at once at most; it is worst at {at}: change the \
             size of one of the meshes, or move their vertices"
        )));
    }
    Err(Failure::NotMakeable(format!(
        "{name}: out of reach: some places are stretched {worst_ratio:.3} times as much as others ({conformal_ratio:.3} \
         times without shear); it is worst at {at}: cut the target into parts that curve less"
    )))
}

fn meaning(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Easy => "expected to be reached",
        Verdict::Hard => "the optimisation decides; from a conformal ratio of about 2 on cuts may be needed",
        Verdict::Beyond => "out of reach without cuts",
    }
}
