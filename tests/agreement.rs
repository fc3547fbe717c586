//! The scenes of the repository by path tracing and by bidirectional path tracing: the same picture (mlt.md §2.4 b).
//!
//! Small pictures in blocks of 8 × 8 pixels. Each block and channel has one value a round; rounds are independent, so that
//! the spread of these values is an error that knows of light which reaches several pixels at once.
#![allow(clippy::unwrap_used, reason = "a failing test panics")]

use std::{path::Path, sync::atomic::AtomicBool};

use ajar::session::{LoadOptions, choose_camera, load, prepare_world};
use ajar_integrators::{Context, Integrator, Settings, Window, bdpt::Bdpt, brightness, path::PathTracer};
use ajar_render::{World, film::Film};
use ajar_scene::Choice;

const WIDTH: u32 = 32;
const HEIGHT: u32 = 24;
/// Pixels on the side of a block.
const BLOCK: u32 = 8;
const ROUNDS: u32 = 32;
/// Values of one round: three channels a block.
const VALUES: usize = (3 * (WIDTH / BLOCK) * (HEIGHT / BLOCK)) as usize;

/// Largest |z| that is taken for chance. Of 36 normal values one exceeds it once in 5·10⁴ scenes; the spread is taken from
/// 32 rounds, and some light comes seldom and bright, which makes it more.
const LIMIT: f64 = 5.0;

fn world(scene: &str) -> World {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(scene).join("scene.toml");
    let choice = Choice::default();
    let options = LoadOptions {
        size: None,
        set: &[],
        strict: false,
        allow: &[],
        memory_limit: 4 << 30,
        choice: &choice,
    };
    let file = load(&path, &options).unwrap().file;
    let camera = choose_camera(&file.scene, file.render.camera.as_deref()).unwrap();
    prepare_world(file.scene, camera, [WIDTH, HEIGHT], 4 << 30).unwrap().0
}

/// Mean and squared standard error of every block and channel.
struct Blocks([(f64, f64); VALUES]);

impl Blocks {
    fn new(world: &World, integrator: &dyn Integrator, seed: u64, samples_per_round: u32) -> Self {
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
    fn scaled(&self, factor: f64) -> Self {
        Self(self.0.map(|(mean, variance)| (mean * factor, variance * factor * factor)))
    }

    /// The largest |z| of all blocks and channels, and the median error of both in proportion to the values.
    fn compare(&self, other: &Self) -> (f64, f64) {
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

/// The scene by both integrators, with samples a round for each.
fn both(scene: &str, path: u32, bdpt: u32) -> (Blocks, Blocks) {
    let world = world(scene);
    (Blocks::new(&world, &PathTracer, 1, path), Blocks::new(&world, &Bdpt, 2, bdpt))
}

fn check(scene: &str, path: u32, bdpt: u32) {
    let (a, b) = both(scene, path, bdpt);
    let (worst, error) = a.compare(&b);
    println!("{scene}: largest z {worst:.2}, typical error {:.2} %", error * 100.0);
    assert!(worst < LIMIT, "{scene}: largest z {worst:.2}");
}

#[test]
fn cornell_and_the_comparison_sees_a_thirtieth_of_the_light() {
    let (path, bdpt) = both("cornell", 64, 16);
    let (worst, error) = path.compare(&bdpt);
    println!("cornell: largest z {worst:.2}, typical error {:.2} %", error * 100.0);
    assert!(worst < LIMIT, "{worst:.2}");
    for broken in [0.97, 1.03] {
        let (worst, _) = path.scaled(broken).compare(&bdpt);
        println!("cornell with {broken} of the light: largest z {worst:.2}");
        assert!(worst > LIMIT, "{broken}: {worst:.2}");
    }
}

#[test]
fn door_ajar() {
    check("door-ajar", 16, 4);
}

#[test]
fn caustic_glass() {
    check("caustic-glass", 64, 8);
}

#[test]
fn materials() {
    check("materials", 16, 4);
}

#[test]
fn window_room() {
    check("window-room", 16, 4);
}

#[test]
fn many_lights() {
    check("many-lights", 16, 4);
}
