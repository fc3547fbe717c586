//! A Python that has certain packages: one that the user names, or one made in the user's cache folder on first use.

use std::{
    env, fs,
    path::{Path, PathBuf},
    process::{self, Command, Stdio},
};

use ajar_scene::{Cause, Diagnostic};

const PYTHON: &str = if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" };

/// What a program needs of Python.
#[derive(Clone, Copy, Debug)]
pub struct Environment {
    /// Those who need it, for messages: "USD files".
    pub purpose: &'static str,
    /// The variable that names a Python that has the packages.
    pub variable: &'static str,
    /// What is installed, as `pip` takes it.
    pub packages: &'static [&'static str],
    /// The versions of Python that they are there for.
    pub versions: &'static str,
    /// The environment's name in the cache. It has to change whenever the packages do.
    pub name: &'static str,
}

impl Environment {
    /// The Python.
    ///
    /// # Errors
    /// There is none and none can be made.
    pub fn python(&self) -> Result<PathBuf, Diagnostic> {
        if let Some(python) = named(self.variable) {
            // A name without folder is looked for on the search path.
            return if python.components().count() > 1 && !python.exists() {
                let message = format!("{} names {}, which is not there", self.variable, python.display());
                Err(Diagnostic::error(message).because(Cause::System))
            } else {
                Ok(python)
            };
        }
        let folder = self.cache()?.join("ajar").join(self.name);
        let python = folder.join(PYTHON);
        if !python.exists() {
            eprintln!(
                "ajar: installing Python packages for {} into {}, once",
                self.purpose,
                folder.display()
            );
            self.make(&folder)?;
        }
        Ok(python)
    }

    fn cache(&self) -> Result<PathBuf, Diagnostic> {
        let home = || named("HOME").or_else(|| named("USERPROFILE")).map(|home| home.join(".cache"));
        named("XDG_CACHE_HOME").or_else(home).ok_or_else(|| {
            let message =
                format!("no folder for the Python environment that {} need: HOME is not set", self.purpose);
            Diagnostic::error(message).because(Cause::System).hint(self.hint())
        })
    }

    fn hint(&self) -> String {
        let mut names: Vec<_> =
            self.packages.iter().filter_map(|package| package.split("==").next()).collect();
        names.dedup();
        format!("{} may name a Python that has {}", self.variable, names.join(", "))
    }

    /// Makes the environment beside its place and moves it there: what is there is complete, also when two make it.
    fn make(&self, folder: &Path) -> Result<(), Diagnostic> {
        let begun = folder.with_extension(format!("part-{}", process::id()));
        let build = self.commands(&begun).iter().try_for_each(|words| run(words));
        let made = build.and_then(|()| {
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
            let message = format!("the Python environment that {} need cannot be made: {why}", self.purpose);
            Diagnostic::error(message).because(Cause::System).hint(format!(
                "with a network and Python {}, run: {}\n    or: {}",
                self.versions,
                self.by_hand(folder),
                self.hint()
            ))
        })
    }

    /// What makes the environment, as a command for a shell.
    fn by_hand(&self, folder: &Path) -> String {
        let quoted = |word: &String| if word.contains(' ') { format!("\"{word}\"") } else { word.clone() };
        let line = |words: &Vec<String>| words.iter().map(quoted).collect::<Vec<_>>().join(" ");
        self.commands(folder).iter().map(line).collect::<Vec<_>>().join(" && ")
    }

    /// What makes the environment in `folder`: `uv` where it is there, which is quicker, else Python's own tools.
    fn commands(&self, folder: &Path) -> [Vec<String>; 2] {
        let (place, python) = (folder.to_string_lossy(), folder.join(PYTHON));
        let python = python.to_string_lossy();
        let (make, fill) = if run(&["uv".into(), "--version".into()]).is_ok() {
            (
                vec!["uv", "venv", "--quiet", &place],
                vec!["uv", "pip", "install", "--quiet", "--python", &python],
            )
        } else {
            let fill = vec![&*python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"];
            (vec!["python3", "-m", "venv", &place], fill)
        };
        [make, [fill, self.packages.to_vec()].concat()]
            .map(|words| words.into_iter().map(String::from).collect())
    }
}

/// The path in an environment variable that is set.
fn named(variable: &str) -> Option<PathBuf> {
    env::var_os(variable).filter(|value| !value.is_empty()).map(PathBuf::from)
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
