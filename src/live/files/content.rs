//! What a file holds, as far as it matters whether it is the same as before.

use std::{
    fs::{File, Metadata},
    path::Path,
    time::{Duration, SystemTime},
};

/// Resolution of the clocks of most file systems, which is that of the kernel, with room to spare.
const CLOCK: Duration = Duration::from_millis(15);
/// Of the coarsest, FAT.
const COARSE_CLOCK: Duration = Duration::from_secs(2);

/// What a file holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Content {
    /// Not the same as anything.
    Unknown,
    /// There is no file, or none that can be read.
    Missing,
    /// No bytes.
    Empty,
    /// Bytes of this hash.
    Bytes(blake3::Hash),
}

impl Content {
    pub fn of(path: &Path) -> Self {
        read(path).unwrap_or(Self::Missing)
    }

    /// Whether there is nothing to read.
    pub fn is_empty(&self) -> bool {
        matches!(self, Self::Missing | Self::Empty)
    }
}

fn read(path: &Path) -> Option<Content> {
    // Opening a pipe would wait for who writes to it.
    if !path.metadata().ok()?.is_file() {
        return None;
    }
    let mut hasher = blake3::Hasher::new();
    hasher.update_reader(File::open(path).ok()?).ok()?;
    Some(if hasher.count() == 0 { Content::Empty } else { Content::Bytes(hasher.finalize()) })
}

/// What tells without reading that a file may have changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Stamp {
    modified: Option<SystemTime>,
    /// When it got its name, content or owner: files that are moved keep the time of their content.
    placed: Option<SystemTime>,
    bytes: u64,
    number: u64,
}

impl Stamp {
    /// That of a file that is there.
    pub fn of(path: &Path) -> Option<Self> {
        let data = path.metadata().ok().filter(Metadata::is_file)?;
        let (placed, number) = entry(&data);
        Some(Self { modified: data.modified().ok(), placed, bytes: data.len(), number })
    }

    /// Whether it may have been written, or put there, since then.
    pub fn is_since(&self, time: SystemTime) -> bool {
        [self.modified, self.placed].into_iter().flatten().any(|then| then > time - CLOCK)
    }

    /// Whether another change now could leave the same stamp.
    pub fn is_recent(&self) -> bool {
        self.is_since(SystemTime::now() - COARSE_CLOCK)
    }
}

/// When the entry of the file changed last, and its number.
#[cfg(unix)]
fn entry(data: &Metadata) -> (Option<SystemTime>, u64) {
    use std::os::unix::fs::MetadataExt;
    let [seconds, nanos] = [data.ctime(), data.ctime_nsec()].map(|n| u64::try_from(n).unwrap_or(0));
    let changed =
        SystemTime::UNIX_EPOCH.checked_add(Duration::from_secs(seconds) + Duration::from_nanos(nanos));
    (changed, data.ino())
}

#[cfg(not(unix))]
fn entry(_data: &Metadata) -> (Option<SystemTime>, u64) {
    (None, 0)
}
