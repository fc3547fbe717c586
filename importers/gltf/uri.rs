//! References to bytes: base64 in `data:` URIs (RFC 2397) and percent-encoded relative paths (RFC 3986).

use std::path::{Path, PathBuf};

use ajar_scene::Diagnostic;
use base64::{
    Engine,
    engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig},
};

use super::Context;
use crate::files;

/// Takes base64 with and without padding: both occur.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &base64::alphabet::STANDARD,
    GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true),
);

/// The bytes of a `data:` URI; `None` for any other URI.
pub(super) fn data(uri: &str, context: &mut Context, element: &str) -> Result<Option<Vec<u8>>, Diagnostic> {
    let Some(body) = uri.get(..5).filter(|scheme| scheme.eq_ignore_ascii_case("data:")).and(uri.get(5..))
    else {
        return Ok(None);
    };
    let broken = |why: &str| Diagnostic::error(format!("the data URI {why}")).element(element);
    let (header, text) = body.split_once(',').ok_or_else(|| broken("has no comma"))?;
    if !header.to_ascii_lowercase().ends_with(";base64") {
        return Err(broken("is not base64"));
    }
    context.charge(text.len() as u64, element)?;
    BASE64.decode(text).map(Some).map_err(|e| broken(&format!("is not base64: {e}")))
}

/// The file that a URI means; it is listed for watch mode also when it cannot be read.
pub(super) fn file(uri: &str, context: &mut Context, element: &str) -> Result<PathBuf, Diagnostic> {
    let reference = percent_decoded(uri);
    match context.request.resolve(&reference) {
        Ok(path) => {
            context.files.push(path.clone());
            Ok(path)
        }
        Err(error) => {
            let relative = Path::new(&reference).is_relative() && !reference.contains(':');
            if relative && !reference.is_empty() && !reference.contains('\0') {
                context.files.push(context.request.folder().join(&reference));
            }
            Err(error.element(element))
        }
    }
}

/// Reads a regular file whole, counted before it is read.
pub(super) fn read_file(path: &Path, context: &mut Context, element: &str) -> Result<Vec<u8>, Diagnostic> {
    let size = files::size(path).map_err(|e| e.element(element))?;
    context.charge(size, element)?;
    files::read(path, size).map_err(|e| e.element(element))
}

/// Percent-encoded bytes decoded; what is not such a code or not UTF-8 stays as it is.
fn percent_decoded(uri: &str) -> String {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let Some((&first, after)) = rest.split_first() {
        let is_code = |code: &&[u8]| first == b'%' && code.iter().all(u8::is_ascii_hexdigit);
        let code = after.get(..2).filter(is_code).and_then(|hex| std::str::from_utf8(hex).ok());
        match code.and_then(|hex| u8::from_str_radix(hex, 16).ok()) {
            Some(byte) => {
                bytes.push(byte);
                rest = after.get(2..).unwrap_or_default();
            }
            None => {
                bytes.push(first);
                rest = after;
            }
        }
    }
    String::from_utf8(bytes).unwrap_or_else(|_| uri.to_string())
}

#[cfg(test)]
mod tests {
    use super::percent_decoded;

    #[test]
    fn percent_codes_are_decoded_and_stray_signs_kept() {
        assert_eq!(percent_decoded("a%20b%C3%A4.bin"), "a bä.bin");
        assert_eq!(percent_decoded("100%.bin%"), "100%.bin%");
        assert_eq!(percent_decoded("%zz%+1%41"), "%zz%+1A");
        assert_eq!(percent_decoded("%FF.bin"), "%FF.bin");
    }
}
