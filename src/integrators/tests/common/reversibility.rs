//! Detailed balance, seen in single steps: of all that chains move, as much must go one way as the other.
//!
//! Paths x are exact samples of the target; from each a mutation proposes y, accepted with probability a. For any h with
//! h(y, x) = −h(x, y) the mean of a·h(x, y) is 0 if the kernel is reversible. A factor of the density that is wrong, or a
//! kernel that is not as likely back as forth, drives what depends on it one way at once; the distribution itself drifts
//! slowly.

use ajar_integrators::mlt::{
    chain::{Kernel, State, ratio},
    choice::Selection,
    lens_subpaths::{LensSubpaths, Spread},
    path::Path,
    proposal::Proposal,
};
use ajar_render::rng::{Purpose, Rng};
use rayon::prelude::*;

use super::samples::Samples;

/// What is watched of a path; changes count up to 1.
const NAMES: [&str; 15] = [
    "contribution",
    "column",
    "row",
    "edges",
    "length",
    "place on the light",
    "first edge",
    "last edge",
    "shortest edge",
    "density from the eye",
    "density from the light",
    "density of all techniques",
    "geometry",
    "Dirac chances",
    "label of the proposal",
];

/// `label` is the probability of what a proposal keeps besides.
fn watched(path: &Path, label: f64) -> [f64; NAMES.len()] {
    let (k, nodes) = (path.edges(), &path.nodes);
    let lengths = || nodes[..k].iter().map(|node| node.edge.length);
    [
        path.scalar().ln(),
        path.raster.x,
        path.raster.y,
        k as f64,
        lengths().sum(),
        nodes[0].vertex.p.x,
        nodes[0].edge.length,
        nodes[k - 1].edge.length,
        lengths().fold(f64::INFINITY, f64::min),
        (0..=k).map(|i| path.from_eye(i).ln()).sum(),
        (0..=k).map(|i| path.from_light(i).ln()).sum(),
        path.density(0, k + 1).ln(),
        nodes[..k].iter().map(|node| node.geometry.ln()).sum(),
        nodes.iter().map(|node| node.chance_to_light.ln()).sum(),
        label.ln(),
    ]
}

/// What goes one way more than the other.
#[derive(Clone, Copy, Debug)]
pub struct Imbalance {
    pub what: &'static str,
    /// Largest |z| of all that is watched.
    pub largest_z: f64,
    pub acceptance: f64,
}

impl Imbalance {
    /// Some thousand of them are looked at, each with fifteen figures.
    pub fn is_none(&self) -> bool {
        self.largest_z < 5.0
    }
}

const BLOCKS: usize = 64;
/// Fewest groups that must tell of a difference for its sum to be nearly normal.
const FEWEST: f64 = 200.0;

/// Sums over groups of paths: of what moved, its square and its fourth power.
#[derive(Clone, Copy, Default)]
struct Sums([f64; 3]);

impl Sums {
    fn add(&mut self, moved: f64) {
        let square = moved * moved;
        self.0 = [self.0[0] + moved, self.0[1] + square, self.0[2] + square * square];
    }

    fn z(&self) -> f64 {
        let [sum, squares, fourths] = self.0;
        if squares * squares < FEWEST * fourths || squares == 0.0 { 0.0 } else { sum / squares.sqrt() }
    }
}

/// Makes a proposal from each of the samples.
pub fn imbalance(samples: &Samples<'_>, kernel: &Kernel<'_>) -> Imbalance {
    let blocks: Vec<_> = (0..BLOCKS)
        .into_par_iter()
        .map(|block| {
            let (mut tracer, mut x, mut y) =
                (samples.bootstrap.tracer(), Path::with_capacity(), Proposal::default());
            y.lens_subpaths = LensSubpaths::new(Spread::AcrossChains, (1, 0), block as u32, BLOCKS as u32);
            let mut sums = [Sums::default(); NAMES.len()];
            let (mut tried, mut accepted) = (0u64, 0.0);
            for group in samples.groups(block, BLOCKS) {
                let mut moved = [0.0; NAMES.len()];
                for (i, candidate) in group {
                    if samples.bootstrap.replay(candidate, &mut tracer, &mut x).is_none() {
                        continue;
                    }
                    tried += 1;
                    let mut rng = Rng::new(1, Purpose::Chain, 0, i as u64);
                    let Some(Proposed { acceptance, labels }) = propose(kernel, &x, &mut y, &mut rng) else {
                        continue;
                    };
                    accepted += acceptance;
                    let (before, after) = (watched(&x, labels[0]), watched(&y.path, labels[1]));
                    for (moved, (before, after)) in moved.iter_mut().zip(before.iter().zip(after)) {
                        let change = (after - before).clamp(-1.0, 1.0);
                        *moved += if change.is_nan() { 0.0 } else { acceptance * change };
                    }
                }
                sums.iter_mut().zip(moved).for_each(|(sums, moved)| sums.add(moved));
            }
            (sums, tried, accepted)
        })
        .collect();
    let mut found = Imbalance { what: "nothing", largest_z: 0.0, acceptance: 0.0 };
    for (q, what) in NAMES.into_iter().enumerate() {
        let mut sums = Sums::default();
        for (block, ..) in &blocks {
            sums.0.iter_mut().zip(block[q].0).for_each(|(sum, part)| *sum += part);
        }
        if sums.z().abs() > found.largest_z {
            (found.what, found.largest_z) = (what, sums.z().abs());
        }
    }
    let tried: u64 = blocks.iter().map(|block| block.1).sum();
    found.acceptance = blocks.iter().map(|block| block.2).sum::<f64>() / tried.max(1) as f64;
    found
}

/// How likely a proposal is accepted, and the probabilities of its label at x and y.
struct Proposed {
    acceptance: f64,
    labels: [f64; 2],
}

/// Proposes a path into `y`.
fn propose(kernel: &Kernel<'_>, x: &Path, y: &mut Proposal, rng: &mut Rng) -> Option<Proposed> {
    let selection = |path: &Path| Selection::at(&path.signature, kernel.mutations, kernel.table);
    let of_x = selection(x);
    let m = of_x.choose(rng)?;
    y.follow(x);
    let aux = kernel.mutations[m].propose(&kernel.space, x, y, rng).ok()?;
    let y = &y.path;
    let (aim_x, aim_y, of_y) = (kernel.target.aim(x), kernel.target.aim(y), selection(y));
    let x = State { path: x, aim: &aim_x, selection: &of_x };
    let y = State { path: y, aim: &aim_y, selection: &of_y };
    // The driver drops what is not a number.
    let ratio = Some(ratio(kernel, &x, &y, m, &aux)).filter(|ratio| !ratio.is_nan())?;
    Some(Proposed { acceptance: ratio.min(1.0), labels: aux.labels })
}
