//! What bidirectional samples make of seeds: neither more takes at some pixels nor Russian roulette may change what they weigh.

mod common;

use std::ops::Range;

use ajar_integrators::{
    Window,
    mlt::{
        path::{Path, Space},
        seeds::{Bootstrap, Candidate},
    },
};
use ajar_render::World;
use common::{
    scenes::{SCENES, TestScene},
    settings, sized,
};

/// Means and standard errors over rounds.
const ROUNDS: u32 = 32;
/// More takes of each third pixel.
const TAKES: u32 = 5;
/// Weight below which roulette decides, in units of the brightness.
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

/// What the candidates of each round weigh, by length and by whether their pixel has more takes: rightly, and as `wrong` has
/// it; and how many there are.
fn weights(
    bootstrap: Bootstrap<'_>,
    rounds: Range<u32>,
    wrong: impl Fn(&Candidate) -> f64,
) -> ([Table; 2], usize) {
    let (mut tables, mut count) = ([Table::default(); 2], 0);
    for round in rounds {
        let candidates = Bootstrap { round, ..bootstrap }.candidates();
        let mut sums = [[0.0; 16]; 2];
        for candidate in &candidates {
            let part = usize::from(has_more(candidate.pixel as usize));
            for (sums, weight) in sums.iter_mut().zip([candidate.weight, wrong(candidate)]) {
                sums[2 * candidate.edges().min(7) + part] += weight / f64::from(bootstrap.samples);
            }
        }
        for (sums, value) in tables.iter_mut().flatten().zip(sums.iter().flatten()) {
            sums.add(*value);
        }
        count += candidates.len();
    }
    (tables, count)
}

fn has_more(pixel: usize) -> bool {
    pixel.is_multiple_of(3)
}

fn largest_z(a: &Table, b: &Table) -> f64 {
    let cells = a.iter().zip(b).filter(|(a, b)| a.mean() > 0.0 || b.mean() > 0.0);
    cells.map(|(a, b)| a.z(b).abs()).fold(0.0, f64::max)
}

/// The left half of the film: light paths are as many as eye paths, and half of them miss it.
fn left_half<'w>(world: &'w World, scene: &TestScene) -> Space<'w> {
    let whole = settings(world, 1, scene.depth, 1).window;
    Space::new(world, Window { x1: whole.x1 / 2, ..whole }, scene.depth)
}

#[test]
fn takes_and_roulette_weigh_the_same() {
    for scene in &SCENES[..3] {
        let world = (scene.world)();
        let space = left_half(&world, scene);
        let takes: Vec<u32> =
            (0..space.window.pixels()).map(|pixel| if has_more(pixel) { TAKES } else { 1 }).collect();
        let usual = Bootstrap::new(space, (3, 0), sized(1 << 12) as u32);
        let ([expected, _], looked) = weights(usual, 0..ROUNDS, |_| 0.0);
        let least = LEAST * expected.iter().map(Sums::mean).sum::<f64>();
        let sum = |c: &Candidate| c.weight * f64::from(takes[c.pixel as usize]);
        // What would have been spared for certain is right, what had to be lucky too light.
        let lost = |c: &Candidate| if c.weight < 1.001 * least { 0.2 * c.weight } else { c.weight };
        let more = weights(Bootstrap { takes: &takes, ..usual }, ROUNDS..2 * ROUNDS, sum);
        let fewer = weights(Bootstrap { least, ..usual }, ROUNDS..2 * ROUNDS, lost);
        for (name, ([right, wrong], count)) in [("takes", more), ("roulette", fewer)] {
            let [z, z_wrong] = [right, wrong].map(|found| largest_z(&expected, &found));
            println!(
                "{}, {name}: largest |z| {z:.2}, {z_wrong:.1} if wrong, {count} of {looked}",
                scene.name
            );
            assert!(z < 4.0, "{}, {name}: {z}", scene.name);
            assert!(z_wrong > 8.0, "{}, {name}, wrong: {z_wrong}", scene.name);
            assert_eq!(count > looked, name == "takes", "{}, {name}: {count} {looked}", scene.name);
        }
    }
}

/// Every candidate can be found again, from whichever take and in spite of roulette.
#[test]
fn candidates_are_found_again() {
    let scene = &SCENES[2];
    let world = (scene.world)();
    let space = left_half(&world, scene);
    let takes = vec![3; space.window.pixels()];
    let all = Bootstrap { takes: &takes, ..Bootstrap::new(space, (4, 0), 1 << 11) };
    let bootstrap = Bootstrap { least: 0.2, ..all };
    let (mut tracer, mut path) = (bootstrap.tracer(), Path::with_capacity());
    let candidates = bootstrap.candidates();
    let found = candidates.iter().filter(|candidate| {
        let found = bootstrap.replay(candidate, &mut tracer, &mut path).is_some();
        found
            && path.edges() == candidate.edges()
            && space.pixel(path.raster) == Some(candidate.pixel as usize)
    });
    let (found, count) = (found.count(), candidates.len());
    println!("{found} of {count} found again");
    assert!(count > 500 && 1000 * found >= 999 * count, "{found} of {count}");
    assert!(2 * count < all.candidates().len(), "roulette hardly played: {count}");
}
