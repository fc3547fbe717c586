//! What is broken leaves the last good image, is told with its place, and heals.

use std::{fs, os::unix::fs::PermissionsExt, thread, time::Duration};

use super::{
    Watch, is_what_render_makes,
    studio::{light, picture, studio},
};
use crate::bench::{Bench, SCENE};

#[test]
fn a_broken_save_is_told_with_its_place_and_the_next_one_heals() {
    let bench = studio();
    let mut watch = Watch::start(&bench, "studio/scene.toml -o out.exr --float");
    watch.wait_for_image();
    bench.write("studio/scene.toml", SCENE.replace("spp = 4", "spp = = 4"));
    let error = watch.wait_for_error();
    assert!(
        error["file"].as_str().unwrap().ends_with("scene.toml") && error["place"][0].as_u64() > Some(15),
        "{error}"
    );
    // The last image is done, and stays.
    watch.wait_for(|it| it["phase"] == "done" && !it["errors"].as_array().unwrap().is_empty());
    // A texture that changes while the scene is broken is not forgotten.
    fs::write(bench.path("studio/wood.ppm.png"), picture(99)).unwrap();
    thread::sleep(Duration::from_millis(300));
    bench.write("studio/scene.toml", light(7));
    watch.wait_for_image();
    is_what_render_makes(&bench, "out.exr", "studio/scene.toml");
}

#[test]
fn a_missing_texture_heals_when_it_comes() {
    let bench = studio();
    let mut watch = Watch::start(&bench, "studio/scene.toml -o out.exr --float");
    watch.wait_for_image();
    let wood = bench.path("studio/wood.ppm.png");
    fs::remove_file(&wood).unwrap();
    // OBJ goes on without; either way something is said about it.
    watch.wait_for(|it| it.to_string().contains("wood.ppm.png") && it["severity"].is_string());
    fs::write(wood, picture(3)).unwrap();
    watch.wait_for_image();
    thread::sleep(Duration::from_millis(500));
    is_what_render_makes(&bench, "out.exr", "studio/scene.toml");
}

#[test]
fn a_scene_that_is_not_there_yet_is_waited_for() {
    let bench = studio();
    let mut watch = Watch::start(&bench, "studio/late/look.toml -o out.exr --float");
    watch.wait_for(|it| it["phase"] == "waiting");
    bench.write("studio/late/box.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    bench.write("studio/late/look.toml", SCENE);
    watch.wait_for_image();
    is_what_render_makes(&bench, "out.exr", "studio/late/look.toml");
}

#[test]
fn an_asset_that_is_half_written_does_not_take_the_image_away() {
    let bench = Bench::new();
    bench.run("convert kitchen/scene.toml -o box.ajar").exits(0);
    let whole = fs::read(bench.path("box.ajar")).unwrap();
    let mut watch = Watch::start(&bench, "box.ajar -o out.exr --float --size 24x16 --spp 4");
    watch.wait_for_image();
    fs::write(bench.path("box.ajar"), &whole[..whole.len() / 2]).unwrap();
    watch.wait_for_error();
    fs::write(bench.path("box.ajar"), &whole).unwrap();
    watch.wait_for_image();
}

#[test]
fn a_glb_that_is_half_written_does_not_take_the_image_away() {
    let bench = Bench::new();
    let glb = bench.glb();
    bench.write("leaf.glb", &glb);
    let mut watch = Watch::start(&bench, "leaf.glb -o out.exr --float --size 24x16 --spp 4");
    watch.wait_for_image();
    let good = fs::read(bench.path("out.exr")).unwrap();
    fs::write(bench.path("leaf.glb"), &glb[..glb.len() / 2]).unwrap();
    let error = watch.wait_for_error();
    assert!(error["file"].as_str().unwrap().ends_with("leaf.glb"), "{error}");
    watch.wait_for(|it| it["phase"] == "done" && !it["errors"].as_array().unwrap().is_empty());
    assert!(fs::read(bench.path("out.exr")).unwrap() == good);
    fs::write(bench.path("leaf.glb"), &glb).unwrap();
    watch.wait_for(|it| it["phase"] == "done" && it["errors"].as_array().unwrap().is_empty());
}

#[test]
fn a_plug_in_that_crashes_does_not_take_the_image_away() {
    let bench = Bench::new();
    let answer = r#"{"ajar": 1, "roots": [0], "nodes": [{"name": "leaf", "meshes": [0]}],
"meshes": [{"positions": [[0,0,0],[1,0,0],[0,1,0]], "triangles": [[0,1,2]]}]}"#;
    let plug_in = format!(
        "#!/bin/sh\nif [ \"$1\" = --probe ]; then echo '{{\"protocol\": 1, \"extensions\": [\"toy\"]}}'; exit; fi
grep -q bad \"$2\" && kill -SEGV $$\ncat << END\n{answer}\nEND\n"
    );
    bench.write("bin/ajar-import-toy", &plug_in);
    fs::set_permissions(bench.path("bin/ajar-import-toy"), fs::Permissions::from_mode(0o755)).unwrap();
    bench.write("a.toy", "good");
    let path = format!("{}:{}", bench.path("bin").display(), std::env::var("PATH").unwrap());
    let mut watch =
        Watch::start_with(&bench, "a.toy -o out.exr --float --size 24x16 --spp 4", &[("PATH", &path)]);
    watch.wait_for_image();
    bench.write("a.toy", "bad");
    let error = watch.wait_for_error();
    assert!(error["file"].as_str().unwrap().ends_with("a.toy"), "{error}");
    assert!(error.to_string().contains("signal"), "{error}");
    watch.wait_for(|it| it["phase"] == "done" && !it["errors"].as_array().unwrap().is_empty());
    bench.write("a.toy", "good again");
    watch.wait_for_image();
}

#[test]
fn a_texture_that_is_deleted_does_not_take_the_image_away() {
    let bench = studio();
    bench.write(
        "studio/scene.toml",
        format!("{SCENE}\n[material.clay]\nbase_color_texture = \"wood.ppm.png\"\n"),
    );
    let mut watch = Watch::start(&bench, "studio/scene.toml -o out.exr --float");
    watch.wait_for_image();
    let good = fs::read(bench.path("out.exr")).unwrap();
    let wood = bench.path("studio/wood.ppm.png");
    fs::remove_file(&wood).unwrap();
    let error = watch.wait_for_error();
    assert!(error["message"].as_str().unwrap().contains("wood.ppm.png"), "{error}");
    assert!(error["file"].as_str().unwrap().ends_with("scene.toml") && error["place"].is_array(), "{error}");
    watch.wait_for(|it| it["phase"] == "done" && !it["errors"].as_array().unwrap().is_empty());
    assert!(fs::read(bench.path("out.exr")).unwrap() == good);
    fs::write(wood, picture(5)).unwrap();
    watch.wait_for_image();
    is_what_render_makes(&bench, "out.exr", "studio/scene.toml");
}
