//! What is rendered, and until when.

use std::time::Duration;

use ajar_integrators::{Integrator, Settings, stop::StopRules};
use ajar_scene::{Cause, Diagnostic};

use crate::session::Status;

/// A render to be made of a world.
#[derive(Clone)]
pub struct Plan {
    /// How.
    pub integrator: &'static dyn Integrator,
    /// Full frame, pixels.
    pub size: [u32; 2],
    /// What else the image depends on.
    pub settings: Settings,
    /// When to stop.
    pub rules: StopRules,
}

/// What a pixel takes at most, from the film to the files: sums and squares of three channels at 16 bytes, a round's at 8,
/// what its eye rays meet, and the picture twice.
const BYTES_A_PIXEL: u64 = 256;
/// What an image may take however low the limit is: one for geometry and textures is not meant to forbid pictures.
const ALWAYS: u64 = 1 << 30;

impl Plan {
    /// Checks that the image takes no more than this much memory, a gigabyte where that is less.
    ///
    /// # Errors
    /// It does; of the cause [`Cause::Resource`], about the key `render.size`.
    pub fn check_memory(&self, limit: u64) -> Result<(), Diagnostic> {
        let window = self.settings.window;
        let bytes = u64::from(window.width()) * u64::from(window.height()) * BYTES_A_PIXEL;
        let limit = limit.max(ALWAYS);
        if bytes <= limit {
            return Ok(());
        }
        let mib = |bytes: u64| bytes.div_ceil(1 << 20);
        let [width, height] = [window.width(), window.height()];
        let (needed, limit) = (mib(bytes), limit >> 20);
        let why =
            format!("{width}x{height} pixels take {needed} MiB, more than the memory limit of {limit} MiB");
        let hint = "render a part of it, or allow more with --memory-limit";
        Err(Diagnostic::error(why).because(Cause::Resource).element("render.size").hint(hint))
    }
}

/// How much of the render is done, by the rule that is nearest to hold.
pub fn fraction(status: &Status, rules: &StopRules) -> f64 {
    let by_rounds = rules.rounds.map_or(0.0, |n| status.rounds as f64 / n.max(1) as f64);
    let by_time =
        rules.time.map_or(0.0, |t| status.elapsed.as_secs_f64() / t.as_secs_f64().max(f64::MIN_POSITIVE));
    // Noise falls with the square root of the work.
    let by_noise = rules.noise.zip(status.noise).map_or(0.0, |(limit, n)| (limit / n.counted()).powi(2));
    by_rounds.max(by_time).max(by_noise).clamp(0.0, 1.0)
}

/// How long it goes on, where that can be told.
pub fn time_left(status: &Status, done: f64) -> Option<Duration> {
    let seconds = status.elapsed.as_secs_f64() * (1.0 / done - 1.0);
    Duration::try_from_secs_f64(seconds).ok().filter(|_| done > 0.0 && done < 1.0)
}
