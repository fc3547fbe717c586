//! A sphere with a material of one's own, as a file of each format.

use std::{f32::consts::PI, fmt::Write, fs, path::Path};

use base64::{Engine, prelude::BASE64_STANDARD};
use serde_json::{Value, json};

/// A picture of 2 × 2 texels: red, green, blue and white.
const PNG: &str =
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAIAAAD91JpzAAAAEklEQVR4nGP4z8DAAMIM/4EAAB/uBfsL2WiLAAAAAElFTkSuQmCC";

/// `map.png` in `folder`, to which materials can refer.
pub fn write_picture(folder: &Path) {
    fs::write(folder.join("map.png"), BASE64_STANDARD.decode(PNG).unwrap()).unwrap();
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

/// `a.gltf` in `folder`, with this material.
pub fn write_gltf(folder: &Path, material: &Value) {
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

/// `a.obj` with lines of `a.mtl`.
pub fn write_obj(folder: &Path, material: &str) {
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

/// `a.usda` with the `inputs` of a surface shader, to which `Map` and `Picture` can be connected.
pub fn write_usd(folder: &Path, output: &str, shader: &str, inputs: &str) {
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
    def Shader "Picture"
    {{
        uniform token info:id = "ND_image_color3"
        asset inputs:file = @map.png@ (
            colorSpace = "srgb_texture"
        )
        color3f outputs:out
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
