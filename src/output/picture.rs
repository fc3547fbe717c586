//! A finished image as plain data: windows, layers of channels, metadata.

use std::collections::HashSet;

use crate::{Metadata, OutputError};

/// How many bits a layer's channels get in an EXR.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// 16-bit floats: 11 bits of mantissa, at most 65504. For colour.
    Half,
    /// 32-bit floats. For depth, position and variance; and for identifiers, which are exact up to 2²⁴. (The format has
    /// integers too, but OpenImageIO scales those to [0, 1] when somebody reads floats.)
    Float,
}

/// A named plane of samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Name within the layer: `R`, `X`, `Z`, `objectId` …
    pub name: String,
    /// One sample a pixel, row after row from the top left.
    pub samples: Vec<f32>,
}

/// Channels that belong together.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// `albedo`, `N` …; empty for channels that stand alone (`R`, `G`, `B`, `A`, `Z`, `objectId`). Layers may share a
    /// name when their channels differ.
    pub name: String,
    /// Bits for its channels.
    pub precision: Precision,
    /// The planes.
    pub channels: Vec<Channel>,
}

impl Layer {
    /// The name of `channel` in the file: `R`, `albedo.R`.
    pub fn full_name(&self, channel: &Channel) -> String {
        if self.name.is_empty() { channel.name.clone() } else { format!("{}.{}", self.name, channel.name) }
    }
}

/// An image with everything that is stored beside its pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels across in the data window, the part that was rendered.
    pub width: u32,
    /// Pixels down in the data window.
    pub height: u32,
    /// The data window's top left pixel in the full frame.
    pub offset: (i32, i32),
    /// Width and height of the full frame, the display window.
    pub full_size: (u32, u32),
    /// Beauty first.
    pub layers: Vec<Layer>,
    /// What produced it.
    pub metadata: Metadata,
}

impl Picture {
    /// Checks what every output relies on: windows that exist, unique printable names, full and finite channels.
    ///
    /// # Errors
    /// The first violation found.
    pub fn check(&self) -> Result<(), OutputError> {
        for (width, height) in [(self.width, self.height), self.full_size] {
            check_size(width, height)?;
        }
        let expected = self.width as usize * self.height as usize;
        let mut names = HashSet::new();
        for layer in &self.layers {
            for channel in &layer.channels {
                let name = layer.full_name(channel);
                if channel.name.is_empty() || name.chars().any(char::is_control) || names.contains(&name) {
                    return Err(OutputError::ChannelName(name));
                }
                let found = channel.samples.len();
                if found != expected {
                    return Err(OutputError::SampleCount { channel: name, found, expected });
                }
                check_finite(&name, &channel.samples, 1, self.width)?;
                names.insert(name);
            }
        }
        Ok(())
    }
}

/// Both formats count pixels in 31 bits and neither stores nothing.
pub(crate) fn check_size(width: u32, height: u32) -> Result<(), OutputError> {
    let fits = |n: u32| n > 0 && i32::try_from(n).is_ok();
    if fits(width) && fits(height) { Ok(()) } else { Err(OutputError::Size { width, height }) }
}

/// `stride` values a pixel, `width` pixels a row.
pub(crate) fn check_finite(name: &str, values: &[f32], stride: usize, width: u32) -> Result<(), OutputError> {
    match values.iter().enumerate().find(|(_, value)| !value.is_finite()) {
        None => Ok(()),
        Some((index, &value)) => {
            let (pixel, width) = (index / stride, width as usize);
            Err(OutputError::NonFinite { channel: name.into(), x: pixel % width, y: pixel / width, value })
        }
    }
}
