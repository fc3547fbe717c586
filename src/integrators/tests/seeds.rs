//! What bidirectional samples make of seeds: neither more takes at some pixels nor Russian roulette may change what they weigh.

mod common;

use std::ops::Range;

use ajar_integrators::mlt::{
    path::{Path, Space},
    seeds::{Bootstrap, Candidate},
};
use common::{scenes::SCENES, settings, sized};

/// Means and standard errors over rounds.
const ROUNDS: u32 = 32;
/// More takes of each third pixel.
const TAKES: u32 = 5;
/// f*/p below which roulette decides, in units of the brightness.
const LEAST: f64 = 4.0;

#[derive(Clone, Copy, Default)]
struct Sums {
    sum: f64,
    squares: f64,
}

impl Sums {
    fn add(&mut self, value: f64) {
        self.sum += value;
        self.squares += value * value;
    }

    fn mean(&self) -> f64 {
        self.sum / f64::from(ROUNDS)
    }

    /// Square of the standard error of the mean.
    fn variance(&self) -> f64 {
        (self.squares / f64::from(ROUNDS) - self.mean().powi(2)) / f64::from(ROUNDS - 1)
    }

    fn z(&self, other: &Self) -> f64 {
        (self.mean() - other.mean()) / (self.variance() + other.variance()).sqrt()
    }
}

/// By length, and by whether the pixel has more takes.
type Table = [Sums; 16];

/// What the candidates of each round weigh, by length and by whether their pixel has more takes; `weigh` may be wrong.
fn weights(
    bootstrap: Bootstrap<'_>,
    rounds: Range<u32>,
    weigh: impl Fn(&Candidate) -> f64,
) -> (Table, usize) {
    let (mut table, mut count) = (Table::default(), 0);
    for round in rounds {
        let candidates = Bootstrap { round, ..bootstrap }.candidates();
        let mut sums = [0.0; 16];
        for candidate in &candidates {
            let part = usize::from(has_more(candidate.pixel as usize));
            sums[2 * candidate.edges().min(7) + part] += weigh(candidate) / f64::from(bootstrap.samples);
        }
        table.iter_mut().zip(sums).for_each(|(sums, value)| sums.add(value));
        count += candidates.len();
    }
    (table, count)
}

fn has_more(pixel: usize) -> bool {
    pixel.is_multiple_of(3)
}

fn largest_z(a: &Table, b: &Table) -> f64 {
    let cells = a.iter().zip(b).filter(|(a, b)| a.mean() > 0.0 && b.mean() > 0.0);
    cells.map(|(a, b)| a.z(b).abs()).fold(0.0, f64::max)
}

#[test]
fn takes_and_roulette_weigh_the_same() {
    for scene in &SCENES[..3] {
        let world = (scene.world)();
        let window = settings(&world, 1, scene.depth, 1).window;
        let space = Space::new(&world, window, scene.depth);
        let takes: Vec<u32> =
            (0..window.pixels()).map(|pixel| if has_more(pixel) { TAKES } else { 1 }).collect();
        let usual = Bootstrap::new(space, (3, 0), sized(1 << 12) as u32);
        let (expected, looked) = weights(usual, 0..ROUNDS, |c| c.weight);
        let brightness: f64 = expected.iter().map(Sums::mean).sum();
        let more = Bootstrap { takes: &takes, ..usual };
        let thinned = Bootstrap { least: LEAST * brightness, ..usual };
        let rounds = ROUNDS..2 * ROUNDS;
        for (name, bootstrap) in [("takes", more), ("roulette", thinned)] {
            let (found, count) = weights(bootstrap, rounds.clone(), |c| c.weight);
            let z = largest_z(&expected, &found);
            println!("{}, {name}: largest |z| {z:.2}, {count} candidates, {looked} as usual", scene.name);
            assert!(z < 4.0, "{}, {name}: {z}", scene.name);
            assert_eq!(count > looked, name == "takes", "{}, {name}: {count} {looked}", scene.name);
        }
        // Whoever forgets to take the mean of takes, or what those that roulette spares stand for, is found out.
        let (sum, _) = weights(more, rounds.clone(), |c| c.weight * f64::from(takes[c.pixel as usize]));
        assert!(largest_z(&expected, &sum) > 8.0, "{}: {}", scene.name, largest_z(&expected, &sum));
        let least = LEAST * brightness;
        let (lost, _) = weights(thinned, rounds, |c| c.weight * (c.weight / least).min(1.0));
        assert!(largest_z(&expected, &lost) > 8.0, "{}: {}", scene.name, largest_z(&expected, &lost));
    }
}

/// Every candidate can be found again, from whichever take and in spite of roulette.
#[test]
fn candidates_are_found_again() {
    let scene = &SCENES[2];
    let world = (scene.world)();
    let window = settings(&world, 1, scene.depth, 1).window;
    let space = Space::new(&world, window, scene.depth);
    let takes = vec![3; window.pixels()];
    let bootstrap = Bootstrap { takes: &takes, least: 0.5, ..Bootstrap::new(space, (4, 0), 1 << 10) };
    let (mut tracer, mut path) = (bootstrap.tracer(), Path::with_capacity());
    let candidates = bootstrap.candidates();
    let found = candidates.iter().filter(|candidate| {
        let found = bootstrap.replay(candidate, &mut tracer, &mut path).is_some();
        found
            && path.edges() == candidate.edges()
            && space.pixel(path.raster) == Some(candidate.pixel as usize)
    });
    let (found, all) = (found.count(), candidates.len());
    println!("{found} of {all} found again");
    assert!(all > 1000 && 1000 * found >= 999 * all, "{found} of {all}");
}
