//! Plug-ins that mean harm with what they print. That they run is the user's will.

use std::{fs, os::unix::fs::PermissionsExt};

use crate::jail::{
    Fate::{self, Clean, Either, Refused, TooLarge, Warned},
    Jail,
};

const PROBE: &str = r#"if [ "$1" = --probe ]; then echo '{"protocol": 1, "extensions": ["toy"]}'; exit; fi"#;
const SCENE: &str = r#"{"ajar": 1, "roots": [0], "nodes": [{"meshes": [0]}],
"meshes": [{"positions": [[0,0,0],[1,0,0],[0,1,0]], "triangles": [[0,1,2]]}]}"#;

/// What becomes of a file that a plug-in reads by running this script. Files beside it may be printed.
fn answers(jail: &mut Jail, script: &str, fate: Fate) {
    let plug_in =
        jail.put("bin/ajar-import-toy", format!("#!/bin/sh\n{PROBE}\ncd \"${{2%/*}}\"\n{script}\n"));
    fs::set_permissions(plug_in, fs::Permissions::from_mode(0o755)).unwrap();
    jail.try_file("inner/a.toy", script, fate);
}

/// A jail in which plug-ins are found and may say nothing for a second.
fn jail() -> Jail {
    let mut jail = Jail::new();
    let path = format!("{}:{}", jail.path("bin").display(), std::env::var("PATH").unwrap());
    jail.variables = vec![("PATH", path), ("AJAR_PLUGIN_TIMEOUT", "1".into())];
    jail.put("inner/scene.json", SCENE);
    answers(&mut jail, "cat scene.json", Clean);
    jail
}

#[test]
fn more_than_anybody_wants() {
    let mut jail = jail();
    answers(&mut jail, "yes", TooLarge);
    answers(&mut jail, "yes >&2", TooLarge);
    answers(&mut jail, "seq 1000000 >&2; cat scene.json", Either);
    answers(&mut jail, "head -c 100000000 /dev/zero >&2; cat scene.json", TooLarge);
    answers(&mut jail, "head -c 10000000 /dev/zero >&2; cat scene.json", Either);
    let many = r#"for i in $(seq 3000); do echo "{\"level\": \"warning\", \"message\": \"m$i\", \"place\": \"p\"}"; done >&2"#;
    answers(&mut jail, &format!("{many}; cat scene.json"), Warned);
    let long = format!(r#"{{"level": "warning", "message": "{}"}}"#, "m".repeat(1 << 20));
    jail.put("inner/long.json", &long);
    answers(&mut jail, "cat long.json >&2; cat scene.json", Warned);
    jail.put("inner/failed.json", long.replace("warning", "error"));
    answers(&mut jail, "cat failed.json >&2; cat scene.json", Refused);
    jail.close();
}

#[test]
fn ends_that_are_none() {
    let mut jail = jail();
    for script in [
        "exit 3",
        "kill -9 $$",
        "kill -11 $$",
        "sleep 3",
        "cat scene.json; sleep 3",
        "cat scene.json; exit 1",
        "exec >&- 2>&-; sleep 3; exit 1",
    ] {
        answers(&mut jail, script, Refused);
    }
    // What goes on behind its back keeps its streams.
    answers(&mut jail, "sleep 3 & cat scene.json", Refused);
    jail.close();
}

#[test]
fn streams_that_are_none() {
    let mut jail = jail();
    let glb = |json: &str| {
        let length = |n: usize| (n as u32).to_le_bytes();
        [&b"glTF\x02\0\0\0"[..], &length(20 + json.len()), &length(json.len()), b"JSON", json.as_bytes()]
            .concat()
    };
    let outside = r#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
        "bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":"../secret.bin"}]}"#;
    jail.put("secret.bin", [0; 36]);
    let image = SCENE.replacen('{', r#"{"images": [{"file": "/etc/passwd"}], "#, 1);
    for output in [
        &b""[..],
        b"\n",
        b"null",
        b"\0\0\0\0",
        b"AJAR",
        b"AJAR\x01\0\0\0\xff\xff\xff\xff",
        b"glTF",
        b"glTF\x02\0\0\0\xff\xff\xff\xff\xff\xff\xff\xffJSON",
        b"#usda 1.0",
        &SCENE.as_bytes()[..100],
        &glb("{}"),
        &glb(outside),
        image.as_bytes(),
    ] {
        jail.put("inner/output", output);
        answers(&mut jail, "cat output", Refused);
    }
    for (line, fate) in [
        (r#"{"level": "fatal", "message": "x"}"#, Either),
        (r#"{"level": "error", "message": ""}"#, Refused),
        (r#"{"level": "error", "message": "\u0000\u001b[2J", "place": "\u001b"}"#, Refused),
        (r#"{"file": "/etc/passwd"}"#, Clean),
        (r#"{"file": 7}"#, Either),
        ("{", Either),
        ("\\0377\\0376\\0000", Either),
    ] {
        jail.put("inner/line", line);
        answers(
            &mut jail,
            "printf '%b\\n' \"$(cat line)\" >&2; cat line >&2; echo >&2; cat scene.json",
            fate,
        );
    }
    jail.close();
}
