//! `ajar render`.

use std::{
    path::{Path, PathBuf},
    time::Duration,
};

use ajar_integrators::{Integrator, Settings, Window, integrators, stop::StopRules};
use ajar_output::ToneMap;
use ajar_scene::{Diagnostic, OutputSettings, RenderSettings, Severity, parse_duration, parse_percent};

use super::{
    Exit,
    arguments::{parse_bounds, parse_bytes, parse_crop, parse_size},
    print, print_diagnostics,
    progress::{Progress, duration},
    signals,
};
use crate::{
    image::{self, Aov, Destination},
    session::{self, Loaded},
};

/// Film size where nothing says another.
const DEFAULT_SIZE: [u32; 2] = [1280, 720];
/// Samples a pixel where no stop rule is given.
const DEFAULT_SPP: u32 = 64;
/// Fewest rounds that `--spp` is spread over, where it is enough for them: their spread is the noise estimate. Points are
/// evenly spread within a round only, so more rounds would mean more noise.
const ROUNDS_OF_SPP: u32 = 8;
/// Eye samples a pixel in a round when only time, noise or rounds limit the render.
const SAMPLES_PER_ROUND: u32 = 16;

#[derive(Debug, clap::Args)]
#[command(after_help = super::EXIT_CODES)]
pub(super) struct Args {
    /// scene.toml, or any file that `ajar formats` lists
    file: PathBuf,
    /// Image to write; a PNG preview goes beside it [default: <name>.exr in the current folder]
    #[arg(short, long, value_name = "OUT.exr")]
    output: Option<PathBuf>,
    /// Camera to look through [default: the first]
    #[arg(long, value_name = "NAME")]
    camera: Option<String>,
    /// Film size in pixels [default: 1280x720]
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<[u32; 2]>,
    /// How to render: path or bdpt [default: path]
    #[arg(long, value_name = "NAME")]
    integrator: Option<String>,
    /// Key of all random numbers
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Edges of the longest path [default: 16]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    max_depth: Option<u32>,
    /// Threads [default: one a core]; the image does not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Stop after N samples a pixel [default: 64 if there is no other stop rule]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    spp: Option<u32>,
    /// Stop after N rounds
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    rounds: Option<u64>,
    /// Stop after a time: 90s, 10m, 2h
    #[arg(long, value_name = "TIME", value_parser = parse_duration)]
    time: Option<Duration>,
    /// Stop when the noise of the typical pixel is this low: 2%
    #[arg(long, value_name = "PERCENT", value_parser = parse_percent)]
    noise: Option<f64>,
    /// Render only this part, as fractions of the frame: x0,x1,y0,y1
    #[arg(long, value_name = "X0,X1,Y0,Y1", value_parser = parse_crop, conflicts_with = "pixel_bounds")]
    crop: Option<[f64; 4]>,
    /// Render only these pixels, the second bounds excluded: x0,x1,y0,y1
    #[arg(long, value_name = "X0,X1,Y0,Y1", value_parser = parse_bounds)]
    pixel_bounds: Option<[u32; 4]>,
    /// Layers to add, with commas between: albedo, normal, geometric_normal, depth, position, uv, material_id, object_id,
    /// variance
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    aov: Option<Vec<String>>,
    /// Tone map of the PNG: agx, aces, neutral or srgb
    #[arg(long, value_name = "NAME")]
    tone_map: Option<String>,
    /// Exposure of the PNG in stops
    #[arg(long, value_name = "EV", allow_negative_numbers = true)]
    exposure: Option<f64>,
    /// Write colours as 32-bit floats instead of halves
    #[arg(long)]
    float: bool,
    /// Treat everything that was approximated or dropped as an error
    #[arg(long)]
    strict: bool,
    /// Most memory for geometry and for decoded textures, each: 512M, 8G
    #[arg(long, value_name = "SIZE", value_parser = parse_bytes, default_value = "8G")]
    memory_limit: u64,
    /// Load and prepare, say what would be rendered, write nothing
    #[arg(long)]
    dry_run: bool,
    /// Write numbers about the render as JSON
    #[arg(long, value_name = "FILE")]
    stats_json: Option<PathBuf>,
    /// Show notes too
    #[arg(short, long, conflicts_with = "quiet")]
    verbose: bool,
    /// Say nothing but errors
    #[arg(short, long)]
    quiet: bool,
}

/// What the command line and the file together ask for.
struct Job {
    integrator: &'static dyn Integrator,
    size: [u32; 2],
    settings: Settings,
    rules: StopRules,
    destination: Destination,
}

pub(super) fn run(args: &Args) -> Exit {
    match execute(args) {
        Ok(exit) => exit,
        Err((exit, diagnostics)) => {
            let least = if args.strict { Severity::Warning } else { Severity::Error };
            print_diagnostics(&diagnostics, least);
            exit
        }
    }
}

type Failure = (Exit, Vec<Diagnostic>);

fn execute(args: &Args) -> Result<Exit, Failure> {
    if let Some(threads) = args.threads {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.into()).build_global();
        pool.map_err(|e| fail(Exit::Resources, format!("cannot start {threads} threads: {e}")))?;
    }
    let stop = signals::stop_flag().map_err(|e| fail(Exit::Failed, format!("cannot handle signals: {e}")))?;
    let size = args.size.unwrap_or(DEFAULT_SIZE);
    let aspect = f64::from(size[0]) / f64::from(size[1]);
    let loaded =
        session::load(&args.file, aspect, args.strict, args.memory_limit).map_err(|d| (Exit::Invalid, d))?;
    let job = job(args, &loaded).map_err(|d| (Exit::Usage, vec![d]))?;
    let Loaded { file, hash } = loaded;
    let least = match (args.quiet, args.verbose) {
        (true, _) => Severity::Error,
        (_, true) => Severity::Note,
        _ => Severity::Warning,
    };
    print_diagnostics(&file.diagnostics, least);
    let camera = args.camera.as_deref().or(file.render.camera.as_deref());
    let camera = session::choose_camera(&file.scene, camera).map_err(|d| (Exit::Usage, vec![d]))?;
    let lens = (file.scene.cameras[camera.0].clone(), camera.1);
    let (world, warnings) = session::prepare_world(file.scene, camera, job.size, args.memory_limit)
        .map_err(|d| (Exit::Invalid, session::about(&args.file, d)))?;
    let warnings = session::about(&args.file, warnings);
    print_diagnostics(&warnings, least);
    if args.dry_run {
        print(&dry_run(&job));
        return Ok(Exit::Ok);
    }
    let mut progress = Progress::new(args.quiet);
    let rendered = session::render(&world, job.integrator, &job.settings, &job.rules, &stop, |status| {
        progress.update(status, &job.rules);
    });
    progress.finish();
    if rendered.status.rounds == 0 {
        return Err(fail(
            Exit::Interrupted,
            "interrupted before the first round was done; nothing written".into(),
        ));
    }
    let run = image::Run {
        world: &world,
        camera: &lens,
        integrator: job.integrator.name(),
        settings: &job.settings,
        rendered: &rendered,
        scene_hash: &hash,
    };
    let notes = image::write(&run, &job.destination).map_err(|e| fail(Exit::Failed, e.to_string()))?;
    if let Some(path) = &args.stats_json {
        image::write_stats(&run, path).map_err(|e| fail(Exit::Failed, e.to_string()))?;
    }
    if !args.quiet {
        notes.iter().for_each(|note| eprintln!("{note}"));
        print(&summary(&rendered, &job.destination));
    }
    Ok(if rendered.reason.is_some() { Exit::Ok } else { Exit::Interrupted })
}

fn fail(exit: Exit, message: String) -> Failure {
    (exit, vec![Diagnostic::error(message)])
}

fn job(args: &Args, loaded: &Loaded) -> Result<Job, Diagnostic> {
    let (render, output) = (&loaded.file.render, &loaded.file.output);
    let name = args.integrator.as_deref().or(render.integrator.as_deref()).unwrap_or("path");
    let integrator = find_integrator(name)?;
    let size = args.size.or(render.size).unwrap_or(DEFAULT_SIZE);
    let max_depth = args.max_depth.or(render.max_depth).unwrap_or(16) as usize;
    if max_depth > integrator.max_depth() {
        let most = integrator.max_depth();
        return Err(Diagnostic::error(format!(
            "max_depth {max_depth} is more than {name} can build, {most}"
        )));
    }
    let (rules, samples_per_round) = stop_rules(args, render);
    let settings = Settings {
        seed: args.seed.or(render.seed).unwrap_or(0),
        max_depth,
        samples_per_round,
        window: window(args, render, size)?,
    };
    Ok(Job { integrator, size, settings, rules, destination: destination(args, output)? })
}

fn find_integrator(name: &str) -> Result<&'static dyn Integrator, Diagnostic> {
    integrators().iter().copied().find(|i| i.name() == name).ok_or_else(|| {
        let known: Vec<_> = integrators().iter().map(|i| i.name()).collect();
        Diagnostic::error(format!("there is no integrator \"{name}\""))
            .hint(format!("choose one of: {}", known.join(", ")))
    })
}

/// Stop rules given on the command line replace all those of the file.
fn stop_rules(args: &Args, render: &RenderSettings) -> (StopRules, u32) {
    let given = args.spp.is_some() || args.rounds.is_some() || args.time.is_some() || args.noise.is_some();
    let (mut spp, rounds, time, noise) = if given {
        (args.spp, args.rounds, args.time, args.noise)
    } else {
        (render.spp, render.rounds, render.time, render.noise)
    };
    if spp.is_none() && rounds.is_none() && time.is_none() && noise.is_none() {
        spp = Some(DEFAULT_SPP);
    }
    let samples = spp.map_or(SAMPLES_PER_ROUND, |n| floor_power_of_two(n / ROUNDS_OF_SPP).min(256));
    let by_spp = spp.map(|n| u64::from(n.div_ceil(samples)));
    let rounds = [rounds, by_spp].into_iter().flatten().min();
    (StopRules { rounds, time, noise }, samples)
}

fn floor_power_of_two(n: u32) -> u32 {
    if n == 0 { 1 } else { 1 << n.ilog2() }
}

fn window(args: &Args, render: &RenderSettings, [w, h]: [u32; 2]) -> Result<Window, Diagnostic> {
    let window = match (args.pixel_bounds, args.crop.or(render.crop)) {
        (Some([x0, x1, y0, y1]), _) => Window { x0, y0, x1: x1.min(w), y1: y1.min(h) },
        (None, Some([x0, x1, y0, y1])) => {
            let at = |fraction: f64, n: u32| (fraction * f64::from(n)).round() as u32;
            Window { x0: at(x0, w), y0: at(y0, h), x1: at(x1, w).min(w), y1: at(y1, h).min(h) }
        }
        (None, None) => Window { x0: 0, y0: 0, x1: w, y1: h },
    };
    if window.x0 < window.x1 && window.y0 < window.y1 {
        Ok(window)
    } else {
        Err(Diagnostic::error("the part to render holds no pixel"))
    }
}

fn destination(args: &Args, output: &OutputSettings) -> Result<Destination, Diagnostic> {
    let merged = OutputSettings {
        path: args.output.clone().or_else(|| output.path.clone()),
        // A new name on the command line takes its preview along.
        png: if args.output.is_some() { None } else { output.png.clone() },
        ..output.clone()
    };
    let (exr, png) = session::output_paths(&args.file, &merged);
    let tone_map = args.tone_map.as_deref().or(output.tone_map.as_deref()).unwrap_or("agx");
    let names = args.aov.clone().or_else(|| output.aov.clone()).unwrap_or_default();
    Ok(Destination {
        exr,
        png,
        tone_map: tone_map.parse::<ToneMap>().map_err(|e| Diagnostic::error(e.to_string()))?,
        exposure: args.exposure.or(output.exposure).unwrap_or(0.0),
        aovs: names.iter().map(|name| Aov::parse(name)).collect::<Result<_, _>>()?,
        float: args.float || output.float.unwrap_or(false),
    })
}

fn dry_run(job: &Job) -> String {
    let Window { x0, y0, x1, y1 } = job.settings.window;
    format!(
        "would render {}x{} pixels of {}x{} by {} to {}",
        x1 - x0,
        y1 - y0,
        job.size[0],
        job.size[1],
        job.integrator.name(),
        job.destination.exr.display()
    )
}

fn summary(rendered: &session::Rendered, destination: &Destination) -> String {
    let status = &rendered.status;
    let noise = status.noise.map_or(String::new(), |n| {
        format!(", noise {:.1} % (worst tile {:.0} %)", n.typical * 100.0, n.worst_tile * 100.0)
    });
    let partial = if rendered.reason.is_none() { " (interrupted)" } else { "" };
    format!(
        "{} samples a pixel in {}{noise}{partial}\nwrote {}\nwrote {}",
        status.samples,
        duration(status.elapsed),
        shown(&destination.exr),
        shown(&destination.png)
    )
}

fn shown(path: &Path) -> String {
    path.canonicalize().unwrap_or_else(|_| path.to_path_buf()).display().to_string()
}
