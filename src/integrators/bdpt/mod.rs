//! Bidirectional path tracing (Lafortune & Willems 1993; Veach & Guibas 1994) with all techniques s, t and weights from
//! one density sweep.

mod connect;

pub use connect::{Connector, Contribution, MAX_VERTICES, Splat, Wanted};

use ajar_render::{
    World,
    bsdf::Mode,
    film::RoundFilm,
    math::Rgb,
    path::{Kind, Stop, Subpath, Vertex},
    rng::{Purpose, Rng},
    sampler::Sequence,
};
use glam::DVec2;
use rayon::prelude::*;

use crate::{Context, Integrator, Rounds};

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

    fn prepare<'a>(&self, cx: Context<'a>) -> Box<dyn Rounds + 'a> {
        Box::new(BdptRounds(cx))
    }
}

struct BdptRounds<'a>(Context<'a>);

impl Rounds for BdptRounds<'_> {
    fn scale(&self) -> f64 {
        1.0 / f64::from(self.0.settings.samples_per_round)
    }

    fn render(&self, round: u32, film: &RoundFilm) {
        let cx = &self.0;
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
                    tracer.sample(raster, sobol.next_2d(), &mut rng, |found| {
                        if found.t > 1 {
                            sum += found.contribution.weighted();
                        } else if let Some(index) = window.index(found.raster.x as u32, found.raster.y as u32)
                        {
                            film.add(index, found.contribution.weighted() / light_fraction);
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

    /// Finds no paths but those that are wanted, and light seen directly.
    pub fn only(mut self, wanted: Wanted<'w>) -> Self {
        self.connector.wanted = Some(wanted);
        self
    }

    /// Plays Russian roulette with connections whose weighted f*/p is less than `least`, before it casts rays for them.
    pub fn with_roulette_below(mut self, least: f64) -> Self {
        self.connector.least = least;
        self
    }

    /// One eye and one light subpath and all their connections that carry light. Contributions are for a film of pixel
    /// measure.
    pub fn sample(
        &mut self,
        raster: DVec2,
        lens: [f64; 2],
        rng: &mut Rng,
        mut visit: impl FnMut(&Found<'_>),
    ) {
        let Self { world, max_depth, light, eye, connector } = self;
        connector.raster = raster;
        let ray = world.camera.ray(raster, lens);
        eye.trace_eye(world, world.lens_vertex(ray.origin), ray.direction, *max_depth + 1, rng);
        light.trace_light(world, *max_depth, rng);
        let (light, eye) = (&*light, &*eye);
        let mut found = |s, t, raster, lens, end: Option<&Vertex>, contribution: Contribution| {
            if contribution.weight > 0.0 && contribution.value != Rgb::ZERO {
                visit(&Found { s, t, raster, lens, end, contribution, light, eye });
            }
        };
        for t in 2..=eye.len() {
            found(0, t, raster, lens, None, connector.hit(eye, t));
            if eye.stops[t - 1].vertex.infinite() || t == *max_depth + 1 {
                continue;
            }
            if let Some((x0, density)) = world.lights.sample(rng.f64(), rng.pair()) {
                found(1, t, raster, lens, Some(&x0), connector.next_event((&x0, density), (eye, t), rng));
            }
            for s in 2..=light.len().min(*max_depth + 1 - t) {
                found(s, t, raster, lens, None, connector.connect((light, s), (eye, t), rng));
            }
        }
        for s in 2..=light.len() {
            if let Some(splat) = connector.splat((light, s), rng) {
                found(s, 1, splat.raster, splat.point, Some(&splat.lens), splat.found);
            }
        }
    }
}

/// What a technique of a bidirectional sample found: s vertices from the light, t from the eye.
#[derive(Clone, Copy)]
pub struct Found<'a> {
    /// Vertices of the light subpath, or the light end sampled for next-event estimation.
    pub s: usize,
    /// Vertices of the eye subpath, or the lens.
    pub t: usize,
    /// Raster position, pixels.
    pub raster: DVec2,
    /// Point of the lens.
    pub lens: [f64; 2],
    /// The vertex that belongs to no subpath: the light for s = 1, the lens for t = 1.
    end: Option<&'a Vertex>,
    /// What arrives.
    pub contribution: Contribution,
    light: &'a Subpath,
    eye: &'a Subpath,
}

impl Found<'_> {
    /// What x_0 is.
    pub fn light_kind(&self) -> Kind {
        match self.end.filter(|_| self.s == 1) {
            Some(light) => light.kind,
            None if self.s == 0 => self.eye.stops[self.t - 1].vertex.kind,
            None => self.light.stops[0].vertex.kind,
        }
    }

    /// Whether x_1 scatters smoothly in this path.
    pub fn second_is_connectable(&self) -> bool {
        self.s < 3 || self.light.stops[1].vertex.connectable()
    }

    /// Hands the path's vertices, light to eye, to `push`.
    pub fn vertices(&self, mut push: impl FnMut(Vertex)) {
        let smooth = |vertex: &Vertex| Vertex { mode: Mode::Smooth, ..*vertex };
        let inner = |stops: &[Stop], n: usize, i: usize| {
            if i + 1 == n { smooth(&stops[i].vertex) } else { stops[i].vertex }
        };
        match self.end.filter(|_| self.s == 1) {
            Some(light) => push(*light),
            None => (0..self.s).for_each(|i| push(inner(&self.light.stops, self.s, i))),
        }
        match self.end.filter(|_| self.t == 1) {
            Some(lens) => push(*lens),
            None => (0..self.t).rev().for_each(|i| push(inner(&self.eye.stops, self.t, i))),
        }
    }
}
