//! Collects what is wrong with a scene file, each with line and column.

use std::{
    cell::{Cell, RefCell},
    ops::Range,
    path::Path,
};

use crate::{Cause, Diagnostic};

/// What is wrong with one value, before its place is known.
#[derive(Debug)]
pub(super) struct Complaint {
    pub message: String,
    pub hint: Option<String>,
}

impl Complaint {
    pub fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), hint: None }
    }

    pub fn hint(mut self, hint: Option<String>) -> Self {
        self.hint = hint;
        self
    }
}

impl From<Diagnostic> for Complaint {
    fn from(Diagnostic { message, hint, .. }: Diagnostic) -> Self {
        Self { message, hint }
    }
}

/// Nobody reads more than this many messages about one file.
const MOST: usize = 100;

/// The diagnostics of one file. Shared by all readers of its tables, hence the cells.
pub(super) struct Report<'a> {
    path: &'a Path,
    text: &'a str,
    found: RefCell<Vec<Diagnostic>>,
    untold: Cell<usize>,
}

impl<'a> Report<'a> {
    pub fn new(path: &'a Path, text: &'a str) -> Self {
        Self { path, text, found: RefCell::default(), untold: Cell::new(0) }
    }

    /// Adds a diagnostic about the text that starts at byte `span.start`.
    pub fn push(&self, span: &Range<usize>, diagnostic: Diagnostic) {
        if self.is_full() {
            self.untold.set(self.untold.get() + 1);
            return;
        }
        let (line, column) = self.place(span);
        self.found.borrow_mut().push(diagnostic.in_file(self.path).at(line, column));
    }

    /// Line and column, both from 1, where a span begins.
    pub fn place(&self, span: &Range<usize>) -> (usize, usize) {
        let before = self.text.get(..span.start).unwrap_or(self.text);
        let line = before.matches('\n').count() + 1;
        (line, before.chars().rev().take_while(|&c| c != '\n').count() + 1)
    }

    /// Adds a diagnostic about an element that stands on the command line.
    pub fn push_elsewhere(&self, diagnostic: Diagnostic) {
        let element = format!("--set {}", diagnostic.element.as_deref().unwrap_or_default());
        self.found.borrow_mut().push(diagnostic.element(element).because(Cause::Usage));
    }

    /// Adds an error about an element that stands on the command line.
    pub fn usage(&self, element: &str, complaint: Complaint) {
        let diagnostic = Diagnostic::error(complaint.message).element(element);
        self.push_elsewhere(Diagnostic { hint: complaint.hint, ..diagnostic });
    }

    /// Adds an error about an element.
    pub fn error(&self, span: &Range<usize>, element: impl Into<String>, complaint: Complaint) {
        let diagnostic = Diagnostic::error(complaint.message).element(element);
        self.push(span, Diagnostic { hint: complaint.hint, ..diagnostic });
    }

    /// Whether further messages are only counted.
    pub fn is_full(&self) -> bool {
        self.found.borrow().len() >= MOST
    }

    /// All that was found, in the order of the file.
    pub fn finish(self) -> Vec<Diagnostic> {
        let mut found = self.found.into_inner();
        found.sort_by_key(|diagnostic| diagnostic.place);
        if self.untold.get() > 0 {
            let message = format!("there are {} more messages about this file", self.untold.get());
            found.push(Diagnostic::error(message).in_file(self.path));
        }
        found
    }
}

/// "did you mean" for a misspelt name, otherwise all there are.
pub(super) fn advice<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<String> {
    let known: Vec<_> = known.into_iter().collect();
    let near = known
        .iter()
        .map(|candidate| (strsim::osa_distance(name, candidate), candidate))
        .filter(|(distance, candidate)| *distance <= 1.max(name.len().min(candidate.len()) / 3))
        .min_by_key(|(distance, _)| *distance);
    match near {
        Some((_, candidate)) => Some(format!("did you mean \"{}\"?", candidate.escape_debug())),
        None if known.is_empty() => None,
        None => Some(format!("one of {}", known.join(", "))),
    }
}
