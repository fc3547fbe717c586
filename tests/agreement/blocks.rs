//! Renders by blocks of pixels, with their errors.

use std::sync::atomic::AtomicBool;

use ajar_integrators::{Context, Integrator, Settings, Window, brightness};
use ajar_render::{World, film::Film};

pub const WIDTH: u32 = 32;
pub const HEIGHT: u32 = 24;
/// Pixels on the side of a block.
const BLOCK: u32 = 8;
const ROUNDS: u32 = 32;
/// Values of one round: three channels a block.
const VALUES: usize = (3 * (WIDTH / BLOCK) * (HEIGHT / BLOCK)) as usize;

/// Mean and squared standard error of every block and channel.
pub struct Blocks([(f64, f64); VALUES]);

impl Blocks {
    pub fn new(world: &World, integrator: &dyn Integrator, seed: u64, samples_per_round: u32) -> Self {
        let window = Window { x0: 0, y0: 0, x1: WIDTH, y1: HEIGHT };
        let settings =
            Settings { seed, max_depth: 10, samples_per_round, window, mutations: Default::default() };
        let unit = brightness(world, settings.max_depth);
        let cancel = AtomicBool::new(false);
        let prepared = integrator.prepare(Context { world, settings: &settings, cancel: &cancel });
        let (mut sums, mut squares) = ([0.0; VALUES], [0.0; VALUES]);
        for round in 0..ROUNDS {
            let mut film = Film::new(window.pixels(), unit);
            let deposits = film.round();
            prepared.render(round, &deposits);
            film.merge(&deposits, prepared.scale());
            let mut values = [0.0; VALUES];
            for (x, y) in (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| (x, y))) {
                let block = 3 * (y / BLOCK * (WIDTH / BLOCK) + x / BLOCK) as usize;
                let color = film.mean((y * WIDTH + x) as usize).to_array();
                (0..3).for_each(|c| values[block + c] += color[c] / f64::from(BLOCK * BLOCK));
            }
            for (i, value) in values.into_iter().enumerate() {
                sums[i] += value;
                squares[i] += value * value;
            }
        }
        let n = f64::from(ROUNDS);
        Self(std::array::from_fn(|i| {
            let mean = sums[i] / n;
            (mean, (squares[i] / n - mean * mean).max(0.0) / (n - 1.0))
        }))
    }

    /// Every value multiplied.
    pub fn scaled(&self, factor: f64) -> Self {
        Self(self.0.map(|(mean, variance)| (mean * factor, variance * factor * factor)))
    }

    /// The largest |z| of all blocks and channels, and the median error of both in proportion to the values.
    pub fn compare(&self, other: &Self) -> (f64, f64) {
        let (mut worst, mut errors) = (0f64, Vec::new());
        for ((a, va), (b, vb)) in self.0.iter().zip(&other.0) {
            // The film counts in steps: 0.02 % of the value is rounding, not noise.
            let error = (va + vb + (2e-4 * a.max(*b)).powi(2) + 1e-30).sqrt();
            worst = worst.max((a - b).abs() / error);
            errors.push(error / a.max(*b).max(1e-30));
        }
        errors.sort_by(f64::total_cmp);
        (worst, errors[VALUES / 2])
    }
}
