//! What `ajar render` writes.

use std::fs;

use crate::bench::{Bench, SCENE};

#[test]
fn an_asset_without_output_name_goes_to_the_current_folder() {
    let bench = Bench::new();
    let run = bench.run("render leaf.gltf --size 16x9 --spp 4").exits(0);
    assert!(bench.has("leaf.exr") && bench.has("leaf.png"), "{:?}", bench.files());
    assert!(
        run.out.contains("leaf.exr") && run.out.contains("leaf.png"),
        "the paths are printed: {}",
        run.out
    );
    let image = bench.image("leaf.exr");
    assert_eq!((image.full, image.window), ([16, 9], [0, 0, 16, 9]));
    assert_eq!(image.channels, ["A", "B", "G", "R"]);
}

#[test]
fn a_scene_is_named_after_its_folder_and_settings_are_its_own() {
    let bench = Bench::new();
    bench.run("render kitchen/scene.toml").exits(0);
    assert!(bench.has("kitchen.exr") && bench.has("kitchen.png"), "{:?}", bench.files());
    assert_eq!(bench.image("kitchen.exr").full, [24, 16]);
    assert!(bench.image("kitchen.exr").mean() > 0.01);
}

#[test]
fn the_command_line_beats_the_file() {
    let bench = Bench::new();
    bench.run("render kitchen/scene.toml -o out.exr --size 8x8 --spp 2").exits(0);
    assert_eq!(bench.image("out.exr").full, [8, 8]);
    assert_eq!(bench.files(), ["kitchen", "leaf.gltf", "out.exr", "out.png"]);
}

#[test]
fn what_a_file_lacks_is_added_and_said_in_a_line_each() {
    let bench = Bench::new();
    let run = bench.run("render leaf.gltf --size 16x16 --spp 4 -v").exits(0);
    for what in ["no camera", "no light"] {
        let lines = run.err.lines().filter(|line| line.contains(what)).count();
        assert_eq!(lines, 1, "{what} in\n{}", run.err);
    }
    assert!(bench.image("leaf.exr").mean() > 0.1);
}

#[test]
fn parts_of_the_frame_are_the_same_pixels_as_in_the_whole() {
    let bench = Bench::new();
    bench.run("render kitchen/scene.toml -o whole.exr --float").exits(0);
    bench.run("render kitchen/scene.toml -o crop.exr --crop 0.25,0.75,0.5,1 --float").exits(0);
    bench.run("render kitchen/scene.toml -o bounds.exr --pixel-bounds 6,18,8,16 --float").exits(0);
    let (whole, crop, bounds) =
        (bench.image("whole.exr"), bench.image("crop.exr"), bench.image("bounds.exr"));
    assert_eq!((crop.full, crop.window), ([24, 16], [6, 8, 12, 8]));
    assert_eq!((bounds.full, bounds.window), ([24, 16], [6, 8, 12, 8]));
    assert_eq!(crop.pixels, bounds.pixels);
    let cut: Vec<_> = (8..16).flat_map(|y| whole.pixels[y * 24 + 6..y * 24 + 18].to_vec()).collect();
    assert_eq!(crop.pixels, cut);
}

#[test]
fn threads_do_not_show_and_seeds_do() {
    let bench = Bench::new();
    let pixels = |arguments: &str| {
        bench.run(&format!("render kitchen/scene.toml -o out.exr --float {arguments}")).exits(0);
        bench.image("out.exr").pixels
    };
    let one = pixels("--threads 1");
    assert_eq!(one, pixels("--threads 3"));
    assert_ne!(one, pixels("--seed 7"));
}

#[test]
fn the_named_camera_is_used() {
    let bench = Bench::new();
    bench.run("render kitchen/scene.toml -o main.exr").exits(0);
    bench.run("render kitchen/scene.toml -o named.exr --camera main").exits(0);
    bench.run("render kitchen/scene.toml -o top.exr --camera top").exits(0);
    let pixels = |name: &str| bench.image(name).pixels;
    assert_eq!(pixels("main.exr"), pixels("named.exr"));
    assert_ne!(pixels("main.exr"), pixels("top.exr"));
}

#[test]
fn every_layer_is_written() {
    let bench = Bench::new();
    let all = "albedo,normal,geometric_normal,depth,position,uv,material_id,object_id,variance";
    bench.run(&format!("render kitchen/scene.toml -o out.exr --aov {all}")).exits(0);
    let channels = bench.image("out.exr").channels;
    for name in ["R", "albedo.R", "N.X", "Ng.Z", "Z", "P.Y", "uv.U", "materialId", "objectId", "variance.B"] {
        assert!(channels.iter().any(|channel| channel == name), "{name} in {channels:?}");
    }
}

#[test]
fn stop_rules_say_how_long() {
    let bench = Bench::new();
    let stats = |arguments: &str| -> serde_json::Value {
        let common = "render kitchen/scene.toml -o out.exr --stats-json stats.json";
        bench.run(&format!("{common} {arguments}")).exits(0);
        serde_json::from_slice(&fs::read(bench.path("stats.json")).unwrap()).unwrap()
    };
    assert_eq!(stats("")["samples_per_pixel"], 4, "the scene's own");
    let by_spp = stats("--spp 32");
    assert_eq!((&by_spp["samples_per_pixel"], &by_spp["complete"]), (&32.into(), &true.into()));
    assert_eq!(stats("--rounds 3")["rounds"], 3);
    assert_eq!(stats("--rounds 3 --spp 1000 --time 1h")["rounds"], 3, "the first to hold");
    assert!(stats("--time 1s")["seconds"].as_f64().unwrap() >= 1.0);
    let by_noise = stats("--noise 40% --rounds 4000");
    assert!(by_noise["noise"].as_f64().unwrap() <= 0.4, "{by_noise}");
    assert!(by_noise["rounds"].as_u64().unwrap() < 4000, "{by_noise}");
    let keys = ["integrator", "seed", "scene_hash", "rejected_contributions", "noise_worst_tile"];
    assert!(keys.iter().all(|key| !by_noise[key].is_null()), "{by_noise}");
}

#[test]
fn quiet_is_quiet_and_a_dry_run_writes_nothing() {
    let bench = Bench::new();
    let before = bench.files();
    let run = bench.run("render leaf.gltf --dry-run --size 32x16 --integrator bdpt").exits(0);
    assert_eq!(bench.files(), before);
    for text in ["32x16", "bdpt", "leaf.exr"] {
        assert!(run.out.contains(text), "{text} in {}", run.out);
    }
    let run = bench.run("render leaf.gltf --size 8x8 --spp 1 --quiet").exits(0);
    assert_eq!((run.out.as_str(), run.err.as_str()), ("", ""));
    assert!(bench.has("leaf.exr"));
}

/// The lamp shines away from everything.
#[test]
fn darkness_is_told_and_marked() {
    let bench = Bench::new();
    let lamp = "type = \"rect\"\nposition = [0, -5, 0]\ndirection = [0, -1, 0]";
    let sun = "type = \"directional\"\ndirection = [-1, -2, -1]\nilluminance = 10";
    let dark = SCENE.replace(sun, lamp);
    assert_ne!(dark, SCENE);
    bench.write("kitchen/dark.toml", &dark);
    let black = "the image is black: no light reaches the camera";
    for (integrator, also) in [
        ("path", black),
        ("bdpt", black),
        ("mlt", "rounds found no path that carries light to the camera among "),
        ("ajar", "camera; 1048576 samples looked for some in vain"),
    ] {
        let command =
            format!("render kitchen/dark.toml -o dark.exr --stats-json stats.json --integrator {integrator}");
        bench.run(&command).exits(0).says(&[black, also]);
        let stats: serde_json::Value =
            serde_json::from_slice(&fs::read(bench.path("stats.json")).unwrap()).unwrap();
        assert_eq!(stats["black"], true);
        assert!(bench.has("dark.exr"));
    }
}
