//! TOML files by name: those inside the program, and those in a folder beside the user's work.

use std::path::{Path, PathBuf};

use thiserror::Error;

use super::{TomlError, read_text};

/// Where the files of one kind are found.
#[derive(Debug, Clone, Copy)]
pub struct Shelf<'a> {
    /// What one is, for messages: "profile".
    pub kind: &'a str,
    /// Those inside the program: names and texts.
    pub embedded: &'a [(&'a str, &'a str)],
    /// The user's folder, whose files go before embedded ones of the same name.
    pub folder: &'a Path,
}

/// A file of a shelf.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TomlFile {
    /// Its name without the ending.
    pub name: String,
    /// The whole text.
    pub text: String,
    /// What it is called in messages.
    pub label: String,
    /// Where it lies; `None` of one inside the program.
    pub path: Option<PathBuf>,
}

/// A file of a shelf could not be had.
#[derive(Debug, Error)]
pub enum ShelfError {
    /// Nothing has this name.
    #[error("no {kind} is called \"{name}\"; there are {}; or give the path of a TOML file", known.join(", "))]
    UnknownName {
        /// What was asked for: "profile".
        kind: String,
        /// The name asked for.
        name: String,
        /// The names that exist.
        known: Vec<String>,
    },
    /// The file cannot be read or breaks a rule.
    #[error(transparent)]
    Toml(#[from] TomlError),
}

impl Shelf<'_> {
    /// Finds a file by name or path.
    ///
    /// What contains a path separator or ends in `.toml` is a path, relative to `base_dir`. Else `NAME.toml` is looked
    /// for in the folder, then among the embedded files.
    ///
    /// # Errors
    /// Nothing by that name, or a file that cannot be read.
    pub fn find(&self, name_or_path: &str, base_dir: &Path) -> Result<TomlFile, ShelfError> {
        if name_or_path.contains(std::path::is_separator) || name_or_path.ends_with(".toml") {
            return Ok(read_file(&base_dir.join(name_or_path))?);
        }
        let user_file = self.folder.join(format!("{name_or_path}.toml"));
        if user_file.is_file() {
            return Ok(read_file(&user_file)?);
        }
        match self.embedded.iter().find(|(name, _)| *name == name_or_path) {
            Some((name, text)) => Ok(TomlFile {
                name: (*name).to_owned(),
                text: (*text).to_owned(),
                label: format!("embedded {} {name}.toml", self.kind),
                path: None,
            }),
            None => Err(ShelfError::UnknownName {
                kind: self.kind.to_owned(),
                name: name_or_path.to_owned(),
                known: self.names(),
            }),
        }
    }

    /// The names that [`Shelf::find`] knows, sorted.
    pub fn names(&self) -> Vec<String> {
        let mut names: Vec<String> = self.embedded.iter().map(|(name, _)| (*name).to_owned()).collect();
        // A folder that is absent or unreadable holds no file.
        for entry in std::fs::read_dir(self.folder).into_iter().flatten().flatten() {
            let file_name = entry.file_name();
            if let Some(name) = file_name.to_str().and_then(|file_name| file_name.strip_suffix(".toml")) {
                names.push(name.to_owned());
            }
        }
        names.sort();
        names.dedup();
        names
    }
}

fn read_file(path: &Path) -> Result<TomlFile, TomlError> {
    let text = read_text(path)?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Ok(TomlFile { name, text, label: path.display().to_string(), path: Some(path.to_owned()) })
}
