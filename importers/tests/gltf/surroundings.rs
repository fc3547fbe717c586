//! EXT_lights_image_based.

use std::io::Cursor;

use ajar_scene::{ImageSource, Imported, LightKind, Severity};
use glam::{DQuat, DVec3};
use image::{DynamicImage, ImageBuffer, ImageFormat, Rgba};
use serde_json::{Value, json};

use crate::{
    build::{Asset, data_uri},
    failure, messages, warnings,
};

const NAME: &str = "EXT_lights_image_based";
const ELEMENT: &str = "extensions.EXT_lights_image_based.lights[0]";

/// Linear, of one colour a face: +X, −X, +Y, −Y, +Z, −Z.
const COLORS: [[f32; 3]; 6] =
    [[1.0, 0.0, 0.0], [0.0, 1.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 1.0], [0.0, 0.0, 1.0], [1.0, 1.0, 0.0]];

const AXES: [DVec3; 6] = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];

fn file(format: ImageFormat, side: u32, texel: impl Fn(u32, u32) -> [u8; 4]) -> Vec<u8> {
    let image = DynamicImage::from(ImageBuffer::from_fn(side, side, |x, y| Rgba(texel(x, y))));
    let mut file = Cursor::new(Vec::new());
    match format {
        ImageFormat::Jpeg => image.to_rgb8().write_to(&mut file, format),
        _ => image.write_to(&mut file, format),
    }
    .unwrap();
    file.into_inner()
}

/// A triangle in the middle of a cube with these faces; the light has these members besides.
fn asset(faces: &[Vec<u8>], members: Value) -> Asset {
    let mut asset = Asset::triangle(json!({}));
    asset.json["images"] = faces.iter().map(|face| json!({"uri": data_uri(face)})).collect();
    let mut light =
        json!({"irradianceCoefficients": [], "specularImageSize": 4, "specularImages": [[0, 1, 2, 3, 4, 5]]});
    light.as_object_mut().unwrap().extend(members.as_object().unwrap().clone());
    asset.json["extensions"] = json!({NAME: {"lights": [light]}});
    asset.json["scenes"] = json!([{"nodes": [0], "extensions": {NAME: {"light": 0}}}]);
    asset
}

fn plain(format: ImageFormat) -> Vec<Vec<u8>> {
    let byte = |value: f32| (value * 255.0) as u8;
    let face = |[r, g, b]: [f32; 3]| file(format, 4, |_, _| [byte(r), byte(g), byte(b), 255]);
    COLORS.map(face).to_vec()
}

/// The light's radiance from a direction of the world, as the scene's conventions say.
fn radiance(imported: &Imported, direction: DVec3) -> [f32; 3] {
    let scene = &imported.scene;
    let node = scene.roots.iter().map(|&root| &scene.nodes[root]).find(|node| node.light.is_some()).unwrap();
    let LightKind::Environment { radiance, texture } = scene.lights[node.light.unwrap()].kind else {
        panic!()
    };
    let ImageSource::Embedded(file) = &scene.images[scene.textures[texture.unwrap()].image].source else {
        panic!()
    };
    let image = image::load_from_memory(file).unwrap().into_rgb32f();
    let DVec3 { x, y, z } = node.transform.matrix3.inverse() * direction;
    let u = 0.5 - x.atan2(z) / std::f64::consts::TAU;
    let v = y.acos() / std::f64::consts::PI;
    let index = |place: f64, count: u32| ((place * f64::from(count)) as u32).min(count - 1);
    image.get_pixel(index(u, image.width()), index(v, image.height())).0.map(|value| value * radiance)
}

fn close(a: [f32; 3], b: [f32; 3]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() < 0.01)
}

#[test]
fn every_face_is_seen_where_it_lies() {
    for format in [ImageFormat::Png, ImageFormat::Jpeg] {
        let imported = asset(&plain(format), json!({"name": "studio"})).import().unwrap();
        assert_eq!(warnings(&imported), [""; 0]);
        assert!(
            messages(&imported, Severity::Note)[0].starts_with(&format!("{ELEMENT}: the blurred levels"))
        );
        assert_eq!(imported.scene.lights.iter().next().unwrap().name, "studio");
        for (axis, color) in AXES.into_iter().zip(COLORS) {
            assert!(close(radiance(&imported, axis), color), "{format:?} {axis} {color:?}");
        }
    }
}

/// Upper left quarters are marked; where they are must fit the neighbours, as in a room.
#[test]
fn faces_are_upright_seen_from_inside() {
    let marked = file(ImageFormat::Png, 16, |x, y| if x < 8 && y < 8 { [255; 4] } else { [0, 0, 0, 255] });
    let imported = asset(&vec![marked; 6], json!({})).import().unwrap();
    for (forward, up) in [
        (DVec3::X, DVec3::Y),
        (DVec3::NEG_X, DVec3::Y),
        (DVec3::Z, DVec3::Y),
        (DVec3::NEG_Z, DVec3::Y),
        (DVec3::Y, DVec3::NEG_Z),
        (DVec3::NEG_Y, DVec3::Z),
    ] {
        let right = forward.cross(up);
        for (across, along, lit) in [(-0.5, 0.5, 1.0), (0.5, 0.5, 0.0), (-0.5, -0.5, 0.0), (0.5, -0.5, 0.0)] {
            let direction = (forward + right * across + up * along).normalize();
            assert_eq!(radiance(&imported, direction), [lit; 3], "{forward} {across} {along}");
        }
    }
}

#[test]
fn rotation_and_intensity_act() {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let imported = asset(&plain(ImageFormat::Png), json!({"rotation": [0, half, 0, half], "intensity": 2.5}));
    let imported = imported.import().unwrap();
    let turn = DQuat::from_rotation_y(std::f64::consts::FRAC_PI_2);
    for (axis, color) in AXES.into_iter().zip(COLORS) {
        // Off the axis: there, rounding would decide between two texels.
        let direction = turn * (axis + DVec3::splat(0.01)).normalize();
        assert!(close(radiance(&imported, direction), color.map(|c| c * 2.5)), "{axis}");
    }
    assert!(close(radiance(&imported, DVec3::new(0.01, 0.01, -1.0).normalize()), [2.5, 0.0, 0.0]));
}

#[test]
fn png_with_alpha_is_divided_by_it() {
    // sRGB 188 is 0.503 linear; alpha 51 is a fifth.
    let face = file(ImageFormat::Png, 2, |_, _| [188, 255, 0, 51]);
    let imported = asset(&vec![face; 6], json!({})).import().unwrap();
    assert!(close(radiance(&imported, DVec3::X), [2.514, 5.0, 0.0]));
}

#[test]
fn what_cannot_be_had_is_dropped_with_a_warning() {
    let sound = plain(ImageFormat::Png);
    let with = |face: Vec<u8>| [&sound[..5], &[face]].concat();
    let small = file(ImageFormat::Png, 2, |_, _| [0; 4]);
    let webp = file(ImageFormat::WebP, 4, |_, _| [0; 4]);
    let torn = sound[0][..sound[0].len() - 20].to_vec();
    for (asset, why) in [
        (asset(&with(small), json!({})), "squares of one size"),
        (asset(&with(webp), json!({})), "PNG or JPEG"),
        (asset(&with(torn), json!({})), "the light is dropped"),
        (asset(&with(b"no image".to_vec()), json!({})), "no known image format"),
        (asset(&sound, json!({"intensity": -1})), "rotation or intensity"),
        (asset(&sound, json!({"rotation": [0, 0, 0, 0]})), "rotation or intensity"),
        (asset(&sound, json!({"specularImages": []})), "no images"),
        (asset(&sound, json!({"specularImages": [[0, 1]]})), "the light is dropped"),
        (asset(&sound, json!({"specularImages": [[0, 1, 2, 3, 4, 9]]})), "points to images[9]"),
    ] {
        let imported = asset.import().unwrap();
        let found = warnings(&imported);
        assert!(found.len() == 1 && found[0].contains(why), "{why}: {found:?}");
        assert!(found[0].starts_with(ELEMENT) && found[0].contains("the light is dropped"), "{found:?}");
        assert!(imported.scene.lights.is_empty() && imported.scene.images.is_empty());
    }
}

#[test]
fn a_light_that_does_not_exist_is_an_error() {
    let mut asset = asset(&plain(ImageFormat::Png), json!({}));
    asset.json["scenes"][0]["extensions"][NAME]["light"] = json!(3);
    let expected =
        ("scenes[0].extensions.EXT_lights_image_based.light", "points to lights[3], but there are only 1");
    let (element, message) = failure(&asset);
    assert_eq!((element.as_str(), message.as_str()), expected);
}
