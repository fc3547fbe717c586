//! Files read whole. Only regular ones: opening a pipe would wait for who writes to it, and devices have no end.

use std::{
    fs::File,
    io::{self, Read},
    path::Path,
};

use ajar_scene::{Cause, Diagnostic};

/// The bytes of a file of at most `limit` bytes.
///
/// # Errors
/// It cannot be read, is no regular file, or is larger, which is a matter of resources.
pub(crate) fn read(path: &Path, limit: u64) -> Result<Vec<u8>, Diagnostic> {
    let size = size(path)?;
    if size > limit {
        let error =
            Diagnostic::error(format!("{size} bytes are more than the memory limit of {limit} bytes"));
        return Err(error.in_file(path).because(Cause::Resource).hint("--memory-limit raises it"));
    }
    let mut bytes = Vec::with_capacity(size as usize);
    let file = File::open(path).map_err(|e| unreadable(path, e))?;
    file.take(size).read_to_end(&mut bytes).map_err(|e| unreadable(path, e))?;
    Ok(bytes)
}

/// The first `most` bytes of a file.
///
/// # Errors
/// It cannot be read or is no regular file.
pub(crate) fn head(path: &Path, most: u64) -> Result<Vec<u8>, Diagnostic> {
    size(path)?;
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(|e| unreadable(path, e))?;
    file.take(most).read_to_end(&mut bytes).map_err(|e| unreadable(path, e))?;
    Ok(bytes)
}

/// Bytes of a regular file, which is not opened for it.
///
/// # Errors
/// It cannot be looked at or is no regular file.
pub(crate) fn size(path: &Path) -> Result<u64, Diagnostic> {
    let info = path.metadata().map_err(|e| unreadable(path, e))?;
    let refuse = || Diagnostic::error("is not a regular file").in_file(path);
    if info.is_file() { Ok(info.len()) } else { Err(refuse()) }
}

fn unreadable(path: &Path, error: io::Error) -> Diagnostic {
    Diagnostic::error(format!("cannot be read: {error}")).in_file(path)
}
