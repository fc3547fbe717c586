//! Cube maps become latitude-longitude images, the one form in which scenes hold surroundings.
//!
//! A face is the picture that one sees from the middle of the cube: that of OpenGL, which is drawn as from outside, flipped
//! left to right, as EXT_lights_image_based asks. PNG files with alpha are RGBD: the colour, sRGB-encoded, is divided by
//! alpha.

use std::{f64::consts::PI, io::Cursor, sync::Arc};

use ajar_scene::Diagnostic;
use glam::{DVec3, Vec3};
use image::{ImageBuffer, ImageFormat, ImageReader, Limits, Rgb};

use crate::{guard, srgb};

/// Texels on the side of a face, at most: the image made of it is four times as wide.
const MOST: u32 = 2048;

/// Where faces lie, in their order in files, and where their upper edges are.
const FACES: [(DVec3, DVec3); 6] = [
    (DVec3::X, DVec3::Y),
    (DVec3::NEG_X, DVec3::Y),
    (DVec3::Y, DVec3::NEG_Z),
    (DVec3::NEG_Y, DVec3::Z),
    (DVec3::Z, DVec3::Y),
    (DVec3::NEG_Z, DVec3::Y),
];

struct Face {
    side: usize,
    texels: Vec<Vec3>,
}

/// Bytes of memory that the faces in these files and the image made of them take, from their headers.
///
/// # Errors
/// A file is no PNG or JPEG, not square, or not of the size of the first.
pub(super) fn cost(files: &[Arc<[u8]>]) -> Result<u64, Diagnostic> {
    let mut sides = Vec::new();
    for file in files {
        let size = guarded(|| open(file)?.into_dimensions().map_err(|e| e.to_string()))?;
        if size.0 != size.1 || size.0 > MOST || sides.first().is_some_and(|&side| side != size.0) {
            let why =
                format!("faces are squares of one size up to {MOST}, one has {} × {} texels", size.0, size.1);
            return Err(Diagnostic::error(why));
        }
        sides.push(size.0);
    }
    let texels = sides.first().map_or(0, |&side| u64::from(side).pow(2));
    // Six faces decoded, and eight times their area as image and as file.
    Ok(texels * (6 + 2 * 8) * size_of::<Vec3>() as u64)
}

/// An OpenEXR file with what the six faces show, four times as wide as one and twice as high. Its centre faces +Z, its left
/// edge is at longitude +π.
///
/// # Errors
/// A face cannot be decoded.
pub(super) fn unrolled(files: &[Arc<[u8]>]) -> Result<Vec<u8>, Diagnostic> {
    let faces = files.iter().map(|file| guarded(|| decode(file))).collect::<Result<Vec<_>, _>>()?;
    let side = faces.first().map_or(0, |face| face.side) as u32;
    let (width, height) = (4 * side, 2 * side);
    let image = ImageBuffer::from_fn(width, height, |column, row| {
        let (x, z) = (2.0 * PI * (0.5 - (f64::from(column) + 0.5) / f64::from(width))).sin_cos();
        let (ring, y) = (PI * (f64::from(row) + 0.5) / f64::from(height)).sin_cos();
        Rgb(seen(&faces, DVec3::new(x * ring, y, z * ring)).to_array())
    });
    let mut file = Cursor::new(Vec::new());
    image.write_to(&mut file, ImageFormat::OpenExr).map_err(|e| Diagnostic::error(e.to_string()))?;
    Ok(file.into_inner())
}

/// What is seen in a direction, bilinear inside the face.
fn seen(faces: &[Face], direction: DVec3) -> Vec3 {
    let nearness = |(forward, _): &(DVec3, DVec3)| direction.dot(*forward);
    let ahead = FACES.iter().enumerate().max_by(|a, b| nearness(a.1).total_cmp(&nearness(b.1)));
    let Some((face, (forward, up))) = ahead.and_then(|(i, place)| Some((faces.get(i)?, place))) else {
        return Vec3::ZERO;
    };
    let far = direction / direction.dot(*forward);
    let last = (face.side - 1) as f64;
    let place = |along: f64| ((along * 0.5 + 0.5) * face.side as f64 - 0.5).clamp(0.0, last);
    let (x, y) = (place(far.dot(forward.cross(*up))), place(-far.dot(*up)));
    let texel = |x: f64, y: f64| face.texels[y.min(last) as usize * face.side + x.min(last) as usize];
    let row = |y: f64| texel(x, y).lerp(texel(x + 1.0, y), x.fract() as f32);
    row(y).lerp(row(y + 1.0), y.fract() as f32)
}

fn open(file: &[u8]) -> Result<ImageReader<Cursor<&[u8]>>, String> {
    let mut reader = ImageReader::new(Cursor::new(file)).with_guessed_format().map_err(|e| e.to_string())?;
    if !matches!(reader.format(), Some(ImageFormat::Png | ImageFormat::Jpeg)) {
        return Err("faces are PNG or JPEG files, one is not".into());
    }
    let mut limits = Limits::default();
    (limits.max_image_width, limits.max_image_height) = (Some(MOST), Some(MOST));
    reader.limits(limits);
    Ok(reader)
}

fn decode(file: &[u8]) -> Result<Face, String> {
    let image = open(file)?.decode().map_err(|e| e.to_string())?.into_rgba32f();
    let texel = |[r, g, b, d]: [f32; 4]| Vec3::from([r, g, b].map(srgb::linear)) / d.max(1.0 / 255.0);
    let side = image.width() as usize;
    Ok(Face { side, texels: image.pixels().map(|pixel| texel(pixel.0)).collect() })
}

/// Runs a decoder. Those of other crates can panic on hostile bytes: that is an error of the image, not of ours.
fn guarded<T>(run: impl FnOnce() -> Result<T, String>) -> Result<T, Diagnostic> {
    guard::catch(run).unwrap_or_else(Err).map_err(Diagnostic::error)
}
