//! The way of a scene: import → override → prepare → advance → write.

use std::{
    path::{Path, PathBuf},
    sync::atomic::{AtomicBool, Ordering},
    time::{Duration, Instant},
};

use ajar_integrators::{
    Context, Integrator, Settings,
    stats::{Noise, noise},
    stop::{Reason, StopRules, is_noise_check},
};
use ajar_render::{World, film::Film, world::prepare};
use ajar_scene::{
    Camera, Cause, Diagnostic, Id, ImportRequest, OutputSettings, Overrides, Scene, SceneFile, Severity,
};
use glam::DAffine3;

/// A loaded file: the scene and what the file says about rendering it.
#[derive(Debug)]
pub struct Loaded {
    /// The scene with defaults added.
    pub file: SceneFile,
    /// Stable hash of the scene.
    pub hash: String,
}

/// Film size where nothing says another.
pub const DEFAULT_SIZE: [u32; 2] = [1280, 720];

/// How to load a file.
#[derive(Clone, Copy, Debug)]
pub struct LoadOptions<'a> {
    /// Film size that goes before that of the file; a camera that is added fills it.
    pub size: Option<[u32; 2]>,
    /// Changes to what the file says, `key.path=value`.
    pub set: &'a [String],
    /// Whether warnings are errors.
    pub strict: bool,
    /// Bytes that no importer may exceed.
    pub memory_limit: u64,
}

/// Reads any file that some importer knows, or a `scene.toml`, checks it, and adds a camera or light where it has none.
///
/// # Errors
/// Everything that makes it unfit to render.
pub fn load(path: &Path, options: &LoadOptions<'_>) -> Result<Loaded, Vec<Diagnostic>> {
    let memory_limit = options.memory_limit;
    let import =
        |request: &ImportRequest| ajar_importers::import(&ImportRequest { memory_limit, ..request.clone() });
    let overrides = Overrides::parse(options.set)?;
    let mut file = if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml")) {
        ajar_scene::load(path, &overrides, &import)?
    } else {
        let imported = import(&ImportRequest::new(path)).map_err(|d| vec![d])?;
        ajar_scene::load_asset(path, &overrides, imported)?
    };
    file.diagnostics.extend(about(path, file.scene.validate()));
    let least = if options.strict { Severity::Warning } else { Severity::Error };
    if file.diagnostics.iter().any(|d| d.severity >= least) {
        return Err(file.diagnostics);
    }
    let hash = file.scene.content_hash();
    let [width, height] = options.size.or(file.render.size).unwrap_or(DEFAULT_SIZE).map(f64::from);
    let camera = file.scene.add_default_camera(width / height);
    let light = file.scene.add_default_light();
    file.diagnostics.extend(about(path, camera.into_iter().chain(light)));
    Ok(Loaded { file, hash })
}

/// The same messages, those without file being about `path`.
pub fn about(path: &Path, diagnostics: impl IntoIterator<Item = Diagnostic>) -> Vec<Diagnostic> {
    diagnostics.into_iter().map(|d| if d.file.is_none() { d.in_file(path) } else { d }).collect()
}

/// The camera called `name`, or the first one, with its place.
///
/// # Errors
/// No such camera: names those there are.
pub fn choose_camera(scene: &Scene, name: Option<&str>) -> Result<(Id<Camera>, DAffine3), Diagnostic> {
    let placed: Vec<_> = scene
        .placed()
        .into_iter()
        .filter_map(|p| Some((p.node.camera?, p.node.name.clone(), p.world)))
        .collect();
    let found = match name {
        None => placed.first(),
        Some(name) => placed.iter().find(|(id, node, _)| scene.cameras[*id].name == name || node == name),
    };
    found.map(|(id, _, world)| (*id, *world)).ok_or_else(|| {
        let names: Vec<_> = placed.iter().map(|(id, node, _)| (&scene.cameras[*id].name, node)).collect();
        let names: Vec<_> =
            names.into_iter().map(|(c, n)| if c.is_empty() { n.as_str() } else { c }).collect();
        Diagnostic::error(format!("there is no camera called \"{}\"", name.unwrap_or_default()))
            .because(Cause::Usage)
            .hint(format!("cameras: {}", names.join(", ")))
    })
}

/// Prepares a scene for a camera and film size.
///
/// # Errors
/// What cannot be prepared, with the way there.
pub fn prepare_world(
    scene: Scene,
    camera: (Id<Camera>, DAffine3),
    size: [u32; 2],
    texture_memory: u64,
) -> Result<(World, Vec<Diagnostic>), Vec<Diagnostic>> {
    prepare(scene, &ajar_render::world::PrepareOptions { camera, size, texture_memory })
}

/// State of a render after a round.
#[derive(Clone, Copy, Debug)]
pub struct Status {
    /// Finished rounds.
    pub rounds: u64,
    /// Eye samples a pixel.
    pub samples: u64,
    /// Time since the first round began.
    pub elapsed: Duration,
    /// Noise as of the last look at it.
    pub noise: Option<Noise>,
}

/// A finished or interrupted render.
#[derive(Debug)]
pub struct Rendered {
    /// The image.
    pub film: Film,
    /// State at the end.
    pub status: Status,
    /// Why it stopped; `None` if it was interrupted.
    pub reason: Option<Reason>,
}

/// Renders rounds until a rule holds or `cancel` is raised; the round in progress is then dropped. `each_round` sees the
/// film after every round.
pub fn render(
    world: &World,
    integrator: &dyn Integrator,
    settings: &Settings,
    rules: &StopRules,
    cancel: &AtomicBool,
    mut each_round: impl FnMut(&Film, &Status),
) -> Rendered {
    let began = Instant::now();
    let brightness = ajar_integrators::brightness(world, settings.max_depth);
    let window = settings.window;
    let mut film = Film::new(window.pixels(), brightness).with_blocks(window.width() as usize);
    let prepared = integrator.prepare(Context { world, settings, cancel });
    let mut status = Status { rounds: 0, samples: 0, elapsed: Duration::ZERO, noise: None };
    let reason = loop {
        let round = film.round();
        let index = film.rounds() as u32;
        prepared.render(index, &round);
        if cancel.load(Ordering::Relaxed) {
            break None;
        }
        film.merge(&round, prepared.scale());
        status.rounds = film.rounds();
        status.samples = status.rounds * u64::from(settings.samples_per_round);
        status.elapsed = began.elapsed();
        if is_noise_check(status.rounds) {
            status.noise = noise(&film, settings.window);
        }
        each_round(&film, &status);
        if let Some(reason) = rules.check(status.rounds, status.elapsed, status.noise) {
            break Some(reason);
        }
    };
    status.noise = noise(&film, settings.window);
    status.elapsed = began.elapsed();
    Rendered { film, status, reason }
}

/// Where results go: the EXR, and the PNG beside it.
pub fn output_paths(input: &Path, output: &OutputSettings) -> (PathBuf, PathBuf) {
    let exr = output.path.clone().unwrap_or_else(|| {
        let named_scene = input.file_stem().is_some_and(|stem| stem == "scene");
        let folder = input.canonicalize().ok().and_then(|p| p.parent()?.file_name().map(PathBuf::from));
        let stem = if named_scene { folder } else { input.file_stem().map(PathBuf::from) };
        stem.unwrap_or_else(|| "render".into()).with_extension("exr")
    });
    let png = output.png.clone().unwrap_or_else(|| exr.with_extension("png"));
    (exr, png)
}
