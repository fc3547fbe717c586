//! Malformed files collected from other projects, where they are at hand, each held to what its manifest expects.

use std::{
    fs,
    path::{Path, PathBuf},
};

use crate::jail::{Fate, Jail};

/// One row of the manifest's table.
struct Row<'a> {
    folder: PathBuf,
    path: PathBuf,
    expect: &'a str,
}

/// The rows about malformed files: `| folder | open this | bytes | source | licence | exercises | expect |`.
fn rows<'a>(manifest: &'a str, assets: &Path) -> Vec<Row<'a>> {
    let row = |line: &'a str| {
        let cells: Vec<_> = line.trim().trim_matches('|').split('|').map(str::trim).collect();
        let [folder, file, _, _, _, _, expect] = cells[..] else { return None };
        let folder = folder.starts_with("malformed/").then(|| assets.join(folder))?;
        Some(Row { path: folder.join(file), folder, expect })
    };
    manifest.lines().filter_map(row).collect()
}

/// Listed, but nothing is wrong with them. One is said to have an empty binary chunk and has one of 44 bytes, as its
/// buffer says; the other has a skin that no mesh uses.
const SOUND: [&str; 2] = ["zero-sized-bin-chunk-issue-440.glb", "issue-492.glb"];

/// What the manifest's words ask of a file. Formats that no importer claims are refused, whatever they hold.
fn fate(row: &Row<'_>) -> Fate {
    let claimed = ajar_importers::find(&row.path).is_ok();
    let (error, warning) = (row.expect.contains("error"), row.expect.contains("warning"));
    match (error, warning) {
        _ if SOUND.iter().any(|name| row.path.ends_with(name)) => Fate::Clean,
        _ if !claimed => Fate::Refused,
        (true, true) => Fate::Noticed,
        (true, false) => Fate::Refused,
        (false, true) => Fate::Warned,
        (false, false) => panic!("{}: what is {:?}?", row.path.display(), row.expect),
    }
}

#[test]
fn malformed_files_of_other_projects() {
    let shared = std::env::var_os("AJAR_SHARED")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared"), PathBuf::from);
    let assets = shared.join("assets");
    if !assets.join("malformed").is_dir() {
        println!("skipped: the shared assets are not here");
        return;
    }
    let manifest = fs::read_to_string(assets.join("MANIFEST.md")).unwrap();
    let rows = rows(&manifest, &assets);
    let folders = fs::read_dir(assets.join("malformed")).unwrap().count();
    assert!(folders > 50 && rows.len() == folders, "{} rows for {folders} folders", rows.len());
    let mut jail = Jail::new();
    let can_read_usd = std::env::var_os("AJAR_USD_PYTHON").is_some();
    if !can_read_usd {
        println!("skipped: USD files, for AJAR_USD_PYTHON is not set");
    }
    for row in rows {
        let is_usd = ajar_importers::find(&row.path).is_ok_and(|importer| importer.name() == "usd");
        match is_usd {
            true if can_read_usd => jail.try_usd(&row.path, &row.folder, fate(&row)),
            true => {}
            false => jail.try_path(&row.path, fate(&row)),
        }
    }
    jail.close();
}
