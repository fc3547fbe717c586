//! What is done with an input: all that happens to a file up to its first pixels.

use std::{fs, io, path::Path, path::PathBuf, sync::atomic::AtomicBool};

use ajar::session::{self, LoadOptions, Loaded};
use ajar_integrators::{Context, Settings, Window, integrators};
use ajar_render::film::Film;
use ajar_scene::{Choice, Diagnostic, ImportRequest, Moment, Overrides, Scene, Severity};

use crate::seeds;

/// Bytes that importers and textures may ask for, each.
const LIMIT: u64 = 64 << 20;
/// Width and height of the film.
const SIZE: u32 = 4;
/// Bytes of all messages about one file. More would bury what matters.
const MESSAGES: usize = 64 << 10;

/// What an input is taken as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    Gltf,
    Glb,
    Obj,
    Mtl,
    Scene,
    Ajar,
    /// The picture of a sky, in any format.
    Picture,
    /// What a plug-in prints: lines of standard error, [`seeds::CUT`], standard output.
    PlugIn,
}

impl Target {
    pub fn name(self) -> &'static str {
        match self {
            Self::Gltf => "gltf",
            Self::Glb => "glb",
            Self::Obj => "obj",
            Self::Mtl => "mtl",
            Self::Scene => "scene",
            Self::Ajar => "ajar",
            Self::Picture => "picture",
            Self::PlugIn => "plug_in",
        }
    }

    /// The file that the input becomes, and the one that is opened.
    fn files(self) -> [&'static str; 2] {
        match self {
            Self::Gltf => ["input.gltf"; 2],
            Self::Glb => ["input.glb"; 2],
            Self::Obj => ["input.obj"; 2],
            Self::Mtl => ["library.mtl", "box.obj"],
            Self::Scene => ["input.toml"; 2],
            Self::Ajar => ["input.ajar"; 2],
            Self::Picture => ["input.picture", "sky.toml"],
            Self::PlugIn => ["input.streams"; 2],
        }
    }
}

/// What became of an input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fate {
    /// An error names the file.
    Refused,
    /// Pixels were rendered.
    Prepared,
}

/// A folder with all files that seeds refer to.
pub struct Laboratory {
    folder: PathBuf,
}

impl Laboratory {
    pub fn new(folder: &Path) -> io::Result<Self> {
        fs::create_dir_all(folder)?;
        for (name, bytes) in seeds::companions() {
            fs::write(folder.join(name), bytes)?;
        }
        Ok(Self { folder: folder.to_owned() })
    }

    /// Opens, prepares and renders the input.
    ///
    /// # Errors
    /// What must not happen, other than panics.
    pub fn examine(&self, target: Target, input: &[u8]) -> Result<Fate, String> {
        let [file, opened] = target.files();
        fs::write(self.folder.join(file), input).map_err(|e| e.to_string())?;
        let path = self.folder.join(opened);
        // Some are read as they are, some at a moment of their animations.
        let moment = (input.len() % 2 == 1).then_some(Moment::Seconds(0.4));
        let choice = Choice { moment, ..Choice::default() };
        let loaded = if target == Target::PlugIn {
            plug_in(&path, input, choice)
        } else {
            let options = LoadOptions {
                size: Some([SIZE; 2]),
                set: &[],
                strict: false,
                allow: &[],
                memory_limit: LIMIT,
                choice: &choice,
            };
            session::load(&path, &options).map(|Loaded { file, .. }| (file.scene, file.diagnostics))
        };
        let found = loaded.and_then(|(scene, mut said)| {
            said.extend(rendered(scene)?);
            Ok(said)
        });
        match found {
            Ok(said) => sound(&said).map(|()| Fate::Prepared),
            Err(said) if said.iter().any(|d| d.severity == Severity::Error) => {
                sound(&said).map(|()| Fate::Refused)
            }
            Err(said) => Err(format!("it is refused without an error: {said:?}")),
        }
    }
}

type Found = Result<(Scene, Vec<Diagnostic>), Vec<Diagnostic>>;

/// The scene that a plug-in's streams give.
fn plug_in(path: &Path, input: &[u8], choice: Choice) -> Found {
    let cut = input.windows(seeds::CUT.len()).position(|bytes| bytes == seeds::CUT);
    let (messages, output) = input.split_at(cut.unwrap_or(0));
    let output = output.strip_prefix(seeds::CUT).unwrap_or(output).to_vec();
    let request = ImportRequest { memory_limit: LIMIT, choice, ..ImportRequest::new(path) };
    let imported = ajar_importers::plugin::answer("toy", output, messages, &request).map_err(|d| vec![d])?;
    let file = ajar_scene::load_asset(&request, &Overrides::parse::<&str>(&[])?, imported)?;
    let mut said = file.diagnostics;
    said.extend(session::about(path, file.scene.validate()));
    if said.iter().any(|d| d.severity == Severity::Error) {
        return Err(said);
    }
    let mut scene = file.scene;
    scene.add_default_camera(1.0);
    scene.add_default_light();
    Ok((scene, said))
}

/// Renders one sample a pixel in two ways; returns the warnings of the preparation.
fn rendered(scene: Scene) -> Result<Vec<Diagnostic>, Vec<Diagnostic>> {
    let camera = session::choose_camera(&scene, None).map_err(|d| vec![d])?;
    let about = |said| session::about(Path::new("prepared"), said);
    let (world, said) = session::prepare_world(scene, camera, [SIZE; 2], LIMIT).map_err(about)?;
    let window = Window { x0: 0, y0: 0, x1: SIZE, y1: SIZE };
    let settings =
        Settings { seed: 1, max_depth: 5, samples_per_round: 1, window, metropolis: Default::default() };
    let cancel = AtomicBool::new(false);
    for integrator in integrators().iter().filter(|it| ["path", "bdpt"].contains(&it.name())) {
        let film = Film::new(window.pixels(), 1.0);
        let context = Context { world: &world, settings: &settings, cancel: &cancel };
        integrator.prepare(context).render(0, &film.round());
    }
    Ok(about(said))
}

/// Whether what is said is in order: the file is named, no importer has failed, and there is not too much of it.
fn sound(said: &[Diagnostic]) -> Result<(), String> {
    let length: usize = said.iter().map(|d| d.to_string().len()).sum();
    if length > MESSAGES {
        return Err(format!("{length} bytes of messages"));
    }
    let is_defect = |d: &&Diagnostic| {
        d.file.is_none() || d.hint.as_ref().is_some_and(|hint| hint.contains("is a defect"))
    };
    said.iter().find(is_defect).map_or(Ok(()), |d| Err(format!("it is refused with: {d:?}")))
}
