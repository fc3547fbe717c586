//! A reader sees the old file or the new one, and errors name the file that was asked for.

#![allow(clippy::unwrap_used, reason = "a failing test panics")]

use std::{fs, io, path::Path};

use ajar_output::write_atomically;

fn entries(folder: &Path) -> usize {
    fs::read_dir(folder).unwrap().count()
}

#[test]
fn a_file_is_made_and_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.bin");
    for content in ["first, and longer", "second"] {
        write_atomically(&path, |file| file.write_all(content.as_bytes())).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), content);
    }
    assert_eq!(entries(folder.path()), 1);
}

#[test]
fn failing_halfway_leaves_the_old_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.bin");
    fs::write(&path, "old").unwrap();
    let error = write_atomically(&path, |file| {
        file.write_all(&[7; 1 << 20])?;
        Err(io::Error::from(io::ErrorKind::StorageFull))
    })
    .unwrap_err();
    assert!(error.to_string().contains("out.bin"), "{error}");
    assert_eq!(fs::read_to_string(&path).unwrap(), "old");
    assert_eq!(entries(folder.path()), 1);
}

#[test]
fn the_new_file_appears_only_when_it_is_whole() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.bin");
    fs::write(&path, "old").unwrap();
    write_atomically(&path, |file| {
        file.write_all(b"new ")?;
        file.flush()?;
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        file.write_all(b"content")
    })
    .unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), "new content");
}

#[test]
fn impossible_places_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    for path in [folder.path().join("absent/out.exr"), file.join("out.exr"), folder.path().to_owned()] {
        let message = write_atomically(&path, |_| Ok(())).unwrap_err().to_string();
        assert!(message.starts_with(&path.display().to_string()), "{message}");
        assert!(!message.contains(".out.exr."), "{message}");
    }
    assert_eq!(entries(folder.path()), 1);
}

#[cfg(unix)]
mod unix {
    use std::{
        fs::{self, Permissions},
        os::unix::fs::{FileTypeExt, PermissionsExt, symlink},
        path::Path,
    };

    use ajar_output::write_atomically;

    #[test]
    fn unwritable_folders_are_named() {
        let folder = tempfile::tempdir().unwrap();
        fs::set_permissions(folder.path(), Permissions::from_mode(0o555)).unwrap();
        if fs::write(folder.path().join("probe"), "").is_ok() {
            println!("skipped: this user may write anywhere");
            return;
        }
        let path = folder.path().join("out.exr");
        let message = write_atomically(&path, |_| Ok(())).unwrap_err().to_string();
        assert!(message.starts_with(&path.display().to_string()), "{message}");
    }

    #[test]
    fn new_files_have_ordinary_permissions() {
        let folder = tempfile::tempdir().unwrap();
        let (ours, plain) = (folder.path().join("ours"), folder.path().join("plain"));
        write_atomically(&ours, |_| Ok(())).unwrap();
        fs::write(&plain, "").unwrap();
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&ours), mode(&plain));
    }

    #[test]
    fn links_stay_links() {
        let folder = tempfile::tempdir().unwrap();
        let (target, link) = (folder.path().join("v1.exr"), folder.path().join("latest.exr"));
        fs::write(&target, "old").unwrap();
        symlink("v1.exr", &link).unwrap();
        write_atomically(&link, |file| file.write_all(b"new")).unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read_to_string(&target).unwrap(), "new");
    }

    #[test]
    fn devices_are_written_to_and_not_replaced() {
        let device = Path::new("/dev/null");
        write_atomically(device, |file| file.write_all(b"gone")).unwrap();
        assert!(fs::metadata(device).unwrap().file_type().is_char_device());
    }
}
