//! The metallic-roughness core, textures, samplers and images.

use ajar_scene::{
    AlphaMode, Channel, ColorSpace, Filter, ImageSource, Imported, Input, Material, Severity, Texture, Wrap,
};
use glam::{Affine2, Vec2, Vec3};
use serde_json::{Value, json};

use crate::{
    build::{Asset, PNG, data_uri, import_files},
    failure, messages, warnings,
};

/// Imports a triangle of this material, which must cause no diagnostics.
pub fn material(definition: Value) -> (Material, Imported) {
    let imported = Asset::with_material(definition).import().unwrap();
    assert_eq!(messages(&imported, Severity::Note), [""; 0]);
    (imported.scene.materials.iter().next().unwrap().clone(), imported)
}

/// The texture of an input and the channel it reads.
pub fn texture<T>(imported: &Imported, input: &Input<T>) -> (Texture, Channel) {
    let input = input.texture.as_ref().expect("the input has a texture");
    (imported.scene.textures[input.texture].clone(), input.channel)
}

#[test]
fn a_primitive_without_material_has_the_default_of_the_specification() {
    let imported = Asset::triangle(json!({})).import().unwrap();
    assert_eq!(imported.scene.materials.len(), 1);
    let mesh = imported.scene.meshes.iter().next().unwrap();
    let material = &imported.scene.materials[mesh.material.unwrap()];
    let expected = Material {
        name: "default".into(),
        base_color: Input::constant(Vec3::ONE),
        metallic: Input::constant(1.0),
        roughness: Input::constant(1.0),
        double_sided: false,
        cull_back: true,
        ..Material::default()
    };
    assert_eq!(material, &expected);
    // An empty material differs in its name only.
    assert_eq!(self::material(json!({})).0, Material { name: "materials[0]".into(), ..expected });
}

#[test]
fn factors_and_sides_are_read() {
    let (material, _) = material(json!({
        "name": "m",
        "pbrMetallicRoughness": {
            "baseColorFactor": [0.1, 0.2, 0.3, 0.4], "metallicFactor": 0.5, "roughnessFactor": 0.25,
        },
        "emissiveFactor": [0.5, 0.25, 0.0],
        "doubleSided": true,
    }));
    assert_eq!(material.name, "m");
    assert_eq!(material.base_color, Input::constant(Vec3::new(0.1, 0.2, 0.3)));
    assert_eq!((material.metallic.value, material.roughness.value), (0.5, 0.25));
    assert_eq!(material.emission, Input::constant(Vec3::new(0.5, 0.25, 0.0)));
    assert_eq!((material.double_sided, material.cull_back), (true, false));
    // Alpha means nothing to opaque materials.
    assert_eq!((material.alpha_mode, material.opacity), (AlphaMode::Opaque, Input::constant(1.0)));
}

#[test]
fn alpha_modes() {
    let info = json!({"baseColorFactor": [1, 1, 1, 0.5], "baseColorTexture": {"index": 0}});
    let (blend, imported) = material(json!({"alphaMode": "BLEND", "pbrMetallicRoughness": info}));
    assert_eq!((blend.alpha_mode, blend.opacity.value), (AlphaMode::Blend, 0.5));
    let (map, channel) = texture(&imported, &blend.opacity);
    assert_eq!((map, channel), (texture(&imported, &blend.base_color).0, Channel::A));
    assert_eq!(imported.scene.textures.len(), 1);

    let (mask, _) = material(json!({"alphaMode": "MASK", "pbrMetallicRoughness": info}));
    assert_eq!(mask.alpha_mode, AlphaMode::Mask(0.5));
    let (mask, _) = material(json!({"alphaMode": "MASK", "alphaCutoff": 0.75}));
    assert_eq!((mask.alpha_mode, mask.opacity), (AlphaMode::Mask(0.75), Input::constant(1.0)));

    let imported = Asset::with_material(json!({"alphaMode": "COVERED"})).import().unwrap();
    assert_eq!(warnings(&imported), ["materials[0].alphaMode: unknown alpha mode, taken as OPAQUE"]);
}

#[test]
fn values_out_of_range_are_clamped_with_a_warning() {
    let core = json!({"baseColorFactor": [2, -1, 0.5, 1], "metallicFactor": 1.5, "roughnessFactor": 1e300});
    let imported = Asset::with_material(json!({"pbrMetallicRoughness": core})).import().unwrap();
    let material = imported.scene.materials.iter().next().unwrap();
    assert_eq!(material.base_color.value, Vec3::new(1.0, 0.0, 0.5));
    assert_eq!((material.metallic.value, material.roughness.value), (1.0, 1.0));
    let expected = "materials[0].pbrMetallicRoughness.baseColorFactor: the value does not lie between 0 and 1 and is \
                    clamped (and at 3 more places)";
    assert_eq!(warnings(&imported), [expected]);

    let imported = Asset::with_material(json!({"emissiveFactor": [1, -1, 1]})).import().unwrap();
    assert_eq!(imported.scene.materials.iter().next().unwrap().emission.value, Vec3::ZERO);
    let expected = "materials[0].emissiveFactor: the emission is negative or not finite and is dropped";
    assert_eq!(warnings(&imported), [expected]);
}

#[test]
fn textures_have_the_channels_and_colour_spaces_of_their_inputs() {
    let (material, imported) = material(json!({
        "pbrMetallicRoughness": {
            "baseColorTexture": {"index": 0}, "metallicRoughnessTexture": {"index": 1, "texCoord": 2},
        },
        "normalTexture": {"index": 1, "scale": 0.5},
        "emissiveTexture": {"index": 0},
        "emissiveFactor": [1, 1, 1],
    }));
    let (base, channel) = texture(&imported, &material.base_color);
    assert_eq!((base.color_space, base.uv_set, channel), (ColorSpace::Srgb, 0, Channel::R));
    assert_eq!(texture(&imported, &material.emission).0, base);
    let (metallic, channel) = texture(&imported, &material.metallic);
    assert_eq!((metallic.color_space, metallic.uv_set, channel), (ColorSpace::Raw, 2, Channel::B));
    assert_eq!(texture(&imported, &material.roughness), (metallic.clone(), Channel::G));
    let map = material.normal_map.unwrap();
    assert_eq!((map.scale, imported.scene.textures[map.texture].color_space), (0.5, ColorSpace::Raw));
    assert_ne!(base.image, metallic.image);
    // Base colour and emission share one, metallic and roughness another.
    assert_eq!((imported.scene.textures.len(), imported.scene.images.len()), (3, 2));
    assert_eq!((base.wrap_u, base.wrap_v, base.filter), (Wrap::Repeat, Wrap::Repeat, Filter::Linear));
}

#[test]
fn samplers() {
    let mut asset = Asset::with_material(json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}));
    asset.json["textures"][0]["sampler"] = json!(0);
    asset.json["samplers"] = json!([{"wrapS": 33071, "wrapT": 33648, "magFilter": 9728}]);
    let imported = asset.import().unwrap();
    let texture = imported.scene.textures.iter().next().unwrap();
    assert_eq!(
        (texture.wrap_u, texture.wrap_v, texture.filter),
        (Wrap::Clamp, Wrap::Mirror, Filter::Nearest)
    );

    asset.json["samplers"] = json!([{"wrapS": 1, "magFilter": 9729}]);
    let imported = asset.import().unwrap();
    let texture = imported.scene.textures.iter().next().unwrap();
    assert_eq!((texture.wrap_u, texture.filter), (Wrap::Repeat, Filter::Linear));
    assert_eq!(warnings(&imported), ["textures[0]: unknown wrapping mode, taken as repeat"]);
}

fn transform_of(field: &str, extension: Value) -> (Affine2, u32) {
    let info = json!({"index": 0, "texCoord": 1, "extensions": {"KHR_texture_transform": extension}});
    let definition = match field {
        "normalTexture" => json!({"normalTexture": info}),
        _ => json!({"pbrMetallicRoughness": {"baseColorTexture": info}}),
    };
    let imported = Asset::with_material(definition).import().unwrap();
    let texture = imported.scene.textures.iter().next().unwrap();
    (texture.transform, texture.uv_set)
}

#[test]
fn texture_transforms_apply_to_every_input() {
    for field in ["normalTexture", "baseColorTexture"] {
        let (transform, set) =
            transform_of(field, json!({"offset": [0.5, 0.25], "scale": [2, 3], "texCoord": 4}));
        assert_eq!(transform.transform_point2(Vec2::new(0.5, 1.0)), Vec2::new(1.5, 3.25));
        assert_eq!(set, 4);
    }
    assert_eq!(transform_of("baseColorTexture", json!({})), (Affine2::IDENTITY, 1));
}

#[test]
fn texture_rotation_is_the_one_of_the_extensions_example() {
    // The README's example shows the lower left quadrant of the image, rotated clockwise by 90 degrees.
    let quarter = std::f32::consts::FRAC_PI_2;
    let extension = json!({"offset": [0, 1], "rotation": quarter, "scale": [0.5, 0.5]});
    let (transform, _) = transform_of("baseColorTexture", extension);
    for (uv, expected) in [([0.0, 0.0], [0.0, 1.0]), ([1.0, 0.0], [0.0, 0.5]), ([0.0, 1.0], [0.5, 1.0])] {
        let found = transform.transform_point2(Vec2::from(uv));
        assert!(found.abs_diff_eq(Vec2::from(expected), 1e-6), "{uv:?} to {found}");
    }
}

#[test]
fn broken_transforms_are_ignored_with_a_warning() {
    let info = json!({"index": 0, "extensions": {"KHR_texture_transform": {"offset": [0.5]}}});
    let imported = Asset::with_material(json!({"normalTexture": info})).import().unwrap();
    assert_eq!(imported.scene.textures.iter().next().unwrap().transform, Affine2::IDENTITY);
    let found = &warnings(&imported)[0];
    let element = "materials[0].normalTexture.extensions.KHR_texture_transform.offset";
    assert!(found.starts_with(&format!("{element}: the extension is ignored: ")), "{found}");
}

#[test]
fn embedded_images_stay_encoded() {
    let mut asset =
        Asset::with_material(json!({"normalTexture": {"index": 0}, "emissiveTexture": {"index": 1}}));
    let view = asset.view(PNG, json!({}));
    asset.json["images"][1] = json!({"bufferView": view, "mimeType": "image/png", "name": "two"});
    let imported = asset.import().unwrap();
    for image in imported.scene.images.iter() {
        let ImageSource::Embedded(bytes) = &image.source else { panic!("{image:?}") };
        assert_eq!(&bytes[..], PNG);
    }
    let names: Vec<_> = imported.scene.images.iter().map(|image| image.name.as_str()).collect();
    assert_eq!(names, ["two", "images[0]"]);
}

#[test]
fn image_files_are_found_by_percent_encoded_names() {
    let mut asset = Asset::with_material(json!({"normalTexture": {"index": 0}}));
    asset.json["images"] = json!([{"uri": "a%20b.png"}, {"uri": data_uri(PNG)}]);
    let imported = import_files(&[("main.gltf", &asset.text()), ("a b.png", PNG)]).unwrap();
    let image = imported.scene.images.iter().next().unwrap();
    assert_eq!(image.name, "a b.png");
    assert!(matches!(&image.source, ImageSource::File(path) if path.ends_with("a b.png")));
    assert!(imported.files.iter().any(|path| path.ends_with("a b.png")));
    assert_eq!(messages(&imported, Severity::Note), [""; 0]);
}

#[test]
fn images_that_cannot_be_had_drop_their_textures_once() {
    let definition =
        json!({"normalTexture": {"index": 0}, "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}});
    let cases = [
        (
            json!({"uri": "missing.png"}),
            "images[0]: textures of this image are dropped: \"missing.png\" cannot be read",
        ),
        (json!({"uri": "../x.png"}), "images[0]: textures of this image are dropped: \"../x.png\" "),
        (
            json!({"uri": "https://a.b/x.png"}),
            "images[0]: textures of this image are dropped: \"https://a.b/x.png\" is a URL",
        ),
        (
            json!({"uri": data_uri(b"GIF89a")}),
            "images[0]: textures of this image are dropped: it is of no known",
        ),
        (
            json!({"uri": "data:image/png;base64,***"}),
            "images[0]: textures of this image are dropped: the data URI is",
        ),
        (json!({}), "images[0]: textures of this image are dropped: it has neither"),
        (json!({"uri": data_uri(b"\xabKTX 11\xbb")}), "images[0]: textures of this image are dropped: KTX 1"),
    ];
    for (image, expected) in cases {
        let mut asset = Asset::with_material(definition.clone());
        asset.json["images"][0] = image;
        let imported = asset.import().unwrap();
        let material = imported.scene.materials.iter().next().unwrap();
        assert_eq!((material.normal_map, material.base_color.texture), (None, None));
        let found = warnings(&imported);
        assert!(found.len() == 1 && found[0].starts_with(expected), "{found:?}");
    }
}

#[test]
fn webp_is_preferred_and_enough() {
    const WEBP: &[u8] = b"RIFF\x04\0\0\0WEBPVP8 ";
    for fallback in [true, false] {
        let mut asset = Asset::with_material(json!({"normalTexture": {"index": 0}}));
        asset.json["images"][1] = json!({"uri": data_uri(WEBP)});
        asset.json["textures"][0] = json!({"extensions": {"EXT_texture_webp": {"source": 1}}});
        if fallback {
            asset.json["textures"][0]["source"] = json!(0);
        }
        asset.json["extensionsRequired"] = json!(["EXT_texture_webp"]);
        let imported = asset.import().unwrap();
        let image = imported.scene.images.iter().next().unwrap();
        assert_eq!(image.source, ImageSource::Embedded(WEBP.into()));
        assert_eq!(messages(&imported, Severity::Note), [""; 0]);
    }
}

#[test]
fn indices_of_textures_must_exist() {
    let (element, message) = failure(&Asset::with_material(json!({"normalTexture": {"index": 2}})));
    assert_eq!(element, "materials[0].normalTexture.index");
    assert_eq!(message, "points to textures[2], but there are only 2");
}

#[test]
fn occlusion_is_noted_once() {
    let mut asset = Asset::with_material(json!({"occlusionTexture": {"index": 0}}));
    asset.push("materials", json!({"occlusionTexture": {"index": 0}}));
    let imported = asset.import().unwrap();
    let expected = "materials[0].occlusionTexture: occlusion is ignored, light transport computes it (and at 1 more place)";
    assert_eq!(messages(&imported, Severity::Note), [expected]);
    assert_eq!(warnings(&imported), [""; 0]);
}

#[test]
fn specular_glossiness_is_a_dielectric_of_its_reflectance() {
    let extension = json!({"diffuseFactor": [0.5, 0.25, 0.125, 0.75], "specularFactor": [0.04, 0.02, 0.01], "glossinessFactor": 0.75});
    let (found, _) = material(json!({
        "extensions": {"KHR_materials_pbrSpecularGlossiness": extension}, "alphaMode": "BLEND",
        "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 0]},
    }));
    assert_eq!((found.base_color.value, found.opacity.value), (Vec3::new(0.5, 0.25, 0.125), 0.75));
    assert_eq!((found.metallic.value, found.roughness.value), (0.0, 0.25));
    let reflected = ((found.ior - 1.0) / (found.ior + 1.0)).powi(2) * found.specular_color.value;
    assert!(reflected.abs_diff_eq(Vec3::new(0.04, 0.02, 0.01), 1e-6), "{reflected}");
}

#[test]
fn specular_glossiness_reads_its_texture_as_tint_and_inverted() {
    let extension = json!({"glossinessFactor": 0.5, "diffuseTexture": {"index": 0}, "specularGlossinessTexture": {"index": 1}});
    let (found, imported) =
        material(json!({"extensions": {"KHR_materials_pbrSpecularGlossiness": extension}}));
    let (gloss, channel) = texture(&imported, &found.roughness);
    assert_eq!((channel, gloss.scale.w, gloss.bias.w, found.roughness.value), (Channel::A, -0.5, 1.0, 1.0));
    let (tint, _) = texture(&imported, &found.specular_color);
    assert_eq!((tint.scale.x, tint.bias.x, tint.color_space), (1.0, 0.0, ColorSpace::Srgb));
    assert_eq!(tint.image, gloss.image);
    // White reflects like a mirror, and so does the default.
    assert!(found.ior > 100.0 && found.specular_color.value == Vec3::ONE);
}
