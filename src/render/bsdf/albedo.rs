//! How much of the light from one direction a GGX interface reflects and transmits by single scattering, tabulated.
//!
//! What the single-scattering model loses is put back by [`super::compensation`], and what an interface leaves over is
//! what the layers below it get; both need these directional albedos. Tables are integrated with a fixed rule, once per
//! index of refraction, and kept for the life of the program: an index takes some 30 KiB.

use std::{f64::consts::PI, iter::Sum, ops::Div, sync::OnceLock};

use glam::{DVec2, DVec3, DVec4};

use super::{fresnel, ggx::Ggx, stretched::Stretched};

/// Nodes along √cosθ and along √α.
pub const NODES: usize = 32;
/// Indices this close to 1 do not bend light.
const MATCHED: f64 = 1e-3;

/// Single-scattering albedos in one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Albedo {
    /// If the microfacets reflected everything.
    pub total: f64,
    /// Reflected with the dielectric's reflectance.
    pub reflected: f64,
    /// Reflected with that reflectance times Schlick's weight of the grazing colour.
    pub edge: f64,
    /// Refracted.
    pub transmitted: f64,
}

impl Albedo {
    /// Of a smooth interface at incident cosine `cos`; `eta` is the index beyond over the index before it.
    pub fn smooth(cos: f64, eta: f64) -> Self {
        let reflected = if eta == 1.0 { 0.0 } else { fresnel::dielectric(cos, eta) };
        Self {
            total: 1.0,
            reflected,
            edge: reflected * fresnel::edge_weight(cos),
            transmitted: 1.0 - reflected,
        }
    }

    /// From a row of numbers in the order of the fields.
    pub fn from_table(v: DVec4) -> Self {
        Self { total: v.x, reflected: v.y, edge: v.z, transmitted: v.w }
    }

    /// As [`Self::from_table`] takes it.
    pub fn to_table(self) -> DVec4 {
        DVec4::new(self.total, self.reflected, self.edge, self.transmitted)
    }
}

/// A width α located between two rows of the tables.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    index: u16,
    fraction: f32,
}

impl Row {
    /// That of an isotropic `ggx`.
    pub fn new(ggx: &Ggx) -> Self {
        let (index, fraction) = locate(ggx.narrow());
        Self { index: index as u16, fraction: fraction as f32 }
    }
}

/// The interval between nodes that holds `x` and where in it, linearly. Nodes are spaced like squares, to crowd towards 0,
/// where albedos change fast.
pub fn locate(x: f64) -> (usize, f64) {
    const LAST: f64 = (NODES - 1) as f64;
    let x = x.clamp(0.0, 1.0) * (LAST * LAST);
    let index = (x.sqrt() as usize).min(NODES - 2);
    let i = index as f64;
    (index, (x - i * i) / (2.0 * i + 1.0))
}

/// Where node `i` is.
pub fn node(i: usize) -> f64 {
    (i as f64 / (NODES - 1) as f64).powi(2)
}

/// Albedos from one side, over α (rows) and the cosine (columns), and their cosine-weighted averages.
#[derive(Debug)]
struct Table {
    rows: Vec<[[f32; 4]; NODES]>,
    averages: Vec<DVec4>,
}

/// A boundary between air in front and a medium of some index behind, of any roughness.
#[derive(Debug)]
pub struct Interface {
    ior: f64,
    front: Table,
    /// Made only for what transmits.
    inside: OnceLock<Table>,
    fresnel_average: f64,
    /// Of anisotropic surfaces, from the front and from inside.
    stretched: [OnceLock<Box<Stretched>>; 2],
}

/// A list that only grows, so that readers need no lock.
struct Cached {
    interface: Interface,
    next: OnceLock<Box<Cached>>,
}

static CACHE: OnceLock<Box<Cached>> = OnceLock::new();

impl Interface {
    /// The interface of index `ior` ≥ 1, integrated when first asked for.
    pub fn of(ior: f64) -> &'static Self {
        let ior = if ior.is_finite() { ior.clamp(1.0, 1e3) } else { 1.0 };
        let ior = if ior - 1.0 < MATCHED { 1.0 } else { ior };
        let mut slot = &CACHE;
        loop {
            let cached = slot
                .get_or_init(|| Box::new(Cached { interface: Self::integrate(ior), next: OnceLock::new() }));
            if cached.interface.ior == ior {
                return &cached.interface;
            }
            slot = &cached.next;
        }
    }

    /// Index of refraction behind; exactly 1 if it does not bend light.
    pub fn ior(&self) -> f64 {
        self.ior
    }

    /// Index of the other side over the index of this one.
    pub fn eta(&self, inside: bool) -> f64 {
        if inside { 1.0 / self.ior } else { self.ior }
    }

    /// Reflectance of a microfacet met at cosine `cos` from a side.
    pub fn fresnel(&self, cos: f64, inside: bool) -> f64 {
        if self.ior == 1.0 { 0.0 } else { fresnel::dielectric(cos.clamp(0.0, 1.0), self.eta(inside)) }
    }

    /// Albedos at cosine `cos` of an isotropic surface of width `row`, on the front or on the inside.
    pub fn albedo(&self, inside: bool, row: Row, cos: f64) -> Albedo {
        let (column, x) = locate(cos);
        let rows = &self.table(inside).rows;
        let at = |row: &[[f32; 4]; NODES]| {
            let [near, far] = [row[column], row[column + 1]].map(|v| DVec4::from_array(v.map(f64::from)));
            near * (1.0 - x) + far * x
        };
        blend(row, |i| at(&rows[i]))
    }

    /// Cosine-weighted averages over the hemisphere.
    pub fn average(&self, inside: bool, row: Row) -> Albedo {
        blend(row, |i| self.table(inside).averages[i])
    }

    /// Tables of anisotropic surfaces.
    pub fn stretched(&self, inside: bool) -> &Stretched {
        self.stretched[usize::from(inside)]
            .get_or_init(|| Box::new(Stretched::integrate(if inside { 1.0 / self.ior } else { self.ior })))
    }

    /// Cosine-weighted average of [`Self::fresnel`] on the front.
    pub fn fresnel_average(&self) -> f64 {
        self.fresnel_average
    }

    fn table(&self, inside: bool) -> &Table {
        if inside { self.inside.get_or_init(|| Table::integrate(1.0 / self.ior)) } else { &self.front }
    }

    fn integrate(ior: f64) -> Self {
        let fresnel_average = if ior == 1.0 { 0.0 } else { mean(256, |cos| fresnel::dielectric(cos, ior)) };
        let (front, inside, stretched) = (Table::integrate(ior), OnceLock::new(), Default::default());
        Self { ior, front, inside, fresnel_average, stretched }
    }
}

impl Table {
    /// For an index `eta` beyond over before.
    fn integrate(eta: f64) -> Self {
        let weights = node_weights();
        let rows: Vec<_> = (0..NODES).map(|j| integrate_row(node(j), eta)).collect();
        let averages = rows.iter().map(|row| average(row, &weights)).collect();
        Self { rows, averages }
    }
}

/// Interpolates between the rows of the tables.
fn blend(place: Row, row: impl Fn(usize) -> DVec4) -> Albedo {
    let (i, y) = (usize::from(place.index), f64::from(place.fraction));
    Albedo::from_table(row(i) * (1.0 - y) + row(i + 1) * y)
}

/// Cosine-weighted average over the hemisphere of a function of the cosine, from `n` samples of it.
pub fn mean<T: Sum + Div<f64, Output = T>>(n: u32, f: impl Fn(f64) -> T) -> T {
    (0..n).map(|i| f(((f64::from(i) + 0.5) / f64::from(n)).sqrt())).sum::<T>() / f64::from(n)
}

/// As [`mean`], from samples that crowd towards the horizon, where sheens shine: cosines are t², of equal steps in t.
pub fn mean_near_horizon(n: u32, f: impl Fn(f64) -> f64) -> f64 {
    let (mut sum, mut whole) = (0.0, 0.0);
    for i in 0..n {
        let t = (f64::from(i) + 0.5) / f64::from(n);
        sum += f(t * t) * t.powi(3);
        whole += t.powi(3);
    }
    sum / whole
}

/// Weights that integrate 2 cosθ f(cosθ) exactly for `f` interpolated between the nodes.
fn node_weights() -> [f64; NODES] {
    const STEPS: usize = 64;
    let mut weights = [0.0; NODES];
    for i in 0..NODES - 1 {
        let spacing = node(i + 1) - node(i);
        for step in 0..STEPS {
            let x = (step as f64 + 0.5) / STEPS as f64;
            let measure = 2.0 * (node(i) + x * spacing) * spacing / STEPS as f64;
            weights[i] += measure * (1.0 - x);
            weights[i + 1] += measure * x;
        }
    }
    let sum: f64 = weights.iter().sum();
    weights.map(|w| w / sum)
}

fn average(row: &[[f32; 4]; NODES], weights: &[f64; NODES]) -> DVec4 {
    row.iter().zip(weights).map(|(v, &w)| DVec4::from_array(v.map(f64::from)) * w).sum()
}

fn integrate_row(alpha: f64, eta: f64) -> [[f32; 4]; NODES] {
    std::array::from_fn(|i| {
        let albedo = if alpha == 0.0 {
            Albedo::smooth(node(i), eta)
        } else {
            let cos = node(i).max(1e-5);
            let w = DVec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
            // Half of the disc is enough by symmetry. Total reflection cuts sharply through what is seen from inside.
            let (radii, azimuths) = if eta < 1.0 { (32, 24) } else { (16, 10) };
            integrate_direction(&Ggx::isotropic(alpha), w, eta, radii, PI / f64::from(azimuths), azimuths)
        };
        albedo.to_table().to_array().map(|v| v as f32)
    })
}

/// Importance sampling of the visible normals by a fixed lattice in polar coordinates on the disc they are drawn from:
/// `azimuths` axes at distances of `step`, and points that crowd towards the rim, where facets are steep and light is
/// lost.
pub fn integrate_direction(ggx: &Ggx, w: DVec3, eta: f64, radii: u32, step: f64, azimuths: u32) -> Albedo {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let (mut sum, mut whole) = (DVec4::ZERO, 0.0);
    for j in 0..azimuths {
        let axis = DVec2::from_angle(step * (f64::from(j) + 0.5));
        for i in 0..radii {
            // 1 − r² = t³, whose element is in proportion to t² dt.
            let t = (f64::from(i) + (f64::from(j) * GOLDEN + 0.5).fract()) / f64::from(radii);
            let normal = ggx.visible_normal(w, axis * (1.0 - t * t * t).sqrt());
            let scattered = normal.map_or(DVec4::ZERO, |h| scatter(ggx, w, h, eta));
            sum += scattered * (t * t);
            whole += t * t;
        }
    }
    if eta == 1.0 {
        // Without bending the roughness has no effect: everything passes.
        sum.w = whole;
    }
    Albedo::from_table(sum / whole)
}

/// What comes of light from `w` that meets a visible microfacet of normal `h`.
fn scatter(ggx: &Ggx, w: DVec3, h: DVec3, eta: f64) -> DVec4 {
    let facet = w.dot(h).clamp(0.0, 1.0);
    let fresnel = if eta == 1.0 { 0.0 } else { fresnel::dielectric(facet, eta) };
    // G₂/G₁ of the outgoing direction `o`.
    let seen = |o: DVec3| 4.0 * o.z * ggx.visibility(w, o) / ggx.visible(w);
    let mut albedo = DVec4::ZERO;
    let reflected = h * (2.0 * w.dot(h)) - w;
    if reflected.z > 0.0 {
        albedo += DVec4::new(1.0, fresnel, fresnel * fresnel::edge_weight(facet), 0.0) * seen(reflected);
    }
    if let Some(o) = fresnel::refract(w, h, eta).filter(|o| o.z < 0.0) {
        albedo.w = (1.0 - fresnel) * seen(DVec3::new(o.x, o.y, -o.z));
    }
    albedo
}
