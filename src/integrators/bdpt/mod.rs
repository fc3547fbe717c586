//! Bidirectional path tracing (Lafortune & Willems 1993; Veach & Guibas 1994) with all techniques s, t and weights from
//! one density sweep.

mod connect;

pub use connect::{Connector, Contribution, MAX_VERTICES, Splat};

use ajar_render::{
    World,
    film::RoundFilm,
    math::Rgb,
    path::Subpath,
    rng::{Purpose, Rng},
    sampler::Sequence,
};
use glam::DVec2;
use rayon::prelude::*;

use crate::{Context, Integrator};

/// The bidirectional path tracer.
#[derive(Clone, Copy, Debug)]
pub struct Bdpt;

impl Integrator for Bdpt {
    fn name(&self) -> &'static str {
        "bdpt"
    }

    fn description(&self) -> &'static str {
        "bidirectional path tracing: caustics and light that arrives through small openings"
    }

    fn max_depth(&self) -> usize {
        MAX_VERTICES - 2
    }

    fn render_round(&self, cx: &Context<'_>, round: u32, film: &RoundFilm) {
        let (window, camera) = (cx.settings.window, &cx.world.camera);
        let light_fraction = window.pixels() as f64 / camera.pixels() as f64;
        (window.y0..window.y1).into_par_iter().for_each(|y| {
            let mut tracer = Tracer::new(cx.world, cx.settings.max_depth, light_fraction);
            for x in window.x0..window.x1 {
                if cx.cancelled() {
                    return;
                }
                let pixel = u64::from(y) * u64::from(camera.width) + u64::from(x);
                let sequence = Sequence::new(cx.settings.seed, 0, pixel);
                let mut sum = Rgb::ZERO;
                for (number, sample) in cx.settings.samples(round).enumerate() {
                    let mut sobol = sequence.sample(sample);
                    let [dx, dy] = sobol.next_2d();
                    let raster = DVec2::new(f64::from(x) + dx, f64::from(y) + dy);
                    let index = pixel * u64::from(cx.settings.samples_per_round) + number as u64;
                    let mut rng = Rng::new(cx.settings.seed, Purpose::Bidirectional, round, index);
                    sum += tracer.sample(raster, sobol.next_2d(), &mut rng, |splat| {
                        let (x, y) = (splat.raster.x as u32, splat.raster.y as u32);
                        if let Some(index) = window.index(x, y) {
                            film.add(index, splat.found.weighted() / light_fraction);
                        }
                    });
                }
                if let Some(index) = window.index(x, y) {
                    film.add(index, sum);
                }
            }
        });
    }
}

/// Builds bidirectional samples; keeps its memory between them.
pub struct Tracer<'w> {
    world: &'w World,
    max_depth: usize,
    light: Subpath,
    eye: Subpath,
    connector: Connector<'w>,
}

impl<'w> Tracer<'w> {
    /// Paths of at most `max_depth` edges; `light_fraction` light paths per eye path over the whole film.
    pub fn new(world: &'w World, max_depth: usize, light_fraction: f64) -> Self {
        let connector = Connector::new(world, light_fraction);
        Self { world, max_depth, light: Subpath::default(), eye: Subpath::default(), connector }
    }

    /// One eye and one light subpath and all their connections. Returns what arrives at `raster` and hands splats, for a
    /// film of pixel measure, to `splat`.
    pub fn sample(
        &mut self,
        raster: DVec2,
        lens: [f64; 2],
        rng: &mut Rng,
        mut splat: impl FnMut(Splat),
    ) -> Rgb {
        let ray = self.world.camera.ray(raster, lens);
        self.eye.trace_eye(
            self.world,
            self.world.lens_vertex(ray.origin),
            ray.direction,
            self.max_depth + 1,
            rng,
        );
        self.light.trace_light(self.world, self.max_depth, rng);
        let mut sum = Rgb::ZERO;
        for t in 2..=self.eye.len() {
            sum += self.connector.hit(&self.eye, t).weighted();
            if self.eye.stops[t - 1].vertex.infinite() || t == self.max_depth + 1 {
                continue;
            }
            if let Some((x0, density)) = self.world.lights.sample(rng.f64(), rng.pair()) {
                sum += self.connector.next_event(&x0, density, &self.eye, t).weighted();
            }
            for s in 2..=self.light.len().min(self.max_depth + 1 - t) {
                sum += self.connector.connect(&self.light, s, &self.eye, t).weighted();
            }
        }
        for s in 2..=self.light.len() {
            if let Some(found) = self.connector.splat(&self.light, s, rng.pair()) {
                splat(found);
            }
        }
        sum
    }
}
