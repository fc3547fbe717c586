//! Importers that are programs of their own.

use std::{fs, os::unix::fs::PermissionsExt, time::Instant};

use super::bench::{Bench, Run};

const PROBE: &str = r#"if [ "$1" = --probe ]; then echo '{"protocol": 1, "extensions": ["toy"]}'; exit; fi"#;
const SCENE: &str = r#"{"ajar": 1, "roots": [0], "nodes": [{"name": "leaf", "meshes": [0]}],
"meshes": [{"positions": [[0,0,0],[1,0,0],[0,1,0]], "triangles": [[0,1,2]]}]}"#;

/// A bench with `a.toy` and a plug-in for it, a shell script.
fn bench(probe: &str, import: &str) -> Bench {
    let bench = Bench::new();
    bench.write("a.toy", "toy");
    bench.write("bin/ajar-import-toy", format!("#!/bin/sh\n{probe}\n{import}\n"));
    fs::set_permissions(bench.path("bin/ajar-import-toy"), fs::Permissions::from_mode(0o755)).unwrap();
    bench
}

fn importing(import: &str) -> Bench {
    bench(PROBE, import)
}

/// Runs with the plug-in on the search path.
fn run(bench: &Bench, words: &str) -> Run {
    let path = format!("{}:{}", bench.path("bin").display(), std::env::var("PATH").unwrap());
    bench.run_with(words, &[("PATH", &path), ("AJAR_PLUGIN_TIMEOUT", "1")])
}

#[test]
fn a_plug_in_is_found_by_extension_and_told_what_to_read() {
    let bench = importing(&format!("echo \"$@\" > asked; cat << END\n{SCENE}\nEND"));
    run(&bench, "inspect a.toy").exits(0).prints(&["leaf"]);
    let asked = fs::read_to_string(bench.path("asked")).unwrap();
    assert!(asked.starts_with("--import a.toy --memory-limit 8589934592"), "{asked}");
}

#[test]
fn a_plug_in_is_found_by_first_bytes() {
    let probe = r#"if [ "$1" = --probe ]; then echo '{"protocol": 1, "extensions": [], "heads": ["746F79"]}'; exit; fi"#;
    let bench = bench(probe, &format!("cat << END\n{SCENE}\nEND"));
    run(&bench, "validate a.toy").exits(0);
}

#[test]
fn the_users_settings_name_programs_too() {
    let bench = importing(&format!("cat << END\n{SCENE}\nEND"));
    fs::rename(bench.path("bin/ajar-import-toy"), bench.path("toys.sh")).unwrap();
    let configured = |text: &str| {
        bench.write("config/ajar/config.toml", text);
        let config = bench.path("config").display().to_string();
        bench.run_with("inspect a.toy", &[("XDG_CONFIG_HOME", &config)])
    };
    configured("[plugins]\ntoy = \"../../toys.sh\"\n").exits(0).prints(&["leaf"]);
    configured("[plugins]\ntoy = 3\n").exits(1).says(&["config.toml: error: is malformed"]);
    configured("").exits(3).says(&["is of no known format"]);
}

#[test]
fn a_plug_in_may_answer_with_a_glb() {
    let bench = importing("cat leaf.glb");
    bench.write("leaf.glb", bench.glb());
    run(&bench, "inspect a.toy").exits(0).prints(&["wedge"]);
}

#[test]
fn what_it_says_is_shown_in_our_words() {
    let bench = importing(&format!(
        r#"echo '{{"level": "warning", "message": "fur dropped", "place": "/cat", "hint": "shave it"}}' >&2
        echo '{{"progress": "combing"}}' >&2; echo plainly >&2; cat << END
{SCENE}
END"#
    ));
    run(&bench, "render a.toy --spp 1 --size 4x4 -v").exits(0).says(&[
        "a.toy: warning: /cat: fur dropped",
        "shave it",
        "note: ajar-import-toy said: plainly",
    ]);
    run(&bench, "validate a.toy --strict").exits(3);
}

#[test]
fn what_was_lost_is_told_apart() {
    let line = |loss: &str| {
        format!(
            r#"echo '{{"level": "warning", "message": "fur {loss}"{}}}' >&2"#,
            match loss {
                "dropped" => String::new(),
                loss => format!(r#", "loss": "{loss}""#),
            }
        )
    };
    let bench =
        importing(&format!("{}\n{}\ncat << END\n{SCENE}\nEND", line("dropped"), line("approximated")));
    let kept = "kept 1 mesh of 1 triangle; 1 thing approximated, 1 dropped";
    run(&bench, "validate a.toy").exits(0).says(&[kept]);
    let text = run(&bench, "inspect a.toy").exits(0).out;
    let section = |title: &str| text.find(&format!("\n{title}\n")).unwrap();
    assert!(section("approximated") < text.find("fur approximated").unwrap(), "{text}");
    assert!(text.find("fur approximated") < Some(section("dropped")), "{text}");
    let json = run(&bench, "inspect a.toy --json").exits(0).out;
    let said: serde_json::Value = serde_json::from_str(&json).unwrap();
    let losses: Vec<_> = said["diagnostics"].as_array().unwrap().iter().map(|it| &it["loss"]).collect();
    assert_eq!(losses[..2], ["dropped", "approximated"]);
}

#[test]
fn files_that_it_reads_are_known() {
    let bench = importing(&format!("echo '{{\"file\": \"fur.png\"}}' >&2; cat << END\n{SCENE}\nEND"));
    run(&bench, "inspect a.toy --json").exits(0).prints(&["fur.png"]);
}

#[test]
fn its_failures_are_errors_with_a_name() {
    for (import, says) in [
        ("exit 7", "ajar-import-toy failed with exit status: 7"),
        ("echo no wool >&2; exit 1", "no wool"),
        ("kill -SEGV $$", "ajar-import-toy failed with signal: 11"),
        ("echo hello", "ajar-import-toy handed over no usable scene"),
        ("true", "ajar-import-toy handed over no usable scene: the scene is empty"),
        (r#"echo '{"ajar": 1, "nodes": [{"meshes": [3]}]}'"#, "nodes[0].meshes: ajar-import-toy handed over"),
        (r#"echo '{"level": "error", "message": "no such cat", "place": "/cat"}' >&2"#, "/cat: no such cat"),
    ] {
        run(&importing(import), "validate a.toy").exits(3).says(&["a.toy: error:", says]);
    }
}

#[test]
fn one_that_hangs_is_stopped() {
    let began = Instant::now();
    let hint = "AJAR_PLUGIN_TIMEOUT sets the seconds";
    run(&importing("exec sleep 600"), "validate a.toy").exits(3).says(&["it said nothing for 1 s", hint]);
    let closed = "exec 1>&- 2>&-; exec sleep 600";
    run(&importing(closed), "validate a.toy").exits(3).says(&["it said nothing for 1 s"]);
    // One that is alive may take longer.
    let patient = importing(&format!(
        "for i in 1 2 3 4; do sleep 0.5; echo '{{\"progress\": \"…\"}}' >&2; done; cat << END\n{SCENE}\nEND"
    ));
    run(&patient, "validate a.toy").exits(0);
    assert!(began.elapsed().as_secs() < 60);
}

#[test]
fn one_that_prints_without_end_is_stopped() {
    run(&importing("yes"), "validate a.toy --memory-limit 1M")
        .exits(4)
        .says(&["printed more than 1048576 bytes"]);
}

#[test]
fn one_that_cannot_be_asked_is_named_where_it_might_be_needed() {
    for (probe, says) in [
        ("exit 1", "--probe ended with exit status: 1"),
        ("echo hello; exit", "--probe printed something else"),
        (r#"echo '{"protocol": 9, "extensions": []}'; exit"#, "speaks protocol 9, only 1 is known"),
    ] {
        let bench = bench(probe, "");
        run(&bench, "validate a.toy")
            .exits(1)
            .says(&["ajar-import-toy: error: the plug-in cannot be used", says]);
        run(&bench, "validate leaf.gltf").exits(0);
    }
}

#[test]
fn the_example_reads_stl() {
    let bench = Bench::new();
    let corners = [[0, 0, 0], [1000, 0, 0], [0, 0, 1000]];
    let text = corners.map(|[x, y, z]| format!("vertex {x} {y} {z}\n")).concat();
    bench.write(
        "text.stl",
        format!("solid\nfacet normal 0 0 0\nouter loop\n{text}endloop\nendfacet\nendsolid\n"),
    );
    let mut binary = vec![0; 80];
    binary.extend(1_u32.to_le_bytes());
    binary.extend([0; 12]);
    binary.extend(corners.as_flattened().iter().flat_map(|&value| (value as f32).to_le_bytes()));
    binary.extend([0; 2]);
    fs::write(bench.path("binary.stl"), &binary).unwrap();
    fs::write(bench.path("short.stl"), &binary[..100]).unwrap();
    let examples = concat!(env!("CARGO_MANIFEST_DIR"), "/tools/examples");
    let path = format!("{examples}:{}", std::env::var("PATH").unwrap());
    for file in ["text.stl", "binary.stl"] {
        // A metre wide and high, Z up.
        let run = bench.run_with(&format!("inspect {file}"), &[("PATH", &path)]);
        run.exits(0).prints(&["1 × 1 × 0 m"]);
    }
    bench.run_with("validate short.stl", &[("PATH", &path)]).exits(3).says(&["1 facets are announced"]);
}

#[test]
fn it_is_told_which_variants_and_moment_to_show() {
    let bench = importing(&format!("echo \"$@\" > asked; cat << END\n{SCENE}\nEND"));
    let asked = |words: &str| {
        run(&bench, words).exits(0);
        fs::read_to_string(bench.path("asked")).unwrap().trim().to_owned()
    };
    let told = asked("inspect a.toy --variant Red --variant /A:b=c --frame 3 --fps 30");
    assert!(told.ends_with("--variant Red --variant /A:b=c --frame 3 --fps 30"), "{told}");
    bench.write("toy.toml", "[[import]]\nfile = \"a.toy\"\nvariant = \"Red\"\nframe = 7\n");
    let told = asked("inspect toy.toml");
    assert!(told.ends_with("--variant Red --frame 7"), "{told}");
    let told = asked("inspect toy.toml --at 1.5 --set import.a.variant=Blue");
    assert!(told.ends_with("--variant Blue --seconds 1.5"), "{told}");
}
