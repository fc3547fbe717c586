//! `ajar merge`.

use std::{path::PathBuf, time::Duration};

use ajar_integrators::{Report, stats::noise};
use ajar_scene::{Diagnostic, Severity};

use super::{Exit, arguments::parse_exr, checkpoints::check_names, log::Format, print, results};
use crate::{
    image::{Destination, Run},
    merge::merge,
    session::Status,
};

#[derive(Debug, clap::Args)]
#[command(after_help = super::EXIT_CODES)]
pub(super) struct Args {
    /// Files that `ajar render --checkpoint` wrote: all shards of a render, or one render that was not split
    #[arg(required = true)]
    parts: Vec<PathBuf>,
    /// Image to write, in the form asked for when the parts were rendered; a PNG preview goes beside it
    #[arg(short, long, value_name = "OUT.exr", value_parser = parse_exr)]
    output: PathBuf,
}

pub(super) fn run(args: &Args, log: Format) -> Exit {
    match execute(args, log) {
        Ok(()) => Exit::Ok,
        Err(diagnostics) => {
            log.messages(&diagnostics, Severity::Error);
            Exit::after(&diagnostics, Severity::Error)
        }
    }
}

fn execute(args: &Args, log: Format) -> Result<(), Vec<Diagnostic>> {
    let (exr, png) = (args.output.clone(), args.output.with_extension("png"));
    args.parts.iter().try_for_each(|part| check_names(part, &exr, &png)).map_err(|d| vec![d])?;
    let sum = merge(&args.parts)?;
    let settings = sum.subject.settings();
    let status = Status {
        rounds: sum.film.rounds(),
        samples: sum.film.rounds().saturating_mul(settings.samples_per_round.into()),
        elapsed: Duration::try_from_secs_f64(sum.seconds).unwrap_or_default(),
        noise: noise(&sum.film, settings.window),
        rejected: sum.film.rejected(),
    };
    let told = sum.mutations_per_sample.map(|number| ("mutations_per_sample".into(), number));
    let report = Report { numbers: told.into_iter().collect(), ..Report::default() };
    let run = Run {
        camera: &(sum.subject.camera, sum.subject.camera_place),
        size: sum.subject.size,
        features: &sum.features,
        integrator: &sum.subject.integrator,
        settings: &settings,
        film: &sum.film,
        shard: sum.shard,
        status: &status,
        report: &report,
        complete: sum.complete,
        scene_hash: &sum.subject.scene,
        comment: None,
    };
    let to = Destination { exr, png, form: sum.form };
    let notes = results::write(&run, &to, None).map_err(|d| vec![d])?;
    log.messages(&notes, Severity::Note);
    print(&results::summary(&run, &to, None, log));
    Ok(())
}
