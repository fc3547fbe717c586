//! Files that are never half written.
//!
//! New bytes go into a temporary file beside the destination, are synced to the disk and take the destination's name in
//! one rename (POSIX `rename`: another process sees the old file or the new one). Then the folder is synced, so the
//! name survives a power cut too.

use std::{
    fs::{self, File},
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
};

use crate::OutputError;

/// Replaces the file at `path` by what `fill` writes. A link keeps pointing where it did and its target is replaced; a
/// pipe or device (`/dev/null`) is written to directly, for it must not be renamed over.
///
/// # Errors
/// [`OutputError::Write`] names `path`. Then the old file is still there, unchanged, and nothing else is left behind.
pub fn write_atomically(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), OutputError> {
    replace(path, fill).map_err(|source| OutputError::Write { path: path.to_owned(), source })
}

fn replace(path: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let target = match fs::metadata(path) {
        Ok(existing) if existing.is_dir() => return Err(io::ErrorKind::IsADirectory.into()),
        Ok(existing) if existing.is_file() => fs::canonicalize(path)?,
        Ok(_) => return write_through(&File::options().write(true).open(path)?, fill),
        Err(_) => path.to_owned(),
    };
    let folder = folder_of(&target);
    let temporary = temporary_file(&target, &folder)?;
    write_through(temporary.as_file(), fill)?;
    temporary.as_file().sync_all()?;
    temporary.persist(&target).map_err(|error| error.error)?;
    sync_folder(&folder)
}

fn write_through(file: &File, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut writer = BufWriter::new(file);
    fill(&mut writer)?;
    writer.flush()
}

fn folder_of(target: &Path) -> PathBuf {
    match target.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.to_owned(),
        _ => PathBuf::from("."),
    }
}

/// A hidden file that vanishes when dropped. It is opened here and not by the library, which would make it private to
/// this user and put its random name into errors.
fn temporary_file(target: &Path, folder: &Path) -> io::Result<tempfile::NamedTempFile> {
    let name = target.file_name().ok_or(io::ErrorKind::InvalidFilename)?;
    let prefix = format!(".{}.", name.to_string_lossy());
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(".tmp");
    builder.make_in(folder, |path| File::options().write(true).create_new(true).open(path))
}

#[cfg(unix)]
fn sync_folder(folder: &Path) -> io::Result<()> {
    File::open(folder)?.sync_all()
}

#[cfg(not(unix))]
fn sync_folder(_folder: &Path) -> io::Result<()> {
    Ok(())
}
