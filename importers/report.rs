//! What was approximated or dropped, each kind once with the number of further places.

use std::{collections::HashMap, path::Path};

use ajar_scene::{Diagnostic, Loss, Severity};

/// Distinct messages that one file may cause.
const MOST: usize = 100;

/// Collects diagnostics. Of those with the same message the first keeps its place, the others are counted.
#[derive(Default)]
pub(crate) struct Report {
    entries: Vec<(Diagnostic, usize)>,
    by_message: HashMap<String, usize>,
    beyond: usize,
}

impl Report {
    /// Adds a diagnostic; a warning is about something that was dropped unless it says something else.
    pub fn add(&mut self, mut diagnostic: Diagnostic) {
        if diagnostic.severity == Severity::Warning {
            diagnostic.loss.get_or_insert(Loss::Dropped);
        }
        if let Some((_, more)) =
            self.by_message.get(&diagnostic.message).and_then(|&at| self.entries.get_mut(at))
        {
            *more += 1;
        } else if self.entries.len() < MOST {
            self.by_message.insert(diagnostic.message.clone(), self.entries.len());
            self.entries.push((diagnostic, 0));
        } else {
            self.beyond += 1;
        }
    }

    /// Adds a warning about an element that is shown, but not as the file says.
    pub fn approximate(&mut self, element: impl Into<String>, message: impl Into<String>) {
        self.add(Diagnostic::warning(message).losing(Loss::Approximated).element(element));
    }

    /// Adds a warning about an element that was dropped.
    pub fn warn(&mut self, element: impl Into<String>, message: impl Into<String>) {
        self.add(Diagnostic::warning(message).element(element));
    }

    /// Adds a note about an element.
    pub fn note(&mut self, element: impl Into<String>, message: impl Into<String>) {
        self.add(Diagnostic::note(message).element(element));
    }

    /// All diagnostics, those without file being about `file`.
    pub fn finish(self, file: &Path) -> Vec<Diagnostic> {
        let mut all: Vec<_> = self
            .entries
            .into_iter()
            .map(|(mut diagnostic, more)| {
                if more > 0 {
                    let places = if more == 1 { "place" } else { "places" };
                    diagnostic.message.push_str(&format!(" (and at {more} more {places})"));
                }
                diagnostic
            })
            .collect();
        if self.beyond > 0 {
            let message = format!("{} more diagnostics are not shown", self.beyond);
            all.push(Diagnostic::warning(message).losing(Loss::Dropped));
        }
        for diagnostic in &mut all {
            diagnostic.file.get_or_insert_with(|| file.into());
        }
        all
    }
}
