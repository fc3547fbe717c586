//! Morph targets and skins.

use ajar_scene::{Choice, Mesh, Moment};
use glam::{DVec3, Vec3};
use serde_json::json;

use crate::{
    assets::{load_as, shared},
    build::{Asset, UNSIGNED_BYTE},
    failure, only_mesh, warnings,
};

/// A triangle with normals and a target that lifts and tips it.
fn morphing() -> Asset {
    let mut asset = Asset::triangle(json!({}));
    let normals = asset.float_accessor("VEC3", 3, &[0.0, 0.0, 1.0].repeat(3));
    asset.attribute("NORMAL", normals);
    let lift = asset.float_accessor("VEC3", 3, &[0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 4.0]);
    let tip = asset.float_accessor("VEC3", 3, &[1.0, 0.0, 0.0].repeat(3));
    let shift = asset.float_accessor("VEC3", 3, &[10.0, 0.0, 0.0].repeat(3));
    asset.json["meshes"][0]["primitives"][0]["targets"] =
        json!([{"POSITION": lift, "NORMAL": tip}, {"POSITION": shift}]);
    asset
}

#[test]
fn targets_add_up_by_their_weights() {
    let mut asset = morphing();
    assert_eq!(only_mesh(&asset).positions[0], Vec3::ZERO);
    asset.json["meshes"][0]["weights"] = json!([0.5, 0.1]);
    let mesh = only_mesh(&asset);
    assert_eq!(
        mesh.positions,
        [Vec3::new(1.0, 0.0, 1.0), Vec3::new(2.0, 0.0, 0.0), Vec3::new(1.0, 1.0, 2.0)]
    );
    let normals = mesh.normals.unwrap();
    assert!(normals[0].abs_diff_eq(Vec3::new(0.5, 0.0, 1.0).normalize(), 1e-6));
}

#[test]
fn nodes_may_weigh_a_mesh_in_their_own_way() {
    let mut asset = morphing();
    asset.json["meshes"][0]["weights"] = json!([0, 0]);
    asset.json["nodes"] = json!([{"mesh": 0}, {"mesh": 0, "weights": [1, 0]}, {"mesh": 0}]);
    let imported = asset.import().unwrap();
    let meshes: Vec<_> = imported.scene.nodes.iter().map(|node| node.meshes[0]).collect();
    assert_eq!((imported.scene.meshes.len(), meshes[0]), (2, meshes[2]));
    assert_eq!(imported.scene.meshes[meshes[0]].positions[0].z, 0.0);
    assert_eq!(imported.scene.meshes[meshes[1]].positions[0].z, 2.0);
}

#[test]
fn targets_that_do_not_fit_are_named() {
    let mut asset = morphing();
    asset.json["meshes"][0]["weights"] = json!([1, 0]);
    let short = asset.float_accessor("VEC3", 3, &[0.0; 6]);
    let targets = json!([{"POSITION": short, "TEXCOORD_0": short}]);
    asset.json["meshes"][0]["primitives"][0]["targets"] = targets;
    let said = warnings(&asset.import().unwrap());
    assert!(said[0].contains("morph targets of TEXCOORD_0 are dropped"), "{said:?}");
    let dropped = "meshes[0].primitives[0].targets[0].POSITION: the target is dropped: it has not as many elements as \
                   POSITION";
    assert_eq!(said[1], dropped);
}

/// A triangle on a moved node whose vertices follow two joints: the first, half and half, the second.
fn skinned() -> Asset {
    let mut asset = Asset::triangle(json!({}));
    let joints = asset.accessor(UNSIGNED_BYTE, "VEC4", 3, &[0, 1, 0, 0].repeat(3), json!({}));
    let weights = [1.0, 0.0, 0.0, 0.0, 0.5, 0.5, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0];
    let weights = asset.float_accessor("VEC4", 4, &weights);
    let normals = asset.float_accessor("VEC3", 3, &[0.0, 0.0, 1.0].repeat(3));
    asset.attribute("JOINTS_0", joints);
    asset.attribute("WEIGHTS_0", weights);
    asset.attribute("NORMAL", normals);
    let mut inverses =
        [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0].repeat(2);
    // The second joint lies at (0, 1, 0) in the bind pose.
    inverses[16 + 13] = -1.0;
    let inverses = asset.float_accessor("MAT4", 16, &inverses);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    asset.json["nodes"] = json!([
        {"mesh": 0, "skin": 0, "translation": [100, 0, 0], "scale": [2, 2, 2]},
        {"translation": [0, 0, 5], "children": [2]},
        {"translation": [0, 1, 0], "rotation": [half, 0, 0, half]},
    ]);
    asset.json["skins"] = json!([{"joints": [1, 2], "inverseBindMatrices": inverses}]);
    asset
}

#[test]
fn vertices_follow_their_joints_whatever_the_node_of_the_mesh_says() {
    let imported = skinned().import().unwrap();
    assert_eq!(warnings(&imported), [""; 0]);
    let placed = imported.scene.placed();
    let placed = placed.iter().find(|placed| !placed.node.meshes.is_empty()).unwrap();
    let mesh = &imported.scene.meshes[placed.node.meshes[0]];
    let world: Vec<_> = mesh.positions.iter().map(|p| placed.world.transform_point3(p.as_dvec3())).collect();
    // Joint 0 moves by (0, 0, 5). Joint 1 turns about its own origin by 90° about X as well.
    let turned = DVec3::new(1.0, 1.0, 4.0);
    let expected =
        [DVec3::new(0.0, 0.0, 5.0), (DVec3::new(1.0, 0.0, 5.0) + turned) / 2.0, DVec3::new(0.0, 1.0, 5.0)];
    for (found, expected) in world.iter().zip(expected) {
        assert!(found.abs_diff_eq(expected, 1e-5), "{world:?}");
    }
    let normals = mesh.normals.as_ref().unwrap();
    assert!(
        normals[0].abs_diff_eq(Vec3::Z, 1e-6) && normals[2].abs_diff_eq(Vec3::NEG_Y, 1e-6),
        "{normals:?}"
    );
}

#[test]
fn broken_skins_are_errors() {
    let mut asset = skinned();
    asset.json["skins"][0]["joints"] = json!([1]);
    let (element, message) = failure(&asset);
    assert_eq!(element, "meshes[0].primitives[0].attributes.JOINTS_0");
    assert!(message.contains("joints[1]"), "{message}");
    asset.json["skins"][0]["joints"] = json!([1, 2, 0]);
    assert_eq!(failure(&asset).0, "skins[0].inverseBindMatrices");
    asset.json["skins"][0]["joints"] = json!([1, 77]);
    assert_eq!(failure(&asset).0, "skins[0].joints[1]");
    asset.json["nodes"][0]["skin"] = json!(3);
    assert_eq!(failure(&asset).0, "skins[0].joints[1]");
}

/// The largest distance from an axis of the vertices of a mesh.
fn reach(mesh: &Mesh) -> Vec3 {
    mesh.positions.iter().fold(Vec3::ZERO, |reach, p| reach.max(p.abs()))
}

#[test]
fn real_skins_and_targets_move() {
    let Some(assets) = shared() else { return };
    let choice = |seconds| Choice { moment: Some(Moment::Seconds(seconds)), ..Choice::default() };
    for (name, then) in [
        ("RiggedSimple/RiggedSimple.glb", 1.0),
        ("blender_03_skinned_cylinder/03_skinned_cylinder.gltf", 0.5),
        ("blender_01_morphed_cube/01_morphed_cube.gltf", 1.0),
        ("MorphPrimitivesTest/MorphPrimitivesTest.gltf", 0.0),
    ] {
        let path = assets.join("gltf").join(name);
        let [rest, first, later] = [Choice::default(), choice(0.0), choice(then)].map(|choice| {
            let imported = load_as(&path, &choice).unwrap();
            assert_eq!(warnings(&imported), [""; 0], "{name}");
            imported.scene.meshes.iter().map(reach).collect::<Vec<_>>()
        });
        assert!(rest.iter().chain(&first).all(|reach| reach.is_finite()));
        let moves = first != later;
        assert_eq!(moves, !name.starts_with("MorphPrimitives"), "{name}: {first:?} {later:?}");
    }
}
