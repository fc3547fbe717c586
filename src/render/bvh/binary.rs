//! Binary trees over boxes.

use glam::Vec3A;
use obvhs::aabb::Aabb;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

use super::{bounds::Bounds, split::split, tree::PADDING};

/// A node; its children follow each other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub(super) bounds: Bounds,
    /// The first child of an inner node, the box of a leaf.
    pub(super) first: u32,
    pub(super) is_leaf: bool,
}

impl Node {
    pub(super) fn leaf(bounds: Bounds, first: u32) -> Self {
        Self { bounds, first, is_leaf: true }
    }

    /// Its bounds follow from those below.
    pub(super) fn inner(first: u32) -> Self {
        Self { bounds: Bounds::EMPTY, first, is_leaf: false }
    }
}

/// Nodes with parents before children, the root first. Every leaf holds one box.
#[derive(Debug)]
pub(super) struct Binary {
    pub(super) nodes: Vec<Node>,
}

/// How deep a tree over `count` boxes may become before it is split in halves.
pub(super) fn deepest(count: usize) -> u32 {
    2 * count.max(1).ilog2() + 8
}

impl Binary {
    /// The tree over those of the `boxes` that are `members`, at least one, by splitting from the top.
    pub(super) fn split(boxes: &[Bounds], members: &mut [u32]) -> Self {
        let mut nodes = Vec::with_capacity(2 * members.len());
        nodes.push(Node::inner(0));
        // Node, its members, levels that are left.
        let mut open = vec![(0, 0..members.len(), deepest(members.len()))];
        while let Some((node, range, left)) = open.pop() {
            let part = &mut members[range.clone()];
            if let [member] = *part {
                nodes[node] = Node::leaf(boxes[member as usize], member);
                continue;
            }
            let middle = range.start + if left > 0 { split(boxes, part) } else { part.len() / 2 };
            let first = nodes.len();
            nodes[node] = Node::inner(first as u32);
            nodes.extend([Node::inner(0); 2]);
            let below = left.saturating_sub(1);
            open.push((first + 1, middle..range.end, below));
            open.push((first, range.start..middle, below));
        }
        Self::fitted(nodes)
    }

    /// The tree over few `boxes`, at least one, by joining neighbours and improving the outcome: PLOC and parallel
    /// reinsertion (D. Meister, J. Bittner, both 2018). It is better than splitting, but takes quadratic time at worst.
    pub(super) fn joined(boxes: &[Bounds]) -> Self {
        let mut members: Vec<u32> = (0..boxes.len() as u32).collect();
        if !boxes.iter().copied().fold(Bounds::EMPTY, Bounds::union).half_area().is_finite() {
            return Self::split(boxes, &mut members);
        }
        let boxes: Vec<Aabb> = boxes.iter().zip(0..).map(|(bounds, index)| distinct(bounds, index)).collect();
        let builder = &mut PlocBuilder::with_capacity(boxes.len());
        let mut tree = builder.build(PlocSearchDistance::Medium, &boxes, members, SortPrecision::U64, 3);
        ReinsertionOptimizer::default().run(&mut tree, 0.5, None);
        let mut nodes = vec![Node::inner(0)];
        let mut open = vec![(0, 0)];
        while let Some((from, to)) = open.pop() {
            let node = &tree.nodes[from];
            let first = node.first_index as usize;
            nodes[to] = if node.is_leaf() {
                let member = tree.primitive_indices[first];
                let Aabb { min, max } = boxes[member as usize];
                Node::leaf(Bounds { low: min, high: max }, member)
            } else {
                open.extend([(first, nodes.len()), (first + 1, nodes.len() + 1)]);
                let below = nodes.len() as u32;
                nodes.extend([Node::inner(0); 2]);
                Node::inner(below)
            };
        }
        Self::fitted(nodes)
    }

    /// The tree of these nodes, with bounds of inner nodes from those of the leaves.
    fn fitted(mut nodes: Vec<Node>) -> Self {
        for index in (0..nodes.len()).rev() {
            let Node { first, is_leaf, .. } = nodes[index];
            if !is_leaf {
                nodes[index].bounds = nodes[first as usize].bounds.union(nodes[first as usize + 1].bounds);
            }
        }
        Self { nodes }
    }
}

/// The box, a little larger in a way of its own: among coincident boxes, PLOC would find one pair of nearest neighbours
/// a pass and take quadratic time.
fn distinct(b: &Bounds, index: u32) -> Aabb {
    let grow = PADDING * b.low.abs().max(b.high.abs()).max_element();
    let part = |salt: u32| {
        let mut h = (index ^ salt.wrapping_mul(0x9E37_79B9)).wrapping_mul(0x85EB_CA6B);
        h = (h ^ (h >> 13)).wrapping_mul(0xC2B2_AE35);
        grow * ((h >> 16) as f32 / 65536.0)
    };
    Aabb::new(b.low - Vec3A::new(part(1), part(2), part(3)), b.high + Vec3A::new(part(4), part(5), part(6)))
}
