//! Files that something happened to, until they are still.

use std::{
    collections::BTreeSet,
    path::PathBuf,
    time::{Duration, Instant},
};

/// A burst of changes is over when nothing happens for this long.
const QUIET: Duration = Duration::from_millis(60);
/// However busy, it is looked at after this.
const LONGEST: Duration = Duration::from_millis(500);

#[derive(Debug, Default)]
pub(super) struct Pending {
    paths: BTreeSet<PathBuf>,
    /// When the first and the last thing happened.
    since: Option<(Instant, Instant)>,
}

impl Pending {
    pub fn add(&mut self, path: PathBuf) {
        self.paths.insert(path);
        self.touch();
    }

    pub fn paths(&self) -> impl Iterator<Item = &PathBuf> {
        self.paths.iter()
    }

    /// When they are to be looked at.
    pub fn due(&self) -> Option<Instant> {
        self.since.map(|(first, last)| (last + QUIET).min(first + LONGEST))
    }

    pub fn is_still(&self) -> bool {
        self.due().is_some_and(|due| Instant::now() >= due)
    }

    /// Gives them a little more time; `false` if they had enough.
    pub fn wait_longer(&mut self) -> bool {
        let has_time = self.since.is_some_and(|(first, _)| Instant::now() < first + LONGEST);
        if has_time {
            self.touch();
        }
        has_time
    }

    pub fn clear(&mut self) {
        *self = Self::default();
    }

    fn touch(&mut self) {
        let now = Instant::now();
        self.since = Some((self.since.map_or(now, |(first, _)| first), now));
    }
}
