//! KHR_lights_punctual: candela and lux as they are, along −Z.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};

use ajar_scene::{Id, Light, LightKind, Scene};
use glam::Vec3;
use gltf::json::Root;
use serde::Deserialize;
use serde_json::Value;

use super::{Context, extensions};

/// The extension's name.
pub(super) const NAME: &str = "KHR_lights_punctual";

/// Spot cones are at least this many radians from edge to edge.
const LEAST_SOFTNESS: f32 = 1e-3;

#[derive(Deserialize)]
struct Definition {
    name: Option<String>,
    #[serde(default = "white")]
    color: [f32; 3],
    #[serde(default = "one")]
    intensity: f32,
    range: Option<f32>,
    spot: Option<Spot>,
    #[serde(rename = "type")]
    kind: String,
}

fn white() -> [f32; 3] {
    [1.0; 3]
}

fn one() -> f32 {
    1.0
}

#[derive(Deserialize)]
#[serde(default, rename_all = "camelCase")]
struct Spot {
    inner_cone_angle: f32,
    outer_cone_angle: f32,
}

impl Default for Spot {
    fn default() -> Self {
        Self { inner_cone_angle: 0.0, outer_cone_angle: FRAC_PI_4 }
    }
}

/// The lights of the document by their index in the extension; `None` for those that were dropped with a warning.
pub(super) fn lights(root: &Root, context: &mut Context, scene: &mut Scene) -> Vec<Option<Id<Light>>> {
    let extension = root.extensions.as_ref().and_then(|extensions| extensions.others.get(NAME));
    let list = extension.and_then(|extension| extension.get("lights")).and_then(Value::as_array);
    let mut made = Vec::new();
    for (i, light) in list.into_iter().flatten().enumerate() {
        let element = format!("extensions.{NAME}.lights[{i}]");
        made.push(light_of(light, context, &element, i).map(|light| scene.lights.push(light)));
    }
    made
}

fn light_of(value: &Value, context: &mut Context, element: &str, index: usize) -> Option<Light> {
    let light: Definition = match serde_path_to_error::deserialize(value) {
        Ok(light) => light,
        Err(error) => {
            let element = extensions::below(element, error.path());
            context.report.warn(element, format!("the light is dropped: {}", error.inner()));
            return None;
        }
    };
    let color = Vec3::from(light.color);
    if !(color.is_finite()
        && color.min_element() >= 0.0
        && light.intensity.is_finite()
        && light.intensity >= 0.0)
    {
        context
            .report
            .warn(element, "the light is dropped: its colour or intensity is negative or not finite");
        return None;
    }
    if light.range.is_some() {
        context
            .report
            .note(format!("{element}.range"), "the range of lights is ignored, they reach everything");
    }
    let intensity = light.intensity;
    let kind = match light.kind.as_str() {
        "point" => LightKind::Point { intensity },
        "directional" => LightKind::Directional { illuminance: intensity, angle: 0.0 },
        "spot" => {
            let (inner, outer) = cone(light.spot.unwrap_or_default(), context, &format!("{element}.spot"));
            LightKind::Spot { intensity, inner, outer }
        }
        other => {
            let message = format!("the light is dropped: unknown type \"{}\"", other.escape_debug());
            context.report.warn(format!("{element}.type"), message);
            return None;
        }
    };
    let name = light.name.unwrap_or_else(|| format!("lights[{index}]"));
    Some(Light { name, color, kind })
}

/// The angles of a cone, 0 ≤ inner < outer ≤ π/2.
fn cone(spot: Spot, context: &mut Context, element: &str) -> (f32, f32) {
    let Spot { inner_cone_angle: inner, outer_cone_angle: outer } = spot;
    if 0.0 <= inner && inner < outer && outer <= FRAC_PI_2 + 1e-6 {
        return (inner, outer.min(FRAC_PI_2));
    }
    context
        .report
        .approximate(element, "the cone's angles contradict each other or exceed π/2; they are changed");
    let outer = if outer.is_nan() { FRAC_PI_4 } else { outer.clamp(LEAST_SOFTNESS, FRAC_PI_2) };
    (inner.max(0.0).min(outer - LEAST_SOFTNESS), outer)
}
