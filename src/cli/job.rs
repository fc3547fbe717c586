//! What to render and where to write it: the command line over the scene file over the defaults.

use ajar_integrators::{Integrator, Settings, Window, integrators, stop::StopRules};
use ajar_output::{ToneMap, frame_path};
use ajar_scene::{Cause, Diagnostic, OutputSettings, RenderSettings};

use super::{frames, metropolis::metropolis, render::Args};
use crate::{
    checkpoint::Saved,
    image::{Aov, Destination, Form},
    session::{self, Loaded},
    shard::Shard,
};

/// Samples a pixel where no stop rule is given.
const DEFAULT_SPP: u32 = 64;
/// Edges of the longest path where nothing says another.
const DEFAULT_DEPTH: u32 = 16;
/// Fewest rounds that `--spp` is spread over, where it is enough for them: their spread is the noise estimate.
const ROUNDS_OF_SPP: u32 = 8;

/// What the command line and the file together ask for.
pub(super) struct Job {
    pub integrator: &'static dyn Integrator,
    /// Full frame, pixels.
    pub size: [u32; 2],
    pub settings: Settings,
    pub shard: Shard,
    /// When to stop; for a shard, in its own rounds.
    pub rules: StopRules,
    pub destination: Destination,
}

impl Job {
    /// Puts together what is asked for. A render that goes on keeps the rounds of `saved`.
    ///
    /// # Errors
    /// It cannot be done; of the cause [`Cause::Usage`].
    pub fn new(args: &Args, loaded: &Loaded, saved: Option<&Saved>) -> Result<Self, Diagnostic> {
        let (render, output) = (&loaded.file.render, &loaded.file.output);
        let name = args.integrator.as_deref().or(render.integrator.as_deref()).unwrap_or("ajar");
        let integrator = find_integrator(name)?;
        let size = session::film_size(args.size, &loaded.file, args.camera.as_deref());
        let max_depth = args.max_depth.or(render.max_depth).unwrap_or(DEFAULT_DEPTH) as usize;
        if max_depth > integrator.max_depth() {
            let most = integrator.max_depth();
            return Err(wrong(format!("max_depth {max_depth} is more than {name} can build, {most}")));
        }
        let kept = saved.map(|saved| saved.subject.samples_per_round);
        let (rules, samples_per_round) = stop_rules(args, render, integrator.samples_per_round(), kept);
        let shard = args.checkpoints.shard.unwrap_or(Shard::WHOLE);
        let rules = if shard.is_whole() { rules } else { share(rules, shard)? };
        let seed = args.seed.or(render.seed).unwrap_or(0);
        let window = window(args, render, size)?;
        let metropolis = metropolis(render)?;
        let settings = Settings { seed, max_depth, samples_per_round, window, metropolis };
        let destination = destination(args, output)?;
        args.checkpoints.check(&destination)?;
        Ok(Self { integrator, size, settings, shard, rules, destination })
    }

    /// What `--dry-run` says.
    pub fn describe(&self) -> String {
        let Window { x0, y0, x1, y1 } = self.settings.window;
        format!(
            "would render {}x{} pixels of {}x{} by {} to {}",
            x1 - x0,
            y1 - y0,
            self.size[0],
            self.size[1],
            self.integrator.name(),
            self.destination.exr.display()
        )
    }
}

pub(super) fn wrong(message: impl Into<String>) -> Diagnostic {
    Diagnostic::error(message).because(Cause::Usage)
}

fn find_integrator(name: &str) -> Result<&'static dyn Integrator, Diagnostic> {
    integrators().iter().copied().find(|i| i.name() == name).ok_or_else(|| {
        let known: Vec<_> = integrators().iter().map(|i| i.name()).collect();
        wrong(format!("there is no integrator \"{name}\""))
            .hint(format!("choose one of: {}", known.join(", ")))
    })
}

/// Stop rules given on the command line replace all those of the file. Rounds have as many samples as those that are
/// `kept`, otherwise as suits the number asked for, otherwise as suits the integrator.
fn stop_rules(
    args: &Args,
    render: &RenderSettings,
    samples_per_round: u32,
    kept: Option<u32>,
) -> (StopRules, u32) {
    let given = args.spp.is_some() || args.rounds.is_some() || args.time.is_some() || args.noise.is_some();
    let (mut spp, rounds, time, noise) = if given {
        (args.spp, args.rounds, args.time, args.noise)
    } else {
        (render.spp, render.rounds, render.time, render.noise)
    };
    if spp.is_none() && rounds.is_none() && time.is_none() && noise.is_none() {
        spp = Some(DEFAULT_SPP);
    }
    let fitting = |n| floor_power_of_two(n / ROUNDS_OF_SPP).min(256);
    let samples = kept.or(spp.map(fitting)).unwrap_or(samples_per_round);
    let by_spp = spp.map(|n| u64::from(n.div_ceil(samples)));
    let rounds = [rounds, by_spp].into_iter().flatten().min();
    (StopRules { rounds, time, noise }, samples)
}

/// The rules for a shard of a render of these rules.
fn share(rules: StopRules, shard: Shard) -> Result<StopRules, Diagnostic> {
    let (Some(total), None, None) = (rules.rounds, rules.time, rules.noise) else {
        return Err(wrong("shards share a number of rounds, which time and noise do not tell before")
            .hint("stop by --rounds or --spp alone"));
    };
    match shard.share(total) {
        0 => Err(wrong(format!("shard {shard} has nothing to do: there are only {total} rounds"))
            .hint("ask for more rounds or fewer shards")),
        rounds => Ok(StopRules { rounds: Some(rounds), ..rules }),
    }
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
        Err(wrong("the part to render holds no pixel"))
    }
}

fn destination(args: &Args, output: &OutputSettings) -> Result<Destination, Diagnostic> {
    let named = args.output.clone().or_else(|| args.checkpoints.shard_image());
    let merged = OutputSettings {
        // A new name on the command line takes its preview along.
        png: if named.is_some() { None } else { output.png.clone() },
        path: named.or_else(|| output.path.clone()),
        ..output.clone()
    };
    let (mut exr, mut png) = session::output_paths(&args.input.file, &merged);
    if let (Some(_), Some(frame)) = (&args.frames, args.input.frame()) {
        if merged.path.is_none() {
            exr = frames::default_template(&exr);
            png = exr.with_extension("png");
        }
        (exr, png) = (frames::place(&exr, frame)?, frames::place(&png, frame)?);
    } else if let Some(frame) = args.input.frame() {
        [exr, png] = [exr, png].map(|path| frame_path(&path, frame).unwrap_or(path));
    }
    let tone_map = args.tone_map.as_deref().or(output.tone_map.as_deref()).unwrap_or("agx");
    let names = args.aov.clone().or_else(|| output.aov.clone()).unwrap_or_default();
    let form = Form {
        tone_map: tone_map.parse::<ToneMap>().map_err(|e| wrong(e.to_string()))?,
        exposure: args.exposure.or(output.exposure).unwrap_or(0.0),
        aovs: names.iter().map(|name| Aov::parse(name)).collect::<Result<_, _>>()?,
        float: args.float || output.float.unwrap_or(false),
    };
    Ok(Destination { exr, png, form })
}
