//! From a binary tree to a wide one, cut into wide nodes and leaves at the least expected cost by the dynamic programme of
//! Ylitie, Karras & Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", section 3.1.

use super::binary::Binary;
use super::bounds::Bounds;
use super::tree::{Node, WIDTH};

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

impl Leaves {
    fn cost(self, area: f32, boxes: u32) -> f32 {
        if boxes as usize > self.capacity {
            return f32::INFINITY;
        }
        area * self.price * (boxes as usize).div_ceil(self.packet) as f32
    }
}

/// For a subtree: its boxes, and the least cost of showing it as at most 1, 2, … `WIDTH` - 1 places of a wide node.
#[derive(Clone)]
struct Cost {
    boxes: u32,
    places: [f32; WIDTH - 1],
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

fn costs(binary: &Binary, leaves: Leaves) -> Vec<Cost> {
    let mut costs = vec![Cost { boxes: 1, places: [0.0; WIDTH - 1] }; binary.nodes.len()];
    for (index, node) in binary.nodes.iter().enumerate().rev() {
        let area = node.bounds.half_area();
        costs[index] = if node.is_leaf {
            Cost { boxes: 1, places: [leaves.cost(area, 1); WIDTH - 1] }
        } else {
            let (left, right) = (&costs[node.first as usize], &costs[node.first as usize + 1]);
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

/// What a binary tree was cut into.
pub(super) struct Pieces {
    pub(super) nodes: Vec<Node>,
    /// Nodes on the longest way down.
    pub(super) depth: usize,
    /// Child fields and bounds of the subtrees that nothing above holds together.
    pub(super) roots: Vec<(u32, Bounds)>,
}

/// Cuts the tree, all but its largest inner nodes: as many as leave `most` subtrees, or less. `emit` stores the boxes of a
/// leaf and answers with its child field.
pub(super) fn cut(binary: &Binary, leaves: Leaves, most: usize, emit: impl FnMut(&[u32]) -> u32) -> Pieces {
    let costs = costs(binary, leaves);
    let pieces = Pieces { nodes: Vec::new(), depth: 0, roots: Vec::new() };
    let mut cutter = Cutter { binary, costs: &costs, leaves, emit, prims: Vec::new(), pieces };
    for root in cutter.roots(most) {
        cutter.cut(root);
    }
    cutter.pieces
}

struct Cutter<'a, F> {
    binary: &'a Binary,
    costs: &'a [Cost],
    leaves: Leaves,
    emit: F,
    prims: Vec<u32>,
    pieces: Pieces,
}

impl<F: FnMut(&[u32]) -> u32> Cutter<'_, F> {
    /// At most `most` subtrees that make up the tree, the largest split first.
    fn roots(&self, most: usize) -> Vec<u32> {
        let area = |index: u32| self.binary.nodes[index as usize].bounds.half_area();
        let (mut open, mut leaves) = (vec![0], Vec::new());
        while open.len() + leaves.len() < most {
            let Some(at) = (0..open.len()).max_by(|&a, &b| area(open[a]).total_cmp(&area(open[b]))) else {
                break;
            };
            let index = open.swap_remove(at);
            if self.is_leaf(index) {
                leaves.push(index);
            } else {
                let first = self.binary.nodes[index as usize].first;
                open.extend([first, first + 1]);
            }
        }
        leaves.append(&mut open);
        leaves
    }

    /// Makes the wide nodes of a subtree.
    fn cut(&mut self, root: u32) {
        let child = self.child(root);
        self.pieces.roots.push((child, self.binary.nodes[root as usize].bounds));
        if self.is_leaf(root) {
            return;
        }
        // Binary node, wide node, depth.
        let mut open = vec![(root, child, 1)];
        let mut members = Vec::with_capacity(WIDTH);
        while let Some((index, wide, depth)) = open.pop() {
            self.pieces.depth = self.pieces.depth.max(depth);
            members.clear();
            self.members_of_children(index, WIDTH, &mut members);
            for (place, &member) in members.iter().enumerate() {
                let child = self.child(member);
                let bounds = self.binary.nodes[member as usize].bounds;
                self.pieces.nodes[wide as usize].set(place, bounds, child);
                if !self.is_leaf(member) {
                    open.push((member, child, depth + 1));
                }
            }
        }
    }

    /// The child field for a subtree: that of a leaf, which is stored, or of a new node.
    fn child(&mut self, index: u32) -> u32 {
        if self.is_leaf(index) {
            return self.leaf(index);
        }
        self.pieces.nodes.push(Node::empty());
        self.pieces.nodes.len() as u32 - 1
    }

    /// Whether a subtree that takes one place is a leaf.
    fn is_leaf(&self, index: u32) -> bool {
        let node = &self.binary.nodes[index as usize];
        let cost = &self.costs[index as usize];
        // The area of boxes beyond 10¹⁹ overflows: then all costs are infinite, and capacity alone decides.
        let fits = cost.boxes as usize <= self.leaves.capacity;
        node.is_leaf || (fits && self.leaves.cost(node.bounds.half_area(), cost.boxes) <= cost.places[0])
    }

    /// The subtrees that fill `places` places below the inner node `index`.
    fn members_of_children(&self, index: u32, places: usize, members: &mut Vec<u32>) {
        let left = self.binary.nodes[index as usize].first;
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

    /// Stores all boxes of a subtree.
    fn leaf(&mut self, index: u32) -> u32 {
        self.prims.clear();
        let mut open = vec![index];
        while let Some(index) = open.pop() {
            let node = &self.binary.nodes[index as usize];
            if node.is_leaf {
                self.prims.push(node.first);
            } else {
                open.extend([node.first + 1, node.first]);
            }
        }
        (self.emit)(&self.prims)
    }
}
