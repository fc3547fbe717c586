//! EXT_meshopt_compression: buffer views that hold vertices or indices in the encoding of meshoptimizer. Source: the
//! bitstream in appendix A of the extension, and its filters in appendix B.

mod attributes;
mod filter;
mod indices;

use ajar_scene::Diagnostic;
use gltf::json::buffer;
use serde::Deserialize;

use super::{Context, container::Bytes, extensions};

/// The extension's name.
const NAME: &str = "EXT_meshopt_compression";

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Compressed {
    buffer: usize,
    #[serde(default)]
    byte_offset: usize,
    byte_length: usize,
    byte_stride: usize,
    count: usize,
    mode: Mode,
    #[serde(default)]
    filter: filter::Filter,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "UPPERCASE")]
enum Mode {
    Attributes,
    Triangles,
    Indices,
}

/// The bytes of a buffer view before they were compressed; `None` where they are not.
///
/// # Errors
/// The stream is broken, or memory runs out.
pub(super) fn decode(
    view: &buffer::View,
    loaded: &[Result<Bytes, Diagnostic>],
    context: &mut Context,
    element: &str,
) -> Result<Option<Vec<u8>>, Diagnostic> {
    let others = view.extensions.as_ref().map(|extensions| &extensions.others);
    let Some(found) = extensions::read::<Compressed>(others, NAME, element, &mut context.report) else {
        return Ok(None);
    };
    let element = format!("{element}.extensions.{NAME}");
    let error = |why: &str| Diagnostic::error(why).element(&element);
    let bytes = super::at(loaded, found.buffer, "buffers", &element)?.as_ref().map_err(Clone::clone)?;
    let end = found.byte_offset.checked_add(found.byte_length);
    let bytes = end.and_then(|end| bytes.get(found.byte_offset..end));
    let bytes = bytes.ok_or_else(|| error("reaches beyond its buffer"))?;
    let size = found.count.checked_mul(found.byte_stride).ok_or_else(|| error("an impossible size"))?;
    context.charge(size as u64, &element)?;
    let (count, stride) = (found.count, found.byte_stride);
    let decoded = match found.mode {
        Mode::Attributes => attributes::decode(bytes, count, stride).and_then(|mut decoded| {
            found.filter.apply(&mut decoded, stride)?;
            Some(decoded)
        }),
        Mode::Triangles => indices::triangles(bytes, count).and_then(|found| indices::bytes(&found, stride)),
        Mode::Indices => indices::sequence(bytes, count).and_then(|found| indices::bytes(&found, stride)),
    };
    decoded.map(Some).ok_or_else(|| error("the compressed data are broken"))
}
