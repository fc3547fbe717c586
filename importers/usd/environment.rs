//! The Python that has usd-core: one that the user names, or one made in the user's cache folder on first use.

use std::{
    env, fs,
    path::{Path, PathBuf},
    process::{self, Command, Stdio},
};

use ajar_scene::{Cause, Diagnostic};

/// Names a Python that has the packages.
const OVERRIDE: &str = "AJAR_USD_PYTHON";
const PACKAGES: [&str; 3] = ["usd-core==26.11", "materialx==1.39.5", "numpy==2.4.6"];
/// The environment's name in the cache. It changes whenever the packages do.
const NAME: &str = "usd-26.11-materialx-1.39.5";
const PYTHON: &str = if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" };

/// The Python to run the importer with.
///
/// # Errors
/// There is none and none can be made.
pub(super) fn python() -> Result<PathBuf, Diagnostic> {
    if let Some(python) = named(OVERRIDE) {
        // A name without folder is looked for on the search path.
        return if python.components().count() > 1 && !python.exists() {
            let message = format!("{OVERRIDE} names {}, which is not there", python.display());
            Err(Diagnostic::error(message).because(Cause::System))
        } else {
            Ok(python)
        };
    }
    let folder = cache()?.join("ajar").join(NAME);
    let python = folder.join(PYTHON);
    if !python.exists() {
        eprintln!("ajar: installing {} for USD files into {}", PACKAGES.join(", "), folder.display());
        make(&folder)?;
    }
    Ok(python)
}

/// The path in an environment variable that is set.
fn named(variable: &str) -> Option<PathBuf> {
    env::var_os(variable).filter(|value| !value.is_empty()).map(PathBuf::from)
}

fn cache() -> Result<PathBuf, Diagnostic> {
    let home = || named("HOME").or_else(|| named("USERPROFILE")).map(|home| home.join(".cache"));
    named("XDG_CACHE_HOME").or_else(home).ok_or_else(|| {
        Diagnostic::error("no folder for the Python environment that USD files need: HOME is not set")
            .because(Cause::System)
            .hint(override_hint())
    })
}

fn override_hint() -> String {
    format!("{OVERRIDE} may name a Python that has {}", PACKAGES.join(", "))
}

/// Makes the environment beside its place and moves it there: what is there is complete, also when two make it.
fn make(folder: &Path) -> Result<(), Diagnostic> {
    let begun = folder.with_extension(format!("part-{}", process::id()));
    let made = build(&begun).and_then(|()| {
        // What is there without a Python is broken.
        let broken = folder.exists() && !folder.join(PYTHON).exists();
        let cleared = if broken { fs::remove_dir_all(folder) } else { Ok(()) };
        match cleared.and_then(|()| fs::rename(&begun, folder)) {
            Err(error) if !folder.join(PYTHON).exists() => Err(format!("{}: {error}", folder.display())),
            _ => Ok(()),
        }
    });
    // Left only by a failure, or where another process was first.
    let _ = fs::remove_dir_all(&begun);
    made.map_err(|why| {
        let message = format!("the Python environment that USD files need cannot be made: {why}");
        Diagnostic::error(message).because(Cause::System).hint(format!(
            "with a network and Python 3.11 to 3.14, run: {}\n    or: {}",
            by_hand(folder),
            override_hint()
        ))
    })
}

/// What makes the environment, as a command for a shell.
fn by_hand(folder: &Path) -> String {
    let lines: Vec<_> = commands(folder).iter().map(|words| words.join(" ")).collect();
    lines.join(" && ")
}

/// What makes the environment in `folder`: `uv` where it is there, which is quicker, else Python's own tools.
fn commands(folder: &Path) -> [Vec<String>; 2] {
    let (place, python) = (folder.to_string_lossy(), folder.join(PYTHON));
    let python = python.to_string_lossy();
    let (make, fill) = if run(&["uv".into(), "--version".into()]).is_ok() {
        (vec!["uv", "venv", "--quiet", &place], vec!["uv", "pip", "install", "--quiet", "--python", &python])
    } else {
        let fill = vec![&*python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"];
        (vec!["python3", "-m", "venv", &place], fill)
    };
    [make, [fill, PACKAGES.to_vec()].concat()].map(|words| words.into_iter().map(String::from).collect())
}

fn build(folder: &Path) -> Result<(), String> {
    commands(folder).iter().try_for_each(|words| run(words))
}

/// Runs a command; the last line that it says is the reason of its failure.
fn run(words: &[String]) -> Result<(), String> {
    let [program, arguments @ ..] = words else { return Ok(()) };
    let end = Command::new(program).args(arguments).stdin(Stdio::null()).output();
    let end = end.map_err(|e| format!("{program}: {e}"))?;
    if end.status.success() {
        return Ok(());
    }
    let said = String::from_utf8_lossy(&end.stderr);
    let last = said.trim().lines().last().unwrap_or_default();
    Err(format!("{program} ended with {}: {last}", end.status))
}
