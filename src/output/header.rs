//! The order of attributes in an EXR header.
//!
//! The encoder keeps custom attributes in a hash map, so equal pictures would give different bytes. OpenEXR's own
//! library writes attributes sorted by name; so do we. Moving attributes changes no length, hence no chunk offset.
//! Layout: magic and version (4 + 4 bytes), then `name\0 type\0 i32-size value` until an empty name ("OpenEXR File
//! Layout", openexr.com).

/// Sorts the attributes of the single-part file in `file` by name; `None` when it is not such a file.
pub(crate) fn sort_attributes(file: &mut [u8]) -> Option<()> {
    const PREAMBLE: usize = 8;
    let mut rest = file.get(PREAMBLE..)?;
    let mut attributes = Vec::new();
    while *rest.first()? != 0 {
        let (attribute, behind) = rest.split_at_checked(attribute_length(rest)?)?;
        attributes.push(attribute);
        rest = behind;
    }
    attributes.sort_by_key(|attribute| attribute.split(|&byte| byte == 0).next());
    let sorted = attributes.concat();
    file.get_mut(PREAMBLE..PREAMBLE + sorted.len())?.copy_from_slice(&sorted);
    Some(())
}

fn attribute_length(bytes: &[u8]) -> Option<usize> {
    let text_end = |from: usize| {
        let length = bytes.get(from..)?.iter().position(|&byte| byte == 0)?;
        Some(from + length + 1)
    };
    let size_at = text_end(text_end(0)?)?;
    let size = i32::from_le_bytes(bytes.get(size_at..size_at + 4)?.try_into().ok()?);
    Some(size_at + 4 + usize::try_from(size).ok()?)
}
