//! Every value counts, and nothing else does.

use std::collections::HashSet;

use glam::Vec3;
use serde_json::Value;

use crate::sample;
use ajar_scene::*;

/// Replaces, one at a time, every leaf of the scene's JSON by another value of its type; each scene so made must have a
/// hash of its own. What JSON cannot say differently without changing the scene is left out by comparing the scenes.
#[test]
fn every_leaf_counts() {
    let scene = sample();
    let json = serde_json::to_value(&scene).unwrap();
    let mut leaves = Vec::new();
    collect(&json, String::new(), &mut leaves);
    let mut hashes = HashSet::from([scene.content_hash()]);
    let mut changed = 0;
    for leaf in &leaves {
        let mut other = json.clone();
        let value = other.pointer_mut(leaf).unwrap();
        *value = match &*value {
            Value::Bool(flag) => Value::Bool(!flag),
            Value::String(text) => match text.as_str() {
                "r" => "g".into(),
                "raw" => "srgb".into(),
                "repeat" => "clamp".into(),
                "linear" => "nearest".into(),
                text => format!("{text}x").into(),
            },
            Value::Number(number) if number.is_f64() => (number.as_f64().unwrap() + 0.25).into(),
            Value::Number(number) => (number.as_u64().unwrap() + 1).into(),
            _ => continue,
        };
        let other: Scene = serde_json::from_value(other).unwrap_or_else(|e| panic!("{leaf}: {e}"));
        assert_ne!(other, scene, "{leaf}");
        let fresh = hashes.insert(other.content_hash());
        assert_eq!(fresh, leaf != "/images/0/name", "{leaf}");
        changed += 1;
    }
    assert!(changed > 150, "{changed}");
}

fn collect(value: &Value, path: String, leaves: &mut Vec<String>) {
    match value {
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(i, item)| collect(item, format!("{path}/{i}"), leaves));
        }
        Value::Object(items) => {
            items.iter().for_each(|(key, item)| collect(item, format!("{path}/{key}"), leaves));
        }
        Value::Null => {}
        _ => leaves.push(path),
    }
}

#[test]
fn equal_scenes_have_equal_hashes() {
    let scene = sample();
    assert_eq!(scene.content_hash(), scene.clone().content_hash());
    let json = serde_json::to_string(&scene).unwrap();
    assert_eq!(serde_json::from_str::<Scene>(&json).unwrap().content_hash(), scene.content_hash());
    assert_eq!(scene.content_hash().len(), 64);
}

/// The stream, byte for byte: it is part of the format of checkpoints and must not change by accident or by platform.
#[test]
fn stream() {
    let mut scene = Scene::default();
    scene.meshes.push(Mesh {
        name: "é".into(),
        positions: vec![Vec3::new(1.0, -2.0, 0.5)],
        triangles: vec![[7, 8, 9]],
        material: Some(Id::new(258)),
        ..Mesh::default()
    });
    let mut stream = vec![12, 0, 0, 0, 0, 0, 0, 0];
    stream.extend(b"ajar scene 1");
    stream.extend([0; 8]); // nodes
    stream.extend([0; 8]); // roots
    stream.extend([1, 0, 0, 0, 0, 0, 0, 0]); // meshes
    stream.extend([2, 0, 0, 0, 0, 0, 0, 0, 0xc3, 0xa9]); // the name, in UTF-8
    stream.extend([1, 0, 0, 0, 0, 0, 0, 0]); // positions
    stream.extend([0, 0, 0x80, 0x3f, 0, 0, 0, 0xc0, 0, 0, 0, 0x3f]);
    stream.extend([1, 0, 0, 0, 0, 0, 0, 0]); // triangles
    stream.extend([7, 0, 0, 0, 8, 0, 0, 0, 9, 0, 0, 0]);
    stream.extend([0, 0]); // no normals, no tangents
    stream.extend([0; 8]); // texture coordinate sets
    stream.extend([0]); // no colours
    stream.extend([1, 2, 1, 0, 0]); // the material
    stream.extend([0; 5 * 8]); // materials, textures, images, lights, cameras
    assert_eq!(scene.content_hash(), blake3::hash(&stream).to_hex().as_str());
}

/// Options, lists and choices that the sample's leaves do not reach.
#[test]
fn structure_counts() {
    let scene = sample();
    let edits: &[fn(&mut Scene)] = &[
        |s| s.roots.reverse(),
        |s| s.roots.truncate(1),
        |s| s.meshes[Id::new(0)].normals = None,
        |s| s.meshes[Id::new(0)].tangents = None,
        |s| s.meshes[Id::new(0)].colors = None,
        |s| s.meshes[Id::new(0)].uvs.clear(),
        |s| s.meshes[Id::new(0)].uvs.push(Vec::new()),
        |s| s.meshes[Id::new(0)].material = None,
        |s| s.meshes[Id::new(0)].triangles.clear(),
        |s| s.nodes[Id::new(0)].material = None,
        |s| s.nodes[Id::new(0)].meshes.push(Id::new(0)),
        |s| s.materials[Id::new(0)].normal_map = None,
        |s| s.materials[Id::new(0)].alpha_mode = AlphaMode::Opaque,
        |s| s.materials[Id::new(0)].alpha_mode = AlphaMode::Blend,
        |s| s.materials[Id::new(0)].attenuation_distance = 1.0,
        |s| s.cameras[Id::new(0)].aspect = Some(1.0),
        |s| s.cameras[Id::new(0)].projection = Projection::Orthographic { half_height: 1.0 },
        |s| s.lights[Id::new(0)].kind = LightKind::Environment { radiance: 1.0, texture: None },
        |s| s.lights[Id::new(0)].kind = LightKind::Point { intensity: 1.0 },
        |s| s.lights[Id::new(0)].kind = LightKind::Spot { intensity: 1.0, inner: 1.0, outer: 1.0 },
        |s| s.lights[Id::new(0)].kind = LightKind::Directional { illuminance: 1.0, angle: 1.0 },
        |s| s.lights[Id::new(0)].kind = LightKind::Disk { radiance: 1.0, radius: 1.0 },
        |s| s.lights[Id::new(0)].kind = LightKind::Sphere { radiance: 1.0, radius: 1.0 },
        |s| s.lights[Id::new(0)].kind = LightKind::Cylinder { radiance: 1.0, radius: 1.0, length: 1.0 },
        |s| s.images[Id::new(0)].source = ImageSource::File("/no/such/file".into()),
    ];
    let mut hashes = HashSet::from([scene.content_hash()]);
    for (index, edit) in edits.iter().enumerate() {
        let mut other = scene.clone();
        edit(&mut other);
        assert!(hashes.insert(other.content_hash()), "edit {index}");
    }
}

/// A file and the same bytes embedded are the same picture, wherever the file lies.
#[test]
fn images_count_by_content() {
    let folder = tempfile::TempDir::new().unwrap();
    let path = folder.path().join("any name.png");
    std::fs::write(&path, [1, 2, 3]).unwrap();
    let mut scene = sample();
    let embedded = scene.content_hash();
    scene.images[Id::new(0)] = Image { name: "other".into(), source: ImageSource::File(path) };
    assert_eq!(scene.content_hash(), embedded);
}
