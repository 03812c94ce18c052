//! Files that are either there, whole, or not there.
//!
//! In: bytes. Out: a file under its final name. The invariant: whatever goes wrong, the old file (or
//! none) stands under that name, and no temporary file is left beside it.

use std::fs::File;
use std::io::{self, Write};
use std::path::Path;

use tempfile::{Builder, NamedTempFile};

/// A file under a temporary name in the folder of its final one; dropped, it vanishes.
fn beside(path: &Path) -> io::Result<NamedTempFile> {
    let prefix = format!(".{}.", path.file_name().unwrap_or_default().to_string_lossy());
    let mut builder = Builder::new();
    builder.prefix(&prefix).suffix(".tmp");
    // Readable for others as every new file is, which temporary files are not.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder_of(path))
}

/// Writes `bytes` as the file `path`: a temporary name in the same folder, synchronised to the disk, then
/// renamed. An existing file is replaced.
///
/// # Errors
/// What the file system said; the old file is then untouched.
pub fn write_bytes(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut temporary = beside(path)?;
    temporary.write_all(bytes)?;
    temporary.as_file().sync_all()?;
    temporary.persist(path)?;
    // The rename itself survives a power cut once the folder is on the disk, where folders can be synchronised.
    if let Ok(folder) = File::open(folder_of(path)) {
        let _ = folder.sync_all();
    }
    Ok(())
}

/// Finds out whether [`write_bytes`] could create a file of that name, by creating and removing one
/// beside it.
///
/// # Errors
/// What the file system said.
pub(super) fn probe(path: &Path) -> io::Result<()> {
    beside(path).map(drop)
}

/// The folder that a file lies in; the current one where the path names none.
pub(super) fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> =
            fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// An existing file is replaced and nothing else is left in the folder.
    #[test]
    fn replaces_and_leaves_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        write_bytes(&path, b"one").unwrap();
        write_bytes(&path, b"two").unwrap();
        probe(&path).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"two");
        assert_eq!(names(folder.path()), ["a.txt"]);
        // As readable as any other new file.
        let other = folder.path().join("other");
        fs::write(&other, b"").unwrap();
        let of = |path: &Path| fs::metadata(path).unwrap().permissions();
        assert_eq!(of(&path), of(&other));
    }

    /// Where the last step fails, the temporary file is gone again.
    #[test]
    fn a_failure_leaves_no_temporary_file() {
        let folder = tempfile::tempdir().unwrap();
        let taken = folder.path().join("folder");
        fs::create_dir(&taken).unwrap();
        fs::write(taken.join("x"), b"").unwrap();
        assert!(write_bytes(&taken, b"bytes").is_err());
        assert_eq!(names(folder.path()), ["folder"]);
    }
}
