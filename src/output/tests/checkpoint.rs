//! Checkpoints come back as they were, and nothing else is taken for one.

#![expect(clippy::unwrap_used, reason = "a test may fail by panic")]

use std::fs;

use ajar_output::{Checkpoint, CheckpointError, read_checkpoint, write_checkpoint};
use ajar_render::{film::Film, math::Rgb};

fn sample() -> Checkpoint {
    let mut film = Film::new(6, 2.0).with_blocks(3);
    for value in [1.0, 2.0, 0.1] {
        let round = film.round();
        (0..6).for_each(|pixel| round.add(pixel, Rgb::new(value, 0.3 * pixel as f64, 0.0)));
        film.merge(&round, 0.9);
    }
    Checkpoint { text: "a film é".into(), film, floats: vec![0.5, f32::NEG_INFINITY, -0.0] }
}

fn written() -> (tempfile::TempDir, std::path::PathBuf, Vec<u8>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("part.ckpt");
    let Checkpoint { text, film, floats } = sample();
    write_checkpoint(&path, &text, &film, &floats).unwrap();
    let bytes = fs::read(&path).unwrap();
    (folder, path, bytes)
}

#[test]
fn what_is_written_is_read() {
    let (_folder, path, _) = written();
    assert_eq!(read_checkpoint(&path).unwrap(), sample());
}

#[test]
fn every_cut_and_every_changed_byte_is_noticed() {
    let (_folder, path, bytes) = written();
    for length in 0..bytes.len() {
        fs::write(&path, &bytes[..length]).unwrap();
        assert!(read_checkpoint(&path).is_err(), "{length} bytes");
    }
    for at in 0..bytes.len() {
        let mut changed = bytes.clone();
        changed[at] ^= 0x40;
        fs::write(&path, &changed).unwrap();
        let error = read_checkpoint(&path).unwrap_err();
        let expected = match at {
            0..8 => matches!(error, CheckpointError::Foreign),
            8..12 => matches!(error, CheckpointError::Version(_)),
            _ => matches!(error, CheckpointError::Damaged),
        };
        assert!(expected, "byte {at}: {error}");
    }
    fs::write(&path, [bytes.as_slice(), &[0]].concat()).unwrap();
    assert!(matches!(read_checkpoint(&path), Err(CheckpointError::Damaged)));
}

/// Files whose hash is right and whose lengths are lies.
#[test]
fn lengths_are_not_believed() {
    let (_folder, path, bytes) = written();
    let text = sample().text.len();
    let floats = bytes.len() - 32 - 3 * 4 - 8;
    for (at, lie) in [
        (12, u64::MAX.to_le_bytes().as_slice()),
        (12, &(1u64 << 40).to_le_bytes()),
        (20 + text, &u32::MAX.to_le_bytes()),
        (20 + text, &[0; 4]),
        (24 + text, &u32::MAX.to_le_bytes()),
        (28 + text, &i32::MIN.to_le_bytes()),
        (32 + text, &u64::MAX.to_le_bytes()),
        (48 + text, &[0xff; 16]),
        (floats, &u64::MAX.to_le_bytes()),
        (floats, &2u64.to_le_bytes()),
    ] {
        let mut changed = bytes[..bytes.len() - 32].to_vec();
        changed[at..at + lie.len()].copy_from_slice(lie);
        let hash = blake3::hash(&changed);
        changed.extend(hash.as_bytes());
        fs::write(&path, &changed).unwrap();
        assert!(matches!(read_checkpoint(&path), Err(CheckpointError::Damaged)), "{at}: {lie:?}");
    }
}

#[test]
fn other_files_are_foreign() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("image.png");
    for content in ["", "AJAR", "\u{89}PNG and so on"] {
        fs::write(&path, content).unwrap();
        assert!(matches!(read_checkpoint(&path), Err(CheckpointError::Foreign)), "{content}");
    }
    assert!(matches!(read_checkpoint(folder.path()), Err(CheckpointError::Read(_))));
    assert!(matches!(read_checkpoint(&folder.path().join("absent")), Err(CheckpointError::Read(_))));
}
