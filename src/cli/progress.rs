//! The line that says how far a render is.

use std::time::{Duration, Instant};

use ajar_integrators::stop::StopRules;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::{Value, json};

use super::log::Format;
use crate::{
    plan::{fraction, time_left},
    session::Status,
};

/// Without a terminal, a plain line this often.
pub(super) const PLAIN_INTERVAL: Duration = Duration::from_secs(5);

/// Shows progress on standard error.
pub(super) struct Progress {
    bar: Option<ProgressBar>,
    last: Instant,
    quiet: bool,
    log: Format,
}

impl Progress {
    pub(super) fn new(quiet: bool, log: Format) -> Self {
        let bar = (!quiet && log.interactive()).then(|| {
            let bar = ProgressBar::new(1000);
            if let Ok(style) = ProgressStyle::with_template("{bar:30} {percent:>3} %  {msg}") {
                bar.set_style(style.progress_chars("━╸ "));
            }
            bar.set_message("getting ready for the first round");
            bar
        });
        Self { bar, last: Instant::now(), quiet, log }
    }

    /// Shows the state after a round.
    pub(super) fn update(&mut self, status: &Status, rules: &StopRules) {
        let done = fraction(status, rules);
        let text = describe(status, done);
        if let Some(bar) = &self.bar {
            bar.set_position((done * 1000.0) as u64);
            bar.set_message(text);
        } else if !self.quiet && self.last.elapsed() >= PLAIN_INTERVAL {
            self.last = Instant::now();
            self.log.progress(&format!("{:3.0} %  {text}", done * 100.0), numbers(status, done));
        }
    }

    pub(super) fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// `round 8, 64 samples a pixel, noise 2.1 % (worst tile 5 %), about 40 s left`, of a render of which this much is done.
fn describe(status: &Status, done: f64) -> String {
    let noise = match status.noise {
        Some(noise) => {
            format!("noise {:.1} % (worst tile {:.0} %)", noise.typical * 100.0, noise.worst_tile * 100.0)
        }
        None => "noise not yet known".into(),
    };
    let left =
        time_left(status, done).map_or(String::new(), |left| format!(", about {} left", duration(left)));
    format!("round {}, {} samples a pixel, {noise}{left}", status.rounds, status.samples)
}

/// The same for programs.
fn numbers(status: &Status, done: f64) -> Value {
    json!({
        "done": done,
        "rounds": status.rounds,
        "samples_per_pixel": status.samples,
        "seconds": status.elapsed.as_secs_f64(),
        "seconds_left": time_left(status, done).map(|left| left.as_secs_f64()),
        "noise": status.noise.map(|noise| noise.typical),
    })
}

/// `45 s`, `3 min 20 s`, `2 h 5 min`.
pub(super) fn duration(time: Duration) -> String {
    let seconds = time.as_secs();
    match seconds {
        0..10 => format!("{:.1} s", time.as_secs_f64()),
        10..120 => format!("{seconds} s"),
        120..7200 => format!("{} min {} s", seconds / 60, seconds % 60),
        _ => format!("{} h {} min", seconds / 3600, seconds / 60 % 60),
    }
}
