//! `ajar render`.

use std::{
    cell::{LazyCell, OnceCell},
    path::PathBuf,
    time::Duration,
};

use ajar_integrators::{
    Report, Rounds,
    features::{Features, features as first_hits},
};
use ajar_render::{World, film::Film};
use ajar_scene::{Camera, Cause, Diagnostic, Severity};
use glam::DAffine3;

use super::{
    Exit,
    appearance::Appearance,
    arguments::parse_exr,
    checkpoints::Checkpoints,
    demand::Demand,
    frames::{self, Frames, parse_frames},
    input::Input,
    job::Job,
    log::{Format, Verbosity},
    print,
    progress::{Progress, samples},
    results,
    signals::Signals,
};
use crate::{
    checkpoint::Subject,
    image::{Destination, Run},
    session::{self, Loaded, Start, Status},
};

#[derive(Clone, Debug, clap::Args)]
#[command(after_help = super::EXIT_CODES)]
pub(super) struct Args {
    #[command(flatten)]
    pub input: Input,
    /// Render these frames, one after the other: 1:10x2,15. Their number takes the place of #### or %04d in OUT.exr
    #[arg(long, value_name = "FRAMES", value_parser = parse_frames, allow_hyphen_values = true,
          conflicts_with_all = ["frame", "at", "checkpoint", "resume", "shard"])]
    pub frames: Option<Frames>,
    /// Image to write; a PNG preview goes beside it [default: <name>.exr in the current folder]
    #[arg(short, long, value_name = "OUT.exr", value_parser = parse_exr)]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub demand: Demand,
    #[command(flatten)]
    pub appearance: Appearance,
    #[command(flatten)]
    pub checkpoints: Checkpoints,
    /// Load and prepare, say what would be rendered, write nothing
    #[arg(long)]
    dry_run: bool,
    /// Write numbers about the render as JSON
    #[arg(long, value_name = "FILE")]
    stats_json: Option<PathBuf>,
    #[command(flatten)]
    verbosity: Verbosity,
}

pub(super) fn run(args: &Args, log: Format) -> Exit {
    execute(args, log).unwrap_or_else(|diagnostics| {
        log.messages(&diagnostics, args.input.least());
        Exit::after(&diagnostics, args.input.least())
    })
}

fn execute(args: &Args, log: Format) -> Result<Exit, Vec<Diagnostic>> {
    args.demand.start_threads().map_err(|d| vec![d])?;
    let signals = Signals::new().map_err(|e| fail(Cause::System, format!("cannot handle signals: {e}")))?;
    let Some(Frames(frames)) = &args.frames else { return image(args, log, &signals) };
    for &frame in frames {
        let mut one = Args { input: args.input.at_frame(frame), ..args.clone() };
        if let Some(stats) = &args.stats_json {
            one.stats_json = Some(frames::place(stats, frame).map_err(|d| vec![d])?);
        }
        match image(&one, log, &signals)? {
            Exit::Ok => {}
            other => return Ok(other),
        }
    }
    Ok(Exit::Ok)
}

/// Renders one image.
fn image(args: &Args, log: Format, signals: &Signals) -> Result<Exit, Vec<Diagnostic>> {
    let (ready, done) = Ready::new(args, log)?;
    if args.dry_run {
        print(&ready.job.describe());
        return Ok(Exit::Ok);
    }
    let Job { integrator, settings, shard, rules, destination, .. } = &ready.job;
    let (mut progress, mut saving) = (Progress::new(args.verbosity.quiet, log), args.checkpoints.saving());
    let each_round = |film: &Film, status: &Status, rounds: &dyn Rounds| {
        progress.update(status, rules);
        let report = LazyCell::new(|| rounds.report());
        let run = || ready.run(film, status, &report, false);
        if signals.snapshot_asked() {
            snapshot(&run(), destination, args, log);
        }
        if saving.is_due()
            && let Err(error) = saving.save(&run(), &destination.form)
        {
            // A disk that is full now may have room at the end.
            log.messages(&[Diagnostic { severity: Severity::Warning, ..error }], args.verbosity.least());
        }
    };
    let start = Start { shard: *shard, done };
    let rendered =
        session::render(&ready.world, *integrator, settings, rules, start, signals.stop(), each_round);
    progress.finish();
    if rendered.status.rounds == 0 {
        let nothing = Diagnostic::error("interrupted before the first round was done; nothing written");
        log.messages(&[nothing], Severity::Error);
        return Ok(Exit::Interrupted);
    }
    let complete = rendered.reason.is_some();
    let run = ready.run(&rendered.film, &rendered.status, &rendered.report, complete);
    // If one of the files cannot be written, the other still is.
    let saved = saving.save(&run, &destination.form);
    let written = results::write(&run, destination, args.stats_json.as_deref());
    let notes = saved.and(written).map_err(|d| vec![d])?;
    if !args.verbosity.quiet {
        log.messages(&notes, Severity::Note);
        print(&results::summary(&run, destination, args.checkpoints.path(), log));
    }
    Ok(if complete { Exit::Ok } else { Exit::Interrupted })
}

/// Everything that a render needs.
struct Ready {
    world: World,
    /// The camera and its place.
    camera: (Camera, DAffine3),
    scene_hash: String,
    job: Job,
    /// First hits, found when something is written.
    features: OnceCell<Vec<Features>>,
}

/// A film to go on with, and the time it took.
type Done = (Film, Duration);

impl Ready {
    /// With what to go on with, if there is something.
    fn new(args: &Args, log: Format) -> Result<(Self, Option<Done>), Vec<Diagnostic>> {
        let path = &args.input.file;
        let saved = args.checkpoints.open().map_err(|d| vec![d])?;
        let loaded = args.input.load(args.demand.size)?;
        let job = Job::new(args, &loaded, saved.as_ref()).map_err(|d| vec![d])?;
        let Loaded { file, added, hash: scene_hash } = loaded;
        log.messages(&file.diagnostics, args.verbosity.least());
        if !args.verbosity.quiet {
            log.messages(&added, Severity::Note);
        }
        let name = args.demand.camera.as_deref().or(file.render.camera.as_deref());
        let id = session::choose_camera(&file.scene, name).map_err(|d| vec![d])?;
        let camera = (file.scene.cameras[id.0].clone(), id.1);
        let subject = Subject::new(&scene_hash, &camera, job.size, job.integrator.name(), &job.settings);
        let done = saved.map(|saved| args.checkpoints.resume(saved, &subject, job.shard)).transpose()?;
        let (world, warnings) = session::prepare_world(file.scene, id, job.size, args.input.memory_limit)
            .map_err(|d| session::about(path, d))?;
        log.messages(&session::about(path, warnings), args.verbosity.least());
        Ok((Self { world, camera, scene_hash, job, features: OnceCell::new() }, done))
    }

    fn run<'a>(&'a self, film: &'a Film, status: &'a Status, report: &'a Report, complete: bool) -> Run<'a> {
        let Self { world, camera, scene_hash, job, features } = self;
        let Job { integrator, size, ref settings, shard, .. } = *job;
        let features = features.get_or_init(|| first_hits(world, settings.window));
        let integrator = integrator.name();
        Run {
            camera,
            size,
            features,
            integrator,
            settings,
            film,
            shard,
            status,
            report,
            complete,
            scene_hash,
            comment: None,
        }
    }
}

fn fail(cause: Cause, message: String) -> Vec<Diagnostic> {
    vec![Diagnostic::error(message).because(cause)]
}

/// Writes the image as it is so far; a disk that is full now may have room at the end.
fn snapshot(run: &Run<'_>, to: &Destination, args: &Args, log: Format) {
    let said = match results::write(run, to, args.stats_json.as_deref()) {
        Ok(_) => Diagnostic::note(format!("snapshot after {}", samples(run.status.samples))).in_file(&to.exr),
        Err(error) => Diagnostic { severity: Severity::Warning, ..error },
    };
    if !args.verbosity.quiet {
        log.messages(&[said], Severity::Note);
    }
}
