//! Damaged files: whatever happens to the bytes, the importer answers, quickly, and what it returns holds together.

use std::{
    fs,
    path::Path,
    sync::atomic::{AtomicUsize, Ordering},
    time::{Duration, Instant},
};

use ajar_importers::gltf::Gltf;
use ajar_scene::{Choice, ImportRequest, Importer, Moment, Scene, Severity};
use serde_json::{Value, json};

use crate::build::{Asset, PNG, UNSIGNED_BYTE, UNSIGNED_SHORT, data_uri, floats};

/// No answer may take longer; the usual one takes a thousandth.
const HANG: Duration = Duration::from_secs(5);
const MEMORY: u64 = 64 << 20;

/// SplitMix64: the same damage in every run.
struct Random(u64);

impl Random {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % bound as u64) as usize
    }
}

/// A file that uses all that the importer knows.
fn rich() -> Asset {
    let mut asset = Asset::new();
    asset.positions(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.5]]);
    let normals = asset.float_accessor("VEC3", 3, &[0.0, 0.0, 1.0].repeat(4));
    let tangents = asset.float_accessor("VEC4", 4, &[1.0, 0.0, 0.0, 1.0].repeat(4));
    let uvs = asset.accessor(UNSIGNED_SHORT, "VEC2", 4, &[0, 128].repeat(8), json!({"normalized": true}));
    let colors =
        asset.accessor(UNSIGNED_BYTE, "VEC4", 4, &[255, 128, 64, 32].repeat(4), json!({"normalized": true}));
    let indices = asset.accessor(UNSIGNED_BYTE, "SCALAR", 6, &[0, 1, 2, 2, 1, 3], json!({}));
    let (at, values) = (asset.view(&[2], json!({})), asset.view(&floats(&[0.5; 3]), json!({})));
    asset.json["accessors"][0]["sparse"] = json!({
        "count": 1, "indices": {"bufferView": at, "componentType": UNSIGNED_BYTE}, "values": {"bufferView": values},
    });
    let attributes = json!({"NORMAL": normals, "TANGENT": tangents, "TEXCOORD_0": uvs, "COLOR_0": colors});
    asset.primitive(json!({"attributes": attributes, "indices": indices, "material": 0}));
    asset.primitive(json!({"mode": 5, "targets": [{"POSITION": 1}]}));
    let image = asset.view(PNG, json!({}));
    asset.json["images"] = json!([{"bufferView": image, "mimeType": "image/png"}, {"uri": data_uri(PNG)}]);
    asset.json["samplers"] = json!([{"wrapS": 33071, "wrapT": 33648, "magFilter": 9728}]);
    asset.json["textures"] =
        json!([{"source": 0, "sampler": 0}, {"extensions": {"EXT_texture_webp": {"source": 1}}}]);
    let transform =
        json!({"KHR_texture_transform": {"offset": [0.5, 0], "rotation": 1, "scale": [2, 3], "texCoord": 1}});
    let info = json!({"index": 0, "extensions": transform});
    asset.json["materials"] = json!([{
        "pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 0.25, 1], "baseColorTexture": info},
        "normalTexture": {"index": 1, "scale": 2}, "emissiveFactor": [1, 1, 1], "alphaMode": "MASK", "alphaCutoff": 0.25,
        "extensions": {
            "KHR_materials_transmission": {"transmissionFactor": 0.5, "transmissionTexture": info},
            "KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 2},
            "KHR_materials_specular": {"specularColorFactor": [2, 1, 1]},
            "KHR_materials_clearcoat": {"clearcoatFactor": 1, "clearcoatTexture": info},
            "KHR_materials_anisotropy": {"anisotropyStrength": 0.5, "anisotropyRotation": 1},
            "KHR_materials_ior": {"ior": 1.25}, "KHR_materials_emissive_strength": {"emissiveStrength": 5},
        },
    }]);
    asset.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "spot", "intensity": 3, "range": 5, "spot": {"innerConeAngle": 0.25, "outerConeAngle": 0.5}},
    ]}});
    asset.json["cameras"] =
        json!([{"type": "perspective", "perspective": {"yfov": 1, "aspectRatio": 2, "znear": 0.1}}]);
    let lit = json!({"KHR_lights_punctual": {"light": 0}, "KHR_node_visibility": {"visible": false}});
    asset.push("nodes", json!({"children": [0, 1], "translation": [1, 2, 3], "rotation": [0, 0, 0, 1]}));
    asset.push("nodes", json!({"children": [2], "camera": 0, "extensions": lit, "scale": [1, 2, 3]}));
    asset.json["scenes"] = json!([{"nodes": [3]}]);
    asset.json["scene"] = json!(0);
    set_in_motion(&mut asset);
    asset
}

/// Bends, moves and repeats the meshes of [`rich`].
fn set_in_motion(asset: &mut Asset) {
    let joints = asset.accessor(UNSIGNED_BYTE, "VEC4", 4, &[0, 1, 0, 0].repeat(4), json!({}));
    let weights = asset.float_accessor("VEC4", 4, &[0.5, 0.5, 0.0, 0.0].repeat(4));
    let identity = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let inverses = asset.float_accessor("MAT4", 16, &identity.repeat(2));
    asset.attribute("JOINTS_0", joints);
    asset.attribute("WEIGHTS_0", weights);
    asset.json["skins"] = json!([{"joints": [2, 3], "inverseBindMatrices": inverses}]);
    asset.json["nodes"][0]["skin"] = json!(0);
    asset.json["meshes"][1]["weights"] = json!([0.5]);
    let places = asset.float_accessor("VEC3", 3, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    asset.json["nodes"][1]["extensions"] =
        json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": places}}});
    let times = asset.float_accessor("SCALAR", 1, &[0.0, 1.0]);
    let turns = asset.float_accessor("VEC4", 4, &[0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0]);
    let pointer = json!({"KHR_animation_pointer": {"pointer": "/materials/0/emissiveFactor"}});
    asset.json["animations"] = json!([{
        "samplers": [{"input": times, "output": places}, {"input": times, "output": turns}],
        "channels": [
            {"sampler": 0, "target": {"node": 2, "path": "translation"}},
            {"sampler": 1, "target": {"node": 3, "path": "rotation"}},
            {"sampler": 0, "target": {"path": "pointer", "extensions": pointer}},
        ],
    }]);
}

/// Every handle, index, length and number of the scene is as promised.
fn hold_together(scene: &Scene) {
    assert!(scene.validate().iter().all(|found| found.severity < Severity::Error), "{:?}", scene.validate());
    for mesh in scene.meshes.iter() {
        let count = mesh.positions.len();
        assert!(mesh.positions.iter().all(|p| p.is_finite()));
        assert!(
            !mesh.triangles.is_empty() && mesh.triangles.as_flattened().iter().all(|&i| (i as usize) < count)
        );
        let normals = mesh.normals.iter().flatten();
        assert!(
            normals.clone().all(|n| n.is_normalized())
                && (mesh.normals.is_none() || normals.count() == count)
        );
        let tangents = mesh.tangents.iter().flatten();
        assert!(tangents.clone().all(|t| t.truncate().is_normalized() && t.w.abs() == 1.0));
        assert!(mesh.tangents.is_none() || tangents.count() == count);
        assert!(mesh.uvs.iter().all(|set| set.len() == count && set.iter().all(|uv| uv.is_finite())));
        let colors = mesh.colors.iter().flatten();
        assert!(colors.clone().all(|c| c.min_element() >= 0.0 && c.max_element() <= 1.0));
        assert!(mesh.colors.is_none() || colors.count() == count);
        assert!(mesh.material.is_some_and(|id| scene.materials.get(id).is_some()));
    }
    for material in scene.materials.iter() {
        let scalars = [
            &material.metallic,
            &material.roughness,
            &material.transmission,
            &material.coat,
            &material.opacity,
        ];
        assert!(scalars.iter().all(|input| (0.0..=1.0).contains(&input.value)));
        assert!(material.ior >= 1.0 && material.ior.is_finite() && material.emission.value.is_finite());
        let maps = scalars.iter().filter_map(|input| input.texture).chain(material.base_color.texture);
        let maps = maps.map(|input| input.texture).chain(material.normal_map.map(|map| map.texture));
        maps.for_each(|id| {
            assert!(scene.textures.get(id).is_some_and(|texture| texture.transform.is_finite()))
        });
    }
    assert!(scene.textures.iter().all(|texture| scene.images.get(texture.image).is_some()));
    let mut reached = 0;
    for node in scene.nodes.iter() {
        assert!(node.transform.is_finite());
        assert!(node.meshes.iter().all(|&id| scene.meshes.get(id).is_some()));
        assert!(node.light.is_none_or(|id| scene.lights.get(id).is_some()));
        assert!(node.camera.is_none_or(|id| scene.cameras.get(id).is_some()));
        reached += node.children.len();
        assert!(node.children.iter().all(|&id| scene.nodes.get(id).is_some()));
    }
    assert!(scene.placed().len() <= reached + scene.roots.len());
}

/// Whether the file was taken. Each has a name of its own: overwriting makes some file systems wait for the disk.
fn survives(folder: &Path, bytes: &[u8], what: &str) -> bool {
    static COUNT: AtomicUsize = AtomicUsize::new(0);
    let path = folder.join(format!("{}.gltf", COUNT.fetch_add(1, Ordering::Relaxed)));
    fs::write(&path, bytes).unwrap();
    let choice = Choice { moment: Some(Moment::Seconds(0.25)), ..Choice::default() };
    let request = ImportRequest { memory_limit: MEMORY, choice, ..ImportRequest::new(&path) };
    let start = Instant::now();
    let outcome = Gltf.import(&request);
    assert!(start.elapsed() < HANG, "{what}: {:?}", start.elapsed());
    match outcome {
        Ok(imported) => {
            assert!(imported.diagnostics.iter().all(|d| d.severity < Severity::Error && d.file.is_some()));
            hold_together(&imported.scene);
            true
        }
        Err(error) => {
            assert!(
                error.severity == Severity::Error && error.file.is_some() && !error.message.is_empty(),
                "{what}"
            );
            false
        }
    }
}

#[test]
fn the_undamaged_file_is_fine() {
    let imported = rich().import().unwrap();
    hold_together(&imported.scene);
    assert_eq!((imported.scene.meshes.len(), imported.scene.textures.len()), (2, 3));
    assert_eq!(imported.scene.placed().len(), 6);
}

#[test]
fn truncated_files() {
    let folder = tempfile::tempdir().unwrap();
    for (name, file) in [("a.gltf", rich().text()), ("a.glb", rich().glb())] {
        for length in (0..file.len()).step_by(11) {
            assert!(!survives(folder.path(), &file[..length], &format!("{name} cut at {length}")));
        }
    }
}

#[test]
fn flipped_bits() {
    let folder = tempfile::tempdir().unwrap();
    let mut random = Random(1);
    for (name, file) in [("a.gltf", rich().text()), ("a.glb", rich().glb())] {
        for round in 0..700 {
            let mut damaged = file.clone();
            for _ in 0..=random.below(3) {
                let at = random.below(damaged.len());
                damaged[at] ^= 1 << random.below(8);
            }
            survives(folder.path(), &damaged, &format!("{name} flipped, round {round}"));
        }
    }
}

/// Values that break careless arithmetic, or are of another type.
fn odd_values() -> Vec<Value> {
    vec![
        json!(0),
        json!(1),
        json!(2),
        json!(3),
        json!(7),
        json!(-1),
        json!(0.5),
        json!(255),
        json!(65536),
        json!(i32::MAX),
        json!(u32::MAX),
        json!(u32::MAX - 1),
        json!(1u64 << 32),
        json!(i64::MAX),
        json!(u64::MAX),
        json!(u64::MAX - 11),
        json!(1e39),
        json!(-1e308),
        json!(1e-320),
        json!(null),
        json!("x"),
        json!([]),
        json!({}),
        json!(true),
    ]
}

/// Pointers to all values below.
fn pointers(value: &Value, path: String, found: &mut Vec<String>) {
    match value {
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(i, item)| pointers(item, format!("{path}/{i}"), found));
        }
        Value::Object(fields) => {
            fields.iter().for_each(|(key, field)| pointers(field, format!("{path}/{key}"), found));
        }
        _ => {}
    }
    found.push(path);
}

#[test]
fn changed_values() {
    let folder = tempfile::tempdir().unwrap();
    let asset = rich();
    let (mut found, odd, mut random) = (Vec::new(), odd_values(), Random(2));
    pointers(&asset.json, String::new(), &mut found);
    let mut taken = 0;
    for round in 0..2000 {
        let mut damaged = asset.clone();
        let mut what = String::new();
        for _ in 0..=random.below(2) {
            let pointer = &found[random.below(found.len())];
            let value = &odd[random.below(odd.len())];
            if let Some(place) = damaged.json.pointer_mut(pointer) {
                *place = value.clone();
            }
            what += &format!("{pointer} = {value}; ");
        }
        if !damaged.json.is_object() {
            continue;
        }
        taken += usize::from(survives(folder.path(), &damaged.text(), &format!("round {round}: {what}")));
    }
    // The damage must be neither harmless nor always fatal, or this test tests nothing.
    assert!((200..1800).contains(&taken), "{taken}");
}

#[test]
fn amplification_is_refused_or_quick() {
    let folder = tempfile::tempdir().unwrap();
    let mut asset = Asset::new();
    asset.positions(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    let indices = asset.accessor(UNSIGNED_BYTE, "SCALAR", 300_000, &[0, 1, 2].repeat(100_000), json!({}));
    let primitive = json!({"attributes": {"POSITION": 0}, "indices": indices});
    asset.push("meshes", json!({"primitives": vec![primitive; 20_000]}));
    assert!(!survives(folder.path(), &asset.text(), "many primitives over the same indices"));

    let mut asset = Asset::new();
    let zeros =
        asset.push("accessors", json!({"componentType": 5126, "type": "VEC3", "count": u32::MAX - 1}));
    asset.push("meshes", json!({"primitives": [{"attributes": {"POSITION": zeros}}]}));
    assert!(!survives(folder.path(), &asset.text(), "zeros without data"));

    // A small primitive over a huge array must not pay for the array.
    let indices = asset.accessor(UNSIGNED_BYTE, "SCALAR", 3, &[0, 1, 2], json!({}));
    asset.json["meshes"][0]["primitives"] =
        json!(vec![json!({"attributes": {"POSITION": zeros}, "indices": indices}); 1000]);
    assert!(survives(folder.path(), &asset.text(), "few indices into many zeros"));

    let nodes: Vec<_> = (0..100_000).map(|i| json!({"children": [(i + 1) % 100_000]})).collect();
    let mut asset = Asset::new();
    asset.json["nodes"] = json!(nodes);
    assert!(!survives(folder.path(), &asset.text(), "a long cycle"));
}
