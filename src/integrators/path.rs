//! Path tracing with next-event estimation (Kajiya 1986; multiple importance sampling: Veach & Guibas 1995).

use ajar_render::{
    World,
    bsdf::{Mode, Side},
    film::RoundFilm,
    math::Rgb,
    path::{Edge, ROULETTE_DEPTH, Step, Vertex, survival},
    sampler::{Sequence, Sobol},
};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

use crate::{Context, Integrator, Rounds};

/// The path tracer: one light sample and one continuation a vertex, weighed by the balance heuristic.
#[derive(Clone, Copy, Debug)]
pub struct PathTracer;

impl Integrator for PathTracer {
    fn name(&self) -> &'static str {
        "path"
    }

    fn description(&self) -> &'static str {
        "path tracing with next-event estimation: best where light reaches most of the scene directly"
    }

    fn max_depth(&self) -> usize {
        4096
    }

    fn prepare<'a>(&self, cx: Context<'a>) -> Box<dyn Rounds + 'a> {
        Box::new(PathTracerRounds(cx))
    }
}

struct PathTracerRounds<'a>(Context<'a>);

impl Rounds for PathTracerRounds<'_> {
    fn scale(&self) -> f64 {
        1.0 / f64::from(self.0.settings.samples_per_round)
    }

    fn render(&self, round: u32, film: &RoundFilm) {
        let cx = &self.0;
        let window = cx.settings.window;
        (window.y0..window.y1).into_par_iter().for_each(|y| {
            for x in window.x0..window.x1 {
                // A row takes longer than those who stop a render are to wait.
                if cx.cancelled() {
                    return;
                }
                let pixel = u64::from(y) * u64::from(cx.world.camera.width) + u64::from(x);
                let sequence = Sequence::new(cx.settings.seed, 0, pixel);
                let mut sum = Rgb::ZERO;
                for sample in cx.settings.samples(round) {
                    let mut sampler = sequence.sample(sample);
                    let [dx, dy] = sampler.next_2d();
                    let raster = DVec2::new(f64::from(x) + dx, f64::from(y) + dy);
                    sum += radiance(cx.world, cx.settings.max_depth, raster, &mut sampler);
                }
                if let Some(index) = window.index(x, y) {
                    film.add(index, sum);
                }
            }
        });
    }
}

/// State of a walk from the eye that is about to leave `from`.
struct Walk<'v> {
    from: &'v mut Vertex,
    origin: DVec3,
    direction: DVec3,
    throughput: Rgb,
    /// Native density of the direction, roulette included.
    density: f64,
    /// Whether next-event estimation at `from` competes with meeting a light by chance.
    competes: bool,
    /// Product of the albedos met so far, until roulette begins.
    albedo: f64,
}

/// Watches a walk of the path tracer.
pub trait Visitor {
    /// The walk goes on from `vertex`, the lens first; its mode is set.
    fn leave(&mut self, _vertex: &Vertex) {}

    /// A path that carries light is complete.
    fn found(&mut self, path: &Found<'_>);
}

/// A complete path of the path tracer: the vertices that its walk left, and these.
#[derive(Clone, Copy)]
pub struct Found<'a> {
    /// f over the density of both ways in which the path tracer makes the path, met and sampled lights.
    pub value: Rgb,
    /// Edges.
    pub edges: usize,
    /// The light end.
    pub x0: &'a Vertex,
    /// The vertex that saw it by next-event estimation; `None` if the walk met it.
    pub seen_from: Option<&'a Vertex>,
}

struct Sum(Rgb);

impl Visitor for Sum {
    fn found(&mut self, path: &Found<'_>) {
        self.0 += path.value;
    }
}

/// Estimates the radiance that reaches `raster` over paths of at most `max_depth` edges.
pub fn radiance(world: &World, max_depth: usize, raster: DVec2, sampler: &mut Sobol) -> Rgb {
    let mut sum = Sum(Rgb::ZERO);
    walk(world, max_depth, raster, sampler, &mut sum);
    sum.0
}

/// Walks from the lens; every contribution to the radiance at `raster` goes to `visitor`. Returns the lens point.
pub fn walk(
    world: &World,
    max_depth: usize,
    raster: DVec2,
    sampler: &mut Sobol,
    visitor: &mut impl Visitor,
) -> [f64; 2] {
    let lens = sampler.next_2d();
    let ray = world.camera.ray(raster, lens);
    let (mut from, mut here) = (world.lens_vertex(ray.origin), world.lens_vertex(ray.origin));
    let (mut here, mut light) = (&mut here, world.lens_vertex(ray.origin));
    let mut walk = Walk {
        from: &mut from,
        origin: ray.origin,
        direction: ray.direction,
        throughput: Rgb::ONE,
        density: world.camera.direction_density(ray.direction),
        competes: false,
        albedo: 1.0,
    };
    visitor.leave(walk.from);
    for edges in 1..=max_depth {
        let seed = if world.has_alpha() { (sampler.next_1d() * 4_294_967_296.0) as u32 } else { 0 };
        if !world.trace_into(walk.origin, walk.direction, edges == 1, seed, here) {
            if let Some(sky) = world.lights.surroundings(walk.direction) {
                met_light(world, &sky, &walk, edges, visitor);
            }
            break;
        }
        let Some(edge) = Edge::between(here, walk.from, world.shortest_edge) else { break };
        walk.throughput *= world.absorption(here, walk.from, &edge);
        if here.emitter != Vertex::NO_EMITTER {
            met_light(world, here, &walk, edges, visitor);
        }
        if edges == max_depth {
            break;
        }
        let w_e = -walk.direction;
        let survival = walk.survival(here, edges);
        let [u, v, choice, u_survival] = sampler.next_4d();
        let next_event = (choice, [u, v]);
        if here.bsdf.has_smooth() {
            let next = NextEvent { edges: edges + 1, survival, x0: &mut light };
            next_event_estimate(world, here, &walk, next, next_event, visitor);
        }
        let [u, v, u_lobe, _] = sampler.next_4d();
        let Some(step) = here.scatter(Side::TowardLight, w_e, u_lobe, [u, v]) else { break };
        if u_survival >= survival {
            break;
        }
        walk.go_on(here, &step, survival);
        if walk.throughput == Rgb::ZERO {
            break;
        }
        std::mem::swap(&mut walk.from, &mut here);
        visitor.leave(walk.from);
    }
    lens
}

impl Walk<'_> {
    /// Probability of surviving Russian roulette at `here`: first the albedo of the whole walk, later that of the surface
    /// alone, which keeps throughputs near 1. A function of the places visited, whatever light was found.
    fn survival(&mut self, here: &Vertex, edges: usize) -> f64 {
        if edges <= ROULETTE_DEPTH {
            self.albedo *= here.bsdf.albedo_bound();
        }
        if edges == ROULETTE_DEPTH { survival(self.albedo) } else { here.survival(edges) }
    }

    /// Leaves `from`, which is yet to become the vertex that it is named after.
    fn go_on(&mut self, from: &mut Vertex, step: &Step, survival: f64) {
        from.mode = step.mode;
        self.origin = from.leave(step.direction);
        self.direction = step.direction;
        self.throughput *= step.weight / survival;
        self.density = step.density * survival;
        self.competes = step.mode == Mode::Smooth;
    }
}

/// A light that the walk met by chance, weighed against next-event estimation.
fn met_light(world: &World, x0: &Vertex, walk: &Walk<'_>, edges: usize, visitor: &mut impl Visitor) {
    let mut value = walk.throughput * world.emitted(x0, -walk.direction);
    if value == Rgb::ZERO {
        return;
    }
    if walk.competes {
        let Some(edge) = Edge::between(x0, walk.from, world.shortest_edge) else { return };
        let met = edge.density(walk.density, walk.from, x0, false);
        let hidden = if world.has_alpha() { world.coverage(x0) * world.passed(x0, walk.from) } else { 1.0 };
        // Where next-event estimation sees the light half covered it is half as good.
        value *= met * hidden / (met * hidden + world.lights.density(x0));
    }
    visitor.found(&Found { value, edges, x0, seen_from: None });
}

/// What next-event estimation needs besides the vertex.
struct NextEvent<'v> {
    /// Edges of the path that it makes.
    edges: usize,
    /// Probability that the walk goes on from the vertex.
    survival: f64,
    /// Room for the light's end.
    x0: &'v mut Vertex,
}

/// One light sample for `here`, weighed against meeting the same light by chance.
fn next_event_estimate(
    world: &World,
    here: &Vertex,
    walk: &Walk<'_>,
    next: NextEvent<'_>,
    (choice, u): (f64, [f64; 2]),
    visitor: &mut impl Visitor,
) {
    let NextEvent { edges, survival, x0 } = next;
    let Some(density) = world.lights.sample_into(choice, u, x0) else { return };
    let Some(edge) = Edge::between(x0, here, world.shortest_edge) else { return };
    let geometry = x0.projected(edge.to_eye) * here.projected(edge.to_eye) * edge.falloff;
    let scattering = here.evaluate(-edge.to_eye, -walk.direction);
    let value = scattering.value * world.emitted(x0, edge.to_eye) * (geometry / density);
    if walk.throughput * value == Rgb::ZERO {
        return;
    }
    let hidden = world.passed(x0, here) * world.coverage(x0);
    if hidden <= 0.0 {
        return;
    }
    let mut value = walk.throughput * value * world.absorption(x0, here, &edge) * hidden;
    if value == Rgb::ZERO {
        return;
    }
    if x0.can_be_met() {
        let met = edge.density(scattering.toward_light * survival, here, x0, false);
        value *= density / (density + met * hidden);
    }
    visitor.found(&Found { value, edges, x0, seen_from: Some(here) });
}
