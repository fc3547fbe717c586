//! A folder with a scene of several files, of each of which there are many others.

use std::fs;

use crate::bench::{Bench, SCENE};

const BOX: &str = "\
mtllib box.mtl\nusemtl clay
v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1
vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1
f 4/1 3/2 2/3 1/4\nf 5/1 6/2 7/3 8/4\nf 1/1 2/2 6/3 5/4\nf 2/1 3/2 7/3 6/4\nf 3/1 4/2 8/3 7/4\nf 4/1 1/2 5/3 8/4\n";

/// A triangle whose corners are in a buffer beside it.
const LEAF: &str = r#"{
  "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": [{ "name": "leaf", "mesh": 0 }],
  "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
  "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                  "min": [-2, -2, -2], "max": [2, 2, 2] }],
  "bufferViews": [{ "buffer": 0, "byteLength": 36 }],
  "buffers": [{ "byteLength": 36, "uri": "leaf.bin" }]
}"#;

const STAGE: &str = "#usda 1.0\n(\n    subLayers = [@lid.usda@]\n)\n";

/// The files that can be another, and what number `n` of each holds.
pub(super) type Variant = (&'static str, fn(u32) -> Vec<u8>);

const FILES: [Variant; 5] = [
    ("studio/scene.toml", |n| light(n).into_bytes()),
    ("studio/box.mtl", |n| material(n).into_bytes()),
    ("studio/wood.ppm.png", picture),
    ("studio/box.obj", |n| shape(n).into_bytes()),
    ("studio/leaf.bin", buffer),
];

/// USD is read by a Python that tests do not set up.
const USD: Variant = ("studio/lid.usda", |n| lid(n).into_bytes());

/// A folder with a scene of several files.
pub(super) fn studio() -> Bench {
    let bench = Bench::new();
    bench.write("studio/leaf.gltf", LEAF);
    for (name, content) in FILES {
        bench.write(name, "");
        fs::write(bench.path(name), content(0)).unwrap();
    }
    bench
}

/// The same with a USD stage among its assets, where those can be read, and all files of it that can be another.
pub(super) fn studio_of_all_formats() -> (Bench, Vec<Variant>) {
    let bench = studio();
    let mut files = FILES.to_vec();
    if std::env::var_os("AJAR_USD_PYTHON").is_none_or(|python| python.is_empty()) {
        println!("skipped: USD layers, for AJAR_USD_PYTHON is not set");
    } else {
        bench.write("studio/stage.usda", STAGE);
        bench.write(USD.0, lid(0));
        files[0].1 = |n| format!("[[import]]\nfile = \"stage.usda\"\n{}", light(n)).into_bytes();
        fs::write(bench.path(files[0].0), files[0].1(0)).unwrap();
        files.push(USD);
    }
    (bench, files)
}

/// An MTL file.
fn material(number: u32) -> String {
    format!("newmtl clay\nKd 1 1 0.{:03}\nmap_Kd wood.ppm.png\n", number % 1000)
}

/// A PNG of one pixel.
pub(super) fn picture(number: u32) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 1, 1);
    encoder.set_color(png::ColorType::Rgb);
    let code = number.to_le_bytes();
    encoder.write_header().unwrap().write_image_data(&[200, code[0], code[1]]).unwrap();
    bytes
}

/// The scene with another light.
pub(super) fn light(number: u32) -> String {
    let scene = format!("[[import]]\nfile = \"leaf.gltf\"\n{SCENE}");
    scene.replace("illuminance = 10", &format!("illuminance = {}", 10.0 + f64::from(number) / 16.0))
}

/// The box.
fn shape(number: u32) -> String {
    BOX.replace("v 1 1 1", &format!("v 1 {} 1", 1.0 + f64::from(number) / 1024.0))
}

/// Corners of the leaf.
fn buffer(number: u32) -> Vec<u8> {
    let tip = 0.5 + number as f32 / 1024.0;
    let corners = [[1.0_f32, -1.0, 1.5], [2.0, -1.0, 1.5], [1.0, tip, 1.5]];
    corners.iter().flatten().flat_map(|x| x.to_le_bytes()).collect()
}

/// A layer with a mesh over the box.
fn lid(number: u32) -> String {
    let height = 1.1 + f64::from(number) / 1024.0;
    format!(
        "#usda 1.0\ndef Mesh \"Lid\" {{
    int[] faceVertexCounts = [3]
    int[] faceVertexIndices = [0, 1, 2]
    point3f[] points = [(-1, {height}, -1), (-1, {height}, 1), (1, {height}, -1)]
    bool doubleSided = 1
}}\n"
    )
}
