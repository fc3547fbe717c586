//! Images of before, as many as memory is set aside for.

use std::sync::{Arc, Mutex, PoisonError};

use ajar_live::frame::Frame;

use super::state::Label;

/// Most of them.
const MOST: usize = 48;
/// Memory for them, bytes; one there may always be.
const MEMORY: usize = 256 << 20;

#[derive(Default)]
pub(super) struct Snapshots(Mutex<Vec<(Label, Arc<Frame>)>>);

impl Snapshots {
    /// Adds one, in place of the oldest where there is no room.
    pub fn add(&self, label: Label, frame: Arc<Frame>) {
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        all.push((label, frame));
        let bytes = |all: &[(Label, Arc<Frame>)]| all.iter().map(|(_, frame)| frame.bytes()).sum::<usize>();
        while all.len() > 1 && (all.len() > MOST || bytes(&all) > MEMORY) {
            all.remove(0);
        }
    }

    pub fn labels(&self) -> Vec<Label> {
        let all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        all.iter().map(|(label, _)| label.clone()).collect()
    }

    pub fn get(&self, image: u64) -> Option<Arc<Frame>> {
        let all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        all.iter().find(|(label, _)| label.image == image).map(|(_, frame)| Arc::clone(frame))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_is_bounded_and_the_newest_stay() {
        let snapshots = Snapshots::default();
        let frame = Arc::new(Frame::new(2048, 2048, &[], None));
        for image in 0..100 {
            snapshots.add(Label { image, changed: Vec::new(), samples: 0 }, Arc::clone(&frame));
        }
        let kept: Vec<_> = snapshots.labels().iter().map(|label| label.image).collect();
        assert_eq!(kept.len(), MEMORY / frame.bytes());
        assert_eq!(kept.last(), Some(&99));
        assert!(snapshots.get(99).is_some() && snapshots.get(0).is_none());
    }
}
