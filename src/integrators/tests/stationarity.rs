//! Each mutation, alone and in the mix, leaves the target as it is (mlt.md §8 V5). `broken.rs` shows that wrong ones do not.
#![allow(clippy::unwrap_used, reason = "a failing test panics")]

mod common;

use std::collections::BTreeMap;

use ajar_integrators::mlt::{
    Mutation,
    base::Split,
    choice::Table,
    mutations::mutations,
    path::{Path, Space},
    target::{Aim, Plain, Relative, Target},
};
use ajar_render::{
    World,
    rng::{Purpose, Rng},
};
use common::{
    scenes::{IMAGES, SCENES, TestScene},
    settings, sized,
    stationarity::drift,
};

const SEEDS: usize = 20_000;

fn scene(name: &str) -> &'static TestScene {
    SCENES.iter().find(|scene| scene.name == name).unwrap()
}

/// Mutations with equal chances.
fn check(scene: &TestScene, mutations: &[&dyn Mutation], target: &dyn Target) {
    let table = Table::uniform(&vec![1.0; mutations.len()]);
    check_weighed(scene, &(scene.world)(), (mutations, &table), target);
}

fn check_weighed(
    scene: &TestScene,
    world: &World,
    (mutations, table): (&[&dyn Mutation], &Table),
    target: &dyn Target,
) {
    let names = mutations.iter().map(|m| m.name()).collect::<Vec<_>>().join(" + ");
    let settings = settings(world, 5, scene.depth, 1);
    for steps in [1, 8, 64] {
        let found = drift(world, &settings, (mutations, table), target, steps, sized(SEEDS));
        println!("{}, {names}, {steps} steps: {found:.2?}", scene.name);
        assert!(found.is_none(), "{}, {names}, {steps} steps: {found:?}", scene.name);
    }
}

/// On one scene; `reversibility.rs` has them all.
#[test]
fn every_mutation_alone() {
    for mutation in mutations(&BTreeMap::new()).0 {
        check(scene("mirror and glass"), &[mutation], &Plain);
    }
}

#[test]
fn all_together() {
    SCENES.iter().chain([&IMAGES]).for_each(|scene| check(scene, &mutations(&BTreeMap::new()).0, &Plain));
}

/// Another density: short paths and the left of the image count more.
struct Tilted;

impl Target for Tilted {
    fn aim(&self, x: &Path) -> Aim {
        let weight = 1.0 / x.edges() as f64 + if x.raster.x < 12.0 { 0.5 } else { 0.1 };
        Aim { weight, deposit: x.f / (x.scalar() * weight) }
    }
}

#[test]
fn under_another_target() {
    check(scene("mirror and glass"), &mutations(&BTreeMap::new()).0, &Tilted);
}

/// Weights of their own for each class of paths, as chains that learn have them.
fn by_class(usual: &Table) -> Table {
    let (mut table, mut rng) = (usual.clone(), Rng::new(2, Purpose::Test, 0, 0));
    for weight in table.weights.iter_mut().flatten() {
        *weight *= (0.1f64).powf(rng.f64());
    }
    table
}

/// What the estimator `ajar` aims at, with mutations chosen by the class of the path: what a base of path tracing leaves,
/// relative to uneven brightness of the pixels, and, in its pilot, all light relative to that.
#[test]
fn under_the_targets_of_the_default_estimator() {
    let (list, usual) = mutations(&BTreeMap::new());
    for (name, residual) in [("mirror and glass", true), ("rough metal and plastic", false)] {
        let scene = scene(name);
        let world = (scene.world)();
        let space = Space::new(&world, settings(&world, 5, scene.depth, 1).window, scene.depth);
        let mut rng = Rng::new(3, Purpose::Test, 0, 0);
        let brightness: Vec<f64> = (0..space.window.pixels()).map(|_| 0.2 + rng.f64()).collect();
        let effort: Vec<u32> = (0..space.window.pixels()).map(|_| 1 + rng.below(4) as u32).collect();
        let split = Split { space, brightness: &brightness, effort: &effort, beside: 0.5, clamp: 2.0 };
        let relative = Relative { space, brightness: &brightness };
        let target: &dyn Target = if residual { &split } else { &relative };
        check_weighed(scene, &world, (&list, &by_class(&usual)), target);
    }
}
