//! A scene file and the files that it extends.

use std::{
    fs,
    path::{Path, PathBuf},
};

use toml::{Spanned, de::DeTable};

use super::{report::Report, source::Source};
use crate::{Diagnostic, ImportRequest};

/// Most files that may extend each other.
const MOST: usize = 16;

/// Largest file.
const MOST_BYTES: u64 = 16 << 20;

/// The key that names the file below.
pub(super) const EXTENDS: &str = "extends";

/// A file with its text.
#[derive(Clone, Debug)]
pub(super) struct Text {
    pub path: PathBuf,
    pub text: String,
}

/// Reads the file of `request` and all that it extends, the first of which counts.
///
/// # Errors
/// A file that cannot be read or parsed, or files that extend each other in a circle.
pub(super) fn read(request: &ImportRequest) -> Result<Vec<Text>, Vec<Diagnostic>> {
    let mut texts: Vec<Text> = Vec::new();
    let mut next = Some(request.path.clone());
    while let Some(path) = next {
        request.looked.note(&path);
        let text = text(&path)?;
        next = below(&ImportRequest { path: path.clone(), ..request.clone() }, &text, &texts)?;
        texts.push(Text { path, text });
    }
    Ok(texts)
}

/// The files as sources. All were parsed before.
pub(super) fn sources(texts: &[Text]) -> Vec<Source<'_>> {
    texts
        .iter()
        .filter_map(|Text { path, text }| Some(Source::file(path, text, DeTable::parse(text).ok()?)))
        .collect()
}

fn text(path: &Path) -> Result<String, Vec<Diagnostic>> {
    let refuse = |message: String| vec![Diagnostic::error(message).in_file(path)];
    let unreadable = |e: std::io::Error| refuse(format!("cannot be read: {e}"));
    let info = path.metadata().map_err(unreadable)?;
    // Opening a pipe would wait for who writes to it.
    if !info.is_file() {
        return Err(refuse("is not a regular file".into()));
    }
    if info.len() > MOST_BYTES {
        return Err(refuse(format!("{} bytes are more than the {MOST_BYTES} of any scene file", info.len())));
    }
    let bytes = fs::read(path).map_err(unreadable)?;
    String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let before = String::from_utf8_lossy(error.as_bytes().get(..valid).unwrap_or_default()).into_owned();
        let report = Report::new(path, &before);
        report.push(&(before.len()..before.len()), Diagnostic::error("is not text in UTF-8"));
        report.finish()
    })
}

/// The document in a text.
///
/// # Errors
/// All that the parser does not understand.
pub(super) fn parse<'a>(path: &Path, text: &'a str) -> Result<Spanned<DeTable<'a>>, Vec<Diagnostic>> {
    let (document, errors) = DeTable::parse_recoverable(text);
    if errors.is_empty() {
        return Ok(document);
    }
    let report = Report::new(path, text);
    for error in errors {
        report.push(&error.span().unwrap_or(0..0), Diagnostic::error(error.message()));
    }
    // What follows on the same line is mostly the parser finding its feet again.
    let mut found = report.finish();
    found.dedup_by_key(|diagnostic| diagnostic.place.map(|(line, _)| line));
    Err(found)
}

/// The file that this one extends.
fn below(request: &ImportRequest, text: &str, above: &[Text]) -> Result<Option<PathBuf>, Vec<Diagnostic>> {
    let path = &*request.path;
    let document = parse(path, text)?;
    let Some(value) = document.get_ref().get(EXTENDS) else { return Ok(None) };
    let refuse = |error: Diagnostic| {
        let report = Report::new(path, text);
        report.push(&value.span(), error.element(EXTENDS));
        Err(report.finish())
    };
    let Some(name) = value.get_ref().as_str() else {
        return refuse(Diagnostic::error(format!(
            "expected the name of a file, found {}",
            value.get_ref().type_str()
        )));
    };
    let file = match request.resolve(name) {
        Ok(file) => file,
        Err(error) => return refuse(error),
    };
    let same = |other: &Path| other.canonicalize().is_ok_and(|other| other == file);
    if same(path) || above.iter().any(|text| same(&text.path)) {
        return refuse(Diagnostic::error("extends itself"));
    }
    if above.len() + 2 > MOST {
        return refuse(Diagnostic::error(format!("more than {MOST} files extend each other")));
    }
    Ok(Some(file))
}
