//! Exit codes.

use std::process::ExitCode;

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

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit as u8)
    }
}
