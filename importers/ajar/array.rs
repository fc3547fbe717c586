//! Arrays: a range of the binary chunk, or the numbers themselves.

use std::borrow::Cow;

use ajar_scene::{Cause, Diagnostic};
use bytemuck::Pod;
use serde::{Deserialize, Serialize, de::DeserializeOwned};
use serde_json::Value;

use crate::budget::Budget;

/// Part of the binary chunk.
#[derive(Clone, Copy, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Range {
    /// First byte.
    pub offset: u64,
    /// Number of items.
    pub count: u64,
}

/// The binary chunk, and how many bytes may still be copied from it.
pub(super) struct Binary<'a> {
    pub bytes: &'a [u8],
    pub budget: Budget,
}

impl<'a> Binary<'a> {
    /// The items that `given` holds or points to, where they are if they lie there as the processor wants them.
    pub fn array<T: Pod + DeserializeOwned>(
        &self,
        given: Value,
        element: &str,
    ) -> Result<Cow<'a, [T]>, Diagnostic> {
        let wrong = |e: serde_json::Error| {
            Diagnostic::error(format!("{e}; an array or {{\"offset\", \"count\"}} is needed"))
                .element(element)
        };
        if given.is_array() {
            return serde_json::from_value(given).map(Cow::Owned).map_err(wrong);
        }
        let range: Range = serde_json::from_value(given).map_err(wrong)?;
        let size = size_of::<T>() as u64;
        let beyond = || {
            Diagnostic::error(format!(
                "{} items of {size} bytes from byte {} reach beyond the {} bytes of the binary chunk",
                range.count,
                range.offset,
                self.bytes.len()
            ))
            .element(element)
        };
        let length = range.count.checked_mul(size).ok_or_else(beyond)?;
        let end = range.offset.checked_add(length).ok_or_else(beyond)?;
        let part = usize::try_from(range.offset).ok().zip(usize::try_from(end).ok());
        let part = part.and_then(|(start, end)| self.bytes.get(start..end)).ok_or_else(beyond)?;
        if !self.budget.take(length) {
            let error = Diagnostic::error("needs more memory than the limit");
            return Err(error.because(Cause::Resource).element(element));
        }
        let copied = |_| Cow::Owned(bytemuck::pod_collect_to_vec(part));
        Ok(bytemuck::try_cast_slice(part).map_or_else(copied, Cow::Borrowed))
    }
}
