//! Programs in Python that Ajar carries with it, each with a Python of its own.
//!
//! [`environment`] finds or makes the Python; the program's text goes to it on standard input. So one file is all that
//! has to be installed.

mod environment;

use std::process::Command;

use ajar_scene::Diagnostic;
use serde_json::{Map, Value, json};

pub use self::environment::Environment;

/// Runs the package that it finds on standard input.
const LOADER: &str = include_str!("loader.py");

/// A program.
#[derive(Clone, Copy, Debug)]
pub struct Program {
    /// What it is called in its messages.
    pub name: &'static str,
    /// Its package.
    pub package: &'static str,
    /// Paths inside the package and texts: modules and what they read.
    pub files: &'static [(&'static str, &'static str)],
    /// The module whose `main()` is the program.
    pub start: &'static str,
    /// What is added to its exit codes, so that those of a Python that fails are none of them.
    pub codes: u8,
    /// What it needs.
    pub environment: Environment,
}

impl Program {
    /// A command that takes the program's arguments, and what it has to find on standard input.
    ///
    /// # Errors
    /// There is no Python for it and none can be made.
    pub fn command(&self) -> Result<(Command, Vec<u8>), Diagnostic> {
        let mut command = Command::new(self.environment.python()?);
        // Isolated: nothing in the current folder takes the place of a module.
        command.args(["-I", "-c", LOADER]);
        let files: Map<String, Value> =
            self.files.iter().map(|&(path, text)| (path.to_owned(), text.into())).collect();
        let Self { name, package, start, codes, .. } = self;
        let input =
            json!({ "program": name, "package": package, "start": start, "codes": codes, "files": files });
        Ok((command, input.to_string().into_bytes()))
    }
}

/// Paths inside a package with their texts, which lie in a folder beside the file that asks.
#[macro_export]
macro_rules! package_files {
    ($folder:literal: $($path:literal),* $(,)?) => {
        &[$(($path, include_str!(concat!($folder, "/", $path)))),*]
    };
}
