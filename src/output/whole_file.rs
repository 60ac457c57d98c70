//! One file, written whole or not at all.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// Writes a file beside `path` and then puts it in its place; folders are made as needed. After an error the
/// file is what it was.
///
/// # Errors
/// What `write` returns, or the file system's refusal.
pub fn write_whole<E: From<io::Error>>(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> Result<(), E>,
) -> Result<(), E> {
    let path = std::path::absolute(path)?;
    if path.is_dir() {
        return Err(io::Error::other("this is a folder; name a file").into());
    }
    let folder = path.parent().unwrap_or(Path::new("/"));
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let partial = folder.join(format!(".{name}.{}.partial", std::process::id()));
    fs::create_dir_all(folder)?;
    let result = File::create(&partial).map_err(E::from).and_then(|file| {
        let mut out = BufWriter::new(file);
        write(&mut out)?;
        out.flush()?;
        out.get_ref().sync_all()?;
        Ok(fs::rename(&partial, &path)?)
    });
    if result.is_err() {
        // Nothing better can be done about a file that cannot be removed.
        let _ = fs::remove_file(&partial);
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_leaves_the_old_file_and_nothing_else() {
        let folder = std::env::temp_dir().join(format!("kirimorph-whole-{}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        let file = folder.join("deep/a.txt");
        write_whole::<io::Error>(&file, |out| out.write_all(b"one")).unwrap();
        let failed = write_whole::<io::Error>(&file, |out| {
            out.write_all(b"two")?;
            Err(io::Error::other("no"))
        });
        assert!(failed.is_err());
        assert_eq!(fs::read(&file).unwrap(), b"one");
        assert_eq!(fs::read_dir(folder.join("deep")).unwrap().count(), 1);
        assert!(write_whole::<io::Error>(&folder, |_| Ok(())).is_err());
        fs::remove_dir_all(folder).unwrap();
    }
}
