//! Exit codes.

use std::process::ExitCode;

use ajar_scene::{Cause, Diagnostic, Severity};

/// How the program ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// Done.
    Ok = 0,
    /// The render failed, or its result could not be written.
    Failed = 1,
    /// The command line makes no sense.
    Usage = 2,
    /// An asset or scene is invalid.
    Invalid = 3,
    /// A limit on memory or size was met.
    Resources = 4,
    /// Interrupted; the partial result is saved.
    Interrupted = 5,
}

impl Exit {
    /// How the program ends after these messages, of which those of `least` severity or worse are errors. Of several
    /// causes the one counts that has to change first: no memory helps a file that is broken.
    pub fn after(diagnostics: &[Diagnostic], least: Severity) -> Self {
        let met = |cause| diagnostics.iter().any(|d| d.severity >= least && d.cause == cause);
        let order = [
            (Cause::Usage, Self::Usage),
            (Cause::Asset, Self::Invalid),
            (Cause::Resource, Self::Resources),
            (Cause::System, Self::Failed),
        ];
        order.into_iter().find(|(cause, _)| met(*cause)).map_or(Self::Ok, |(_, exit)| exit)
    }
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit as u8)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cause_that_must_change_first_decides() {
        let of = |causes: &[Cause]| {
            let errors: Vec<_> = causes.iter().map(|&cause| Diagnostic::error("").because(cause)).collect();
            Exit::after(&errors, Severity::Error)
        };
        assert_eq!(of(&[]), Exit::Ok);
        assert_eq!(of(&[Cause::System]), Exit::Failed);
        assert_eq!(of(&[Cause::System, Cause::Resource]), Exit::Resources);
        assert_eq!(of(&[Cause::Resource, Cause::Asset]), Exit::Invalid);
        assert_eq!(of(&[Cause::Asset, Cause::Usage, Cause::System]), Exit::Usage);
    }

    #[test]
    fn only_what_is_severe_enough_counts() {
        let found = [Diagnostic::warning(""), Diagnostic::error("").because(Cause::Resource)];
        assert_eq!(Exit::after(&found, Severity::Error), Exit::Resources);
        assert_eq!(Exit::after(&found, Severity::Warning), Exit::Invalid);
        assert_eq!(Exit::after(&found[..1], Severity::Error), Exit::Ok);
    }
}
