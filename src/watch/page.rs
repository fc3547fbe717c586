//! What pages ask for, and what they are told besides the state.

use std::sync::{
    Arc,
    atomic::{AtomicUsize, Ordering},
    mpsc::Sender,
};

use ajar_live::{
    frame::Frame,
    server::{Program, Reply},
};
use serde::{Deserialize, Serialize};

use super::{Event, State, draft, snapshots::Snapshots, views::Views};

/// Requests that may wait; a page that sends more is not one of ours.
const MOST_WAITING: usize = 1000;

/// What a page asks for.
#[derive(Clone, Debug, Deserialize)]
#[serde(tag = "do", rename_all = "lowercase", deny_unknown_fields)]
pub(super) enum Request {
    /// Render no further.
    Stop {},
    /// Render further, also beyond what was asked for.
    Continue {},
    /// Begin the image again.
    Restart {},
    /// Render only this part: left, top, right, bottom in pixels; all where none is said.
    Region { pixels: Option<[u32; 4]> },
    /// What is at this pixel?
    Probe { x: u32, y: u32 },
    /// Look from here.
    Camera(View),
    /// Look through the camera of this name.
    Through { camera: String },
    /// Show these variants of an import; none is what the file shows by itself.
    Variants { import: String, variants: Vec<String> },
    /// Change a value.
    Set(draft::Setting),
    /// Show everything as if made of clay, or as it is.
    Clay { show: bool },
    /// Drop all changes that pages made.
    Revert {},
    /// Save them as a layer.
    Save {},
}

/// A place to look from.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct View {
    pub position: [f64; 3],
    pub target: [f64; 3],
    pub up: [f64; 3],
    /// Of an orthographic camera: half of what it sees from top to bottom, metres.
    #[serde(default)]
    pub half_height: Option<f64>,
}

/// The state as pages are told.
#[derive(Serialize)]
pub(super) struct Told<'a> {
    #[serde(rename = "type")]
    pub kind: &'static str,
    #[serde(flatten)]
    pub state: &'a State,
}

/// Hands on what pages want.
pub(super) struct Pages {
    pub events: Sender<Event>,
    pub snapshots: Arc<Snapshots>,
    pub views: Arc<Views>,
    pub waiting: Arc<AtomicUsize>,
}

impl Program for Pages {
    fn command(&self, text: String, reply: Reply) -> bool {
        let Ok(request) = serde_json::from_str(&text) else { return false };
        if self.waiting.fetch_add(1, Ordering::Relaxed) >= MOST_WAITING {
            self.waiting.fetch_sub(1, Ordering::Relaxed);
            // A pointer that moves while a large scene is read asks many times, and will again.
            return matches!(request, Request::Probe { .. });
        }
        self.events.send(Event::Page(request, reply)).is_ok()
    }

    fn image(&self, name: &str) -> Option<Arc<Frame>> {
        name.parse().map_or_else(|_| self.views.get(name), |image| self.snapshots.get(image))
    }
}
