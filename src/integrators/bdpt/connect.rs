//! Connections c_{s,t} and their weights: every way to join a light subpath and an eye subpath (Veach 1997 §10).

use ajar_render::{
    World,
    bsdf::{Evaluation, Mode},
    math::{Rgb, scalar},
    path::{Edge, Kind, ROULETTE_DEPTH, Stop, Subpath, Vertex, survival, sweep::Densities},
    rng::Rng,
};
use glam::{DVec2, DVec3};

/// Most vertices of a path.
pub const MAX_VERTICES: usize = 66;

/// An end of a subpath, about to be connected: its vertex is smooth here, however the walk went on from it.
#[derive(Clone, Copy)]
struct End {
    vertex: Vertex,
    throughput: Rgb,
    to_previous: DVec3,
}

impl End {
    fn of(stop: &Stop) -> Option<Self> {
        let vertex = Vertex { mode: Mode::Smooth, ..stop.vertex };
        let scatters = vertex.kind == Kind::Surface && vertex.bsdf.has_smooth();
        scatters.then_some(Self { vertex, throughput: stop.throughput, to_previous: stop.to_previous })
    }
}

/// Whether a path is wanted, given its raster position in pixels and f*/p of path tracing alone: or more, since nobody has
/// looked yet what dims or stops light along the connection.
pub type Wanted<'w> = &'w (dyn Fn(DVec2, f64) -> bool + Sync);

/// Arrays of the sweep, kept between connections.
pub struct Connector<'w> {
    world: &'w World,
    light_fraction: f64,
    /// Which paths are wanted, all if nothing is said. Asked before looking whether something is in the way, which is most
    /// of the work.
    pub(super) wanted: Option<Wanted<'w>>,
    /// Weighted f*/p of a technique below which Russian roulette decides whether to look at all; 0 for never.
    pub(super) least: f64,
    /// Raster position of the eye subpath, pixels.
    pub(super) raster: DVec2,
    to_eye: [f64; MAX_VERTICES],
    to_light: [f64; MAX_VERTICES],
    connectable: [bool; MAX_VERTICES],
}

/// What one technique found.
#[derive(Clone, Copy, Debug, Default)]
pub struct Contribution {
    /// f/p of this technique alone, for a film of total measure 1.
    pub value: Rgb,
    /// Its share by the balance heuristic.
    pub weight: f64,
}

impl Contribution {
    const NONE: Self = Self { value: Rgb::ZERO, weight: 0.0 };

    /// What it adds to the image.
    pub fn weighted(&self) -> Rgb {
        self.value * self.weight
    }
}

/// A contribution of technique t = 1, which chooses its own place on the film.
#[derive(Clone, Copy, Debug)]
pub struct Splat {
    /// Raster position, pixels.
    pub raster: DVec2,
    /// Point of the lens.
    pub point: [f64; 2],
    /// The lens vertex.
    pub lens: Vertex,
    /// What arrives there.
    pub found: Contribution,
}

impl<'w> Connector<'w> {
    /// `light_fraction`: light paths per eye path over the whole film.
    pub fn new(world: &'w World, light_fraction: f64) -> Self {
        Self {
            world,
            light_fraction,
            wanted: None,
            least: 0.0,
            raster: DVec2::ZERO,
            to_eye: [0.0; MAX_VERTICES],
            to_light: [0.0; MAX_VERTICES],
            connectable: [false; MAX_VERTICES],
        }
    }

    /// Technique s = 0: the eye subpath's `t`-th vertex is an emitter.
    pub fn hit(&mut self, eye: &Subpath, t: usize) -> Contribution {
        let stop = &eye.stops[t - 1];
        let x0 = Vertex { mode: Mode::Smooth, ..stop.vertex };
        if x0.emitter == Vertex::NO_EMITTER {
            return Contribution::NONE;
        }
        let value = stop.throughput * self.world.emitted(&x0, stop.to_previous);
        if value == Rgb::ZERO || t == 2 {
            return Contribution { value, weight: 1.0 };
        }
        let x1 = &eye.stops[t - 2].vertex;
        let Some(edge) = Edge::between(&x0, x1, self.world.shortest_edge) else { return Contribution::NONE };
        self.fill_eye(eye, t, 0);
        self.connectable[0] = true;
        self.to_light[1] = stop.arrival_as_end * x1.survival(t - 2);
        self.to_eye[0] = self.emission_density(&x0, x1, &edge);
        let found = self.weigh(value, &x0, (0, t), inner(&[], &eye.stops[1..t - 1]));
        if self.is_wanted(&found, self.raster) { found.contribution } else { Contribution::NONE }
    }

    /// Technique s = 1: `x0`, a light end sampled with density `density`, seen from the eye subpath's `t`-th vertex.
    pub fn next_event(
        &mut self,
        (x0, density): (&Vertex, f64),
        (eye, t): (&Subpath, usize),
        rng: &mut Rng,
    ) -> Contribution {
        let Some(end) = End::of(&eye.stops[t - 1]) else { return Contribution::NONE };
        let Some(edge) = Edge::between(x0, &end.vertex, self.world.shortest_edge) else {
            return Contribution::NONE;
        };
        let emitted = self.world.emitted(x0, edge.to_eye) * (self.world.coverage(x0) / density);
        let at_eye = end.vertex.evaluate(-edge.to_eye, end.to_previous);
        let value = emitted * end.throughput * at_eye.value * geometry(x0, &end.vertex, &edge);
        let value = self.visible_unless_later(value, x0, &end.vertex, &edge);
        if value == Rgb::ZERO {
            return Contribution::NONE;
        }
        self.fill_eye(eye, t, 1);
        self.connectable[0] = true;
        self.to_eye[0] = self.emission_density(x0, &end.vertex, &edge);
        self.join_eye(eye, &end, &at_eye, x0, &edge, (1, t));
        let found = self.weigh(value, x0, (1, t), inner(&[], &eye.stops[1..t]));
        self.visible_if_wanted(&found, self.raster, (x0, &end.vertex, &edge), rng)
    }

    /// Technique s ≥ 2, t ≥ 2.
    pub fn connect(
        &mut self,
        (light, s): (&Subpath, usize),
        (eye, t): (&Subpath, usize),
        rng: &mut Rng,
    ) -> Contribution {
        let (Some(l), Some(e)) = (End::of(&light.stops[s - 1]), End::of(&eye.stops[t - 1])) else {
            return Contribution::NONE;
        };
        let Some(edge) = Edge::between(&l.vertex, &e.vertex, self.world.shortest_edge) else {
            return Contribution::NONE;
        };
        let at_light = l.vertex.evaluate(l.to_previous, edge.to_eye);
        if at_light.value == Rgb::ZERO {
            return Contribution::NONE;
        }
        let at_eye = e.vertex.evaluate(-edge.to_eye, e.to_previous);
        let scattered = l.throughput * at_light.value * at_eye.value * e.throughput;
        let value = scattered * geometry(&l.vertex, &e.vertex, &edge);
        let value = self.visible_unless_later(value, &l.vertex, &e.vertex, &edge);
        if value == Rgb::ZERO {
            return Contribution::NONE;
        }
        self.fill_light(light, s, t);
        self.fill_eye(eye, t, s);
        self.join_light(light, &l, &at_light, &e.vertex, &edge, (s, t));
        self.join_eye(eye, &e, &at_eye, &l.vertex, &edge, (s, t));
        let between = inner(&light.stops[1..s], &eye.stops[1..t]);
        let found = self.weigh(value, &light.stops[0].vertex, (s, t), between);
        self.visible_if_wanted(&found, self.raster, (&l.vertex, &e.vertex, &edge), rng)
    }

    /// Technique t = 1: the light subpath's `s`-th vertex, s ≥ 2, seen through a point of the lens.
    pub fn splat(&mut self, (light, s): (&Subpath, usize), rng: &mut Rng) -> Option<Splat> {
        let point = rng.pair();
        let end = End::of(&light.stops[s - 1])?;
        let seen = self.world.camera.connect(end.vertex.p, point)?;
        let lens = self.world.lens_vertex(seen.lens);
        let edge = Edge { to_eye: seen.direction, length: seen.distance, falloff: 1.0 };
        let scattering = end.vertex.evaluate(end.to_previous, seen.direction);
        let value =
            end.throughput * scattering.value * (end.vertex.projected(seen.direction) * seen.importance);
        let value = self.visible_unless_later(value, &end.vertex, &lens, &edge);
        if value == Rgb::ZERO {
            return None;
        }
        let k = s;
        self.fill_light(light, s, 1);
        self.connectable[k] = true;
        self.to_light[k] = seen.importance * end.vertex.projected(seen.direction);
        self.join_light(light, &end, &scattering, &lens, &edge, (s, 1));
        let found = self.weigh(value, &light.stops[0].vertex, (s, 1), inner(&light.stops[1..s], &[]));
        let found = self.visible_if_wanted(&found, seen.raster, (&end.vertex, &lens, &edge), rng);
        Some(Splat { raster: seen.raster, point, lens, found })
    }

    /// `value` times what of it crosses the edge, unless that is looked for later; no ray is cast for nothing.
    fn visible_unless_later(&self, value: Rgb, light: &Vertex, eye: &Vertex, edge: &Edge) -> Rgb {
        if value == Rgb::ZERO || self.looks_later() {
            value
        } else {
            value * self.world.transmittance(light, eye, edge)
        }
    }

    /// Whether paths have to be weighed before it is known which of them are worth a ray.
    fn looks_later(&self) -> bool {
        self.wanted.is_some() || self.least > 0.0
    }

    fn is_wanted(&self, found: &Weighed, raster: DVec2) -> bool {
        self.wanted.is_none_or(|wanted| wanted(raster, found.alone))
    }

    /// What of `found` crosses the edge from the light's side to the eye's, if it is wanted, Russian roulette spares it, and
    /// nobody has looked yet.
    fn visible_if_wanted(
        &self,
        found: &Weighed,
        raster: DVec2,
        (light, eye, edge): (&Vertex, &Vertex, &Edge),
        rng: &mut Rng,
    ) -> Contribution {
        if !self.looks_later() {
            return found.contribution;
        }
        let chance = if found.worth < self.least { found.worth / self.least } else { 1.0 };
        if !self.is_wanted(found, raster) || chance < 1.0 && rng.f64() >= chance {
            return Contribution::NONE;
        }
        let Contribution { value, weight } = found.contribution;
        Contribution { value: value * self.world.transmittance(light, eye, edge) / chance, weight }
    }

    fn emission_density(&self, x0: &Vertex, x1: &Vertex, edge: &Edge) -> f64 {
        let native = self.world.lights.emit_density(x0, edge.to_eye);
        edge.density(native, x0, x1, x0.direction_is_fixed())
    }

    /// Steps of the eye subpath that do not depend on the connection: the path's last `t` vertices after `s` others.
    fn fill_eye(&mut self, eye: &Subpath, t: usize, s: usize) {
        let k = s + t - 1;
        for j in 0..t.saturating_sub(1) {
            let (i, stop) = (k - j, &eye.stops[j]);
            self.connectable[i] = stop.vertex.connectable();
            self.to_eye[i] = stop.back * stop.vertex.survival(i);
            self.to_light[i] = eye.stops[j + 1].arrival * stop.vertex.survival(j);
        }
    }

    /// The same for the path's first `s` vertices, before `t` others.
    fn fill_light(&mut self, light: &Subpath, s: usize, t: usize) {
        let k = s + t - 1;
        for i in 0..s - 1 {
            let stop = &light.stops[i];
            self.connectable[i] = stop.vertex.connectable();
            self.to_light[i] = stop.back * stop.vertex.survival(k - i);
            self.to_eye[i] = light.stops[i + 1].arrival * stop.vertex.survival(i);
        }
    }

    /// Steps around the eye end, whose light-side neighbour is `light`.
    fn join_eye(
        &mut self,
        eye: &Subpath,
        end: &End,
        at: &Evaluation,
        light: &Vertex,
        edge: &Edge,
        (s, t): (usize, usize),
    ) {
        let (x, previous) = (&end.vertex, &eye.stops[t - 2].vertex);
        self.connectable[s] = true;
        self.to_light[s + 1] = eye.stops[t - 1].arrival_as_end * previous.survival(t - 2);
        self.to_light[s] = edge.density(at.toward_light * x.survival(t - 1), x, light, false);
        let Some(back) = Edge::between(x, previous, 0.0) else { return };
        self.to_eye[s] = back.density(at.toward_eye * x.survival(s), x, previous, false);
    }

    /// Steps around the light end, whose eye-side neighbour is `eye`.
    fn join_light(
        &mut self,
        light: &Subpath,
        end: &End,
        at: &Evaluation,
        eye: &Vertex,
        edge: &Edge,
        (s, t): (usize, usize),
    ) {
        let (x, previous) = (&end.vertex, &light.stops[s - 2].vertex);
        self.connectable[s - 1] = true;
        self.to_eye[s - 2] = light.stops[s - 1].arrival_as_end * previous.survival(s - 2);
        self.to_eye[s - 1] = edge.density(at.toward_eye * x.survival(s - 1), x, eye, false);
        let Some(back) = Edge::between(previous, x, 0.0) else { return };
        self.to_light[s - 1] = back.density(at.toward_light * x.survival(t), x, previous, false);
    }

    /// Weighs what a technique found, where `inner` are the vertices between the ends, from the eye's side.
    fn weigh<'v>(
        &self,
        value: Rgb,
        x0: &Vertex,
        (s, t): (usize, usize),
        inner: impl Iterator<Item = &'v Stop>,
    ) -> Weighed {
        let k = s + t - 1;
        let densities = Densities {
            to_eye: &self.to_eye[..=k],
            to_light: &self.to_light[..=k],
            connectable: &self.connectable[..=k],
            light: self.world.lights.density(x0),
            light_can_be_hit: x0.can_be_met(),
            light_fraction: self.light_fraction,
        };
        // Technique s walks on at x_{s+1}, and so survives roulette there; short paths know none.
        let asked = self.wanted.is_some();
        let fewer = if asked && k > ROULETTE_DEPTH { roulette_of_walks(inner) } else { 1.0 };
        // Sampled light ends carry their coverage; f, of which path tracing's share is a part, does not.
        let covered = if asked && s > 0 { self.world.coverage(x0) } else { 1.0 };
        let (mut all, mut by_eye) = (0.0, 0.0);
        densities.for_each_ratio(s, |s, ratio| {
            all += ratio;
            if s < 2 {
                by_eye += if k > s + ROULETTE_DEPTH { ratio * fewer } else { ratio };
            }
        });
        let mut worth = scalar(value) / all;
        if t == 1 {
            by_eye *= self.light_fraction;
            worth /= self.light_fraction;
        }
        Weighed {
            contribution: Contribution { value, weight: 1.0 / all },
            worth,
            alone: scalar(value) / (by_eye * covered),
        }
    }
}

/// What a technique found, what that is worth, and what path tracing alone would make of it, where a filter asks.
struct Weighed {
    contribution: Contribution,
    /// Weighted f*/p for an eye path of its own for each light path.
    worth: f64,
    /// f*/p of path tracing; infinite where it never finds the path.
    alone: f64,
}

/// Vertices between the ends of a path, from the eye's side.
fn inner<'a>(light: &'a [Stop], eye: &'a [Stop]) -> impl Iterator<Item = &'a Stop> {
    eye.iter().chain(light.iter().rev())
}

/// How much less often Russian roulette of the path tracer lets a long path through than that of bidirectional samples:
/// it begins with the albedo of all vertices instead of one.
fn roulette_of_walks<'v>(inner: impl Iterator<Item = &'v Stop>) -> f64 {
    let (mut all, mut last) = (1.0, 1.0);
    for stop in inner.take(ROULETTE_DEPTH) {
        last = stop.vertex.bsdf.albedo_bound();
        all *= last;
    }
    survival(all) / survival(last)
}

/// Geometric term G without visibility.
fn geometry(light: &Vertex, eye: &Vertex, edge: &Edge) -> f64 {
    light.projected(edge.to_eye) * eye.projected(edge.to_eye) * edge.falloff
}
