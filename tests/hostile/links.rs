//! Links that lead out of the folder, and pipes that nobody writes to, wherever a file is named.

use std::{os::unix::fs::symlink, process::Command};

use crate::{
    images::{ONE_PIXEL, png},
    jail::{
        Fate::{self, Clean, Refused, Warned},
        Jail,
    },
};

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const SCENE: &str = r#"{"ajar": 1, "roots": [0], "nodes": [{"meshes": [0]}],
"meshes": [{"positions": [[0,0,0],[1,0,0],[0,1,0]], "triangles": [[0,1,2]]}]}"#;

/// What names a file: the name of what is opened, its text with `FILE` for the name, what that is, and what becomes of a
/// file that must not be read.
fn cases() -> Vec<(&'static str, String, &'static str, Vec<u8>, Fate)> {
    let import = "[[import]]\nfile = \"FILE\"\n".to_owned();
    let lit = "[[light]]\ntype = \"environment\"\ntexture = \"FILE\"\n".to_owned();
    let picture = || png(1, 1, ONE_PIXEL);
    let gltf = crate::gltf::Asset::new().text();
    let shown = SCENE.replacen('{', r#"{"images": [{"file": "FILE"}], "#, 1);
    vec![
        ("a.toml", import.clone(), "b.obj", TRIANGLE.into(), Refused),
        ("a.toml", import.clone(), "b.gltf", gltf.into(), Refused),
        ("a.toml", import.clone(), "b.ajar", SCENE.into(), Refused),
        ("a.toml", import, "b.of-no-known-format", TRIANGLE.into(), Refused),
        ("a.toml", "extends = \"FILE\"\n".into(), "b.toml", Vec::new(), Refused),
        ("a.toml", lit, "b.png", picture(), Refused),
        ("a.obj", format!("mtllib FILE\nusemtl a\n{TRIANGLE}"), "b.mtl", "newmtl a\n".into(), Warned),
        ("a.ajar", shown, "b.png", picture(), Refused),
    ]
}

#[test]
fn links_out_of_the_folder_are_not_followed() {
    let mut jail = Jail::new();
    for (opened, text, name, bytes, fate) in cases() {
        let text = text.replace("FILE", name);
        jail.put(&format!("inner/{name}"), &bytes);
        jail.try_file(&format!("inner/{opened}"), &text, Clean);
        std::fs::remove_file(jail.path(&format!("inner/{name}"))).unwrap();
        let secret = jail.put(&format!("secrets/{name}"), bytes);
        symlink(secret, jail.path(&format!("inner/{name}"))).unwrap();
        jail.try_file(&format!("inner/{opened}"), &text, fate);
        // Through a link to a folder.
        let _ = symlink(jail.path("secrets"), jail.path("inner/folder"));
        jail.try_file(&format!("inner/{opened}"), text.replace(name, &format!("folder/{name}")), fate);
        std::fs::remove_file(jail.path(&format!("inner/{name}"))).unwrap();
    }
    jail.close();
}

#[test]
fn pipes_are_not_waited_for() {
    let mut jail = Jail::new();
    for (opened, text, name, _, fate) in cases() {
        let pipe = jail.path(&format!("inner/{name}"));
        std::fs::create_dir_all(pipe.parent().unwrap()).unwrap();
        if !Command::new("mkfifo").arg(&pipe).status().is_ok_and(|status| status.success()) {
            println!("skipped: there is no mkfifo");
            return;
        }
        jail.try_file(&format!("inner/{opened}"), text.replace("FILE", name), fate);
        if name != "b.mtl" && name != "b.png" {
            jail.try_path(&pipe, Refused);
        }
        std::fs::remove_file(&pipe).unwrap();
    }
    jail.close();
}
