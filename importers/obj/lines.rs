//! Text into statements: encoding, line ends, continuation with `\`, comments.

use std::{borrow::Cow, path::Path};

use ajar_scene::Diagnostic;

use crate::files;

/// One statement, with the line it starts on.
pub(super) struct Line<'a> {
    /// From 1.
    pub number: usize,
    /// Without white space at its ends; not empty, not a comment.
    pub text: Cow<'a, str>,
}

impl Line<'_> {
    /// The first word.
    pub fn keyword(&self) -> &str {
        self.text.split_ascii_whitespace().next().unwrap_or_default()
    }

    /// What follows the keyword, as written: names may hold spaces and `#`.
    pub fn rest(&self) -> &str {
        self.text.get(self.keyword().len()..).unwrap_or_default().trim()
    }

    /// The words after the keyword up to a comment, for statements made of numbers.
    pub fn words(&self) -> impl Iterator<Item = &str> {
        self.rest().split('#').next().unwrap_or_default().split_ascii_whitespace()
    }

    /// An error at `word`, which is a part of this line.
    pub fn error(&self, word: &str, message: impl Into<String>) -> Diagnostic {
        let offset = (word.as_ptr() as usize).saturating_sub(self.text.as_ptr() as usize);
        let column =
            if matches!(self.text, Cow::Borrowed(_)) && offset < self.text.len() { offset + 1 } else { 1 };
        Diagnostic::error(message).at(self.number, column)
    }

    /// Reads `word` as a finite number.
    pub fn number(&self, word: &str) -> Result<f32, Diagnostic> {
        match word.parse::<f32>() {
            Ok(number) if number.is_finite() => Ok(number),
            Ok(_) => Err(self.error(word, format!("{} is not finite", quote(word)))),
            Err(_) => Err(self.error(word, format!("{} is not a number", quote(word)))),
        }
    }
}

/// The statements of a text.
pub(super) struct Lines<'a> {
    rest: &'a str,
    number: usize,
}

impl<'a> Lines<'a> {
    pub fn new(text: &'a str) -> Self {
        Self { rest: text, number: 0 }
    }

    /// The next line without its end, which is `\n`, `\r\n` or `\r`.
    fn raw(&mut self) -> Option<&'a str> {
        if self.rest.is_empty() {
            return None;
        }
        self.number += 1;
        let (line, rest) = match self.rest.split_once(['\n', '\r']) {
            Some((line, rest)) if self.rest[line.len()..].starts_with('\r') => {
                (line, rest.strip_prefix('\n').unwrap_or(rest))
            }
            Some(split) => split,
            None => (self.rest, ""),
        };
        self.rest = rest;
        Some(line.trim())
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        loop {
            let first = self.raw()?;
            let number = self.number;
            // A backslash at the end of a comment is more often a Windows path than a continuation.
            if first.is_empty() || first.starts_with('#') {
                continue;
            }
            let Some(start) = first.strip_suffix('\\') else {
                return Some(Line { number, text: Cow::Borrowed(first) });
            };
            let mut text = start.to_owned();
            while let Some(next) = self.raw() {
                text.push(' ');
                text.push_str(next.strip_suffix('\\').unwrap_or(next));
                if !next.ends_with('\\') {
                    break;
                }
            }
            let text = text.trim();
            if !text.is_empty() {
                return Some(Line { number, text: Cow::Owned(text.to_owned()) });
            }
        }
    }
}

/// Reads a text file of at most `limit` bytes: UTF-8, UTF-16 that begins with its mark, or else Windows-1252's common part
/// Latin-1, in which every byte is a character. The flag tells of the last.
pub(super) fn read(path: &Path, limit: u64) -> Result<(String, bool), Diagnostic> {
    let fail = |message: String| Diagnostic::error(message).in_file(path);
    let mut bytes = files::read(path, limit)?;
    if let Some(order) = [u16::from_be_bytes as fn([u8; 2]) -> u16, u16::from_le_bytes]
        .into_iter()
        .find(|order| bytes.get(..2).is_some_and(|mark| order([mark[0], mark[1]]) == 0xFEFF))
    {
        let units = bytes[2..].as_chunks().0.iter().map(|&pair| order(pair));
        let text: Result<String, _> = char::decode_utf16(units).collect();
        return match text {
            Ok(text) if !text.contains('\0') => Ok((text, false)),
            _ => Err(fail("is broken UTF-16 text".to_owned()).at(1, 1).hint("save it as UTF-8")),
        };
    }
    if let Some(at) = bytes.iter().position(|&b| b == 0) {
        let line = 1 + bytes[..at].iter().filter(|&&b| b == b'\n').count();
        return Err(fail("holds a zero byte: it is binary or UTF-16, not text".to_owned()).at(line, 1));
    }
    if bytes.starts_with(b"\xEF\xBB\xBF") {
        bytes.drain(..3);
    }
    Ok(match String::from_utf8(bytes) {
        Ok(text) => (text, false),
        Err(e) => (e.as_bytes().iter().map(|&byte| char::from(byte)).collect(), true),
    })
}

/// Text from a file, shortened and made printable for a message.
pub(super) fn quote(text: &str) -> String {
    let short: String = text.chars().take(60).collect();
    let dots = if short.len() < text.len() { "…" } else { "" };
    format!("\"{}{dots}\"", short.escape_debug())
}
