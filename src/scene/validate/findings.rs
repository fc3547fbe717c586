//! Collects complaints and counts those that repeat.

use crate::{Diagnostic, Severity};

/// How often one complaint is made in full.
const SHOWN: usize = 3;

/// Complaints, in the order in which their rules were first broken.
#[derive(Default)]
pub(super) struct Findings(Vec<Rule>);

struct Rule {
    name: &'static str,
    severity: Severity,
    shown: Vec<Diagnostic>,
    more: usize,
}

impl Findings {
    /// Adds a diagnostic about `element`; `rule` names what all complaints of its kind have in common.
    pub fn add(&mut self, rule: &'static str, element: impl FnOnce() -> String, diagnostic: Diagnostic) {
        let severity = diagnostic.severity;
        let found = self.0.iter().position(|it| it.name == rule && it.severity == severity);
        let index = found.unwrap_or(self.0.len());
        if found.is_none() {
            self.0.push(Rule { name: rule, severity, shown: Vec::new(), more: 0 });
        }
        if let Some(rule) = self.0.get_mut(index) {
            if rule.shown.len() < SHOWN {
                rule.shown.push(diagnostic.element(element()));
            } else {
                rule.more += 1;
            }
        }
    }

    /// All complaints; where some were only counted, a last one says how many.
    pub fn finish(self) -> Vec<Diagnostic> {
        let mut all = Vec::new();
        for Rule { name, severity, shown, more } in self.0 {
            all.extend(shown);
            if more > 0 {
                all.push(Diagnostic { severity, ..Diagnostic::note(format!("and {more} more: {name}")) });
            }
        }
        all
    }
}
