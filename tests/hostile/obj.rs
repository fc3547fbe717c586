//! Hostile OBJ and MTL.

use crate::jail::{
    Fate::{Clean, Either, Refused, Warned},
    Jail,
};

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

#[test]
fn indices_out_of_this_world() {
    let mut jail = Jail::new();
    for index in [
        "0",
        "4",
        "-4",
        "4294967297",
        "9223372036854775807",
        "-9223372036854775808",
        "1e3",
        "99999999999999999999999",
        "",
        "/",
        "x",
    ] {
        jail.try_file("face.obj", format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 {index}\n"), Either);
        jail.try_file("normal.obj", format!("{TRIANGLE}vn 0 0 1\nf 1//1 2//1 3//{index}\n"), Either);
        jail.try_file("uv.obj", format!("{TRIANGLE}vt 0 0\nf 1/1 2/1 3/{index}\n"), Either);
    }
    jail.close();
}

#[test]
fn numbers_that_are_none() {
    let mut jail = Jail::new();
    for number in ["nan", "inf", "-inf", "1e999", "1e38", "", "x", "0x10", "1,5", "1e-999"] {
        jail.try_file("v.obj", format!("v {number} {number} 0\n{TRIANGLE}f 1 2 3\n"), Either);
        jail.try_file("vn.obj", format!("vn {number} 0 0\n{TRIANGLE}f 1//1 2//1 3//1\n"), Either);
        jail.try_file("vt.obj", format!("vt {number} 0\n{TRIANGLE}f 1/1 2/1 3/1\n"), Either);
        jail.put("m.mtl", format!("newmtl a\nKd {number} 0 0\nNs {number}\nd {number}\nNi {number}\n"));
        jail.try_file("m.obj", format!("mtllib m.mtl\nusemtl a\n{TRIANGLE}"), Either);
    }
    jail.close();
}

#[test]
fn long_and_large() {
    let mut jail = Jail::new();
    let many = 100_000;
    let circle: String = (0..many)
        .map(|i| f64::from(i) / f64::from(many) * std::f64::consts::TAU)
        .map(|a| format!("v {} {} 0\n", a.cos(), a.sin()))
        .collect();
    let all: String = (1..=many).map(|i| format!(" {i}")).collect();
    jail.try_file("round.obj", format!("{circle}f{all}\n"), Clean);
    let comb: String = (0..many).map(|i| format!("v {i} {} 0\n", i % 2 * (many - i))).collect();
    jail.try_file("comb.obj", format!("{comb}f{all}\n"), Either);
    jail.try_file("fan.obj", format!("{TRIANGLE}f{}\n", " 1 2 3".repeat(many as usize)), Either);
    jail.try_file("line.obj", format!("{TRIANGLE}#{}", "x".repeat(20 << 20)), Either);
    jail.try_file("token.obj", format!("v {}\n{TRIANGLE}", "1".repeat(10 << 20)), Either);
    jail.try_file("joined.obj", "\\\n".repeat(1 << 20), Either);
    jail.try_file(
        "keywords.obj",
        (0..many).map(|i| format!("k{i} 1\n")).collect::<String>() + TRIANGLE,
        Either,
    );
    let groups: String = (0..many).map(|i| format!("g a{i}\nusemtl m{i}\ns {i}\nf 1 2 3\n")).collect();
    jail.try_file("groups.obj", format!("{TRIANGLE}{groups}"), Either);
    jail.try_file("libraries.obj", format!("mtllib{}\n{TRIANGLE}", " a.mtl".repeat(many as usize)), Either);
    let faces = "f 1 2 3\n".repeat(2 * many as usize);
    jail.try_file("smooth.obj", format!("{TRIANGLE}s 1\n{faces}"), Either);
    jail.close();
}

#[test]
fn references_stay_in_the_folder() {
    let mut jail = Jail::new();
    let secret = "newmtl secret\nKd 1 0 0\n";
    jail.put("secret.mtl", secret);
    jail.put("secret.png", secret);
    for name in [
        "../secret.mtl",
        "..\\secret.mtl",
        "/etc/passwd",
        "/dev/zero",
        "file:///etc/passwd",
        ".",
        "http://localhost/a.mtl",
    ] {
        jail.try_file("inner/library.obj", format!("mtllib {name}\nusemtl secret\n{TRIANGLE}"), Warned);
        jail.put("inner/map.mtl", format!("newmtl a\nmap_Kd {name}\n"));
        jail.try_file("inner/map.obj", format!("mtllib map.mtl\nusemtl a\n{TRIANGLE}"), Warned);
    }
    jail.try_file("inner/self.obj", format!("mtllib self.obj\nusemtl a\n{TRIANGLE}"), Either);
    jail.close();
}

#[test]
fn text_that_is_none() {
    let mut jail = Jail::new();
    for bytes in [&b""[..], b"\0\0\0\0", b"\xff\xfev\0 \0", b"\xef\xbb\xbf", b"v", b"f 1 2 3", b"#"] {
        jail.try_file("text.obj", bytes, Refused);
    }
    jail.try_file("text.obj", b"f", Either);
    jail.close();
}
