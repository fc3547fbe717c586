//! Where `ajar` runs chains, and where it traces paths alone.

mod common;

use std::sync::atomic::AtomicBool;

use ajar_integrators::{Context, Integrator, mlt::Ajar};
use common::{scenes, scenes::TestScene, settings};

/// Seeds: what decides is estimated.
const SEEDS: u64 = 3;

/// With how many seeds the scene is path traced.
fn path_traced(scene: &TestScene) -> usize {
    let world = (scene.world)();
    let alone = |seed: &u64| {
        let settings = settings(&world, *seed, scene.depth, 4);
        let cancel = AtomicBool::new(false);
        let cx = Context { world: &world, settings: &settings, cancel: &cancel };
        let report = Ajar { always: false }.prepare(cx).report();
        report.lines.iter().any(|line| line.starts_with("path tracing alone"))
    };
    (0..SEEDS).filter(alone).count()
}

#[test]
fn easy_scenes_are_path_traced() {
    for name in
        ["diffuse room", "cloth, leaf and pearl", "point light", "spot light", "sun and sky", "thin lens"]
    {
        let scene = scenes::SCENES.iter().find(|scene| scene.name == name).unwrap();
        assert_eq!(path_traced(scene), SEEDS as usize, "{name}");
    }
}

#[test]
fn chains_run_where_paths_seldom_find_light() {
    for scene in [&scenes::DOOR_AJAR, &scenes::POINT_LIGHT_AND_GLASS] {
        assert_eq!(path_traced(scene), 0, "{}", scene.name);
    }
}
