//! What a render leaves behind: files, and the lines that name them.

use std::path::Path;

use ajar_output::OutputError;
use ajar_scene::{Cause, Diagnostic};
use serde_json::json;

use super::{
    log::Format,
    progress::{duration, samples},
};
use crate::image::{self, Destination, Run};

/// Writes the images, and the numbers to `stats`; returns notes about them.
pub(super) fn write(
    run: &Run<'_>,
    to: &Destination,
    stats: Option<&Path>,
) -> Result<Vec<Diagnostic>, Diagnostic> {
    let notes = image::write(run, to).map_err(failed)?;
    if let Some(path) = stats {
        image::write_stats(run, path).map_err(failed)?;
    }
    Ok(notes)
}

/// The message about a file that cannot be written.
pub(super) fn failed(error: OutputError) -> Diagnostic {
    Diagnostic::error(error.to_string()).because(Cause::System)
}

/// What was done and where it is.
pub(super) fn summary(run: &Run<'_>, to: &Destination, checkpoint: Option<&Path>, log: Format) -> String {
    let (exr, png, checkpoint) = (shown(&to.exr), shown(&to.png), checkpoint.map(shown));
    if log == Format::Json {
        let stats = run.stats();
        return json!({ "type": "result", "exr": exr, "png": png, "checkpoint": checkpoint, "stats": stats })
            .to_string();
    }
    let status = run.status;
    let noise = status.noise.map_or(String::new(), |n| {
        format!(", noise {:.1} % (worst tile {:.0} %)", n.typical * 100.0, n.worst_tile * 100.0)
    });
    let partial = if run.complete { "" } else { " (interrupted)" };
    let (samples, time) = (samples(status.samples), duration(status.elapsed));
    let details: String = run.report.lines.iter().map(|line| format!("\n{line}")).collect();
    let files = [Some(exr), Some(png), checkpoint].into_iter().flatten();
    let files: String = files.map(|file| format!("\nwrote {file}")).collect();
    format!("{samples} in {time}{noise}{partial}{details}{files}")
}

fn shown(path: &Path) -> String {
    path.canonicalize().unwrap_or_else(|_| path.to_path_buf()).display().to_string()
}
