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
    compare::assert_blocks_agree,
    render_blocks,
    scenes::{IMAGES, POINT_LIGHT_AND_GLASS, SCENES},
    settings,
};

#[test]
fn all_integrators_show_what_bidirectional_path_tracing_shows() {
    for scene in SCENES.iter().chain([&IMAGES, &POINT_LIGHT_AND_GLASS]) {
        let world = (scene.world)();
        let settings = |seed, samples| settings(&world, seed, scene.depth, samples);
        let bdpt = render_blocks(&world, &Bdpt, &settings(3, 12), 24);
        // Path tracing does not find what a light without extent sends through glass.
        if scene.name != POINT_LIGHT_AND_GLASS.name {
            let path = render_blocks(&world, &PathTracer, &settings(1, 32), 24);
            assert_blocks_agree(&format!("{}, path", scene.name), &bdpt, &path);
        }
        let mlt = render_blocks(&world, &Mlt, &settings(4, 48), 32);
        assert_blocks_agree(&format!("{}, mlt", scene.name), &bdpt, &mlt);
        let ajar = render_blocks(&world, &Ajar { always: true }, &settings(5, 8), 24);
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
