//! `ajar convert`.

use std::path::PathBuf;

use ajar_scene::{Cause, Diagnostic, Preference, SceneFile, Severity};

use super::{Exit, input::Input, log::Format};
use crate::session;

#[derive(Debug, clap::Args)]
#[command(after_help = super::EXIT_CODES)]
pub(super) struct Args {
    #[command(flatten)]
    input: Input,
    /// The file to write, an Ajar scene with all its textures
    #[arg(short, long, value_name = "FILE.ajar")]
    output: PathBuf,
}

pub(super) fn run(args: &Args, log: Format) -> Exit {
    let diagnostics = convert(args).unwrap_or_else(|found| found);
    log.messages(&diagnostics, Severity::Note);
    Exit::after(&diagnostics, args.input.least())
}

/// Writes the scene; returns what is to be said about it.
fn convert(Args { input, output }: &Args) -> Result<Vec<Diagnostic>, Vec<Diagnostic>> {
    if !output.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("ajar")) {
        let error = Diagnostic::error("is not named .ajar").in_file(output).because(Cause::Usage);
        return Err(vec![error.hint("other formats are read, not written")]);
    }
    let SceneFile { scene, render, diagnostics, .. } = input.open()?;
    let preference = Preference { camera: render.camera, size: render.size };
    let bytes = ajar_importers::ajar::write(&scene, &preference)
        .map_err(|error| session::about(&input.file, [error]))?;
    ajar_output::write_atomically(output, |file| file.write_all(&bytes))
        .map_err(|e| vec![Diagnostic::error(e.to_string()).because(Cause::System)])?;
    Ok(diagnostics)
}
