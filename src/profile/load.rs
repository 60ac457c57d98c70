//! Where profiles are found: a path, the folder `profiles` of the working directory, the program itself.

use std::path::Path;

use super::{Profile, read};
use crate::toml_source::{Shelf, ShelfError, TomlFile};

/// The profiles inside the program, by name, sorted.
pub(super) const EMBEDDED: [(&str, &str); 4] = [
    ("nitrile-rubber-2mm", include_str!("../../profiles/nitrile-rubber-2mm.toml")),
    ("nylon-6-5mm", include_str!("../../profiles/nylon-6-5mm.toml")),
    ("nylon-6-conditioned-5mm", include_str!("../../profiles/nylon-6-conditioned-5mm.toml")),
    ("steel-304-0.5mm", include_str!("../../profiles/steel-304-0.5mm.toml")),
];

/// The folder beside the user's work whose files go before the embedded ones.
const USER_FOLDER: &str = "profiles";

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
pub fn load(name_or_path: &str, base_dir: &Path) -> Result<Profile, ShelfError> {
    load_with(name_or_path, base_dir, Path::new(USER_FOLDER))
}

/// The file that [`load`] reads.
///
/// # Errors
/// Nothing by that name, or an unreadable file.
pub fn source(name_or_path: &str, base_dir: &Path) -> Result<TomlFile, ShelfError> {
    shelf(Path::new(USER_FOLDER)).find(name_or_path, base_dir)
}

/// The names that [`load`] knows: embedded and in the folder `profiles` of the working directory, sorted.
pub fn names() -> Vec<String> {
    names_with(Path::new(USER_FOLDER))
}

pub(super) fn load_with(
    name_or_path: &str,
    base_dir: &Path,
    user_folder: &Path,
) -> Result<Profile, ShelfError> {
    let file = shelf(user_folder).find(name_or_path, base_dir)?;
    Ok(read::parse(&file.text, &file.name, &file.label)?)
}

pub(super) fn names_with(user_folder: &Path) -> Vec<String> {
    shelf(user_folder).names()
}

fn shelf(folder: &Path) -> Shelf<'_> {
    Shelf { kind: "profile", embedded: &EMBEDDED, folder }
}
