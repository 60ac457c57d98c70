//! Where machines are found: a path, the folder `profiles/machines` of the working directory, the program
//! itself.

use std::path::Path;

use thiserror::Error;

use super::{Machine, read};
use crate::toml_source::{TomlError, read_text};

/// The machines inside the program, by name, sorted.
pub(super) const EMBEDDED: [(&str, &str); 9] = [
    ("fanuc-30i-ac", include_str!("../../../profiles/machines/fanuc-30i-ac.toml")),
    ("haas-umc-bc", include_str!("../../../profiles/machines/haas-umc-bc.toml")),
    ("heidenhain-bc", include_str!("../../../profiles/machines/heidenhain-bc.toml")),
    ("linuxcnc-xyz", include_str!("../../../profiles/machines/linuxcnc-xyz.toml")),
    ("linuxcnc-xyzab-tdr", include_str!("../../../profiles/machines/linuxcnc-xyzab-tdr.toml")),
    ("linuxcnc-xyzac-trt", include_str!("../../../profiles/machines/linuxcnc-xyzac-trt.toml")),
    ("linuxcnc-xyzbc-trt", include_str!("../../../profiles/machines/linuxcnc-xyzbc-trt.toml")),
    ("linuxcnc-xyzbc-trt-no-tcp", include_str!("../../../profiles/machines/linuxcnc-xyzbc-trt-no-tcp.toml")),
    ("siemens-840d-ac", include_str!("../../../profiles/machines/siemens-840d-ac.toml")),
];

/// The folder beside the user's work whose files go before the embedded ones.
const USER_FOLDER: &str = "profiles/machines";

/// A machine could not be had.
#[derive(Debug, Error)]
pub enum MachineFileError {
    /// No machine has this name.
    #[error("no machine is called \"{name}\"; there are {}; or give the path of a TOML file", known.join(", "))]
    UnknownName {
        /// The name asked for.
        name: String,
        /// The names that exist.
        known: Vec<String>,
    },
    /// The file cannot be read or breaks a rule.
    #[error(transparent)]
    Toml(#[from] TomlError),
}

/// Loads a machine by name or path.
///
/// What contains a path separator or ends in `.toml` is a path, relative to `base_dir`. Else `NAME.toml` is
/// looked for in the folder `profiles/machines` of the working directory, then among the embedded machines.
///
/// # Errors
/// Nothing by that name, an unreadable file, or a file that breaks a rule.
pub fn load(name_or_path: &str, base_dir: &Path) -> Result<Machine, MachineFileError> {
    if name_or_path.contains(std::path::is_separator) || name_or_path.ends_with(".toml") {
        return read_file(&base_dir.join(name_or_path));
    }
    let user_file = Path::new(USER_FOLDER).join(format!("{name_or_path}.toml"));
    if user_file.is_file() {
        return read_file(&user_file);
    }
    match EMBEDDED.iter().find(|(name, _)| *name == name_or_path) {
        Some((name, text)) => Ok(read::parse(text, name, &format!("embedded machine {name}.toml"))?),
        None => Err(MachineFileError::UnknownName { name: name_or_path.to_owned(), known: names() }),
    }
}

fn read_file(path: &Path) -> Result<Machine, MachineFileError> {
    let text = read_text(path)?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    Ok(read::parse(&text, &name, &path.display().to_string())?)
}

/// The names that [`load`] knows: embedded and in the folder `profiles/machines` of the working directory,
/// sorted.
pub fn names() -> Vec<String> {
    let mut names: Vec<String> = EMBEDDED.iter().map(|(name, _)| (*name).to_owned()).collect();
    // A folder that is absent or unreadable holds no machine.
    for entry in std::fs::read_dir(USER_FOLDER).into_iter().flatten().flatten() {
        let file_name = entry.file_name();
        if let Some(name) = file_name.to_str().and_then(|file_name| file_name.strip_suffix(".toml")) {
            names.push(name.to_owned());
        }
    }
    names.sort();
    names.dedup();
    names
}
