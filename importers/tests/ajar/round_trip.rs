//! What was written is read again as it was.

use std::{
    fs,
    path::{Path, PathBuf},
};

use ajar_importers::ajar::write;
use ajar_scene::{
    AlphaMode, Camera, Channel, ColorSpace, Filter, Id, Image, ImageSource, Input, Light, LightKind,
    Material, Mesh, Node, NormalMap, Preference, Projection, Scene, Texture, TextureInput, Wrap,
};
use glam::{Affine2, DAffine3, DVec3, Vec2, Vec3, Vec4};
use serde_json::json;

use super::{import, import_json};

/// A scene in which everything differs from its default, with numbers that decimals cannot write.
fn full() -> Scene {
    let mut scene = Scene::default();
    let image =
        scene.images.push(Image { name: "dots".into(), source: ImageSource::Embedded(vec![1, 2, 3].into()) });
    let texture = scene.textures.push(Texture {
        color_space: ColorSpace::Srgb,
        wrap_u: Wrap::Mirror,
        wrap_v: Wrap::Black,
        filter: Filter::Nearest,
        uv_set: 1,
        transform: Affine2::from_scale_angle_translation(Vec2::new(0.1, 0.3), 0.7, Vec2::ONE / 3.0),
        scale: Vec4::new(0.1, 0.2, 0.3, 0.4),
        bias: Vec4::splat(0.1),
        image,
    });
    let input = TextureInput { texture, channel: Channel::B };
    let number = |value| Input { value, texture: Some(input) };
    let color = |x| Input { value: Vec3::new(x, 1.0 / 3.0, 1e-30), texture: Some(input) };
    // Every field is written out, so that a new one is not forgotten here.
    let material = scene.materials.push(Material {
        name: "red \"one\"".into(),
        path: "/World/Looks/All".into(),
        base_color: color(0.1),
        diffuse_roughness: number(0.11),
        metallic: number(0.12),
        roughness: number(0.13),
        anisotropy: number(0.14),
        anisotropy_rotation: -0.15,
        anisotropy_direction: Some(texture),
        specular: number(0.16),
        specular_color: color(0.17),
        ior: 1.18,
        dispersion: 0.19,
        transmission: number(0.2),
        thin_walled: true,
        diffuse_transmission: number(0.21),
        diffuse_transmission_color: color(0.22),
        attenuation_color: Vec3::new(0.23, 1.0 / 3.0, 0.0),
        attenuation_distance: 0.7,
        sheen_color: color(0.24),
        sheen_roughness: number(0.25),
        film: number(0.26),
        film_ior: 1.27,
        film_thickness: number(280.3),
        coat: number(0.29),
        coat_roughness: number(0.3),
        coat_ior: 1.31,
        emission: color(1e9 / 3.0),
        double_sided: false,
        cull_back: true,
        opacity: number(0.32),
        alpha_mode: AlphaMode::Mask(0.3),
        normal_map: Some(NormalMap { texture, scale: 0.9 }),
        coat_normal_map: Some(NormalMap { texture, scale: -0.1 }),
        unlit: true,
    });
    scene.materials.push(Material { alpha_mode: AlphaMode::Blend, ..Material::default() });
    let mesh = scene.meshes.push(Mesh {
        name: "triangle".into(),
        positions: vec![Vec3::ZERO, Vec3::X / 3.0, Vec3::Y * 0.1],
        triangles: vec![[0, 1, 2]],
        normals: Some(vec![Vec3::Z; 3]),
        tangents: Some(vec![Vec4::X - Vec4::W; 3]),
        uvs: vec![vec![Vec2::splat(0.1); 3], vec![Vec2::Y; 3]],
        colors: Some(vec![Vec4::splat(0.2); 3]),
        material: Some(material),
    });
    let sun = LightKind::Directional { illuminance: 0.1, angle: 0.009 };
    let light = scene.lights.push(Light { name: "sun".into(), color: Vec3::new(1.0, 0.9, 0.7), kind: sun });
    for kind in [
        LightKind::Point { intensity: 0.1 },
        LightKind::Spot { intensity: 0.1, inner: 0.2, outer: 0.3 },
        LightKind::Rect { radiance: 0.1, width: 0.2, height: 0.3, texture: Some(texture) },
        LightKind::Disk { radiance: 0.1, radius: 0.2 },
        LightKind::Sphere { radiance: 0.1, radius: 0.2 },
        LightKind::Cylinder { radiance: 0.1, radius: 0.2, length: 0.3 },
        LightKind::Environment { radiance: 0.1, texture: Some(texture) },
    ] {
        let light = scene.lights.push(Light { name: format!("{kind:?}"), color: Vec3::ONE / 3.0, kind });
        scene.add_root(Node { light: Some(light), ..Node::default() });
    }
    let projection =
        Projection::Perspective { yfov: 0.7, lens_radius: 0.01, focus_distance: 3.3, shift: [0.1, -0.2] };
    let camera =
        scene.cameras.push(Camera { name: "main".into(), projection, aspect: Some(1.7), exposure: 0.3 });
    let seen_flat = Projection::Orthographic { half_height: 0.1 };
    let flat = scene.cameras.push(Camera {
        name: "flat".into(),
        projection: seen_flat,
        aspect: None,
        exposure: 1.0,
    });
    scene.add_root(Node { camera: Some(flat), ..Node::default() });
    let leaf =
        scene.nodes.push(Node { name: "leaf".into(), meshes: vec![mesh], visible: false, ..Node::default() });
    scene.add_root(Node {
        transform: DAffine3::from_translation(DVec3::new(0.1, 1.0 / 3.0, 1e9)),
        children: vec![leaf],
        light: Some(light),
        camera: Some(camera),
        material: Some(material),
        ..Node::default()
    });
    scene
}

#[test]
fn everything_comes_back() {
    let render = Preference { camera: Some("main".into()), size: Some([3, 2]) };
    let again = import(&write(&full(), &render).unwrap()).unwrap();
    assert_eq!(again.scene, full());
    assert_eq!(again.render, render);
    assert_eq!(again.diagnostics, []);
}

#[test]
fn what_is_left_out_has_its_default() {
    let scene = import_json(&json!({
        "ajar": 1,
        "nodes": [{}],
        "materials": [{ "roughness": 0.25, "base_color": { "value": [1, 0, 0], "texture": { "texture": 0 } } }],
        "textures": [{ "image": 0 }],
        "lights": [{ "kind": { "point": { "intensity": 3 } } }],
        "cameras": [{ "projection": { "orthographic": { "half_height": 2 } } }],
    }))
    .unwrap()
    .scene;
    assert_eq!(scene.nodes[Id::new(0)], Node::default());
    let texture = Some(TextureInput { texture: Id::new(0), channel: Channel::R });
    let expected = Material {
        roughness: Input::constant(0.25),
        base_color: Input { value: Vec3::X, texture },
        ..Material::default()
    };
    assert_eq!(scene.materials[Id::new(0)], expected);
    assert_eq!(scene.textures[Id::new(0)], Texture::new(Id::new(0)));
    assert_eq!(scene.lights[Id::new(0)].color, Vec3::ONE);
    assert_eq!(scene.cameras[Id::new(0)].exposure, 1.0);
}

fn assets() -> Option<PathBuf> {
    let root = std::env::var_os("AJAR_SHARED").map(PathBuf::from);
    let root = root.unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared"));
    Some(root.join("assets")).filter(|folder| folder.is_dir())
}

fn collect(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap().flatten() {
        let path = entry.path();
        if path.is_dir() {
            collect(&path, found);
        } else if path.extension().is_some_and(|e| e == "gltf" || e == "glb" || e == "obj") {
            found.push(path);
        }
    }
}

/// Real files keep their content hash, which covers the bytes of their images.
#[test]
fn real_files_come_back() {
    let Some(assets) = assets() else {
        eprintln!("skipped: no shared assets");
        return;
    };
    let mut files = Vec::new();
    collect(&assets, &mut files);
    let mut checked = 0;
    for file in files {
        let Ok(imported) = ajar_importers::import(&ajar_scene::ImportRequest::new(&file)) else { continue };
        let Ok(bytes) = write(&imported.scene, &imported.render) else { continue };
        let again = import(&bytes).unwrap();
        assert_eq!(again.scene.content_hash(), imported.scene.content_hash(), "{}", file.display());
        checked += 1;
    }
    assert!(checked > 20, "only {checked}");
}
