//! What image is asked for and when it is done; the same for all commands that render.

use std::time::Duration;

use ajar_integrators::{Integrator, Settings, Window, integrators, stop::StopRules};
use ajar_scene::{Diagnostic, RenderSettings, SceneFile, parse_duration};

use super::{
    arguments::{parse_bounds, parse_crop, parse_noise, parse_size},
    job::wrong,
    metropolis::metropolis,
};
use crate::{plan::Plan, session, watch::Said};

/// Samples a pixel where no stop rule is given.
const DEFAULT_SPP: u32 = 64;
/// Edges of the longest path where nothing says another.
const DEFAULT_DEPTH: u32 = 16;
/// Fewest rounds that `--spp` is spread over, where it is enough for them: their spread is the noise estimate.
const ROUNDS_OF_SPP: u32 = 8;

#[derive(Clone, Debug, Default, clap::Args)]
pub(super) struct Demand {
    /// Camera to look through [default: the first]
    #[arg(long, value_name = "NAME")]
    pub camera: Option<String>,
    /// Film size in pixels [default: 1280 wide, in the shape of the camera, else 1280x720]
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    pub size: Option<[u32; 2]>,
    /// How to render: path for light that comes directly, bdpt for caustics and lamps behind glass, mlt for light on hard
    /// ways, ajar for all of these [default: ajar]
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
    #[command(flatten)]
    until: Until,
    /// Render only this part, as fractions of the frame: x0,x1,y0,y1
    #[arg(long, value_name = "X0,X1,Y0,Y1", value_parser = parse_crop, conflicts_with = "pixel_bounds")]
    crop: Option<[f64; 4]>,
    /// Render only these pixels, the second bounds excluded: x0,x1,y0,y1
    #[arg(long, value_name = "X0,X1,Y0,Y1", value_parser = parse_bounds)]
    pixel_bounds: Option<[u32; 4]>,
}

/// When an image is done: the first to hold.
#[derive(Clone, Debug, Default, clap::Args)]
struct Until {
    /// Stop after N samples a pixel, rounded up to whole rounds; without any stop rule, render stops after 64, watch at a
    /// noise of 1 %
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    spp: Option<u32>,
    /// Stop after N rounds
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    rounds: Option<u64>,
    /// Stop with the round in which this time ends: 90s, 10m, 2h
    #[arg(long, value_name = "TIME", value_parser = parse_duration)]
    time: Option<Duration>,
    /// Stop when the noise of the typical pixel is this low: 2%
    #[arg(long, value_name = "PERCENT", value_parser = parse_noise)]
    noise: Option<f64>,
}

impl Until {
    /// Rules given on the command line replace all those of the file.
    fn over(&self, file: &RenderSettings) -> Self {
        let of_file = Self { spp: file.spp, rounds: file.rounds, time: file.time, noise: file.noise };
        if self.is_never() { of_file } else { self.clone() }
    }

    fn is_never(&self) -> bool {
        self.spp.is_none() && self.rounds.is_none() && self.time.is_none() && self.noise.is_none()
    }
}

impl Demand {
    /// The same, done at this noise where neither it nor the file says when.
    pub fn or_noise(&self, file: &RenderSettings, noise: f64) -> Self {
        let mut demand = self.clone();
        if self.until.over(file).is_never() {
            demand.until.noise = Some(noise);
        }
        demand
    }

    /// Starts the threads that are asked for.
    ///
    /// # Errors
    /// They cannot be started.
    pub fn start_threads(&self) -> Result<(), Diagnostic> {
        let Some(threads) = self.threads else { return Ok(()) };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.into()).build_global();
        pool.map_err(|e| {
            Diagnostic::error(format!("cannot start {threads} threads: {e}"))
                .because(ajar_scene::Cause::Resource)
        })
    }

    /// What it means for a file. Rounds have as many samples as those that are `kept` from an earlier render, otherwise as
    /// suits the number asked for, otherwise as suits the integrator.
    ///
    /// # Errors
    /// It cannot be done; of the cause `Usage`.
    pub fn plan(&self, file: &SceneFile, kept: Option<u32>) -> Result<Plan, Diagnostic> {
        let render = &file.render;
        let name = self.integrator.as_deref().or(render.integrator.as_deref()).unwrap_or("ajar");
        let integrator = find_integrator(name).map_err(|d| of_file(&self.integrator, "integrator", d))?;
        let size = session::film_size(self.size, file, self.camera.as_deref());
        let max_depth = self.max_depth.or(render.max_depth).unwrap_or(DEFAULT_DEPTH) as usize;
        if max_depth > integrator.max_depth() {
            let most = integrator.max_depth();
            let wrong = wrong(format!("max_depth {max_depth} is more than {name} can build, {most}"));
            return Err(of_file(&self.max_depth, "max_depth", wrong));
        }
        let (rules, samples_per_round) =
            stop_rules(self.until.over(render), integrator.samples_per_round(), kept);
        let seed = self.seed.or(render.seed).unwrap_or(0);
        let window = self.window(render, size)?;
        let metropolis = metropolis(render)?;
        let settings = Settings { seed, max_depth, samples_per_round, window, metropolis };
        Ok(Plan { integrator, size, settings, rules })
    }

    /// Adds what is said about the look of images; when they are done is none of it. The camera that is looked through has
    /// this name.
    pub fn say(&self, camera: &str, said: &mut Said) {
        match &self.camera {
            Some(_) if camera.is_empty() => said.unsaid.push("--camera".into()),
            Some(_) => said.say("render", "camera", camera),
            None => {}
        }
        if let Some(size) = self.size {
            said.say("render", "size", size.map(i64::from).to_vec());
        }
        if let Some(name) = &self.integrator {
            said.say("render", "integrator", name.as_str());
        }
        if let Some(seed) = self.seed {
            match i64::try_from(seed) {
                Ok(seed) => said.say("render", "seed", seed),
                Err(_) => said.unsaid.push("--seed".into()),
            }
        }
        if let Some(depth) = self.max_depth {
            said.say("render", "max_depth", i64::from(depth));
        }
        if let Some(crop) = self.crop {
            said.say("render", "crop", crop.to_vec());
        }
        if self.pixel_bounds.is_some() {
            said.unsaid.push("--pixel-bounds".into());
        }
    }

    fn window(&self, render: &RenderSettings, [w, h]: [u32; 2]) -> Result<Window, Diagnostic> {
        let window = match (self.pixel_bounds, self.crop.or(render.crop)) {
            (Some([_, x1, _, y1]), _) if x1 > w || y1 > h => {
                return Err(wrong(format!("the pixels end at {x1}, {y1}, the image at {w}, {h}")));
            }
            (Some([x0, x1, y0, y1]), _) => Window { x0, y0, x1, y1 },
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
}

/// A complaint about a value that is `given` on the command line, or is that of the file under this key of `[render]`.
fn of_file<T>(given: &Option<T>, key: &str, complaint: Diagnostic) -> Diagnostic {
    if given.is_some() { complaint } else { complaint.element(format!("render.{key}")) }
}

fn find_integrator(name: &str) -> Result<&'static dyn Integrator, Diagnostic> {
    integrators().iter().copied().find(|i| i.name() == name).ok_or_else(|| {
        let known: Vec<_> = integrators().iter().map(|i| i.name()).collect();
        wrong(format!("there is no integrator \"{name}\""))
            .hint(format!("choose one of: {}", known.join(", ")))
    })
}

/// The rules, and the samples of a round.
fn stop_rules(mut until: Until, samples_per_round: u32, kept: Option<u32>) -> (StopRules, u32) {
    if until.is_never() {
        until.spp = Some(DEFAULT_SPP);
    }
    let Until { spp, rounds, time, noise } = until;
    let fitting = |n| floor_power_of_two(n / ROUNDS_OF_SPP).min(256);
    let samples = kept.or(spp.map(fitting)).unwrap_or(samples_per_round);
    let by_spp = spp.map(|n| u64::from(n.div_ceil(samples)));
    let rounds = [rounds, by_spp].into_iter().flatten().min();
    (StopRules { rounds, time, noise }, samples)
}

fn floor_power_of_two(n: u32) -> u32 {
    if n == 0 { 1 } else { 1 << n.ilog2() }
}
