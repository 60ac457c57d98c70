//! Where machines are found: a path, the folder `profiles/machines` of the working directory, the program
//! itself.

use std::path::Path;

use super::{Machine, read};
use crate::toml_source::{Shelf, ShelfError, TomlFile};

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

/// Loads a machine by name or path.
///
/// What contains a path separator or ends in `.toml` is a path, relative to `base_dir`. Else `NAME.toml` is
/// looked for in the folder `profiles/machines` of the working directory, then among the embedded machines.
///
/// # Errors
/// Nothing by that name, an unreadable file, or a file that breaks a rule.
pub fn load(name_or_path: &str, base_dir: &Path) -> Result<Machine, ShelfError> {
    let file = source(name_or_path, base_dir)?;
    Ok(read::parse(&file.text, &file.name, &file.label)?)
}

/// The file that [`load`] reads.
///
/// # Errors
/// Nothing by that name, or an unreadable file.
pub fn source(name_or_path: &str, base_dir: &Path) -> Result<TomlFile, ShelfError> {
    shelf().find(name_or_path, base_dir)
}

/// The names that [`load`] knows: embedded and in the folder `profiles/machines` of the working directory,
/// sorted.
pub fn names() -> Vec<String> {
    shelf().names()
}

fn shelf() -> Shelf<'static> {
    Shelf { kind: "machine", embedded: &EMBEDDED, folder: Path::new(USER_FOLDER) }
}
