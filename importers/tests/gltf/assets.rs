//! Real files, skipped where they are absent.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

use ajar_importers::{gltf::Gltf, import};
use ajar_scene::{Choice, Diagnostic, ImportRequest, Imported, Importer, Severity};
use glam::Vec3;
use serde_json::Value;

/// Nodes in the scene, meshes in the file, triangles in the scene, materials in the file, lights, cameras; counted from
/// the JSON by a program of its own.
const FACTS: [(&str, [usize; 6]); 57] = [
    ("AlphaBlendModeTest", [13, 9, 61, 6, 0, 1]),
    ("AnimatedTriangle", [1, 1, 1, 0, 0, 0]),
    ("AnisotropyBarnLamp", [3, 3, 10203, 3, 0, 0]),
    ("BoxInterleaved", [2, 1, 12, 1, 0, 0]),
    ("Cameras", [3, 1, 2, 0, 0, 2]),
    ("ClearCoatTest", [33, 27, 37116, 19, 0, 0]),
    ("CornellBox", [4, 6, 36, 5, 0, 0]),
    ("ExtCoat", [1, 1, 12, 1, 0, 0]),
    ("ExtDiffuseRoughness", [1, 1, 12, 1, 0, 0]),
    ("ExtDispersion", [1, 1, 12, 1, 0, 0]),
    ("ExtIridescence", [1, 1, 12, 1, 0, 0]),
    ("ExtVolumeScatterTransmission", [1, 1, 12, 1, 0, 0]),
    ("InterpolationTest", [12, 10, 110, 10, 0, 0]),
    ("Mesh_PrimitiveMode_00", [1, 0, 0, 0, 0, 0]),
    ("Mesh_PrimitiveMode_02", [1, 0, 0, 0, 0, 0]),
    ("Mesh_PrimitiveMode_04", [1, 1, 2, 0, 0, 0]),
    ("Mesh_PrimitiveMode_06", [1, 1, 2, 0, 0, 0]),
    ("Mesh_PrimitiveMode_08", [1, 0, 0, 0, 0, 0]),
    ("Mesh_PrimitiveMode_10", [1, 0, 0, 0, 0, 0]),
    ("Mesh_PrimitiveMode_12", [1, 1, 2, 0, 0, 0]),
    ("Mesh_PrimitiveMode_14", [1, 1, 2, 0, 0, 0]),
    ("MorphPrimitivesTest", [2, 2, 32, 2, 0, 0]),
    ("NormalTangentTest", [2, 1, 7774, 1, 0, 0]),
    ("RiggedSimple", [5, 1, 188, 1, 0, 0]),
    ("SimpleSparseAccessor", [1, 1, 12, 0, 0, 0]),
    ("TextureCoordinateTest", [6, 5, 10, 5, 0, 0]),
    ("TextureTransformTest", [12, 9, 24, 9, 0, 0]),
    ("TransmissionThinWalled", [1, 1, 12, 1, 0, 0]),
    ("Triangle", [1, 1, 1, 0, 0, 0]),
    ("UnlitTest", [2, 2, 88, 2, 0, 0]),
    ("VertexColorTest", [2, 2, 36, 2, 0, 0]),
    ("blender_01_alpha_blend", [3, 2, 14, 2, 0, 0]),
    ("blender_01_morphed_cube", [2, 1, 12, 1, 0, 0]),
    ("blender_01_single_vs_double_sided", [2, 2, 1480, 2, 0, 0]),
    ("blender_02_node_hierarchy", [3, 2, 60, 1, 0, 0]),
    ("blender_03_skinned_cylinder", [8, 1, 316, 1, 0, 0]),
    ("blender_04_lights", [9, 1, 2, 1, 0, 0]),
    ("blender_06_parent-inverse-anim", [12, 10, 120, 1, 0, 0]),
    ("blender_09_texture_transform", [1, 1, 2, 1, 0, 0]),
    ("blender_11_factors_and_textures", [1, 1, 12, 1, 0, 0]),
    ("blender_13_occlusion_strength", [1, 1, 2, 1, 0, 0]),
    ("blender_16_volume", [25, 20, 296, 20, 0, 0]),
    ("blender_18_variants", [1, 3, 12, 5, 0, 0]),
    ("blender_19_sheen", [7, 7, 6720, 7, 0, 0]),
    ("blender_20_specular", [7, 7, 6720, 7, 0, 0]),
    ("blender_22_vertex_color", [5, 3, 5, 0, 0, 0]),
    ("blender_24_gpu_instancing", [1905, 2, 7_656_770, 2, 0, 0]),
    ("derived_diffuse_transmission", [1, 1, 12, 1, 0, 0]),
    ("gltf_primitives", [1, 4, 12, 4, 0, 0]),
    ("magnum_camera", [0, 0, 0, 0, 0, 4]),
    ("magnum_escaped-strings", [0, 0, 0, 1, 1, 1]),
    ("magnum_material-clearcoat", [0, 0, 0, 6, 0, 0]),
    ("magnum_mesh-primitives-types", [0, 5, 0, 0, 0, 0]),
    ("magnum_mesh-sparse", [0, 8, 0, 0, 0, 0]),
    ("sphere_lights", [5, 1, 224, 1, 4, 0]),
    ("teapots_galore", [1906, 2, 7_656_770, 3, 0, 1]),
    ("webp_required", [2, 1, 12, 1, 0, 0]),
];

/// Files that require what is not supported.
const REFUSED: [(&str, &str); 1] = [("magnum_image-basis-embedded", "GOOGLE_texture_basis")];

/// The folder of shared test assets, if there is one on this machine.
pub fn shared() -> Option<PathBuf> {
    let root = std::env::var_os("AJAR_SHARED").map(PathBuf::from);
    let root = root.unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared"));
    let assets = root.join("assets");
    if !assets.is_dir() {
        println!("skipped: no shared assets");
        return None;
    }
    Some(assets)
}

/// Folder and file of the glTF rows that the manifest lists below `kind`.
fn listed(assets: &Path, kind: &str) -> Vec<(String, PathBuf)> {
    let manifest = fs::read_to_string(assets.join("MANIFEST.md")).unwrap();
    let mut found = Vec::new();
    for line in manifest.lines() {
        let cells: Vec<_> = line.split('|').map(str::trim).collect();
        let [_, folder, file, ..] = cells[..] else { continue };
        let is_gltf = file.ends_with(".gltf") || file.ends_with(".glb");
        if let Some(name) = folder.strip_prefix(kind).filter(|_| is_gltf) {
            found.push((name.to_string(), assets.join(folder).join(file)));
        }
    }
    found
}

fn load(path: &Path) -> Result<Imported, Diagnostic> {
    load_as(path, &Choice::default())
}

pub fn load_as(path: &Path, choice: &Choice) -> Result<Imported, Diagnostic> {
    Gltf.import(&ImportRequest { choice: choice.clone(), ..ImportRequest::new(path) })
}

#[test]
fn real_files_have_the_parts_that_their_json_names() {
    let Some(assets) = shared() else { return };
    let facts = BTreeMap::from(FACTS);
    let refused = BTreeMap::from(REFUSED);
    let files = listed(&assets, "gltf/");
    assert!(files.len() >= 67, "{}", files.len());
    for (name, path) in files {
        let imported = load(&path);
        if let Some(extension) = refused.get(name.as_str()) {
            let error = imported.map(|_| ()).unwrap_err();
            assert!(error.message.contains(extension), "{name}: {error}");
            continue;
        }
        let imported = imported.unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(imported.diagnostics.iter().all(|d| d.severity < Severity::Error));
        let scene = &imported.scene;
        let placed = scene.placed();
        let meshes = placed.iter().flat_map(|placed| &placed.node.meshes);
        let triangles = meshes.map(|&mesh| scene.meshes[mesh].triangles.len()).sum();
        // Cameras and lights that were dropped are not counted, nor is the material for primitives without.
        let materials = scene.materials.iter().filter(|material| material.name != "default").count();
        let found =
            [placed.len(), scene.meshes.len(), triangles, materials, scene.lights.len(), scene.cameras.len()];
        if let Some(expected) = facts.get(name.as_str()) {
            assert_eq!(&found, expected, "{name}");
        }
        check_bounds(&name, &path, &imported);
    }
}

/// The document of a text or binary file.
fn document(path: &Path) -> Value {
    let bytes = fs::read(path).unwrap();
    let text = match bytes.strip_prefix(b"glTF") {
        Some(rest) => &rest[16..16 + u32::from_le_bytes(rest[8..12].try_into().unwrap()) as usize],
        None => bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(&bytes),
    };
    serde_json::from_slice(text).unwrap()
}

/// Positions lie within the bounds that the exporter wrote, and reach them where all vertices are in use.
fn check_bounds(name: &str, path: &Path, imported: &Imported) {
    let document = document(path);
    if document["skins"].is_array() || document["meshes"][0]["weights"].is_array() {
        return;
    }
    let primitives =
        document["meshes"].as_array().into_iter().flatten().flat_map(|m| m["primitives"].as_array().unwrap());
    let positions: Vec<_> = primitives
        .filter(|p| p["mode"].as_u64().unwrap_or(4) >= 4 && p["attributes"]["POSITION"].is_u64())
        .map(|p| &document["accessors"][p["attributes"]["POSITION"].as_u64().unwrap() as usize])
        .collect();
    if positions.len() != imported.scene.meshes.len() {
        return;
    }
    for (accessor, mesh) in positions.iter().zip(imported.scene.meshes.iter()) {
        let bound = |key: &str| {
            let values = accessor[key].as_array()?;
            let values: Vec<_> = values.iter().map(|v| v.as_f64().unwrap() as f32).collect();
            (accessor["normalized"] != true).then(|| Vec3::from_slice(&values))
        };
        let (Some(low), Some(high)) = (bound("min"), bound("max")) else { continue };
        let found_low = mesh.positions.iter().copied().reduce(Vec3::min).unwrap();
        let found_high = mesh.positions.iter().copied().reduce(Vec3::max).unwrap();
        let slack = 1e-5 * high.abs().max(low.abs()).max_element();
        assert!(
            (found_low - low).min_element() >= -slack && (high - found_high).min_element() >= -slack,
            "{name}"
        );
        if accessor["count"] == mesh.positions.len() {
            assert!(found_low.abs_diff_eq(low, slack) && found_high.abs_diff_eq(high, slack), "{name}");
        }
    }
}

#[test]
fn malformed_files_give_an_error_or_a_warning() {
    let Some(assets) = shared() else { return };
    let files = listed(&assets, "malformed/");
    assert!(files.len() >= 40, "{}", files.len());
    for (name, path) in files {
        let start = std::time::Instant::now();
        match import(&ImportRequest::new(&path)) {
            Ok(imported) => {
                // An empty binary chunk beside a data URI is allowed, and so is a skin of two joints that no node
                // has; they are here because they crashed another reader.
                let fine = ["tinygltf_zero-sized-bin-chunk-issue-440", "tinygltf_issue-492"];
                assert_eq!(imported.diagnostics.is_empty(), fine.contains(&name.as_str()), "{name}");
            }
            Err(error) => assert!(!error.message.contains("importer failed"), "{name}: {error}"),
        }
        assert!(start.elapsed().as_secs() < 5, "{name}");
    }
}

#[test]
fn the_interleaved_box_is_a_unit_cube() {
    let Some(assets) = shared() else { return };
    let imported = load(&assets.join("gltf/BoxInterleaved/BoxInterleaved.glb")).unwrap();
    let mesh = imported.scene.meshes.iter().next().unwrap();
    assert!(mesh.positions.iter().all(|p| p.abs() == Vec3::splat(0.5)));
    let normals = mesh.normals.as_ref().unwrap();
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|i| mesh.positions[i as usize]);
        let geometric = (b - a).cross(c - a).normalize();
        assert!(triangle.iter().all(|&i| normals[i as usize] == geometric));
    }
}
