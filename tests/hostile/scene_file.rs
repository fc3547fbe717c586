//! Hostile scene files.

use crate::jail::{
    Fate::{Clean, Either, Refused, Warned},
    Jail,
};

const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

#[test]
fn imports_stay_in_the_folder() {
    let mut jail = Jail::new();
    let secret = jail.put("secret.obj", OBJ);
    jail.put("inner/box.obj", OBJ);
    for file in [
        "../secret.obj".into(),
        "..\\\\secret.obj".into(),
        "x/../../secret.obj".into(),
        secret.to_string_lossy().replace('\\', "/"),
        "/etc/passwd".into(),
        "/dev/zero".into(),
        "file:///etc/passwd".into(),
        "http://localhost/box.obj".into(),
        ".".into(),
        "scene.toml".into(),
        String::new(),
    ] {
        jail.try_file("inner/scene.toml", format!("[[import]]\nfile = \"{file}\"\n"), Refused);
        let light = format!("[[light]]\ntype = \"environment\"\ntexture = \"{file}\"\n");
        jail.try_file("inner/light.toml", light, Refused);
    }
    jail.try_file("inner/good.toml", "[[import]]\nfile = \"box.obj\"\n", Clean);
    jail.close();
}

#[test]
fn what_an_import_refers_to_lies_below_the_scene() {
    let mut jail = Jail::new();
    let library = "newmtl a\nKd 1 0 0\n";
    jail.put("secret.mtl", library);
    jail.put("inner/shared.mtl", library);
    jail.put("inner/parts/out.obj", format!("mtllib ../../secret.mtl\nusemtl a\n{OBJ}"));
    jail.put("inner/parts/in.obj", format!("mtllib ../shared.mtl\nusemtl a\n{OBJ}"));
    let scene = |part: &str| format!("[[import]]\nfile = \"parts/{part}.obj\"\n");
    jail.try_file("inner/in.toml", scene("in"), Clean);
    jail.try_file("inner/out.toml", scene("out"), Warned);
    jail.close();
}

#[test]
fn deep_and_long_structures() {
    let mut jail = Jail::new();
    let many = 100_000;
    jail.try_file("arrays.toml", format!("a = {}{}", "[".repeat(many), "]".repeat(many)), Refused);
    jail.try_file("open.toml", format!("a = {}", "[".repeat(many)), Refused);
    jail.try_file("tables.toml", format!("a = {}1{}", "{a=".repeat(many), "}".repeat(many)), Refused);
    jail.try_file("dotted.toml", format!("a{} = 1", ".a".repeat(many)), Refused);
    jail.try_file("header.toml", format!("[a{}]", ".a".repeat(many)), Refused);
    let unknown: String = (0..many).map(|i| format!("k{i} = 1\n")).collect();
    jail.try_file("unknown.toml", unknown, Refused);
    jail.try_file("errors.toml", "= = =\n".repeat(many), Refused);
    jail.try_file("cameras.toml", "[[camera]]\n".repeat(many / 10), Either);
    jail.put("box.obj", OBJ);
    jail.try_file("imports.toml", "[[import]]\nfile = \"box.obj\"\n".repeat(500), Either);
    let pattern = "a*".repeat(5_000);
    let name = "a".repeat(5_000);
    jail.put("named.mtl", format!("newmtl {name}\nKd 1 0 0\n"));
    jail.put("named.obj", format!("mtllib named.mtl\nusemtl {name}\n{OBJ}"));
    let text = format!("[[import]]\nfile = \"named.obj\"\n[material.\"{pattern}b\"]\nior = 1.25\n");
    jail.try_file("pattern.toml", text, Either);
    jail.close();
}

#[test]
fn values_out_of_this_world() {
    let mut jail = Jail::new();
    for text in [
        "[render]\nsize = [65536, 1]",
        "[render]\nsize = [1e9, 1e9]",
        "[render]\nspp = 99999999999999999999",
        "[render]\nseed = -1",
        "[render]\ntime = \"1e400s\"",
        "[render]\nnoise = \"nan%\"",
        "[render]\ncrop = [nan, 1, 0, 1]",
        "[[camera]]\nposition = [nan, 0, 0]",
        "[[camera]]\nposition = [1, 1, 1]\ntarget = [1, 1, 1]",
        "[[camera]]\nyfov = 180",
        "[[light]]\ntype = \"rect\"\nwidth = -1",
        "[[light]]\ntype = \"point\"\nintensity = inf",
        "[[light]]",
        "[[import]]",
        "import = 1",
        "camera = [1, [2]]",
    ] {
        jail.try_file("values.toml", text, Refused);
    }
    for bytes in [&b"\xff\xfe"[..], b"\0", b"\xef\xbb\xbfa = 1", b"a = \"\xff\"", b"[render", b"a = 'b"] {
        jail.try_file("bytes.toml", bytes, Refused);
    }
    jail.try_file("empty.toml", "", Clean);
    jail.close();
}
