//! Malformed files collected from other projects, where they are at hand.

use std::{
    fs,
    path::{Path, PathBuf},
};

use crate::jail::{Fate, Jail};

fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    let mut entries: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() { files(&path, found) } else { found.push(path) }
    }
}

#[test]
fn malformed_files_of_other_projects() {
    let shared = std::env::var_os("AJAR_SHARED")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared"), PathBuf::from);
    let folder = shared.join("assets/malformed");
    if !folder.is_dir() {
        println!("skipped: the shared assets are not here");
        return;
    }
    let mut found = Vec::new();
    files(&folder, &mut found);
    assert!(found.len() > 50, "{} files", found.len());
    let mut jail = Jail::new();
    for path in found {
        jail.try_path(&path, Fate::Either);
    }
    jail.close();
}
