//! Measures how many mutations a second one thread makes on a door ajar: of plain Metropolis light transport, of each
//! mutation alone, and of rays by comparison. Seeds are found before the clock starts.
//!
//! Usage: `cargo run --release -p ajar-integrators --example mutations [SECONDS]`, for each row.

use std::{
    collections::BTreeMap,
    error::Error,
    io::Write,
    time::{Duration, Instant},
};

use ajar_integrators::mlt::{
    Mutation,
    chain::{Chain, Kernel},
    choice::Table,
    lens_subpaths::{LensSubpaths, REUSE, Spread},
    mutations::mutations,
    path::{Path, Space},
    seeds::{Bootstrap, resample},
    target::Plain,
};
use ajar_render::rng::{Purpose, Rng};
use common::scenes::DOOR_AJAR;

#[path = "../tests/common/mod.rs"]
mod common;

const SEEDS: usize = 512;
/// Steps between looks at the clock.
const STEPS: u32 = 256;

fn main() -> Result<(), Box<dyn Error>> {
    let seconds = std::env::args().nth(1).map_or(Ok(3.0), |given| given.parse())?;
    let world = (DOOR_AJAR.world)();
    let settings = common::settings(&world, 1, DOOR_AJAR.depth, 1);
    let space = Space::new(&world, settings.window, settings.max_depth);
    let seeds = seeds(space);
    let (list, table) = mutations(&BTreeMap::new());
    let mut out = std::io::stdout();
    writeln!(out, "mutation         per second  nanoseconds  rays  accepted")?;
    let mut row = |name: &str, list: &[&dyn Mutation], table: &Table| {
        let kernel = Kernel { space, mutations: list, table, target: &Plain };
        let seeds: Vec<&Path> =
            seeds.iter().filter(|x| list.iter().any(|m| m.applies(&x.signature))).collect();
        let Speed { steps, rays, accepted, time } = time(kernel, &seeds, seconds);
        let (rate, steps) = (steps / time.as_secs_f64(), steps.max(1.0));
        let (rays, accepted) = (rays / steps, accepted / steps);
        writeln!(out, "{name:15} {rate:11.0} {:12.0} {rays:5.2} {accepted:9.2}", 1e9 / rate)
    };
    row("all", &list, &table)?;
    for mutation in &list {
        row(mutation.name(), &[*mutation], &Table::uniform(&[1.0]))?;
    }
    Ok(())
}

/// Paths in proportion to their contribution.
fn seeds(space: Space<'_>) -> Vec<Path> {
    let bootstrap = Bootstrap::new(space, (1, 0), 1 << 16);
    let mut candidates = bootstrap.candidates();
    let chosen = resample(&mut candidates, SEEDS, &mut Rng::new(1, Purpose::Resampling, 0, 0));
    let mut tracer = bootstrap.tracer();
    let found = chosen.iter().filter_map(|&i| {
        let mut path = Path::with_capacity();
        bootstrap.replay(&candidates[i as usize], &mut tracer, &mut path).map(|()| path)
    });
    found.collect()
}

struct Speed {
    steps: f64,
    rays: f64,
    accepted: f64,
    time: Duration,
}

/// Chains from one seed after the other until the time is up.
fn time(kernel: Kernel<'_>, seeds: &[&Path], seconds: f64) -> Speed {
    let mut chain = Chain::new(kernel, Rng::new(1, Purpose::Chain, 0, 0));
    let (limit, mut time) = (Duration::from_secs_f64(seconds), Duration::ZERO);
    for (index, seed) in seeds.iter().cycle().enumerate() {
        if index % REUSE == 0 {
            chain.share(LensSubpaths::new(Spread::AcrossChains, (1, 0), index as u32, 1 << 20));
        }
        chain.start(seed, Rng::new(1, Purpose::Chain, 0, index as u64));
        let started = Instant::now();
        chain.run(STEPS, |path, _, share| {
            std::hint::black_box((path.raster, share));
        });
        time += started.elapsed();
        if time > limit {
            break;
        }
    }
    let accepted = chain.stats.mutations.iter().map(|m| m.acceptance).sum();
    Speed { steps: chain.stats.steps() as f64, rays: chain.stats.rays as f64, accepted, time }
}
