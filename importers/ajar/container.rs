//! The container: the layout of GLB with a magic number of its own.

use ajar_scene::Diagnostic;

pub(super) const MAGIC: &[u8] = b"AJAR";
const VERSION: u32 = 1;
const JSON: &[u8] = b"JSON";
const BIN: &[u8] = b"BIN\0";
const HEADER: usize = 12;
const CHUNK_HEADER: usize = 8;

fn broken(why: impl std::fmt::Display) -> Diagnostic {
    Diagnostic::error(format!("broken Ajar container: {why}"))
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    let word = bytes.get(at..at.checked_add(4)?)?;
    Some(u32::from_le_bytes(word.try_into().ok()?))
}

/// JSON and binary chunk. Text that begins with `{` is JSON alone.
pub(super) fn split(bytes: &[u8]) -> Result<(&[u8], &[u8]), Diagnostic> {
    if bytes.is_empty() {
        return Err(Diagnostic::error("the scene is empty"));
    }
    if !bytes.starts_with(MAGIC) {
        let text = bytes.iter().find(|byte| !byte.is_ascii_whitespace()) == Some(&b'{');
        return if text {
            Ok((bytes, &[]))
        } else {
            Err(Diagnostic::error("is no Ajar scene: it begins neither with AJAR nor with {"))
        };
    }
    let (Some(version), Some(length)) = (word(bytes, 4), word(bytes, 8)) else {
        return Err(broken("the header is incomplete"));
    };
    if version != VERSION {
        return Err(broken(format_args!("version {version}, only {VERSION} is known")));
    }
    if length as usize != bytes.len() {
        return Err(broken(format_args!("{length} bytes announced, {} there", bytes.len())));
    }
    let (json, end) = chunk(bytes, HEADER, JSON)?;
    let (binary, end) = if end == bytes.len() { (&bytes[..0], end) } else { chunk(bytes, end, BIN)? };
    if end != bytes.len() {
        return Err(broken("something follows the binary chunk"));
    }
    Ok((json, binary))
}

/// The chunk of this kind at `at`, and where it ends.
fn chunk<'a>(bytes: &'a [u8], at: usize, kind: &[u8]) -> Result<(&'a [u8], usize), Diagnostic> {
    let incomplete = || broken("a chunk is incomplete");
    let size = word(bytes, at).ok_or_else(incomplete)? as usize;
    let start = at + CHUNK_HEADER;
    if bytes.get(at + 4..start) != Some(kind) {
        return Err(broken(format_args!("the chunk at byte {at} is not {}", kind.escape_ascii())));
    }
    let end = start.checked_add(size).ok_or_else(incomplete)?;
    Ok((bytes.get(start..end).ok_or_else(incomplete)?, end))
}

/// Puts a container together; `None` if it is too large for its 32-bit lengths.
pub(super) fn join(mut json: Vec<u8>, mut binary: Vec<u8>) -> Option<Vec<u8>> {
    json.resize(json.len().next_multiple_of(4), b' ');
    binary.resize(binary.len().next_multiple_of(4), 0);
    let length = HEADER + 2 * CHUNK_HEADER + json.len() + binary.len();
    let mut bytes = Vec::with_capacity(length);
    bytes.extend(MAGIC);
    bytes.extend(VERSION.to_le_bytes());
    bytes.extend(u32::try_from(length).ok()?.to_le_bytes());
    for (kind, chunk) in [(JSON, &json), (BIN, &binary)] {
        bytes.extend((chunk.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    Some(bytes)
}
