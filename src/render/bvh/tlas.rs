//! The top level: a tree over the placements of meshes that are placed many times.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec3A};

use super::blas::{Blas, enter};
use super::bounds::Bounds;
use super::build;
use super::cut::Leaves;
use super::tree::{PADDING, Slabs, Tree};

/// Entering an instance costs about as much as a few nodes.
const LEAVES: Leaves = Leaves { capacity: 1, packet: 1, price: 8.0 };

/// One placement of a set of triangles.
#[derive(Clone, Debug)]
pub(super) struct Placed {
    pub(super) instance: u32,
    pub(super) blas: Arc<Blas>,
    pub(super) to_world: DAffine3,
    pub(super) to_local: DAffine3,
}

impl Placed {
    /// World bounds: those of the transformed box. Low above high if there is no triangle.
    pub(super) fn bounds(&self) -> (DVec3, DVec3) {
        let (low, high) = self.blas.bounds();
        if !low.cmple(high).all() {
            return (DVec3::INFINITY, DVec3::NEG_INFINITY);
        }
        let m = self.to_world.matrix3;
        let middle = self.to_world.transform_point3((low + high) * 0.5);
        let half = (high - low) * 0.5;
        let half = m.x_axis.abs() * half.x + m.y_axis.abs() * half.y + m.z_axis.abs() * half.z;
        (middle - half, middle + half)
    }
}

/// Placements in leaf order, and the tree over their boxes relative to `center`.
#[derive(Debug)]
pub(super) struct Tlas {
    center: DVec3,
    low: DVec3,
    high: DVec3,
    tree: Tree,
    placed: Vec<Placed>,
    /// Where each given placement is in `placed`.
    slots: Vec<u32>,
}

impl Tlas {
    pub(super) fn build(placed: &[Placed]) -> Self {
        let bounds: Vec<_> = placed.iter().map(Placed::bounds).collect();
        let (sound, unsound): (Vec<usize>, Vec<usize>) =
            (0..placed.len()).partition(|&i| is_finite(&bounds[i]));
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for &i in &sound {
            low = low.min(bounds[i].0);
            high = high.max(bounds[i].1);
        }
        let center = if sound.is_empty() { DVec3::ZERO } else { (low + high) * 0.5 };
        let boxes: Vec<Bounds> =
            sound.iter().map(|&i| padded_box(bounds[i].0 - center, bounds[i].1 - center)).collect();
        let mut order = Vec::with_capacity(placed.len());
        let store =
            |boxes: &[u32], units: &mut Vec<usize>| units.extend(boxes.iter().map(|&b| sound[b as usize]));
        let tree = build::build(&boxes, LEAVES, store, |units| order.extend(units));
        // No leaf refers to these, but their vertices can be asked for.
        order.extend(unsound);
        let mut slots = vec![0; placed.len()];
        for (slot, &number) in order.iter().enumerate() {
            slots[number] = slot as u32;
        }
        let placed = order.iter().map(|&number| placed[number].clone()).collect();
        Self { center, low: low - center, high: high - center, tree, placed, slots }
    }

    /// The placement that was given as number `number`.
    pub(super) fn placement(&self, number: u32) -> &Placed {
        &self.placed[self.slots[number as usize] as usize]
    }

    pub(super) fn is_empty(&self) -> bool {
        self.tree.is_empty()
    }

    /// Corners of the bounds; low above high if there is nothing.
    pub(super) fn bounds(&self) -> (DVec3, DVec3) {
        (self.center + self.low, self.center + self.high)
    }

    /// Bytes held, those of each set of triangles once.
    pub(super) fn memory(&self) -> usize {
        let sets: BTreeMap<_, _> =
            self.placed.iter().map(|one| (Arc::as_ptr(&one.blas), one.blas.memory())).collect();
        let own = size_of_val(&self.tree.nodes[..]) + size_of_val(&self.placed[..]);
        own + size_of_val(&self.slots[..]) + sets.values().sum::<usize>()
    }

    /// Calls `visit` for the placements whose boxes the ray meets. It answers with the distance beyond which nothing
    /// matters any more; a negative one ends the walk.
    #[inline]
    pub(super) fn walk(
        &self,
        origin: DVec3,
        direction: DVec3,
        t_max: f64,
        mut visit: impl FnMut(&Placed) -> f64,
    ) {
        if self.tree.is_empty() {
            return;
        }
        let origin = origin - self.center;
        let Some(start) = enter(origin, direction, self.low, self.high, t_max) else { return };
        let slabs = Slabs::new((origin + direction * start).as_vec3a(), direction.as_vec3a());
        self.tree.walk(&slabs, (t_max - start) as f32, |first, count, mut limit| {
            for placed in &self.placed[first as usize..(first + count) as usize] {
                limit = limit.min((visit(placed) - start) as f32);
                if limit < 0.0 {
                    break;
                }
            }
            limit
        });
    }
}

fn is_finite(bounds: &(DVec3, DVec3)) -> bool {
    bounds.0.is_finite() && bounds.1.is_finite()
}

fn padded_box(low: DVec3, high: DVec3) -> Bounds {
    let (low, high) = (Vec3A::from(low.as_vec3()), Vec3A::from(high.as_vec3()));
    let pad = Vec3A::splat(PADDING * low.abs().max(high.abs()).max_element());
    Bounds { low: low - pad, high: high + pad }
}
