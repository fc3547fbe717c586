//! The scene graph's operations on whole scenes.

mod bounds;
mod edit;
mod hash;
mod validate;

use glam::{Vec2, Vec3, Vec4};

use ajar_scene::*;

/// A scene with one of everything, valid.
fn sample() -> Scene {
    let mut scene = Scene::default();
    let source = ImageSource::Embedded(vec![1, 2, 3].into());
    let image = scene.images.push(Image { name: "pixels".into(), source });
    let texture = scene.textures.push(Texture::new(image));
    let mut material = Material { name: "Chrome".into(), ..Material::default() };
    material.base_color.texture = Some(TextureInput { texture, channel: Channel::R });
    material.normal_map = Some(NormalMap { texture, scale: 1.0 });
    material.alpha_mode = AlphaMode::Mask(0.5);
    let material = scene.materials.push(material);
    let mesh = scene.meshes.push(Mesh {
        name: "Bulb".into(),
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        triangles: vec![[0, 1, 2]],
        normals: Some(vec![Vec3::Z; 3]),
        tangents: Some(vec![Vec4::new(1.0, 0.0, 0.0, 1.0); 3]),
        uvs: vec![vec![Vec2::ZERO; 3]],
        colors: Some(vec![Vec4::ONE; 3]),
        material: Some(material),
    });
    let kind = LightKind::Environment { radiance: 1.0, texture: Some(texture) };
    let light = scene.lights.push(Light { name: "sky".into(), color: Vec3::ONE, kind });
    let (camera, transform) = framing_camera(&scene, 1.0);
    let camera = scene.cameras.push(camera);
    let lamp = scene.nodes.push(Node {
        name: "Lamp".into(),
        meshes: vec![mesh],
        material: Some(material),
        ..Node::default()
    });
    scene.add_root(Node {
        name: "World".into(),
        children: vec![lamp],
        light: Some(light),
        ..Node::default()
    });
    scene.add_root(Node { name: "View".into(), transform, camera: Some(camera), ..Node::default() });
    scene
}
