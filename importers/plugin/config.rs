//! The user's settings: `ajar/config.toml` in the folder for settings, in which `[plugins]` names programs.
//!
//! Scene files cannot name programs: who opens one from elsewhere would run them.

use std::{
    collections::BTreeMap,
    env, fs, io,
    path::{Path, PathBuf},
};

use ajar_scene::{Cause, Diagnostic};
use serde::Deserialize;

/// What the file holds.
#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Config {
    /// Programs by name, relative to the file's folder.
    #[serde(default)]
    plugins: BTreeMap<String, PathBuf>,
}

/// The programs that `[plugins]` names; none without a file.
///
/// # Errors
/// The file cannot be read or is malformed.
pub(super) fn plug_ins() -> Result<BTreeMap<String, PathBuf>, Diagnostic> {
    let Some(path) = place() else { return Ok(BTreeMap::new()) };
    let refuse = |why: String| Diagnostic::error(why).in_file(&path).because(Cause::System);
    let text = match fs::read_to_string(&path) {
        Ok(text) => text,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(BTreeMap::new()),
        Err(error) => return Err(refuse(format!("cannot be read: {error}"))),
    };
    let config: Config =
        toml::from_str(&text).map_err(|error| refuse(format!("is malformed: {}", error.message())))?;
    let folder = path.parent().unwrap_or(Path::new("."));
    Ok(config.plugins.into_iter().map(|(name, program)| (name, folder.join(program))).collect())
}

/// `$XDG_CONFIG_HOME/ajar/config.toml`, else that in `~/.config`.
fn place() -> Option<PathBuf> {
    let named = |variable| env::var_os(variable).filter(|value| !value.is_empty()).map(PathBuf::from);
    let home = || named("HOME").or_else(|| named("USERPROFILE")).map(|home| home.join(".config"));
    Some(named("XDG_CONFIG_HOME").or_else(home)?.join("ajar/config.toml"))
}
