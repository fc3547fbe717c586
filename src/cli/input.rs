//! The file that a command opens, and how; the same for all commands.

use std::path::PathBuf;

use ajar_scene::{Choice, Diagnostic, Moment, Overrides, SceneFile, Severity};
use toml::Table;

use super::arguments::{parse_bytes, parse_fps, parse_number};
use crate::{
    session::{self, LoadOptions, Loaded, Reading},
    watch::Said,
};

#[derive(Clone, Debug, clap::Args)]
pub(super) struct Input {
    /// scene.toml, or any file that `ajar formats` lists
    pub file: PathBuf,
    /// Change what the file says, by the keys of a scene file: material.Chrome.roughness=0.2
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Treat everything that was approximated or dropped as an error
    #[arg(long)]
    strict: bool,
    /// Files below this folder may be read too, besides those beside FILE; may be given several times
    #[arg(long, value_name = "FOLDER")]
    allow: Vec<PathBuf>,
    /// Most memory for geometry, for decoded textures and for the image, each: 512M, 8G; images may always take 1G
    #[arg(long, value_name = "SIZE", value_parser = parse_bytes, default_value = "8G")]
    pub memory_limit: u64,
    #[command(flatten)]
    chosen: Chosen,
}

#[derive(Clone, Debug, clap::Args)]
struct Chosen {
    /// Show this variant of the asset; may be given several times
    #[arg(long, value_name = "NAME")]
    variant: Vec<String>,
    /// Show animations at this frame [default: the rest pose]
    #[arg(long, value_name = "N", value_parser = parse_number, allow_negative_numbers = true, conflicts_with = "at")]
    frame: Option<f64>,
    /// Show animations at this time
    #[arg(long, value_name = "SECONDS", value_parser = parse_number, allow_negative_numbers = true)]
    at: Option<f64>,
    /// Frames per second [default: what the file says, else 24]
    #[arg(long, value_name = "N", value_parser = parse_fps)]
    fps: Option<f64>,
}

impl Chosen {
    fn choice(&self) -> Choice {
        let moment = self.frame.map(Moment::Frame).or(self.at.map(Moment::Seconds));
        Choice { variants: self.variant.clone(), moment, fps: self.fps }
    }
}

impl Input {
    /// Opens the file. `size` is that of the film where the command line states it.
    pub fn load(&self, size: Option<[u32; 2]>) -> Result<Loaded, Vec<Diagnostic>> {
        let choice = self.chosen.choice();
        session::load(&self.file, &self.options(size, &choice))
    }

    /// Opens the file as it is: no camera or light is added.
    pub fn open(&self) -> Result<SceneFile, Vec<Diagnostic>> {
        let choice = self.chosen.choice();
        session::open(&self.file, &self.options(None, &choice))
    }

    /// As [`Input::open`], read this way.
    pub fn open_as(&self, reading: &Reading<'_>) -> Result<SceneFile, Vec<Diagnostic>> {
        let choice = self.chosen.choice();
        session::open_as(&self.file, &self.options(None, &choice), reading)
    }

    /// Adds the camera or light that the file lacks.
    pub fn complete(&self, size: Option<[u32; 2]>, file: &mut SceneFile) {
        let choice = self.chosen.choice();
        let added = session::complete(&self.file, &self.options(size, &choice), file);
        file.diagnostics.extend(added);
    }

    fn options<'a>(&'a self, size: Option<[u32; 2]>, choice: &'a Choice) -> LoadOptions<'a> {
        let Self { set, strict, allow, memory_limit, .. } = self;
        LoadOptions { size, set, strict: *strict, allow, memory_limit: *memory_limit, choice }
    }

    /// The same at a frame.
    pub fn at_frame(&self, frame: i32) -> Self {
        let chosen = Chosen { frame: Some(frame.into()), ..self.chosen.clone() };
        Self { chosen, ..self.clone() }
    }

    /// The frame asked for, if it is a whole one.
    pub fn frame(&self) -> Option<i32> {
        let frame = self.chosen.frame?;
        (frame.fract() == 0.0 && frame.abs() <= f64::from(i32::MAX)).then_some(frame as i32)
    }

    /// What is said about the look of the scene.
    pub fn said(&self) -> Said {
        let Chosen { variant, frame, at, fps } = &self.chosen;
        let mut import = Table::new();
        if !variant.is_empty() {
            import.insert("variant".into(), variant.clone().into());
        }
        let numbers = [("frame", frame), ("time", at), ("fps", fps)];
        import.extend(numbers.into_iter().filter_map(|(key, n)| Some((key.to_owned(), (*n)?.into()))));
        let unsaid = if self.allow.is_empty() { Vec::new() } else { vec!["--allow".to_owned()] };
        Said { changes: Overrides::tables(&self.set), import, unsaid }
    }

    /// The least severity that makes a file unfit.
    pub fn least(&self) -> Severity {
        if self.strict { Severity::Warning } else { Severity::Error }
    }
}
