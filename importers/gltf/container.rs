//! The GLB container (specification, section 4) and how a file is recognized.

use std::ops::Deref;

use ajar_scene::Diagnostic;

use crate::report::Report;

const MAGIC: &[u8] = b"glTF";
const JSON: &[u8] = b"JSON";
const BIN: &[u8] = b"BIN\0";
const HEADER: usize = 12;
const CHUNK_HEADER: usize = 8;

/// Top-level keys of a document, for files with a foreign extension.
const KEYS: [&str; 12] = [
    "\"accessors\"",
    "\"asset\"",
    "\"bufferViews\"",
    "\"buffers\"",
    "\"cameras\"",
    "\"extensionsRequired\"",
    "\"extensionsUsed\"",
    "\"images\"",
    "\"materials\"",
    "\"meshes\"",
    "\"nodes\"",
    "\"scenes\"",
];

/// Whether the first bytes of a file look like text or binary glTF.
pub(super) fn looks_like_gltf(head: &[u8]) -> bool {
    let text = String::from_utf8_lossy(head);
    let json = text.trim_start_matches('\u{feff}').trim_start().starts_with('{');
    is_binary(head) || json && KEYS.iter().any(|key| text.contains(key))
}

/// Whether bytes are binary glTF.
pub(super) fn is_binary(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// Bytes that are the end of others, so that what comes before need not be cut off.
pub(super) struct Bytes {
    all: Vec<u8>,
    start: usize,
}

impl Bytes {
    /// Forgets what follows the first `length` bytes.
    pub fn truncate(&mut self, length: usize) {
        self.all.truncate(self.start.saturating_add(length));
    }
}

impl From<Vec<u8>> for Bytes {
    fn from(all: Vec<u8>) -> Self {
        Self { all, start: 0 }
    }
}

impl Deref for Bytes {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        self.all.get(self.start..).unwrap_or_default()
    }
}

/// A file taken apart.
pub(super) struct Container {
    /// The JSON text.
    pub json: Vec<u8>,
    /// The binary chunk, with up to three bytes of padding.
    pub binary: Option<Bytes>,
    /// Whether the file is a GLB, where a line in the JSON is no line of the file.
    pub is_binary: bool,
}

/// Splits a GLB; anything that does not start with its magic number is taken as JSON.
pub(super) fn split(mut file: Vec<u8>, report: &mut Report) -> Result<Container, Diagnostic> {
    if file.is_empty() {
        return Err(Diagnostic::error("the file is empty"));
    }
    if !is_binary(&file) {
        return Ok(Container { json: file, binary: None, is_binary: false });
    }
    let broken = |why: String| Diagnostic::error(format!("broken GLB container: {why}"));
    let word = |at: usize| {
        let bytes = file.get(at..at.checked_add(4)?)?;
        Some(u32::from_le_bytes(bytes.try_into().ok()?))
    };
    let version = word(4).ok_or_else(|| broken("the header is incomplete".into()))?;
    if version != 2 {
        return Err(broken(format!("version {version}, only 2 is known"))
            .hint("convert glTF 1.0 files to 2.0 with gltf-pipeline"));
    }
    let length = word(8).ok_or_else(|| broken("the header is incomplete".into()))? as usize;
    if length > file.len() {
        return Err(broken(format!("{length} bytes announced, {} there", file.len())));
    }
    if length < file.len() {
        report.add(Diagnostic::warning(format!(
            "{} bytes after the end of the GLB are ignored",
            file.len() - length
        )));
    }
    let chunk = |at: usize| -> Result<(usize, usize, &[u8]), Diagnostic> {
        let (Some(size), Some(kind)) = (word(at), file.get(at + 4..at + CHUNK_HEADER)) else {
            return Err(broken("a chunk's header is incomplete".into()));
        };
        let start = at + CHUNK_HEADER;
        match start.checked_add(size as usize) {
            Some(end) if end <= length => Ok((start, end, kind)),
            _ => Err(broken(format!("a chunk of {size} bytes reaches beyond the end"))),
        }
    };
    let (start, end, kind) = chunk(HEADER)?;
    if kind != JSON {
        return Err(broken("the first chunk is not JSON".into()));
    }
    let json = file.get(start..end).unwrap_or_default().to_vec();
    let binary = match length.saturating_sub(end) {
        0 => None,
        rest if rest < CHUNK_HEADER => return Err(broken("a chunk's header is incomplete".into())),
        _ => {
            let (start, end, kind) = chunk(end)?;
            (kind == BIN).then_some((start, end))
        }
    };
    let binary = binary.map(|(start, end)| {
        file.truncate(end);
        Bytes { all: file, start }
    });
    Ok(Container { json, binary, is_binary: true })
}
