//! `--frames`: which frames of an animation to render, and the file of each.

use std::path::{Path, PathBuf};

use ajar_output::frame_path;
use ajar_scene::{Cause, Diagnostic};

/// Longer lists are mistakes.
const MOST: usize = 100_000;

/// Frames in the order in which they are rendered, each once.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Frames(pub Vec<i32>);

/// Reads `1:10x2,15`: frames and ranges `FIRST:LAST`, which `xSTEP` thins out.
pub(super) fn parse_frames(text: &str) -> Result<Frames, String> {
    let wrong = || "give frames and ranges, with a step if need be: 1:10x2,15".to_string();
    let mut frames = Vec::new();
    for part in text.split(',') {
        let (range, step) = match part.split_once('x') {
            Some((range, step)) => (range, step.trim().parse().map_err(|_| wrong())?),
            None => (part, 1i32),
        };
        let (first, last) = range.split_once(':').unwrap_or((range, range));
        let [first, last]: [i32; 2] = match [first, last].map(|end| end.trim().parse()) {
            [Ok(first), Ok(last)] if step > 0 => [first, last],
            _ => return Err(wrong()),
        };
        // Backwards where the range says so.
        let length = i64::from(last) - i64::from(first);
        let count = length.unsigned_abs() / u64::from(step.unsigned_abs()) + 1;
        if count > (MOST - frames.len()) as u64 {
            return Err(format!("these are more than {MOST} frames"));
        }
        frames.extend(
            (0..count as i64).map(|i| (i64::from(first) + length.signum() * i * i64::from(step)) as i32),
        );
    }
    let mut met = std::collections::HashSet::new();
    frames.retain(|frame| met.insert(*frame));
    Ok(Frames(frames))
}

/// The file of a frame of several: all need one of their own.
///
/// # Errors
/// The name has no place for the number.
pub(super) fn place(template: &Path, frame: i32) -> Result<PathBuf, Diagnostic> {
    frame_path(template, frame).ok_or_else(|| {
        let message = format!("all frames would be written to {}", template.display());
        Diagnostic::error(message)
            .because(Cause::Usage)
            .hint("give the number a place in the name: -o out.####.exr or -o out.%04d.exr")
    })
}

/// The name for frames where none is given.
pub(super) fn default_template(exr: &Path) -> PathBuf {
    exr.with_extension("####.exr")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_and_ranges() {
        let frames = |text: &str| parse_frames(text).map(|frames| frames.0);
        assert_eq!(frames("1:10x2,15"), Ok(vec![1, 3, 5, 7, 9, 15]));
        assert_eq!(frames("7"), Ok(vec![7]));
        assert_eq!(frames("3:1,2,-1"), Ok(vec![3, 2, 1, -1]));
        assert_eq!(frames(" -2 : 2 x 3"), Ok(vec![-2, 1]));
        for bad in ["", "a", "1:", ":3", "1:5x0", "1:5x-1", "1,,2", "1.5", "1:2:3", "0:2147483647"] {
            assert!(parse_frames(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn each_frame_has_a_file() {
        assert_eq!(place(Path::new("a.####.exr"), 7).unwrap(), Path::new("a.0007.exr"));
        assert_eq!(place(&default_template(Path::new("chair.exr")), 7).unwrap(), Path::new("chair.0007.exr"));
        assert_eq!(place(Path::new("a.exr"), 7).unwrap_err().cause, Cause::Usage);
    }
}
