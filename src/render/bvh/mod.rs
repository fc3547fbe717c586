//! What rays meet: triangles, found through trees of boxes.
//!
//! Meshes that are placed once become triangles in world space under one tree. Meshes that are placed many times keep
//! one tree of their own, and a top level finds the placements. The shapes of lights have a tree apart, so that moving a
//! light leaves all others as they are ([`Geometry::build_after`]). All trees are eight children wide. Traversal is in f32
//! around a centre near the detail of the scene and is watertight (Woop, Benthin & Wald 2013); the hit is then computed
//! again in f64.
//!
//! The same vertices that rays meet are what [`Geometry::vertices`] gives, so points on them are on the surface to the
//! last digits of f64.

mod assemble;
mod bake;
mod binary;
mod blas;
mod bounds;
mod build;
mod cut;
mod lanes;
mod offset;
mod split;
mod stack;
#[cfg(test)]
mod tests;
mod tlas;
mod tree;
mod triangle;

use std::sync::Arc;

use glam::{DAffine3, DVec3};

use crate::ray::Ray;
use blas::{Blas, Candidate};
use tlas::Tlas;

pub use assemble::Previous;
pub use offset::{Anchor, inside, offset_origin, segment};

/// One placement of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InstanceGeometry {
    /// Which of the meshes.
    pub mesh: usize,
    /// Any affine map; singular ones are allowed.
    pub to_world: DAffine3,
    /// Whether it is the shape of a light.
    pub is_lamp: bool,
}

impl InstanceGeometry {
    /// A placement of a mesh that is no light.
    pub fn solid(mesh: usize, to_world: DAffine3) -> Self {
        Self { mesh, to_world, is_lamp: false }
    }
}

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Number of the placement.
    pub instance: u32,
    /// Number of the triangle in its mesh.
    pub triangle: u32,
    /// Weight of the triangle's second vertex, in [0, 1].
    pub u: f32,
    /// Weight of the triangle's third vertex, in [0, 1 - `u`].
    pub v: f32,
    /// Distance along the ray.
    pub t: f64,
}

/// A hit and the vertices of its triangle, as [`Geometry::vertices`] gives them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Met {
    /// The hit.
    pub hit: Hit,
    /// World-space vertices.
    pub vertices: [DVec3; 3],
}

/// Everything rays can meet. Immutable; any number of threads may ask it.
#[derive(Debug)]
pub struct Geometry {
    places: Vec<Place>,
    baked: Arc<Blas>,
    lamps: Arc<Blas>,
    /// The trees of meshes that have one of their own.
    own: Vec<Option<Arc<Blas>>>,
    tlas: Tlas,
    low: DVec3,
    high: DVec3,
}

/// Where the triangles of a placement are.
#[derive(Debug)]
enum Place {
    /// Among the world's triangles, from this one on.
    Baked(u32),
    /// Among those of the shapes of lights, from this one on.
    Lamp(u32),
    /// This one of the top level's placements.
    Own(u32),
}

impl Geometry {
    /// Two opposite corners of a box around everything; zero if there is nothing.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        (self.low, self.high)
    }

    /// The vertices of a triangle in world space, exactly where rays meet them.
    pub fn vertices(&self, instance: u32, triangle: u32) -> [DVec3; 3] {
        match &self.places[instance as usize] {
            Place::Baked(first) => self.baked.vertices(first + triangle),
            Place::Lamp(first) => self.lamps.vertices(first + triangle),
            Place::Own(number) => {
                let one = self.tlas.placement(*number);
                one.blas.vertices(triangle).map(|p| one.to_world.transform_point3(p))
            }
        }
    }

    /// How far traversal may misplace a triangle of `instance` with these [`Self::vertices`] for rays that start on it:
    /// the distance for [`offset_origin`].
    #[inline]
    pub fn rounding(&self, instance: u32, vertices: &[DVec3; 3]) -> f64 {
        let [a, b, c] = *vertices;
        let extent =
            (b - a).length_squared().max((c - a).length_squared()).max((c - b).length_squared()).sqrt();
        let from = |set: &Blas| {
            set.center().map_or(0.0, |center| {
                (a - center).abs().max((b - center).abs()).max((c - center).abs()).max_element()
            })
        };
        let mut reach = from(&self.baked);
        match &self.places[instance as usize] {
            Place::Baked(_) => {}
            Place::Lamp(_) => reach = reach.max(from(&self.lamps)),
            Place::Own(number) => {
                let one = self.tlas.placement(*number);
                let m = one.to_world.matrix3;
                let local = one.blas.reach();
                let own = m.x_axis.abs() * local.x + m.y_axis.abs() * local.y + m.z_axis.abs() * local.z;
                reach = reach.max(own.max_element());
            }
        }
        offset::rounding(reach, extent)
    }

    /// The nearest hit for which `accept` holds, at a distance in (0, `t_max`]. Distances given to `accept` are those of
    /// f32; it is called for some of the hits on the way, in no particular order.
    #[inline]
    pub fn intersect(&self, ray: &Ray, accept: impl Fn(&Hit) -> bool) -> Option<Met> {
        self.find::<false, true>(ray, accept)
    }

    /// The nearest hit at a distance in (0, `t_max`].
    #[inline]
    pub fn nearest(&self, ray: &Ray) -> Option<Met> {
        self.find::<false, false>(ray, |_| true)
    }

    /// Whether there is any hit for which `accept` holds, at a distance in (0, `t_max`].
    #[inline]
    pub fn occluded(&self, ray: &Ray, accept: impl Fn(&Hit) -> bool) -> bool {
        self.find::<true, true>(ray, accept).is_some()
    }

    /// Whether there is any hit at a distance in (0, `t_max`].
    #[inline]
    pub fn blocked(&self, ray: &Ray) -> bool {
        self.find::<true, false>(ray, |_| true).is_some()
    }

    #[inline(always)]
    fn find<const ANY: bool, const FILTER: bool>(
        &self,
        ray: &Ray,
        accept: impl Fn(&Hit) -> bool,
    ) -> Option<Met> {
        if ray.t_max <= 0.0 || ray.t_max.is_nan() {
            return None;
        }
        let mut best = find_in::<ANY, FILTER>(&self.baked, None, ray, &accept);
        if !(self.lamps.is_empty() || (ANY && best.is_some())) {
            self.find_lamp::<ANY, FILTER>(ray, &mut best, &accept);
        }
        if !(self.tlas.is_empty() || (ANY && best.is_some())) {
            self.find_placed::<ANY, FILTER>(ray, &mut best, &accept);
        }
        best
    }

    /// Replaces `best` by what is nearer among the shapes of lights.
    #[inline(never)]
    fn find_lamp<const ANY: bool, const FILTER: bool>(
        &self,
        ray: &Ray,
        best: &mut Option<Met>,
        accept: &impl Fn(&Hit) -> bool,
    ) {
        let rest = Ray { t_max: best.map_or(ray.t_max, |met| met.hit.t), ..*ray };
        let found = find_in::<ANY, FILTER>(&self.lamps, None, &rest, accept);
        if let Some(met) = found.filter(|met| best.is_none_or(|b| is_before(&met.hit, &b.hit))) {
            *best = Some(met);
        }
    }

    /// Replaces `best` by what is nearer among the placements of the top level.
    #[inline(never)]
    fn find_placed<const ANY: bool, const FILTER: bool>(
        &self,
        ray: &Ray,
        best: &mut Option<Met>,
        accept: &impl Fn(&Hit) -> bool,
    ) {
        let mut rest = Ray { t_max: best.map_or(ray.t_max, |met| met.hit.t), ..*ray };
        self.tlas.walk(ray.origin, ray.direction, rest.t_max, |one| {
            let local = Ray {
                origin: one.to_local.transform_point3(ray.origin),
                direction: one.to_local.transform_vector3(ray.direction),
                t_max: rest.t_max,
            };
            let found = find_in::<ANY, FILTER>(&one.blas, Some(one.instance), &local, accept);
            if let Some(met) = found.filter(|met| best.is_none_or(|b| is_before(&met.hit, &b.hit))) {
                let [a, b, c] = met.vertices;
                let vertices = [a, b, c].map(|p| one.to_world.transform_point3(p));
                *best = Some(Met { vertices, ..met });
                rest.t_max = if ANY { f64::NEG_INFINITY } else { met.hit.t };
            }
            rest.t_max
        });
    }

    /// Bytes held by triangles, trees and placements.
    pub fn memory(&self) -> usize {
        size_of_val(&self.places[..]) + self.baked.memory() + self.lamps.memory() + self.tlas.memory()
    }
}

/// At equal distance the lower number wins.
fn is_before(a: &Hit, b: &Hit) -> bool {
    a.t < b.t || (a.t == b.t && (a.instance, a.triangle) < (b.instance, b.triangle))
}

/// The nearest hit, or any, in one set of triangles. `ray` is in its space; `t` is the same in all spaces.
#[inline(always)]
fn find_in<const ANY: bool, const FILTER: bool>(
    blas: &Blas,
    instance: Option<u32>,
    ray: &Ray,
    accept: &impl Fn(&Hit) -> bool,
) -> Option<Met> {
    let local = blas.local_ray(ray.origin, ray.direction, ray.t_max)?;
    let hit = |c: &Candidate, u: f32, v: f32, t: f64| Hit {
        instance: instance.unwrap_or(c.id[0]),
        triangle: c.id[1],
        u,
        v,
        t,
    };
    let limit = (ray.t_max - local.start) as f32;
    let mut found = blas.closest(&local, limit, ANY, |c| {
        !FILTER || (blas.is_ahead(&local, c) && accept(&hit(c, c.u, c.v, local.start + f64::from(c.t))))
    })?;
    // At grazing angles rounding can put a plane behind the origin in front of it.
    if !FILTER && !blas.is_ahead(&local, &found) {
        found = blas.closest_ahead(&local, limit, ANY)?;
    }
    let exact = blas.refine(&local, &found);
    let hit = hit(&found, exact.u as f32, exact.v as f32, exact.t.max(0.0).min(ray.t_max));
    Some(Met { hit, vertices: exact.vertices })
}
