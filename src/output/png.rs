//! PNG previews: exposure, tone mapping, sRGB, 8 bits.
//!
//! Values are rounded to the nearest code, without dither: equal renders give equal files and a difference between two
//! previews is a difference between the renders. The `sRGB` chunk tells viewers how to read the codes.

use std::path::Path;

use png::{BitDepth, ColorType, Encoder, SrgbRenderingIntent};

use crate::{
    OutputError, ToneMap,
    picture::{check_finite, check_size},
    tonemap::srgb_encode,
    write_atomically,
};

/// Writes interleaved linear Rec.709 `rgb`, rows from the top, `width` × `height` pixels, brightened by `exposure_ev`
/// stops. `alpha` (coverage, clamped to [0, 1]) means that `rgb` is premultiplied, as renders are; PNG stores colour
/// and coverage apart, so light without coverage (a glow in front of nothing) is lost.
///
/// # Errors
/// Samples are missing or not finite, or the file system refuses; the old file is then untouched.
pub fn write_png(
    path: &Path,
    rgb: &[f32],
    alpha: Option<&[f32]>,
    width: u32,
    height: u32,
    tone_map: ToneMap,
    exposure_ev: f32,
) -> Result<(), OutputError> {
    check_size(width, height)?;
    let pixels = width as usize * height as usize;
    check_samples("RGB", rgb, 3, pixels, width)?;
    if let Some(alpha) = alpha {
        check_samples("A", alpha, 1, pixels, width)?;
    }

    let gain = exposure_ev.exp2();
    let mut codes = Vec::with_capacity(pixels * (3 + usize::from(alpha.is_some())));
    for (index, pixel) in rgb.as_chunks::<3>().0.iter().enumerate() {
        let coverage = alpha.and_then(|alpha| alpha.get(index)).map(|a| a.clamp(0.0, 1.0));
        let gain = match coverage {
            Some(0.0) => 0.0,
            Some(coverage) => gain / coverage,
            None => gain,
        };
        let shown = tone_map.apply(pixel.map(|value| value * gain));
        codes.extend(shown.map(|value| quantize(srgb_encode(value))));
        codes.extend(coverage.map(quantize));
    }

    let color = if alpha.is_some() { ColorType::Rgba } else { ColorType::Rgb };
    let bytes =
        encode(&codes, color, width, height).map_err(|error| OutputError::Encode(error.to_string()))?;
    write_atomically(path, |file| file.write_all(&bytes))
}

fn check_samples(
    name: &str,
    values: &[f32],
    stride: usize,
    pixels: usize,
    width: u32,
) -> Result<(), OutputError> {
    let (found, expected) = (values.len(), pixels * stride);
    if found != expected {
        return Err(OutputError::SampleCount { channel: name.into(), found, expected });
    }
    check_finite(name, values, stride, width)
}

/// The nearest 8-bit code of a value in [0, 1].
fn quantize(value: f32) -> u8 {
    (value * 255.0).round() as u8
}

fn encode(codes: &[u8], color: ColorType, width: u32, height: u32) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, width, height);
    encoder.set_color(color);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(codes)?;
    writer.finish()?;
    Ok(bytes)
}
