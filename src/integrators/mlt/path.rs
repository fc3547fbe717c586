//! A complete light path x_0 … x_k with everything that mutations ask of it.
//!
//! f and all densities are written relative to the same measure (mlt.md §1–2 of the design): products of the vertices'
//! measures; generalized geometry of Dirac chains divided out; and, since rays stop at partially opaque surfaces by
//! chance, the opacities of all vertices and what all edges let through divided out as well. A technique that connects
//! x_c and x_{c+1} instead of casting a ray between them therefore has its density divided by what that edge lets through.

use std::sync::atomic::{AtomicBool, Ordering};

use ajar_render::{
    World,
    bsdf::{Mode, Side},
    math::{Rgb, scalar},
    path::{Edge, Kind, Vertex},
};
use glam::DVec2;

use super::Reject;
use crate::{Context, Window, bdpt::MAX_VERTICES};

/// Where paths live: the scene and the part of the film that counts; and whether anybody still wants them.
#[derive(Clone, Copy, Debug)]
pub struct Space<'w> {
    /// The prepared scene.
    pub world: &'w World,
    /// Pixels to render.
    pub window: Window,
    /// Edges of the longest path.
    pub max_depth: usize,
    /// Pixels of the film over pixels of the window: f is normalized so that uniform raster positions in the window have
    /// throughput 1.
    pub film_ratio: f64,
    /// Set by others to stop early.
    cancel: &'w AtomicBool,
}

static NEVER: AtomicBool = AtomicBool::new(false);

impl<'w> Space<'w> {
    /// The paths of at most `max_depth` edges that arrive in `window`.
    pub fn new(world: &'w World, window: Window, max_depth: usize) -> Self {
        let film_ratio = world.camera.pixels() as f64 / window.pixels() as f64;
        Self { world, window, max_depth, film_ratio, cancel: &NEVER }
    }

    /// The paths among them of at most `max_depth` edges.
    pub fn with_depth(&self, max_depth: usize) -> Self {
        Self { max_depth, ..*self }
    }

    /// Those that a render asks for.
    pub fn of(cx: &Context<'w>) -> Self {
        Self { cancel: cx.cancel, ..Self::new(cx.world, cx.settings.window, cx.settings.max_depth) }
    }

    /// Whether whatever is found from now on is worthless.
    #[inline]
    pub fn cancelled(&self) -> bool {
        self.cancel.load(Ordering::Relaxed)
    }

    /// The pixel of the window at a raster position.
    pub fn pixel(&self, raster: DVec2) -> Option<usize> {
        let inside = raster.x >= 0.0 && raster.y >= 0.0;
        inside.then(|| self.window.index(raster.x as u32, raster.y as u32)).flatten()
    }

    /// The raster position of a point of the unit square.
    pub fn raster(&self, [u, v]: [f64; 2]) -> DVec2 {
        let low = DVec2::new(self.window.x0.into(), self.window.y0.into());
        low + DVec2::new(u * f64::from(self.window.width()), v * f64::from(self.window.height()))
    }
}

/// A vertex x_i and the edge from it to x_{i+1}.
#[derive(Clone, Copy, Debug)]
pub struct Node {
    /// The vertex, in the mode in which the path scatters there.
    pub vertex: Vertex,
    /// Its factor of f: emission at x_0, scattering inside, 1 at the lens.
    pub factor: Rgb,
    /// Density of x_{i+1} given x_i.
    pub to_eye: f64,
    /// Density of x_{i-1} given x_i.
    pub to_light: f64,
    /// The part of `to_eye` that is the probability of a Dirac event; 1 at smooth vertices.
    pub chance_to_eye: f64,
    /// The same of `to_light`.
    pub chance_to_light: f64,
    /// The edge to x_{i+1}.
    pub edge: Edge,
    /// Geometric term of the edge without visibility; 1 where an end is Dirac. Includes importance at the lens.
    pub geometry: f64,
    /// What surfaces on the edge let through.
    pub passed: f64,
    /// What the medium along the edge lets through.
    pub absorption: Rgb,
    /// Albedo that Russian roulette of the path tracer sees.
    pub albedo: f64,
}

impl Node {
    /// Its vertex has become another.
    pub fn arrived(&mut self) {
        self.albedo = self.vertex.bsdf.albedo_bound();
    }

    /// Takes over what was measured of `other`, whose vertex is the same in all but, at the lens, its place.
    pub fn copy_measured(&mut self, other: &Self) {
        self.vertex.p = other.vertex.p;
        (self.factor, self.absorption) = (other.factor, other.absorption);
        (self.to_eye, self.to_light) = (other.to_eye, other.to_light);
        (self.edge, self.geometry, self.passed) = (other.edge, other.geometry, other.passed);
    }

    /// Whether it equals `other` in all that changes along a chain.
    pub fn is(&self, other: &Self) -> bool {
        let (a, b) = (&self.vertex, &other.vertex);
        a.p == b.p
            && a.site == b.site
            && a.mode == b.mode
            && (self.factor, self.absorption) == (other.factor, other.absorption)
            && (self.to_eye, self.to_light) == (other.to_eye, other.to_light)
            && (self.geometry, self.passed) == (other.geometry, other.passed)
    }

    /// A vertex of which nothing else is known yet.
    pub fn new(vertex: Vertex) -> Self {
        Self {
            vertex,
            factor: Rgb::ONE,
            to_eye: 0.0,
            to_light: 0.0,
            chance_to_eye: 1.0,
            chance_to_light: 1.0,
            edge: Edge { to_eye: glam::DVec3::ZERO, length: 0.0, falloff: 1.0 },
            geometry: 1.0,
            passed: 1.0,
            absorption: Rgb::ONE,
            albedo: vertex.bsdf.albedo_bound(),
        }
    }
}

/// What mutations fit a path by: where connections may end, and what x_0 is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Signature {
    /// Bit i: a connection may end at x_i.
    connectable: u128,
    /// Number of edges k.
    edges: usize,
    /// Whether x_0 lies infinitely far.
    infinite: bool,
}

impl Signature {
    /// Number of edges k.
    pub fn edges(&self) -> usize {
        self.edges
    }

    /// Whether a connection may end at x_i.
    pub fn connectable(&self, i: usize) -> bool {
        self.connectable >> i & 1 == 1
    }

    /// Bit i: a connection may end at x_i.
    pub fn ends(&self) -> u128 {
        self.connectable
    }

    /// Whether x_0 lies infinitely far.
    pub fn is_lit_from_far(&self) -> bool {
        self.infinite
    }
}

/// A path.
#[derive(Clone, Debug, Default)]
pub struct Path {
    /// x_0 … x_k.
    pub nodes: Vec<Node>,
    /// Raster position, pixels: canonical, never derived from the geometry again.
    pub raster: DVec2,
    /// Point of the lens in [0, 1)².
    pub lens: [f64; 2],
    /// Contribution.
    pub f: Rgb,
    /// Density of x_0 as a sampled light end.
    pub light: f64,
    /// What mutations fit it by.
    pub signature: Signature,
}

impl Path {
    /// Room for the longest path, so that chains do not allocate.
    pub fn with_capacity() -> Self {
        Self { nodes: Vec::with_capacity(MAX_VERTICES), ..Self::default() }
    }

    /// Number of edges k.
    pub fn edges(&self) -> usize {
        self.nodes.len() - 1
    }

    /// f*, the scalar contribution.
    pub fn scalar(&self) -> f64 {
        scalar(self.f)
    }

    /// Whether a connection may end at x_i.
    pub fn connectable(&self, i: usize) -> bool {
        self.signature.connectable(i)
    }

    fn sign(&mut self) {
        let bit = |(i, node): (usize, &Node)| u128::from(node.vertex.connectable()) << i;
        self.signature = Signature {
            connectable: self.nodes.iter().enumerate().map(bit).fold(0, |bits, bit| bits | bit),
            edges: self.edges(),
            infinite: self.nodes[0].vertex.infinite(),
        };
    }

    /// Becomes a copy of `other`.
    pub fn copy_from(&mut self, other: &Self) {
        self.nodes.clone_from(&other.nodes);
        self.copy_rest_from(other);
    }

    /// Becomes a copy of `other` but for its nodes.
    pub fn copy_rest_from(&mut self, other: &Self) {
        (self.raster, self.lens) = (other.raster, other.lens);
        (self.f, self.light, self.signature) = (other.f, other.light, other.signature);
    }

    /// Recomputes f, and everything that depends on edges `from..to` and vertices `from..=to`. `connection` is the edge
    /// along which no ray was cast yet.
    ///
    /// # Errors
    /// Why the path carries no light.
    pub fn measure(
        &mut self,
        space: &Space<'_>,
        (from, to): (usize, usize),
        connection: Option<usize>,
    ) -> Result<(), Reject> {
        let world = space.world;
        self.sign();
        for e in from..to {
            let (light, eye) = (&self.nodes[e].vertex, &self.nodes[e + 1].vertex);
            let edge = Edge::between(light, eye, world.shortest_edge).ok_or(Reject::Black)?;
            self.nodes[e].absorption = world.absorption(light, eye, &edge);
            self.nodes[e].edge = edge;
        }
        for i in from..=to {
            self.measure_vertex(space, i)?;
        }
        for e in from..to {
            self.nodes[e].geometry = self.geometry(e);
            self.nodes[e].passed = 1.0;
        }
        self.f = self.contribution();
        if !self.f.is_finite() || self.f.min_element() < 0.0 {
            return Err(Reject::NotFinite);
        }
        if self.f == Rgb::ZERO {
            return Err(Reject::Black);
        }
        self.look(space, (from, to), connection)
    }

    /// Visibility: of the connection always, of edges that rays were cast along only where surfaces let light pass.
    fn look(
        &mut self,
        space: &Space<'_>,
        (from, to): (usize, usize),
        connection: Option<usize>,
    ) -> Result<(), Reject> {
        let edges = if space.world.has_alpha() { from..to } else { connection.map_or(0..0, |e| e..e + 1) };
        for e in edges {
            let passed = space.world.passed(&self.nodes[e].vertex, &self.nodes[e + 1].vertex);
            if passed <= 0.0 {
                return Err(Reject::Blocked);
            }
            self.nodes[e].passed = passed;
        }
        Ok(())
    }

    fn measure_vertex(&mut self, space: &Space<'_>, i: usize) -> Result<(), Reject> {
        if i == 0 {
            self.measure_light(space);
            return Ok(());
        }
        let (w_l, k) = (-self.nodes[i - 1].edge.to_eye, self.edges());
        if i == k {
            self.nodes[k].to_light = self.camera_density(space);
            return Ok(());
        }
        let w_e = self.nodes[i].edge.to_eye;
        let [before, here, after] = &mut self.nodes[i - 1..=i + 1] else { return Err(Reject::Black) };
        let vertex = &here.vertex;
        let (to_light, to_eye);
        if vertex.mode == Mode::Smooth {
            let found = vertex.evaluate(w_l, w_e);
            (here.factor, to_light, to_eye) = (found.value, found.toward_light, found.toward_eye);
            (here.chance_to_light, here.chance_to_eye) = (1.0, 1.0);
        } else {
            let event = |side, known| vertex.dirac_step(side, known, vertex.mode).ok_or(Reject::Black);
            let (light, eye) = (event(Side::TowardLight, w_e)?, event(Side::TowardEye, w_l)?);
            (here.factor, to_light, to_eye) = (light.factor, light.density, eye.density);
            (here.chance_to_light, here.chance_to_eye) = (light.probability, eye.probability);
        }
        here.to_light = before.edge.density(to_light, &here.vertex, &before.vertex, false);
        here.to_eye = here.edge.density(to_eye, &here.vertex, &after.vertex, false);
        Ok(())
    }

    fn measure_light(&mut self, space: &Space<'_>) {
        let [x0, x1, ..] = self.nodes.as_mut_slice() else { return };
        let lights = &space.world.lights;
        x0.factor = space.world.emitted(&x0.vertex, x0.edge.to_eye);
        let native = lights.emit_density(&x0.vertex, x0.edge.to_eye);
        x0.to_eye = x0.edge.density(native, &x0.vertex, &x1.vertex, x0.vertex.direction_is_fixed());
        self.light = lights.density(&x0.vertex) / space.world.coverage(&x0.vertex);
    }

    fn camera_density(&self, space: &Space<'_>) -> f64 {
        let [.., last, lens] = self.nodes.as_slice() else { return 0.0 };
        let native = space.world.camera.direction_density(-last.edge.to_eye) * space.film_ratio;
        let fixed = space.world.camera.is_orthographic();
        last.edge.density(native, &lens.vertex, &last.vertex, fixed)
    }

    fn geometry(&self, e: usize) -> f64 {
        let (light, eye) = (&self.nodes[e], &self.nodes[e + 1]);
        if eye.vertex.kind == Kind::Lens {
            // Importance is normalized such that it is the density of what the lens sees.
            return eye.to_light;
        }
        if light.vertex.connectable() && eye.vertex.connectable() {
            let to_eye = light.edge.to_eye;
            light.vertex.projected(to_eye) * eye.vertex.projected(to_eye) * light.edge.falloff
        } else {
            1.0
        }
    }

    fn contribution(&self) -> Rgb {
        let edges = &self.nodes[..self.edges()];
        edges.iter().fold(Rgb::ONE, |f, node| f * node.factor * (node.absorption * node.geometry))
    }

    /// Density of x_i as generated from the light's side.
    pub fn from_light(&self, i: usize) -> f64 {
        if i == 0 { self.light } else { self.nodes[i - 1].to_eye }
    }

    /// Density of x_i as generated from the eye's side; a new lens point has density 1.
    pub fn from_eye(&self, i: usize) -> f64 {
        if i == self.edges() { 1.0 } else { self.nodes[i + 1].to_light }
    }

    /// Densities of the ways to make the `n` vertices from x_first on, `visit(s, density)`: the first s from the light's
    /// side, the others from the eye's side, and a connection between them.
    pub fn splits(&self, first: usize, n: usize, mut visit: impl FnMut(usize, f64)) {
        let mut from_eye = [1.0; MAX_VERTICES + 1];
        for s in (0..n).rev() {
            from_eye[s] = from_eye[s + 1] * self.from_eye(first + s);
        }
        let mut from_light = 1.0;
        for (s, &from_eye) in from_eye[..=n].iter().enumerate() {
            if let Some(passed) = self.connection(first + s) {
                visit(s, from_light * from_eye / passed);
            }
            if s < n {
                from_light *= self.from_light(first + s);
            }
        }
    }

    /// What the connection of x_{i-1} and x_i lets through; `None` where none is possible. For i = 0 the eye's side
    /// meets the light instead, along no connection.
    fn connection(&self, i: usize) -> Option<f64> {
        if i == 0 {
            return self.nodes[0].vertex.can_be_met().then_some(1.0);
        }
        let possible = i <= self.edges() && self.connectable(i - 1) && self.connectable(i);
        possible.then(|| self.nodes[i - 1].passed)
    }

    /// Total density of all [`Path::splits`].
    pub fn density(&self, first: usize, n: usize) -> f64 {
        let mut sum = 0.0;
        self.splits(first, n, |_, p| sum += p);
        sum
    }
}
