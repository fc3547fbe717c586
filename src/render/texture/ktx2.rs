//! KTX2 images of Basis Universal (KHR_texture_basisu): the first level of the first image, decoded to RGBA.

use std::io::{BufRead, Read};

use basisu::{DecodeFlags, TargetFormat, Transcoder};
use half::f16;

use super::{Bitmap, Texels, decode::Header};

const MAGIC: &[u8] = b"\xabKTX 20\xbb\r\n\x1a\n";
/// Bytes of the header.
const HEADER: usize = 80;
/// Encoded images are smaller than this unless they mean harm: four channels of a byte and their mip levels at the largest
/// size.
const MAX_BYTES: u64 = 2 << 30;

/// Whether a file begins like a KTX2 image.
pub fn is_ktx2(head: &[u8]) -> bool {
    head.starts_with(MAGIC)
}

/// Reads the header alone.
///
/// # Errors
/// It is cut off.
pub fn header(mut input: impl BufRead) -> Result<Header, String> {
    let mut head = [0; HEADER];
    input.read_exact(&mut head).map_err(|e| e.to_string())?;
    let [width, height] = [20, 24].map(|at| {
        let bytes = head.get(at..at + 4).and_then(|bytes| bytes.try_into().ok());
        u32::from_le_bytes(bytes.unwrap_or_default()) as usize
    });
    // The encoded image and what its decoder needs stay below the pixels' size.
    Ok(Header { width, height, bytes: 8 * (width as u64) * (height as u64) })
}

/// Decodes an image.
///
/// # Errors
/// It is no Basis image, or its data are broken.
pub fn load(input: impl BufRead) -> Result<Bitmap, String> {
    let mut bytes = Vec::new();
    input.take(MAX_BYTES).read_to_end(&mut bytes).map_err(|e| e.to_string())?;
    let image = Transcoder::new(&bytes).map_err(|e| format!("is no KTX2 image of Basis Universal: {e:?}"))?;
    let (width, height) = image.base_dimensions();
    let (target, kind): (_, fn(Vec<u8>) -> Texels) = if image.supports(TargetFormat::Rgba32) {
        (TargetFormat::Rgba32, Texels::U8)
    } else {
        (TargetFormat::RgbaHalf, halves)
    };
    let texels = image
        .transcode_image(0, 0, 0, target, DecodeFlags::NONE)
        .map_err(|e| format!("has broken data: {e:?}"))?;
    Bitmap::new(width as usize, height as usize, 4, kind(texels)).ok_or_else(|| "has no pixels".into())
}

/// Numbers of half precision.
fn halves(bytes: Vec<u8>) -> Texels {
    Texels::F16(bytes.as_chunks().0.iter().map(|pair| f16::from_le_bytes(*pair)).collect())
}
