//! From boxes to a wide tree. The boxes are split from the top into chunks; each chunk becomes wide subtrees by itself, some
//! at a time, so that binary trees exist for few boxes only. Time is in proportion to n log n, whatever the boxes are.

use rayon::prelude::*;

use super::{
    binary::{Binary, deepest},
    bounds::Bounds,
    cut::{Leaves, Pieces, cut},
    split::split,
    tree::{self, Tree},
};

/// Boxes of a chunk, at most.
const CHUNK: usize = 1 << 15;

/// Subtrees that a chunk leaves to be joined with those of other chunks: a tree over them is better than one over chunks,
/// for a chunk is as large as its largest box.
const LOOSE: usize = 64;

/// Prices of the tree above.
const ABOVE: Leaves = Leaves { capacity: 1, packet: 1, price: 1.0 };

/// How the boxes were split into chunks.
enum Top {
    Chunk(usize),
    Split(Box<[Top; 2]>),
}

impl Top {
    /// Splits `members` in place, `left` levels by cost.
    fn new(boxes: &[Bounds], members: &mut [u32], left: u32) -> Self {
        if members.len() <= CHUNK {
            return Self::Chunk(members.len());
        }
        let middle = if left > 0 { split(boxes, members) } else { members.len() / 2 };
        let (one, other) = members.split_at_mut(middle);
        let below = left.saturating_sub(1);
        let (one, other) = rayon::join(|| Self::new(boxes, one, below), || Self::new(boxes, other, below));
        Self::Split(Box::new([one, other]))
    }

    /// Sizes of the chunks, in order.
    fn sizes(self, sizes: &mut Vec<usize>) {
        match self {
            Self::Chunk(size) => sizes.push(size),
            Self::Split(below) => below.into_iter().for_each(|top| top.sizes(sizes)),
        }
    }
}

/// Builds the tree over `boxes`. `store` appends the units of a leaf with these boxes; `take` gets all units in their
/// order, some at a time.
pub(super) fn build<U: Send>(
    boxes: &[Bounds],
    leaves: Leaves,
    store: impl Fn(&[u32], &mut Vec<U>) + Sync,
    mut take: impl FnMut(Vec<U>),
) -> Tree {
    if boxes.is_empty() {
        return Tree::EMPTY;
    }
    let mut members: Vec<u32> = (0..boxes.len() as u32).collect();
    let mut sizes = Vec::new();
    Top::new(boxes, &mut members, deepest(boxes.len())).sizes(&mut sizes);
    let (mut all, mut units) = (Pieces { nodes: Vec::new(), depth: 0, roots: Vec::new() }, 0);
    let mut chunks = slices(&mut members, &sizes);
    for batch in chunks.chunks_mut(2 * rayon::current_num_threads()) {
        let made: Vec<_> = batch.par_iter_mut().map(|chunk| pieces(boxes, chunk, leaves, &store)).collect();
        for (mut pieces, stored) in made {
            let nodes = all.nodes.len();
            pieces.nodes.iter_mut().for_each(|node| node.relink(|child| tree::moved(child, nodes, units)));
            all.nodes.append(&mut pieces.nodes);
            all.roots.extend(pieces.roots.iter().map(|&(child, b)| (tree::moved(child, nodes, units), b)));
            all.depth = all.depth.max(pieces.depth);
            units += stored.len();
            take(stored);
        }
    }
    join(all)
}

/// The list in parts of these sizes.
fn slices<'a>(mut list: &'a mut [u32], sizes: &[usize]) -> Vec<&'a mut [u32]> {
    let mut slices = Vec::with_capacity(sizes.len());
    for &size in sizes {
        let (slice, rest) = list.split_at_mut(size);
        slices.push(slice);
        list = rest;
    }
    slices
}

/// Wide subtrees over some of the boxes, and what their leaves refer to.
fn pieces<U>(
    boxes: &[Bounds],
    members: &mut [u32],
    leaves: Leaves,
    store: &impl Fn(&[u32], &mut Vec<U>),
) -> (Pieces, Vec<U>) {
    let mut units = Vec::with_capacity(members.len().div_ceil(leaves.packet));
    let pieces = cut(&Binary::split(boxes, members), leaves, LOOSE, |members| {
        let first = units.len();
        store(members, &mut units);
        tree::leaf(first, units.len() - first)
    });
    (pieces, units)
}

/// One tree over all roots.
fn join(Pieces { mut nodes, depth, roots }: Pieces) -> Tree {
    if let [(root, _)] = roots[..] {
        return Tree::new(nodes, root, depth);
    }
    let boxes: Vec<Bounds> = roots.iter().map(|root| root.1).collect();
    let mut above = cut(&Binary::joined(&boxes), ABOVE, 1, |members| tree::leaf(members[0] as usize, 1));
    let first = nodes.len();
    let link = |child| tree::first_unit(child).map_or(tree::moved(child, first, 0), |root| roots[root].0);
    above.nodes.iter_mut().for_each(|node| node.relink(link));
    nodes.append(&mut above.nodes);
    Tree::new(nodes, link(above.roots[0].0), depth + above.depth)
}
