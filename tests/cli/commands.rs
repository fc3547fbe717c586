//! `ajar inspect`, `validate`, `formats`, and help.

use serde_json::Value;

use crate::bench::Bench;

#[test]
fn help_names_the_exit_codes_and_fits_the_screen() {
    let bench = Bench::new();
    for arguments in [
        "--help",
        "render --help",
        "inspect --help",
        "validate --help",
        "formats --help",
        "merge --help",
        "watch --help",
        "render -h",
    ] {
        let run = bench.run(arguments).exits(0);
        assert!(run.out.contains("Exit codes: 0 ok"), "{arguments}:\n{}", run.out);
        assert!(run.out.contains("5 interrupted"), "{arguments}");
        for line in run.out.lines() {
            assert!(line.chars().count() <= 100, "{arguments}: {line}");
        }
    }
    assert!(bench.run("--version").exits(0).out.starts_with("ajar "));
}

#[test]
fn formats_lists_the_importers() {
    let bench = Bench::new();
    let text = bench.run("formats").exits(0).out;
    for part in ["gltf  .gltf .glb", "obj  .obj", "scene  .toml", "[[import]]", "KHR_", "OpenEXR"] {
        assert!(text.contains(part), "{part} in\n{text}");
    }
    let json: Value = serde_json::from_str(&bench.run("formats --json").exits(0).out).unwrap();
    let formats = json["formats"].as_array().unwrap();
    for name in ["scene", "ajar", "gltf", "obj", "plug-ins"] {
        let format = formats.iter().find(|format| format["name"] == name).unwrap();
        assert!(format["features"].as_array().unwrap().iter().all(|row| row["support"].is_string()));
    }
}

#[test]
fn inspect_tells_who_set_what() {
    let bench = Bench::new();
    bench.write("kitchen/look.toml", "extends = \"scene.toml\"\n[[camera]]\nname = \"main\"\nyfov = 20\n");
    bench.run("inspect kitchen/look.toml --set camera.main.exposure=2").exits(0).prints(&[
        "camera[0].yfov = 20 (look.toml)",
        "camera[0].name = \"main\" (look.toml, over scene.toml)",
        "camera[0].exposure = 2 (--set)",
        "render.spp = 4 (scene.toml)",
    ]);
    let alone = bench.run("inspect kitchen/scene.toml").exits(0).out;
    assert!(!alone.contains("settings"), "{alone}");
}

#[test]
fn schema_is_json() {
    let out = Bench::new().run("schema").exits(0).out;
    let schema: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert_eq!(schema["title"], "Ajar scene file");
}

#[test]
fn inspect_counts_what_is_there() {
    let bench = Bench::new();
    let run = bench.run("inspect leaf.gltf --json").exits(0);
    let json: Value = serde_json::from_str(&run.out).unwrap();
    let counts = &json["counts"];
    for (key, count) in [("meshes", 1), ("instances", 1), ("triangles", 1), ("vertices", 3), ("materials", 1)]
    {
        assert_eq!(counts[key], count, "{key} in {counts}");
    }
    assert_eq!((&counts["cameras"], &counts["lights"]), (&1.into(), &2.into()), "those that were added");
    assert_eq!(json["bounds"]["size"], serde_json::json!([1.0, 1.0, 0.0]));
    assert_eq!(json["nodes"][0]["name"], "leaf");
    assert_eq!(json["materials"][0]["name"], "clay");
    assert_eq!(
        (&json["materials"][0]["path"], &json["materials"][0]["shown"]),
        (&"leaf/clay".into(), &1.into())
    );
    assert_eq!(json["materials"][0]["parameters"]["roughness"]["value"], 0.25);
    assert!(json["materials"][0]["parameters"]["metallic"].is_null(), "as the default");
    assert!(json["diagnostics"].as_array().unwrap().len() >= 2, "{}", json["diagnostics"]);
    assert_eq!(json["scene_hash"].as_str().unwrap().len(), 64);
    assert_eq!(run.out, bench.run("inspect leaf.gltf --json").out, "the same every time");
}

#[test]
fn inspect_reads_well() {
    let bench = Bench::new();
    let text = bench.run("inspect kitchen/scene.toml").exits(0).out;
    for part in [
        "box\n",
        "(12 triangles)",
        "2 × 2 × 2 m, from (-1, -1, -1) to (1, 1, 1)",
        "\"sun\": directional, 10 lx",
        "\"main\": perspective, 40° high, pinhole",
        "camera \"top\"",
        "1 light, 2 cameras",
    ] {
        assert!(text.contains(part), "{part} in\n{text}");
    }
    let text = bench.run("inspect leaf.gltf").exits(0).out;
    for part in
        ["leaf: mesh \"wedge\" of \"clay\" (1 triangle)", "roughness 0.25", "note: the scene has no camera"]
    {
        assert!(text.contains(part), "{part} in\n{text}");
    }
}

#[test]
fn long_lists_are_cut_unless_all_is_asked_for() {
    let bench = Bench::new();
    let children: Vec<_> = (1..=50).map(|i| i.to_string()).collect();
    let leaves: Vec<_> = (1..=50).map(|i| format!("{{\"name\": \"leaf{i}\"}}")).collect();
    let text = format!(
        "{{\"asset\": {{\"version\": \"2.0\"}}, \"scenes\": [{{\"nodes\": [0]}}], \"scene\": 0,
          \"nodes\": [{{\"name\": \"tree\", \"children\": [{}]}}, {}]}}",
        children.join(","),
        leaves.join(",")
    );
    bench.write("tree.gltf", &text);
    let short = bench.run("inspect tree.gltf").exits(0).out;
    assert!(
        short.contains("leaf12\n") && !short.contains("leaf13") && short.contains("… and 38 more"),
        "{short}"
    );
    let long = bench.run("inspect tree.gltf --all").exits(0).out;
    assert!(long.contains("leaf50\n") && !long.contains("more"), "{long}");
}

#[test]
fn inspect_of_a_bad_file_is_json_too() {
    let bench = Bench::new();
    bench.write("cut.gltf", "{");
    let run = bench.run("inspect cut.gltf --json").exits(3);
    let json: Value = serde_json::from_str(&run.out).unwrap();
    assert_eq!(json["diagnostics"][0]["severity"], "error");
}

#[test]
fn validate_gives_a_verdict_and_writes_nothing() {
    let bench = Bench::new();
    let before = bench.files();
    assert_eq!(bench.run("validate kitchen/scene.toml").exits(0).out, "kitchen/scene.toml: fit to render\n");
    bench.write("kitchen/box.obj", "v 0 0 0\nf 1 2 3\n");
    let run = bench.run("validate kitchen/scene.toml");
    assert!(run.out.starts_with("kitchen/scene.toml: "), "{}", run.out);
    assert!(run.err.contains("box.obj:2:"), "{}", run.err);
    assert_eq!(bench.files(), before);
}

#[test]
fn variants_that_are_not_there_are_errors_of_usage() {
    let bench = Bench::new();
    bench.run("inspect kitchen/box.obj --variant Red").exits(2).says(&["variant \"Red\"", "has none"]);
    let scene = bench.run("validate kitchen/scene.toml --variant Red");
    scene.exits(2).says(&["--set 'import.NAME.variant=Red'"]);
    bench.run("inspect leaf.gltf --frame 1 --at 2").exits(2);
    bench.run("inspect leaf.gltf --fps 0").exits(2);
}
