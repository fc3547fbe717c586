//! Images as they are shown: linear RGB as halves, in tiles, of which two frames share those that are the same.

use std::sync::Arc;

use half::f16;
use rayon::prelude::*;

/// Side of a tile, pixels.
pub const TILE: usize = 64;

/// An image.
#[derive(Clone, Debug, Default)]
pub struct Frame {
    width: usize,
    height: usize,
    tiles: Vec<Arc<[u8]>>,
}

impl Frame {
    /// A frame of `width` times `height` pixels of linear RGB, rows from the top, which shares what it can with the
    /// `previous` one. What halves cannot hold becomes the largest that they can; NaN stays.
    ///
    /// Pixels that are missing are black.
    pub fn new(width: usize, height: usize, pixels: &[[f32; 3]], previous: Option<&Self>) -> Self {
        let previous = previous.filter(|old| (old.width, old.height) == (width, height));
        let columns = width.div_ceil(TILE);
        let tile = |index: usize| {
            let bytes = tile(width, height, pixels, (index % columns) * TILE, (index / columns) * TILE);
            match previous.and_then(|old| old.tiles.get(index)) {
                Some(old) if **old == *bytes => Arc::clone(old),
                _ => bytes.into(),
            }
        };
        Self {
            width,
            height,
            tiles: (0..columns * height.div_ceil(TILE)).into_par_iter().map(tile).collect(),
        }
    }

    /// Columns.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Bytes of memory that its pixels take.
    pub fn bytes(&self) -> usize {
        self.tiles.iter().map(|tile| tile.len()).sum()
    }

    /// The tiles that differ from those of an `earlier` frame, with their numbers, row by row. The bytes of a tile are its
    /// rows of red, green and blue, each a little-endian half; tiles at the right and lower edge are smaller.
    pub fn changes<'a>(&'a self, earlier: Option<&'a Self>) -> impl Iterator<Item = (usize, &'a Arc<[u8]>)> {
        let earlier = earlier.filter(|old| (old.width, old.height) == (self.width, self.height));
        let is_same = move |index: usize, tile: &Arc<[u8]>| {
            earlier.and_then(|old| old.tiles.get(index)).is_some_and(|old| Arc::ptr_eq(old, tile))
        };
        self.tiles.iter().enumerate().filter(move |(index, tile)| !is_same(*index, tile))
    }
}

fn tile(width: usize, height: usize, pixels: &[[f32; 3]], x: usize, y: usize) -> Vec<u8> {
    let (right, bottom) = ((x + TILE).min(width), (y + TILE).min(height));
    let rows = (y..bottom).map(|row| pixels.get(row * width + x..row * width + right));
    let mut bytes = Vec::with_capacity((right - x) * (bottom - y) * 6);
    for row in rows {
        match row {
            Some(row) => bytes.extend(row.iter().flatten().flat_map(|value| code(*value))),
            None => bytes.resize(bytes.len() + (right - x) * 6, 0),
        }
    }
    bytes
}

fn code(value: f32) -> [u8; 2] {
    let largest = f32::from(f16::MAX);
    f16::from_f32(if value.is_nan() { value } else { value.clamp(-largest, largest) }).to_le_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decoded(bytes: &[u8]) -> Vec<f32> {
        bytes.chunks(2).map(|code| f16::from_le_bytes([code[0], code[1]]).to_f32()).collect()
    }

    #[test]
    fn tiles_hold_their_pixels() {
        let pixels: Vec<_> = (0..70 * 66).map(|i| [(i % 70) as f32, (i / 70) as f32, 0.5]).collect();
        let frame = Frame::new(70, 66, &pixels, None);
        let tiles: Vec<_> = frame.changes(None).map(|(_, tile)| decoded(tile)).collect();
        assert_eq!(
            tiles.iter().map(Vec::len).collect::<Vec<_>>(),
            [64 * 64 * 3, 6 * 64 * 3, 64 * 2 * 3, 6 * 2 * 3]
        );
        assert_eq!(tiles[1][..6], [64.0, 0.0, 0.5, 65.0, 0.0, 0.5]);
        assert_eq!(tiles[3][6 * 3..][..3], [64.0, 65.0, 0.5]);
        assert_eq!(frame.bytes(), 70 * 66 * 6);
    }

    #[test]
    fn frames_share_what_is_the_same() {
        let mut pixels = vec![[1.0; 3]; 128 * 64];
        let first = Frame::new(128, 64, &pixels, None);
        pixels[100] = [2.0; 3];
        let second = Frame::new(128, 64, &pixels, Some(&first));
        assert_eq!(second.changes(Some(&first)).map(|(index, _)| index).collect::<Vec<_>>(), [1]);
        assert_eq!(second.changes(Some(&second)).count(), 0);
        let other = Frame::new(64, 128, &pixels, Some(&first));
        assert_eq!(other.changes(Some(&second)).count(), 2, "another shape shares nothing");
    }

    #[test]
    fn what_halves_cannot_hold_is_bounded_and_nan_stays() {
        let frame = Frame::new(1, 1, &[[1e9, -1e9, f32::NAN]], None);
        let values = frame.changes(None).map(|(_, tile)| decoded(tile)).next().unwrap();
        assert_eq!(values[..2], [65504.0, -65504.0]);
        assert!(values[2].is_nan());
    }

    #[test]
    fn missing_pixels_are_black() {
        let frame = Frame::new(2, 2, &[[1.0; 3]; 2], None);
        assert_eq!(decoded(frame.changes(None).next().unwrap().1)[6..], [0.0; 6]);
        assert_eq!(Frame::new(0, 0, &[], None).changes(None).count(), 0);
    }
}
