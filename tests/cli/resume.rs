//! Renders in pieces: interrupted and resumed, or shared out and merged, they are the whole to the last bit.

use std::{collections::BTreeMap, fs};

use exr::prelude::*;
use serde_json::Value;

use crate::bench::Bench;

/// Every integrator.
pub const INTEGRATORS: [&str; 4] = ["path", "bdpt", "mlt", "ajar"];

/// What an image says that must not depend on how it was made: bits of all channels, and attributes but times.
#[derive(Debug, PartialEq)]
pub struct Content {
    channels: Vec<(String, Vec<u32>)>,
    pub attributes: BTreeMap<String, String>,
}

pub fn content(bench: &Bench, name: &str) -> Content {
    let image = read_first_flat_layer_from_file(bench.path(name)).unwrap();
    let bits = |channel: &AnyChannel<FlatSamples>| {
        let samples = channel.sample_data.values_as_f32().map(f32::to_bits).collect();
        (channel.name.to_string(), samples)
    };
    let said = image.layer_data.attributes.other.iter();
    Content {
        channels: image.layer_data.channel_data.list.iter().map(bits).collect(),
        attributes: said
            .map(|(name, value)| (name.to_string(), format!("{value:?}")))
            .filter(|(name, _)| !name.starts_with("renderTime"))
            .collect(),
    }
}

/// The command for `rounds` rounds of a room that is lit through a gap, with all layers.
fn room(integrator: &str, rounds: u32) -> String {
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/door-ajar/scene.toml");
    format!(
        "render {scene} --size 24x24 --max-depth 6 --seed 5 --integrator {integrator} --rounds {rounds} --float \
         --aov albedo,normal,geometric_normal,depth,position,uv,material_id,object_id,variance"
    )
}

/// A render of the kitchen.
fn kitchen(more: &str) -> String {
    format!("render kitchen/scene.toml --size 24x24 --integrator path {more}")
}

/// Three shards of four rounds, as parts `0`, `1`, `2`.
fn shards(bench: &Bench) {
    for index in 0..3 {
        bench.run(&kitchen(&format!("--rounds 4 --shard {index}/3 --checkpoint {index}"))).exits(0);
    }
}

#[test]
fn resumed_is_uninterrupted_for_every_integrator_and_number_of_threads() {
    let bench = Bench::new();
    for integrator in INTEGRATORS {
        bench.run(&format!("{} -o whole.exr --threads 1", room(integrator, 9))).exits(0);
        bench.run(&format!("{} -o a.exr --threads 2 --checkpoint a.ckpt", room(integrator, 1))).exits(0);
        bench.run(&format!("{} -o a.exr --threads 1 --resume a.ckpt", room(integrator, 4))).exits(0);
        bench.run(&format!("{} -o b.exr --resume a.ckpt --checkpoint b.ckpt", room(integrator, 9))).exits(0);
        let whole = content(&bench, "whole.exr");
        assert!(
            whole.attributes.contains_key("ajar:noise")
                && whole.attributes.contains_key("ajar:blockVariance8")
        );
        assert!(whole == content(&bench, "b.exr"), "{integrator}");
        assert!(whole != content(&bench, "a.exr"), "{integrator}: the comparison sees nothing");
        bench.run("merge b.ckpt -o image.exr").exits(0);
        assert!(whole == content(&bench, "image.exr"), "{integrator}: made of the checkpoint");
    }
}

#[test]
fn merged_shards_are_the_unsplit_render_for_every_integrator() {
    let bench = Bench::new();
    for integrator in INTEGRATORS {
        bench.run(&format!("{} -o whole.exr --stats-json whole.json", room(integrator, 8))).exits(0);
        for index in 0..3 {
            let threads = 1 + index % 2;
            let part = format!("--threads {threads} --shard {index}/3 --checkpoint part{index}");
            bench.run(&format!("{} {part}", room(integrator, 8))).exits(0);
        }
        bench.run("merge part2 part0 part1 -o merged.exr").exits(0);
        assert!(content(&bench, "whole.exr") == content(&bench, "merged.exr"), "{integrator}");
        let shard = content(&bench, "part1.exr");
        assert!(shard.attributes["ajar:shard"].contains("1/3"));
        let stats: Value = serde_json::from_slice(&fs::read(bench.path("whole.json")).unwrap()).unwrap();
        let detail = |name: &str| stats["details"][name].as_f64();
        if integrator == "ajar" {
            assert!(detail("mutations_per_sample") > Some(0.0), "no chains: the scene tests nothing");
        }
        if ["mlt", "ajar"].contains(&integrator) {
            // How good the seeds were.
            assert!(detail("seed_candidates") > Some(50.0) && detail("empty_rounds") == Some(0.0), "{stats}");
            assert!(detail("heaviest_thousandth_of_candidates") > Some(0.0), "{stats}");
            assert!(detail("chains") > Some(8.0) && detail("lost_seeds") < Some(2.0), "{stats}");
        }
    }
}

#[test]
fn samples_of_a_round_stay_as_they_were_and_crops_fit() {
    let bench = Bench::new();
    let crop = "--pixel-bounds 3,20,5,24 --float";
    bench.run(&kitchen(&format!("--spp 8 -o a.exr --checkpoint a.ckpt {crop}"))).exits(0);
    bench.run(&kitchen(&format!("--spp 64 -o b.exr --resume a.ckpt {crop}"))).exits(0);
    bench.run(&kitchen(&format!("--spp 8 --rounds 64 -o c.exr --checkpoint c.ckpt {crop}"))).exits(0);
    bench.run(&kitchen(&format!("--rounds 64 -o c.exr --resume c.ckpt {crop}"))).exits(0);
    let resumed = content(&bench, "b.exr");
    assert!(resumed == content(&bench, "c.exr"));
    assert_eq!(resumed.attributes["samplesPerPixel"], "I32(64)");
    assert_eq!(resumed.attributes["ajar:rounds"], "I32(64)");
    // Nothing is left to do: the image comes again.
    bench.run(&kitchen(&format!("--spp 8 -o again.exr --resume a.ckpt {crop}"))).exits(0);
    assert!(resumed == content(&bench, "again.exr"), "--resume saves where it read");
}

#[test]
fn another_render_is_not_resumed_and_differences_are_named() {
    let bench = Bench::new();
    let first = "--rounds 2 -o a.exr --checkpoint a.ckpt";
    bench.run(&kitchen(first)).exits(0);
    let before = fs::read(bench.path("a.ckpt")).unwrap();
    for (more, says) in [
        ("--seed 7", "a.ckpt: error: rendered with seed 0, not 7"),
        ("--max-depth 3", "rendered with max depth 16, not 3"),
        ("--camera top", "rendered with another camera place"),
        ("--pixel-bounds 0,8,0,8", "rendered with pixel bounds [0,24,0,24], not [0,8,0,8]"),
        ("--shard 0/2", "holds shard 0/1, not 0/2"),
    ] {
        bench.run(&kitchen(&format!("--rounds 4 -o b.exr --resume a.ckpt {more}"))).exits(2).says(&[says]);
    }
    let other = "render kitchen/scene.toml --size 8x8 --integrator bdpt --resume a.ckpt";
    bench.run(other).exits(2).says(&["integrator \"path\", not \"bdpt\"", "size [24,24], not [8,8]"]);
    let scene = "--set light.sun.illuminance=3 --resume a.ckpt -o b.exr";
    bench.run(&kitchen(scene)).exits(3).says(&["rendered with scene"]);
    assert_eq!(fs::read(bench.path("a.ckpt")).unwrap(), before);
    assert!(!bench.has("b.exr"));
}

#[test]
fn damaged_and_foreign_files_are_3() {
    let bench = Bench::new();
    bench.run(&kitchen("--rounds 1 -o a.exr --checkpoint a.ckpt")).exits(0);
    let whole = fs::read(bench.path("a.ckpt")).unwrap();
    let mut flipped = whole.clone();
    flipped[whole.len() / 2] ^= 1;
    let mut newer = whole.clone();
    newer[8] = 9;
    for (bytes, says) in [
        (&whole[..whole.len() / 2], "bad: error: damaged"),
        (&whole[..9], "bad: error: damaged"),
        (&flipped, "bad: error: damaged"),
        (&newer, "a checkpoint of version 9"),
        (b"", "not a checkpoint"),
        (b"a text of somebody else", "not a checkpoint"),
    ] {
        fs::write(bench.path("bad"), bytes).unwrap();
        bench.run(&kitchen("--rounds 2 -o b.exr --resume bad")).exits(3).says(&[says]);
        bench.run("merge bad -o b.exr").exits(3).says(&[says]);
    }
    bench.run("merge absent -o b.exr").exits(3).says(&["absent: error: cannot read"]);
    assert!(!bench.has("b.exr"));
}

#[test]
fn parts_that_make_no_whole_are_refused() {
    let bench = Bench::new();
    shards(&bench);
    bench.run(&kitchen("--rounds 1 -o x.exr --shard 0/3 --checkpoint short")).exits(0);
    bench.run(&kitchen("--rounds 4 -o x.exr --shard 1/3 --checkpoint other --seed 1")).exits(0);
    bench.run(&kitchen("--rounds 4 -o x.exr --shard 1/2 --checkpoint half")).exits(0);
    bench.run(&kitchen("--rounds 5 -o x.exr --shard 1/3 --checkpoint long")).exits(0);
    for (parts, code, says) in [
        ("0 2", 2, "shards are missing: 1/3"),
        ("1", 2, "shards are missing: 0/3, 2/3"),
        ("0 1 2 1", 2, "1: error: holds shard 1/3, as 1 does"),
        ("0 other 2", 2, "other: error: rendered with seed 1, not 0"),
        ("0 half 2", 2, "half: error: holds shard 1/2 of a render of 3 shards"),
        ("short long 2", 3, "short: error: shard 0/3 has 1 of its 2 rounds"),
    ] {
        bench.run(&format!("merge {parts} -o out.exr")).exits(code).says(&[says]);
    }
    bench.write("1.exr", fs::read(bench.path("1")).unwrap());
    bench.run("merge 0 1.exr 2 -o 1.exr").exits(2).says(&["take the place"]);
    bench.run("merge 0 1 2").exits(2).says(&["--output"]);
    assert!(!bench.has("out.exr"));
    bench.run("merge 0 1 2 -o out.exr").exits(0);
}

#[test]
fn shards_need_a_file_and_a_number_of_rounds() {
    let bench = Bench::new();
    for (more, says) in [
        ("--rounds 4 --shard 0/3", "--checkpoint"),
        ("--rounds 4 --shard 3/3 --checkpoint a", "0/3, 1/3, 2/3"),
        ("--rounds 2 --shard 2/3 --checkpoint a", "shard 2/3 has nothing to do"),
        ("--time 1s --shard 0/3 --checkpoint a", "--rounds or --spp"),
        ("--rounds 8 --noise 5% --shard 0/3 --checkpoint a", "--rounds or --spp"),
        ("--rounds 8 --checkpoint a.exr -o a.exr", "take the place"),
        ("--rounds 8 --checkpoint a --checkpoint-interval often", "90s"),
    ] {
        bench.run(&kitchen(more)).exits(2).says(&[says]);
    }
    assert_eq!(bench.files(), ["kitchen", "leaf.gltf"], "nothing is written");
}
