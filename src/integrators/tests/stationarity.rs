//! Each mutation, alone and in the mix, leaves the target as it is, and one with a wrong factor does not (mlt.md §8 V5).
//!
//! `AJAR_RELEASE_TESTS=1` takes a million seeds instead of twenty thousand.
#![allow(clippy::unwrap_used, reason = "a failing test panics")]

mod common;

use std::collections::BTreeMap;

use ajar_integrators::mlt::{
    Aux, Mutation, Reject,
    manifold::generalized_geometry,
    mutations::{
        Bidirectional, Caustic, Chances, EyeChain, Lens, LensSubpath, LightChain, Manifold, MultiChain,
        Technique, Window, mutations,
    },
    path::{Path, Signature, Space},
    proposal::Proposal,
    target::{Plain, Target},
};
use ajar_render::rng::Rng;
use common::{
    scenes::{IMAGES, SCENES, TestScene},
    settings,
    stationarity::drift,
};

fn seeds() -> usize {
    if std::env::var_os("AJAR_RELEASE_TESTS").is_some() { 1_000_000 } else { 20_000 }
}

fn scene(name: &str) -> &'static TestScene {
    SCENES.iter().find(|scene| scene.name == name).unwrap()
}

fn check(scene: &TestScene, mutations: &[&dyn Mutation], target: &dyn Target) {
    let world = (scene.world)();
    let names = mutations.iter().map(|m| m.name()).collect::<Vec<_>>().join(" + ");
    for steps in [1, 8, 64] {
        let found = drift(&world, &settings(&world, 5, scene.depth, 1), mutations, target, steps, seeds());
        println!("{}, {names}, {steps} steps: {found:.2?}", scene.name);
        assert!(found.is_none(), "{}, {names}, {steps} steps: {found:?}", scene.name);
    }
}

#[test]
fn every_mutation_alone() {
    for (mutation, scenes) in [
        (&Bidirectional as &dyn Mutation, ["rough metal and plastic", "mirror and glass"]),
        (&Lens, ["rough metal and plastic", "mirror and glass"]),
        (&Caustic, ["mirror and glass", "mirror and glass"]),
        (&MultiChain, ["mirror and glass", "mirror and glass"]),
        (&Window, ["rough metal and plastic", "mirror and glass"]),
        (&Technique, ["rough metal and plastic", "mirror and glass"]),
        (&LensSubpath, ["rough metal and plastic", "mirror and glass"]),
        (&EyeChain, ["rough metal and plastic", "mirror and glass"]),
        (&LightChain, ["rough metal and plastic", "mirror and glass"]),
        (&Manifold, ["mirror and glass", "orthographic"]),
    ] {
        let distinct = if scenes[0] == scenes[1] { &scenes[..1] } else { &scenes[..] };
        distinct.iter().for_each(|name| check(scene(name), &[mutation], &Plain));
    }
}

#[test]
fn all_together() {
    SCENES.iter().chain([&IMAGES]).for_each(|scene| check(scene, &mutations(&BTreeMap::new()).0, &Plain));
}

/// Another density: short paths and the left of the image count more.
struct Tilted;

impl Target for Tilted {
    fn aim(&self, x: &Path) -> ajar_integrators::mlt::target::Aim {
        let weight = 1.0 / x.edges() as f64 + if x.raster.x < 12.0 { 0.5 } else { 0.1 };
        ajar_integrators::mlt::target::Aim { weight, deposit: x.f / (x.scalar() * weight) }
    }
}

#[test]
fn under_another_target() {
    check(scene("mirror and glass"), &mutations(&BTreeMap::new()).0, &Tilted);
}

/// A mutation that gets its density wrong by the factor `error`.
struct Broken<'a> {
    inner: &'a dyn Mutation,
    error: fn(&Space<'_>, &Path, &Path, &Aux) -> f64,
}

impl Mutation for Broken<'_> {
    fn name(&self) -> &'static str {
        self.inner.name()
    }
    fn applies(&self, x: &Signature) -> bool {
        self.inner.applies(x)
    }
    fn propose(&self, space: &Space<'_>, x: &Path, y: &mut Proposal, rng: &mut Rng) -> Result<Aux, Reject> {
        self.inner.propose(space, x, y, rng)
    }
    fn q(&self, space: &Space<'_>, x: &Path, y: &Path, aux: &Aux) -> f64 {
        self.inner.q(space, x, y, aux) * (self.error)(space, x, y, aux)
    }
}

#[test]
fn a_wrong_factor_shows() {
    type Error = fn(&Space<'_>, &Path, &Path, &Aux) -> f64;
    let variants: [(&str, &dyn Mutation, Error); 10] = [
        ("without p_d", &Bidirectional, |space, x, _, aux| 1.0 / Chances::new(space, x, aux).range),
        ("without p_a", &Bidirectional, |space, x, _, aux| 1.0 / Chances::new(space, x, aux).length),
        ("without the choice of the split", &Bidirectional, |space, x, _, aux| {
            1.0 / Chances::new(space, x, aux).split
        }),
        ("without the samplers' densities", &Technique, |_, _, y, aux| 1.0 / y.density(0, aux.added)),
        ("without the samplers' densities", &Window, |_, _, y, aux| 1.0 / y.density(aux.stem, aux.added)),
        ("without the camera's density", &Lens, |_, _, y, _| 1.0 / y.nodes[y.edges()].to_light),
        ("without importance", &Caustic, |_, _, y, _| y.nodes[y.edges()].to_light),
        ("without the contribution", &MultiChain, |_, _, y, _| y.scalar()),
        ("without the chances of lobes", &Technique, |_, _, _, aux| aux.labels[1]),
        ("without the generalized geometry", &Manifold, |space, _, y, aux| {
            let bend = (aux.stem..aux.stem + aux.added).rev().find(|&i| y.connectable(i)).unwrap();
            let chain: Vec<_> = y.nodes[aux.stem - 1..=bend].iter().map(|node| node.vertex).collect();
            generalized_geometry(space.world, &chain).unwrap()
        }),
    ];
    for (what, inner, error) in variants {
        let broken = Broken { inner, error };
        let scene = scene("mirror and glass");
        let world = (scene.world)();
        let shows = [8, 64, 512].into_iter().any(|steps| {
            let settings = settings(&world, 5, scene.depth, 1);
            let found = drift(&world, &settings, &[&broken], &Plain, steps, 20_000);
            println!("{} {what}, {steps} steps: {found:.2?}", inner.name());
            !found.is_none()
        });
        assert!(shows, "{} {what} went unnoticed", inner.name());
    }
}
