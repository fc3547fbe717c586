//! A random walk from the light or from the eye, with what connections and the density sweep need of it.

use glam::DVec3;

use super::{Edge, Vertex};
use crate::{bsdf::Side, light::Emission, math::Rgb, rng::Rng, world::World};

/// A vertex of a walk with what the walk knows about it. "Back" is towards the walk's start. Densities exclude roulette.
#[derive(Clone, Copy, Debug)]
pub struct Stop {
    /// The vertex in the mode in which the walk went on from it, smooth if it ended here.
    pub vertex: Vertex,
    /// Factors of f over density up to the vertex, its own scattering excluded.
    pub throughput: Rgb,
    /// Unit direction to the vertex before.
    pub to_previous: DVec3,
    /// Density of the step that arrived here, for a path in which the vertex is `vertex`.
    pub arrival: f64,
    /// The same for a path that connects here, so that the vertex is smooth.
    pub arrival_as_end: f64,
    /// Density of the step back; 0 where the walk ended.
    pub back: f64,
}

/// A walk.
#[derive(Clone, Debug, Default)]
pub struct Subpath {
    /// Its vertices in order.
    pub stops: Vec<Stop>,
}

/// A ray of a walk on its way to the next vertex.
struct Leg {
    origin: DVec3,
    direction: DVec3,
    density: f64,
    throughput: Rgb,
}

impl Subpath {
    /// Number of vertices.
    pub fn len(&self) -> usize {
        self.stops.len()
    }

    /// Whether it has no vertex.
    pub fn is_empty(&self) -> bool {
        self.stops.is_empty()
    }

    /// Walks from a light to at most `max` vertices.
    pub fn trace_light(&mut self, world: &World, max: usize, rng: &mut Rng) {
        self.stops.clear();
        let Some((x0, density)) = world.lights.sample(rng.f64(), rng.pair()) else { return };
        let (u_direction, u_side) = (rng.pair(), rng.f64());
        let throughput = Rgb::splat(world.coverage(&x0) / density);
        self.stops.push(Stop::start(x0, throughput));
        if max < 2 {
            return;
        }
        let Some(emission) = world.lights.emit(&x0, u_direction, u_side) else { return };
        let Emission { origin, direction, density } = emission;
        let radiance = world.emitted(&x0, direction) * x0.projected(direction);
        let origin = if x0.infinite() { origin } else { x0.leave(direction) };
        let throughput = throughput * radiance / density;
        self.go(world, Side::TowardEye, Leg { origin, direction, density, throughput }, max, rng);
    }

    /// Walks from the lens vertex `lens`, whose first ray goes in `direction`, to at most `max` vertices.
    pub fn trace_eye(&mut self, world: &World, lens: Vertex, direction: DVec3, max: usize, rng: &mut Rng) {
        self.stops.clear();
        self.stops.push(Stop::start(lens, Rgb::ONE));
        let density = world.camera.direction_density(direction);
        let leg = Leg { origin: lens.p, direction, density, throughput: Rgb::ONE };
        self.go(world, Side::TowardLight, leg, max, rng);
    }

    fn go(&mut self, world: &World, side: Side, mut leg: Leg, max: usize, rng: &mut Rng) {
        while self.len() < max && leg.throughput != Rgb::ZERO {
            let Some((stop, edge)) = self.arrive(world, side, &leg, rng) else { return };
            self.stops.push(stop);
            if stop.vertex.infinite() || self.len() == max {
                return;
            }
            let Some(next) = self.scatter(world, side, &leg, &edge, rng) else { return };
            leg = next;
        }
    }

    /// Follows a leg to the next vertex, its mode still smooth.
    fn arrive(&self, world: &World, side: Side, leg: &Leg, rng: &mut Rng) -> Option<(Stop, Edge)> {
        let from_lens = side == Side::TowardLight && self.len() == 1;
        let seed = rng.next_u32();
        let vertex = match world.trace(leg.origin, leg.direction, from_lens, seed) {
            Some(vertex) => vertex,
            None if side == Side::TowardLight => world.lights.surroundings(leg.direction)?,
            None => return None,
        };
        let source = &self.stops.last()?.vertex;
        let (light, eye) = match side {
            Side::TowardLight => (&vertex, source),
            Side::TowardEye => (source, &vertex),
        };
        let edge = Edge::between(light, eye, world.shortest_edge)?;
        let arrival = edge.density(leg.density, source, &vertex, world.fixed_direction(source));
        let throughput = leg.throughput * world.absorption(light, eye, &edge);
        let stop = Stop {
            vertex,
            throughput,
            to_previous: -leg.direction,
            arrival,
            arrival_as_end: arrival,
            back: 0.0,
        };
        Some((stop, edge))
    }

    /// Chooses how the walk goes on from its last vertex and completes what is known about it.
    fn scatter(&mut self, world: &World, side: Side, leg: &Leg, edge: &Edge, rng: &mut Rng) -> Option<Leg> {
        let edges = self.len() - 1;
        let [.., before, here] = self.stops.as_mut_slice() else { return None };
        let (source, vertex) = (&before.vertex, &mut here.vertex);
        let step = vertex.scatter(side, here.to_previous, rng.f64(), rng.pair())?;
        let survival = vertex.survival(edges);
        if rng.f64() >= survival {
            return None;
        }
        vertex.mode = step.mode;
        here.arrival = edge.density(leg.density, source, vertex, world.fixed_direction(source));
        here.back = edge.density(step.back, vertex, source, false);
        Some(Leg {
            origin: vertex.leave(step.direction),
            direction: step.direction,
            density: step.density,
            throughput: here.throughput * step.weight / survival,
        })
    }
}

impl Stop {
    fn start(vertex: Vertex, throughput: Rgb) -> Self {
        let to_previous = DVec3::ZERO;
        Self { vertex, throughput, to_previous, arrival: 0.0, arrival_as_end: 0.0, back: 0.0 }
    }
}
