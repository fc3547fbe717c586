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
    format!("round {}, {}, {noise}{left}", status.rounds, samples(status.samples))
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

/// `64 samples a pixel`.
pub(super) fn samples(count: u64) -> String {
    format!("{count} {} a pixel", if count == 1 { "sample" } else { "samples" })
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

#[cfg(test)]
mod tests {
    use ajar_integrators::stats::Noise;

    use super::*;

    fn status(seconds: f64, noise: Option<Noise>) -> Status {
        Status { rounds: 8, samples: 64, elapsed: Duration::from_secs_f64(seconds), noise, rejected: 0 }
    }

    #[test]
    fn durations_are_told_in_two_units_at_most() {
        for (seconds, text) in [
            (0.0, "0.0 s"),
            (9.94, "9.9 s"),
            (10.0, "10 s"),
            (119.9, "119 s"),
            (120.0, "2 min 0 s"),
            (200.0, "3 min 20 s"),
            (7199.0, "119 min 59 s"),
            (7200.0, "2 h 0 min"),
            (7500.0, "2 h 5 min"),
        ] {
            assert_eq!(duration(Duration::from_secs_f64(seconds)), text, "{seconds}");
        }
    }

    #[test]
    fn what_is_left_takes_as_long_as_what_is_done() {
        let left = |done| time_left(&status(10.0, None), done).map(|left| left.as_secs_f64());
        for (done, expected) in [(0.5, 10.0), (0.2, 40.0), (0.8, 2.5)] {
            assert!((left(done).unwrap() - expected).abs() < 1e-6, "{done}: {:?}", left(done));
        }
        // Nothing is left, or nobody can tell.
        for done in [0.0, 1.0, f64::NAN, f64::MIN_POSITIVE] {
            assert_eq!(left(done), None, "{done}");
        }
    }

    #[test]
    fn a_line_says_how_far_it_is() {
        let noise = Noise { typical: 0.021, worst_tile: 0.05 };
        assert_eq!(
            describe(&status(10.0, Some(noise)), 0.2),
            "round 8, 64 samples a pixel, noise 2.1 % (worst tile 5 %), about 40 s left"
        );
        assert_eq!(samples(1), "1 sample a pixel");
        assert_eq!(describe(&status(10.0, None), 0.0), "round 8, 64 samples a pixel, noise not yet known");
        let numbers = numbers(&status(10.0, Some(noise)), 0.2);
        assert_eq!((&numbers["rounds"], &numbers["seconds_left"]), (&json!(8), &json!(40.0)));
        assert_eq!(numbers["noise"], json!(0.021));
    }

    #[test]
    fn the_rule_nearest_to_hold_says_how_much_is_done() {
        let rules = StopRules { rounds: Some(64), time: Some(Duration::from_secs(100)), noise: Some(0.02) };
        let done = |seconds, typical| {
            let noise = Some(Noise { typical, worst_tile: typical });
            fraction(&status(seconds, noise), &rules)
        };
        // Eight of 64 rounds; 60 of 100 seconds; half the noise takes four times the work.
        assert_eq!([done(1.0, 1.0), done(60.0, 1.0), done(1.0, 0.04)], [0.125, 0.6, 0.25]);
        assert_eq!(done(1.0, 0.01), 1.0);
        // A tile with twice the noise that it may have holds everything up.
        let noise = Some(Noise { typical: 0.01, worst_tile: 0.12 });
        assert_eq!(fraction(&status(1.0, noise), &rules), 0.25);
    }
}
