//! Grey TIFF files of 32-bit floats, which `image` leaves out.

use std::io::{BufRead, Seek, SeekFrom};

use tiff::{
    ColorType,
    decoder::{Decoder, DecodingResult, Limits},
};

use super::{Bitmap, Texels, decode::Header};

/// What is said of the file, if it is of this kind; afterwards the input is where it was.
///
/// # Errors
/// The file is broken.
pub(super) fn header(mut input: impl BufRead + Seek) -> Result<Option<Header>, String> {
    let is_tiff = input.fill_buf().is_ok_and(|head| head.starts_with(b"II*\0") || head.starts_with(b"MM\0*"));
    if !is_tiff {
        return Ok(None);
    }
    let start = input.stream_position().map_err(|e| e.to_string())?;
    let mut decoder = Decoder::new(&mut input).map_err(|e| e.to_string())?;
    let is_grey = matches!(decoder.colortype(), Ok(ColorType::Gray(32)));
    let (width, height) = decoder.dimensions().map_err(|e| e.to_string())?;
    input.seek(SeekFrom::Start(start)).map_err(|e| e.to_string())?;
    let bytes = 4 * u64::from(width) * u64::from(height);
    Ok(is_grey.then_some(Header { width: width as usize, height: height as usize, bytes }))
}

/// Reads a file of this kind whose `header` is that.
///
/// # Errors
/// The file is broken, or holds whole numbers.
pub(super) fn load(input: impl BufRead + Seek, header: Header) -> Result<Bitmap, String> {
    let mut limits = Limits::default();
    limits.decoding_buffer_size = header.bytes as usize;
    let mut decoder = Decoder::new(input).map_err(|e| e.to_string())?.with_limits(limits);
    match decoder.read_image().map_err(|e| e.to_string())? {
        DecodingResult::F32(texels) => Bitmap::new(header.width, header.height, 1, Texels::F32(texels))
            .ok_or_else(|| "has no pixels".into()),
        _ => Err("has grey numbers of 32 bits that are no floats".into()),
    }
}
