//! Packets of triangles and the watertight test of Woop, Benthin & Wald 2013, "Watertight Ray/Triangle Intersection".
//!
//! Nothing here is fused: an edge that two triangles share must give both exactly opposite edge functions, on every
//! processor.

use glam::{Vec3, Vec3A, Vec3Swizzles};

use super::lanes::Four;

/// Triangles in a packet.
pub(super) const LANES: usize = 4;

type Lanes = [f32; LANES];

/// Triangles in three cache lines.
#[repr(C, align(64))]
#[derive(Clone, Debug)]
pub(super) struct Packet {
    /// By vertex, axis and lane. Lanes without triangle hold NaN, which no test accepts.
    vertices: [[Lanes; 3]; 3],
    /// Who the triangles are: instance and triangle.
    ids: [[u32; 2]; LANES],
}

impl Packet {
    pub(super) fn empty() -> Self {
        Self { vertices: [[[f32::NAN; LANES]; 3]; 3], ids: [[u32::MAX; 2]; LANES] }
    }

    pub(super) fn set(&mut self, lane: usize, triangle: [[f32; 3]; 3], id: [u32; 2]) {
        self.ids[lane] = id;
        for (vertex, position) in self.vertices.iter_mut().zip(triangle) {
            for (axis, x) in vertex.iter_mut().zip(position) {
                axis[lane] = x;
            }
        }
    }

    #[inline]
    pub(super) fn get(&self, lane: usize) -> [Vec3; 3] {
        let vertex = |[x, y, z]: &[Lanes; 3]| Vec3::new(x[lane], y[lane], z[lane]);
        let [a, b, c] = &self.vertices;
        [vertex(a), vertex(b), vertex(c)]
    }

    pub(super) fn id(&self, lane: usize) -> [u32; 2] {
        self.ids[lane]
    }
}

/// A ray as the triangle test wants it: the axis along which it is fastest becomes Z, and a shear turns it parallel to Z.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shear {
    axes: [usize; 3],
    origin: [f32; 3],
    shear: [f32; 3],
}

impl Shear {
    #[inline]
    pub(super) fn new(origin: Vec3A, direction: Vec3A) -> Self {
        let size = direction.abs();
        let (axes, o, d) = if size.x >= size.y && size.x >= size.z {
            ([1, 2, 0], origin.yzx(), direction.yzx())
        } else if size.y >= size.z {
            ([2, 0, 1], origin.zxy(), direction.zxy())
        } else {
            ([0, 1, 2], origin, direction)
        };
        let scale = 1.0 / d.z;
        Self { axes, origin: o.to_array(), shear: [d.x * scale, d.y * scale, scale] }
    }
}

/// Where a ray meets the triangles of a packet: the set of lanes, distances, and weights of the second and third vertex.
pub(super) struct PacketHit {
    pub(super) set: u32,
    pub(super) t: Lanes,
    pub(super) u: Lanes,
    pub(super) v: Lanes,
}

impl Packet {
    /// The lanes whose triangle, seen from either side, the ray meets in (0, `limit`].
    #[inline(always)]
    pub(super) fn intersect(&self, ray: &Shear, limit: f32) -> Option<PacketHit> {
        let splat = |[x, y, z]: [f32; 3]| [Four::splat(x), Four::splat(y), Four::splat(z)];
        let (origin, shear) = (splat(ray.origin), splat(ray.shear));
        let [kx, ky, kz] = ray.axes;
        let project = |vertex: &[Lanes; 3]| {
            let depth = Four::new(&vertex[kz]) - origin[2];
            let x = (Four::new(&vertex[kx]) - origin[0]) - shear[0] * depth;
            let y = (Four::new(&vertex[ky]) - origin[1]) - shear[1] * depth;
            [x, y, shear[2] * depth]
        };
        let [a, b, c] = [project(&self.vertices[0]), project(&self.vertices[1]), project(&self.vertices[2])];
        let edge = |p: [Four; 3], q: [Four; 3]| p[0] * q[1] - p[1] * q[0];
        let mut e = [edge(c, b), edge(a, c), edge(b, a)];
        let nought = Four::splat(0.0);
        let least = e[0].min(e[1]).min(e[2]);
        let most = e[0].max(e[1]).max(e[2]);
        let mut inside = (nought.at_most(least) | most.at_most(nought)).bits();
        if inside == 0 {
            return None;
        }
        let zero = (e[0].is_zero() | e[1].is_zero() | e[2].is_zero()).bits();
        if inside & zero != 0 {
            inside = recheck([a, b, c], &mut e, inside, zero);
        }
        let inverse = (e[0] + e[1] + e[2]).inverse();
        let t = (e[0] * a[2] + e[1] * b[2] + e[2] * c[2]) * inverse;
        // A triangle seen edge-on has no inverse; its distance is then NaN, which is in no range.
        let set = inside & (nought.below(t) & t.at_most(Four::splat(limit))).bits();
        (set != 0).then(|| PacketHit {
            set,
            t: t.to_array(),
            u: (e[1] * inverse).to_array(),
            v: (e[2] * inverse).to_array(),
        })
    }
}

/// A difference of rounded products that is not zero has the right sign; a zero may hide either. Products of two f32 are
/// exact in f64, so there the sign is certain.
#[cold]
fn recheck(vertices: [[Four; 3]; 3], e: &mut [Four; 3], inside: u32, zero: u32) -> u32 {
    let [a, b, c] = vertices.map(|p| [p[0].to_array(), p[1].to_array()]);
    let mut functions = e.map(Four::to_array);
    let mut kept = inside;
    for i in (0..LANES).filter(|i| inside & zero & (1 << i) != 0) {
        let product = |x: f32, y: f32| f64::from(x) * f64::from(y);
        let edge = |p: [Lanes; 2], q: [Lanes; 2]| product(p[0][i], q[1][i]) - product(p[1][i], q[0][i]);
        let exact = [edge(c, b), edge(a, c), edge(b, a)];
        if !(exact.iter().all(|&s| s >= 0.0) || exact.iter().all(|&s| s <= 0.0)) {
            kept &= !(1 << i);
        }
        // Scaled, so that products that vanish in f32 do not make the triangle look edge-on.
        let size = exact.iter().fold(0f64, |m, s| m.max(s.abs()));
        for (function, s) in functions.iter_mut().zip(exact) {
            function[i] = if size > 0.0 { (s / size) as f32 } else { 0.0 };
        }
    }
    *e = functions.map(|x| Four::new(&x));
    kept
}
