//! What chains would gain over path tracing alone, as the pilot finds it.
//!
//! Chains see paths in proportion to what they contribute: the mean of C/μ over them is the second moment of the path tracer,
//! however seldom it would find them itself.

use std::sync::{Mutex, PoisonError};

use ajar_render::math::scalar;
use rayon::prelude::*;

use super::{
    base,
    path::Space,
    pilot::{FLOOR, part},
    plain::{PlainChains, Run},
};

/// Steps that chains are taken to need to forget a pixel where work is divided between base and chains: more than they do
/// on easy scenes and fewer than behind a door, where the base is needed for its seeds.
const USUAL_CORRELATION: f64 = 15.0;
/// Even spread makes an eye path worth about this many random ones where paths alone do well.
const EVENNESS: f64 = 1.5;
/// What κ may be: where chains render next to everything, more would leave fireflies in the base; where they render
/// little, more spares them the work.
const CLAMPS: [f64; 3] = [2.0, 4.0, 8.0];
/// Bookkeeping of a mutation, in rays.
const OVERHEAD: f64 = 1.5;
/// Work of an eye path that meets nothing, in rays.
const MISS: f64 = 0.5;
/// Shares of the work that the base may get beside chains.
const BASE_SHARE: [f64; 2] = [0.3, 0.7];
/// What looks for seeds besides the base, relative to the work of base and chains.
const SEED_WORK: f64 = 0.11;
/// What a bidirectional sample that looks for heavy paths costs in eye paths.
const BIDIRECTIONAL_COST: f64 = 3.0;
/// Largest relative contribution that counts in full in the second moments. What is worth more is so seldom found, by eye
/// paths or as seeds of chains, that it makes a few single pixels bright with or without chains.
const MOST: f64 = 400.0;
/// Parts of the chains of which each finds the correlation by itself: what one of them met by chance does not decide.
const PARTS: usize = 15;

/// Relative second moments of one sample, averaged over pixels, what is left to chains, and costs in rays.
#[derive(Clone, Copy, Debug, Default)]
pub struct Gain {
    /// κ of the base.
    pub clamp: f64,
    /// Mean of what is left to chains.
    pub residual: f64,
    /// What of that shows beside light that is seen directly.
    shown: f64,
    /// Second moments of path tracing alone, and of the base.
    path: f64,
    base: f64,
    /// How many mutations are worth one that is independent of all others.
    correlation: f64,
    path_cost: f64,
    mutation_cost: f64,
}

impl Gain {
    /// Bidirectional samples for each eye path that add [`SEED_WORK`] to the work.
    pub fn beside(&self, mutations_per_sample: f64) -> f64 {
        let work = self.path_cost + mutations_per_sample * self.mutation_cost;
        SEED_WORK * work / (BIDIRECTIONAL_COST * self.path_cost)
    }

    /// Squared error of path tracing alone over that of base and chains, in equal time.
    pub fn advantage(&self) -> f64 {
        let error = self.error(self.correlation) * (1.0 + SEED_WORK);
        self.path * self.path_cost / (EVENNESS * error)
    }

    /// Squared error of base and chains times the time that both take.
    fn error(&self, correlation: f64) -> f64 {
        let ((base, chains), share) = (self.work(correlation), self.share());
        base / share + chains / (1.0 - share)
    }

    /// Share of the base in the time. Minimizes σ²_B/t_B + σ²_M/t_M: times in proportion to the standard deviations, within
    /// bounds.
    fn share(&self) -> f64 {
        let (base, chains) = self.work(USUAL_CORRELATION);
        let [least, most] = BASE_SHARE;
        if base + chains > 0.0 {
            (base.sqrt() / (base.sqrt() + chains.sqrt())).clamp(least, most)
        } else {
            most
        }
    }

    /// Variances times costs of base and chains.
    fn work(&self, correlation: f64) -> (f64, f64) {
        (self.base * self.path_cost, self.residual * self.shown * correlation * self.mutation_cost)
    }

    /// Mutations for each eye path.
    pub fn mutations_per_sample(&self) -> f64 {
        let share = self.share();
        (1.0 - share) / share * self.path_cost / self.mutation_cost
    }
}

/// What `run` relative to `brightness` tells: of the gains by each value that κ may have, that with the least error. None if
/// chains find no light.
pub fn gain_over(chains: &PlainChains<'_>, brightness: &[f64], run: &Run<'_>) -> Option<Gain> {
    let (space, seed) = (&chains.space, chains.cx.settings.seed);
    let parts: [Mutex<Vec<Visit>>; PARTS] = Default::default();
    let run = Run { relative_to: Some(brightness), ..*run };
    let totals = chains.render(&run, |start, path, aim, share| {
        let Some(pixel) = space.pixel(path.raster) else { return };
        let visit = Visit {
            place: (start.sample, pixel as u32),
            value: scalar(aim.deposit) * share / brightness[pixel],
            contribution: base::contribution(path) / brightness[pixel],
        };
        parts[part(start.sample, PARTS)].lock().unwrap_or_else(PoisonError::into_inner).push(visit);
    });
    if totals.stats.steps() == 0 || space.cancelled() {
        return None;
    }
    // Errors of darker pixels than this do not show.
    let dark = FLOOR * crate::brightness(space.world, space.max_depth);
    let shows = |pixel: u32| brightness[pixel as usize] / brightness[pixel as usize].max(dark);
    let visits =
        parts.into_par_iter().map(|visits| visits.into_inner().unwrap_or_else(PoisonError::into_inner));
    let parts: Vec<Moments> = visits.map(|visits| Moments::of(visits, shows)).collect();
    let mut all = Moments::default();
    parts.iter().for_each(|part| all.add(part));
    let correlation = correlation(&parts, all.value / totals.stats.steps() as f64);
    let (path_cost, mutation_cost) = (path_cost(space, seed), totals.rays_per_mutation() + OVERHEAD);
    let gains = CLAMPS.into_iter().zip(all.divided).map(|(clamp, Divided { base, residual, shown })| Gain {
        clamp,
        residual,
        shown,
        path: all.path,
        base,
        correlation,
        path_cost,
        mutation_cost,
    });
    let best = gains.min_by(|a, b| a.error(USUAL_CORRELATION).total_cmp(&b.error(USUAL_CORRELATION)));
    best.filter(|_| !space.cancelled())
}

/// Steps of a chain on a path.
#[derive(Clone, Copy)]
struct Visit {
    /// The bidirectional sample that the chain began with, and the pixel.
    place: (u32, u32),
    /// What the steps add to the pixel, relative to its brightness.
    value: f64,
    /// C/μ of the path.
    contribution: f64,
}

/// What a value of κ makes of what chains saw.
#[derive(Clone, Copy, Debug, Default)]
struct Divided {
    base: f64,
    residual: f64,
    shown: f64,
}

/// Sums over what chains saw, as [`Gain`] has them.
#[derive(Debug, Default)]
struct Moments {
    value: f64,
    path: f64,
    divided: [Divided; CLAMPS.len()],
    /// Squares of what all steps that go back to the same bidirectional sample add to a pixel.
    squares: f64,
}

impl Moments {
    /// Those of a part. `shows` tells how much of a pixel's brightness, relative to its own, counts.
    fn of(mut visits: Vec<Visit>, shows: impl Fn(u32) -> f64) -> Self {
        // The order of threads must not show.
        let key = |visit: &Visit| (visit.place, visit.contribution.to_bits(), visit.value.to_bits());
        visits.sort_unstable_by_key(key);
        let mut moments = Self::default();
        for visits in visits.chunk_by(|a, b| a.place == b.place) {
            let shows = shows(visits[0].place.1);
            visits.iter().for_each(|visit| moments.see(visit, shows.powi(2)));
            let value = visits.iter().map(|visit| visit.value).sum::<f64>();
            moments.value += value * shows;
            moments.squares += (value * shows).powi(2);
        }
        moments
    }

    fn see(&mut self, visit: &Visit, shows: f64) {
        let Visit { value, contribution, .. } = *visit;
        let shown = value * shows;
        self.path += contribution.min(MOST) * shown;
        for (divided, clamp) in self.divided.iter_mut().zip(CLAMPS) {
            let left = base::share_of_chains(contribution, clamp);
            if left < 1.0 {
                divided.base += ((1.0 - left).powi(2) * contribution).min(MOST) * shown;
            }
            divided.residual += left * value;
            divided.shown += left * shown;
        }
    }

    fn add(&mut self, other: &Self) {
        self.value += other.value;
        self.path += other.path;
        for (divided, other) in self.divided.iter_mut().zip(other.divided) {
            divided.base += other.base;
            divided.residual += other.residual;
            divided.shown += other.shown;
        }
        self.squares += other.squares;
    }
}

/// How many mutations, each of which adds `step` to a pixel, are worth one that is independent of all others: as the part of
/// the chains in the middle has it.
fn correlation(parts: &[Moments], step: f64) -> f64 {
    let of_part = |part: &Moments| if part.value > 0.0 { part.squares / (part.value * step) } else { 1.0 };
    let mut found: Vec<f64> = parts.iter().map(of_part).collect();
    found.sort_unstable_by(f64::total_cmp);
    found[found.len() / 2]
}

/// Rays of one eye path, or what costs as much.
fn path_cost(space: &Space<'_>, seed: u64) -> f64 {
    const STRIDE: usize = 37;
    let paths = space.window.pixels().div_ceil(STRIDE);
    let vertices = |path| if space.cancelled() { 0 } else { base::vertices(space, seed, path * STRIDE) };
    let cost = |path| match vertices(path) {
        0..=1 => MISS,
        // At each vertex one ray to a light and one that goes on.
        vertices => 2.0 * vertices as f64,
    };
    let costs: Vec<f64> = (0..paths).into_par_iter().map(cost).collect();
    costs.iter().sum::<f64>() / paths as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Visits of one part to pixels that show in full: `stay` of a step each for each bidirectional sample.
    fn part(samples: u32, stay: usize) -> Vec<Visit> {
        let visits = |sample| Visit { place: (sample, sample % 7), value: 1.0, contribution: 3.0 };
        (0..samples).flat_map(|sample| vec![visits(sample); stay]).collect()
    }

    #[test]
    fn correlation_is_how_long_chains_stay() {
        for stay in [1, 10] {
            let parts: Vec<Moments> = (0..PARTS).map(|_| Moments::of(part(50, stay), |_| 1.0)).collect();
            assert_eq!(correlation(&parts, 1.0), stay as f64);
        }
    }

    #[test]
    fn a_chain_that_is_stuck_does_not_decide() {
        let stuck = std::iter::once(part(1, 5000));
        let parts = stuck.chain((1..PARTS).map(|_| part(50, 10)));
        let parts: Vec<Moments> = parts.map(|visits| Moments::of(visits, |_| 1.0)).collect();
        assert_eq!(correlation(&parts, 1.0), 10.0);
    }

    #[test]
    fn moments_do_not_depend_on_the_order_of_visits() {
        let mut visits: Vec<Visit> = (0..1000_u32)
            .map(|i| {
                let x = f64::from(i * 7919 % 1009) / 1009.0;
                Visit { place: (i % 50, i % 3), value: 0.1 + x, contribution: 1e3 * x }
            })
            .collect();
        let shows = |pixel| if pixel == 0 { 0.5 } else { 1.0 };
        let sorted = format!("{:?}", Moments::of(visits.clone(), shows));
        visits.reverse();
        assert_eq!(format!("{:?}", Moments::of(visits, shows)), sorted);
    }

    #[test]
    fn work_goes_where_its_variance_is() {
        let gain = Gain {
            path: 9.0,
            base: 1.0,
            path_cost: 4.0,
            mutation_cost: 4.0,
            correlation: 1.0,
            ..Gain::default()
        };
        let with = |residual| Gain { residual, shown: residual, ..gain };
        // Where next to nothing is left to chains, the base gets all that it may; where everything is, as little as it may.
        let per_sample = |share: f64| (1.0 - share) / share;
        assert!((with(1e-6).mutations_per_sample() - per_sample(BASE_SHARE[1])).abs() < 1e-9);
        assert!((with(10.0).mutations_per_sample() - per_sample(BASE_SHARE[0])).abs() < 1e-9);
        assert!(with(0.1).advantage() > with(1.0).advantage());
        let longer = Gain { correlation: 100.0, ..with(1.0) };
        assert!(longer.advantage() < 0.1 * with(1.0).advantage());
        assert_eq!(longer.mutations_per_sample(), with(1.0).mutations_per_sample());
    }
}
