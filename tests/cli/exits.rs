//! Exit codes, and what is said with them.

use std::fs;

use crate::bench::{Bench, SCENE};

#[test]
fn what_the_command_line_gets_wrong_is_2() {
    let bench = Bench::new();
    for (arguments, says) in [
        ("", "Usage"),
        ("rendre leaf.gltf", "render"),
        ("render", "FILE"),
        ("render leaf.gltf --sise 8x8", "--size"),
        ("render leaf.gltf --size 8", "640x480"),
        ("render leaf.gltf --spp 0", "--spp"),
        ("render leaf.gltf --time soon", "--time"),
        ("render leaf.gltf --crop 0,2,0,1", "--crop"),
        ("render leaf.gltf --crop 0,1,0,1 --pixel-bounds 0,1,0,1", "cannot be used with"),
        ("render leaf.gltf --pixel-bounds 2000,2001,0,1", "the image at 1280, 720"),
        ("render leaf.gltf --integrator photon", "bdpt"),
        ("render leaf.gltf --aov colour", "albedo"),
        ("render leaf.gltf --tone-map filmic", "agx"),
        ("render kitchen/scene.toml --camera side", "main, top"),
        ("render leaf.gltf --quiet --verbose", "cannot be used with"),
        ("validate", "FILE"),
        ("inspect leaf.gltf --xml", "--xml"),
    ] {
        let run = bench.run(arguments).exits(2).says(&[says]);
        assert_eq!(run.out, "", "{arguments}");
    }
    assert_eq!(bench.files(), ["kitchen", "leaf.gltf"], "nothing is written");
}

#[test]
fn what_a_file_gets_wrong_is_3() {
    let bench = Bench::new();
    bench.write("cut.gltf", r#"{ "asset": { "version": "2.0" }, "nodes": [ "#);
    bench.write("text.abc", "a file of no format");
    bench.write("out.exr", "precious");
    for command in ["render", "validate", "inspect"] {
        let output = if command == "render" { "-o out.exr" } else { "" };
        for (file, says) in [
            ("absent.gltf", "absent.gltf: error: "),
            ("absent.obj", "absent.obj: error: "),
            ("absent.toml", "absent.toml: error: "),
            ("absent", "absent: error: "),
            ("cut.gltf", "cut.gltf:1:"),
            ("text.abc", "text.abc: error: "),
        ] {
            bench.run(&format!("{command} {file} {output}")).exits(3).says(&[says]);
        }
    }
    assert_eq!(fs::read_to_string(bench.path("out.exr")).unwrap(), "precious");
    assert!(!bench.has("out.png"));
}

#[test]
fn mistakes_in_a_scene_file_have_line_column_and_advice() {
    let bench = Bench::new();
    for (good, bad, says) in [
        ("illuminance", "iluminance", ["scene.toml:19:1: error: ", "\"illuminance\""]),
        ("[[camera]]", "[[camara]]", ["scene.toml:5:", "\"camera\""]),
        ("directional", "directionl", ["scene.toml:17:8: error: ", "\"directional\""]),
        ("spp = 4", "spp = 0", ["scene.toml:23:7: error: ", "spp"]),
        ("box.obj", "bax.obj", ["scene.toml:3:8: error: ", "bax.obj"]),
        ("spp = 4", "spp = ", ["scene.toml:23:", "error: "]),
        ("spp = 4", "integrator = \"photon\"", ["scene.toml:23:14: error: render.integrator: ", "bdpt"]),
        ("spp = 4", "max_depth = 5000", ["scene.toml:23:13: error: render.max_depth: ", "5000"]),
        ("spp = 4", "mutations = { lans = 1 }", ["scene.toml:23:", "lens"]),
        ("spp = 4", "mutations = { lens = -1 }", ["scene.toml:23:22: error: render.mutations.lens: ", "-1"]),
        (
            "spp = 4",
            "mutations = { bidirectional = 0, lens = 0, caustic = 0, multi-chain = 0, window = 0, technique = 0, \
             eye-chain = 0, light-chain = 0, lens-subpath = 0, manifold = 0 }",
            ["scene.toml:23:31: error: render.mutations: ", "switched off"],
        ),
        ("spp = 4", "chain_length = 0", ["scene.toml:23:16: error: render.chain_length: ", "1"]),
        ("spp = 4", "mutation_choice = \"best\"", ["scene.toml:23:", "learned"]),
        ("spp = 4", "[output]\ntone_map = \"fimlic\"", ["scene.toml:24:12: error: output.tone_map: ", "agx"]),
        ("spp = 4", "[output]\naov = [\"nrm\"]", ["scene.toml:24:7: error: output.aov: ", "normal"]),
        ("spp = 4", "[output]\npath = \"a.png\"", ["scene.toml:24:8: error: output.path: ", ".exr"]),
        ("spp = 4", "[output]\npng = \"../a.png\"", ["scene.toml:24:7: error: output.png: ", "-o"]),
        ("spp = 4", "[output]\npath = \"/tmp/a.exr\"", ["scene.toml:24:8: error: output.path: ", "-o"]),
        ("\"top\"", "\"main\"", ["scene.toml:11:8: error: camera[1].name: ", "another camera"]),
    ] {
        assert!(SCENE.contains(good), "{good}");
        bench.write("kitchen/scene.toml", SCENE.replacen(good, bad, 1));
        for command in ["render", "validate"] {
            bench.run(&format!("{command} kitchen/scene.toml")).exits(3).says(&says);
        }
    }
    assert_eq!(bench.files(), ["kitchen", "leaf.gltf"], "nothing is written");
}

#[test]
fn an_output_that_cannot_be_written_is_1() {
    let bench = Bench::new();
    bench
        .run("render leaf.gltf --size 8x8 --spp 1 -o leaf.gltf/out.exr")
        .exits(1)
        .says(&["leaf.gltf", "cannot write"]);
    // It is said before anything is rendered.
    bench
        .run("render leaf.gltf --dry-run -o away/out.exr")
        .exits(1)
        .says(&["away/out.exr", "no such folder"]);
}

#[test]
fn images_take_nothing_else_s_place() {
    let bench = Bench::new();
    bench.write("own.glb", bench.glb());
    bench.write("shot.exr", "precious");
    let small = "--size 8x8 --spp 1";
    for output in ["x.png", "own.glb", "x"] {
        bench.run(&format!("render own.glb {small} -o {output}")).exits(2).says(&[".exr"]);
    }
    bench.write(
        "kitchen/scene.toml",
        format!("{SCENE}\n[material.\"*\"]\nbase_color_texture = \"../shot.exr\"\n"),
    );
    let over = format!("render kitchen/scene.toml {small} --allow . -o shot.exr");
    bench.run(&over).exits(2).says(&["shot.exr: error: ", "a file of the scene"]);
    assert_eq!(fs::read_to_string(bench.path("shot.exr")).unwrap(), "precious");
    assert_eq!(fs::read(bench.path("own.glb")).unwrap(), bench.glb());
}

#[test]
fn an_image_that_takes_too_much_memory_is_4() {
    let bench = Bench::new();
    bench.write("kitchen/scene.toml", SCENE.replace("[24, 16]", "[65535, 65535]"));
    for command in ["render", "validate"] {
        let says = ["scene.toml:22:8: error: render.size: 65535x65535 pixels", "--memory-limit"];
        bench.run(&format!("{command} kitchen/scene.toml")).exits(4).says(&says);
    }
    bench.run("render leaf.gltf --size 60000x60000").exits(4).says(&["60000x60000 pixels"]);
    let part = "--pixel-bounds 10,18,10,18 --spp 1 -o part.exr";
    bench.run(&format!("render kitchen/scene.toml {part}")).exits(0);
    bench.run("render leaf.gltf --size 8x8 --pixel-bounds 0,9,0,8").exits(2).says(&["8, 8"]);
}

#[test]
fn numbers_out_of_range_are_2() {
    let bench = Bench::new();
    for flag in ["--noise 0", "--noise 0%", "--exposure nan", "--exposure inf"] {
        bench.run(&format!("render leaf.gltf {flag}")).exits(2).says(&[flag.split_once(' ').unwrap().0]);
    }
}

#[test]
fn strict_makes_warnings_errors() {
    let bench = Bench::new();
    bench.write("lines.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nl 1 2\n");
    for command in ["validate", "inspect"] {
        bench.run(&format!("{command} lines.obj")).exits(0);
        bench.run(&format!("{command} lines.obj --strict")).exits(3).says(&["lines.obj:5:", "warning: "]);
    }
    bench.run("render lines.obj --size 8x8 --spp 1 --strict").exits(3).says(&["lines.obj:5:"]);
    assert!(!bench.has("lines.exr"));
}

#[test]
fn what_needs_more_memory_than_allowed_is_4() {
    let bench = Bench::new();
    for command in ["render", "validate", "inspect"] {
        for file in ["leaf.gltf", "kitchen/scene.toml", "kitchen/box.obj"] {
            bench
                .run(&format!("{command} {file} --memory-limit 100"))
                .exits(4)
                .says(&["error: ", "memory limit"]);
        }
    }
    // A file that is broken stays broken with more memory.
    let broken = SCENE.replacen("illuminance", "iluminance", 1);
    bench.write("kitchen/scene.toml", &broken);
    bench
        .run("validate kitchen/scene.toml --memory-limit 100")
        .exits(3)
        .says(&["memory limit", "iluminance"]);
    assert!(!bench.has("leaf.exr"));
}

#[test]
fn a_texture_without_coordinates_is_said_once() {
    let bench = Bench::new();
    let leaf = fs::read_to_string(bench.path("leaf.gltf")).unwrap();
    // A PNG of one grey pixel.
    let pixel =
        "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAAAAAA6fptVAAAACklEQVR4nGNoAAAAggCBd81ytgAAAABJRU5ErkJggg==";
    let texture = format!(
        "\"textures\": [{{ \"source\": 0 }}], \"images\": [{{ \"uri\": \"data:image/png;base64,{pixel}\" }}],\n  \"materials\""
    );
    let textured = leaf.replace("\"materials\"", &texture).replace(
        "\"roughnessFactor\"",
        "\"baseColorTexture\": { \"index\": 0, \"texCoord\": 1 }, \"roughnessFactor\"",
    );
    bench.write("textured.gltf", &textured);
    bench.write(
        "placed.toml",
        "[[import]]\nfile = \"textured.gltf\"\n[[import]]\nfile = \"kitchen/box.obj\"\n",
    );
    for file in ["textured.gltf", "placed.toml"] {
        let run = bench.run(&format!("validate {file}")).exits(0);
        let said: Vec<_> = run.err.lines().filter(|line| line.contains("UV set 1")).collect();
        assert_eq!(said.len(), 1, "{}", run.err);
        for part in [file, "warning: ", "node \"leaf\"/mesh \"wedge\"", "material \"clay\""] {
            assert!(said[0].contains(part), "{part} in {}", said[0]);
        }
        bench.run(&format!("validate {file} --strict")).exits(3);
    }
}
