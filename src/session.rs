//! The way of a scene: import → override → prepare → advance → write.

use std::{
    path::{Path, PathBuf},
    sync::atomic::AtomicBool,
    time::{Duration, Instant},
};

use ajar_integrators::{
    Context, Integrator, Report, Rounds, Settings,
    stats::{Noise, noise},
    stop::{Reason, StopRules, is_noise_check},
};
use ajar_render::{
    World,
    film::Film,
    world::{PrepareOptions, prepare},
};
use ajar_scene::{
    Camera, Cause, Choice, Diagnostic, Id, ImportRequest, Imported, Looked, OutputSettings, Overrides, Scene,
    SceneFile, Severity,
};
use glam::DAffine3;

use crate::{kept::kept, shard::Shard};

/// A loaded file: the scene and what the file says about rendering it.
#[derive(Debug)]
pub struct Loaded {
    /// The scene with defaults added.
    pub file: SceneFile,
    /// What is said of these defaults.
    pub added: Vec<Diagnostic>,
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
    /// Folders below which files may be read besides the folder of the file.
    pub allow: &'a [PathBuf],
    /// Bytes that no importer may exceed.
    pub memory_limit: u64,
    /// Variants and moment of the assets, over those that a scene file says.
    pub choice: &'a Choice,
}

/// Turns one file into a scene.
pub type Import<'a> = dyn Fn(&ImportRequest) -> Result<Imported, Diagnostic> + 'a;

/// How files are read where that is not just once.
pub struct Reading<'a> {
    /// Path and text of a scene file that is not saved yet and lies over everything else.
    pub draft: Option<(&'a Path, &'a str)>,
    /// Variants of the asset, where it is one that is read, over all others.
    pub variants: Vec<String>,
    /// Notes the files that are looked for.
    pub looked: Looked,
    /// What importers are asked through.
    pub import: &'a Import<'a>,
}

/// Reads any file that some importer knows, or a `scene.toml`, checks it, and adds a camera or light where it has none.
///
/// # Errors
/// Everything that makes it unfit to render.
pub fn load(path: &Path, options: &LoadOptions<'_>) -> Result<Loaded, Vec<Diagnostic>> {
    let mut file = open(path, options)?;
    let hash = file.scene.content_hash();
    let added = complete(path, options, &mut file);
    Ok(Loaded { file, added, hash })
}

/// Adds a camera or light where there is none, and says so.
pub fn complete(path: &Path, options: &LoadOptions<'_>, file: &mut SceneFile) -> Vec<Diagnostic> {
    let [width, height] = film_size(options.size, file, None).map(f64::from);
    let camera = file.scene.add_default_camera(width / height);
    let light = file.scene.add_default_light();
    about(path, camera.into_iter().chain(light))
}

/// Reads and checks a file as it is.
///
/// # Errors
/// Everything that makes it unfit to render.
pub fn open(path: &Path, options: &LoadOptions<'_>) -> Result<SceneFile, Vec<Diagnostic>> {
    let (looked, import) = (Looked::default(), &ajar_importers::import);
    let reading = Reading { draft: None, variants: Vec::new(), looked, import };
    open_as(path, options, &reading)
}

/// Whether the file is a scene file.
pub fn is_scene_file(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"))
}

/// As [`open`], read this way.
///
/// # Errors
/// Everything that makes it unfit to render.
pub fn open_as(
    path: &Path,
    options: &LoadOptions<'_>,
    reading: &Reading<'_>,
) -> Result<SceneFile, Vec<Diagnostic>> {
    let memory_limit = options.memory_limit;
    let chosen = Choice { variants: reading.variants.clone(), ..Choice::default() };
    let import = |request: &ImportRequest| {
        let choice = chosen.or(options.choice).or(&request.choice);
        let mut allowed = request.allowed.clone();
        allowed.extend_from_slice(options.allow);
        (reading.import)(&ImportRequest { allowed, memory_limit, choice, ..request.clone() })
    };
    let mut overrides = Overrides::parse(options.set)?;
    if let Some((path, text)) = reading.draft {
        overrides = overrides.below(path, text)?;
    }
    let (allowed, looked) = (options.allow.to_vec(), reading.looked.clone());
    let request = ImportRequest { allowed, looked, ..ImportRequest::new(path) };
    let mut file = if is_scene_file(path) {
        whole(path, options.choice).map_err(|d| vec![d])?;
        ajar_scene::load(&request, &overrides, &import)?
    } else {
        reading.looked.note(path);
        let imported = import(&request).map_err(|d| vec![d])?;
        ajar_scene::load_asset(&request, &overrides, imported)?
    };
    let kept = kept(&file.scene, &file.diagnostics);
    file.diagnostics.extend(about(path, file.scene.validate().into_iter().chain([kept])));
    let least = if options.strict { Severity::Warning } else { Severity::Error };
    if file.diagnostics.iter().any(|d| d.severity >= least) {
        return Err(file.diagnostics);
    }
    Ok(file)
}

/// Size of the film: what is asked for, else what the file says, else 1280 pixels wide in the shape that the camera, called
/// `camera` where that is not what the file says, was composed for.
pub fn film_size(asked: Option<[u32; 2]>, file: &SceneFile, camera: Option<&str>) -> [u32; 2] {
    asked.or(file.render.size).unwrap_or_else(|| {
        let name = camera.or(file.render.camera.as_deref());
        let aspect = choose_camera(&file.scene, name).ok().and_then(|(id, _)| file.scene.cameras[id].aspect);
        let [width, height] = DEFAULT_SIZE;
        [width, aspect.map_or(height, |aspect| (width as f32 / aspect).round().clamp(1.0, 65535.0) as u32)]
    })
}

/// Variants belong to one asset, a scene file may import several.
fn whole(path: &Path, choice: &Choice) -> Result<(), Diagnostic> {
    choice.variants.first().map_or(Ok(()), |name| {
        let error = Diagnostic::error("a scene file has no variants itself").in_file(path);
        let hint = format!("choose for one of its imports: --set 'import.NAME.variant={name}'");
        Err(error.because(Cause::Usage).hint(hint))
    })
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
/// What cannot be prepared.
pub fn prepare_world(
    scene: Scene,
    camera: (Id<Camera>, DAffine3),
    size: [u32; 2],
    texture_memory: u64,
) -> Result<(World, Vec<Diagnostic>), Vec<Diagnostic>> {
    prepare(scene, &PrepareOptions { camera, size, texture_memory })
}

/// State of a render after a round.
#[derive(Clone, Copy, Debug, Default)]
pub struct Status {
    /// Finished rounds.
    pub rounds: u64,
    /// Eye samples a pixel.
    pub samples: u64,
    /// Time since the first round began, all runs of a resumed render together.
    pub elapsed: Duration,
    /// Noise as of the last look at it.
    pub noise: Option<Noise>,
    /// Contributions left out because they were negative or not finite.
    pub rejected: u64,
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
    /// What the integrator tells about it.
    pub report: Report,
}

/// Where a render begins.
#[derive(Clone, Debug)]
pub struct Start {
    /// Which rounds it makes.
    pub shard: Shard,
    /// Those it has already, and the time they took.
    pub done: Option<(Film, Duration)>,
}

/// Rounds to go on from, and the time that they took.
#[derive(Debug)]
pub struct Leg {
    film: Film,
    before: Duration,
    began: Instant,
}

impl Leg {
    /// From these rounds on, or from nothing. What is to be prepared for it takes part of its time.
    pub fn begin(world: &World, settings: &Settings, done: Option<(Film, Duration)>) -> Self {
        let (began, window) = (Instant::now(), settings.window);
        let (film, before) = done.unwrap_or_else(|| {
            let brightness = ajar_integrators::brightness(world, settings.max_depth);
            (Film::new(window.pixels(), brightness).with_blocks(window.width() as usize), Duration::ZERO)
        });
        Self { film, before, began }
    }
}

/// Renders rounds until a rule holds or `cancel` is raised; the round in progress is then dropped. `each_round` sees the
/// film after every round, and who can tell about it.
pub fn render(
    world: &World,
    integrator: &dyn Integrator,
    settings: &Settings,
    rules: &StopRules,
    start: Start,
    cancel: &AtomicBool,
    each_round: impl FnMut(&Film, &Status, &dyn Rounds),
) -> Rendered {
    let leg = Leg::begin(world, settings, start.done);
    let cx = Context { world, settings, cancel };
    advance(&*integrator.prepare(cx), cx, rules, start.shard, leg, each_round)
}

/// The same with an integrator that is prepared.
pub fn advance(
    prepared: &dyn Rounds,
    cx: Context<'_>,
    rules: &StopRules,
    shard: Shard,
    leg: Leg,
    mut each_round: impl FnMut(&Film, &Status, &dyn Rounds),
) -> Rendered {
    let Leg { mut film, before, began } = leg;
    let settings = cx.settings;
    let mut status = look(&film, settings, before, None);
    let reason = loop {
        if let Some(reason) = rules.check(status.rounds, status.elapsed, status.noise) {
            break Some(reason);
        }
        let Some(index) = shard.round(film.rounds()) else { break Some(Reason::Rounds) };
        let round = film.round();
        prepared.render(index, &round);
        if cx.cancelled() {
            break None;
        }
        film.merge(&round, prepared.scale());
        status = look(&film, settings, before + began.elapsed(), status.noise);
        each_round(&film, &status, prepared);
    };
    if !is_noise_check(status.rounds) {
        status.noise = noise(&film, settings.window);
    }
    status.elapsed = before + began.elapsed();
    Rendered { film, status, reason, report: prepared.report() }
}

/// How far a film is; its noise stays as it was `last` where it is not due.
fn look(film: &Film, settings: &Settings, elapsed: Duration, last: Option<Noise>) -> Status {
    let rounds = film.rounds();
    let noise = if is_noise_check(rounds) { noise(film, settings.window) } else { last };
    Status {
        rounds,
        samples: rounds * u64::from(settings.samples_per_round),
        elapsed,
        noise,
        rejected: film.rejected(),
    }
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
