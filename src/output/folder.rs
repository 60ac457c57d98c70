//! The output folder: all files of one run, or none.
//!
//! Files are written into a new folder beside the wanted one, which then takes its place. A folder that
//! already exists is replaced only if it holds nothing but files that a run makes, so that nothing of the
//! user's is lost and no old result is left among new ones. On Linux the two change places in one step: at no
//! moment is there no folder or half of one. A link to a folder stays; the folder that it leads to is replaced.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use super::leftover::{Kind, Unfinished, begin, resolved};

/// The finished part as a solid.
pub const PART: &str = "part.stl";

/// The pieces on their way between the states, animated.
pub const MORPH: &str = "morph.glb";

/// The page by which a person decides.
pub const REPORT: &str = "report.html";

/// The solid pieces in the other state: of a sheet that is cut closed, and of one that is cut open.
pub const MOVED: [&str; 2] = ["open.stl", "closed.stl"];

/// The names of the files that a run makes of a sheet that is cut closed.
pub const SHEET_FILES: [&str; 10] = sheet_files(MOVED[0]);

/// The names of the files that a run makes of a sheet that is cut open.
pub const OPEN_SHEET_FILES: [&str; 10] = sheet_files(MOVED[1]);

const fn sheet_files(moved: &'static str) -> [&'static str; 10] {
    [
        "design.json",
        "cut.dxf",
        "cut.svg",
        "hinges.csv",
        "hinges.json",
        PART,
        moved,
        "preview.svg",
        REPORT,
        "timings.json",
    ]
}

/// What is told of the snap of a bistable sheet, besides the other files.
pub const SNAP_FILES: [&str; 2] = ["snap.json", "snap.svg"];

/// Solids of the pieces in the closed and in the open state.
pub const SOLIDS: [&str; 2] = ["pieces-closed.stl", "pieces-open.stl"];

/// The names of the files that a run makes where neither state is flat.
pub const ASSEMBLY_FILES: [&str; 8] =
    ["design.json", "hinges.csv", "hinges.json", SOLIDS[0], SOLIDS[1], "preview.svg", REPORT, "timings.json"];

/// What a run writes for a mill in the place of [`CUT_FILES`], besides the program.
pub const MILL_FILES: [&str; 2] = ["toolpath.svg", "setup.txt"];

/// What a run writes for a laser.
pub const CUT_FILES: [&str; 2] = ["cut.dxf", "cut.svg"];

/// Whether a file is a milling program of ours: `mill.ngc`, `mill-01.nc`.
fn is_program(name: &str) -> bool {
    let Some((stem, ending)) = name.split_once('.') else { return false };
    let number = stem.strip_prefix("mill-").map(|number| number.chars().all(|digit| digit.is_ascii_digit()));
    (stem == "mill" || number == Some(true)) && ["ngc", "nc", "h", "mpf"].contains(&ending)
}

/// What an interrupted run leaves behind. It may stand in a folder that is replaced.
const PARTIAL: &str = super::partial_json::FILE_NAME;

/// Why the output cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum FolderError {
    /// The path names a file.
    #[error("{}: this is a file; name a folder with -o", path.display())]
    NotAFolder {
        /// The path.
        path: PathBuf,
    },
    /// The folder holds other files.
    #[error("{}: the folder holds \"{found}\", which no run of this program makes; name a new or empty folder with -o", path.display())]
    Occupied {
        /// The folder.
        path: PathBuf,
        /// One of the files in it.
        found: String,
    },
    /// The file system refused.
    #[error("{}: {source}", path.display())]
    Io {
        /// What was to be written.
        path: PathBuf,
        /// Why not.
        source: io::Error,
    },
}

/// Whether a file is one that a run makes.
fn is_of_a_run(name: &str) -> bool {
    let lists = [&SHEET_FILES[..], &OPEN_SHEET_FILES, &ASSEMBLY_FILES, &SNAP_FILES, &MILL_FILES];
    lists.iter().any(|files| files.contains(&name)) || [PARTIAL, MORPH].contains(&name) || is_program(name)
}

/// A folder being filled. Dropped before [`OutputFolder::finish`], it leaves nothing behind.
pub struct OutputFolder {
    /// Absolute, links followed.
    wanted: PathBuf,
    partial: Unfinished,
    is_ours: fn(&str) -> bool,
    finished: bool,
}

impl OutputFolder {
    /// Checks that `wanted` may be made or replaced. Nothing is written yet.
    ///
    /// # Errors
    /// A file in its place, or a folder with other files.
    pub fn check(wanted: &Path) -> Result<(), FolderError> {
        Self::check_of(wanted, is_of_a_run)
    }

    fn check_of(wanted: &Path, is_ours: fn(&str) -> bool) -> Result<(), FolderError> {
        let io = |source| FolderError::Io { path: wanted.to_owned(), source };
        match fs::symlink_metadata(wanted) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
            Err(error) => return Err(io(error)),
            Ok(_) if !wanted.is_dir() => {
                resolved(wanted).map_err(io)?;
                return Err(FolderError::NotAFolder { path: wanted.to_owned() });
            }
            Ok(_) => (),
        }
        for entry in fs::read_dir(wanted).map_err(io)? {
            let found = entry.map_err(io)?.file_name().to_string_lossy().into_owned();
            if !is_ours(&found) {
                return Err(FolderError::Occupied { path: wanted.to_owned(), found });
            }
        }
        Ok(())
    }

    /// Makes the new folder beside the wanted one.
    ///
    /// # Errors
    /// As [`OutputFolder::check`], or the file system's refusal.
    pub fn create(wanted: &Path) -> Result<Self, FolderError> {
        Self::create_of(wanted, is_of_a_run)
    }

    /// The same for files of other names: a folder that exists may hold only those that `is_ours` knows.
    ///
    /// # Errors
    /// A file in its place, a folder with other files, or the file system's refusal.
    pub fn create_of(wanted: &Path, is_ours: fn(&str) -> bool) -> Result<Self, FolderError> {
        Self::check_of(wanted, is_ours)?;
        let io = |source| FolderError::Io { path: wanted.to_owned(), source };
        let absolute = resolved(wanted).map_err(io)?;
        fs::create_dir_all(absolute.parent().unwrap_or(Path::new("/"))).map_err(io)?;
        let partial = begin(&absolute, Kind::Folder).map_err(io)?;
        Ok(Self { wanted: absolute, partial, is_ours, finished: false })
    }

    /// Writes one file.
    ///
    /// # Errors
    /// What `write` returns.
    pub fn write<E: From<io::Error>>(
        &self,
        name: &str,
        write: impl FnOnce(&mut BufWriter<File>) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut out = BufWriter::new(File::create(self.partial.path.join(name))?);
        write(&mut out)?;
        out.flush()?;
        out.get_ref().sync_all()?;
        Ok(())
    }

    /// Reads back one of the files that were written.
    ///
    /// # Errors
    /// The file system's refusal.
    pub fn read(&self, name: &str) -> io::Result<Vec<u8>> {
        fs::read(self.partial.path.join(name))
    }

    /// Puts one file of the new folder into the wanted one, beside what that holds.
    ///
    /// # Errors
    /// The file system's refusal.
    pub fn put_beside(self, name: &str) -> Result<(), FolderError> {
        let io = |source| FolderError::Io { path: self.wanted.clone(), source };
        fs::create_dir_all(&self.wanted).map_err(io)?;
        fs::rename(self.partial.path.join(name), self.wanted.join(name)).map_err(io)
    }

    /// Puts the new folder in the wanted one's place.
    ///
    /// # Errors
    /// The file system's refusal, or files of the user's that appeared meanwhile; the wanted folder is then
    /// as it was.
    pub fn finish(mut self) -> Result<(), FolderError> {
        let io = |source| FolderError::Io { path: self.wanted.clone(), source };
        Self::check_of(&self.wanted, self.is_ours)?;
        put_in_place(&self.partial.path, &self.wanted).map_err(io)?;
        // An empty folder may have been in the way; else the old results bear the partial folder's name now.
        self.finished = true;
        match fs::remove_dir_all(&self.partial.path) {
            Err(source) if source.kind() != io::ErrorKind::NotFound => {
                Err(FolderError::Io { path: self.partial.path.clone(), source })
            }
            _ => Ok(()),
        }
    }
}

/// Puts the folder `new` in the place of `wanted`; what was there then has the name `new`.
#[cfg(target_os = "linux")]
fn put_in_place(new: &Path, wanted: &Path) -> io::Result<()> {
    use rustix::fs::{CWD, RenameFlags, renameat_with};
    let exchange = renameat_with(CWD, new, CWD, wanted, RenameFlags::EXCHANGE);
    match exchange.map_err(io::Error::from) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => match fs::rename(new, wanted) {
            // Another run was faster.
            Err(error) if error.kind() == io::ErrorKind::DirectoryNotEmpty => put_in_place(new, wanted),
            renamed => renamed,
        },
        // Not every file system can do that.
        Err(_) => put_in_two_steps(new, wanted),
        Ok(()) => Ok(()),
    }
}

#[cfg(not(target_os = "linux"))]
fn put_in_place(new: &Path, wanted: &Path) -> io::Result<()> {
    put_in_two_steps(new, wanted)
}

/// As [`put_in_place`], with a moment at which there is no folder `wanted`.
fn put_in_two_steps(new: &Path, wanted: &Path) -> io::Result<()> {
    if !wanted.exists() {
        return fs::rename(new, wanted);
    }
    let old = new.with_extension("old");
    fs::rename(wanted, &old)?;
    if let Err(error) = fs::rename(new, wanted) {
        // Best effort: the old folder goes back to its name.
        let _ = fs::rename(&old, wanted);
        return Err(error);
    }
    fs::rename(old, new)
}

impl Drop for OutputFolder {
    fn drop(&mut self) {
        if !self.finished {
            // Nothing better can be done about a folder that cannot be removed.
            let _ = fs::remove_dir_all(&self.partial.path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fresh(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("kirimorph-folder-{}-{name}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).unwrap();
        folder
    }

    fn fill(wanted: &Path, text: &str) -> Result<(), FolderError> {
        let folder = OutputFolder::create(wanted)?;
        folder.write::<io::Error>("design.json", |out| out.write_all(text.as_bytes())).unwrap();
        folder.finish()
    }

    #[test]
    fn replaces_its_own_results_whole_and_leaves_others_alone() {
        let base = fresh("replace");
        let wanted = base.join("deep/out");
        fill(&wanted, "one").unwrap();
        fs::write(wanted.join("cut.dxf"), "old").unwrap();
        fill(&wanted, "two").unwrap();
        assert_eq!(fs::read_to_string(wanted.join("design.json")).unwrap(), "two");
        assert!(!wanted.join("cut.dxf").exists(), "an old result stayed among the new ones");
        fs::write(wanted.join("notes.txt"), "mine").unwrap();
        assert!(
            matches!(fill(&wanted, "three"), Err(FolderError::Occupied { found, .. }) if found == "notes.txt")
        );
        assert_eq!(fs::read_to_string(wanted.join("design.json")).unwrap(), "two");
        assert_eq!(fs::read_dir(base.join("deep")).unwrap().count(), 1, "a partial folder was left");
        fs::remove_dir_all(base).unwrap();
    }

    #[test]
    fn adds_one_file_and_takes_it_away_with_the_rest() {
        let base = fresh("add");
        let wanted = base.join("out");
        let add = |text: &str| {
            let folder = OutputFolder::create(&wanted).unwrap();
            folder.write::<io::Error>(PARTIAL, |out| out.write_all(text.as_bytes())).unwrap();
            folder.put_beside(PARTIAL).unwrap();
        };
        add("one");
        assert_eq!(fs::read_dir(&wanted).unwrap().count(), 1);
        fill(&wanted, "whole").unwrap();
        assert!(!wanted.join(PARTIAL).exists());
        add("two");
        add("three");
        assert_eq!(fs::read_to_string(wanted.join(PARTIAL)).unwrap(), "three");
        assert_eq!(fs::read_to_string(wanted.join("design.json")).unwrap(), "whole");
        assert_eq!(fs::read_dir(&base).unwrap().count(), 1, "a partial folder was left");
        fs::remove_dir_all(base).unwrap();
    }

    #[test]
    fn leaves_nothing_when_dropped_or_refused() {
        let base = fresh("drop");
        drop(OutputFolder::create(&base.join("out")).unwrap());
        assert_eq!(fs::read_dir(&base).unwrap().count(), 0);
        fs::write(base.join("file"), "").unwrap();
        assert!(matches!(fill(&base.join("file"), ""), Err(FolderError::NotAFolder { .. })));
        assert!(matches!(fill(&base.join("file/below"), ""), Err(FolderError::Io { .. })));
        fs::remove_dir_all(base).unwrap();
    }
}
