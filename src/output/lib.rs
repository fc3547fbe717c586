//! Images and files: what leaves the renderer.
//!
//! A [`Picture`] is plain data, rows from the top, colours linear Rec.709; [`write_exr`] stores it without loss beyond
//! half precision, [`write_png`] stores what a person would see through a [`ToneMap`]. Every file goes through
//! [`write_atomically`]: a reader finds the old file or the new one. Pixels that are not finite are an error and reach
//! no file. A render so far is a [`Checkpoint`]. This crate prints nothing and knows of
//! the renderer only its film.

mod atomic;
mod camera_matrices;
mod checkpoint;
mod error;
mod exr;
mod frames;
mod header;
mod metadata;
mod picture;
mod png;
mod statistics;
mod tonemap;

pub use self::atomic::write_atomically;
pub use self::camera_matrices::CameraMatrices;
pub use self::checkpoint::{Checkpoint, CheckpointError, read_checkpoint, write_checkpoint};
pub use self::error::OutputError;
pub use self::exr::{Widened, write_exr};
pub use self::frames::frame_path;
pub use self::metadata::Metadata;
pub use self::picture::{Channel, Layer, Picture, Precision};
pub use self::png::write_png;
pub use self::statistics::BlockVariances;
pub use self::tonemap::{ToneMap, UnknownToneMap, srgb_encode};
