//! What can go wrong between a finished picture and a file.

use std::{io, path::PathBuf};

/// Why a file was not written. The destination is then as it was before.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    /// The file system refused.
    #[error("{}: cannot write: {source}", path.display())]
    Write {
        /// The destination that was asked for.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A pixel is NaN or infinite.
    #[error("channel `{channel}` is {value} at pixel ({x}, {y})")]
    NonFinite {
        /// Full channel name.
        channel: String,
        /// Column, counted from the left of the data window.
        x: usize,
        /// Row, counted from the top of the data window.
        y: usize,
        /// The offending value.
        value: f32,
    },
    /// A channel has too few or too many samples.
    #[error("channel `{channel}` has {found} samples for {expected} pixels")]
    SampleCount {
        /// Full channel name.
        channel: String,
        /// Samples given.
        found: usize,
        /// Samples needed.
        expected: usize,
    },
    /// A channel name is empty, taken, or holds control characters.
    #[error("`{0}` cannot name a channel: it must be unique, non-empty and printable")]
    ChannelName(String),
    /// The windows are empty or too large for the format.
    #[error("an image of {width} × {height} pixels cannot be stored")]
    Size {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
    },
    /// The encoder refused the picture.
    #[error("cannot encode the image: {0}")]
    Encode(String),
}
