//! Ajar scenes, as JSON alone and in their container.

use glam::Vec3;
use serde_json::{Value, json};

/// All seeds.
pub fn all() -> Vec<Vec<u8>> {
    vec![
        everything(json!({"positions": CORNERS, "triangles": [[0, 1, 2], [2, 1, 3]]}))
            .to_string()
            .into_bytes(),
        contained(),
        polygons().to_string().into_bytes(),
    ]
}

const CORNERS: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.5]];

/// A scene with one of everything around a mesh.
fn everything(mesh: Value) -> Value {
    let material = json!({
        "name": "red", "base_color": {"value": [0.8, 0.1, 0.1], "texture": {"texture": 0, "channel": "r"}},
        "roughness": 0.25, "metallic": 0.5, "coat": 0.5, "normal_map": {"texture": 0, "scale": 0.5},
        "opacity": {"value": 0.75, "texture": null}, "alpha_mode": {"mask": 0.5}, "anisotropy": 0.5,
    });
    json!({
        "ajar": 1,
        "roots": [0, 3],
        "nodes": [
            {"name": "leaf", "meshes": [0], "children": [1, 2], "transform": [1,0,0, 0,1,0, 0,0,1, 0,0.5,0]},
            {"name": "twig", "meshes": [0], "material": 1, "transform": [2,0,0, 0,2,0, 0,0,2, 0,0,-2]},
            {"name": "lamp", "light": 0, "transform": [1,0,0, 0,1,0, 0,0,1, 0,3,0]},
            {"name": "eye", "camera": 0, "light": 1, "transform": [1,0,0, 0,1,0, 0,0,1, 0,0,5]},
        ],
        "meshes": [mesh],
        "materials": [material, {"name": "glass", "transmission": 1, "ior": 1.5, "attenuation_distance": 0.5}],
        "textures": [{"image": 0, "color_space": "srgb", "wrap_u": "mirror", "uv_set": 0, "scale": [1,1,1,1]}],
        "images": [{"name": "map", "file": "map.png"}],
        "lights": [
            {"kind": {"sphere": {"radiance": 100, "radius": 0.1}}},
            {"kind": {"environment": {"radiance": 1, "texture": 0}}, "color": [0.5, 0.75, 1]},
        ],
        "cameras": [{
            "name": "main", "aspect": 1.5, "exposure": 2,
            "projection": {"perspective": {"yfov": 0.7, "lens_radius": 0.01, "focus_distance": 3, "shift": [0.1, 0]}},
        }],
        "render": {"camera": "main", "size": [32, 24]},
    })
}

fn contained() -> Vec<u8> {
    let mut binary = Vec::new();
    let mut array = |numbers: &[f32], width: usize| {
        let offset = binary.len();
        binary.extend(numbers.iter().flat_map(|x| x.to_le_bytes()));
        json!({"offset": offset, "count": numbers.len() / width})
    };
    let positions = array(CORNERS.as_flattened(), 3);
    let normals = array(&[Vec3::Z.to_array(); 4].concat(), 3);
    let tangents = array(&[[1.0, 0.0, 0.0, -1.0]; 4].concat(), 4);
    let uvs = array(&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0], 2);
    let colors = array(&[0.5; 16], 4);
    let triangles = json!({"offset": binary.len(), "count": 2});
    binary.extend([0_u32, 1, 2, 2, 1, 3].iter().flat_map(|i| i.to_le_bytes()));
    let picture = super::text::picture();
    let image = json!([{"name": "inside", "bytes": {"offset": binary.len(), "count": picture.len()}}]);
    binary.extend(picture);
    let mut scene = everything(json!({
        "name": "two", "positions": positions, "triangles": triangles, "normals": normals, "tangents": tangents,
        "uvs": [uvs.clone(), uvs], "colors": colors, "material": 0,
    }));
    scene["images"] = image;
    super::container(*b"AJAR", scene.to_string().into_bytes(), binary)
}

/// Two squares and a pentagon with everything that polygons may have.
fn polygons() -> Value {
    everything(json!({
        "positions": [[0,0,0], [1,0,0], [2,0,0.5], [0,1,0], [1,1,0], [2,1,0], [1,2,0.5]],
        "faces": [4, 4, 4],
        "corners": [0, 1, 4, 3, 1, 2, 5, 4, 4, 5, 6, 3],
        "holes": [1],
        "parts": [{"material": 1, "faces": [2]}],
        "uvs": [
            {"values": [[0,0], [1,0], [1,1], [0,1]], "indices": [0,1,2,3, 0,1,2,3, 0,1,2,3]},
            {"values": [[0,0], [0.5,0], [1,0]], "per": "face"},
        ],
        "colors": {"values": [[1,1,1,1]], "per": "mesh"},
        "normals": {"values": [[0,0,1], [0,0,1], [0,0,1], [0,0,1], [0,0,1], [0,0,1], [0,0,1]], "per": "position"},
        "subdivision": {
            "levels": 2, "boundary": "edges", "linear": "boundary", "creases": [[1, 4]], "crease_sharpness": [1.5],
            "sharp_positions": [0], "position_sharpness": [10],
        },
        "material": 0,
    }))
}
