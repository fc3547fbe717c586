//! The secret in the address of a page: who knows it may see and steer.

use std::{
    fs,
    io::{self, Write},
    path::Path,
};

/// A new one: 128 random bits as hexadecimal digits.
///
/// # Errors
/// The system has no randomness.
pub fn new() -> io::Result<String> {
    let mut bits = [0; 16];
    getrandom::fill(&mut bits).map_err(io::Error::other)?;
    Ok(bits.iter().map(|byte| format!("{byte:02x}")).collect())
}

/// The one that is kept in a file, so that pages find the program again after it was restarted; only this user may read
/// the file. A new one is written there where there is none, or one that others could read.
///
/// # Errors
/// The file cannot be written, or the system has no randomness.
pub fn kept(path: &Path) -> io::Result<String> {
    if is_private(path)
        && let Some(token) = fs::read_to_string(path).ok().filter(|token| is_token(token))
    {
        return Ok(token);
    }
    let token = new()?;
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    // Removed first: an old file may be open to others.
    let _ = fs::remove_file(path);
    let mut options = fs::File::options();
    options.write(true).create_new(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    options.open(path)?.write_all(token.as_bytes())?;
    Ok(token)
}

/// Whether nobody else may read the file.
fn is_private(path: &Path) -> bool {
    #[cfg(unix)]
    return fs::metadata(path)
        .is_ok_and(|file| std::os::unix::fs::PermissionsExt::mode(&file.permissions()) & 0o077 == 0);
    #[cfg(not(unix))]
    return path.is_file();
}

fn is_token(text: &str) -> bool {
    text.len() == 32 && text.bytes().all(|byte| byte.is_ascii_hexdigit())
}

/// Whether two texts are the same; how long it takes tells nothing about where they differ.
pub fn is_same(a: &str, b: &str) -> bool {
    blake3::hash(a.as_bytes()) == blake3::hash(b.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_token_is_kept_for_this_user_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("ajar/token");
        let token = kept(&path).unwrap();
        assert!(is_token(&token));
        assert_eq!(kept(&path).unwrap(), token);
        assert_ne!(new().unwrap(), token);
        #[cfg(unix)]
        {
            let mode = std::os::unix::fs::PermissionsExt::mode(&path.metadata().unwrap().permissions());
            assert_eq!(mode & 0o777, 0o600);
        }
        fs::write(&path, "guessed").unwrap();
        assert!(is_token(&kept(&path).unwrap()), "what is no token is replaced");
    }

    #[test]
    fn tokens_are_compared() {
        assert!(is_same("abc", "abc") && !is_same("abc", "abd") && !is_same("abc", ""));
    }
}
