//! Interrupted work: what it leaves in the output folder, and how it is taken up again.

use std::collections::BTreeMap;
use std::path::Path;

use super::{Failure, Optimisation};
use crate::job::Job;
use crate::memory;
use crate::output::folder::OutputFolder;
use crate::output::partial_json::{self, FILE_NAME, Partial};
use crate::pipeline::{self, Clock, PipelineError, fingerprint, source_hashes};
use crate::solver::Journal;

/// A job whose interrupted work is kept in a folder.
pub struct Resumable<'a> {
    folder: &'a Path,
    hashes: BTreeMap<String, String>,
}

impl<'a> Resumable<'a> {
    /// Hashes all that decides about the optimisation: the job, its target, and the profile, whose ligament and kerf
    /// decide about the hinges' places.
    pub fn new(job: &Job, job_file: &Path, folder: &'a Path) -> Self {
        let mut hashes = source_hashes(job, job_file);
        let profile = format!("{:?}", job.fabrication.profile);
        hashes.insert("profile".to_owned(), fingerprint(profile.as_bytes()));
        Self { folder, hashes }
    }

    /// Hands the clock the journal of the interrupted work, where that is to go on, and the memory that it may take.
    ///
    /// # Errors
    /// A journal that cannot be read or belongs to another job.
    pub fn begin(&self, optimisation: &Optimisation, clock: &mut Clock) -> Result<(), Failure> {
        if optimisation.resume {
            let journal = partial_json::read(&self.folder.join(FILE_NAME), &self.hashes);
            clock.journal = journal.map(Journal::resumed).map_err(Failure::bad_input)?;
        }
        clock.memory = if optimisation.ignore_memory { None } else { memory::free() };
        Ok(())
    }

    /// How a job ends that could not be finished. What an interrupted one had reached goes into the folder.
    pub fn failure(&self, error: PipelineError) -> Failure {
        let file = self.folder.join(FILE_NAME);
        match error {
            PipelineError::Interrupted { stage, reached: None } => Failure::Interrupted(format!(
                "in {stage}, before the optimisation had begun: there is nothing to go on from"
            )),
            PipelineError::Interrupted { stage, reached: Some(reached) } => match self.leave(&reached) {
                Ok(()) => Failure::Interrupted(format!(
                    "in {stage}; {} holds what was reached: add --resume to go on from there",
                    file.display()
                )),
                Err(error) => Failure::BadInput(format!("cannot write the interrupted design: {error}")),
            },
            PipelineError::Journal(fault) => Failure::BadInput(format!(
                "{}: {fault}; without --resume the job starts from its beginning",
                file.display()
            )),
            error => error.into(),
        }
    }

    fn leave(&self, reached: &pipeline::Partial) -> Result<(), Box<dyn std::error::Error>> {
        let pipeline::Partial { stage, pieces, journal } = reached;
        let partial = Partial { stage, pieces, journal, hashes: &self.hashes };
        let out = OutputFolder::create(self.folder)?;
        out.write(FILE_NAME, |file| partial_json::write(&partial, file))?;
        Ok(out.put_beside(FILE_NAME)?)
    }

    /// Takes away the interrupted work that has served. That it stays is no reason to fail.
    pub fn served(&self) {
        let _ = std::fs::remove_file(self.folder.join(FILE_NAME));
    }
}
