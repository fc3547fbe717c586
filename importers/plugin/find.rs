//! Which plug-ins there are and what they claim.

use std::{
    collections::BTreeMap,
    env, fs,
    path::{Path, PathBuf},
    process::Command,
    sync::OnceLock,
    time::Duration,
};

use ajar_scene::{Cause, Diagnostic};
use serde::Deserialize;

use super::{config, process::Program};

const PREFIX: &str = "ajar-import-";
const PROTOCOL: u64 = 1;
const PROBE_TIME: Duration = Duration::from_secs(10);
const PROBE_SIZE: u64 = 1 << 16;

/// An executable and what it says of itself.
#[derive(Clone, Debug)]
pub(crate) struct PlugIn {
    pub program: PathBuf,
    extensions: Vec<String>,
    heads: Vec<Vec<u8>>,
}

impl PlugIn {
    /// Its name, for messages.
    pub fn name(&self) -> String {
        self.program.file_stem().unwrap_or_default().to_string_lossy().into_owned()
    }
}

/// What `--probe` prints.
#[derive(Deserialize)]
struct Probe {
    protocol: u64,
    extensions: Vec<String>,
    #[serde(default)]
    heads: Vec<String>,
}

/// The plug-in that claims the file: by its extension, else by its first bytes.
///
/// # Errors
/// No plug-in claims it and some plug-in could not be asked: it might have.
pub(crate) fn claimant(path: &Path, head: &[u8]) -> Result<Option<PlugIn>, Diagnostic> {
    static ASKED: OnceLock<Vec<Result<PlugIn, Diagnostic>>> = OnceLock::new();
    let asked = ASKED.get_or_init(|| match programs() {
        Ok(programs) => programs.into_values().map(|program| probe(&program)).collect(),
        Err(error) => vec![Err(error)],
    });
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_lowercase();
    let by_extension = asked.iter().flatten().find(|plug_in| plug_in.extensions.contains(&extension));
    let begins = |plug_in: &&PlugIn| plug_in.heads.iter().any(|bytes| head.starts_with(bytes));
    let claim = by_extension.or_else(|| asked.iter().flatten().find(begins)).cloned();
    match (claim, asked.iter().find_map(|plug_in| plug_in.as_ref().err())) {
        (None, Some(error)) => Err(error.clone()),
        (claim, _) => Ok(claim),
    }
}

/// All plug-ins by name; those that the user's settings name go before those on the search path.
fn programs() -> Result<BTreeMap<String, PathBuf>, Diagnostic> {
    let mut found = executables();
    found.extend(config::plug_ins()?.into_iter().map(|(name, program)| (format!("{PREFIX}{name}"), program)));
    Ok(found)
}

/// The plug-ins on the search path by name; the first of a name wins.
fn executables() -> BTreeMap<String, PathBuf> {
    let mut found = BTreeMap::new();
    let folders = env::var_os("PATH").unwrap_or_default();
    for folder in env::split_paths(&folders) {
        for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
            let name = entry.file_name().to_string_lossy().into_owned();
            if name.starts_with(PREFIX) && is_executable(&entry.path()) {
                found.entry(name).or_insert_with(|| entry.path());
            }
        }
    }
    found
}

#[cfg(unix)]
fn is_executable(path: &Path) -> bool {
    use std::os::unix::fs::PermissionsExt;
    path.metadata().is_ok_and(|info| info.is_file() && info.permissions().mode() & 0o111 != 0)
}

#[cfg(not(unix))]
fn is_executable(path: &Path) -> bool {
    path.is_file()
}

fn probe(program: &Path) -> Result<PlugIn, Diagnostic> {
    let mut command = Command::new(program);
    command.arg("--probe");
    let failed = |why: String| {
        let error = Diagnostic::error(format!("the plug-in cannot be used: --probe {why}"));
        error.in_file(program).because(Cause::System)
    };
    let end = Program { command, input: Vec::new(), silence: PROBE_TIME, most: PROBE_SIZE }
        .run()
        .map_err(|failure| failed(failure.to_string()))?;
    if !end.status.success() {
        return Err(failed(format!("ended with {}", end.status)));
    }
    let probe: Probe =
        serde_json::from_slice(&end.output).map_err(|e| failed(format!("printed something else: {e}")))?;
    if probe.protocol != PROTOCOL {
        return Err(failed(format!("speaks protocol {}, only {PROTOCOL} is known", probe.protocol)));
    }
    let heads = probe.heads.iter().map(|text| bytes(text).filter(|bytes| !bytes.is_empty()));
    let heads = heads
        .collect::<Option<_>>()
        .ok_or_else(|| failed("printed heads that are not hexadecimal".into()))?;
    let extensions = probe.extensions.iter().map(|e| e.trim_start_matches('.').to_lowercase()).collect();
    Ok(PlugIn { program: program.to_owned(), extensions, heads })
}

/// Bytes written in hexadecimal.
fn bytes(text: &str) -> Option<Vec<u8>> {
    let pairs = text.as_bytes().chunks(2);
    pairs
        .map(|pair| u8::from_str_radix(std::str::from_utf8(pair).ok().filter(|p| p.len() == 2)?, 16).ok())
        .collect()
}
