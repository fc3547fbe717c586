//! From boxes to a wide tree: `obvhs` builds and optimizes a binary tree (PLOC, Meister & Bittner 2018, and parallel
//! reinsertion, Meister & Bittner 2018), which is then cut into wide nodes and leaves at the least expected cost by the
//! dynamic programme of Ylitie, Karras & Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed
//! Wide BVHs", section 3.1.

use glam::Vec3A;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

use super::tree::{Node, PADDING, Tree, WIDTH};

/// What leaves may hold and cost.
#[derive(Clone, Copy)]
pub(super) struct Leaves {
    /// Most boxes in a leaf.
    pub(super) capacity: usize,
    /// Boxes that are tested at the price of one.
    pub(super) packet: usize,
    /// Price of a packet; a node costs 1.
    pub(super) price: f32,
}

/// Builds the tree over `boxes`. `emit` stores the boxes of a leaf and answers with its child field.
pub(super) fn build(boxes: &[Aabb], leaves: Leaves, emit: impl FnMut(&[u32]) -> u32) -> Tree {
    if boxes.is_empty() {
        return Tree { nodes: Vec::new(), depth: 0 };
    }
    let binary = binary_tree(boxes);
    let costs = costs(&binary, leaves);
    Cutter { binary: &binary, costs: &costs, leaves, emit, prims: Vec::new() }.cut()
}

fn binary_tree(boxes: &[Aabb]) -> Bvh2 {
    let boxes: Vec<Aabb> = boxes.iter().enumerate().map(|(i, b)| distinct(b, i as u32)).collect();
    let boxes = &boxes;
    let indices = (0..boxes.len() as u32).collect();
    let mut tree = PlocBuilder::with_capacity(boxes.len()).build(
        PlocSearchDistance::Medium,
        boxes,
        indices,
        SortPrecision::U64,
        3,
    );
    ReinsertionOptimizer::default().run(&mut tree, 0.1, None);
    tree
}

/// The box, a little larger in a way of its own: among coincident boxes, PLOC would find one pair of nearest neighbours
/// a pass and take quadratic time.
fn distinct(b: &Aabb, index: u32) -> Aabb {
    let grow = PADDING * b.min.abs().max(b.max.abs()).max_element();
    let part = |salt: u32| {
        let mut h = (index ^ salt.wrapping_mul(0x9E37_79B9)).wrapping_mul(0x85EB_CA6B);
        h = (h ^ (h >> 13)).wrapping_mul(0xC2B2_AE35);
        grow * ((h >> 16) as f32 / 65536.0)
    };
    Aabb::new(b.min - Vec3A::new(part(1), part(2), part(3)), b.max + Vec3A::new(part(4), part(5), part(6)))
}

/// For a subtree: its boxes, and the least cost of showing it as at most 1, 2, … `WIDTH` - 1 places of a wide node.
#[derive(Clone)]
struct Cost {
    boxes: u32,
    places: [f32; WIDTH - 1],
}

impl Leaves {
    fn cost(self, area: f32, boxes: u32) -> f32 {
        if boxes as usize > self.capacity {
            return f32::INFINITY;
        }
        area * self.price * (boxes as usize).div_ceil(self.packet) as f32
    }
}

/// The best split of `places` between two subtrees, and what it costs.
fn distribute(left: &Cost, right: &Cost, places: usize) -> (usize, f32) {
    let mut best = (1, f32::INFINITY);
    for k in 1..places {
        let cost = left.places[k - 1] + right.places[places - k - 1];
        if cost < best.1 {
            best = (k, cost);
        }
    }
    best
}

fn costs(binary: &Bvh2, leaves: Leaves) -> Vec<Cost> {
    let mut costs = vec![Cost { boxes: 0, places: [0.0; WIDTH - 1] }; binary.nodes.len()];
    let mut order = vec![0u32];
    let mut next = 0;
    while let Some(&index) = order.get(next) {
        let node = &binary.nodes[index as usize];
        if !node.is_leaf() {
            order.extend([node.first_index, node.first_index + 1]);
        }
        next += 1;
    }
    for &index in order.iter().rev() {
        let node = &binary.nodes[index as usize];
        let area = node.aabb().half_area();
        costs[index as usize] = if node.is_leaf() {
            Cost { boxes: node.prim_count, places: [leaves.cost(area, node.prim_count); WIDTH - 1] }
        } else {
            let (left, right) = (&costs[node.first_index as usize], &costs[node.first_index as usize + 1]);
            let boxes = left.boxes + right.boxes;
            let inner = distribute(left, right, WIDTH).1 + area;
            let mut places = [leaves.cost(area, boxes).min(inner); WIDTH - 1];
            for i in 2..WIDTH {
                places[i - 1] = places[i - 2].min(distribute(left, right, i).1);
            }
            Cost { boxes, places }
        };
    }
    costs
}

struct Cutter<'a, F> {
    binary: &'a Bvh2,
    costs: &'a [Cost],
    leaves: Leaves,
    emit: F,
    prims: Vec<u32>,
}

impl<F: FnMut(&[u32]) -> u32> Cutter<'_, F> {
    fn cut(mut self) -> Tree {
        let mut tree = Tree { nodes: vec![Node::empty()], depth: 1 };
        if self.is_leaf(0) {
            self.fill(&mut tree, 0, 0, 0);
            return tree;
        }
        // Binary node, wide node, depth.
        let mut open = vec![(0u32, 0u32, 1usize)];
        while let Some((index, wide, depth)) = open.pop() {
            tree.depth = tree.depth.max(depth);
            let mut members = Vec::with_capacity(WIDTH);
            self.members_of_children(index, WIDTH, &mut members);
            for (place, &member) in members.iter().enumerate() {
                if self.is_leaf(member) {
                    self.fill(&mut tree, wide, place, member);
                } else {
                    let child = tree.nodes.len() as u32;
                    tree.nodes.push(Node::empty());
                    self.set(&mut tree, wide, place, member, child);
                    open.push((member, child, depth + 1));
                }
            }
        }
        tree
    }

    /// Whether a subtree that takes one place is a leaf.
    fn is_leaf(&self, index: u32) -> bool {
        let node = &self.binary.nodes[index as usize];
        let cost = &self.costs[index as usize];
        // The area of boxes beyond 10¹⁹ overflows: then all costs are infinite, and capacity alone decides.
        let fits = cost.boxes as usize <= self.leaves.capacity;
        node.is_leaf() || (fits && self.leaves.cost(node.aabb().half_area(), cost.boxes) <= cost.places[0])
    }

    /// The subtrees that fill `places` places below the inner node `index`.
    fn members_of_children(&self, index: u32, places: usize, members: &mut Vec<u32>) {
        let left = self.binary.nodes[index as usize].first_index;
        let (k, _) = distribute(&self.costs[left as usize], &self.costs[left as usize + 1], places);
        self.members(left, k, members);
        self.members(left + 1, places - k, members);
    }

    fn members(&self, index: u32, mut places: usize, members: &mut Vec<u32>) {
        let cost = &self.costs[index as usize].places;
        while places > 1 && cost[places - 2] <= cost[places - 1] {
            places -= 1;
        }
        if places == 1 {
            members.push(index);
        } else {
            self.members_of_children(index, places, members);
        }
    }

    fn fill(&mut self, tree: &mut Tree, wide: u32, place: usize, member: u32) {
        self.prims.clear();
        let mut open = vec![member];
        while let Some(index) = open.pop() {
            let node = &self.binary.nodes[index as usize];
            if node.is_leaf() {
                let range = node.first_index as usize..(node.first_index + node.prim_count) as usize;
                self.prims.extend_from_slice(&self.binary.primitive_indices[range]);
            } else {
                open.extend([node.first_index + 1, node.first_index]);
            }
        }
        let child = (self.emit)(&self.prims);
        self.set(tree, wide, place, member, child);
    }

    fn set(&self, tree: &mut Tree, wide: u32, place: usize, member: u32, child: u32) {
        let aabb = self.binary.nodes[member as usize].aabb();
        tree.nodes[wide as usize].set(place, aabb.min.to_array(), aabb.max.to_array(), child);
    }
}
