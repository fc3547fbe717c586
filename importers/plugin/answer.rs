//! What a plug-in answers: a scene on standard output, and lines about it.

use std::path::PathBuf;

use ajar_scene::{Cause, Diagnostic, ImportRequest, Imported, Loss, Severity};
use serde::Deserialize;

use super::process::End;
use crate::{ajar, gltf, report::Report};

/// Characters of a text that are shown.
const SHOWN: usize = 1000;

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
struct Said<'a> {
    report: Report,
    files: Vec<PathBuf>,
    error: Option<Diagnostic>,
    /// Lines without form.
    other: Vec<&'a str>,
}

impl<'a> Said<'a> {
    fn new(messages: &'a str) -> Self {
        let mut said = Self { report: Report::default(), files: Vec::new(), error: None, other: Vec::new() };
        for line in messages.lines().filter(|line| !line.trim().is_empty()) {
            if !line.starts_with('{') {
                said.other.push(line);
                continue;
            }
            match serde_json::from_str(line) {
                Ok(Line::File { file }) => said.files.push(file),
                Ok(Line::Progress { .. }) => {}
                Ok(Line::Message { level, message, place, hint, loss, cause }) => said.add(Diagnostic {
                    severity: level,
                    cause,
                    loss,
                    element: place.map(|place| printable(&place)),
                    hint: hint.map(|hint| printable(&hint)),
                    ..Diagnostic::error(printable(&message))
                }),
                Err(_) => said.other.push(line),
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
    let messages = String::from_utf8_lossy(&end.messages);
    let mut said = Said::new(&messages);
    said.files.iter().for_each(|file| request.looked.note(file));
    if end.status.success() || said.error.is_some() {
        return decoded(name, said, end.output, request);
    }
    let last = said.other.split_off(said.other.len().saturating_sub(LAST_LINES));
    let last = last.into_iter().map(printable).collect::<Vec<_>>().join("\n    ");
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
    decoded(name, Said::new(&String::from_utf8_lossy(messages)), output, request)
}

fn decoded(
    name: &str,
    mut said: Said<'_>,
    output: Vec<u8>,
    request: &ImportRequest,
) -> Result<Imported, Diagnostic> {
    if let Some(error) = said.error {
        return Err(error.in_file(&request.path));
    }
    for line in said.other {
        said.report.add(Diagnostic::note(format!("{name} said: {}", printable(line))));
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

/// A text of the plug-in, fit for a terminal.
fn printable(text: &str) -> String {
    let shown = text.chars().take(SHOWN).map(|c| if c.is_control() && c != '\n' { '\u{fffd}' } else { c });
    let dots = text.chars().nth(SHOWN).map(|_| '…');
    shown.chain(dots).collect()
}
