//! A set of triangles with its tree.

use glam::{DVec3, Vec3, Vec3A};
use rayon::prelude::*;

use super::bounds::Bounds;
use super::build;
use super::cut::Leaves;
use super::tree::{PADDING, Slabs, Tree};
use super::triangle::{LANES, Packet, Shear};

/// A packet costs about as much as a node: other prices were slower in furnished rooms (`examples/rays.rs`).
const LEAVES: Leaves = Leaves { capacity: 4, packet: LANES, price: 1.0 };

/// Triangles that a tree is built over.
pub(super) trait Triangles: Sync {
    /// How many there are.
    fn len(&self) -> usize;
    /// The vertices of one.
    fn get(&self, index: u32) -> [Vec3; 3];
    /// Instance and triangle.
    fn id(&self, index: u32) -> [u32; 2];
}

/// Triangles around `center`, to which all f32 positions are relative.
#[derive(Debug)]
pub(super) struct Blas {
    center: DVec3,
    /// Bounds of the boxes around `center`.
    low: DVec3,
    high: DVec3,
    tree: Tree,
    packets: Vec<Packet>,
    /// In which lane of which packet each given triangle is.
    slots: Vec<u32>,
}

/// A ray of a set of triangles: relative to its centre and starting no further away than its bounds.
pub(super) struct LocalRay {
    slabs: Slabs,
    shear: Shear,
    /// Distance already gone from the true origin.
    pub(super) start: f64,
    origin: DVec3,
    direction: DVec3,
}

/// A hit as found in f32. `t` counts from the start of the local ray.
#[derive(Clone, Copy)]
pub(super) struct Candidate {
    pub(super) slot: u32,
    pub(super) id: [u32; 2],
    pub(super) t: f32,
    pub(super) u: f32,
    pub(super) v: f32,
}

/// Distance along a ray and weights of the second and third vertex, in f64; the vertices.
pub(super) struct Refined {
    pub(super) vertices: [DVec3; 3],
    pub(super) t: f64,
    pub(super) u: f64,
    pub(super) v: f64,
}

impl Blas {
    /// The tree over triangles that are relative to `center`.
    pub(super) fn build(center: DVec3, triangles: &impl Triangles) -> Self {
        let all = 0..triangles.len() as u32;
        let (sound, unsound): (Vec<u32>, Vec<u32>) =
            all.into_par_iter().partition(|&i| is_sound(&triangles.get(i)));
        let boxes: Vec<Bounds> = sound.par_iter().map(|&i| padded_box(&triangles.get(i))).collect();
        let mut filed = Filed { packets: Vec::new(), slots: vec![0; triangles.len()] };
        let store = |boxes: &[u32], packed: &mut Vec<Packed>| {
            packed.extend(
                boxes.chunks(LANES).map(|boxes| Packed::new(boxes, |b| sound[b as usize], triangles)),
            );
        };
        let tree = build::build(&boxes, LEAVES, store, |packed| filed.file(packed));
        // No leaf refers to these, but their vertices can be asked for.
        filed.file(unsound.chunks(LANES).map(|lost| Packed::new(lost, |i| i, triangles)).collect());
        let all = boxes.par_iter().copied().reduce(|| Bounds::EMPTY, Bounds::union);
        let Filed { mut packets, slots } = filed;
        packets.shrink_to_fit();
        Self { center, low: all.low.as_dvec3(), high: all.high.as_dvec3(), tree, packets, slots }
    }

    /// Corners of the bounds of the boxes; low above high if there are none.
    pub(super) fn bounds(&self) -> (DVec3, DVec3) {
        (self.center + self.low, self.center + self.high)
    }

    /// The largest coordinate, which f32 rounding is relative to.
    pub(super) fn reach(&self) -> DVec3 {
        self.low.abs().max(self.high.abs())
    }

    pub(super) fn memory(&self) -> usize {
        size_of_val(&self.tree.nodes[..]) + size_of_val(&self.packets[..]) + size_of_val(&self.slots[..])
    }

    #[cfg(test)]
    pub(super) fn has_same_tree(&self, other: &Self) -> bool {
        self.tree == other.tree && self.slots == other.slots
    }

    /// Vertices of the triangle that was given as number `index`.
    pub(super) fn vertices(&self, index: u32) -> [DVec3; 3] {
        let [a, b, c] = self.slot_vertices(self.slots[index as usize]);
        [self.center + a, self.center + b, self.center + c]
    }

    /// Whether rays meet nothing in it.
    #[inline]
    pub(super) fn is_empty(&self) -> bool {
        self.tree.is_empty()
    }

    /// What positions are relative to; none if there is no triangle.
    pub(super) fn center(&self) -> Option<DVec3> {
        (!self.is_empty()).then_some(self.center)
    }

    #[inline]
    fn slot_vertices(&self, slot: u32) -> [DVec3; 3] {
        let slot = slot as usize;
        let [a, b, c] = self.packets[slot / LANES].get(slot % LANES);
        [a.as_dvec3(), b.as_dvec3(), c.as_dvec3()]
    }

    /// The ray as this set sees it; none if it misses the bounds before `t_max`.
    #[inline]
    pub(super) fn local_ray(&self, origin: DVec3, direction: DVec3, t_max: f64) -> Option<LocalRay> {
        let origin = origin - self.center;
        let start = enter(origin, direction, self.low, self.high, t_max)?;
        let (moved, along) = ((origin + direction * start).as_vec3a(), direction.as_vec3a());
        Some(LocalRay {
            slabs: Slabs::new(moved, along),
            shear: Shear::new(moved, along),
            start,
            origin,
            direction,
        })
    }

    /// Candidates no farther than `limit` for which `accept` holds, until there is no nearer one; with `any`, the first.
    #[inline(always)]
    pub(super) fn closest(
        &self,
        ray: &LocalRay,
        limit: f32,
        any: bool,
        accept: impl Fn(&Candidate) -> bool,
    ) -> Option<Candidate> {
        let mut best: Option<Candidate> = None;
        // Finite, so that a distance that overflows is none.
        self.tree.walk(&ray.slabs, limit.min(f32::MAX), |first, count, mut limit| {
            for index in first..first + count {
                let packet = &self.packets[index as usize];
                let Some(hit) = packet.intersect(&ray.shear, limit) else { continue };
                let mut set = hit.set;
                while set != 0 {
                    let lane = set.trailing_zeros() as usize % LANES;
                    set &= set - 1;
                    let slot = index * LANES as u32 + lane as u32;
                    let id = packet.id(lane);
                    let found = Candidate { slot, id, t: hit.t[lane], u: hit.u[lane], v: hit.v[lane] };
                    // At equal distance the lower number wins, so that the order of the tree does not matter.
                    let nearer = found.t < limit || best.is_none_or(|b| found.t == b.t && id < b.id);
                    if found.t <= limit && nearer && accept(&found) {
                        best = Some(found);
                        limit = found.t;
                        if any {
                            return -1.0;
                        }
                    }
                }
            }
            limit
        });
        best
    }

    /// Whether the true ray, in f64, goes towards the plane of the triangle that it was found to hit.
    #[inline]
    pub(super) fn is_ahead(&self, ray: &LocalRay, hit: &Candidate) -> bool {
        let [a, b, c] = self.slot_vertices(hit.slot);
        let normal = (b - a).cross(c - a);
        (ray.origin - a).dot(normal) * ray.direction.dot(normal) < 0.0
    }

    /// The nearest candidate ahead, or any; asked for when the nearest of all turns out to be behind.
    #[cold]
    pub(super) fn closest_ahead(&self, ray: &LocalRay, limit: f32, any: bool) -> Option<Candidate> {
        self.closest(ray, limit, any, |c| self.is_ahead(ray, c))
    }

    /// The hit in f64. `t` counts from the true origin.
    #[inline(always)]
    pub(super) fn refine(&self, ray: &LocalRay, hit: &Candidate) -> Refined {
        let [a, b, c] = self.slot_vertices(hit.slot);
        let vertices = [self.center + a, self.center + b, self.center + c];
        refine([a, b, c], vertices, ray, hit)
    }
}

/// A packet, and the numbers of its triangles.
struct Packed {
    packet: Packet,
    members: [u32; LANES],
}

impl Packed {
    fn new(items: &[u32], member_of: impl Fn(u32) -> u32, triangles: &impl Triangles) -> Self {
        let mut packed = Self { packet: Packet::empty(), members: [u32::MAX; LANES] };
        for (lane, &item) in items.iter().enumerate() {
            let member = member_of(item);
            packed.packet.set(lane, triangles.get(member).map(|p| p.to_array()), triangles.id(member));
            packed.members[lane] = member;
        }
        packed
    }
}

/// Packets in their order, and where each triangle is.
struct Filed {
    packets: Vec<Packet>,
    slots: Vec<u32>,
}

impl Filed {
    fn file(&mut self, packed: Vec<Packed>) {
        for Packed { packet, members } in packed {
            let first = self.packets.len() * LANES;
            for (lane, member) in members.into_iter().enumerate() {
                if let Some(slot) = self.slots.get_mut(member as usize) {
                    *slot = (first + lane) as u32;
                }
            }
            self.packets.push(packet);
        }
    }
}

/// Whether a triangle has finite vertices and an area.
fn is_sound(triangle: &[Vec3; 3]) -> bool {
    let [a, b, c] = triangle.map(|p| p.as_dvec3());
    let area = (b - a).cross(c - a).length_squared();
    area > 0.0 && area.is_finite()
}

fn padded_box(triangle: &[Vec3; 3]) -> Bounds {
    let [a, b, c] = triangle.map(Vec3A::from);
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    let pad = Vec3A::splat(PADDING * low.abs().max(high.abs()).max_element());
    Bounds { low: low - pad, high: high + pad }
}

/// Distance at which a ray is within a box: 0 if it starts there, none if it gets there after `t_max` or never.
#[inline]
pub(super) fn enter(origin: DVec3, direction: DVec3, low: DVec3, high: DVec3, t_max: f64) -> Option<f64> {
    if origin.cmpge(low).all() && origin.cmple(high).all() {
        return (t_max >= 0.0).then_some(0.0);
    }
    enter_from_outside(origin, direction, low, high, t_max)
}

fn enter_from_outside(origin: DVec3, direction: DVec3, low: DVec3, high: DVec3, t_max: f64) -> Option<f64> {
    let (mut near, mut far) = (0f64, t_max);
    for axis in 0..3 {
        let (low, high, along) = (low[axis] - origin[axis], high[axis] - origin[axis], direction[axis]);
        if along == 0.0 && low <= 0.0 && high >= 0.0 {
            continue;
        }
        let (a, b) = (low / along, high / along);
        near = near.max(a.min(b));
        far = far.min(a.max(b));
    }
    (near <= far).then_some(near)
}

/// Möller & Trumbore 1997 in f64, with the point kept inside the triangle.
#[inline(always)]
fn refine([a, b, c]: [DVec3; 3], vertices: [DVec3; 3], ray: &LocalRay, hit: &Candidate) -> Refined {
    let (ab, ac) = (b - a, c - a);
    let p = ray.direction.cross(ac);
    let inverse = 1.0 / ab.dot(p);
    let from = ray.origin - a;
    let q = from.cross(ab);
    let (mut u, mut v) = (from.dot(p) * inverse, ray.direction.dot(q) * inverse);
    if !(u.abs() <= 2.0 && v.abs() <= 2.0) {
        // Edge-on: the determinant has no digits.
        (u, v) = (f64::from(hit.u), f64::from(hit.v));
    }
    u = u.max(0.0);
    v = v.max(0.0);
    let sum = u + v;
    if sum > 1.0 {
        u /= sum;
        v /= sum;
    }
    let t = (ab * u + ac * v - from).dot(ray.direction) / ray.direction.length_squared();
    Refined { vertices, t, u, v }
}
