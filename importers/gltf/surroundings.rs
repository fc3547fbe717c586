//! EXT_lights_image_based: the cube map around the scene becomes its environment.
//!
//! Of the levels of the cube only the sharpest counts: the others are its blurred copies for materials of some roughness,
//! and the irradiance coefficients its diffuse part, which rendering finds by itself. What the extension calls lux is
//! taken as cd/m², as by those who show such files.

use ajar_scene::{
    ColorSpace, Diagnostic, Id, Image, ImageSource, Light, LightKind, Node, Scene, Severity, Texture,
};
use glam::{DAffine3, DQuat, Vec3};
use serde::Deserialize;
use serde_json::Value;

use super::{Asset, Context, at, cube, extensions, image, uri};

/// The extension's name.
const NAME: &str = "EXT_lights_image_based";

#[derive(Deserialize)]
struct Placed {
    light: u32,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Definition {
    name: Option<String>,
    #[serde(default = "unturned")]
    rotation: [f64; 4],
    #[serde(default = "one")]
    intensity: f32,
    specular_images: Vec<[u32; 6]>,
}

fn unturned() -> [f64; 4] {
    DQuat::IDENTITY.to_array()
}

fn one() -> f32 {
    1.0
}

/// The node with the light of the scene at `index`, if it has one that can be had.
///
/// # Errors
/// An index points beyond its list, or memory runs out.
pub(super) fn place(
    asset: &Asset,
    index: usize,
    context: &mut Context,
    scene: &mut Scene,
) -> Result<Option<Id<Node>>, Diagnostic> {
    let owner = asset.root.scenes.get(index);
    let others = owner.and_then(|owner| owner.extensions.as_ref()).map(|extensions| &extensions.others);
    let owner = format!("scenes[{index}]");
    let Some(placed) = extensions::read::<Placed>(others, NAME, &owner, &mut context.report) else {
        return Ok(None);
    };
    let all =
        asset.root.extensions.as_ref().and_then(|extensions| extensions.others.get(NAME)?.get("lights"));
    let all = all.and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    let value = at(all, placed.light as usize, "lights", &format!("{owner}.extensions.{NAME}.light"))?;
    let element = format!("extensions.{NAME}.lights[{}]", placed.light);
    let mut light: Definition = match serde_path_to_error::deserialize(value) {
        Ok(light) => light,
        Err(error) => {
            let element = extensions::below(&element, error.path());
            context.report.warn(element, format!("the light is dropped: {}", error.inner()));
            return Ok(None);
        }
    };
    let rotation = DQuat::from_array(light.rotation);
    let turned = rotation.is_finite() && rotation.length_squared() > 0.0;
    if !(turned && light.intensity.is_finite() && light.intensity >= 0.0) {
        context.report.warn(element, "the light is dropped: its rotation or intensity is impossible");
        return Ok(None);
    }
    let name = light.name.take().unwrap_or_else(|| "surroundings".into());
    let source = match faces(&light, asset, context, &element) {
        Ok(source) => source,
        Err(error) if error.cause == ajar_scene::Cause::Resource => return Err(error),
        Err(error) => {
            let message = format!("the light is dropped: {}", error.message);
            context.report.add(Diagnostic { severity: Severity::Warning, message, ..error }.element(element));
            return Ok(None);
        }
    };
    let image = scene.images.push(Image { name: name.clone(), source });
    let texture = scene.textures.push(Texture { color_space: ColorSpace::Raw, ..Texture::new(image) });
    let kind = LightKind::Environment { radiance: light.intensity, texture: Some(texture) };
    let light = scene.lights.push(Light { name: name.clone(), color: Vec3::ONE, kind });
    let transform = DAffine3::from_quat(rotation.normalize());
    Ok(Some(scene.nodes.push(Node { name, transform, light: Some(light), ..Node::default() })))
}

/// The sharpest level as a latitude-longitude image.
fn faces(
    light: &Definition,
    asset: &Asset,
    context: &mut Context,
    element: &str,
) -> Result<ImageSource, Diagnostic> {
    let Some(level) = light.specular_images.first() else {
        return Err(Diagnostic::error("it has no images"));
    };
    let mut files = Vec::with_capacity(level.len());
    for (i, &face) in level.iter().enumerate() {
        let user = format!("{element}.specularImages[0][{i}]");
        let found = at(&asset.root.images, face as usize, "images", &user)?;
        files.push(match image::source(asset, context, found, &user)? {
            ImageSource::File(path) => uri::read_file(&path, context, &user)?.into(),
            ImageSource::Embedded(bytes) => bytes,
        });
    }
    context.charge(cube::cost(&files)?, element)?;
    let note =
        "the blurred levels and irradiance coefficients are not needed: they follow from the sharpest level";
    context.report.note(element, note);
    Ok(ImageSource::Embedded(cube::unrolled(&files)?.into()))
}
