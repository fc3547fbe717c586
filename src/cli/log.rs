//! What is said on standard error besides results: for people, or as one JSON object a line for programs.

use std::{
    cmp::Reverse,
    io::{IsTerminal, Write},
};

use ajar_scene::{Diagnostic, Severity};
use serde::Serialize;

/// How messages are written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum Format {
    /// For people.
    #[default]
    Text,
    /// One object a line.
    Json,
}

/// How much is said.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(super) struct Verbosity {
    /// Show notes too
    #[arg(short, long, conflicts_with = "quiet")]
    verbose: bool,
    /// Say nothing but errors
    #[arg(short, long)]
    pub quiet: bool,
}

impl Verbosity {
    /// The least severity of messages that are shown.
    pub fn least(self) -> Severity {
        match (self.quiet, self.verbose) {
            (true, _) => Severity::Error,
            (_, true) => Severity::Note,
            _ => Severity::Warning,
        }
    }
}

/// A line of JSON.
#[derive(Serialize)]
#[serde(tag = "type", rename_all = "lowercase")]
enum Event<'a, T: Serialize> {
    Message(&'a Diagnostic),
    Progress(T),
}

/// Messages shown at most: a broken file can cause one a line.
const MOST_MESSAGES: usize = 100;

impl Format {
    /// Writes messages, those of `least` severity or worse. Where there are too many, the worst are kept.
    pub fn messages(self, diagnostics: &[Diagnostic], least: Severity) {
        let mut shown: Vec<_> = diagnostics.iter().filter(|d| d.severity >= least).collect();
        if shown.len() > MOST_MESSAGES {
            shown.sort_by_key(|d| Reverse(d.severity));
        }
        let untold = shown.len().saturating_sub(MOST_MESSAGES);
        let more = (untold > 0).then(|| Diagnostic::note(format!("and {untold} more messages")));
        let lines = shown.into_iter().take(MOST_MESSAGES).chain(&more);
        write_line(&lines.map(|diagnostic| self.message(diagnostic)).collect::<String>());
    }

    fn message(self, diagnostic: &Diagnostic) -> String {
        match self {
            Self::Text => format!("{diagnostic}\n"),
            Self::Json => json(&Event::<()>::Message(diagnostic)),
        }
    }

    /// Writes how far a render is, in the words of `text` or as `numbers`.
    pub fn progress(self, text: &str, numbers: impl Serialize) {
        write_line(&match self {
            Self::Text => format!("{text}\n"),
            Self::Json => json(&Event::Progress(numbers)),
        });
    }

    /// Whether progress may redraw its line.
    pub fn interactive(self) -> bool {
        self == Self::Text && std::io::stderr().is_terminal()
    }
}

fn json(event: &Event<'_, impl Serialize>) -> String {
    // Cannot fail: numbers, strings, and nothing that is a key but strings.
    serde_json::to_string(event).map_or_else(|_| String::new(), |line| line + "\n")
}

fn write_line(text: &str) {
    // Nobody reads it if the pipe is closed.
    let _ = std::io::stderr().write_all(text.as_bytes());
}
