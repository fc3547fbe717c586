//! One model underneath: the same sphere of the same material through glTF, OBJ, UsdPreviewSurface and Standard Surface is
//! the same picture.
//!
//! USD takes part where `AJAR_USD_PYTHON` names a Python that reads it.

use std::{f32::consts::PI, fmt::Write, fs, path::Path};

use ajar_integrators::path::PathTracer;
use base64::{Engine, prelude::BASE64_STANDARD};
use serde_json::{Value, json};

use crate::{LIMIT, blocks::Blocks, open};

pub fn reads_usd() -> bool {
    std::env::var_os("AJAR_USD_PYTHON").is_some_and(|python| !python.is_empty())
}

/// A picture of 2 × 2 texels: red, green, blue and white.
const PNG: &str =
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAIAAAD91JpzAAAAEklEQVR4nGP4z8DAAMIM/4EAAB/uBfsL2WiLAAAAAElFTkSuQmCC";

/// A window before a dim sky, so that highlights have an edge.
const LIGHTS: &str = r#"
[[light]]
type = "rect"
position = [2, 3, 2]
target = [0, 0, 0]
width = 2
height = 2
radiance = 20
[[light]]
type = "environment"
radiance = 0.2
"#;

/// One material in the words of each format; nothing where a format cannot say it.
struct Look {
    gltf: Value,
    mtl: &'static str,
    preview: &'static str,
    standard: &'static str,
}

const RINGS: u32 = 12;
const SECTORS: u32 = 24;

type Rows<T, const N: usize> = Vec<[T; N]>;

/// A sphere of radius 1: positions, which are the normals too, texture coordinates from the bottom left, triangles.
fn sphere() -> (Rows<f32, 3>, Rows<f32, 2>, Rows<u32, 3>) {
    let (mut points, mut uvs, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
    for (i, j) in (0..=RINGS).flat_map(|i| (0..=SECTORS).map(move |j| (i, j))) {
        let [u, v] = [j as f32 / SECTORS as f32, i as f32 / RINGS as f32];
        let ((sin, cos), (y, x)) = ((PI * v).sin_cos(), (2.0 * PI * u).sin_cos());
        points.push([sin * x, -cos, -sin * y]);
        uvs.push([u, v]);
        if i < RINGS && j < SECTORS {
            let [a, b] = [i * (SECTORS + 1) + j, (i + 1) * (SECTORS + 1) + j];
            triangles.extend([[a, a + 1, b + 1], [a, b + 1, b]]);
        }
    }
    // The poles' triangles have no area.
    triangles.retain(|t| {
        let [a, b, c] = t.map(|i| points[i as usize]);
        let near = |a: [f32; 3], b: [f32; 3]| (0..3).all(|k| (a[k] - b[k]).abs() < 1e-6);
        !near(a, b) && !near(b, c) && !near(c, a)
    });
    (points, uvs, triangles)
}

fn write_gltf(folder: &Path, material: &Value) {
    let (points, uvs, triangles) = sphere();
    let flipped: Vec<_> = uvs.iter().map(|[u, v]| [*u, 1.0 - v]).collect();
    let floats = |values: &[f32]| values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
    let parts = [
        floats(points.as_flattened()),
        floats(flipped.as_flattened()),
        triangles.as_flattened().iter().flat_map(|i| i.to_le_bytes()).collect(),
    ];
    let mut start = 0;
    let views: Vec<_> = parts
        .iter()
        .map(|part| {
            let view = json!({"buffer": 0, "byteOffset": start, "byteLength": part.len()});
            start += part.len();
            view
        })
        .collect();
    let data = format!("data:;base64,{}", BASE64_STANDARD.encode(parts.concat()));
    let document = json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{
            "attributes": {"POSITION": 0, "NORMAL": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0,
        }]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": points.len()},
            {"bufferView": 1, "componentType": 5126, "type": "VEC2", "count": uvs.len()},
            {"bufferView": 2, "componentType": 5125, "type": "SCALAR", "count": 3 * triangles.len()},
        ],
        "bufferViews": views, "buffers": [{"byteLength": start, "uri": data}],
        "materials": [material], "textures": [{"source": 0}], "images": [{"uri": "map.png"}],
    });
    fs::write(folder.join("a.gltf"), document.to_string()).unwrap();
}

fn write_obj(folder: &Path, material: &str) {
    let (points, uvs, triangles) = sphere();
    let mut text = "mtllib a.mtl\nusemtl look\n".to_string();
    points.iter().for_each(|[x, y, z]| write!(text, "v {x} {y} {z}\nvn {x} {y} {z}\n").unwrap());
    uvs.iter().for_each(|[u, v]| writeln!(text, "vt {u} {v}").unwrap());
    for triangle in triangles {
        let [a, b, c] = triangle.map(|i| i + 1);
        writeln!(text, "f {a}/{a}/{a} {b}/{b}/{b} {c}/{c}/{c}").unwrap();
    }
    fs::write(folder.join("a.obj"), text).unwrap();
    fs::write(folder.join("a.mtl"), format!("newmtl look\n{material}\n")).unwrap();
}

fn write_usd(folder: &Path, output: &str, shader: &str, inputs: &str) {
    let (points, uvs, triangles) = sphere();
    let list = |values: Vec<String>| values.join(", ");
    let points = list(points.iter().map(|[x, y, z]| format!("({x}, {y}, {z})")).collect());
    let uvs = list(uvs.iter().map(|[u, v]| format!("({u}, {v})")).collect());
    let counts = list(triangles.iter().map(|_| "3".to_string()).collect());
    let corners = list(triangles.as_flattened().iter().map(u32::to_string).collect());
    let text = format!(
        r#"#usda 1.0
(
    metersPerUnit = 1
    upAxis = "Y"
    defaultPrim = "Ball"
)
def Mesh "Ball" (
    prepend apiSchemas = ["MaterialBindingAPI"]
)
{{
    rel material:binding = </Look>
    uniform token subdivisionScheme = "none"
    point3f[] points = [{points}]
    normal3f[] normals = [{points}] (
        interpolation = "vertex"
    )
    texCoord2f[] primvars:st = [{uvs}] (
        interpolation = "vertex"
    )
    int[] faceVertexCounts = [{counts}]
    int[] faceVertexIndices = [{corners}]
}}
def Material "Look"
{{
    token outputs:{output}.connect = </Look/Surface.outputs:out>
    def Shader "Surface"
    {{
        uniform token info:id = "{shader}"
        token outputs:out
{inputs}
    }}
    def Shader "Map"
    {{
        uniform token info:id = "UsdUVTexture"
        asset inputs:file = @map.png@
        token inputs:sourceColorSpace = "sRGB"
        token inputs:wrapS = "repeat"
        token inputs:wrapT = "repeat"
        float2 inputs:st.connect = </Look/Coordinates.outputs:result>
        float3 outputs:rgb
    }}
    def Shader "Coordinates"
    {{
        uniform token info:id = "UsdPrimvarReader_float2"
        string inputs:varname = "st"
        float2 outputs:result
    }}
}}
"#
    );
    fs::write(folder.join("a.usda"), text).unwrap();
}

/// The pictures of a look, with the formats' names; the first is that of glTF.
fn pictures(look: &Look) -> Vec<(&'static str, Blocks)> {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("map.png"), BASE64_STANDARD.decode(PNG).unwrap()).unwrap();
    let render = |file: &str, seed| {
        let scene = folder.join("scene.toml");
        fs::write(&scene, format!("[[import]]\nfile = \"{file}\"\n{LIGHTS}")).unwrap();
        Blocks::new(&open(&scene), &PathTracer, seed, 32)
    };
    write_gltf(folder, &look.gltf);
    write_obj(folder, look.mtl);
    let mut found = vec![("glTF", render("a.gltf", 1)), ("OBJ", render("a.obj", 2))];
    if !reads_usd() {
        println!("skipped: USD, for AJAR_USD_PYTHON is not set");
        return found;
    }
    if !look.preview.is_empty() {
        write_usd(folder, "surface", "UsdPreviewSurface", look.preview);
        found.push(("UsdPreviewSurface", render("a.usda", 3)));
    }
    if !look.standard.is_empty() {
        write_usd(folder, "mtlx:surface", "ND_standard_surface_surfaceshader", look.standard);
        found.push(("Standard Surface", render("a.usda", 4)));
    }
    found
}

fn same(look: &Look) {
    let mut all = pictures(look).into_iter();
    let (_, first) = all.next().unwrap();
    for (name, other) in all {
        let (worst, error) = first.compare(&other);
        println!("{name}: largest z {worst:.2}, typical error {:.2} %", error * 100.0);
        assert!(worst < LIMIT, "{name} is not as glTF: largest z {worst:.2}");
    }
}

fn plastic(roughness: f64) -> Value {
    let factors = json!({
        "baseColorFactor": [0.8, 0.2, 0.1, 1], "metallicFactor": 0, "roughnessFactor": roughness,
    });
    json!({"pbrMetallicRoughness": factors, "doubleSided": true})
}

const PLASTIC: Look = Look {
    gltf: Value::Null,
    mtl: "Kd .8 .2 .1\nKs .5 .5 .5\nPr .4\nPm 0\nillum 2",
    preview: "color3f inputs:diffuseColor = (0.8, 0.2, 0.1)\nfloat inputs:roughness = 0.4",
    standard: "color3f inputs:base_color = (0.8, 0.2, 0.1)\nfloat inputs:base = 1\n\
               float inputs:specular_roughness = 0.4",
};

#[test]
fn plastic_is_the_same_and_the_comparison_sees_other_plastic() {
    same(&Look { gltf: plastic(0.4), ..PLASTIC });
    let all = pictures(&Look { gltf: plastic(0.3), ..PLASTIC });
    assert!(all[0].1.compare(&all[1].1).0 > LIMIT);
}

#[test]
fn metal_is_the_same() {
    let factors = json!({"baseColorFactor": [0.9, 0.6, 0.3, 1], "roughnessFactor": 0.3});
    same(&Look {
        gltf: json!({"pbrMetallicRoughness": factors, "doubleSided": true}),
        mtl: "Kd .9 .6 .3\nKs .5 .5 .5\nPr .3\nPm 1\nillum 2",
        preview: "color3f inputs:diffuseColor = (0.9, 0.6, 0.3)\nfloat inputs:roughness = 0.3\n\
                  float inputs:metallic = 1",
        standard: "color3f inputs:base_color = (0.9, 0.6, 0.3)\nfloat inputs:base = 1\n\
                   float inputs:metalness = 1\nfloat inputs:specular_roughness = 0.3",
    });
}

#[test]
fn rough_glass_is_the_same() {
    let factors = json!({"metallicFactor": 0, "roughnessFactor": 0.3});
    let glass = json!({
        "KHR_materials_transmission": {"transmissionFactor": 1},
        "KHR_materials_volume": {"thicknessFactor": 1},
    });
    same(&Look {
        gltf: json!({"pbrMetallicRoughness": factors, "doubleSided": true, "extensions": glass}),
        mtl: "Kd 1 1 1\nKs .5 .5 .5\nTf 1 1 1\nNi 1.5\nPr .3\nillum 7",
        preview: "",
        standard: "float inputs:transmission = 1\nfloat inputs:base = 1\n\
                   float inputs:specular_roughness = 0.3\nfloat inputs:specular_IOR = 1.5",
    });
}

#[test]
fn coated_plastic_is_the_same() {
    let mut gltf = plastic(0.4);
    gltf["extensions"] =
        json!({"KHR_materials_clearcoat": {"clearcoatFactor": 1, "clearcoatRoughnessFactor": 0.1}});
    same(&Look {
        gltf,
        mtl: "Kd .8 .2 .1\nKs .5 .5 .5\nPr .4\nPm 0\nPc 1\nPcr .1\nillum 2",
        preview: "color3f inputs:diffuseColor = (0.8, 0.2, 0.1)\nfloat inputs:roughness = 0.4\n\
                  float inputs:clearcoat = 1\nfloat inputs:clearcoatRoughness = 0.1",
        standard: "color3f inputs:base_color = (0.8, 0.2, 0.1)\nfloat inputs:base = 1\n\
                   float inputs:specular_roughness = 0.4\nfloat inputs:coat = 1\n\
                   float inputs:coat_roughness = 0.1\nfloat inputs:coat_IOR = 1.5",
    });
}

#[test]
fn emission_is_the_same() {
    let mut gltf = plastic(0.4);
    gltf["emissiveFactor"] = json!([1, 0.5, 0.25]);
    gltf["extensions"] = json!({"KHR_materials_emissive_strength": {"emissiveStrength": 2}});
    same(&Look {
        gltf,
        mtl: "Kd .8 .2 .1\nKs .5 .5 .5\nPr .4\nPm 0\nKe 2 1 .5\nillum 2",
        preview: "color3f inputs:diffuseColor = (0.8, 0.2, 0.1)\nfloat inputs:roughness = 0.4\n\
                  color3f inputs:emissiveColor = (2, 1, 0.5)",
        standard: "color3f inputs:base_color = (0.8, 0.2, 0.1)\nfloat inputs:base = 1\n\
                   float inputs:specular_roughness = 0.4\nfloat inputs:emission = 2\n\
                   color3f inputs:emission_color = (1, 0.5, 0.25)",
    });
}

#[test]
fn textures_are_the_same() {
    let factors = json!({"baseColorTexture": {"index": 0}, "metallicFactor": 0, "roughnessFactor": 0.4});
    same(&Look {
        gltf: json!({"pbrMetallicRoughness": factors, "doubleSided": true}),
        mtl: "Kd 1 1 1\nmap_Kd map.png\nKs .5 .5 .5\nPr .4\nPm 0\nillum 2",
        preview: "color3f inputs:diffuseColor.connect = </Look/Map.outputs:rgb>\nfloat inputs:roughness = 0.4",
        standard: "",
    });
}
