//! Measures whether chains pay: squared error times time of path tracing alone over that of `ajar` with chains in any case,
//! beside what the pilot of `ajar` makes of it.
//!
//! Usage: `cargo run --release -p ajar --example pays [FILE]...`, a row for each. One thread; the pilot's time counts.

use std::{error::Error, io::Write, path::Path, sync::atomic::AtomicBool, time::Instant};

use ajar::session::{LoadOptions, choose_camera, load, prepare_world};
use ajar_integrators::{Context, Integrator, Settings, Window, brightness, mlt::Ajar, path::PathTracer};
use ajar_render::{World, film::Film, math::scalar};
use ajar_scene::Choice;

const SIZE: [u32; 2] = [192, 144];
const MEMORY: u64 = 4 << 30;
/// Renders of each kind, by whose differences the error is known.
const SEEDS: u64 = 4;
/// Samples a pixel of `ajar`, whose rounds have as many as it usually gives them; path tracing gets twice as many.
const SAMPLES: u32 = 64;
const SAMPLES_A_ROUND: u32 = 4;
/// Brightness below which pixels are as good as dark, relative to the mean.
const DARK: f64 = 0.1;

fn main() -> Result<(), Box<dyn Error>> {
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global()?;
    let mut out = std::io::stdout();
    writeln!(out, "  seems     is  without the worst percent")?;
    for file in std::env::args().skip(1) {
        let world = open(Path::new(&file))?;
        let (paths, with_chains) =
            (Renders::of(&world, &PathTracer, 2), Renders::of(&world, &Ajar { always: true }, 1));
        let reference: Vec<f64> = paths
            .mean()
            .zip(with_chains.mean())
            .map(|(paths, with_chains)| (paths + with_chains) / 2.0)
            .collect();
        let [all, most] =
            [1.0, 0.99].map(|share| paths.error(&reference, share) / with_chains.error(&reference, share));
        let seems = with_chains.advantages.iter().sum::<f64>() / SEEDS as f64;
        writeln!(out, "{seems:7.2} {all:6.2} {most:6.2}  {file}")?;
    }
    Ok(())
}

fn open(file: &Path) -> Result<World, Box<dyn Error>> {
    let choice = Choice::default();
    let options = LoadOptions {
        size: Some(SIZE),
        set: &[],
        strict: false,
        allow: &[],
        memory_limit: MEMORY,
        choice: &choice,
    };
    let said = |what: &dyn std::fmt::Debug| format!("{}: {what:?}", file.display());
    let loaded = load(file, &options).map_err(|e| said(&e))?.file;
    let camera = choose_camera(&loaded.scene, loaded.render.camera.as_deref()).map_err(|e| said(&e))?;
    Ok(prepare_world(loaded.scene, camera, SIZE, MEMORY).map_err(|e| said(&e))?.0)
}

/// Images by the same integrator with other seeds.
struct Renders {
    images: Vec<Vec<f64>>,
    /// Seconds that all took.
    time: f64,
    /// What the pilots expected, if there were any.
    advantages: Vec<f64>,
}

impl Renders {
    fn of(world: &World, integrator: &dyn Integrator, times: u32) -> Self {
        let mut renders = Self { images: Vec::new(), time: 0.0, advantages: Vec::new() };
        let window = Window { x0: 0, y0: 0, x1: SIZE[0], y1: SIZE[1] };
        let cancel = AtomicBool::new(false);
        for seed in 0..SEEDS {
            let settings = Settings {
                seed,
                max_depth: 16,
                samples_per_round: SAMPLES_A_ROUND * times,
                window,
                metropolis: Default::default(),
            };
            let mut film = Film::new(window.pixels(), brightness(world, settings.max_depth));
            let started = Instant::now();
            let rounds = integrator.prepare(Context { world, settings: &settings, cancel: &cancel });
            for round in 0..SAMPLES / SAMPLES_A_ROUND {
                let deposits = film.round();
                rounds.render(round, &deposits);
                film.merge(&deposits, rounds.scale());
            }
            renders.time += started.elapsed().as_secs_f64();
            renders.images.push((0..film.pixels()).map(|pixel| scalar(film.mean(pixel))).collect());
            let numbers = rounds.report().numbers.into_iter();
            renders
                .advantages
                .extend(numbers.filter(|(name, _)| name == "advantage").map(|(_, value)| value));
        }
        renders
    }

    fn mean(&self) -> impl Iterator<Item = f64> {
        let sum = |pixel| self.images.iter().map(|image| image[pixel]).sum::<f64>();
        (0..self.images[0].len()).map(move |pixel| sum(pixel) / self.images.len() as f64)
    }

    /// Squared relative error of an image, of the best `share` of its pixels, times the time that it takes.
    fn error(&self, reference: &[f64], share: f64) -> f64 {
        let dark = DARK * reference.iter().sum::<f64>() / reference.len() as f64;
        let error = |(pixel, (mean, reference)): (usize, (f64, &f64))| {
            let squares = self.images.iter().map(|image| (image[pixel] - mean).powi(2)).sum::<f64>();
            squares / (SEEDS - 1) as f64 / reference.max(dark).powi(2)
        };
        let mut errors: Vec<f64> = self.mean().zip(reference).enumerate().map(error).collect();
        errors.sort_unstable_by(f64::total_cmp);
        errors.truncate((share * errors.len() as f64) as usize);
        self.time * errors.iter().sum::<f64>()
    }
}
