//! A scene that is ready to be rendered, and how it came to be.

use std::{
    collections::BTreeSet,
    panic::{AssertUnwindSafe, catch_unwind},
    path::PathBuf,
    sync::Arc,
};

use ajar_render::{
    World,
    world::{PrepareOptions, Previous, prepare_after},
};
use ajar_scene::{Camera, Cause, Diagnostic, Looked, SceneFile, Setting, VariedImport};
use glam::DAffine3;

use super::{Subject, clay, describe, imports::Imports};
use crate::{
    image::{Destination, Form},
    plan::Plan,
    session::{self, Reading},
};

/// A scene that is ready to be rendered.
pub(super) struct Opened {
    pub world: Arc<World>,
    /// The camera and its place.
    pub camera: (Camera, DAffine3),
    pub plan: Plan,
    /// Where finished images go, if they are wanted.
    pub output: Option<Output>,
    /// The form in which images are written.
    pub form: Form,
    /// Every value that scene files said, and who.
    pub settings: Vec<Setting>,
    /// The imports that have variants.
    pub varied: Vec<VariedImport>,
    /// The lights that pages can change.
    pub lights: Vec<serde_json::Value>,
    /// Whether the camera is one that was added.
    pub is_framed: bool,
}

/// What is to be written of finished images.
pub(super) struct Output {
    pub to: Destination,
    /// Hash of the scene.
    pub hash: String,
}

/// What a scene is read with.
pub(super) struct Desk<'a> {
    pub subject: &'a dyn Subject,
    pub imports: &'a Imports,
    /// Path and text of a scene file that lies over everything.
    pub draft: Option<(PathBuf, String)>,
    /// The camera that pages look through, if they chose one.
    pub camera: Option<&'a str>,
    /// Variants of the asset, where it is one.
    pub variants: Vec<String>,
    /// Whether everything is to look as if made of clay.
    pub is_clay: bool,
    /// Whether something will be written of the scene.
    pub wants_output: bool,
    /// The scene before, and the files that changed since.
    pub before: Option<(&'a World, &'a BTreeSet<PathBuf>)>,
}

/// What came of reading a scene: it, or why not; files that matter; messages.
pub(super) struct Read {
    pub opened: Result<Opened, Vec<Diagnostic>>,
    pub files: BTreeSet<PathBuf>,
    pub messages: Vec<Diagnostic>,
}

impl Desk<'_> {
    /// Reads and prepares.
    pub fn read(&self) -> Read {
        let (looked, mut messages) = (Looked::default(), Vec::new());
        // What breaks an importer is a fault of ours, and no reason to lose the image that is shown.
        let opened = catch_unwind(AssertUnwindSafe(|| self.open(&looked, &mut messages)));
        let opened = opened.unwrap_or_else(|_| {
            let path = self.subject.path();
            let fault = "reading it failed in a way that is a fault of this program";
            Err(vec![Diagnostic::error(fault).in_file(path).because(Cause::System)])
        });
        looked.note(self.subject.path());
        Read { opened, files: looked.take(), messages }
    }

    fn open(&self, looked: &Looked, messages: &mut Vec<Diagnostic>) -> Result<Opened, Vec<Diagnostic>> {
        let subject = self.subject;
        let path = subject.path();
        let import = |request: &ajar_scene::ImportRequest| self.imports.ask(request, &ajar_importers::import);
        let draft = self.draft.as_ref().map(|(path, text)| (path.as_path(), text.as_str()));
        let (variants, looked) = (self.variants.clone(), looked.clone());
        let reading = Reading { draft, variants, looked: looked.clone(), import: &import };
        let mut file = subject.open(&reading)?;
        if self.is_clay {
            clay::cover(&mut file.scene);
        }
        let hash = self.wants_output.then(|| file.scene.content_hash());
        let lights = describe::lights(&file.scene, &file.settings);
        let cameras = file.scene.cameras.len();
        subject.complete(&mut file);
        let is_framed = file.scene.cameras.len() > cameras;
        file.files.iter().for_each(|file| looked.note(file));
        messages.extend(file.diagnostics.iter().cloned());
        let plan = subject.plan(&file).map_err(|d| vec![d])?;
        let form = subject.form(&file).map_err(|d| vec![d])?;
        let output = hash.map(|hash| subject.destination(&file).map(|to| Output { to, hash }));
        let output = output.transpose().map_err(|d| vec![d])?;
        let id = session::choose_camera(&file.scene, self.camera.or(subject.camera(&file)))
            .map_err(|d| vec![d])?;
        let camera = (file.scene.cameras[id.0].clone(), id.1);
        let SceneFile { scene, settings, varied, .. } = file;
        let options = PrepareOptions { camera: id, size: plan.size, texture_memory: subject.memory_limit() };
        let previous = self.before.map(|(world, changed)| Previous { world, changed });
        let prepared = prepare_after(scene, &options, previous);
        let (world, warnings) = prepared.map_err(|d| session::about(path, d))?;
        messages.extend(session::about(path, warnings));
        Ok(Opened { world: Arc::new(world), camera, plan, output, form, settings, varied, lights, is_framed })
    }
}

/// File names of paths, each once, for people.
pub(super) fn names<'a>(paths: impl IntoIterator<Item = &'a PathBuf>) -> Vec<String> {
    let name = |path: &'a PathBuf| path.file_name().map(|name| name.to_string_lossy().into_owned());
    let names: BTreeSet<_> = paths.into_iter().filter_map(name).collect();
    names.into_iter().collect()
}
