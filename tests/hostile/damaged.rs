//! Sound files with bits flipped, bytes replaced, and ends cut off.

use crate::{
    gltf::Asset,
    images::{ONE_PIXEL, png},
    jail::{Fate::Either, Jail},
};

/// Damaged copies of each file.
const COPIES: u64 = 40;

/// Marsaglia's xorshift64: the same damage in every run.
struct Dice(u64);

impl Dice {
    fn below(&mut self, limit: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % limit as u64) as usize
    }
}

fn damage(sound: &[u8], dice: &mut Dice) -> Vec<u8> {
    let mut bytes = sound.to_vec();
    match dice.below(4) {
        0 => bytes.truncate(dice.below(sound.len())),
        1 => {
            let (from, to) = (dice.below(sound.len()), dice.below(sound.len()));
            bytes.drain(from.min(to)..from.max(to));
        }
        2 => {
            for _ in 0..1 + dice.below(4) {
                bytes[dice.below(sound.len())] ^= 1 << dice.below(8);
            }
        }
        _ => {
            for _ in 0..1 + dice.below(4) {
                bytes[dice.below(sound.len())] = [b'9', b'-', b'"', 0, 0xff, b'e'][dice.below(6)];
            }
        }
    }
    bytes
}

fn try_all(file: &str, sound: &[u8], open: Option<&str>) {
    let mut jail = Jail::new();
    jail.put("map.png", png(1, 1, ONE_PIXEL));
    jail.put("library.mtl", LIBRARY);
    jail.put("box.obj", OBJ);
    for copy in 1..=COPIES {
        let bytes = damage(sound, &mut Dice(copy.wrapping_mul(0x9e37_79b9_7f4a_7c15)));
        match open {
            None => jail.try_file(&format!("{copy}.{file}"), bytes, Either),
            Some(opened) => {
                jail.put(file, bytes);
                jail.try_path(&jail.path(opened), Either);
            }
        }
    }
    jail.close();
}

const LIBRARY: &str =
    "newmtl a\nKd 0.5 0.5 0.5\nNs 100\nmap_Kd -s 2 2 2 map.png\nnewmtl b\nPr 0.5\nPm 1\nd 0.5\n";

const OBJ: &str =
    "mtllib library.mtl\no one\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nusemtl a\ns 1
f 1/1/1 2/1/1 3/1/1 4/1/1\ng two\nusemtl b\nf -1//-1 -2//-1 -3//-1\n";

fn textured() -> Asset {
    let mut asset = Asset::new();
    asset.more = r#","images":[{"uri":"map.png"}],"textures":[{"source":0}],
"materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0},"metallicFactor":0.5},"normalTexture":{"index":0}}],
"cameras":[{"type":"perspective","perspective":{"yfov":1,"znear":0.1}}]"#
        .into();
    asset
}

#[test]
fn gltf() {
    try_all("gltf", textured().text().as_bytes(), None);
}

#[test]
fn glb() {
    let mut asset = textured();
    asset.buffers = r#"{"byteLength":36}"#.into();
    let mut json = asset.text().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let binary: Vec<u8> =
        [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].into_iter().flat_map(f32::to_le_bytes).collect();
    let length = |n: usize| (n as u32).to_le_bytes();
    let file = [
        &b"glTF\x02\0\0\0"[..],
        &length(12 + 8 + json.len() + 8 + binary.len()),
        &length(json.len()),
        b"JSON",
        &json,
        &length(binary.len()),
        b"BIN\0",
        &binary,
    ];
    try_all("glb", &file.concat(), None);
}

#[test]
fn obj() {
    try_all("obj", OBJ.as_bytes(), None);
}

#[test]
fn mtl() {
    try_all("library.mtl", LIBRARY.as_bytes(), Some("box.obj"));
}

#[test]
fn scene() {
    let scene = r#"
[[import]]
file = "box.obj"
scale = 2.5
rotate = [0, 30, 0]

[[camera]]
position = [3, 2, 4]
target = [0, 0, 0]
yfov = 30

[[light]]
type = "environment"
texture = "map.png"
radiance = 10

[material.a]
roughness = 0.25

[render]
size = [24, 16]
time = "10m"
noise = "2%"
"#;
    try_all("toml", scene.as_bytes(), None);
}

#[test]
fn image() {
    try_all("map.png", &png(1, 1, ONE_PIXEL), Some("box.obj"));
}
