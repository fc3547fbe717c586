//! Malformed files collected from other projects, where they are at hand, each held to what its manifest expects.

use std::{
    fs,
    path::{Path, PathBuf},
};

use crate::jail::{Fate, Jail};

/// One row of the manifest's table.
struct Row<'a> {
    path: PathBuf,
    expect: &'a str,
}

/// The rows about malformed files: `| folder | open this | bytes | source | licence | exercises | expect |`.
fn rows<'a>(manifest: &'a str, assets: &Path) -> Vec<Row<'a>> {
    let row = |line: &'a str| {
        let cells: Vec<_> = line.trim().trim_matches('|').split('|').map(str::trim).collect();
        let [folder, file, _, _, _, _, expect] = cells[..] else { return None };
        folder.starts_with("malformed/").then(|| Row { path: assets.join(folder).join(file), expect })
    };
    manifest.lines().filter_map(row).collect()
}

/// Listed as having an empty binary chunk, but it has one of 44 bytes, as its buffer says, and nothing else is wrong.
const SOUND: &str = "zero-sized-bin-chunk-issue-440.glb";

/// What the manifest's words ask of a file. Formats that no importer claims are refused, whatever they hold.
fn fate(row: &Row<'_>) -> Fate {
    let claimed = ajar_importers::find(&row.path).is_ok();
    let (error, warning) = (row.expect.contains("error"), row.expect.contains("warning"));
    match (error, warning) {
        _ if row.path.ends_with(SOUND) => Fate::Clean,
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
    for row in rows {
        jail.try_path(&row.path, fate(&row));
    }
    jail.close();
}
