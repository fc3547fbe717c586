//! Each mutation, alone and in the mix, moves as much one way as the other (mlt.md §8 V4, V5). `broken.rs` shows that wrong
//! ones do not.
#![allow(clippy::unwrap_used, reason = "a failing test panics")]

mod common;

use std::collections::BTreeMap;

use ajar_integrators::mlt::{
    Mutation,
    base::Split,
    chain::Kernel,
    choice::Table,
    mutations::mutations,
    path::Space,
    target::{Plain, Relative, Target},
};
use ajar_render::{
    World,
    rng::{Purpose, Rng},
};
use common::{
    reversibility::imbalance,
    samples::Samples,
    scenes::{IMAGES, SCENES, TestScene},
    settings, sized,
};

const SAMPLES: usize = 20_000;

/// Each mutation alone and all of them by their usual weights.
fn check(scene: &TestScene, space: Space<'_>, target: &dyn Target) {
    let samples =
        Samples::draw(space, &settings(space.world, 5, scene.depth, 1), target, (0, sized(SAMPLES)));
    let assert_even = |names: &str, mutations: &[&dyn Mutation], table: &Table| {
        let found = imbalance(&samples, &Kernel { space, mutations, table, target });
        println!("{}, {names}: {found:.2?}", scene.name);
        assert!(found.is_none(), "{}, {names}: {found:?}", scene.name);
    };
    let (list, usual) = mutations(&BTreeMap::new());
    for mutation in &list {
        assert_even(mutation.name(), &[*mutation], &Table::uniform(&[1.0]));
    }
    assert_even("all", &list, &usual);
}

fn space<'w>(scene: &TestScene, world: &'w World) -> Space<'w> {
    Space::new(world, settings(world, 5, scene.depth, 1).window, scene.depth)
}

#[test]
fn every_mutation_is_as_likely_back_as_forth() {
    for scene in SCENES.iter().chain([&IMAGES]) {
        check(scene, space(scene, &(scene.world)()), &Plain);
    }
}

#[test]
fn under_the_targets_of_the_default_estimator() {
    let names = ["mirror and glass", "rough metal and plastic"];
    for scene in SCENES.iter().filter(|scene| names.contains(&scene.name)) {
        let world = (scene.world)();
        let space = space(scene, &world);
        let mut rng = Rng::new(3, Purpose::Test, 0, 0);
        let pixels = 0..space.window.pixels();
        let brightness: Vec<f64> = pixels.clone().map(|_| 0.2 + rng.f64()).collect();
        let effort: Vec<u32> = pixels.map(|_| 1 + rng.below(4) as u32).collect();
        check(
            scene,
            space,
            &Split { space, brightness: &brightness, effort: &effort, beside: 0.5, clamp: 2.0 },
        );
        check(scene, space, &Relative { space, brightness: &brightness });
    }
}
