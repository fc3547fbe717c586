use std::{io::Write, sync::Arc};

use ::exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image as Exr, IntegerBounds, Layer, LayerAttributes,
    WritableImage,
};
use glam::Vec4;
use half::f16;
use image::{DynamicImage, ImageBuffer, codecs::hdr::HdrEncoder};

use super::*;

fn named(bytes: Vec<u8>) -> ajar_scene::Image {
    ajar_scene::Image { name: "wood".into(), source: ImageSource::Embedded(Arc::from(bytes)) }
}

fn bitmap(bytes: Vec<u8>) -> Bitmap {
    decode(&named(bytes), 1 << 20).unwrap().bitmap
}

fn error(bytes: Vec<u8>) -> String {
    let diagnostic = decode(&named(bytes), 1 << 20).unwrap_err();
    assert!(diagnostic.message.contains("wood"), "{diagnostic}");
    diagnostic.message
}

fn encode(image: &DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

/// A 3 × 2 image of 8 bits with the numbers 0, 10, 20, ….
fn eight_bits(channels: u8) -> DynamicImage {
    let raw: Vec<u8> = (0..6 * channels).map(|i| i * 10).collect();
    match channels {
        1 => DynamicImage::ImageLuma8(ImageBuffer::from_raw(3, 2, raw).unwrap()),
        2 => DynamicImage::ImageLumaA8(ImageBuffer::from_raw(3, 2, raw).unwrap()),
        3 => DynamicImage::ImageRgb8(ImageBuffer::from_raw(3, 2, raw).unwrap()),
        _ => DynamicImage::ImageRgba8(ImageBuffer::from_raw(3, 2, raw).unwrap()),
    }
}

#[test]
fn lossless_eight_bit_images_keep_their_bytes() {
    use ImageFormat::{Bmp, Png, Tga, Tiff, WebP};
    for (format, channels) in [
        (Png, 1),
        (Png, 2),
        (Png, 3),
        (Png, 4),
        (Tiff, 1),
        (Tiff, 3),
        (Tiff, 4),
        (WebP, 3),
        (WebP, 4),
        (Bmp, 3),
        (Tga, 1),
        (Tga, 3),
        (Tga, 4),
    ] {
        let image = eight_bits(channels);
        let b = bitmap(encode(&image, format));
        assert_eq!((b.width(), b.height(), b.channels()), (3, 2, usize::from(channels)), "{format:?}");
        assert_eq!(b.texels(), &Texels::U8(image.into_bytes()), "{format:?}");
    }
    let texel = |channels| bitmap(encode(&eight_bits(channels), Png)).texel(1, 1, false) * 255.0;
    assert!((texel(1) - Vec4::new(40.0, 40.0, 40.0, 255.0)).length() < 1e-4);
    assert!((texel(2) - Vec4::new(80.0, 80.0, 80.0, 90.0)).length() < 1e-4);
    assert!((texel(3) - Vec4::new(120.0, 130.0, 140.0, 255.0)).length() < 1e-4);
    assert!((texel(4) - Vec4::new(160.0, 170.0, 180.0, 190.0)).length() < 1e-4);
}

#[test]
fn sixteen_bits_and_floats_are_kept() {
    let raw: Vec<u16> = (0..24).map(|i| i * 2800).collect();
    let image = DynamicImage::ImageRgba16(ImageBuffer::from_raw(3, 2, raw.clone()).unwrap());
    for format in [ImageFormat::Png, ImageFormat::Tiff] {
        assert_eq!(bitmap(encode(&image, format)).texels(), &Texels::U16(raw.clone()));
    }
    let grey = DynamicImage::ImageLuma16(ImageBuffer::from_raw(1, 1, vec![16384]).unwrap());
    assert!((bitmap(encode(&grey, ImageFormat::Png)).texel(0, 0, false).x - 0.250_004).abs() < 1e-6);
    let floats: Vec<f32> = (0..18).map(|i| i as f32 * 100.5 - 3.0).collect();
    let image = DynamicImage::ImageRgb32F(ImageBuffer::from_raw(3, 2, floats.clone()).unwrap());
    assert_eq!(bitmap(encode(&image, ImageFormat::Tiff)).texels(), &Texels::F32(floats));
}

#[test]
fn grey_floats_in_tiff_are_kept() {
    use ::tiff::encoder::{TiffEncoder, colortype::Gray32Float};
    let floats: Vec<f32> = (0..6).map(|i| i as f32 * 100.5 - 3.0).collect();
    let mut file = Cursor::new(Vec::new());
    TiffEncoder::new(&mut file).unwrap().write_image::<Gray32Float>(3, 2, &floats).unwrap();
    let image = bitmap(file.into_inner());
    assert_eq!((image.width(), image.height(), image.channels()), (3, 2, 1));
    assert_eq!(image.texels(), &Texels::F32(floats));
}

#[test]
fn radiance_files_keep_high_radiance() {
    let pixels: Vec<_> = (0..6).map(|i| image::Rgb([2000.0f32, i as f32, 0.25])).collect();
    let mut bytes = Vec::new();
    HdrEncoder::new(&mut bytes).encode(&pixels, 3, 2).unwrap();
    let texel = bitmap(bytes).texel(2, 1, false);
    // Shared exponents leave 8 bits of the largest channel.
    assert!((texel - Vec4::new(2000.0, 5.0, 0.25, 1.0)).abs().max_element() < 8.0, "{texel}");
    assert!((texel.x / 2000.0 - 1.0).abs() < 0.005);
}

#[test]
fn jpeg_is_decoded_in_grey_colour_and_ink() {
    let rgb = image::RgbImage::from_pixel(16, 16, image::Rgb([200, 90, 30]));
    let b = bitmap(encode(&DynamicImage::ImageRgb8(rgb), ImageFormat::Jpeg));
    assert!((b.texel(7, 7, false) * 255.0 - Vec4::new(200.0, 90.0, 30.0, 255.0)).abs().max_element() < 4.0);
    let grey = image::GrayImage::from_pixel(16, 16, image::Luma([77]));
    let b = bitmap(encode(&DynamicImage::ImageLuma8(grey), ImageFormat::Jpeg));
    assert_eq!(b.channels(), 1);
    assert!((b.texel(3, 3, false).x * 255.0 - 77.0).abs() < 2.0);
    // Stored inverted: no cyan, half magenta, full yellow, no black.
    let texel = bitmap(cmyk_jpeg()).texel(4, 4, false) * 255.0;
    assert!((texel - Vec4::new(255.0, 128.0, 0.0, 255.0)).abs().max_element() < 3.0, "{texel}");
}

/// An 8 × 8 baseline JPEG of four components, Adobe's inverted CMYK of 255, 128, 0, 255.
fn cmyk_jpeg() -> Vec<u8> {
    let segment = |marker: u8, body: &[u8]| [&[0xff, marker, 0, body.len() as u8 + 2], body].concat();
    let components = |tail: &[u8]| (1..=4).flat_map(|id| [&[id], tail].concat()).collect::<Vec<u8>>();
    let mut bytes = vec![0xff, 0xd8];
    bytes.extend(segment(0xee, b"Adobe\0\x64\0\0\0\0\0"));
    bytes.extend(segment(0xdb, &[&[0][..], &[8; 64]].concat()));
    bytes.extend(segment(0xc0, &[&[8, 0, 8, 0, 8, 4][..], &components(&[0x11, 0])].concat()));
    // Differences of 0, 7 and 8 bits get the codes 00, 01 and 10; the end of a block is the bit 0.
    bytes.extend(segment(0xc4, &[&[0x00, 0, 3][..], &[0; 14], &[0, 7, 8]].concat()));
    bytes.extend(segment(0xc4, &[&[0x10, 1][..], &[0; 15], &[0]].concat()));
    bytes.extend(segment(0xda, &[&[4][..], &components(&[0]), &[0, 63, 0]].concat()));
    let bits =
        ["01", "1111111", "0", "00", "0", "10", "01111111", "0", "01", "1111111", "0"].concat() + "1111111";
    for byte in bits.as_bytes().chunks_exact(8) {
        let byte = byte.iter().fold(0, |value, bit| value << 1 | (bit - b'0'));
        bytes.push(byte);
        if byte == 0xff {
            bytes.push(0);
        }
    }
    bytes.extend([0xff, 0xd9]);
    bytes
}

/// An OpenEXR file of 3 × 2 pixels with the given channels.
fn exr_file(
    channels: &[(&str, FlatSamples)],
    encoding: Encoding,
    position: (i32, i32),
    display: (usize, usize),
) -> Vec<u8> {
    let list = channels.iter().map(|(name, samples)| AnyChannel::new(*name, samples.clone())).collect();
    let attributes = LayerAttributes { layer_position: position.into(), ..LayerAttributes::default() };
    let layer = Layer::new((3, 2), attributes, encoding, AnyChannels::sort(list));
    let mut image = Exr::from_layer(layer);
    image.attributes.display_window = IntegerBounds::new((0, 0), display);
    let mut bytes = Cursor::new(Vec::new());
    image.write().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

fn halves(start: f32) -> FlatSamples {
    FlatSamples::F16((0..6).map(|i| f16::from_f32(start + i as f32)).collect())
}

#[test]
fn exr_channels_are_found_by_name_and_keep_their_width() {
    let rgba = [
        ("B", halves(20.0)),
        ("A", halves(0.0)),
        ("R", halves(1000.0)),
        ("G", halves(10.0)),
        ("Z", halves(7.0)),
    ];
    for encoding in [Encoding::UNCOMPRESSED, Encoding::SMALL_LOSSLESS, Encoding::FAST_LOSSLESS] {
        let b = bitmap(exr_file(&rgba, encoding, (0, 0), (3, 2)));
        assert!(matches!(b.texels(), Texels::F16(_)));
        assert_eq!(b.texel(2, 1, false), Vec4::new(1005.0, 15.0, 25.0, 5.0));
    }
    let floats = FlatSamples::F32((0..6).map(|i| i as f32 * 1e5).collect());
    let luminance = bitmap(exr_file(&[("Y", floats.clone())], Encoding::FAST_LOSSLESS, (0, 0), (3, 2)));
    assert!(matches!(luminance.texels(), Texels::F32(_)));
    assert_eq!(luminance.texel(1, 1, false), Vec4::new(4e5, 4e5, 4e5, 1.0));
    let single = bitmap(exr_file(&[("height", floats)], Encoding::FAST_LOSSLESS, (0, 0), (3, 2)));
    assert_eq!((single.channels(), single.texel(1, 0, false).x), (1, 1e5));
    let other =
        exr_file(&[("N.x", halves(0.0)), ("N.y", halves(0.0))], Encoding::FAST_LOSSLESS, (0, 0), (3, 2));
    assert!(error(other).contains("N.x, N.y"));
}

#[test]
fn exr_pixels_lie_in_the_display_window() {
    let b = bitmap(exr_file(&[("Y", halves(1.0))], Encoding::FAST_LOSSLESS, (1, -1), (5, 3)));
    assert_eq!((b.width(), b.height()), (5, 3));
    let row = |y| [0, 1, 2, 3, 4].map(|x| b.texel(x, y, false).x);
    assert_eq!([row(0), row(1)], [[0.0, 4.0, 5.0, 6.0, 0.0], [0.0; 5]]);
}

#[test]
fn numbers_that_are_not_finite_are_replaced_and_counted() {
    let floats = vec![1.0, f32::INFINITY, -f32::INFINITY, f32::NAN, -2.0, 1e30];
    let halves = floats.iter().map(|&x| f16::from_f32(x)).collect();
    for (samples, count, last) in
        [(FlatSamples::F32(floats), 3, 1e30), (FlatSamples::F16(halves), 4, 65504.0)]
    {
        let file = exr_file(&[("Y", samples)], Encoding::FAST_LOSSLESS, (0, 0), (3, 2));
        let decoded = decode(&named(file), 1 << 20).unwrap();
        assert_eq!(decoded.not_finite, count);
        let values = [0, 1, 2, 3, 4, 5].map(|i| decoded.bitmap.texel(i % 3, i / 3, false).x);
        assert_eq!(values, [1.0, 65504.0, 0.0, 0.0, -2.0, last]);
    }
}

#[test]
fn bytes_decide_the_format_and_sizes_are_limited() {
    assert!(error(b"#version 330".to_vec()).contains("is not a PNG"));
    assert!(error(Vec::new()).contains("is not a PNG"));
    let mut file = tempfile();
    file.1.write_all(&encode(&eight_bits(3), ImageFormat::Png)).unwrap();
    let image = ajar_scene::Image { name: "wood".into(), source: ImageSource::File(file.0.clone()) };
    assert_eq!(decode(&image, 18).unwrap().bitmap.width(), 3);
    let refused = decode(&image, 17).unwrap_err();
    assert!(refused.message.contains("needs 1 MiB") && refused.file.as_ref() == Some(&file.0), "{refused}");
    std::fs::remove_file(&file.0).unwrap();
    assert!(decode(&image, 18).unwrap_err().message.contains("cannot be read"));
    let folder = ajar_scene::Image { source: ImageSource::File(std::env::temp_dir()), ..image };
    assert!(decode(&folder, 18).unwrap_err().message.contains("is not a file"));

    let wide = DynamicImage::ImageLuma8(ImageBuffer::new(16385, 1));
    assert!(error(encode(&wide, ImageFormat::Png)).contains("16385 × 1"));
    let huge = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 900000 +X 900000\n".to_vec();
    assert!(error(huge).contains("900000"));
}

/// A file named like a JPEG, whatever it holds.
fn tempfile() -> (std::path::PathBuf, File) {
    let path = std::env::temp_dir().join(format!("ajar-decode-{}.jpg", std::process::id()));
    (path.clone(), File::create(path).unwrap())
}

#[test]
fn malformed_files_give_errors_not_panics() {
    let mut files =
        vec![cmyk_jpeg(), exr_file(&[("Y", halves(0.0))], Encoding::SMALL_LOSSLESS, (0, 0), (3, 2))];
    for format in [ImageFormat::Png, ImageFormat::Jpeg, ImageFormat::WebP, ImageFormat::Tiff] {
        files.push(encode(&eight_bits(3), format));
    }
    let mut rng = crate::rng::Rng::new(1, crate::rng::Purpose::Test, 0, 0);
    for file in files {
        assert!(decode(&named(file.clone()), 1 << 20).is_ok());
        for keep in [1, 10, file.len() / 2] {
            // Some decoders return what they have; none may panic.
            _ = decode(&named(file[..keep].to_vec()), 1 << 20);
        }
        for _ in 0..300 {
            let mut broken = file.clone();
            for _ in 0..3 {
                broken[rng.below(file.len())] = rng.next_u32() as u8;
            }
            _ = decode(&named(broken), 1 << 20);
        }
    }
}
