//! Interrupted work: what it leaves in the output folder, and how it is taken up again.

use std::collections::BTreeMap;
use std::path::Path;

use super::Failure;
use crate::job::Job;
use crate::output::folder::OutputFolder;
use crate::output::partial_json::{self, FILE_NAME, Partial};
use crate::pipeline::{self, PipelineError, fingerprint, source_hashes};
use crate::solver::Journal;

/// Hashes of all that decides about the optimisation, by name: the job, its target, and the profile, whose
/// ligament and kerf decide about the hinges' places.
pub fn hashes(job: &Job, job_file: &Path) -> BTreeMap<String, String> {
    let mut hashes = source_hashes(job, job_file);
    let profile = format!("{:?}", job.fabrication.profile);
    hashes.insert("profile".to_owned(), fingerprint(profile.as_bytes()));
    hashes
}

/// The journal of the interrupted work in a folder.
pub fn journal(folder: &Path, hashes: &BTreeMap<String, String>) -> Result<Journal, Failure> {
    partial_json::read(&folder.join(FILE_NAME), hashes).map(Journal::resumed).map_err(Failure::bad_input)
}

/// How a job ends that could not be finished. What an interrupted one had reached goes into the folder.
pub fn failure(error: PipelineError, folder: &Path, hashes: &BTreeMap<String, String>) -> Failure {
    match error {
        PipelineError::Interrupted { stage, reached: None } => Failure::Interrupted(format!(
            "in {stage}, before the optimisation had begun: there is nothing to go on from"
        )),
        PipelineError::Interrupted { stage, reached: Some(reached) } => {
            match leave(&reached, folder, hashes) {
                Ok(()) => Failure::Interrupted(format!(
                    "in {stage}; {} holds what was reached: add --resume to go on from there",
                    folder.join(FILE_NAME).display()
                )),
                Err(error) => Failure::BadInput(format!("cannot write the interrupted design: {error}")),
            }
        }
        PipelineError::Journal(fault) => Failure::BadInput(format!(
            "{}: {fault}; without --resume the job starts from its beginning",
            folder.join(FILE_NAME).display()
        )),
        error if error.is_bad_input() => Failure::bad_input(error),
        error => Failure::NotMakeable(error.to_string()),
    }
}

fn leave(
    reached: &pipeline::Partial,
    folder: &Path,
    hashes: &BTreeMap<String, String>,
) -> Result<(), Box<dyn std::error::Error>> {
    let pipeline::Partial { stage, pieces, journal } = reached;
    let out = OutputFolder::create(folder)?;
    out.write(FILE_NAME, |file| partial_json::write(&Partial { stage, pieces, journal, hashes }, file))?;
    Ok(out.put_beside(FILE_NAME)?)
}
