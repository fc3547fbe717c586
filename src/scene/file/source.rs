//! Who says something: a scene file, a file that it extends, or the command line.

use std::{
    cell::RefCell,
    ops::Range,
    path::{Path, PathBuf},
};

use serde::Serialize;
use toml::{Spanned, de::DeTable};

use super::report::{Complaint, Report};
use crate::{Cause, Diagnostic, ImportRequest};

/// What the command line is called.
const COMMAND_LINE: &str = "--set";

/// A value and who set it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Setting {
    /// Path of the key, `render.max_depth`.
    pub key: String,
    /// The value as it is written.
    pub value: String,
    /// Name of the file that says it, `--set` for the command line.
    pub by: String,
    /// Those that say it too and are overruled.
    pub over: Vec<String>,
    /// Where it says it: file, line and column; none for the command line.
    #[serde(skip)]
    pub place: Option<(PathBuf, (usize, usize))>,
}

impl Setting {
    /// A complaint about a key or table, which is its element: where a file says it, the file has to change.
    pub fn blame(settings: &[Self], complaint: Diagnostic) -> Diagnostic {
        let said = complaint.element.as_deref().and_then(|element| {
            let is_meant = |key: &str| {
                key.strip_prefix(element).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
            };
            settings.iter().find(|setting| is_meant(&setting.key))
        });
        match said.and_then(|setting| setting.place.clone()) {
            Some((file, (line, column))) => {
                let cause = if complaint.cause == Cause::Usage { Cause::Asset } else { complaint.cause };
                complaint.because(cause).in_file(file).at(line, column)
            }
            None => complaint,
        }
    }
}

/// One of those who say something.
pub(super) struct Source<'a> {
    pub report: Report<'a>,
    /// Finds the files that it names.
    pub request: ImportRequest,
    pub document: Spanned<DeTable<'a>>,
    text: &'a str,
    is_command_line: bool,
}

impl<'a> Source<'a> {
    /// A file of this text, parsed.
    pub fn file(path: &'a Path, text: &'a str, document: Spanned<DeTable<'a>>) -> Self {
        let request = ImportRequest::new(path);
        Self { report: Report::new(path, text), request, document, text, is_command_line: false }
    }

    /// The command line; files that it names are found like those of the file at `path`.
    pub fn command_line(path: &'a Path, text: &'a str, document: Spanned<DeTable<'a>>) -> Self {
        Self { is_command_line: true, ..Self::file(path, text, document) }
    }

    /// What it is called.
    pub fn name(&self) -> String {
        if self.is_command_line {
            return COMMAND_LINE.to_owned();
        }
        self.request.path.file_name().unwrap_or_default().to_string_lossy().into_owned()
    }

    /// File, line and column of a value.
    pub fn place(&self, span: &Range<usize>) -> Option<(PathBuf, (usize, usize))> {
        (!self.is_command_line).then(|| (self.request.path.clone(), self.report.place(span)))
    }

    /// A value as it is written there.
    pub fn written(&self, span: Range<usize>) -> String {
        self.text.get(span).unwrap_or_default().to_owned()
    }

    /// Reports an error about an element at `span`.
    pub fn error(&self, span: &Range<usize>, element: String, complaint: Complaint) {
        if self.is_command_line {
            self.report.usage(&element, complaint);
        } else {
            self.report.error(span, element, complaint);
        }
    }

    /// Reports a warning about an element at `span`.
    pub fn warn(&self, span: &Range<usize>, element: String, message: &str) {
        let warning = Diagnostic::warning(message).element(element);
        if self.is_command_line {
            self.report.push_elsewhere(warning);
        } else {
            self.report.push(span, warning);
        }
    }

    pub fn is_command_line(&self) -> bool {
        self.is_command_line
    }
}

/// All values that were read.
pub(super) type Settings = RefCell<Vec<Setting>>;
