//! Images: found and recognized, but left encoded.

use ajar_scene::{Diagnostic, Id, Image, ImageSource, Scene, Severity};

use super::{Asset, Context, at, uri};
use crate::files;

/// Bytes that tell the format.
const HEAD: u64 = 12;

/// The images asked for so far, by their index in the file; `None` for those that cannot be had.
#[derive(Default)]
pub(super) struct Images(std::collections::HashMap<usize, Option<Id<Image>>>);

impl Images {
    /// The image at `index`, to which `element` refers; `None`, with one warning, if it cannot be had.
    ///
    /// # Errors
    /// The index points beyond the list.
    pub fn get(
        &mut self,
        asset: &Asset,
        context: &mut Context,
        scene: &mut Scene,
        index: usize,
        element: &str,
    ) -> Result<Option<Id<Image>>, Diagnostic> {
        if let Some(known) = self.0.get(&index) {
            return Ok(*known);
        }
        let image = at(&asset.root.images, index, "images", element)?;
        let own = format!("images[{index}]");
        let found = match source(asset, context, image, &own) {
            Ok(source) => {
                let name = image.name.clone().or_else(|| named_after(&source)).unwrap_or(own);
                Some(scene.images.push(Image { name, source }))
            }
            Err(error) => {
                let message = format!("textures of this image are dropped: {}", error.message);
                context.report.add(Diagnostic { severity: Severity::Warning, message, ..error }.element(own));
                None
            }
        };
        self.0.insert(index, found);
        Ok(found)
    }
}

fn named_after(source: &ImageSource) -> Option<String> {
    match source {
        ImageSource::File(path) => path.file_name().map(|name| name.to_string_lossy().into_owned()),
        ImageSource::Embedded(_) => None,
    }
}

/// An image in its file or in a buffer.
///
/// # Errors
/// It cannot be had, is of no known format, or memory runs out.
pub(super) fn source(
    asset: &Asset,
    context: &mut Context,
    image: &gltf::json::Image,
    element: &str,
) -> Result<ImageSource, Diagnostic> {
    let embedded = match (&image.uri, image.buffer_view) {
        (Some(uri), _) => match uri::data(uri, context, element)? {
            Some(bytes) => bytes,
            None => {
                let path = uri::file(uri, context, element)?;
                recognize(&files::head(&path, HEAD)?)?;
                return Ok(ImageSource::File(path));
            }
        },
        (None, Some(view)) => {
            let view = asset.buffers.view(&asset.root, view.value(), element)?;
            context.charge(view.bytes.len() as u64, element)?;
            view.bytes.to_vec()
        }
        (None, None) => return Err(Diagnostic::error("it has neither URI nor buffer view")),
    };
    recognize(&embedded)?;
    Ok(ImageSource::Embedded(embedded.into()))
}

/// Refuses what no decoder of ours reads. The bytes decide, not the media type, which is often wrong.
fn recognize(bytes: &[u8]) -> Result<(), Diagnostic> {
    const KNOWN: [&[u8]; 7] = [
        b"\x89PNG\r\n\x1a\n",
        b"\xff\xd8\xff",
        b"#?",
        b"\x76\x2f\x31\x01",
        b"II*\0",
        b"MM\0*",
        b"\xabKTX 20\xbb\r\n\x1a\n",
    ];
    let webp = bytes.starts_with(b"RIFF") && bytes.get(8..12) == Some(b"WEBP");
    if webp || KNOWN.iter().any(|magic| bytes.starts_with(magic)) {
        Ok(())
    } else if bytes.starts_with(b"\xabKTX 11") || bytes.starts_with(b"sB") {
        Err(Diagnostic::error("KTX 1 and plain Basis images are not supported")
            .hint("convert it to KTX2, PNG or WebP"))
    } else {
        Err(Diagnostic::error("it is of no known image format"))
    }
}
