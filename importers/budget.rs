//! Bytes that a file may still ask for, counted before they are allocated, by all threads.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// What is left.
pub(crate) struct Budget(AtomicU64);

impl Budget {
    /// So many bytes.
    pub fn new(bytes: u64) -> Self {
        Self(AtomicU64::new(bytes))
    }

    /// Takes `bytes`, or nothing where less is left.
    #[must_use]
    pub fn take(&self, bytes: u64) -> bool {
        self.0.fetch_update(Relaxed, Relaxed, |left| left.checked_sub(bytes)).is_ok()
    }
}
