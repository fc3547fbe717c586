//! `ajar convert`.

use std::fs;

use super::bench::Bench;

#[test]
fn a_converted_scene_renders_to_the_same_bytes() {
    let bench = Bench::new();
    let pixels = |file: &str| {
        bench.run(&format!("render {file} --spp 4 -o {file}.exr --size 16x12")).exits(0);
        bench.image(&format!("{file}.exr")).pixels
    };
    let asset = pixels("leaf.gltf");
    bench.run("convert leaf.gltf -o leaf.ajar").exits(0);
    fs::remove_file(bench.path("leaf.gltf")).unwrap();
    assert_eq!(pixels("leaf.ajar"), asset);

    // Camera and size of the scene file come along, the rest of what it says about rendering does not.
    let scene = pixels("kitchen/scene.toml");
    bench.run("convert kitchen/scene.toml -o kitchen.ajar").exits(0);
    fs::remove_dir_all(bench.path("kitchen")).unwrap();
    assert_eq!(pixels("kitchen.ajar"), scene);
}

#[test]
fn the_hash_stays() {
    let bench = Bench::new();
    let hash = |file: &str| {
        let out = bench.run(&format!("inspect {file}")).exits(0).out;
        out.lines().find(|line| line.starts_with("scene ")).unwrap().to_owned()
    };
    bench.run("convert kitchen/scene.toml -o kitchen.ajar").exits(0);
    assert_eq!(hash("kitchen.ajar"), hash("kitchen/scene.toml"));
}

#[test]
fn it_refuses_what_it_cannot_write() {
    let bench = Bench::new();
    bench.run("convert leaf.gltf -o leaf.glb").exits(2).says(&["leaf.glb: error: is not named .ajar"]);
    bench.run("convert leaf.gltf -o nowhere/leaf.ajar").exits(1).says(&["nowhere/leaf.ajar"]);
    bench.run("convert missing.gltf -o leaf.ajar").exits(3);
    assert!(!bench.has("leaf.ajar"));
}
