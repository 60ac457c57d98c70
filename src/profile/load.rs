//! Where profiles are found: a path, the folder `profiles` of the working directory, the program itself.

use std::path::Path;

use thiserror::Error;

use super::{Profile, read};
use crate::toml_source::{TomlError, read_text};

/// The profiles inside the program, by name, sorted.
pub(super) const EMBEDDED: [(&str, &str); 4] = [
    ("nitrile-rubber-2mm", include_str!("../../profiles/nitrile-rubber-2mm.toml")),
    ("nylon-6-5mm", include_str!("../../profiles/nylon-6-5mm.toml")),
    ("nylon-6-conditioned-5mm", include_str!("../../profiles/nylon-6-conditioned-5mm.toml")),
    ("steel-304-0.5mm", include_str!("../../profiles/steel-304-0.5mm.toml")),
];

/// The folder beside the user's work whose files go before the embedded ones.
const USER_FOLDER: &str = "profiles";

/// A profile could not be had.
#[derive(Debug, Error)]
pub enum ProfileError {
    /// No profile has this name.
    #[error("no profile is called \"{name}\"; there are {}; or give the path of a TOML file", known.join(", "))]
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

/// The profiles inside the program, sorted by name.
pub fn embedded() -> Vec<Profile> {
    // A test reads them all; none is refused.
    EMBEDDED.iter().filter_map(|(name, text)| read::parse(text, name, name).ok()).collect()
}

/// Loads a profile by name or path.
///
/// What contains a path separator or ends in `.toml` is a path, relative to `base_dir`. Else `NAME.toml` is looked
/// for in the folder `profiles` of the working directory, then among the embedded profiles.
///
/// # Errors
/// Nothing by that name, an unreadable file, or a profile that breaks a rule.
pub fn load(name_or_path: &str, base_dir: &Path) -> Result<Profile, ProfileError> {
    load_with(name_or_path, base_dir, Path::new(USER_FOLDER))
}

/// The names that [`load`] knows: embedded and in the folder `profiles` of the working directory, sorted.
pub fn names() -> Vec<String> {
    names_with(Path::new(USER_FOLDER))
}

pub(super) fn load_with(
    name_or_path: &str,
    base_dir: &Path,
    user_folder: &Path,
) -> Result<Profile, ProfileError> {
    if name_or_path.contains(std::path::is_separator) || name_or_path.ends_with(".toml") {
        return read_file(&base_dir.join(name_or_path));
    }
    let user_file = user_folder.join(format!("{name_or_path}.toml"));
    if user_file.is_file() {
        return read_file(&user_file);
    }
    match EMBEDDED.iter().find(|(name, _)| *name == name_or_path) {
        Some((name, text)) => Ok(read::parse(text, name, &format!("embedded profile {name}.toml"))?),
        None => {
            Err(ProfileError::UnknownName { name: name_or_path.to_owned(), known: names_with(user_folder) })
        }
    }
}

fn read_file(path: &Path) -> Result<Profile, ProfileError> {
    let text = read_text(path)?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    Ok(read::parse(&text, &name, &path.display().to_string())?)
}

pub(super) fn names_with(user_folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = EMBEDDED.iter().map(|(name, _)| (*name).to_owned()).collect();
    // A folder that is absent or unreadable holds no profile.
    for entry in std::fs::read_dir(user_folder).into_iter().flatten().flatten() {
        let file_name = entry.file_name();
        if let Some(name) = file_name.to_str().and_then(|file_name| file_name.strip_suffix(".toml")) {
            names.push(name.to_owned());
        }
    }
    names.sort();
    names.dedup();
    names
}
