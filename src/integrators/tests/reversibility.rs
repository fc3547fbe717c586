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
use ajar_render::rng::{Purpose, Rng};
use common::{
    reversibility::imbalance,
    samples::Samples,
    scenes::{IMAGES, SCENES, TestScene},
    settings, sized,
};

const SAMPLES: usize = 20_000;

/// Each mutation alone and all of them by their usual weights. `target` is made for the space of the scene.
fn check(scene: &TestScene, target: impl Fn(Space<'_>, &mut dyn FnMut(&dyn Target))) {
    let world = (scene.world)();
    let settings = settings(&world, 5, scene.depth, 1);
    let space = Space::new(&world, settings.window, scene.depth);
    let (list, usual) = mutations(&BTreeMap::new());
    target(space, &mut |target| {
        let samples = Samples::draw(space, &settings, target, (0, sized(SAMPLES)));
        let assert_even = |names: &str, mutations: &[&dyn Mutation], table: &Table| {
            let found = imbalance(&samples, &Kernel { space, mutations, table, target });
            println!("{}, {names}: {found:.2?}", scene.name);
            assert!(found.is_none(), "{}, {names}: {found:?}", scene.name);
        };
        for mutation in &list {
            assert_even(mutation.name(), &[*mutation], &Table::uniform(&[1.0]));
        }
        assert_even("all", &list, &usual);
    });
}

#[test]
fn every_mutation_is_as_likely_back_as_forth() {
    for scene in SCENES.iter().chain([&IMAGES]) {
        check(scene, |_, check| check(&Plain));
    }
}

#[test]
fn under_the_targets_of_the_default_estimator() {
    for scene in
        SCENES.iter().filter(|scene| ["mirror and glass", "rough metal and plastic"].contains(&scene.name))
    {
        check(scene, |space, check| {
            let mut rng = Rng::new(3, Purpose::Test, 0, 0);
            let pixels = 0..space.window.pixels();
            let brightness: Vec<f64> = pixels.clone().map(|_| 0.2 + rng.f64()).collect();
            let effort: Vec<u32> = pixels.map(|_| 1 + rng.below(4) as u32).collect();
            check(&Split { space, brightness: &brightness, effort: &effort, beside: 0.5 });
            check(&Relative { space, brightness: &brightness });
        });
    }
}
