//! One broken scene a rule, with exactly what is said.

use glam::{DAffine3, DVec3, Vec2, Vec3};

use crate::sample;
use ajar_scene::*;

const NODE: Id<Node> = Id::new(0);
const MESH: Id<Mesh> = Id::new(0);
const MATERIAL: Id<Material> = Id::new(0);
const CAMERA: Id<Camera> = Id::new(0);
const LIGHT: Id<Light> = Id::new(0);

#[test]
fn sample_is_valid() {
    assert_eq!(sample().validate(), []);
    assert_eq!(Scene::default().validate(), []);
}

type Case = (fn(&mut Scene), &'static str);

fn check(cases: &[Case]) {
    for (index, (edit, expected)) in cases.iter().enumerate() {
        let mut scene = sample();
        edit(&mut scene);
        let said: Vec<_> = scene.validate().iter().map(ToString::to_string).collect();
        assert_eq!(said, [*expected], "case {index}");
    }
}

#[test]
fn hierarchy() {
    check(&[
        (
            |s| s.nodes[NODE].transform.translation.x = f64::NAN,
            "error: node \"Lamp\": the transform is not finite",
        ),
        (
            |s| s.nodes[NODE].transform = DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0)),
            "warning: node \"Lamp\": the transform flattens space; meshes and lights here and below are hidden",
        ),
        (
            |s| s.nodes[NODE].children.push(Id::new(9)),
            "error: node \"Lamp\": names child #9, which does not exist",
        ),
        (
            |s| s.nodes[NODE].meshes.push(Id::new(1)),
            "error: node \"Lamp\": names mesh #1, which does not exist",
        ),
        (
            |s| s.nodes[NODE].material = Some(Id::new(7)),
            "error: node \"Lamp\": names material #7, which does not exist",
        ),
        (
            |s| s.nodes[NODE].light = Some(Id::new(7)),
            "error: node \"Lamp\": names light #7, which does not exist",
        ),
        (
            |s| s.nodes[NODE].camera = Some(Id::new(7)),
            "error: node \"Lamp\": names camera #7, which does not exist",
        ),
        (|s| s.roots.push(Id::new(7)), "error: roots: name node #7, which does not exist"),
        (
            |s| s.roots.push(NODE),
            "error: node \"Lamp\": is named 2 times as child or root; a node has one parent",
        ),
        (
            |s| {
                s.nodes.push(Node { children: vec![Id::new(3)], ..Node::default() });
            },
            "error: node #3: is its own ancestor",
        ),
    ]);
    let mut scene = sample();
    scene.nodes[NODE].transform = DAffine3::from_scale(DVec3::splat(1e-6));
    assert_eq!(scene.validate(), [], "small is not flat");
}

#[test]
fn long_cycles_and_deep_chains_end() {
    let mut scene = Scene::default();
    for i in 0..100_000 {
        scene.nodes.push(Node { children: vec![Id::new((i + 1) % 100_000)], ..Node::default() });
    }
    let said: Vec<_> = scene.validate().iter().map(ToString::to_string).collect();
    assert_eq!(said, ["error: node #0: is its own ancestor"]);
    scene.nodes[Id::new(99_999)].children.clear();
    scene.roots.push(Id::new(0));
    assert_eq!(scene.validate(), []);
}

#[test]
fn meshes() {
    check(&[
        (|s| s.meshes[MESH].triangles.clear(), "warning: node \"Lamp\"/mesh \"Bulb\": has no triangles"),
        (
            |s| s.meshes[MESH].triangles.extend([[0, 1, 3], [7, 0, 0]]),
            "error: node \"Lamp\"/mesh \"Bulb\": triangle 1 names vertices [0, 1, 3] of 3, like 1 more triangles",
        ),
        (
            |s| s.meshes[MESH].positions[1].y = f32::INFINITY,
            "error: node \"Lamp\"/mesh \"Bulb\": positions[1] is not finite",
        ),
        (
            |s| s.meshes[MESH].normals = Some(vec![Vec3::NAN; 3]),
            "error: node \"Lamp\"/mesh \"Bulb\": normals[0] is not finite, like 2 more of them",
        ),
        (
            |s| s.meshes[MESH].normals = Some(vec![Vec3::Z; 2]),
            "error: node \"Lamp\"/mesh \"Bulb\": has 2 normals for 3 positions",
        ),
        (
            |s| s.meshes[MESH].tangents = Some(vec![]),
            "error: node \"Lamp\"/mesh \"Bulb\": has 0 tangents for 3 positions",
        ),
        (
            |s| s.meshes[MESH].uvs.push(vec![Vec2::ZERO; 4]),
            "error: node \"Lamp\"/mesh \"Bulb\": has 4 uvs[1] for 3 positions",
        ),
        (
            |s| s.meshes[MESH].uvs[0][2].x = f32::NAN,
            "error: node \"Lamp\"/mesh \"Bulb\": uvs[0][2] is not finite",
        ),
        (
            |s| s.meshes[MESH].colors = Some(vec![]),
            "error: node \"Lamp\"/mesh \"Bulb\": has 0 colors for 3 positions",
        ),
        (
            |s| s.meshes[MESH].material = Some(Id::new(4)),
            "error: node \"Lamp\"/mesh \"Bulb\": names material #4, which does not exist",
        ),
        (
            |s| {
                s.meshes.push(Mesh::default());
            },
            "warning: mesh #1: has no triangles",
        ),
    ]);
}

#[test]
fn parts() {
    check(&[
        (
            |s| s.materials[MATERIAL].roughness.value = 1.5,
            "warning: material \"Chrome\": roughness is 1.5; it is used as 1",
        ),
        (
            |s| s.materials[MATERIAL].base_color.value = Vec3::splat(-1.0),
            "warning: material \"Chrome\": base_color is -1; it is used as 0",
        ),
        (|s| s.materials[MATERIAL].ior = 0.5, "warning: material \"Chrome\": ior is 0.5; it is used as 1"),
        (
            |s| s.materials[MATERIAL].emission.value.y = -2.0,
            "warning: material \"Chrome\": emission is -2; it is used as 0",
        ),
        (
            |s| s.materials[MATERIAL].anisotropy_rotation = f32::NAN,
            "error: material \"Chrome\": anisotropy_rotation is not finite",
        ),
        (
            |s| {
                s.materials[MATERIAL].coat.texture =
                    Some(TextureInput { texture: Id::new(3), channel: Channel::R })
            },
            "error: material \"Chrome\": names texture #3, which does not exist",
        ),
        (
            |s| s.textures[Id::new(0)].image = Id::new(3),
            "error: texture #0: names image #3, which does not exist",
        ),
        (
            |s| s.textures[Id::new(0)].scale.x = f32::NAN,
            "error: texture #0: transform, scale or bias is not finite",
        ),
        (
            |s| s.lights[LIGHT].color.x = -1.0,
            "error: node \"World\"/light \"sky\": color must be at least 0, is -1",
        ),
        (
            |s| s.lights[LIGHT].kind = LightKind::Environment { radiance: 1.0, texture: Some(Id::new(3)) },
            "error: node \"World\"/light \"sky\": names texture #3, which does not exist",
        ),
        (
            |s| {
                let image = s.images.ids().next().unwrap();
                let turned = Texture { transform: glam::Affine2::from_angle(1.0), ..Texture::new(image) };
                let texture = Some(s.textures.push(turned));
                s.lights[LIGHT].kind = LightKind::Environment { radiance: 1.0, texture };
            },
            "warning: node \"World\"/light \"sky\": its image surrounds everything: the transform of the \
             texture is ignored\n  hint: turn the light",
        ),
        (
            |s| s.lights[LIGHT].kind = LightKind::Spot { intensity: 1.0, inner: 1.0, outer: 0.5 },
            "error: node \"World\"/light \"sky\": inner must lie between 0 and outer, is 1",
        ),
        (
            |s| s.lights[LIGHT].kind = LightKind::Spot { intensity: 1.0, inner: 1.0, outer: 2.0 },
            "error: node \"World\"/light \"sky\": outer must lie in (0, π/2], is 2",
        ),
        (
            |s| s.lights[LIGHT].kind = LightKind::Sphere { radiance: f32::NAN, radius: 1.0 },
            "error: node \"World\"/light \"sky\": radiance is not finite",
        ),
        (
            |s| s.cameras[CAMERA].exposure = -1.0,
            "error: node \"View\"/camera \"default\": exposure must be at least 0, is -1",
        ),
        (
            |s| s.cameras[CAMERA].projection = Projection::Orthographic { half_height: 0.0 },
            "error: node \"View\"/camera \"default\": half_height must be greater than 0, is 0",
        ),
    ]);
    let mut scene = sample();
    scene.cameras[CAMERA].projection =
        Projection::Perspective { yfov: 3.2, lens_radius: 0.0, focus_distance: 1.0, shift: [0.0; 2] };
    assert_eq!(
        scene.validate()[0].to_string(),
        "error: node \"View\"/camera \"default\": yfov must lie in (0, π), is 3.2"
    );
}

/// What is said about numbers out of range is what `in_range` does.
#[test]
fn in_range_is_valid() {
    let mut wild = Material { ior: 0.0, coat_ior: -1.0, ..Material::default() };
    wild.base_color.value = Vec3::new(-1.0, 0.5, 2.0);
    wild.emission.value = Vec3::new(-1.0, 0.5, 2.0);
    wild.attenuation_distance = -3.0;
    wild.metallic.value = 7.0;
    let tame = wild.in_range();
    assert_eq!(tame.base_color.value, Vec3::new(0.0, 0.5, 1.0));
    assert_eq!(tame.emission.value, Vec3::new(0.0, 0.5, 2.0));
    assert_eq!(
        (tame.ior, tame.coat_ior, tame.attenuation_distance, tame.metallic.value),
        (1.0, 1.0, 0.0, 1.0)
    );
    let mut scene = Scene::default();
    scene.materials.push(tame);
    assert_eq!(scene.validate(), []);
    assert_eq!(Material::default().in_range(), Material::default());
}

#[test]
fn a_missing_uv_set_is_said_once_a_mesh_and_material() {
    let mut scene = sample();
    scene.textures[Id::new(0)].uv_set = 1;
    // Placed again: nothing new to say.
    let again = scene.nodes[NODE].clone();
    let again = scene.nodes.push(again);
    scene.roots.push(again);
    let said: Vec<_> = scene.validate().iter().map(ToString::to_string).collect();
    let warning = "warning: node \"Lamp\"/mesh \"Bulb\": material \"Chrome\" has a texture on UV set 1, which the \
                   mesh lacks; its colour at (0, 0) is used";
    assert_eq!(said, [warning]);
    scene.meshes[MESH].uvs.push(vec![Vec2::ONE; 3]);
    assert_eq!(scene.validate(), []);
}

#[test]
fn repetition_is_counted() {
    let mut scene = sample();
    for _ in 0..10 {
        scene.meshes.push(Mesh::default());
    }
    scene.materials[MATERIAL].ior = f32::NAN;
    let said: Vec<_> = scene.validate().iter().map(ToString::to_string).collect();
    assert_eq!(
        said,
        [
            "warning: mesh #1: has no triangles",
            "warning: mesh #2: has no triangles",
            "warning: mesh #3: has no triangles",
            "warning: and 7 more: meshes without triangles",
            "error: material \"Chrome\": ior is not finite",
        ]
    );
}
