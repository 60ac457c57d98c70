//! What mills the sheet: a key of `[fabrication]`.

use std::path::Path;

use super::fabrication::RawFabrication;
use super::{DEFAULT_MACHINE, JobError};
use crate::machine::{self, Machine};
use crate::profile::{Process, Profile};
use crate::toml_source::{ShelfError, TomlSource};

/// The machine of a sheet that is milled.
pub(super) fn machine(
    source: &TomlSource,
    raw: &RawFabrication,
    folder: &Path,
    profile: &Profile,
) -> Result<Option<Machine>, JobError> {
    let faulty = |fault| JobError::Machine { file: source.file.to_owned(), source: fault };
    match (&raw.machine, profile.process) {
        (None, Process::Laser) => Ok(None),
        (Some(name), Process::Laser) => {
            let what = format!("not for the profile {}, which is for a laser", profile.name);
            Err(source
                .value_error(name.span(), &what, "leave the key out, or take a profile for milling")
                .into())
        }
        (None, Process::Milling) => machine::load(DEFAULT_MACHINE, folder).map(Some).map_err(faulty),
        (Some(name), Process::Milling) => match machine::load(name.get_ref(), folder) {
            Ok(machine) => Ok(Some(machine)),
            Err(ShelfError::UnknownName { known, .. }) => {
                let help = format!("there are {}; or give the path of a TOML file", known.join(", "));
                Err(source.value_error(name.span(), "not the name of a machine", help).into())
            }
            Err(fault) => Err(faulty(fault)),
        },
    }
}
