//! What is taken over from an earlier world: the result is that of a fresh preparation, and what did not change is shared.

#![allow(clippy::unwrap_used, reason = "a failing test panics")]

use std::{collections::BTreeSet, io::Cursor, path::PathBuf};

use ajar_scene::{
    Camera, Image, ImageSource, Input, Light, LightKind, Material, Node, NormalMap, Projection, Texture,
    TextureInput,
};
use glam::{DAffine3, Vec2, Vec3};

use super::*;

fn png(value: u8) -> ImageSource {
    let mut bytes = Cursor::new(Vec::new());
    let image = image::RgbImage::from_pixel(4, 2, image::Rgb([value, 100, 255]));
    image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    ImageSource::Embedded(bytes.into_inner().into())
}

fn quad(material: Id<Material>) -> Mesh {
    Mesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::ONE, Vec3::Y],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        normals: Some(vec![Vec3::Z; 4]),
        uvs: vec![vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y]],
        material: Some(material),
        ..Mesh::default()
    }
}

fn add(scene: &mut Scene, node: Node) {
    let id = scene.nodes.push(node);
    scene.roots.push(id);
}

fn add_light(scene: &mut Scene, kind: LightKind, at: DVec3) {
    let light = Some(scene.lights.push(Light { name: String::new(), color: Vec3::ONE, kind }));
    add(scene, Node { light, transform: DAffine3::from_translation(at), ..Node::default() });
}

/// Two quads of which one has a normal map, a mesh placed often enough for a tree of its own, a lamp, a sky, a sun.
fn scene() -> Scene {
    let mut scene = Scene::default();
    let image = |scene: &mut Scene, value: u8| {
        scene.images.push(Image { name: value.to_string(), source: png(value) })
    };
    let (first, second) = (image(&mut scene, 10), image(&mut scene, 200));
    let (bumps, sky) = (scene.textures.push(Texture::new(first)), scene.textures.push(Texture::new(second)));
    let color =
        Input { value: Vec3::ONE, texture: Some(TextureInput { texture: sky, channel: Default::default() }) };
    let normal_map = Some(NormalMap { texture: bumps, scale: 1.0 });
    let plain = scene.materials.push(Material { base_color: color, ..Material::default() });
    let bumpy = scene.materials.push(Material { normal_map, ..Material::default() });
    for (i, material) in [plain, bumpy].into_iter().enumerate() {
        let mesh = scene.meshes.push(quad(material));
        let transform = DAffine3::from_translation(DVec3::X * i as f64);
        add(&mut scene, Node { meshes: vec![mesh], transform, ..Node::default() });
    }
    let mut many = quad(plain);
    many.triangles = many.triangles.repeat(200);
    let mesh = scene.meshes.push(many);
    for i in 0..200 {
        let transform = DAffine3::from_translation(DVec3::new(0.1, 0.2, 0.3) * f64::from(i));
        add(&mut scene, Node { meshes: vec![mesh], transform, ..Node::default() });
    }
    add_light(&mut scene, LightKind::Sphere { radiance: 5.0, radius: 0.1 }, DVec3::Z);
    add_light(&mut scene, LightKind::Environment { radiance: 1.0, texture: Some(sky) }, DVec3::ZERO);
    add_light(&mut scene, LightKind::Directional { illuminance: 3.0, angle: 0.1 }, DVec3::ZERO);
    let projection =
        Projection::Perspective { yfov: 1.0, lens_radius: 0.0, focus_distance: 1.0, shift: [0.0; 2] };
    let camera =
        Some(scene.cameras.push(Camera { name: "main".into(), projection, aspect: None, exposure: 1.0 }));
    add(
        &mut scene,
        Node { camera, transform: DAffine3::from_translation(DVec3::Z * 9.0), ..Node::default() },
    );
    scene
}

fn options() -> PrepareOptions {
    PrepareOptions {
        camera: (Id::new(0), DAffine3::from_translation(DVec3::Z * 9.0)),
        size: [16, 9],
        texture_memory: 1 << 20,
    }
}

/// Which parts two worlds share: the baked tree, that of lamps, that of the mesh placed often, the image of the normal
/// map, tangents, surroundings.
fn shared(a: &World, b: &World) -> [bool; 6] {
    let image = |world: &World| std::ptr::from_ref(world.textures.get(Id::new(0)).unwrap().bitmap());
    let tangents = |world: &World| world.tangents[1].as_ref().map(|it| Arc::clone(&it.corners));
    let sky = |world: &World| world.lights.shared_environment();
    let same = |a: Option<Arc<_>>, b: Option<Arc<_>>| a.zip(b).is_some_and(|(a, b)| Arc::ptr_eq(&a, &b));
    let trees = a.geometry.shared(&b.geometry);
    let sky = sky(a).zip(sky(b)).is_some_and(|(a, b)| Arc::ptr_eq(&a, &b));
    [trees[0], trees[1], trees[2], std::ptr::eq(image(a), image(b)), same(tangents(a), tangents(b)), sky]
}

/// Changes the scene; the world prepared after that of the old scene is a fresh one and shares what `wanted` says.
#[track_caller]
fn check(change: impl FnOnce(&mut Scene), wanted: [bool; 6]) {
    let mut scene = scene();
    let (old, _) = prepare(scene.clone(), &options()).unwrap();
    change(&mut scene);
    let (fresh, said) = prepare(scene.clone(), &options()).unwrap();
    let none = BTreeSet::<PathBuf>::new();
    let previous = Previous { world: &old, changed: &none };
    let (after, said_after) = prepare_after(scene, &options(), Some(previous)).unwrap();
    assert_eq!(format!("{after:?}"), format!("{fresh:?}"));
    assert_eq!((shared(&old, &after), said_after), (wanted, said));
    assert_eq!(shared(&old, &fresh), [false; 6], "the check sees what is not shared");
}

#[test]
fn a_scene_that_did_not_change_is_shared_whole() {
    check(|_| {}, [true; 6]);
}

#[test]
fn materials_and_cameras_leave_everything_else() {
    check(|scene| scene.materials[Id::new(0)].roughness.value = 0.1, [true; 6]);
    check(|scene| scene.cameras[Id::new(0)].exposure = 2.0, [true; 6]);
}

#[test]
fn a_texture_replaces_itself_and_what_is_made_of_it() {
    check(|scene| scene.images[Id::new(0)].source = png(90), [true, true, true, false, true, true]);
    check(|scene| scene.images[Id::new(1)].source = png(90), [true, true, true, true, true, false]);
    let clamp = |scene: &mut Scene| scene.textures[Id::new(1)].bias.x = 0.5;
    check(clamp, [true, true, true, true, true, false]);
}

#[test]
fn light_strength_leaves_geometry() {
    let stronger = |scene: &mut Scene| {
        scene.lights[Id::new(0)].kind = LightKind::Sphere { radiance: 50.0, radius: 0.1 };
    };
    check(stronger, [true; 6]);
    let sun = |scene: &mut Scene| scene.lights[Id::new(2)].color = Vec3::X;
    check(sun, [true, true, true, true, true, false]);
}

#[test]
fn a_lamp_that_grows_or_moves_touches_only_the_tree_of_lamps() {
    let grow = |scene: &mut Scene| {
        scene.lights[Id::new(0)].kind = LightKind::Sphere { radiance: 5.0, radius: 0.3 };
    };
    check(grow, [true, false, true, true, true, true]);
    let moved = |scene: &mut Scene| scene.nodes[Id::new(202)].transform.translation.x = 0.25;
    check(moved, [true, false, true, true, true, true]);
}

#[test]
fn a_mesh_that_changes_touches_the_trees_that_it_is_in() {
    let bend = |mesh: usize| move |scene: &mut Scene| scene.meshes[Id::new(mesh)].positions[2].z = 0.5;
    check(bend(0), [false, true, true, true, true, true]);
    check(bend(1), [false, true, true, true, false, true]);
    check(bend(2), [true, true, false, true, true, true]);
    let moved =
        |node: usize| move |scene: &mut Scene| scene.nodes[Id::new(node)].transform.translation.y = 0.7;
    check(moved(0), [false, true, true, true, true, true]);
    check(moved(7), [true, true, true, true, true, true]);
}

#[test]
fn zeros_of_both_signs_are_not_the_same_shape() {
    check(|scene| scene.meshes[Id::new(0)].positions[0].x = -0.0, [false, true, true, true, true, true]);
}

#[test]
fn more_or_fewer_instances_are_no_problem() {
    check(|scene| scene.nodes[Id::new(0)].visible = false, [false, false, true, true, true, true]);
    let more = |scene: &mut Scene| add(scene, Node { meshes: vec![Id::new(0)], ..Node::default() });
    check(more, [false, true, true, true, true, true]);
    let other = |scene: &mut Scene| {
        let mesh = scene.meshes.push(quad(Id::new(0)));
        add(scene, Node { meshes: vec![mesh], ..Node::default() });
    };
    check(other, [false, false, true, true, true, true]);
}

#[test]
fn another_camera_sees_the_same_world() {
    let scene = scene();
    let (world, _) = prepare(scene.clone(), &options()).unwrap();
    let aside = DAffine3::from_translation(DVec3::new(3.0, 1.0, 7.0));
    let options = PrepareOptions { camera: (Id::new(0), aside), size: [20, 30], ..options() };
    let moved = world.seen_by(&scene.cameras[Id::new(0)], &aside, [20, 30]);
    let (fresh, _) = prepare(scene, &options).unwrap();
    assert_eq!(format!("{moved:?}"), format!("{fresh:?}"));
}
