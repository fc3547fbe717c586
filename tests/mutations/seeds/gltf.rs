//! glTF documents, each for text and container.

use serde_json::json;

#[expect(dead_code, reason = "the importer's own tests need more of it")]
#[path = "../../../importers/tests/gltf/build.rs"]
mod build;

use build::{Asset, BYTE, FLOAT, SHORT, UNSIGNED_BYTE, UNSIGNED_INT, UNSIGNED_SHORT, data_uri, floats};

const SQUARE: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.5]];

/// All seeds.
pub fn all() -> Vec<Asset> {
    vec![attributes(), materials(), moving(), packed()]
}

/// All vertex attributes in different component types, strips and fans, cameras and lights.
fn attributes() -> Asset {
    let mut asset = Asset::new();
    asset.positions(&SQUARE);
    let indices: Vec<u8> = [0_u16, 1, 2, 2, 1, 3].iter().flat_map(|i| i.to_le_bytes()).collect();
    let indices = asset.accessor(UNSIGNED_SHORT, "SCALAR", 6, &indices, json!({}));
    asset.primitive(json!({"indices": indices, "mode": 4}));
    let normals: Vec<u8> = [[0_i8, 0, 127, 0]; 4].concat().iter().map(|&n| n as u8).collect();
    let view = asset.view(&normals, json!({"byteStride": 4}));
    let normals =
        json!({"bufferView": view, "componentType": BYTE, "normalized": true, "type": "VEC3", "count": 4});
    let normals = asset.push("accessors", normals);
    let tangents = asset.float_accessor("VEC4", 4, &[1.0, 0.0, 0.0, -1.0].repeat(4));
    let uvs: Vec<u8> =
        [0_u16, 0, 65535, 0, 0, 65535, 65535, 65535].iter().flat_map(|i| i.to_le_bytes()).collect();
    let uvs = asset.accessor(UNSIGNED_SHORT, "VEC2", 4, &uvs, json!({"normalized": true}));
    let colors = asset.accessor(UNSIGNED_BYTE, "VEC4", 4, &[200; 16], json!({"normalized": true}));
    for (name, accessor) in [
        ("NORMAL", normals),
        ("TANGENT", tangents),
        ("TEXCOORD_0", uvs),
        ("TEXCOORD_1", uvs),
        ("COLOR_0", colors),
    ] {
        asset.attribute(name, accessor);
    }
    let places = asset.view(&[1, 0, 3, 0], json!({}));
    let values = asset.view(&floats(&[0.5, 0.0, 0.0, 1.0, 1.0, 1.0]), json!({}));
    let sparse = json!({"componentType": FLOAT, "type": "VEC3", "count": 4, "sparse": {"count": 2,
        "indices": {"bufferView": places, "componentType": UNSIGNED_SHORT}, "values": {"bufferView": values}}});
    let sparse = asset.push("accessors", sparse);
    for mode in [5, 6, 1] {
        let primitive = json!({"attributes": {"POSITION": sparse}, "mode": mode});
        asset.json["meshes"][0]["primitives"].as_array_mut().unwrap().push(primitive);
    }
    asset.json["cameras"] = json!([
        {"type": "perspective", "name": "eye", "perspective": {"yfov": 0.7, "aspectRatio": 1.5, "znear": 0.1}},
        {"type": "orthographic", "orthographic": {"xmag": 2, "ymag": 2, "znear": 0, "zfar": 9}},
    ]);
    asset.json["extensionsUsed"] = json!(["KHR_lights_punctual", "KHR_node_visibility", "ACME_paint"]);
    asset.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "spot", "intensity": 100, "color": [1, 0.5, 0.25], "spot": {"innerConeAngle": 0.1, "outerConeAngle": 0.5}},
        {"type": "directional", "intensity": 2}, {"type": "point", "range": 5},
    ]}});
    let lamp = |index: u32| json!({"KHR_lights_punctual": {"light": index}});
    for node in [
        json!({"camera": 0, "translation": [0, 0, 5], "children": [2, 3]}),
        json!({"camera": 1, "rotation": [0, 0.6, 0, 0.8], "extensions": lamp(0)}),
        json!({"matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 1,2,3,1], "extensions": lamp(1)}),
        json!({"scale": [1, -2, 1], "mesh": 0, "extensions": {"KHR_node_visibility": {"visible": false}}}),
    ] {
        asset.push("nodes", node);
    }
    asset.json["scene"] = json!(0);
    asset.json["scenes"] = json!([{"nodes": [0, 1, 4]}, {"nodes": [4]}]);
    asset
}

/// Textures and material extensions.
fn materials() -> Asset {
    let mut asset = Asset::triangle(json!({"material": 0}));
    let uvs = asset.float_accessor("VEC2", 2, &[0.0, 0.0, 2.0, 0.0, 0.0, 2.0]);
    asset.attribute("TEXCOORD_0", uvs);
    let picture = super::text::picture();
    let view = asset.view(&picture, json!({}));
    asset.json["images"] = json!([{"uri": data_uri(&picture)}, {"bufferView": view, "mimeType": "image/png"},
        {"uri": "map.png"}]);
    asset.json["samplers"] = json!([{"wrapS": 33071, "wrapT": 33648, "magFilter": 9728, "minFilter": 9987}]);
    asset.json["textures"] = json!([{"source": 0, "sampler": 0}, {"source": 1},
        {"source": 0, "extensions": {"EXT_texture_webp": {"source": 2}}}]);
    let turned = json!({"KHR_texture_transform": {"offset": [0.5, 0], "rotation": 0.3, "scale": [2, 2], "texCoord": 0}});
    let texture = |index: u32| json!({"index": index});
    asset.json["materials"] = json!([
        {
            "name": "all", "alphaMode": "MASK", "alphaCutoff": 0.25, "doubleSided": true, "emissiveFactor": [1, 0.5, 0],
            "pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 0.5, 0.75], "metallicFactor": 0.5, "roughnessFactor": 0.25,
                "baseColorTexture": {"index": 0, "extensions": turned}, "metallicRoughnessTexture": texture(1)},
            "normalTexture": {"index": 1, "scale": 0.5}, "emissiveTexture": texture(2),
            "occlusionTexture": {"index": 0, "strength": 0.5},
            "extensions": {
                "KHR_materials_clearcoat": {"clearcoatFactor": 0.5, "clearcoatRoughnessTexture": texture(0)},
                "KHR_materials_emissive_strength": {"emissiveStrength": 5},
                "KHR_materials_ior": {"ior": 1.4},
                "KHR_materials_specular": {"specularFactor": 0.5, "specularColorFactor": [1, 0.5, 2]},
                "KHR_materials_transmission": {"transmissionFactor": 0.5, "transmissionTexture": texture(1)},
                "KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 0.5, "attenuationColor": [1, 0.5, 1]},
                "KHR_materials_anisotropy": {"anisotropyStrength": 0.5, "anisotropyRotation": 1},
                "KHR_materials_sheen": {"sheenColorFactor": [1, 1, 1], "sheenRoughnessFactor": 0.5},
                "KHR_materials_iridescence": {"iridescenceFactor": 1, "iridescenceThicknessMaximum": 500},
                "KHR_materials_dispersion": {"dispersion": 0.5},
                "KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": 0.5},
            },
        },
        {"extensions": {"KHR_materials_unlit": {}}},
        {"extensions": {"KHR_materials_pbrSpecularGlossiness": {"diffuseFactor": [1, 0.5, 0.5, 1],
            "specularFactor": [0.5, 0.5, 0.5], "glossinessFactor": 0.5, "diffuseTexture": texture(0)}}},
    ]);
    asset.json["extensions"] =
        json!({"KHR_materials_variants": {"variants": [{"name": "A"}, {"name": "B"}]}});
    let mapping = json!({"KHR_materials_variants": {"mappings": [{"material": 1, "variants": [0]}, {"material": 2, "variants": [1]}]}});
    asset.json["meshes"][0]["primitives"][0]["extensions"] = mapping;
    asset
}

/// A skin, morph targets and animations of both.
pub fn moving() -> Asset {
    let mut asset = Asset::new();
    asset.positions(&SQUARE);
    asset.primitive(json!({}));
    let indices = asset.accessor(UNSIGNED_BYTE, "SCALAR", 6, &[0, 1, 2, 2, 1, 3], json!({}));
    let moves = asset.float_accessor("VEC3", 3, &[0.0, 0.0, 0.5].repeat(4));
    let joints = asset.accessor(UNSIGNED_BYTE, "VEC4", 4, &[0, 1, 0, 0].repeat(4), json!({}));
    let weights = asset.float_accessor("VEC4", 4, &[0.5, 0.5, 0.0, 0.0].repeat(4));
    let primitive = &mut asset.json["meshes"][0]["primitives"][0];
    primitive["indices"] = json!(indices);
    primitive["targets"] = json!([{"POSITION": moves}, {"POSITION": moves, "NORMAL": moves}]);
    asset.json["meshes"][0]["weights"] = json!([0.25, 0]);
    asset.attribute("JOINTS_0", joints);
    asset.attribute("WEIGHTS_0", weights);
    let unit: Vec<f32> = (0..16).map(|i| if i % 5 == 0 { 1.0 } else { 0.0 }).collect();
    let inverse = asset.float_accessor("MAT4", 16, &unit.repeat(2));
    asset.json["skins"] = json!([{"joints": [1, 2], "inverseBindMatrices": inverse, "skeleton": 1}]);
    asset.json["nodes"][0]["skin"] = json!(0);
    asset.push("nodes", json!({"children": [2], "rotation": [0, 0, 0, 1]}));
    asset.push("nodes", json!({"translation": [0, 1, 0]}));
    let times = asset.float_accessor("SCALAR", 1, &[0.0, 0.5, 1.0]);
    let turns =
        asset.float_accessor("VEC4", 4, &[0.0, 0.0, 0.0, 1.0, 0.0, 0.6, 0.0, 0.8, 0.0, 0.0, 1.0, 0.0]);
    let paths = asset.float_accessor("VEC3", 3, &[0.5; 27]);
    let shapes = asset.float_accessor("SCALAR", 1, &[0.0, 1.0, 0.5, 0.5, 1.0, 0.0]);
    asset.json["animations"] = json!([{
        "samplers": [
            {"input": times, "output": turns}, {"input": times, "output": paths, "interpolation": "CUBICSPLINE"},
            {"input": times, "output": shapes, "interpolation": "STEP"},
        ],
        "channels": [
            {"sampler": 0, "target": {"node": 1, "path": "rotation"}},
            {"sampler": 1, "target": {"node": 2, "path": "translation"}},
            {"sampler": 2, "target": {"node": 0, "path": "weights"}},
            {"sampler": 1, "target": {"path": "pointer", "extensions":
                {"KHR_animation_pointer": {"pointer": "/nodes/1/scale"}}}},
        ],
    }]);
    asset
}

/// Instances, quantized numbers and compressed views.
fn packed() -> Asset {
    let mut asset = Asset::new();
    let corners = [0_i16, 0, 0, 0, 8, 0, 0, 0, 0, 8, 0, 0, 8, 8, 0, 0];
    let corners: Vec<u8> = corners.iter().flat_map(|i| i.to_le_bytes()).collect();
    let view = asset.view(&corners, json!({"byteStride": 8, "target": 34962}));
    let positions = json!({"bufferView": view, "componentType": SHORT, "type": "VEC3", "count": 4});
    asset.push("accessors", positions);
    let wide: Vec<u8> = [0_u32, 1, 2].iter().flat_map(|i| i.to_le_bytes()).collect();
    let wide = asset.accessor(UNSIGNED_INT, "SCALAR", 3, &wide, json!({}));
    asset.primitive(json!({"indices": wide}));
    let places = asset.float_accessor("VEC3", 3, &[0.0, 0.0, 0.0, 10.0, 0.0, 0.0, 0.0, 10.0, 0.0]);
    let scales = asset.float_accessor("VEC3", 3, &[1.0; 9]);
    asset.json["nodes"][0]["extensions"] =
        json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": places, "SCALE": scales}}});
    for (mode, stream, count, stride) in [
        ("INDICES", &[0xd1, 0, 4, 4, 0, 2, 8, 0, 0, 0, 0][..], 6, 2),
        ("TRIANGLES", &[0xe1, 0xf0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0][..], 6, 2),
        ("ATTRIBUTES", &[0xa0].iter().chain(&[0; 36]).copied().collect::<Vec<u8>>()[..], 3, 4),
    ] {
        let view = asset.view(stream, json!({}));
        let mut members = asset.json["bufferViews"][view].clone();
        members["mode"] = json!(mode);
        (members["count"], members["byteStride"]) = (json!(count), json!(stride));
        asset.json["bufferViews"][view] = json!({"buffer": 0, "byteLength": count * stride,
            "extensions": {"EXT_meshopt_compression": members}});
        let component = if stride == 2 { UNSIGNED_SHORT } else { UNSIGNED_BYTE };
        let accessor =
            json!({"bufferView": view, "componentType": component, "type": "SCALAR", "count": count});
        let accessor = asset.push("accessors", accessor);
        if stride == 2 {
            let primitive = json!({"attributes": {"POSITION": 0}, "indices": accessor});
            asset.json["meshes"][0]["primitives"].as_array_mut().unwrap().push(primitive);
        }
    }
    asset
}
