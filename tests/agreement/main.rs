//! The scenes of the repository by path tracing and by bidirectional path tracing: the same picture (mlt.md §2.4 b).
//!
//! Small pictures in blocks of 8 × 8 pixels. Each block and channel has one value a round; rounds are independent, so that
//! the spread of these values is an error that knows of light which reaches several pixels at once.
#![allow(clippy::unwrap_used, reason = "a failing test panics")]

mod blocks;
mod door;
mod formats;
mod sphere;

use std::path::Path;

use ajar::session::{LoadOptions, choose_camera, load, prepare_world};
use ajar_integrators::{bdpt::Bdpt, path::PathTracer};
use ajar_render::World;
use ajar_scene::Choice;

use blocks::{Blocks, HEIGHT, WIDTH};

/// Largest |z| that is taken for chance. Of 36 normal values one exceeds it once in 5·10⁴ scenes; the spread is taken from
/// 32 rounds, and some light comes seldom and bright, which makes it more.
const LIMIT: f64 = 5.0;

/// Largest typical error, relative: beyond it a difference could hide in noise.
const NOISE: f64 = 0.05;

/// A scene of the repository: a folder with a `scene.toml`, or a file in it.
fn world(scene: &str) -> World {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(scene);
    open(&if path.is_dir() { path.join("scene.toml") } else { path })
}

/// A file of any format, ready to render.
fn open(path: &Path) -> World {
    let choice = Choice::default();
    let options = LoadOptions {
        size: None,
        set: &[],
        strict: false,
        allow: &[],
        memory_limit: 4 << 30,
        choice: &choice,
    };
    let file = load(path, &options).unwrap().file;
    let camera = choose_camera(&file.scene, file.render.camera.as_deref()).unwrap();
    prepare_world(file.scene, camera, [WIDTH, HEIGHT], 4 << 30).unwrap().0
}

/// The scene by both integrators, with samples a round for each.
fn both(scene: &str, path: u32, bdpt: u32) -> (Blocks, Blocks) {
    let world = world(scene);
    (Blocks::new(&world, &PathTracer, 1, path), Blocks::new(&world, &Bdpt, 2, bdpt))
}

fn check(scene: &str, path: u32, bdpt: u32) {
    check_within(scene, (path, bdpt), NOISE);
}

/// Likewise, with a larger typical error than usual.
fn check_within(scene: &str, (path, bdpt): (u32, u32), noise: f64) {
    let (a, b) = both(scene, path, bdpt);
    let (worst, error) = a.compare(&b);
    println!("{scene}: largest z {worst:.2}, typical error {:.2} %", error * 100.0);
    assert!(worst < LIMIT, "{scene}: largest z {worst:.2}");
    assert!(error < noise, "{scene}: {:.2} % of noise", error * 100.0);
}

#[test]
fn cornell_and_the_comparison_sees_a_thirtieth_of_the_light() {
    let (path, bdpt) = both("cornell", 64, 16);
    let (worst, error) = path.compare(&bdpt);
    println!("cornell: largest z {worst:.2}, typical error {:.2} %", error * 100.0);
    assert!(worst < LIMIT, "{worst:.2}");
    for broken in [0.97, 1.03] {
        let (worst, _) = path.scaled(broken).compare(&bdpt);
        println!("cornell with {broken} of the light: largest z {worst:.2}");
        assert!(worst > LIMIT, "{broken}: {worst:.2}");
    }
}

/// Both find little light behind the door; docs/agreement.md has longer comparisons, also with `mlt` and `ajar`.
#[test]
fn door_ajar() {
    check_within("door-ajar", (64, 16), 0.2);
}

#[test]
fn caustic_glass() {
    check("caustic-glass", 64, 8);
}

#[test]
fn materials() {
    check("materials", 16, 4);
}

#[test]
fn window_room() {
    check("window-room", 16, 4);
}

#[test]
fn reading_corner() {
    check("reading-corner", 48, 12);
}

#[test]
fn many_lights() {
    check("many-lights", 16, 4);
}

/// Reads USD, where `AJAR_USD_PYTHON` names a Python that does.
#[test]
fn tea_table() {
    if !formats::reads_usd() {
        println!("skipped: AJAR_USD_PYTHON is not set");
        return;
    }
    check("tea-table/scene.usda", 16, 4);
}
