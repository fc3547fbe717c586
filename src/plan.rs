//! What is rendered, and until when.

use std::time::Duration;

use ajar_integrators::{Integrator, Settings, stop::StopRules};

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

/// How much of the render is done, by the rule that is nearest to hold.
pub fn fraction(status: &Status, rules: &StopRules) -> f64 {
    let by_rounds = rules.rounds.map_or(0.0, |n| status.rounds as f64 / n.max(1) as f64);
    let by_time =
        rules.time.map_or(0.0, |t| status.elapsed.as_secs_f64() / t.as_secs_f64().max(f64::MIN_POSITIVE));
    // Noise falls with the square root of the work.
    let by_noise =
        rules.noise.zip(status.noise).map_or(0.0, |(limit, n)| (limit / n.typical.max(limit)).powi(2));
    by_rounds.max(by_time).max(by_noise).clamp(0.0, 1.0)
}

/// How long it goes on, where that can be told.
pub fn time_left(status: &Status, done: f64) -> Option<Duration> {
    let seconds = status.elapsed.as_secs_f64() * (1.0 / done - 1.0);
    Duration::try_from_secs_f64(seconds).ok().filter(|_| done > 0.0 && done < 1.0)
}
