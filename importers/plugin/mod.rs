//! Importers that are programs of their own: executables `ajar-import-NAME`.
//!
//! `docs/plug-ins.md` is the specification of what they are asked and what they answer.

mod answer;
mod config;
mod find;
mod process;

use std::{env, process::Command, time::Duration};

use ajar_scene::{Cause, Choice, Diagnostic, Feature, ImportRequest, Imported, Importer, Moment};

use self::process::Program;
use crate::{HEAD, files};

/// Replaces [`SILENCE`].
const TIMEOUT: &str = "AJAR_PLUGIN_TIMEOUT";

/// How long a plug-in may say nothing, seconds.
const SILENCE: u64 = 300;

/// The importer of what plug-ins claim.
pub struct PlugIns;

impl Importer for PlugIns {
    fn name(&self) -> &'static str {
        "plug-ins"
    }

    fn extensions(&self) -> &'static [&'static str] {
        &[]
    }

    fn sniff(&self, _head: &[u8]) -> bool {
        false
    }

    fn features(&self) -> &'static [Feature] {
        &[Feature { name: "ajar-import-NAME", support: "programs that read other formats; docs/plug-ins.md" }]
    }

    fn import(&self, request: &ImportRequest) -> Result<Imported, Diagnostic> {
        let plug_in = claimant(&request.path, &files::head(&request.path, HEAD)?)?
            .ok_or_else(|| Diagnostic::error("is claimed by no plug-in").in_file(&request.path))?;
        run(&plug_in.name(), Command::new(&plug_in.program), Vec::new(), request)
    }
}

pub use answer::answer;
pub(crate) use find::claimant;

/// Lets a plug-in import the file of `request`; `input` goes to its standard input.
///
/// # Errors
/// It cannot be run, is stopped, fails, or hands over no scene.
pub(crate) fn run(
    name: &str,
    mut command: Command,
    input: Vec<u8>,
    request: &ImportRequest,
) -> Result<Imported, Diagnostic> {
    command.arg("--import").arg(&request.path);
    for folder in &request.allowed {
        command.arg("--allow").arg(folder);
    }
    command.arg("--memory-limit").arg(request.memory_limit.to_string());
    choose(&mut command, &request.choice);
    let program = Program { command, input, silence: silence()?, most: request.memory_limit };
    let end = program.run().map_err(|failure| {
        let error = Diagnostic::error(format!("{name} {failure}")).in_file(&request.path);
        let error = error.because(failure.cause());
        match failure {
            process::Failure::Silence(_) => {
                error.hint(format!("{TIMEOUT} sets the seconds that a plug-in may say nothing"))
            }
            _ => error,
        }
    })?;
    answer::imported(name, end, request)
}

/// Tells which variants and which moment are to be read.
fn choose(command: &mut Command, choice: &Choice) {
    for variant in &choice.variants {
        command.arg("--variant").arg(variant);
    }
    match choice.moment {
        Some(Moment::Frame(frame)) => drop(command.arg("--frame").arg(frame.to_string())),
        Some(Moment::Seconds(seconds)) => drop(command.arg("--seconds").arg(seconds.to_string())),
        None => {}
    }
    if let Some(fps) = choice.fps {
        command.arg("--fps").arg(fps.to_string());
    }
}

/// How long a plug-in may say nothing.
///
/// # Errors
/// The user's own number is none.
fn silence() -> Result<Duration, Diagnostic> {
    let Some(text) = env::var_os(TIMEOUT) else { return Ok(Duration::from_secs(SILENCE)) };
    let seconds = text.to_str().and_then(|text| text.parse().ok()).filter(|&seconds| seconds > 0);
    seconds.map(Duration::from_secs).ok_or_else(|| {
        let message = format!("{TIMEOUT} is {text:?}, a number of seconds is needed");
        Diagnostic::error(message).because(Cause::Usage)
    })
}
