//! Seeds that are pictures: every format that textures may have, small.

use std::io::Cursor;

use exr::prelude::{Encoding, Image, Layer, LayerAttributes, SpecificChannels, WritableImage};
use image::{DynamicImage, ImageFormat, Rgb32FImage, RgbaImage};

/// Pixels a side: several blocks of JPEG.
const SIDE: u32 = 20;

/// A picture in every format.
pub fn all() -> Vec<Vec<u8>> {
    let pixel = |x: u32, y: u32| [(x * 12) as u8, (y * 12) as u8, (x * y) as u8, 255 - x as u8];
    let bytes = DynamicImage::from(RgbaImage::from_fn(SIDE, SIDE, |x, y| image::Rgba(pixel(x, y))));
    let floats = |x: u32, y: u32| [x, y, x * y].map(|i| i as f32 * 0.25);
    let numbers = DynamicImage::from(Rgb32FImage::from_fn(SIDE, SIDE, |x, y| image::Rgb(floats(x, y))));
    let formats = [
        (ImageFormat::Png, bytes.to_rgba16().into()),
        (ImageFormat::Png, bytes.to_luma8().into()),
        (ImageFormat::Jpeg, bytes.to_rgb8().into()),
        (ImageFormat::Jpeg, bytes.to_luma8().into()),
        (ImageFormat::WebP, bytes.clone()),
        (ImageFormat::Tiff, bytes.to_rgb16().into()),
        (ImageFormat::Tiff, numbers.clone()),
        (ImageFormat::Bmp, bytes.to_rgb8().into()),
        (ImageFormat::Hdr, numbers),
    ];
    let pictures = formats.into_iter().map(|(format, picture): (_, DynamicImage)| {
        let mut file = Cursor::new(Vec::new());
        // What cannot be written is an empty seed, which the test refuses to begin with.
        let _ = picture.write_to(&mut file, format);
        file.into_inner()
    });
    pictures
        .chain([Encoding::SMALL_LOSSLESS, Encoding::FAST_LOSSLESS, Encoding::UNCOMPRESSED].map(exr))
        .chain([ktx2()])
        .collect()
}

fn exr(encoding: Encoding) -> Vec<u8> {
    let pixel = |at: exr::math::Vec2<usize>| (at.x() as f32, at.y() as f32 * 0.5, 0.25_f32);
    let size = (SIDE as usize, SIDE as usize);
    let layer = Layer::new(size, LayerAttributes::default(), encoding, SpecificChannels::rgb(pixel));
    let mut file = Cursor::new(Vec::new());
    let _ = Image::from_layer(layer).write().to_buffered(&mut file);
    file.into_inner()
}

/// Four texels of 8 bits, R G B A (KTX 2.0, §3).
fn ktx2() -> Vec<u8> {
    const UNORM: u32 = 37;
    let texels = [255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 9, 9, 9, 128];
    let words = |words: &[u32]| words.iter().flat_map(|word| word.to_le_bytes()).collect::<Vec<u8>>();
    let sizes = [UNORM, 1, 2, 2, 0, 0, 1, 1, 0];
    // An empty description of the data behind the header, no keys, no supercompression, then the one level.
    let (index, level) = ([104, 4, 0, 0, 0, 0, 0, 0], [108, 0, 16, 0, 16, 0]);
    [
        b"\xabKTX 20\xbb\r\n\x1a\n".to_vec(),
        words(&sizes),
        words(&index),
        words(&level),
        words(&[4]),
        texels.to_vec(),
    ]
    .concat()
}
