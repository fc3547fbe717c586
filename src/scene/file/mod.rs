//! `scene.toml`, the program's own scene file: it places imported assets, adds cameras and lights, changes materials and
//! says how to render. `docs/scene-file.md` is its reference.
//!
//! Reading is by hand instead of through `serde` derives because every mistake is to be reported at once, each with line,
//! column and advice, where a deserializer stops at the first.

mod camera;
mod choice;
mod glob;
mod keys;
mod lamp;
mod layers;
mod light;
mod load;
mod material;
mod node;
mod overrides;
mod placement;
mod report;
mod settings;
mod shown;
mod source;
#[cfg(test)]
mod tests;
mod texture;
mod value;

use std::path::PathBuf;

pub use load::{load, load_asset};
pub use overrides::Overrides;
pub use source::Setting;

use crate::{Diagnostic, OutputSettings, RenderSettings, Scene, VariantSet};

/// The JSON Schema of scene files, for editors that complete and check them.
pub const SCHEMA: &str = include_str!("schema.json");

/// An asset that has variants.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct VariedImport {
    /// What `[[import]]` tables call it.
    pub name: String,
    /// Its variants.
    pub variants: Vec<VariantSet>,
}

/// What a scene file says.
#[derive(Clone, Debug)]
pub struct SceneFile {
    /// The scene: imports merged and placed, with cameras and lights added and materials changed. Not yet validated.
    pub scene: Scene,
    /// How to render.
    pub render: RenderSettings,
    /// What to write.
    pub output: OutputSettings,
    /// Warnings and notes of the file and its imports.
    pub diagnostics: Vec<Diagnostic>,
    /// Every file that was read, for watch mode; the scene file comes first.
    pub files: Vec<PathBuf>,
    /// The imports that have variants.
    pub varied: Vec<VariedImport>,
    /// Every value that was read, and who set it.
    pub settings: Vec<Setting>,
}
