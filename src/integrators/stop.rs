//! When a render is done: the first of the given limits to hold.

use std::time::Duration;

use crate::stats::{MIN_ROUNDS, Noise};

/// Limits; absent ones never hold.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StopRules {
    /// Number of rounds.
    pub rounds: Option<u64>,
    /// Time since the first round began.
    pub time: Option<Duration>,
    /// Noise as [`Noise::counted`].
    pub noise: Option<f64>,
}

/// Why a render stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// All rounds are done.
    Rounds,
    /// The time is up.
    Time,
    /// The noise is low enough.
    Noise,
}

impl StopRules {
    /// Whether the render should stop after `rounds` rounds; however short the time, one is made.
    pub fn check(&self, rounds: u64, elapsed: Duration, noise: Option<Noise>) -> Option<Reason> {
        if self.rounds.is_some_and(|limit| rounds >= limit) {
            return Some(Reason::Rounds);
        }
        if rounds > 0 && self.time.is_some_and(|limit| elapsed >= limit) {
            return Some(Reason::Time);
        }
        let stop = is_noise_check(rounds)
            && self.noise.zip(noise).is_some_and(|(limit, noise)| noise.counted() <= limit);
        stop.then_some(Reason::Noise)
    }
}

/// Noise is looked at after 8, 11, 16, 23, … rounds: looking after every round would stop on lucky estimates.
pub fn is_noise_check(rounds: u64) -> bool {
    let mut next = MIN_ROUNDS as f64;
    while next.round() < rounds as f64 {
        next *= std::f64::consts::SQRT_2;
    }
    next.round() == rounds as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_checked_at_growing_intervals() {
        let checks: Vec<u64> = (0..70).filter(|&r| is_noise_check(r)).collect();
        assert_eq!(checks, [8, 11, 16, 23, 32, 45, 64]);
    }

    #[test]
    fn the_first_rule_to_hold_wins() {
        let rules = StopRules { rounds: Some(100), time: Some(Duration::from_secs(10)), noise: Some(0.02) };
        let noise = |typical, worst_tile| Some(Noise { typical, worst_tile });
        let second = Duration::from_secs(1);
        assert_eq!(rules.check(16, second, noise(0.03, 0.03)), None);
        assert_eq!(rules.check(16, second, noise(0.02, 0.07)), None);
        assert_eq!(rules.check(17, second, noise(0.01, 0.01)), None);
        assert_eq!(rules.check(16, second, noise(0.02, 0.05)), Some(Reason::Noise));
        assert_eq!(rules.check(17, 10 * second, None), Some(Reason::Time));
        assert_eq!(rules.check(0, 10 * second, None), None);
        assert_eq!(rules.check(100, second, None), Some(Reason::Rounds));
    }
}
