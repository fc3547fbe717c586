//! OpenEXR files: RGB, RGBA, luminance or a single channel of any name, placed in the display window.

use std::io::{BufRead, Read, Seek};

use exr::{
    meta::MetaData,
    prelude::{AnyChannel, FlatSamples, ReadChannels, ReadLayers, SampleType, read},
};
use half::f16;

use super::{Bitmap, Texels, decode::Header};

/// Whether a file that begins with `head` is OpenEXR.
pub(super) fn is_exr(head: &[u8]) -> bool {
    head.starts_with(&[0x76, 0x2f, 0x31, 0x01])
}

/// Size of the display window and memory of the largest layer.
pub(super) fn header(input: impl BufRead) -> Result<Header, String> {
    let meta = MetaData::read_from_buffered(input, false).map_err(|e| e.to_string())?;
    let mut found = Header { width: 0, height: 0, bytes: 0 };
    for header in &meta.headers {
        let (display, data) = (header.shared_attributes.display_window.size, header.layer_size);
        found.width = found.width.max(display.0).max(data.0);
        found.height = found.height.max(display.1).max(data.1);
        let pixel: u64 = header.channels.list.iter().map(|channel| sample_bytes(channel.sample_type)).sum();
        let area = |size: exr::math::Vec2<usize>| size.0 as u64 * size.1 as u64;
        found.bytes = found.bytes.max(area(display).max(area(data)).saturating_mul(pixel));
    }
    Ok(found)
}

fn sample_bytes(kind: SampleType) -> u64 {
    if kind == SampleType::F16 { 2 } else { 4 }
}

/// Reads the first layer; its size has been checked by [`header`].
pub(super) fn load(input: impl Read + Seek) -> Result<Bitmap, String> {
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(input)
        .map_err(|e| e.to_string())?;
    let (display, layer) = (image.attributes.display_window, image.layer_data);
    let channels = chosen(&layer.channel_data.list)?;
    let window = Window {
        size: [display.size.0, display.size.1],
        data_size: [layer.size.0, layer.size.1],
        offset: [
            i64::from(layer.attributes.layer_position.0) - i64::from(display.position.0),
            i64::from(layer.attributes.layer_position.1) - i64::from(display.position.1),
        ],
    };
    let halves: Option<Vec<&[f16]>> = channels
        .iter()
        .map(|samples| if let FlatSamples::F16(v) = samples { Some(v.as_slice()) } else { None })
        .collect();
    let texels = match halves {
        Some(halves) => Texels::F16(window.interleave(&halves)),
        None => {
            let floats: Vec<Vec<f32>> = channels.iter().map(|c| c.values_as_f32().collect()).collect();
            let floats: Vec<&[f32]> = floats.iter().map(Vec::as_slice).collect();
            Texels::F32(window.interleave(&floats))
        }
    };
    Bitmap::new(window.size[0], window.size[1], channels.len(), texels).ok_or_else(|| "has no pixels".into())
}

/// The channels that make a texture, in the order grey or RGB, then alpha.
fn chosen(list: &[AnyChannel<FlatSamples>]) -> Result<Vec<&FlatSamples>, String> {
    let find = |name: &str| list.iter().find(|channel| channel.name.eq(name)).map(|c| &c.sample_data);
    let colors = match (find("R"), find("G"), find("B"), find("Y"), list) {
        (Some(r), Some(g), Some(b), _, _) => vec![r, g, b],
        (_, _, _, Some(y), _) => vec![y],
        (_, _, _, _, [only]) => vec![&only.sample_data],
        _ => {
            let names: Vec<String> =
                list.iter().map(|c| c.name.to_string().escape_debug().to_string()).collect();
            return Err(format!("has no channels R, G, B or Y, only {}", names.join(", ")));
        }
    };
    let alpha = if list.len() > 1 { find("A") } else { None };
    Ok(colors.into_iter().chain(alpha).collect())
}

/// Where the stored pixels lie in the display window, which is what texture coordinates span.
struct Window {
    size: [usize; 2],
    data_size: [usize; 2],
    offset: [i64; 2],
}

impl Window {
    /// Interleaves planes of `data_size` into an image of `size`, transparent black where nothing is stored. A plane
    /// that is too short leaves zeros.
    fn interleave<T: Copy + Default>(&self, planes: &[&[T]]) -> Vec<T> {
        let mut pixels = vec![T::default(); self.size[0] * self.size[1] * planes.len()];
        let inside = |position: usize, axis: usize| {
            usize::try_from(position as i64 - self.offset[axis]).ok().filter(|&i| i < self.data_size[axis])
        };
        for (index, pixel) in pixels.chunks_exact_mut(planes.len()).enumerate() {
            let (x, y) = (inside(index % self.size[0], 0), inside(index / self.size[0], 1));
            let (Some(x), Some(y)) = (x, y) else { continue };
            for (number, plane) in pixel.iter_mut().zip(planes) {
                *number = plane.get(y * self.data_size[0] + x).copied().unwrap_or_default();
            }
        }
        pixels
    }
}
