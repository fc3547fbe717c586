//! A Markov chain over paths (Veach & Guibas 1997 §3; mlt.md §3.2 of the design).

use ajar_render::{math::Rgb, rng::Rng};

use super::{
    Aux, Mutation, Reject,
    choice::{Learner, Selection, Table},
    lens_subpaths::LensSubpaths,
    path::{Path, Space},
    proposal::Proposal,
    stats::ChainStats,
    target::{Aim, Target},
};

/// What all chains of a round share.
#[derive(Clone, Copy)]
pub struct Kernel<'a> {
    /// Where paths live.
    pub space: Space<'a>,
    /// The mutations, in the order of the table.
    pub mutations: &'a [&'a dyn Mutation],
    /// Their weights.
    pub table: &'a Table,
    /// The density to visit.
    pub target: &'a dyn Target,
}

/// A chain.
pub struct Chain<'a> {
    kernel: Kernel<'a>,
    rng: Rng,
    x: Path,
    aim: Aim,
    selection: Selection,
    y: Proposal,
    /// Steps that x has stood for and not yet deposited.
    pending: f64,
    /// What happened.
    pub stats: ChainStats,
    /// Learns which mutations serve which paths, if asked to.
    pub learner: Option<Box<Learner>>,
}

impl<'a> Chain<'a> {
    /// A chain with nothing in it yet, but all the memory that it will need.
    pub fn new(kernel: Kernel<'a>, rng: Rng) -> Self {
        Self {
            kernel,
            rng,
            x: Path::with_capacity(),
            aim: Aim { weight: 1.0, deposit: Rgb::ZERO },
            selection: Selection::NONE,
            y: Proposal::default(),
            pending: 0.0,
            stats: ChainStats::default(),
            learner: None,
        }
    }

    /// What the chains that follow are offered.
    pub fn share(&mut self, subpaths: LensSubpaths) {
        self.y.lens_subpaths = subpaths;
    }

    /// Begins again at `seed`, whose f* is not 0, with the random numbers of `rng`.
    pub fn start(&mut self, seed: &Path, rng: Rng) {
        self.rng = rng;
        self.y.lens_subpaths.next_chain();
        self.x.copy_from(seed);
        self.y.follow(seed);
        self.aim = self.kernel.target.aim(seed);
        self.selection = self.selection_at(seed);
        self.pending = 0.0;
    }

    /// Where the chain is.
    pub fn path(&self) -> &Path {
        &self.x
    }

    fn selection_at(&self, x: &Path) -> Selection {
        Selection::at(&x.signature, self.kernel.mutations, self.kernel.table)
    }

    /// Makes `steps` steps. `record` takes the paths of expected-value recording (Veach & Guibas 1997 §3.1): what they
    /// aim at, and the number of steps that they stand for, `steps` in all.
    pub fn run(&mut self, steps: u32, mut record: impl FnMut(&Path, &Aim, f64)) {
        for _ in 0..steps {
            self.step(&mut record);
        }
        record(&self.x, &self.aim, self.pending);
        self.pending = 0.0;
        self.stats.rays += std::mem::take(&mut self.y.rays);
    }

    /// One step.
    fn step(&mut self, record: &mut impl FnMut(&Path, &Aim, f64)) {
        let Some(m) = self.selection.choose(&mut self.rng) else {
            self.pending += 1.0;
            return;
        };
        let rays = self.y.rays;
        match self.propose(m) {
            Err(reject) => {
                self.stats.fail(m, reject);
                self.pending += 1.0;
                self.learn(m, rays, 0.0);
            }
            Ok(Proposed { aim, selection, acceptance }) => {
                self.learn(m, rays, acceptance);
                let accepted = self.rng.f64() < acceptance;
                self.stats.count(m, acceptance, accepted);
                if accepted {
                    record(&self.x, &self.aim, self.pending + 1.0 - acceptance);
                    self.y.accept(&mut self.x);
                    (self.aim, self.selection, self.pending) = (aim, selection, acceptance);
                } else {
                    if acceptance > 0.0 {
                        record(&self.y.path, &aim, acceptance);
                    }
                    self.pending += 1.0 - acceptance;
                }
            }
        }
    }

    /// Proposes a path into `y` by mutation number `m`.
    fn propose(&mut self, m: usize) -> Result<Proposed, Reject> {
        let mutation = self.kernel.mutations[m];
        let aux = mutation.propose(&self.kernel.space, &self.x, &mut self.y, &mut self.rng)?;
        let aim = self.kernel.target.aim(&self.y.path);
        let same_kind = self.y.path.signature == self.x.signature;
        let selection = if same_kind { self.selection } else { self.selection_at(&self.y.path) };
        let x = State { path: &self.x, aim: &self.aim, selection: &self.selection };
        let y = State { path: &self.y.path, aim: &aim, selection: &selection };
        let ratio = ratio(&self.kernel, &x, &y, m, &aux);
        if ratio.is_nan() {
            Err(Reject::NotFinite)
        } else {
            Ok(Proposed { aim, selection, acceptance: ratio.min(1.0) })
        }
    }

    fn learn(&mut self, m: usize, rays_before: u64, acceptance: f64) {
        if let Some(learner) = &mut self.learner {
            let moved = if acceptance > 0.0 { (self.y.path.raster - self.x.raster).length() } else { 0.0 };
            learner.note(&self.x.signature, m, self.y.rays - rays_before, (acceptance, moved));
        }
    }
}

/// A path that may be accepted.
struct Proposed {
    aim: Aim,
    selection: Selection,
    acceptance: f64,
}

/// A state of a chain: a path, what it aims at, and the chances of the mutations there.
#[derive(Clone, Copy)]
pub struct State<'a> {
    /// The path.
    pub path: &'a Path,
    /// Its aim.
    pub aim: &'a Aim,
    /// The chances there.
    pub selection: &'a Selection,
}

/// Metropolis–Hastings: π(y) T(x|y) / (π(x) T(y|x)) for mutation number `m`, the choice of the mutation included; the
/// acceptance probability where it is less than 1.
pub fn ratio(kernel: &Kernel<'_>, x: &State<'_>, y: &State<'_>, m: usize, aux: &Aux) -> f64 {
    let (space, mutation) = (&kernel.space, kernel.mutations[m]);
    let forth = mutation.q(space, x.path, y.path, aux);
    let back = mutation.q(space, y.path, x.path, &aux.reverse());
    if !(forth.is_normal() && (back.is_normal() || back == 0.0)) {
        // Products that leave the range of f64 do so seen from either end.
        return f64::NAN;
    }
    let chosen = y.selection.probability(m) / x.selection.probability(m);
    back / forth * chosen * y.aim.weight / x.aim.weight
}
