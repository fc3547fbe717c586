//! Previews decode to the codes that the curves promise.

#![allow(clippy::unwrap_used, reason = "a failing test panics")]

use std::{fs, io::Cursor, path::Path};

use ajar_output::{OutputError, ToneMap, write_png};
use png::{ColorType, Decoder};

fn decode(path: &Path) -> (png::OutputInfo, Vec<u8>, bool) {
    let mut reader = Decoder::new(Cursor::new(fs::read(path).unwrap())).read_info().unwrap();
    let mut codes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut codes).unwrap();
    (info, codes, reader.info().srgb.is_some())
}

#[test]
fn codes_are_srgb_after_exposure() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.png");
    let rgb = [0.0, 0.09, 0.25, 0.5, 7.0, -1.0];
    write_png(&path, &rgb, None, 2, 1, ToneMap::Srgb, 1.0).unwrap();
    let (info, codes, srgb) = decode(&path);
    assert_eq!((info.width, info.height, info.color_type), (2, 1, ColorType::Rgb));
    assert!(srgb, "the colour space is declared");
    assert_eq!(codes, [0, 118, 188, 255, 255, 0]);
}

#[test]
fn premultiplied_colour_is_stored_straight() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.png");
    let rgb = [0.09, 0.09, 0.09, 0.3, 0.3, 0.3];
    write_png(&path, &rgb, Some(&[0.5, 0.0]), 1, 2, ToneMap::Srgb, 0.0).unwrap();
    let (info, codes, _) = decode(&path);
    assert_eq!(info.color_type, ColorType::Rgba);
    assert_eq!(codes, [118, 118, 118, 128, 0, 0, 0, 0]);
}

#[test]
fn the_tone_map_is_used() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.png");
    write_png(&path, &[0.18; 3], None, 1, 1, ToneMap::Neutral, 0.0).unwrap();
    // 0.14 of white.
    assert_eq!(decode(&path).1, [105; 3]);
}

#[test]
fn broken_pixels_are_refused_and_the_old_file_stays() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.png");
    fs::write(&path, "old").unwrap();
    let mut rgb = [0.0; 12];
    rgb[10] = f32::INFINITY;
    let error = write_png(&path, &rgb, None, 2, 2, ToneMap::Agx, 0.0).unwrap_err();
    assert!(matches!(error, OutputError::NonFinite { x: 1, y: 1, .. }), "{error}");
    let error = write_png(&path, &rgb[..9], None, 2, 2, ToneMap::Agx, 0.0).unwrap_err();
    assert!(matches!(error, OutputError::SampleCount { found: 9, expected: 12, .. }), "{error}");
    let error = write_png(&path, &rgb, Some(&[1.0]), 2, 2, ToneMap::Agx, 0.0).unwrap_err();
    assert!(matches!(error, OutputError::NonFinite { .. } | OutputError::SampleCount { .. }), "{error}");
    assert!(matches!(write_png(&path, &[], None, 0, 2, ToneMap::Agx, 0.0), Err(OutputError::Size { .. })));
    assert_eq!(fs::read_to_string(&path).unwrap(), "old");
}
