//! What is going on, for terminals and pages.

use ajar_integrators::Window;
use ajar_scene::Diagnostic;
use serde::Serialize;

use crate::{
    plan::{Plan, fraction, time_left},
    session::Status,
};

/// What the program does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Phase {
    /// Reading and preparing the scene.
    #[default]
    Loading,
    /// Rendering.
    Rendering,
    /// The image is as good as it is asked to be.
    Done,
    /// Somebody stopped the render.
    Stopped,
    /// There is no scene that could be rendered yet.
    Waiting,
}

/// What is going on.
#[derive(Clone, Debug, Default, Serialize)]
pub struct State {
    /// The file.
    pub scene: String,
    /// What the program does.
    pub phase: Phase,
    /// Number of the image: each change makes a new one.
    pub image: u64,
    /// Names of what changed last.
    pub changed: Vec<String>,
    /// Names of all that changed since the image that is shown.
    #[serde(skip)]
    pub(super) waiting: Vec<String>,
    /// Names of what changed for the image that is shown.
    pub shown_for: Vec<String>,
    /// Why the last change is not shown.
    pub errors: Vec<Diagnostic>,
    /// Full frame, pixels.
    pub size: [u32; 2],
    /// The part that is rendered: left, top, right, bottom.
    pub window: [u32; 4],
    /// Finished rounds.
    pub rounds: u64,
    /// Eye samples a pixel; where no round is finished yet, those of the eye paths that are shown until then.
    pub samples: u64,
    /// Seconds since the first round began.
    pub seconds: f64,
    /// Seconds until a rule holds, where that can be told.
    pub seconds_left: Option<f64>,
    /// How much of the render is done, 0 to 1.
    pub done: f64,
    /// Relative standard error of the typical pixel.
    pub noise: Option<f64>,
    /// Of the typical pixel in the worst tile.
    pub worst_tile: Option<f64>,
    /// Contributions of light left out because they were negative or not finite.
    pub rejected: u64,
    /// Images of before that can be compared with, the oldest first.
    pub snapshots: Vec<Label>,
    /// What pages changed, as a scene file.
    pub edits: String,
    /// Whether everything is shown as if made of clay.
    pub is_clay: bool,
    /// The file that these are saved to, as they are.
    pub saved: Option<String>,
    /// Options of the command line that this file cannot say.
    pub saved_without: Vec<String>,
}

/// An image of before.
#[derive(Clone, Debug, Serialize)]
pub struct Label {
    /// Its number.
    pub image: u64,
    /// What had changed for it.
    pub changed: Vec<String>,
    /// Eye samples a pixel.
    pub samples: u64,
}

impl State {
    /// Something changed.
    pub(super) fn note(&mut self, names: impl IntoIterator<Item = String>) {
        self.changed = names.into_iter().collect();
        for name in &self.changed {
            if !self.waiting.contains(name) {
                self.waiting.push(name.clone());
            }
        }
    }

    pub(super) fn plan(&mut self, plan: &Plan) {
        let Window { x0, y0, x1, y1 } = plan.settings.window;
        (self.size, self.window) = (plan.size, [x0, y0, x1, y1]);
    }

    pub(super) fn status(&mut self, status: &Status, plan: &Plan) {
        let done = fraction(status, &plan.rules);
        (self.rounds, self.samples, self.done) = (status.rounds, status.samples, done);
        self.seconds = status.elapsed.as_secs_f64();
        self.seconds_left = time_left(status, done).map(|left| left.as_secs_f64());
        self.rejected = status.rejected;
        self.noise = status.noise.map(|noise| noise.typical);
        self.worst_tile = status.noise.map(|noise| noise.worst_tile);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_that_changed_since_an_image_is_kept() {
        let mut state = State::default();
        for names in [&["a.obj"][..], &["look.toml", "a.obj"], &["clay"]] {
            state.note(names.iter().map(|name| (*name).to_owned()));
        }
        assert_eq!(state.changed, ["clay"]);
        assert_eq!(state.waiting, ["a.obj", "look.toml", "clay"]);
    }
}
