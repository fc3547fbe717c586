//! Statistics for those who compare images, as attributes: docs/image-statistics.md defines them for other programs.
//!
//! The type is OpenEXR's `floatvector` ("Standard Attributes"): little-endian 32-bit floats without a count.

use exr::meta::attribute::{AttributeValue, Text};

use crate::metadata::text;

/// Estimated variances of the means of all blocks of one side.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockVariances {
    /// Side in pixels, from the top left of the data window; the whole image for `None`.
    pub side: Option<u32>,
    /// R, G and B of every block, rows from the top; units of the pixels, squared.
    pub values: Vec<f32>,
}

impl BlockVariances {
    pub(crate) fn attribute(&self) -> (Text, AttributeValue) {
        let name =
            self.side.map_or_else(|| "ajar:imageVariance".into(), |side| format!("ajar:blockVariance{side}"));
        let bytes = self.values.iter().flat_map(|value| value.to_le_bytes()).collect();
        (text(&name), AttributeValue::Custom { kind: text("floatvector"), bytes })
    }
}
