//! `--frames`: which frames are rendered, and the names of their images.

use std::path::{Path, PathBuf};

/// Most frames of one command.
const MOST: usize = 1_000_000;

/// Frames in the order in which they are rendered.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Frames(Vec<i64>);

impl Frames {
    pub fn numbers(&self) -> impl Iterator<Item = i64> {
        self.0.iter().copied()
    }
}

/// `1:10x2,15` are the frames 1, 3, 5, 7, 9 and 15, as in `usdrecord`.
pub(super) fn parse_frames(text: &str) -> Result<Frames, String> {
    let mut frames = Vec::new();
    for part in text.split(',') {
        let (range, step) = part.split_once('x').unwrap_or((part, "1"));
        let (first, last) = range.split_once(':').unwrap_or((range, range));
        let numbers = (first.trim().parse::<i64>(), last.trim().parse::<i64>(), step.trim().parse::<usize>());
        let (Ok(first), Ok(last), Ok(step @ 1..)) = numbers else {
            return Err("give frames as 1:10, 1:10x2 or 1:10x2,15".into());
        };
        let room = MOST - frames.len();
        frames.extend((first..=last).step_by(step).take(room + 1));
        if frames.len() > MOST {
            return Err(format!("more than {MOST} frames"));
        }
    }
    if frames.is_empty() {
        return Err("there are no frames from a number to a smaller one".into());
    }
    Ok(Frames(frames))
}

/// The path with the number of a frame: in place of `####` or `%04d` of the file's name, else before the extension.
pub(super) fn numbered(path: &Path, frame: i64) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let number = |width: usize| format!("{frame:0width$}");
    let named = match place(&name) {
        Some((start, end, width)) => format!("{}{}{}", &name[..start], number(width), &name[end..]),
        None => match name.rsplit_once('.') {
            Some((stem, extension)) => format!("{stem}.{}.{extension}", number(4)),
            None => format!("{name}.{}", number(4)),
        },
    };
    path.with_file_name(named)
}

/// Where a name wants the number, from byte to byte, and with how many digits.
fn place(name: &str) -> Option<(usize, usize, usize)> {
    if let Some(start) = name.find('#') {
        let width = name[start..].bytes().take_while(|&byte| byte == b'#').count();
        return Some((start, start + width, width));
    }
    let start = name.find('%')?;
    let digits = name[start + 1..].split_once('d')?.0;
    let width = if digits.is_empty() { 0 } else { digits.parse().ok().filter(|width| *width <= 20)? };
    Some((start, start + digits.len() + 2, width))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_ranges_with_steps() {
        let frames = |text| parse_frames(text).map(|frames| frames.numbers().collect::<Vec<_>>());
        assert_eq!(frames("7"), Ok(vec![7]));
        assert_eq!(frames("1:10x3,15"), Ok(vec![1, 4, 7, 10, 15]));
        assert_eq!(frames("-2:0"), Ok(vec![-2, -1, 0]));
        for bad in ["", "a", "1:", "1:5x0", "5:1", "1:9000000000000", "1.5"] {
            assert!(frames(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn images_are_numbered() {
        let named = |name: &str| numbered(Path::new(name), 7).to_string_lossy().into_owned();
        assert_eq!(named("out.####.exr"), "out.0007.exr");
        assert_eq!(named("a#b/out.##.exr"), "a#b/out.07.exr");
        assert_eq!(named("out_%03d.exr"), "out_007.exr");
        assert_eq!(named("out%d.exr"), "out7.exr");
        assert_eq!(named("50%/out.exr"), "50%/out.0007.exr");
        assert_eq!(named("out"), "out.0007");
    }
}
