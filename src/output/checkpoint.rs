//! Files that hold a render so far: a film's integers, planes of floats, and a text that says what they are of.
//!
//! Layout, all numbers little-endian: the eight bytes `AJARFILM`, `u32` version; `u64` length and bytes of the text;
//! `u32` width, `u32` height, `i32` binary logarithm of the unit, `u64` rounds, `u64` rejected deposits; the sums as
//! `i128` in the order of [`Film::sums`]; `u64` count and values of the floats as `f32`; the BLAKE3 hash of all that.
//! Readers believe no length that the file is too short for.

use std::{
    fs::File,
    io::{self, BufWriter, Read, Write},
    path::Path,
};

use ajar_render::film::{Film, FilmState};

use crate::{OutputError, write_atomically};

const MAGIC: &[u8; 8] = b"AJARFILM";
const VERSION: u32 = 1;

/// A render so far.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint {
    /// What it is of, in words of the program.
    pub text: String,
    /// The sum of its rounds; with blocks.
    pub film: Film,
    /// Numbers beside it.
    pub floats: Vec<f32>,
}

/// Why a file is no checkpoint.
#[derive(Debug, thiserror::Error)]
pub enum CheckpointError {
    /// The file system refused.
    #[error("cannot read: {0}")]
    Read(#[from] io::Error),
    /// Other bytes at its beginning.
    #[error("not a checkpoint")]
    Foreign,
    /// Of another version of the format.
    #[error("a checkpoint of version {0}, this program reads version {VERSION}")]
    Version(u32),
    /// Bytes are missing or not as they were written.
    #[error("damaged: it is cut off, or its bytes are not those that were written")]
    Damaged,
}

/// Writes a checkpoint; a reader finds the old file or the new one.
///
/// # Errors
/// The file cannot be written, or `film` keeps no blocks.
pub fn write_checkpoint(path: &Path, text: &str, film: &Film, floats: &[f32]) -> Result<(), OutputError> {
    write_atomically(path, |file| {
        let mut out = BufWriter::new(Hashing { file, hasher: blake3::Hasher::new() });
        fill(&mut out, text, film, floats)?;
        let Hashing { file, hasher } = out.into_inner().map_err(io::IntoInnerError::into_error)?;
        file.write_all(hasher.finalize().as_bytes())
    })
}

fn fill(out: &mut impl Write, text: &str, film: &Film, floats: &[f32]) -> io::Result<()> {
    let state = film.state().ok_or(io::ErrorKind::InvalidInput)?;
    out.write_all(MAGIC)?;
    out.write_all(&VERSION.to_le_bytes())?;
    out.write_all(&(text.len() as u64).to_le_bytes())?;
    out.write_all(text.as_bytes())?;
    out.write_all(&state.width.to_le_bytes())?;
    out.write_all(&state.height.to_le_bytes())?;
    out.write_all(&state.unit_bits.to_le_bytes())?;
    out.write_all(&state.rounds.to_le_bytes())?;
    out.write_all(&state.rejected.to_le_bytes())?;
    film.sums().try_for_each(|sum| out.write_all(&sum.to_le_bytes()))?;
    out.write_all(&(floats.len() as u64).to_le_bytes())?;
    floats.iter().try_for_each(|value| out.write_all(&value.to_le_bytes()))
}

/// Hashes what it passes on.
struct Hashing<'a> {
    file: &'a mut dyn Write,
    hasher: blake3::Hasher,
}

impl Write for Hashing<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.file.write(bytes)?;
        self.hasher.update(bytes.get(..written).unwrap_or(bytes));
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// Reads a checkpoint.
///
/// # Errors
/// The file cannot be read or is not one.
pub fn read_checkpoint(path: &Path) -> Result<Checkpoint, CheckpointError> {
    let mut file = File::open(path)?;
    // Whatever else it is, it is not read to its end.
    let mut magic = Vec::new();
    Read::take(&mut file, MAGIC.len() as u64).read_to_end(&mut magic)?;
    if magic != MAGIC {
        return Err(CheckpointError::Foreign);
    }
    let mut bytes = magic;
    file.read_to_end(&mut bytes)?;
    parse(&bytes)
}

fn parse(bytes: &[u8]) -> Result<Checkpoint, CheckpointError> {
    let mut rest = bytes.get(MAGIC.len()..).unwrap_or_default();
    let version = number(&mut rest).map(u32::from_le_bytes).ok_or(CheckpointError::Damaged)?;
    if version != VERSION {
        return Err(CheckpointError::Version(version));
    }
    let (content, hash) = rest.split_last_chunk::<{ blake3::OUT_LEN }>().ok_or(CheckpointError::Damaged)?;
    let hashed = bytes.get(..bytes.len() - hash.len()).unwrap_or_default();
    if blake3::hash(hashed) != *hash {
        return Err(CheckpointError::Damaged);
    }
    sections(content).ok_or(CheckpointError::Damaged)
}

fn sections(mut rest: &[u8]) -> Option<Checkpoint> {
    let rest = &mut rest;
    let length = number(rest).map(u64::from_le_bytes)?;
    let text = std::str::from_utf8(split(rest, length, 1)?).ok()?.to_owned();
    let state = FilmState {
        width: number(rest).map(u32::from_le_bytes)?,
        height: number(rest).map(u32::from_le_bytes)?,
        unit_bits: number(rest).map(i32::from_le_bytes)?,
        rounds: number(rest).map(u64::from_le_bytes)?,
        rejected: number(rest).map(u64::from_le_bytes)?,
    };
    let (sums, _) = split(rest, state.sums()? as u64, 16)?.as_chunks();
    let film = Film::restore(state, sums.iter().copied().map(i128::from_le_bytes).collect())?;
    let count = number(rest).map(u64::from_le_bytes)?;
    let (floats, _) = split(rest, count, 4)?.as_chunks();
    let floats = floats.iter().copied().map(f32::from_le_bytes).collect();
    rest.is_empty().then_some(Checkpoint { text, film, floats })
}

/// Takes the bytes of a number.
fn number<const N: usize>(rest: &mut &[u8]) -> Option<[u8; N]> {
    let (number, behind) = rest.split_first_chunk()?;
    *rest = behind;
    Some(*number)
}

/// Takes `count` elements of `size` bytes, if there are so many.
fn split<'a>(rest: &mut &'a [u8], count: u64, size: usize) -> Option<&'a [u8]> {
    let length = usize::try_from(count).ok()?.checked_mul(size)?;
    let (taken, behind) = rest.split_at_checked(length)?;
    *rest = behind;
    Some(taken)
}
