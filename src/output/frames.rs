//! File names of sequences: `out.####.exr` and `out.%04d.exr`, as compositors and `printf` write them.

use std::path::{Path, PathBuf};

/// The file of `frame` for a template whose file name holds a run of `#` (as many digits, at least) or `%d`, `%4d`,
/// `%04d` (`printf`'s meaning; all pad with zeros, for a file name with blanks helps nobody). Every such place is
/// filled. `None` when the name holds none: then all frames would share one file.
pub fn frame_path(template: &Path, frame: i32) -> Option<PathBuf> {
    let name = template.file_name()?.to_str()?;
    let mut filled = String::new();
    let mut rest = name;
    let mut found = false;
    while let Some(start) = rest.find(['#', '%']) {
        let (before, pattern) = rest.split_at(start);
        filled.push_str(before);
        let length = match pattern_at(pattern) {
            Some((length, digits)) => {
                filled.push_str(&format!("{frame:0digits$}"));
                found = true;
                length
            }
            None => {
                filled.push('%');
                1
            }
        };
        rest = pattern.get(length..).unwrap_or_default();
    }
    filled.push_str(rest);
    found.then(|| template.with_file_name(filled))
}

/// Length in bytes and digits of the pattern that `text` starts with.
fn pattern_at(text: &str) -> Option<(usize, usize)> {
    let hashes = text.bytes().take_while(|&byte| byte == b'#').count();
    if hashes > 0 {
        return Some((hashes, hashes));
    }
    let width = text.get(1..)?.bytes().take_while(u8::is_ascii_digit).count();
    let number = text.get(1..1 + width)?;
    let digits = if number.is_empty() { 0 } else { number.parse().ok().filter(|&digits| digits <= 32)? };
    text.get(1 + width..)?.starts_with('d').then_some((width + 2, digits))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn filled(template: &str, frame: i32) -> Option<String> {
        frame_path(Path::new(template), frame).map(|path| path.to_string_lossy().into_owned())
    }

    #[test]
    fn patterns_are_filled() {
        assert_eq!(filled("a/out.####.exr", 7).as_deref(), Some("a/out.0007.exr"));
        assert_eq!(filled("out.%04d.exr", 12).as_deref(), Some("out.0012.exr"));
        assert_eq!(filled("out_%d.png", 12).as_deref(), Some("out_12.png"));
        assert_eq!(filled("out.##.exr", 12345).as_deref(), Some("out.12345.exr"));
        assert_eq!(filled("out.%04d.exr", -1).as_deref(), Some("out.-001.exr"));
        assert_eq!(filled("é50%_##.exr", 3).as_deref(), Some("é50%_03.exr"));
    }

    #[test]
    fn names_without_pattern_are_told() {
        for template in ["out.exr", "a##/out.exr", "100%.exr", "%s.exr", "%99999999999d.exr", "%", ""] {
            assert_eq!(filled(template, 1), None, "{template}");
        }
    }
}
