//! The rules of the house that the compiler does not check. `ARCHITECTURE.md` says why.

#![expect(clippy::unwrap_used, reason = "a test may fail by panic")]

use std::{
    fs,
    path::{Path, PathBuf},
};

/// What lies at the top besides files whose name begins with a dot and what builds leave behind.
const TOP: &[&str] = &[
    "ARCHITECTURE.md",
    "CHANGELOG.md",
    "Cargo.lock",
    "Cargo.toml",
    "LICENSE-APACHE",
    "LICENSE-MIT",
    "README.md",
    "clippy.toml",
    "docs",
    "importers",
    "scenes",
    "src",
    "tests",
    "tools",
];

/// Folders that builds and tools make.
const MADE: &[&str] = &["target", ".venv", ".git", "__pycache__", "out", "ajar-artifacts"];

/// Which crate may import which.
const FLOORS: &[(&str, &[&str])] = &[
    ("src/scene", &[]),
    ("src/live", &[]),
    ("importers", &["scene"]),
    ("src/render", &["scene"]),
    ("src/integrators", &["render", "scene"]),
    ("src/output", &["render", "scene"]),
];

const LONGEST_FILE: usize = 400;

/// Fails with all offenders below the rule.
fn hold(rule: &str, offenders: &[String]) {
    assert!(offenders.is_empty(), "{rule}:\n  {}", offenders.join("\n  "));
}

/// All files below `folder` that a person wrote, as paths from the top with `/`, sorted.
fn files(folder: &str) -> Vec<String> {
    let (mut found, mut open) = (Vec::new(), vec![PathBuf::from(folder)]);
    while let Some(folder) = open.pop() {
        for entry in fs::read_dir(top().join(&folder)).into_iter().flatten().flatten() {
            let (name, kind) = (entry.file_name(), entry.file_type().unwrap());
            let path = folder.join(&name);
            let name = name.to_string_lossy();
            if MADE.contains(&name.as_ref()) || name.ends_with(".egg-info") {
                continue;
            } else if kind.is_dir() {
                open.push(path);
            } else if kind.is_file() {
                found.push(path.to_string_lossy().replace('\\', "/"));
            }
        }
    }
    found.sort();
    found
}

fn top() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The text of a file, or nothing if it is not text.
fn text(path: &str) -> Option<String> {
    fs::read_to_string(top().join(path)).ok()
}

/// Lines of the Rust files below `folders` for which `bad` holds, as `path:line: text`. Tests and examples are left out:
/// files and folders of that name, and what follows `#[cfg(test)]` before a module.
fn lines(folders: &[&str], bad: impl Fn(&str, &str) -> bool) -> Vec<String> {
    let mut found = Vec::new();
    for path in folders.iter().flat_map(|folder| files(folder)).filter(|path| path.ends_with(".rs")) {
        if ["/tests/", "/tests.rs", "/examples/"].iter().any(|part| path.contains(part)) {
            continue;
        }
        let text = text(&path).unwrap_or_default();
        let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
        let hits = code.lines().enumerate().filter(|(_, line)| bad(&path, line));
        found.extend(hits.map(|(at, line)| format!("{path}:{}: {}", at + 1, line.trim())));
    }
    found
}

#[test]
fn the_top_level_holds_what_it_should() {
    let there: Vec<String> =
        fs::read_dir(top()).unwrap().map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
    let strange = there.iter().filter(|name| {
        !name.starts_with('.') && !TOP.contains(&name.as_str()) && !MADE.contains(&name.as_str())
    });
    let missing = TOP.iter().filter(|name| !there.iter().any(|there| there == *name));
    let mut offenders: Vec<_> = strange.map(|name| format!("{name} does not belong there")).collect();
    offenders.extend(missing.map(|name| format!("{name} is missing")));
    offenders.sort();
    hold("the top level", &offenders);
}

#[test]
fn crates_import_only_from_floors_below() {
    let mut offenders = Vec::new();
    let manifests = files("src").into_iter().chain(files("importers"));
    for manifest in manifests.filter(|path| path.ends_with("/Cargo.toml")) {
        let folder = manifest.trim_end_matches("/Cargo.toml");
        let Some((_, allowed)) = FLOORS.iter().find(|(floor, _)| *floor == folder) else {
            offenders.push(format!("{folder} is a crate that no floor is set for"));
            continue;
        };
        let text = text(&manifest).unwrap_or_default();
        let mut section = "";
        for line in text.lines().map(str::trim) {
            if line.starts_with('[') {
                section = line;
            }
            // `[dependencies]`, of a target too, and `[dependencies.ajar-x]`; tests may use what they like.
            let dependency = line.trim_start_matches("[dependencies.").strip_prefix("ajar-");
            let Some(name) =
                dependency.filter(|_| section.contains("dependencies") && !section.contains("dev-"))
            else {
                continue;
            };
            let name = name.split(['.', ' ', '=', ']']).next().unwrap_or_default();
            if !allowed.contains(&name) {
                offenders.push(format!("{folder} imports {name}; it may import {allowed:?}"));
            }
        }
    }
    hold("crates import only from floors below", &offenders);
}

#[test]
fn files_are_short() {
    let code = files(".").into_iter().filter(|path| path.ends_with(".rs") || path.ends_with(".py"));
    let mut lengths: Vec<_> =
        code.filter_map(|path| text(&path).map(|text| (text.lines().count(), path))).collect();
    lengths.sort_unstable();
    if let Some((median, _)) = lengths.get(lengths.len() / 2) {
        println!("{} files, median {median} lines", lengths.len());
    }
    let long = lengths.into_iter().filter(|(length, _)| *length > LONGEST_FILE);
    let offenders: Vec<_> = long.map(|(length, path)| format!("{path}: {length} lines")).collect();
    hold(&format!("no file is longer than {LONGEST_FILE} lines"), &offenders);
}

#[test]
fn libraries_print_nothing() {
    let print = |_: &str, line: &str| line.contains("print!") || line.contains("println!");
    hold("only the program prints", &lines(&["src/scene", "src/render", "src/integrators"], print));
}

#[test]
fn no_clock_and_no_hash_order_reaches_a_pixel() {
    let rooms = ["src/render", "src/integrators"];
    let clock = |path: &str, line: &str| {
        path != "src/integrators/stop.rs" && (line.contains("std::time") || line.contains("Instant"))
    };
    hold("only the rules of stopping look at the clock", &lines(&rooms, clock));
    let hashed = |_: &str, line: &str| {
        let named = line.contains("HashMap") || line.contains("HashSet");
        named && !line.contains("// lookup only") && !line.trim_start().starts_with("use ")
    };
    hold("hash maps are marked `// lookup only`", &lines(&rooms, hashed));
}

#[test]
fn no_text_names_a_machine() {
    // Put together here, so that this file does not name them.
    let paths = ["work/", "root/", "tmp/brief"].map(|folder| format!("/{folder}"));
    let mut offenders = Vec::new();
    for path in files(".") {
        let text = text(&path).unwrap_or_default();
        let hits =
            text.lines().enumerate().filter(|(_, line)| paths.iter().any(|p| line.contains(p.as_str())));
        offenders.extend(hits.map(|(at, _)| format!("{path}:{}", at + 1)));
    }
    hold("no file names a path of one machine", &offenders);
}

#[test]
fn every_scene_is_complete() {
    let mut offenders = Vec::new();
    for entry in fs::read_dir(top().join("scenes")).unwrap().flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        if !entry.path().is_dir() || name == "modelling" || MADE.contains(&name.as_str()) {
            continue;
        }
        let has = |file: &str| entry.path().join(file).is_file();
        let scene = if has("scene.usda") { "scene.usda" } else { "scene.toml" };
        let missing = [scene, "LICENSE.md", "generate.py"].into_iter().filter(|file| !has(file));
        offenders.extend(missing.map(|file| format!("scenes/{name} has no {file}")));
    }
    offenders.sort();
    hold("every scene says what it is, whose it is and how it was made", &offenders);
}
