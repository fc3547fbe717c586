//! `--set`: changes by the keys of the scene file.

use serde_json::Value;

use crate::bench::Bench;

/// What `ajar inspect` says with these changes.
fn inspect(bench: &Bench, file: &str, changes: &[&str]) -> Value {
    let mut command = bench.command(&format!("inspect {file} --json"));
    command.args(changes.iter().flat_map(|change| ["--set", change]));
    let output = command.output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn materials_of_assets_and_scenes_change() {
    let bench = Bench::new();
    bench.write("placed.toml", "[[import]]\nfile = \"leaf.gltf\"\n[material.\"*\"]\nroughness = 0.9\n");
    for file in ["leaf.gltf", "placed.toml"] {
        let plain = inspect(&bench, file, &[]);
        let changed = inspect(
            &bench,
            file,
            &["material.clay.roughness=0.125", "material.'cl*'.ior=3", "material./leaf/clay.ior=2"],
        );
        let parameters = &changed["materials"][0]["parameters"];
        assert_eq!(
            (&parameters["roughness"]["value"], &parameters["ior"]),
            (&0.125.into(), &2.0.into()),
            "{file}"
        );
        assert_ne!(plain["scene_hash"], changed["scene_hash"]);
        assert_eq!(plain["scene_hash"], inspect(&bench, file, &["render.max_depth=3"])["scene_hash"]);
    }
}

#[test]
fn files_elsewhere_are_read_below_allowed_folders_only() {
    let bench = Bench::new();
    bench.write(
        "looks/look.toml",
        "extends = \"../kitchen/scene.toml\"\n[[import]]\nfile = \"../leaf.gltf\"\n",
    );
    bench.run("inspect looks/look.toml").exits(3).says(&["lies outside the scene's folder", "--allow"]);
    bench.run("inspect looks/look.toml --allow kitchen --allow .").exits(0).prints(&["leaf", "box"]);
}

#[test]
fn lists_are_changed_by_name_or_position() {
    let bench = Bench::new();
    let scene = "kitchen/scene.toml";
    let changes = ["light.sun.illuminance=5", "camera[1].half_height=2", "import.box.scale=3"];
    let changed = inspect(&bench, scene, &changes);
    assert_eq!(changed["lights"][0]["strength"], 5.0, "{}", changed["lights"]);
    assert_eq!(changed["cameras"][1]["kind"], "orthographic", "{}", changed["cameras"]);
    assert_eq!(changed["bounds"]["size"][0], 6.0);
}

#[test]
fn settings_go_before_the_file_and_behind_the_flags() {
    let bench = Bench::new();
    let dry = |more: &str| {
        bench
            .run(&format!("render kitchen/scene.toml --dry-run --set render.size=[32,20] {more}"))
            .exits(0)
            .out
    };
    assert!(dry("").contains("32x20") && dry("").contains("by ajar"));
    assert!(dry("--set render.integrator=bdpt").contains("by bdpt"));
    assert!(dry("--set render.crop=[0,0.5,0,1]").contains("16x20 pixels of 32x20"));
    assert!(dry("--set output.path=other.exr").contains("other.exr"));
    assert!(dry("--size 8x8").contains("8x8"));
    let run = bench.run("render leaf.gltf --dry-run --set render.integrator=bdpt --set render.size=[4,4]");
    assert!(run.exits(0).out.contains("4x4 by bdpt"), "assets have no file to stand in");
}

#[test]
fn mistakes_are_2_and_name_the_nearest() {
    let bench = Bench::new();
    for (change, says) in [
        ("render.max_depht=4", ["--set render.max_depht: unknown key", "\"max_depth\""]),
        ("rendr.spp=4", ["--set rendr: unknown key", "\"render\""]),
        ("render.max_depth=0", ["--set render.max_depth", "at least 1"]),
        ("render.integrator=photon", ["photon", "bdpt"]),
        ("render=3", ["--set render", "expected a table"]),
        ("material.bax.roughness=0.5", ["--set material.\"bax\"", "no import has a material"]),
        ("material.default.roughnes=0.5", ["roughnes: unknown key", "\"roughness\""]),
        ("material.default.roughness=matt", ["roughness", "expected a number"]),
        ("light.son.illuminance=5", ["--set light.son", "\"sun\""]),
        ("light.sun=5", ["--set light.sun", "name one of them"]),
        ("camera[2].yfov=30", ["--set camera.2", "no such camera"]),
        ("camera=30", ["--set camera", "name one of them"]),
        ("render.max_depth", ["--set render.max_depth", "KEY=VALUE"]),
    ] {
        let run = bench.run(&format!("render kitchen/scene.toml --set {change}")).exits(2).says(&says);
        assert_eq!(run.out, "", "{change}");
    }
    bench.run("render leaf.gltf --set light.sun.color=[1,0,0]").exits(2).says(&["no such light"]);
    bench.run("validate leaf.gltf --set material.clay.roughnes=1").exits(2).says(&["\"roughness\""]);
    assert_eq!(bench.files(), ["kitchen", "leaf.gltf"], "nothing is written");
}
