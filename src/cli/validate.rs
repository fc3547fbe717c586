//! `ajar validate`.

use std::path::PathBuf;

use ajar_scene::{Diagnostic, Severity};

use super::{Exit, arguments::parse_bytes, print, print_diagnostics};
use crate::session::{self, Loaded};

/// Film that the scene is prepared for; no pixel of it is rendered.
const FILM: [u32; 2] = [8, 8];

#[derive(Debug, clap::Args)]
#[command(after_help = super::EXIT_CODES)]
pub(super) struct Args {
    /// scene.toml, or any file that `ajar formats` lists
    file: PathBuf,
    /// Treat everything that was approximated or dropped as an error
    #[arg(long)]
    strict: bool,
    /// Most memory for geometry and for decoded textures, each: 512M, 8G
    #[arg(long, value_name = "SIZE", value_parser = parse_bytes, default_value = "8G")]
    memory_limit: u64,
}

pub(super) fn run(args: &Args) -> Exit {
    let (fit, diagnostics) = match check(args) {
        Ok(diagnostics) => (true, diagnostics),
        Err(diagnostics) => (false, diagnostics),
    };
    let fit = fit && (!args.strict || diagnostics.iter().all(|d| d.severity < Severity::Warning));
    print_diagnostics(&diagnostics, Severity::Note);
    let verdict = if fit { "fit to render" } else { "not fit to render" };
    print(&format!("{}: {verdict}{}", args.file.display(), tally(&diagnostics)));
    if fit { Exit::Ok } else { Exit::Invalid }
}

/// Everything short of rendering.
fn check(args: &Args) -> Result<Vec<Diagnostic>, Vec<Diagnostic>> {
    let Loaded { file, .. } = session::load(&args.file, 1.0, args.strict, args.memory_limit)?;
    let mut diagnostics = file.diagnostics;
    let prepared = session::choose_camera(&file.scene, file.render.camera.as_deref())
        .map_err(|d| vec![d])
        .and_then(|camera| session::prepare_world(file.scene, camera, FILM, args.memory_limit));
    let fit = prepared.is_ok();
    diagnostics.extend(session::about(&args.file, prepared.map_or_else(|found| found, |(_, found)| found)));
    if fit { Ok(diagnostics) } else { Err(diagnostics) }
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
