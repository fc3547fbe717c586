use std::io::Cursor;

use ajar_scene::{ImageSource, Input, Light, Material, Mesh, Node, NormalMap, Severity, TextureInput};
use glam::Vec3;

use super::*;

fn png(width: u32, value: u8) -> ImageSource {
    let mut bytes = Cursor::new(Vec::new());
    let image = image::GrayImage::from_pixel(width, 1, image::Luma([value]));
    image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    ImageSource::Embedded(bytes.into_inner().into())
}

fn add_texture(scene: &mut Scene, name: &str, source: ImageSource) -> Id<ajar_scene::Texture> {
    let image = scene.images.push(Image { name: name.into(), source });
    scene.textures.push(ajar_scene::Texture::new(image))
}

fn input<T>(value: T, texture: Id<ajar_scene::Texture>) -> Input<T> {
    Input { value, texture: Some(TextureInput { texture, channel: Default::default() }) }
}

/// Shows a material on a mesh of its own.
fn show(scene: &mut Scene, material: Material, visible: bool) {
    let material = Some(scene.materials.push(material));
    let mesh = scene.meshes.push(Mesh { material, ..Mesh::default() });
    let node = scene.nodes.push(Node { meshes: vec![mesh], visible, ..Node::default() });
    scene.roots.push(node);
}

fn messages(diagnostics: &[Diagnostic]) -> Vec<&str> {
    diagnostics.iter().map(|diagnostic| diagnostic.message.as_str()).collect()
}

#[test]
fn only_what_is_seen_is_decoded_and_images_are_shared() {
    let mut scene = Scene::default();
    let base = add_texture(&mut scene, "base", png(2, 51));
    let again = scene.textures.push(scene.textures[base].clone());
    let sky = add_texture(&mut scene, "sky", png(1, 255));
    let garbage = || ImageSource::Embedded((*b"garbage").into());
    let (unused, hidden) =
        (add_texture(&mut scene, "unused", garbage()), add_texture(&mut scene, "hidden", garbage()));
    let map = NormalMap { texture: again, scale: 1.0 };
    let colored =
        Material { base_color: input(Vec3::ONE, base), normal_map: Some(map), ..Material::default() };
    show(&mut scene, colored, true);
    show(&mut scene, Material { roughness: input(1.0, hidden), ..Material::default() }, false);
    let kind = LightKind::Environment { radiance: 1.0, texture: Some(sky) };
    let light = Some(scene.lights.push(Light { name: String::new(), color: Vec3::ONE, kind }));
    let node = scene.nodes.push(Node { light, ..Node::default() });
    scene.roots.push(node);

    let (textures, diagnostics) = load_textures(&scene, 100);
    assert!(diagnostics.is_empty(), "{:?}", messages(&diagnostics));
    let (first, second) = (textures.get(base).unwrap(), textures.get(again).unwrap());
    assert!(std::ptr::eq(first.bitmap(), second.bitmap()));
    assert!((first.average().x - 0.2).abs() < 1e-6);
    assert_eq!(textures.get(sky).unwrap().average().x, 1.0);
    assert!(textures.get(unused).is_none() && textures.get(hidden).is_none());
    assert!(textures.get(Id::new(99)).is_none());
}

#[test]
fn a_node_material_replaces_the_meshes_own() {
    let mut scene = Scene::default();
    let (own, replacing) =
        (add_texture(&mut scene, "own", png(1, 0)), add_texture(&mut scene, "other", png(1, 0)));
    show(&mut scene, Material { metallic: input(1.0, own), ..Material::default() }, true);
    let other = scene.materials.push(Material { opacity: input(1.0, replacing), ..Material::default() });
    scene.nodes[scene.roots[0]].material = Some(other);
    let (textures, _) = load_textures(&scene, 100);
    assert!(textures.get(own).is_none() && textures.get(replacing).is_some());
}

#[test]
fn failures_are_errors_that_name_the_image() {
    let mut scene = Scene::default();
    let bad = add_texture(&mut scene, "bad", ImageSource::Embedded((*b"garbage").into()));
    let good = add_texture(&mut scene, "good", png(1, 0));
    let both = Material { coat: input(1.0, bad), emission: input(Vec3::ONE, good), ..Material::default() };
    show(&mut scene, both, true);
    let (textures, diagnostics) = load_textures(&scene, 100);
    assert!(textures.get(bad).is_none() && textures.get(good).is_some());
    assert_eq!(diagnostics.len(), 1);
    assert_eq!(diagnostics[0].severity, Severity::Error);
    assert!(diagnostics[0].message.contains("\"bad\""));
}

#[test]
fn memory_goes_to_the_first_images() {
    let mut scene = Scene::default();
    for (name, width) in [("a", 60), ("b", 50), ("c", 40)] {
        let texture = add_texture(&mut scene, name, png(width, 0));
        show(&mut scene, Material { metallic: input(1.0, texture), ..Material::default() }, true);
    }
    let (textures, diagnostics) = load_textures(&scene, 100);
    let loaded: Vec<bool> = scene.textures.ids().map(|id| textures.get(id).is_some()).collect();
    assert_eq!(loaded, [true, false, true]);
    assert!(diagnostics[0].message.contains("\"b\""), "{:?}", messages(&diagnostics));
}

#[test]
fn repaired_numbers_are_a_warning() {
    let floats = vec![f32::NAN, 1.0, 2.0];
    let image = image::DynamicImage::ImageRgb32F(image::ImageBuffer::from_raw(1, 1, floats).unwrap());
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, image::ImageFormat::Tiff).unwrap();
    let mut scene = Scene::default();
    let texture = add_texture(&mut scene, "glow", ImageSource::Embedded(bytes.into_inner().into()));
    show(&mut scene, Material { emission: input(Vec3::ONE, texture), ..Material::default() }, true);
    let (textures, diagnostics) = load_textures(&scene, 100);
    assert_eq!(textures.get(texture).unwrap().average().x, 0.0);
    assert_eq!((diagnostics.len(), diagnostics[0].severity), (1, Severity::Warning));
    assert!(diagnostics[0].message.contains("\"glow\": 1 values"));
}
