//! From the bytes of an image file to a [`Bitmap`].
//!
//! The bytes decide about the format, never the name. Sizes are checked on the header, before anything is allocated for
//! pixels. Colour profiles and gamma chunks are ignored, as glTF and USD ask.

use std::{
    fs::File,
    io::{BufRead, BufReader, Cursor, Seek},
    panic::{AssertUnwindSafe, catch_unwind},
};

use ajar_scene::{Cause, Diagnostic, Image, ImageSource};
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};

use super::{Bitmap, Texels, exr, ktx2, tiff};

/// Largest width and height.
pub(super) const MAX_SIZE: usize = 16384;

/// Bytes of an image file.
trait Input: BufRead + Seek {}
impl<T: BufRead + Seek> Input for T {}

/// A decoded image and what was repaired.
#[derive(Debug)]
pub struct Decoded {
    /// The pixels, all finite.
    pub bitmap: Bitmap,
    /// How many numbers were not finite: +∞ became 65504, all else 0.
    pub not_finite: usize,
}

impl Decoded {
    /// A warning about repairs to `image`, if there were any.
    pub(super) fn warning(&self, image: &Image) -> Option<Diagnostic> {
        let why = format!("{} values are not finite: +inf read as 65504, all else as 0", self.not_finite);
        (self.not_finite > 0).then(|| about(image, Diagnostic::warning, &why))
    }
}

/// What the header says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Header {
    pub width: usize,
    pub height: usize,
    /// Memory that the decoded pixels take.
    pub bytes: u64,
}

/// Decodes an image that takes at most `memory_limit` bytes.
///
/// # Errors
/// A diagnostic that names the image: unreadable file, unknown format, corrupt or too large.
pub fn decode(image: &Image, memory_limit: u64) -> Result<Decoded, Diagnostic> {
    let header = probe(image)?;
    if header.bytes > memory_limit {
        return Err(too_large(image, header.bytes, memory_limit));
    }
    let mut bitmap = guarded(image, || {
        let mut input = open(&image.source)?;
        let head = input.fill_buf().map_err(|e| e.to_string())?;
        if exr::is_exr(head) {
            exr::load(input)
        } else if ktx2::is_ktx2(head) {
            ktx2::load(input)
        } else if let Some(header) = tiff::header(&mut input)? {
            tiff::load(input, header)
        } else {
            read(input, memory_limit)
        }
    })?;
    let not_finite = bitmap.make_finite();
    Ok(Decoded { bitmap, not_finite })
}

/// Reads the header alone.
pub(super) fn probe(image: &Image) -> Result<Header, Diagnostic> {
    let header = guarded(image, || {
        let mut input = open(&image.source)?;
        let head = input.fill_buf().map_err(|e| e.to_string())?;
        if exr::is_exr(head) {
            return exr::header(input);
        } else if ktx2::is_ktx2(head) {
            return ktx2::header(input);
        } else if let Some(header) = tiff::header(&mut input)? {
            return Ok(header);
        }
        let decoder = reader(input)?.into_decoder().map_err(|e| e.to_string())?;
        let (width, height) = decoder.dimensions();
        Ok(Header { width: width as usize, height: height as usize, bytes: decoder.total_bytes() })
    })?;
    if header.width.max(header.height) > MAX_SIZE {
        let Header { width, height, .. } = header;
        let why = format!("{width} × {height} texels, more than {MAX_SIZE} on a side");
        // The file's fault: no memory limit would let it in.
        return Err(refuse(image, &why).hint("scale it down"));
    }
    Ok(header)
}

pub(super) fn too_large(image: &Image, bytes: u64, left: u64) -> Diagnostic {
    let mib = |bytes: u64| bytes.div_ceil(1 << 20);
    let why = format!("needs {} MiB, {} MiB are left for textures", mib(bytes), left >> 20);
    let hint = "scale images down or allow more with --memory-limit";
    refuse(image, &why).because(Cause::Resource).hint(hint)
}

/// An error about `image`.
fn refuse(image: &Image, why: &str) -> Diagnostic {
    about(image, Diagnostic::error, why)
}

fn about(image: &Image, severity: fn(String) -> Diagnostic, why: &str) -> Diagnostic {
    let diagnostic = severity(format!("image \"{}\": {why}", image.name.escape_debug()));
    match &image.source {
        ImageSource::File(path) => diagnostic.in_file(path),
        ImageSource::Embedded(_) => diagnostic,
    }
}

/// Runs a decoder. Those of other crates can panic on hostile bytes: that is an error of the image, not of ours.
fn guarded<T>(image: &Image, run: impl FnOnce() -> Result<T, String>) -> Result<T, Diagnostic> {
    catch_unwind(AssertUnwindSafe(run))
        .unwrap_or_else(|_| Err("the decoder failed on malformed bytes".into()))
        .map_err(|why| refuse(image, &why))
}

fn open(source: &ImageSource) -> Result<Box<dyn Input>, String> {
    match source {
        ImageSource::Embedded(bytes) => Ok(Box::new(Cursor::new(bytes.clone()))),
        ImageSource::File(path) => {
            let file = File::open(path).map_err(|e| format!("cannot be read: {e}"))?;
            if !file.metadata().is_ok_and(|metadata| metadata.is_file()) {
                return Err("is not a file".into());
            }
            Ok(Box::new(BufReader::new(file)))
        }
    }
}

fn reader(input: Box<dyn Input>) -> Result<ImageReader<Box<dyn Input>>, String> {
    let mut input = input;
    let is_targa = is_targa(input.fill_buf().map_err(|e| e.to_string())?);
    let mut reader = ImageReader::new(input).with_guessed_format().map_err(|e| e.to_string())?;
    if reader.format().is_none() && is_targa {
        reader.set_format(ImageFormat::Tga);
    }
    if reader.format().is_none() {
        return Err("is not a PNG, JPEG, WebP, TIFF, TGA, BMP, Radiance HDR, OpenEXR or KTX2 file".into());
    }
    Ok(reader)
}

/// Whether a file may be a Truevision TGA, which has no magic number: kind of colour map, kind of image, bits a pixel.
fn is_targa(head: &[u8]) -> bool {
    matches!(head, [_, 0 | 1, 1..=3 | 9..=11, _, _, _, _, _, _, _, _, _, _, _, _, _, 8 | 16 | 24 | 32, _, ..])
}

fn read(input: Box<dyn Input>, memory_limit: u64) -> Result<Bitmap, String> {
    let mut reader = reader(input)?;
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIZE as u32);
    limits.max_image_height = Some(MAX_SIZE as u32);
    // Decoders keep some buffers besides the pixels.
    limits.max_alloc = Some(memory_limit.saturating_mul(2).saturating_add(64 << 20));
    reader.limits(limits);
    let image = reader.decode().map_err(|e| e.to_string())?;
    let (width, height) = (image.width() as usize, image.height() as usize);
    let (channels, texels) = match image {
        DynamicImage::ImageLuma8(i) => (1, Texels::U8(i.into_raw())),
        DynamicImage::ImageLumaA8(i) => (2, Texels::U8(i.into_raw())),
        DynamicImage::ImageRgb8(i) => (3, Texels::U8(i.into_raw())),
        DynamicImage::ImageRgba8(i) => (4, Texels::U8(i.into_raw())),
        DynamicImage::ImageLuma16(i) => (1, Texels::U16(i.into_raw())),
        DynamicImage::ImageLumaA16(i) => (2, Texels::U16(i.into_raw())),
        DynamicImage::ImageRgb16(i) => (3, Texels::U16(i.into_raw())),
        DynamicImage::ImageRgba16(i) => (4, Texels::U16(i.into_raw())),
        DynamicImage::ImageRgb32F(i) => (3, Texels::F32(i.into_raw())),
        DynamicImage::ImageRgba32F(i) => (4, Texels::F32(i.into_raw())),
        _ => return Err("has a pixel layout that is not supported".into()),
    };
    Bitmap::new(width, height, channels, texels).ok_or_else(|| "has no pixels".into())
}

#[cfg(test)]
mod tests;
