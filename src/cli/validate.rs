//! `ajar validate`.

use ajar_scene::{Diagnostic, Setting, Severity};

use super::{Exit, appearance::Appearance, demand::Demand, input::Input, log::Format, print};
use crate::session::{self, Loaded};

/// Film that the scene is prepared for; no pixel of it is rendered.
const FILM: [u32; 2] = [8, 8];

#[derive(Debug, clap::Args)]
#[command(after_help = super::EXIT_CODES)]
pub(super) struct Args {
    #[command(flatten)]
    input: Input,
}

pub(super) fn run(Args { input }: &Args, log: Format) -> Exit {
    let diagnostics = check(input);
    let exit = Exit::after(&diagnostics, input.least());
    log.messages(&diagnostics, Severity::Note);
    let verdict = if exit == Exit::Ok { "fit to render" } else { "not fit to render" };
    print(&format!("{}: {verdict}{}", input.file.display(), tally(&diagnostics)));
    exit
}

/// All that is said on the way to rendering.
fn check(input: &Input) -> Vec<Diagnostic> {
    let Loaded { file, added, .. } = match input.load(None) {
        Ok(loaded) => loaded,
        Err(diagnostics) => return diagnostics,
    };
    let mut diagnostics = file.diagnostics.clone();
    diagnostics.extend(added);
    let planned = Demand::default().plan(&file, None).and_then(|plan| plan.check_memory(input.memory_limit));
    let formed = Appearance::default().form(&file.output);
    let complaints = [planned.err(), formed.err()].into_iter().flatten();
    let complaints = complaints.map(|complaint| Setting::blame(&file.settings, complaint));
    diagnostics.extend(session::about(&input.file, complaints));
    let prepared = session::choose_camera(&file.scene, file.render.camera.as_deref())
        .map_err(|d| vec![d])
        .and_then(|camera| session::prepare_world(file.scene, camera, FILM, input.memory_limit));
    diagnostics.extend(session::about(&input.file, prepared.map_or_else(|found| found, |(_, found)| found)));
    diagnostics
}

/// `: 1 error, 2 warnings`, or nothing.
fn tally(diagnostics: &[Diagnostic]) -> String {
    let count = |severity| diagnostics.iter().filter(|d| d.severity == severity).count();
    let counts = [("error", count(Severity::Error)), ("warning", count(Severity::Warning))];
    let said: Vec<_> = counts
        .into_iter()
        .filter(|(_, n)| *n > 0)
        .map(|(what, n)| format!("{n} {what}{}", if n == 1 { "" } else { "s" }))
        .collect();
    if said.is_empty() { String::new() } else { format!(": {}", said.join(", ")) }
}
