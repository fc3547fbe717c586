//! The contract of importers: bytes below a folder become a [`Scene`], with a report of what was left out.

use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
    sync::{Arc, Mutex, PoisonError},
};

use serde::{Deserialize, Serialize};

use crate::{Cause, Diagnostic, Scene};

/// What an importer is given.
#[derive(Clone, Debug)]
pub struct ImportRequest {
    /// The file to read.
    pub path: PathBuf,
    /// Folders below which files may be read besides the file's own folder.
    pub allowed: Vec<PathBuf>,
    /// No importer may hold more than this many bytes that the file alone asks for.
    pub memory_limit: u64,
    /// What of the file is read, where it holds more than one still scene.
    pub choice: Choice,
    /// Notes the files that are looked for.
    pub looked: Looked,
}

/// Files that somebody looked for, by their absolute paths, whether they were there or not and whether reading them worked.
/// Clones share the notes.
#[derive(Clone, Debug, Default)]
pub struct Looked(Arc<Mutex<BTreeSet<PathBuf>>>);

impl Looked {
    /// Notes a file.
    pub fn note(&self, path: impl AsRef<Path>) {
        let path = path.as_ref();
        // Only an empty path has no absolute one.
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        self.0.lock().unwrap_or_else(PoisonError::into_inner).insert(path);
    }

    /// Takes all notes.
    pub fn take(&self) -> BTreeSet<PathBuf> {
        std::mem::take(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// Frames per second where nothing says another number.
const DEFAULT_FPS: f64 = 24.0;

/// Which of the variants of an asset and which moment of its animation are read. The default: what the file shows by
/// itself, in its rest pose.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Choice {
    /// Names of variants, as the format writes them: `Red` in glTF, `/Prim:set=choice` in USD.
    pub variants: Vec<String>,
    /// The moment; `None` is the rest pose.
    pub moment: Option<Moment>,
    /// Frames per second, over what the file says.
    pub fps: Option<f64>,
}

/// A moment of an animation, in the terms of whoever asks for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Moment {
    /// A frame; parts of frames count.
    Frame(f64),
    /// Seconds.
    Seconds(f64),
}

impl Choice {
    /// The moment in seconds, for formats that know no frames: frame 0 is at 0 s.
    pub fn seconds(&self) -> Option<f64> {
        self.moment.map(|moment| match moment {
            Moment::Frame(frame) => frame / self.fps.unwrap_or(DEFAULT_FPS),
            Moment::Seconds(seconds) => seconds,
        })
    }

    /// This choice, and what it leaves open as in `other`.
    pub fn or(&self, other: &Self) -> Self {
        let variants = if self.variants.is_empty() { &other.variants } else { &self.variants };
        Self { variants: variants.clone(), moment: self.moment.or(other.moment), fps: self.fps.or(other.fps) }
    }
}

/// Variants of an asset of which one is shown.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VariantSet {
    /// What it is called: `/Prim:set` in USD; empty in glTF, which has one set.
    #[serde(default)]
    pub name: String,
    /// The variants, by the names that [`Choice::variants`] takes.
    pub choices: Vec<String>,
    /// The one that is shown; `None` is what the file shows by itself.
    #[serde(default)]
    pub chosen: Option<String>,
}

impl ImportRequest {
    /// A request with the defaults: only the file's own folder, 8 GiB, the rest pose.
    pub fn new(path: impl Into<PathBuf>) -> Self {
        Self {
            path: path.into(),
            allowed: Vec::new(),
            memory_limit: 8 << 30,
            choice: Choice::default(),
            looked: Looked::default(),
        }
    }

    /// For importers of formats that know no variants.
    ///
    /// # Errors
    /// One is asked for.
    pub fn refuse_variants(&self) -> Result<(), Diagnostic> {
        self.choice.variants.first().map_or(Ok(()), |name| {
            let message = format!("there is no variant \"{}\": the format has none", name.escape_debug());
            Err(Diagnostic::error(message).in_file(&self.path).because(Cause::Usage))
        })
    }

    /// The folder of the file.
    pub fn folder(&self) -> &Path {
        match self.path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        }
    }

    /// Turns a reference inside the file (already percent-decoded) into a path that may be read.
    ///
    /// # Errors
    /// A reference that leaves the allowed folders (also through symbolic links), is absolute, does not exist, or
    /// is no regular file.
    pub fn resolve(&self, reference: &str) -> Result<PathBuf, Diagnostic> {
        let refuse = |why: &str| {
            Diagnostic::error(format!("\"{}\" {why}", reference.escape_debug())).in_file(&self.path)
        };
        if reference.is_empty() {
            return Err(refuse("is not a file"));
        }
        if reference.contains("://") {
            return Err(refuse("is a URL; only files beside the scene are read"));
        }
        let file = self.folder().join(reference.replace('\\', "/"));
        let found = file.canonicalize().map_err(|e| refuse(&format!("cannot be read: {e}")));
        self.looked.note(&file);
        let real = found?;
        let inside = |folder: &Path| folder.canonicalize().is_ok_and(|folder| real.starts_with(folder));
        if inside(self.folder()) || self.allowed.iter().any(|folder| inside(folder)) {
            // Opening a pipe or a device could wait forever.
            if !real.is_file() {
                return Err(refuse("is not a file"));
            }
            self.looked.note(&real);
            Ok(real)
        } else {
            Err(refuse("lies outside the scene's folder")
                .hint("move it there, or allow its folder with --allow"))
        }
    }
}

/// What an importer returns.
#[derive(Clone, Debug, Default)]
pub struct Imported {
    /// The scene.
    pub scene: Scene,
    /// What was approximated or dropped, each once.
    pub diagnostics: Vec<Diagnostic>,
    /// Every file that was read or looked for, for watch mode.
    pub files: Vec<PathBuf>,
    /// How the asset wants to be rendered where nobody else says it.
    pub render: Preference,
    /// Which variants there are.
    pub variants: Vec<VariantSet>,
}

/// What an asset says about its picture.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Preference {
    /// Name of the camera.
    pub camera: Option<String>,
    /// Width and height in pixels, 1 to 65535.
    pub size: Option<[u32; 2]>,
}

impl Preference {
    /// Takes over what this does not say.
    pub fn complete(&mut self, other: Self) {
        self.camera = self.camera.take().or(other.camera);
        self.size = self.size.or(other.size);
    }
}

/// One row of the support table that `ajar formats` prints.
#[derive(Clone, Copy, Debug)]
pub struct Feature {
    /// Name of the feature or extension.
    pub name: &'static str,
    /// What of it is supported, in words.
    pub support: &'static str,
}

/// Reads one file format.
pub trait Importer: Sync {
    /// Short name, `gltf`.
    fn name(&self) -> &'static str;
    /// Extensions without dot, lower case.
    fn extensions(&self) -> &'static [&'static str];
    /// Whether the first bytes of a file (up to 256) look like this format, for files with a foreign extension.
    fn sniff(&self, head: &[u8]) -> bool;
    /// What is supported.
    fn features(&self) -> &'static [Feature];
    /// Reads the file.
    ///
    /// # Errors
    /// A diagnostic with file and place. Never panics, whatever the file contains.
    fn import(&self, request: &ImportRequest) -> Result<Imported, Diagnostic>;
}
