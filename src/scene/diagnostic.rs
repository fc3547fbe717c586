//! What went wrong, where, and what helps: `path:line:column: error: message`.

use std::{fmt, path::PathBuf};

use serde::{Deserialize, Serialize, Serializer};

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// Worth knowing.
    Note,
    /// Something was approximated or dropped; `--strict` turns it into an error.
    Warning,
    /// The file or scene cannot be used.
    Error,
}

/// What has to change before it works; programs tell it by the exit code.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Cause {
    /// The file or the scene.
    #[default]
    Asset,
    /// What the user asked for.
    Usage,
    /// A limit on memory or size.
    Resource,
    /// The machine: a file that cannot be written, a thread that cannot be started.
    System,
}

/// What became of the part of a file that a warning is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Loss {
    /// It is shown, but not as the file says.
    Approximated,
    /// It is not shown, or its effect is not.
    Dropped,
}

/// One message about a file or a scene.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Diagnostic {
    /// How bad it is.
    pub severity: Severity,
    /// What has to change.
    #[serde(default)]
    pub cause: Cause,
    /// What an import lost; none where the message is about something else.
    #[serde(default)]
    pub loss: Option<Loss>,
    /// The file it is about.
    #[serde(serialize_with = "lossy")]
    pub file: Option<PathBuf>,
    /// Line and column, both from 1.
    pub place: Option<(usize, usize)>,
    /// Path of the element in the file's own terms, `materials[3].normalTexture`.
    pub element: Option<String>,
    /// What is wrong, one sentence in lower case without full stop.
    pub message: String,
    /// What to do about it.
    pub hint: Option<String>,
}

impl Diagnostic {
    fn new(severity: Severity, message: impl Into<String>) -> Self {
        let (cause, message) = (Cause::default(), message.into());
        Self { severity, cause, loss: None, file: None, place: None, element: None, message, hint: None }
    }

    /// An error.
    pub fn error(message: impl Into<String>) -> Self {
        Self::new(Severity::Error, message)
    }

    /// A warning.
    pub fn warning(message: impl Into<String>) -> Self {
        Self::new(Severity::Warning, message)
    }

    /// A note.
    pub fn note(message: impl Into<String>) -> Self {
        Self::new(Severity::Note, message)
    }

    /// The same, of this cause.
    pub fn because(mut self, cause: Cause) -> Self {
        self.cause = cause;
        self
    }

    /// The same, about something that was approximated or dropped.
    pub fn losing(mut self, loss: Loss) -> Self {
        self.loss = Some(loss);
        self
    }

    /// The same, about `file`.
    pub fn in_file(mut self, file: impl Into<PathBuf>) -> Self {
        self.file = Some(file.into());
        self
    }

    /// The same, at line and column (both from 1).
    pub fn at(mut self, line: usize, column: usize) -> Self {
        self.place = Some((line, column));
        self
    }

    /// The same, about the element of this path.
    pub fn element(mut self, element: impl Into<String>) -> Self {
        self.element = Some(element.into());
        self
    }

    /// The same, with advice.
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }
}

/// JSON knows only Unicode, file systems know more.
fn lossy<S: Serializer>(file: &Option<PathBuf>, serializer: S) -> Result<S::Ok, S::Error> {
    file.as_ref().map(|file| file.to_string_lossy()).serialize(serializer)
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(file) = &self.file {
            write!(f, "{}:", file.display())?;
            if let Some((line, column)) = self.place {
                write!(f, "{line}:{column}:")?;
            }
            f.write_str(" ")?;
        }
        let severity = match self.severity {
            Severity::Note => "note",
            Severity::Warning => "warning",
            Severity::Error => "error",
        };
        write!(f, "{severity}: ")?;
        if let Some(element) = &self.element {
            write!(f, "{element}: ")?;
        }
        f.write_str(&self.message)?;
        if let Some(hint) = &self.hint {
            write!(f, "\n  hint: {hint}")?;
        }
        Ok(())
    }
}

impl std::error::Error for Diagnostic {}
