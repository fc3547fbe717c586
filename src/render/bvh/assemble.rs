//! From meshes and placements to what rays meet, taking over trees that would come out the same.

use std::sync::Arc;

use ajar_scene::Mesh;
use glam::{DAffine3, DVec3};
use rayon::prelude::*;

use super::{
    Geometry, InstanceGeometry, Place,
    bake::{Baked, own_blas},
    blas::Blas,
    tlas::{Placed, Tlas},
};

/// Meshes placed many times are still baked if the copies come to fewer triangles than this: rays are faster then.
const BAKED_COPIES: usize = 50_000;

/// Geometry that was built before.
#[derive(Clone, Copy, Debug)]
pub struct Previous<'a> {
    /// It.
    pub geometry: &'a Geometry,
    /// What it was built of.
    pub instances: &'a [InstanceGeometry],
    /// For each mesh of the new geometry whether the old one had the same at that number.
    pub same: &'a [bool],
}

impl Geometry {
    /// Prepares `instances` of the positions and triangles of `meshes`. Triangles with missing or infinite vertices or
    /// without area are never met.
    pub fn build(meshes: &[&Mesh], instances: &[InstanceGeometry]) -> Self {
        Self::build_after(meshes, instances, None)
    }

    /// As [`Geometry::build`], with the same result, but trees over what did not change are those of `previous`.
    pub fn build_after(
        meshes: &[&Mesh],
        instances: &[InstanceGeometry],
        previous: Option<Previous<'_>>,
    ) -> Self {
        Self::build_baking(meshes, instances, BAKED_COPIES, previous)
    }

    pub(super) fn build_baking(
        meshes: &[&Mesh],
        instances: &[InstanceGeometry],
        copies: usize,
        previous: Option<Previous<'_>>,
    ) -> Self {
        let own = own_trees(meshes, instances, copies, previous);
        let (mut baked, mut lamps) = (Baked::default(), Baked::default());
        let mut places = Vec::with_capacity(instances.len());
        let mut placed = Vec::new();
        for (number, instance) in instances.iter().enumerate() {
            let (number, mesh, to_world) =
                (number as u32, meshes.get(instance.mesh).copied(), instance.to_world);
            let blas = own.get(instance.mesh).and_then(Option::as_ref);
            places.push(match blas.filter(|_| is_invertible(&to_world)) {
                Some(blas) => {
                    let (blas, to_local) = (Arc::clone(blas), to_world.inverse());
                    placed.push(Placed { instance: number, blas, to_world, to_local });
                    Place::Own(placed.len() as u32 - 1)
                }
                None if instance.is_lamp => Place::Lamp(lamps.add(number, mesh, to_world)),
                None => Place::Baked(baked.add(number, mesh, to_world)),
            });
        }
        let kept = |wanted| previous.filter(|it| it.has(wanted, instances, &places)).map(|it| it.geometry);
        let is_baked = |place: &Place| matches!(place, Place::Baked(_));
        let is_lamp = |place: &Place| matches!(place, Place::Lamp(_));
        let baked = || kept(is_baked).map_or_else(|| Arc::new(baked.build()), |it| Arc::clone(&it.baked));
        let lamps = || kept(is_lamp).map_or_else(|| Arc::new(lamps.build()), |it| Arc::clone(&it.lamps));
        let (baked, (lamps, tlas)) = rayon::join(baked, || rayon::join(lamps, || Tlas::build(&placed)));
        let bounds = [baked.bounds(), lamps.bounds(), tlas.bounds()];
        let (mut low, mut high) = bounds
            .into_iter()
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), (other_low, other_high)| {
                (low.min(other_low), high.max(other_high))
            });
        if !low.cmple(high).all() {
            (low, high) = (DVec3::ZERO, DVec3::ZERO);
        }
        Self { places, baked, lamps, own, tlas, low, high }
    }
}

impl Previous<'_> {
    /// Whether it would come out the same of these placements.
    pub fn is_of(&self, instances: &[InstanceGeometry]) -> bool {
        let is_same = |it: &InstanceGeometry| self.same.get(it.mesh) == Some(&true);
        self.instances == instances && instances.iter().all(is_same)
    }

    /// Whether it has the same triangles as the new geometry in those places that `wanted` holds for.
    fn has(&self, wanted: fn(&Place) -> bool, instances: &[InstanceGeometry], places: &[Place]) -> bool {
        let new = instances.iter().zip(places).enumerate().filter(|(_, (_, place))| wanted(place));
        let old = self.instances.iter().zip(&self.geometry.places).enumerate();
        let old = old.filter(|(_, (_, place))| wanted(place)).map(|(number, (it, _))| (number, it));
        let new = new.map(|(number, (it, _))| (number, it));
        new.clone().eq(old) && new.clone().all(|(_, it)| self.same.get(it.mesh) == Some(&true))
    }
}

/// Trees of the meshes that keep one of their own.
fn own_trees(
    meshes: &[&Mesh],
    instances: &[InstanceGeometry],
    copies: usize,
    previous: Option<Previous<'_>>,
) -> Vec<Option<Arc<Blas>>> {
    let mut uses = vec![0usize; meshes.len()];
    for instance in instances {
        if let Some(n) = uses.get_mut(instance.mesh) {
            *n += 1;
        }
    }
    let is_own = |mesh: usize| (uses[mesh].saturating_sub(1)) * meshes[mesh].triangles.len() >= copies.max(1);
    let kept = |mesh: usize| {
        let previous = previous.filter(|previous| previous.same.get(mesh) == Some(&true))?;
        previous.geometry.own.get(mesh)?.clone()
    };
    let tree = |mesh| is_own(mesh).then(|| kept(mesh).unwrap_or_else(|| Arc::new(own_blas(meshes[mesh]))));
    (0..meshes.len()).into_par_iter().map(tree).collect()
}

fn is_invertible(map: &DAffine3) -> bool {
    let m = map.matrix3;
    let volume = m.determinant().abs();
    let size = m.x_axis.length() * m.y_axis.length() * m.z_axis.length();
    volume > 1e-12 * size && map.inverse().is_finite()
}

#[cfg(test)]
impl Geometry {
    /// Whether two geometries share the baked tree, that of lights, and one of those that meshes have of their own.
    pub fn shared(&self, other: &Self) -> [bool; 3] {
        let own = self.own.iter().flatten().zip(other.own.iter().flatten());
        let own = own.map(|(a, b)| Arc::ptr_eq(a, b)).next().unwrap_or(false);
        [Arc::ptr_eq(&self.baked, &other.baked), Arc::ptr_eq(&self.lamps, &other.lamps), own]
    }
}
