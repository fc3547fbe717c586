//! What to render and where to write it: the command line over the scene file over the defaults.

use ajar_integrators::{Integrator, Settings, Window, stop::StopRules};
use ajar_output::frame_path;
use ajar_scene::{Cause, Diagnostic, OutputSettings, Setting};

use super::{frames, render::Args};
use crate::{
    checkpoint::Saved,
    image::Destination,
    plan::Plan,
    session::{self, Loaded},
    shard::Shard,
};

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
    /// It cannot be done, or takes too much memory.
    pub fn new(args: &Args, loaded: &Loaded, saved: Option<&Saved>) -> Result<Self, Diagnostic> {
        let kept = saved.map(|saved| saved.subject.samples_per_round);
        let blame = |complaint| Setting::blame(&loaded.file.settings, complaint);
        let plan = args.demand.plan(&loaded.file, kept).map_err(blame)?;
        plan.check_memory(args.input.memory_limit).map_err(blame)?;
        let Plan { integrator, size, settings, rules } = plan;
        let shard = args.checkpoints.shard.unwrap_or(Shard::WHOLE);
        let rules = if shard.is_whole() { rules } else { share(rules, shard)? };
        let destination = destination(args, &loaded.file.output).map_err(blame)?;
        destination.check(&loaded.file.files)?;
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
    let form = args.appearance.form(output)?;
    Ok(Destination { exr, png, form })
}
