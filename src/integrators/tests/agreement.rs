//! All integrators must show the same image (mlt.md §2.4 b, V6).
#![allow(clippy::unwrap_used, reason = "a failing test panics")]

mod common;

use ajar_integrators::{
    Metropolis, Settings,
    bdpt::Bdpt,
    mlt::{Ajar, Mlt, choice::Choice, lens_subpaths::Spread},
    path::PathTracer,
};
use common::{
    compare::{assert_blocks_agree, assert_same},
    render, render_blocks,
    scenes::{IMAGES, POINT_LIGHT_AND_GLASS, SCENES},
    settings,
};

#[test]
fn path_tracing_and_bidirectional_path_tracing() {
    for scene in SCENES {
        let world = (scene.world)();
        let path = render(&world, &PathTracer, &settings(&world, 1, scene.depth, 32), 24);
        let bdpt = render(&world, &Bdpt, &settings(&world, 2, scene.depth, 8), 24);
        assert_same(scene.name, &path, &bdpt, world.camera.width as usize);
    }
}

#[test]
fn bidirectional_path_tracing_and_metropolis_light_transport() {
    for scene in SCENES.iter().chain([&IMAGES, &POINT_LIGHT_AND_GLASS]) {
        let world = (scene.world)();
        let bdpt = render_blocks(&world, &Bdpt, &settings(&world, 3, scene.depth, 12), 24);
        let mlt = render_blocks(&world, &Mlt, &settings(&world, 4, scene.depth, 48), 32);
        assert_blocks_agree(&format!("{}, mlt", scene.name), &bdpt, &mlt);
        let ajar = Ajar { always: true };
        let ajar = render_blocks(&world, &ajar, &settings(&world, 5, scene.depth, 8), 24);
        assert_blocks_agree(&format!("{}, ajar", scene.name), &bdpt, &ajar);
    }
}

/// What `render.mutation_choice` and `render.lens_subpaths` offer besides the usual.
#[test]
fn other_choices_of_mutations_show_the_same() {
    let usual = Metropolis::default();
    let ways = [
        ("learned", Metropolis { choice: Choice::Learned, ..usual.clone() }),
        ("equal", Metropolis { choice: Choice::Equal, ..usual.clone() }),
        ("list", Metropolis { lens_subpaths: Spread::List, ..usual }),
    ];
    let scene = SCENES.iter().find(|scene| scene.name == "mirror and glass").unwrap();
    let world = (scene.world)();
    let bdpt = render_blocks(&world, &Bdpt, &settings(&world, 3, scene.depth, 12), 24);
    for (name, metropolis) in ways {
        let settings = Settings { metropolis, ..settings(&world, 6, scene.depth, 16) };
        let mlt = render_blocks(&world, &Mlt, &settings, 24);
        assert_blocks_agree(name, &bdpt, &mlt);
    }
}
