//! Unfinished files and folders beside the wanted ones, and those that killed runs left.
//!
//! Whatever is written goes by the name `.NAME.PROCESS.partial` until it is whole. The process holds a lock on it,
//! which the system takes away when the process ends, however that happens: what bears such a name and is not locked
//! is a leftover, and the next run that writes NAME removes it.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// What an unfinished file or folder is.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A file.
    File,
    /// A folder.
    Folder,
}

/// An unfinished file or folder, locked until it is dropped.
pub struct Unfinished {
    /// Where it is.
    pub path: PathBuf,
    /// The file, open for writing; of a folder the folder itself, where the system opens folders.
    pub handle: Option<File>,
}

/// How often a new name is made: only a run that clears away leftovers at the same moment can take one away.
const TRIES: usize = 100;

/// Makes the unfinished file or folder for `wanted`, whose folder exists, and clears leftovers away.
///
/// # Errors
/// The file system's refusal.
pub fn begin(wanted: &Path, kind: Kind) -> io::Result<Unfinished> {
    let folder = wanted.parent().unwrap_or(Path::new("/"));
    let name = wanted.file_name().unwrap_or_default().to_string_lossy().into_owned();
    clear(folder, &name);
    let path = folder.join(format!(".{name}.{}.partial", std::process::id()));
    for _ in 0..TRIES {
        let made = match kind {
            Kind::File => OpenOptions::new().write(true).create_new(true).open(&path).map(Some),
            Kind::Folder => fs::create_dir(&path).map(|()| File::open(&path).ok()),
        };
        let handle = match made {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => None,
            made => Some(made?),
        };
        // A file system without locks has no leftovers that could be told from others.
        let free = |file: &File| !matches!(file.try_lock(), Err(TryLockError::WouldBlock));
        match handle {
            Some(handle) if handle.as_ref().is_none_or(free) && path.exists() => {
                return Ok(Unfinished { path, handle });
            }
            _ => std::thread::sleep(Duration::from_millis(1)),
        }
    }
    Err(io::Error::other(format!("{} is in the way; remove it", path.display())))
}

/// Removes what killed runs left beside the file or folder of this name. What cannot be removed stays.
fn clear(folder: &Path, name: &str) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        if !is_unfinished(&entry.file_name().to_string_lossy(), name) {
            continue;
        }
        let path = entry.path();
        let Ok(kind) = entry.file_type() else { continue };
        let lock = File::open(&path).ok().filter(|file| file.try_lock().is_ok());
        if lock.is_some() && kind.is_dir() {
            let _ = fs::remove_dir_all(&path);
        } else if lock.is_some() && kind.is_file() {
            let _ = fs::remove_file(&path);
        }
    }
}

/// Whether an entry is an unfinished one of this name.
fn is_unfinished(entry: &str, name: &str) -> bool {
    let process = entry.strip_prefix('.').and_then(|rest| rest.strip_prefix(name)?.strip_prefix('.'));
    let process = process.and_then(|rest| rest.strip_suffix(".partial"));
    process.is_some_and(|digits| !digits.is_empty() && digits.bytes().all(|digit| digit.is_ascii_digit()))
}

/// Where a path that may be a link leads: what exists with all links followed, else the path itself, absolute.
///
/// # Errors
/// A link that leads nowhere.
pub fn resolved(wanted: &Path) -> io::Result<PathBuf> {
    match fs::symlink_metadata(wanted) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => std::path::absolute(wanted),
        Err(error) => Err(error),
        Ok(_) => fs::canonicalize(wanted).map_err(|error| match error.kind() {
            // Pipes have no path.
            io::ErrorKind::NotFound if wanted.exists() => {
                io::Error::other("this is a device or pipe; name another place")
            }
            io::ErrorKind::NotFound => io::Error::other("this is a link that leads nowhere; remove it"),
            _ => error,
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_no_process_holds_is_cleared_away() {
        let folder = std::env::temp_dir().join(format!("kirimorph-leftover-{}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(folder.join(".out.1.partial/below")).unwrap();
        for name in [".out.2.partial", ".out.partial", ".out.2x.partial", ".other.2.partial", "out.2.partial"]
        {
            fs::write(folder.join(name), "").unwrap();
        }
        let held = File::create(folder.join(".out.3.partial")).unwrap();
        held.lock().unwrap();
        let begun = begin(&folder.join("out"), Kind::Folder).unwrap();
        assert!(begun.path.is_dir());
        let mut left: Vec<_> =
            fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        left.sort();
        let own = format!(".out.{}.partial", std::process::id());
        let mut wanted =
            [".other.2.partial", ".out.2x.partial", ".out.3.partial", ".out.partial", &own, "out.2.partial"];
        wanted.sort_unstable();
        assert_eq!(left, wanted);
        fs::remove_dir_all(folder).unwrap();
    }
}
