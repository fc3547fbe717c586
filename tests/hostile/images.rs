//! Images that say they are large, or are not images.

use crate::jail::{
    Fate::{Clean, Either, Refused, TooLarge},
    Jail,
};

/// A scene lit by an image.
fn lit_by(image: &str) -> String {
    format!("[[light]]\ntype = \"environment\"\ntexture = \"{image}\"\n")
}

fn chunk(kind: &[u8; 4], data: &[u8]) -> Vec<u8> {
    let named = [&kind[..], data].concat();
    let crc = named.iter().fold(!0_u32, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| (crc >> 1) ^ (0xedb8_8320 & (crc & 1).wrapping_neg()))
    });
    [&(data.len() as u32).to_be_bytes()[..], &named, &(!crc).to_be_bytes()].concat()
}

/// A PNG of 16 bits a channel, RGBA, with this stream for its pixels.
pub fn png(width: u32, height: u32, pixels: &[u8]) -> Vec<u8> {
    let header = [&width.to_be_bytes()[..], &height.to_be_bytes(), &[16, 6, 0, 0, 0]].concat();
    let mut file = b"\x89PNG\r\n\x1a\n".to_vec();
    for (kind, data) in [(b"IHDR", &header[..]), (b"IDAT", pixels), (b"IEND", &[])] {
        file.extend(chunk(kind, data));
    }
    file
}

/// A deflate stream of one stored block: a row of one pixel, filter byte first.
pub const ONE_PIXEL: &[u8] =
    b"\x78\x01\x01\x09\x00\xf6\xff\x00\x80\x00\x80\x00\x80\x00\xff\xff\x0c\x06\x03\x7f";

fn jpeg(width: u16, height: u16) -> Vec<u8> {
    let [h, w] = [height, width].map(u16::to_be_bytes);
    let frame = [0xff, 0xc0, 0, 17, 8, h[0], h[1], w[0], w[1], 3, 1, 0x22, 0, 2, 0x11, 1, 3, 0x11, 1];
    [&[0xff, 0xd8][..], &frame, &[0xff, 0xda, 0, 12, 3, 1, 0, 2, 0x11, 3, 0x11, 0, 63, 0, 0xff, 0xd9]]
        .concat()
}

fn tiff(width: u32, height: u32) -> Vec<u8> {
    let mut file = b"II*\0\x08\0\0\0\x08\0".to_vec();
    let entries =
        [(256, width), (257, height), (258, 8), (259, 1), (262, 1), (273, 8), (278, height), (279, u32::MAX)];
    for (tag, value) in entries {
        file.extend([&u16::to_le_bytes(tag)[..], &[4, 0, 1, 0, 0, 0], &value.to_le_bytes()].concat());
    }
    file.extend([0; 4]);
    file
}

/// An EXR of one pixel whose windows are said to be larger.
fn exr(width: i32, height: i32) -> Vec<u8> {
    use exr::prelude::*;
    let mut file = std::io::Cursor::new(Vec::new());
    let pixel = |_| (0.5_f32, 0.5_f32, 0.5_f32);
    Image::from_channels((1, 1), SpecificChannels::rgb(pixel)).write().to_buffered(&mut file).unwrap();
    let mut file = file.into_inner();
    for window in [&b"dataWindow\0box2i\0\x10\0\0\0"[..], b"displayWindow\0box2i\0\x10\0\0\0"] {
        let at = file.windows(window.len()).position(|bytes| bytes == window).unwrap() + window.len();
        file[at + 8..at + 12].copy_from_slice(&(width - 1).to_le_bytes());
        file[at + 12..at + 16].copy_from_slice(&(height - 1).to_le_bytes());
    }
    file
}

#[test]
fn giants() {
    let mut jail = Jail::new();
    jail.put("sound.png", png(1, 1, ONE_PIXEL));
    jail.try_file("sound.toml", lit_by("sound.png"), Clean);
    jail.put("sound.exr", exr(1, 1));
    jail.try_file("sound2.toml", lit_by("sound.exr"), Clean);
    for (index, size) in [16_000, 16_384, 16_385, 65_535, 1 << 30].into_iter().enumerate() {
        let short = size.min(65_535) as u16;
        let (unsigned, side) = (size as u32, size);
        for (name, bytes) in [
            ("png", png(unsigned, unsigned, ONE_PIXEL)),
            ("jpg", jpeg(short, short)),
            ("tiff", tiff(unsigned, unsigned)),
            ("exr", exr(side, side)),
            ("hdr", format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {size} +X {size}\n").into_bytes()),
        ] {
            let image = format!("giant{index}.{name}");
            jail.put(&image, bytes);
            // Whether memory is short, or no memory would be enough.
            let fate = if size > 16_384 { Refused } else { TooLarge };
            jail.try_file(&format!("{image}.toml"), lit_by(&image), fate);
        }
    }
    jail.close();
}

#[test]
fn no_images() {
    let mut jail = Jail::new();
    let half = png(2, 2, ONE_PIXEL);
    for (index, bytes) in [
        &b""[..],
        b"\x89PNG",
        b"RIFF\xff\xff\xff\xffWEBPVP8X",
        b"#?RADIANCE\n",
        b"\x76\x2f\x31\x01\x02\0\0\0",
        b"\xff\xd8\xff",
        b"GIF89a",
        b"BM",
        b"<svg xmlns='http://www.w3.org/2000/svg'/>",
        &png(0, 0, ONE_PIXEL),
        &half[..half.len() / 2],
    ]
    .into_iter()
    .enumerate()
    {
        jail.put(&format!("none{index}.png"), bytes);
        jail.try_file(&format!("none{index}.toml"), lit_by(&format!("none{index}.png")), Refused);
    }
    jail.put("half.png", half);
    jail.try_file("half.toml", lit_by("half.png"), Either);
    jail.close();
}
