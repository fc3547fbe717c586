//! Teeth of the tests of reversibility and stationarity: mutations with a wrong factor, or an uneven kernel, must fail them
//! (mlt.md §8 V5.5).
#![allow(clippy::unwrap_used, reason = "a failing test panics")]

mod common;

use ajar_integrators::mlt::{
    Aux, Mutation, Reject,
    chain::Kernel,
    choice::Table,
    manifold::generalized_geometry,
    mutations::{
        Bidirectional, Caustic, Chances, EyeChain, Lens, LensSubpath, LightChain, Manifold, MultiChain,
        Technique, Window,
    },
    path::{Path, Signature, Space},
    proposal::Proposal,
    target::Plain,
};
use ajar_render::rng::Rng;
use common::{reversibility::imbalance, samples::Samples, scenes::SCENES, settings, stationarity::drift};

type Error = fn(&Space<'_>, &Path, &Path, &Aux) -> f64;

/// Whether a mutation is kept from a proposal.
type Veto = fn(&Path, &Path, &mut Rng) -> bool;

/// A mutation that gets its density wrong by the factor `error`, and does not tell of proposals that it drops.
struct Broken<'a> {
    inner: &'a dyn Mutation,
    error: Error,
    drops: Veto,
}

impl Mutation for Broken<'_> {
    fn name(&self) -> &'static str {
        self.inner.name()
    }
    fn applies(&self, x: &Signature) -> bool {
        self.inner.applies(x)
    }
    fn propose(&self, space: &Space<'_>, x: &Path, y: &mut Proposal, rng: &mut Rng) -> Result<Aux, Reject> {
        let aux = self.inner.propose(space, x, y, rng)?;
        if (self.drops)(x, &y.path, rng) { Err(Reject::Unsuitable) } else { Ok(aux) }
    }
    fn q(&self, space: &Space<'_>, x: &Path, y: &Path, aux: &Aux) -> f64 {
        self.inner.q(space, x, y, aux) * (self.error)(space, x, y, aux)
    }
}

/// Exact samples of the target.
const SAMPLES: usize = 300_000;

fn assert_all_show<'a>(variants: impl Iterator<Item = (&'a str, Broken<'a>)>) {
    let scene = SCENES.iter().find(|scene| scene.name == "mirror and glass").unwrap();
    let world = (scene.world)();
    let settings = settings(&world, 5, scene.depth, 1);
    let space = Space::new(&world, settings.window, settings.max_depth);
    let samples = Samples::draw(space, &settings, &Plain, (0, SAMPLES));
    let table = Table::uniform(&[1.0]);
    for (what, broken) in variants {
        let found =
            imbalance(&samples, &Kernel { space, mutations: &[&broken], table: &table, target: &Plain });
        println!("{} {what}: {found:.2?}", broken.name());
        assert!(!found.is_none(), "{} {what} went unnoticed", broken.name());
    }
}

/// n_l: the pieces of the length that was chosen which could have been deleted.
fn places(space: &Space<'_>, x: &Path, aux: &Aux) -> f64 {
    let can = |stem: &usize| Chances::new(space, x, &Aux { stem: *stem, added: 2, ..*aux }).range > 0.0;
    (0..=x.edges()).filter(can).count() as f64
}

fn from_eye(y: &Path, aux: &Aux) -> f64 {
    (aux.stem..=y.edges()).map(|i| y.from_eye(i)).product()
}

/// Of the technique that makes all moving vertices from the eye alone, in proportion to all of them.
fn from_one_side(y: &Path, aux: &Aux) -> f64 {
    let mut first = None;
    y.splits(aux.stem, aux.added, |_, p| first = first.or((p > 0.0).then_some(p)));
    first.unwrap() / y.density(aux.stem, aux.added)
}

#[test]
fn a_wrong_factor_or_an_uneven_kernel_shows() {
    let factors: [(&str, &dyn Mutation, Error); 15] = [
        ("without p_d", &Bidirectional, |space, x, _, aux| 1.0 / Chances::new(space, x, aux).range),
        ("without p_a", &Bidirectional, |space, x, _, aux| 1.0 / Chances::new(space, x, aux).length),
        ("without the number of places", &Bidirectional, |space, x, _, aux| places(space, x, aux)),
        ("without the choice of the split", &Bidirectional, |space, x, _, aux| {
            1.0 / Chances::new(space, x, aux).split
        }),
        ("without the samplers' densities", &Technique, |_, _, y, aux| 1.0 / y.density(0, aux.added)),
        ("without the other techniques", &Technique, |_, _, y, aux| from_one_side(y, aux)),
        ("without the chances of lobes", &Technique, |_, _, _, aux| aux.labels[1]),
        ("without the samplers' densities", &Window, |_, _, y, aux| 1.0 / y.density(aux.stem, aux.added)),
        ("without the camera's density", &Lens, |_, _, y, _| 1.0 / y.nodes[y.edges()].to_light),
        ("without importance", &Caustic, |_, _, y, _| y.nodes[y.edges()].to_light),
        ("without the contribution", &MultiChain, |_, _, y, _| y.scalar()),
        ("without the walk's density", &LensSubpath, |_, _, y, aux| 1.0 / from_eye(y, aux)),
        ("without the walk's density", &EyeChain, |_, _, y, aux| 1.0 / from_eye(y, aux)),
        ("without the contribution", &LightChain, |_, _, y, _| y.scalar()),
        ("without the generalized geometry", &Manifold, |space, _, y, aux| {
            let bend = (aux.stem..aux.stem + aux.added).rev().find(|&i| y.connectable(i)).unwrap();
            let chain: Vec<_> = y.nodes[aux.stem - 1..=bend].iter().map(|node| node.vertex).collect();
            generalized_geometry(space.world, &chain).unwrap()
        }),
    ];
    // Kernels must be as likely back as forth.
    let kernels: [(&str, &dyn Mutation, Veto); 3] = [
        ("to the left", &Lens, |x, y, rng| y.raster.x > x.raster.x && rng.f64() < 0.3),
        ("upwards", &Caustic, |x, y, rng| y.raster.y > x.raster.y && rng.f64() < 0.3),
        ("to bright paths", &Window, |x, y, rng| y.scalar() > x.scalar() && rng.f64() < 0.3),
    ];
    let factors = factors.map(|(what, inner, error)| (what, Broken { inner, error, drops: |_, _, _| false }));
    let kernels =
        kernels.map(|(what, inner, drops)| (what, Broken { inner, error: |_, _, _, _| 1.0, drops }));
    assert_all_show(factors.into_iter().chain(kernels));
}

/// What goes wrong by much also moves the target itself.
#[test]
fn a_wrong_factor_drifts() {
    let scene = SCENES.iter().find(|scene| scene.name == "mirror and glass").unwrap();
    let world = (scene.world)();
    let settings = settings(&world, 5, scene.depth, 1);
    let variants: [(&dyn Mutation, Error); 4] = [
        (&Bidirectional, |space, x, _, aux| 1.0 / Chances::new(space, x, aux).range),
        (&Lens, |_, _, y, _| 1.0 / y.nodes[y.edges()].to_light),
        (&LensSubpath, |_, _, y, aux| 1.0 / from_eye(y, aux)),
        (&EyeChain, |_, _, y, aux| 1.0 / from_eye(y, aux)),
    ];
    for (inner, error) in variants {
        let broken = Broken { inner, error, drops: |_, _, _| false };
        let found = drift(&world, &settings, (&[&broken], &Table::uniform(&[1.0])), &Plain, 8, 20_000);
        println!("{}: {found:.2?}", broken.name());
        assert!(!found.is_none(), "{} went unnoticed", broken.name());
    }
}
