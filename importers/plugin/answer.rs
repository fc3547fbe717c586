//! What a plug-in answers: a scene on standard output, and lines about it.

use std::path::PathBuf;

use ajar_scene::{Cause, Diagnostic, ImportRequest, Imported, Loss, Severity};
use serde::Deserialize;

use super::process::End;
use crate::{ajar, gltf, report::Report};

/// Lines without form that an error repeats.
const LAST_LINES: usize = 5;

/// A line of standard error.
#[derive(Deserialize)]
#[serde(untagged)]
enum Line {
    Message {
        level: Severity,
        message: String,
        place: Option<String>,
        hint: Option<String>,
        loss: Option<Loss>,
        #[serde(default)]
        cause: Cause,
    },
    File {
        file: PathBuf,
    },
    Progress {
        #[expect(dead_code, reason = "that it came says all")]
        progress: String,
    },
}

/// What the lines said.
struct Said {
    report: Report,
    files: Vec<PathBuf>,
    error: Option<Diagnostic>,
    /// Lines without form.
    other: Vec<String>,
}

impl Said {
    fn new(messages: &[u8]) -> Self {
        let mut said = Self { report: Report::default(), files: Vec::new(), error: None, other: Vec::new() };
        for line in String::from_utf8_lossy(messages).lines().filter(|line| !line.trim().is_empty()) {
            match serde_json::from_str(line) {
                Ok(Line::File { file }) => said.files.push(file),
                Ok(Line::Progress { .. }) => {}
                Ok(Line::Message { level, message, place, hint, loss, cause }) => said.add(Diagnostic {
                    severity: level,
                    cause,
                    loss,
                    element: place,
                    hint,
                    ..Diagnostic::error(message)
                }),
                Err(_) => said.other.push(line.to_owned()),
            }
        }
        said
    }

    fn add(&mut self, diagnostic: Diagnostic) {
        if diagnostic.severity == Severity::Error {
            self.error.get_or_insert(diagnostic);
        } else {
            self.report.add(diagnostic);
        }
    }
}

/// The import that the program's end tells.
pub(super) fn imported(name: &str, end: End, request: &ImportRequest) -> Result<Imported, Diagnostic> {
    let mut said = Said::new(&end.messages);
    if end.status.success() || said.error.is_some() {
        return decoded(name, said, end.output, request);
    }
    let last = said.other.split_off(said.other.len().saturating_sub(LAST_LINES)).join("\n    ");
    let error = Diagnostic::error(format!("{name} failed with {}", end.status)).in_file(&request.path);
    Err(if last.is_empty() { error } else { error.hint(format!("it said\n    {last}")) })
}

/// What the plug-in `name` printed for the file of `request`, on standard output and standard error, as an import.
///
/// # Errors
/// The one that it tells, or its output is no scene.
pub fn answer(
    name: &str,
    output: Vec<u8>,
    messages: &[u8],
    request: &ImportRequest,
) -> Result<Imported, Diagnostic> {
    decoded(name, Said::new(messages), output, request)
}

fn decoded(
    name: &str,
    mut said: Said,
    output: Vec<u8>,
    request: &ImportRequest,
) -> Result<Imported, Diagnostic> {
    if let Some(error) = said.error {
        return Err(error.in_file(&request.path));
    }
    for line in said.other {
        said.report.add(Diagnostic::note(format!("{name} said: {line}")));
    }
    let decoded = if gltf::is_container(&output) {
        gltf::decode(output, request)
    } else {
        ajar::decode(&output, request)
    };
    let mut imported = decoded.map_err(|error| {
        let message = format!("{name} handed over no usable scene: {}", error.message);
        Diagnostic { message, ..error }.in_file(&request.path)
    })?;
    imported.diagnostics.splice(0..0, said.report.finish(&request.path));
    imported.files.splice(0..0, [vec![request.path.clone()], said.files].concat());
    let mut met = std::collections::HashSet::new();
    imported.files.retain(|file| met.insert(file.clone()));
    Ok(imported)
}
