//! One file, written whole or not at all.

use std::fs::{self, File};
use std::io::{self, BufWriter, Read, Write};
use std::path::{Path, PathBuf};

use super::leftover::{Kind, begin, resolved};

/// Largest file that is read whole, bytes.
const LARGEST: u64 = 1 << 30;

/// Writes a file beside `path` and then puts it in its place; folders are made as needed. After an error the
/// file is what it was. A link stays one: what it leads to is written.
///
/// # Errors
/// What `write` returns, a folder, device or pipe in the file's place, or the file system's refusal.
pub fn write_whole<E: From<io::Error>>(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> Result<(), E>,
) -> Result<(), E> {
    let path = check(path)?;
    fs::create_dir_all(path.parent().unwrap_or(Path::new("/")))?;
    let partial = begin(&path, Kind::File)?;
    let file = partial.handle.as_ref().expect("files are opened").try_clone()?;
    let mut out = BufWriter::new(file);
    let result = write(&mut out).and_then(|()| {
        out.flush()?;
        out.get_ref().sync_all()?;
        Ok(fs::rename(&partial.path, &path)?)
    });
    if result.is_err() {
        // Nothing better can be done about a file that cannot be removed.
        let _ = fs::remove_file(&partial.path);
    }
    result
}

/// Checks that a file may be written at `path`, and tells where that leads. Nothing is written yet.
///
/// # Errors
/// A folder, device or pipe in the file's place, or a link that leads nowhere.
pub fn check(path: &Path) -> io::Result<PathBuf> {
    let path = resolved(path)?;
    if path.is_dir() {
        return Err(io::Error::other("this is a folder; name a file"));
    }
    if path.exists() && !path.is_file() {
        return Err(io::Error::other("this is a device or pipe; name another place"));
    }
    Ok(path)
}

/// The content of a file of at most a gibibyte.
///
/// # Errors
/// A folder, device or pipe, which may never end, a larger file, or the file system's refusal.
pub fn read_regular(path: &Path) -> io::Result<Vec<u8>> {
    if !fs::metadata(path)?.is_file() {
        return Err(io::Error::other("this is a folder, device or pipe, not a file"));
    }
    let mut bytes = Vec::new();
    // One byte more than the limit tells whether the file is larger.
    File::open(path)?.take(LARGEST + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > LARGEST {
        return Err(io::Error::other(format!("the file is larger than {LARGEST} bytes")));
    }
    Ok(bytes)
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
        assert!(read_regular(&folder).is_err());
        assert_eq!(read_regular(&file).unwrap(), b"one");
        fs::remove_dir_all(folder).unwrap();
    }
}
