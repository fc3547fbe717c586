//! Movements of a pointer: changes of the same thing, each soon after the one before, are one.

use std::time::{Duration, Instant};

/// How soon.
const PAUSE: Duration = Duration::from_millis(1500);

#[derive(Debug, Default)]
pub(super) struct Gesture {
    /// What changed last, and when.
    last: Option<(String, Instant)>,
    /// Whether all changes since the image that is shown go on with the movement that it is of; `None` where there are none.
    goes_on: Option<bool>,
}

impl Gesture {
    /// A page changed this.
    pub fn step(&mut self, what: &str, at: Instant) {
        let is_same =
            |(last, then): &(String, Instant)| last == what && at.saturating_duration_since(*then) < PAUSE;
        let follows = self.last.as_ref().is_some_and(is_same);
        self.goes_on = Some(follows && self.goes_on != Some(false));
        self.last = Some((what.to_owned(), at));
    }

    /// Something else changed.
    pub fn end(&mut self) {
        *self = Self { last: None, goes_on: Some(false) };
    }

    /// Asked once a new image is to be shown: whether the one before is of a movement that has gone on.
    pub fn has_moved_on(&mut self) -> bool {
        self.goes_on.take().unwrap_or(false)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_a_movement_only_the_end_is_kept() {
        let (mut gesture, start) = (Gesture::default(), Instant::now());
        let at = |millis| start + Duration::from_millis(millis);
        // The image before the movement is no step of it, however many steps come before the next image.
        gesture.step("camera", at(0));
        gesture.step("camera", at(100));
        assert!(!gesture.has_moved_on());
        gesture.step("camera", at(1000));
        assert!(gesture.has_moved_on());
        gesture.step("camera", at(4000));
        assert!(!gesture.has_moved_on(), "a pause ends it");
        gesture.step("lamp intensity", at(4100));
        assert!(!gesture.has_moved_on(), "another thing is another movement");
        gesture.step("lamp intensity", at(4200));
        gesture.end();
        assert!(!gesture.has_moved_on(), "a file changed too");
        gesture.step("lamp intensity", at(4300));
        assert!(!gesture.has_moved_on(), "the image is of that file");
    }
}
