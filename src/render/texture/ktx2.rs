//! KTX2 images, of Basis Universal (KHR_texture_basisu) or with plain texels of a byte a channel: the first level of the
//! first image.

use std::io::{BufRead, Read};

use basisu::{DecodeFlags, TargetFormat, Transcoder};
use flate2::read::ZlibDecoder;
use half::f16;
use ktx2::{Format, Level, Reader, SupercompressionScheme as Scheme};
use ruzstd::StreamingDecoder;

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
/// Its texels are compressed for graphics cards, or its data are broken.
pub fn load(input: impl BufRead) -> Result<Bitmap, String> {
    let mut bytes = Vec::new();
    input.take(MAX_BYTES).read_to_end(&mut bytes).map_err(|e| e.to_string())?;
    let file = Reader::new(bytes.as_slice()).map_err(|e| format!("is no KTX2 image: {e}"))?;
    match file.header().format {
        None => basis(&bytes),
        Some(format) => plain(&file, format),
    }
}

/// Channels of the formats with a byte for each.
fn channels(format: Format) -> Option<usize> {
    match format {
        Format::R8_UNORM | Format::R8_SRGB => Some(1),
        Format::R8G8_UNORM | Format::R8G8_SRGB => Some(2),
        Format::R8G8B8_UNORM | Format::R8G8B8_SRGB => Some(3),
        Format::R8G8B8A8_UNORM | Format::R8G8B8A8_SRGB => Some(4),
        _ => None,
    }
}

fn plain(file: &Reader<&[u8]>, format: Format) -> Result<Bitmap, String> {
    let channels = channels(format).ok_or_else(|| format!("has texels of the format {format:?}"))?;
    let header = file.header();
    let [width, height] = [header.pixel_width, header.pixel_height].map(|size| size as usize);
    let size = width.saturating_mul(height).saturating_mul(channels);
    let level = file.levels().next().ok_or("has no levels")?;
    let mut texels = inflate(&level, header.supercompression_scheme, size)?;
    // Levels may hold several images; the first one comes first.
    texels.truncate(size);
    Bitmap::new(width, height, channels, Texels::U8(texels)).ok_or_else(|| "has too few texels".into())
}

/// The first `size` bytes of a level.
fn inflate(level: &Level<'_>, scheme: Option<Scheme>, size: usize) -> Result<Vec<u8>, String> {
    let mut texels = Vec::new();
    let broken = |e: &dyn std::fmt::Display| format!("has broken data: {e}");
    let end = size as u64;
    match scheme {
        None => level.data.take(end).read_to_end(&mut texels),
        Some(Scheme::Zstandard) => {
            let decoder = StreamingDecoder::new(level.data).map_err(|e| broken(&e))?;
            decoder.take(end).read_to_end(&mut texels)
        }
        Some(Scheme::ZLIB) => ZlibDecoder::new(level.data).take(end).read_to_end(&mut texels),
        Some(other) => return Err(format!("is compressed by {other:?}")),
    }
    .map_err(|e| broken(&e))?;
    Ok(texels)
}

fn basis(bytes: &[u8]) -> Result<Bitmap, String> {
    let image = Transcoder::new(bytes).map_err(|e| format!("is no KTX2 image of Basis Universal: {e:?}"))?;
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

#[cfg(test)]
mod tests {
    use super::*;

    /// An image of 2 × 1 texels in the Vulkan format `format`, its one level stored as `data`.
    fn file(format: u32, scheme: u32, data: &[u8]) -> Vec<u8> {
        const LEVEL: u32 = HEADER as u32 + 24 + 4;
        let mut file = MAGIC.to_vec();
        // Format, bytes of a channel, size, layers, faces, levels, compression, then where descriptor and notes lie.
        let words = [format, 1, 2, 1, 0, 0, 1, 1, scheme, LEVEL - 4, 4, 0, 0];
        file.extend(words.iter().flat_map(|word| word.to_le_bytes()));
        for word in [0, 0, u64::from(LEVEL), data.len() as u64, 6] {
            file.extend(word.to_le_bytes());
        }
        // A descriptor without blocks.
        file.extend(4u32.to_le_bytes());
        [&file, data].concat()
    }

    const TEXELS: [u8; 6] = [1, 2, 3, 4, 5, 6];
    const RGB: u32 = 23;

    #[test]
    fn plain_texels_are_read() {
        // A Zstandard frame of one raw block (RFC 8878 §3.1.1).
        let zstd = [&[0x28, 0xB5, 0x2F, 0xFD, 0x20, 6, 6 << 3 | 1, 0, 0], &TEXELS[..]].concat();
        let mut zlib = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
        std::io::Write::write_all(&mut zlib, &TEXELS).unwrap();
        for (scheme, data) in [(0, TEXELS.to_vec()), (2, zstd), (3, zlib.finish().unwrap())] {
            let bytes = file(RGB, scheme, &data);
            assert_eq!(header(&*bytes).map(|it| (it.width, it.height)), Ok((2, 1)));
            let bitmap = load(&*bytes).unwrap();
            let Texels::U8(texels) = bitmap.texels() else { panic!("{bitmap:?}") };
            assert_eq!((bitmap.channels(), texels.as_slice()), (3, &TEXELS[..]), "scheme {scheme}");
        }
    }

    #[test]
    fn other_files_say_why() {
        for (file, why) in [
            (file(RGB, 0, &TEXELS[..5]), "has too few texels"),
            (file(RGB, 2, &TEXELS), "has broken data"),
            (file(131, 0, &TEXELS), "has texels of the format BC1_RGB_UNORM_BLOCK"),
            (file(RGB, 1, &TEXELS), "is compressed by BasisLZ"),
            (file(0, 0, &TEXELS), "is no KTX2 image of Basis Universal"),
            (MAGIC.to_vec(), "is no KTX2 image"),
        ] {
            let said = load(&*file).unwrap_err();
            assert!(said.starts_with(why), "{said}");
        }
    }
}
