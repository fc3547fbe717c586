//! OpenEXR files: one part, scan lines, ZIP, every layer as channels `layer.channel`.
//!
//! The data window is the crop, the display window the full frame. Equal pictures give equal bytes.

use std::{fmt, io::Cursor, path::Path};

use exr::{
    image::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer as Part, write::WritableImage},
    math::Vec2,
    meta::{attribute::IntegerBounds, header::ImageAttributes},
};
use half::f16;

use crate::{Layer, OutputError, Picture, Precision, header::sort_attributes, metadata, write_atomically};

/// A layer that was stored as 32-bit floats although half was asked for, because half would have lost its highlights.
#[derive(Clone, Debug, PartialEq)]
pub struct Widened {
    /// The layer's name; empty for the beauty.
    pub layer: String,
    /// Its largest magnitude.
    pub peak: f32,
}

impl fmt::Display for Widened {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let layer = if self.layer.is_empty() { "the beauty layer" } else { &self.layer };
        write!(f, "{layer} reaches {:e}, beyond half's {}: stored as 32-bit float", self.peak, f16::MAX)
    }
}

/// Writes `picture` to `path`, replacing a file there as a whole. Returns the layers that half could not hold: a layer
/// is widened as one, for some readers take the type of its first channel for all.
///
/// # Errors
/// [`Picture::check`] fails or the file system refuses; the old file is then untouched.
pub fn write_exr(path: &Path, picture: &Picture) -> Result<Vec<Widened>, OutputError> {
    picture.check()?;
    let widened: Vec<_> = picture.layers.iter().filter_map(overflow).collect();
    let bytes = encode(picture)?;
    write_atomically(path, |file| file.write_all(&bytes))?;
    Ok(widened)
}

pub(crate) fn encode(picture: &Picture) -> Result<Vec<u8>, OutputError> {
    let (width, height) = picture.full_size;
    let window = IntegerBounds::new((0, 0), (width as usize, height as usize));
    let mut image_attributes = ImageAttributes::new(window);
    metadata::declare_rec709(&mut image_attributes);

    let mut attributes = picture.metadata.layer_attributes();
    attributes.layer_position = Vec2(picture.offset.0, picture.offset.1);

    let channels = AnyChannels::sort(picture.layers.iter().flat_map(stored_channels).collect());
    let size = (picture.width as usize, picture.height as usize);
    let part = Part::new(size, attributes, Encoding::SMALL_LOSSLESS, channels);
    let image = Image::empty(image_attributes).with_layer(part);

    let mut bytes = Cursor::new(Vec::new());
    image.write().to_buffered(&mut bytes).map_err(|error| OutputError::Encode(error.to_string()))?;
    let mut bytes = bytes.into_inner();
    sort_attributes(&mut bytes).ok_or_else(|| OutputError::Encode("unexpected header layout".into()))?;
    Ok(bytes)
}

fn stored_channels(layer: &Layer) -> impl Iterator<Item = AnyChannel<FlatSamples>> {
    let half = layer.precision == Precision::Half && overflow(layer).is_none();
    layer.channels.iter().map(move |channel| {
        let samples = if half {
            FlatSamples::F16(channel.samples.iter().map(|&value| f16::from_f32(value)).collect())
        } else {
            FlatSamples::F32(channel.samples.clone())
        };
        AnyChannel::new(metadata::text(&layer.full_name(channel)), samples)
    })
}

/// Whether some value of a half layer would round to infinity.
fn overflow(layer: &Layer) -> Option<Widened> {
    let samples = layer.channels.iter().flat_map(|channel| &channel.samples);
    let peak = samples.fold(0.0_f32, |peak, value| peak.max(value.abs()));
    let overflows = layer.precision == Precision::Half && f16::from_f32(peak).is_infinite();
    overflows.then(|| Widened { layer: layer.name.clone(), peak })
}
