//! The file that a command opens, and how; the same for all commands.

use std::path::PathBuf;

use ajar_scene::{Diagnostic, SceneFile, Severity};

use super::arguments::parse_bytes;
use crate::session::{self, LoadOptions, Loaded};

#[derive(Debug, clap::Args)]
pub(super) struct Input {
    /// scene.toml, or any file that `ajar formats` lists
    pub file: PathBuf,
    /// Change what the file says, by the keys of a scene file: material.Chrome.roughness=0.2
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Treat everything that was approximated or dropped as an error
    #[arg(long)]
    strict: bool,
    /// Most memory for geometry and for decoded textures, each: 512M, 8G
    #[arg(long, value_name = "SIZE", value_parser = parse_bytes, default_value = "8G")]
    pub memory_limit: u64,
}

impl Input {
    /// Opens the file. `size` is that of the film where the command line states it.
    pub fn load(&self, size: Option<[u32; 2]>) -> Result<Loaded, Vec<Diagnostic>> {
        session::load(&self.file, &self.options(size))
    }

    /// Opens the file as it is: no camera or light is added.
    pub fn open(&self) -> Result<SceneFile, Vec<Diagnostic>> {
        session::open(&self.file, &self.options(None))
    }

    fn options(&self, size: Option<[u32; 2]>) -> LoadOptions<'_> {
        LoadOptions { size, set: &self.set, strict: self.strict, memory_limit: self.memory_limit }
    }

    /// The least severity that makes a file unfit.
    pub fn least(&self) -> Severity {
        if self.strict { Severity::Warning } else { Severity::Error }
    }
}
