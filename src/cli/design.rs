//! `kirimorph design`: the pattern alone, or what is to be expected of it.

use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

use super::map::{figures, map};
use super::partial::Resumable;
use super::progress::{Reporting, watched};
use super::{Failure, Optimisation, events, open_state, print};
use crate::job::read_job;
use crate::kirigami::feasibility::{Feasibility, Verdict};
use crate::output::design_json::{self, DesignFile, Provenance, WriteDesignError};
use crate::output::stretch_map;
use crate::output::whole_file::{self, write_whole};
use crate::pipeline::{Designed, Prediction, placed_design, predict, source_hashes};

/// The flags.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The job file (TOML).
    job: PathBuf,
    /// File for the design [default: out/NAME.design.json, NAME being the job file's].
    #[arg(short, long, conflicts_with = "feasibility_only")]
    output: Option<PathBuf>,
    /// Print what the target asks of the pattern, and design nothing: exit status 2 if it is out of reach.
    #[arg(long)]
    feasibility_only: bool,
    /// Draw where the target asks for how much stretch, as FILE.svg or FILE.html.
    #[arg(long, value_name = "FILE")]
    map: Option<PathBuf>,
    #[command(flatten)]
    optimisation: Optimisation,
    #[command(flatten)]
    pub reporting: Reporting,
}

/// Predicts, where asked for, and designs.
pub fn run(options: &Arguments) -> Result<(), Failure> {
    let job = read_job(&options.job).map_err(Failure::bad_input)?;
    let name = options.job.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let map = options.map.as_deref().map(|map| is_html(map).map(|html| (map, html))).transpose()?;
    let file = options.output.clone().unwrap_or_else(|| Path::new("out").join(format!("{name}.design.json")));
    // Before the work, not after it.
    for file in [Some(&file), options.map.as_ref()].into_iter().flatten() {
        whole_file::check(file).map_err(|error| Failure::BadInput(format!("{}: {error}", file.display())))?;
    }
    // What an interrupted run leaves goes beside the design.
    let folder = file.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
    let partial = Resumable::new(&job, &options.job, folder);
    let outcome = watched(&options.reporting, |clock| {
        partial.begin(&options.optimisation, clock)?;
        if options.feasibility_only || map.is_some() {
            let prediction = predict(&job, clock)?;
            map.map_or(Ok(()), |(map, html)| write_map(&prediction, &name, map, html))?;
            if options.feasibility_only {
                return Ok(Outcome::Predicted(prediction));
            }
        }
        placed_design(&job, clock).map(Outcome::Designed).map_err(|error| partial.failure(error))
    })?;
    let designed = match outcome {
        Outcome::Predicted(prediction) => return report(&prediction, &name, &options.reporting),
        Outcome::Designed(designed) => designed,
    };
    let (hashes, target) = (source_hashes(&job, &options.job), job.target.meshes()[0].to_string_lossy());
    let provenance = Provenance { job: &name, target: &target, hashes: &hashes };
    write(&designed, provenance, &file)?;
    if options.optimisation.resume {
        partial.served();
    }
    tell(&designed, &name, &file, &options.reporting);
    Ok(())
}

/// What was done.
enum Outcome {
    Predicted(Prediction),
    Designed(Designed),
}

/// Whether a map is a page; else it is a picture.
fn is_html(map: &Path) -> Result<bool, Failure> {
    match map.extension().and_then(|ending| ending.to_str()) {
        Some("html" | "htm") => Ok(true),
        Some("svg") => Ok(false),
        _ => Err(Failure::BadInput(format!("{}: the map must end in .svg or .html", map.display()))),
    }
}

fn write(designed: &Designed, provenance: Provenance, path: &Path) -> Result<(), Failure> {
    let Designed { design, quality, stages, .. } = designed;
    let file = DesignFile { design, quality, stages, max_strain: None, provenance };
    write_whole::<WriteDesignError>(path, |out| design_json::write(&file, out))
        .map_err(|error| Failure::BadInput(format!("{}: {error}", path.display())))
}

/// Tells what was designed.
fn tell(designed: &Designed, name: &str, file: &Path, reporting: &Reporting) {
    let Designed { design, quality, .. } = designed;
    let (pieces, hinges) = (design.pieces.len(), design.hinges.len());
    if reporting.json {
        let figures: BTreeMap<&str, f64> = design_json::figures(quality).into();
        events::tell(&serde_json::json!({
            "event": "result", "status": 0, "files": [file], "pieces": pieces, "hinges": hinges, "figures": figures,
        }));
    } else if !reporting.quiet {
        let mut text = format!(
            "{name}: designed, {pieces} pieces and {hinges} hinges; off the target {:.3} mm, length error {:.1e}\n",
            quality.distance_max, quality.max_length_error,
        );
        for (label, value) in open_state::figures(quality) {
            text += &format!("  {label}: {value}\n");
        }
        print(&format!("{text}Design in {}\n", file.display()));
    }
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
