//! The wide tree: its nodes, and the walk of a ray through them.
//!
//! Boxes are stored as one array per side, so that a ray meets all children of a node at once.

use glam::Vec3A;

use super::bounds::Bounds;
use super::lanes::Eight;
use super::stack::Space;

/// Children of a node.
pub(super) const WIDTH: usize = 8;

/// The child field of a leaf has this bit, the number of its units less one in the two bits below, and the index of
/// its first unit in the rest. What a unit is depends on the tree: a triangle packet or an instance.
const LEAF: u32 = 1 << 31;
const COUNT_SHIFT: u32 = 29;
const INDEX: u32 = (1 << COUNT_SHIFT) - 1;
/// The most units in a leaf.
pub(super) const MAX_UNITS: usize = 4;
/// The child field of a place without child.
const NONE: u32 = u32::MAX;

/// A node. Sides are in the order low x, y, z, high x, y, z. Boxes of absent children are inverted.
#[repr(C, align(64))]
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Node {
    sides: [[f32; WIDTH]; 6],
    children: [u32; WIDTH],
}

impl Node {
    pub(super) fn empty() -> Self {
        let (low, high) = ([f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]);
        Self { sides: [low, low, low, high, high, high], children: [NONE; WIDTH] }
    }

    pub(super) fn set(&mut self, place: usize, bounds: Bounds, child: u32) {
        for axis in 0..3 {
            self.sides[axis][place] = bounds.low[axis];
            self.sides[axis + 3][place] = bounds.high[axis];
        }
        self.children[place] = child;
    }

    /// Replaces child fields.
    pub(super) fn relink(&mut self, replace: impl Fn(u32) -> u32) {
        self.children.iter_mut().filter(|child| **child != NONE).for_each(|child| *child = replace(*child));
    }
}

/// The child field after nodes and units were put behind others.
pub(super) fn moved(child: u32, nodes: usize, units: usize) -> u32 {
    child + if child & LEAF == 0 { nodes } else { units } as u32
}

/// The index of the first unit, where the child field is that of a leaf.
pub(super) fn first_unit(child: u32) -> Option<usize> {
    (child & LEAF != 0).then_some((child & INDEX) as usize)
}

/// The child field for the leaf with `count` units from `first`.
pub(super) fn leaf(first: usize, count: usize) -> u32 {
    debug_assert!((1..=MAX_UNITS).contains(&count) && first <= INDEX as usize);
    LEAF | ((count as u32 - 1) << COUNT_SHIFT) | first as u32
}

/// A tree of boxes.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tree {
    pub(super) nodes: Vec<Node>,
    /// Child field of the root.
    root: u32,
    /// Nodes on the longest way down.
    pub(super) depth: usize,
}

/// A ray as the box test wants it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slabs {
    inverse: [f32; 3],
    /// Origin times inverse direction for the near and the far sides. The two differ by the padding that the ray's own
    /// origin asks for.
    near: [f32; 3],
    far: [f32; 3],
    /// Axes along which the ray goes down, so that high sides are near.
    negative: [bool; 3],
}

/// Boxes grow by this part of the coordinates. Shear and edge functions of the triangle test and the box test itself
/// round to at most about a quarter of it.
pub(super) const PADDING: f32 = 4e-6;

impl Slabs {
    #[inline]
    pub(super) fn new(origin: Vec3A, direction: Vec3A) -> Self {
        // The inverse stays finite so that no product with a zero is undefined.
        let least = Vec3A::splat(1e-18);
        let steep = Vec3A::select(direction.abs().cmplt(least), least.copysign(direction), direction);
        let inverse = steep.recip();
        let pad = Vec3A::splat(PADDING * origin.abs().max_element()).copysign(inverse);
        Self {
            inverse: inverse.to_array(),
            near: ((origin + pad) * inverse).to_array(),
            far: ((origin - pad) * inverse).to_array(),
            negative: [inverse.x < 0.0, inverse.y < 0.0, inverse.z < 0.0],
        }
    }
}

/// Distances at which the ray enters the children, and the set of children that it meets before `limit`.
#[inline(always)]
fn meet(node: &Node, ray: &Slabs, limit: f32) -> (Eight, u32) {
    let mut enter = Eight::splat(0.0);
    let mut leave = Eight::splat(limit);
    for axis in 0..3 {
        let inverse = Eight::splat(ray.inverse[axis]);
        let (low, high) = (axis, axis + 3);
        let (near, far) = if ray.negative[axis] { (high, low) } else { (low, high) };
        let near = Eight::new(&node.sides[near]);
        enter = near.multiply_subtract(inverse, Eight::splat(ray.near[axis])).max(enter);
        let far = Eight::new(&node.sides[far]);
        leave = far.multiply_subtract(inverse, Eight::splat(ray.far[axis])).min(leave);
    }
    (enter, enter.at_most(leave))
}

/// A stack entry: distances are not negative, so their bits order like them.
#[inline(always)]
fn entry(distance: f32, child: u32) -> u64 {
    (u64::from(distance.to_bits()) << 32) | u64::from(child)
}

impl Tree {
    /// A tree without boxes.
    pub(super) const EMPTY: Self = Self { nodes: Vec::new(), root: NONE, depth: 0 };

    /// The tree below the child field `root`.
    pub(super) fn new(nodes: Vec<Node>, root: u32, depth: usize) -> Self {
        Self { nodes, root, depth }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.root == NONE
    }

    /// Calls `visit(first, count, limit)` for the leaves that the ray meets, nearer boxes first. `visit` answers with
    /// the new limit, which must not grow; a negative one ends the walk.
    #[inline(always)]
    pub(super) fn walk(&self, ray: &Slabs, mut limit: f32, mut visit: impl FnMut(u32, u32, f32) -> f32) {
        if self.is_empty() {
            return;
        }
        let mut space = Space::new(self.depth * (WIDTH - 1) + 1);
        let mut stack = space.stack();
        stack.push(entry(0.0, self.root));
        while let Some(top) = stack.pop() {
            if f32::from_bits((top >> 32) as u32) > limit {
                continue;
            }
            let mut child = top as u32;
            while child & LEAF == 0 {
                let node = &self.nodes[child as usize];
                let (enter, mut set) = meet(node, ray, limit);
                if set == 0 {
                    child = NONE;
                    break;
                }
                let first = set.trailing_zeros() as usize % WIDTH;
                child = node.children[first];
                set &= set - 1;
                if set != 0 {
                    let enter = enter.to_array();
                    let mut nearest = entry(enter[first], child);
                    let bottom = stack.len();
                    while set != 0 {
                        let i = set.trailing_zeros() as usize % WIDTH;
                        set &= set - 1;
                        let other = entry(enter[i], node.children[i]);
                        stack.push_sorted(nearest.max(other), bottom);
                        nearest = nearest.min(other);
                    }
                    child = nearest as u32;
                }
            }
            if child != NONE {
                limit = visit(child & INDEX, ((child & !LEAF) >> COUNT_SHIFT) + 1, limit);
                if limit < 0.0 {
                    return;
                }
            }
        }
    }
}
