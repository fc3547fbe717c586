//! Materials, textures, lights and cameras: numbers that mean something.

use std::f32::consts::{FRAC_PI_2, PI};

use glam::Affine2;

use super::{Findings, label, placed_label};
use crate::{
    Camera, Diagnostic, Light, LightKind, Material, Projection, Scene, Texture,
    ranges::{Number, Range},
};

pub(super) fn check(scene: &Scene, findings: &mut Findings) {
    for (index, it) in scene.materials.iter().enumerate() {
        material(scene, it, &|| label("material", &it.name, index), findings);
    }
    for (index, it) in scene.textures.iter().enumerate() {
        texture(scene, it, &|| format!("texture #{index}"), findings);
    }
    let placed = scene.placed();
    let place = |holds: &dyn Fn(&crate::Node) -> bool| {
        placed.iter().find(|placed| holds(placed.node)).map(|placed| placed.id.index())
    };
    for (id, it) in scene.lights.ids().zip(scene.lights.iter()) {
        let node = || place(&|node| node.light == Some(id));
        let name = || placed_label(scene, "light", &it.name, id.index(), node());
        light(scene, it, &name, findings);
    }
    for (id, it) in scene.cameras.ids().zip(scene.cameras.iter()) {
        let node = || place(&|node| node.camera == Some(id));
        camera(it, &|| placed_label(scene, "camera", &it.name, id.index(), node()), findings);
    }
}

fn material(scene: &Scene, material: &Material, name: &impl Fn() -> String, findings: &mut Findings) {
    let mut last = "";
    material.clone().numbers(|Number { name: key, value, range }| {
        // One channel of a colour speaks for all.
        if key == last {
            return;
        }
        let mut warn = |used: f32, rule| {
            let message = format!("{key} is {value}; it is used as {used}");
            findings.add(rule, name, Diagnostic::warning(message));
            last = key;
        };
        match range {
            _ if !value.is_finite() => {
                let message = format!("{key} is not finite");
                findings.add("material parameters are not finite", name, Diagnostic::error(message));
                last = key;
            }
            Range::Unit if *value < 0.0 => warn(0.0, "material parameters outside [0, 1]"),
            Range::Unit if *value > 1.0 => warn(1.0, "material parameters outside [0, 1]"),
            Range::AtLeast(low) if *value < low => warn(low, "material parameters too small"),
            Range::Unit | Range::AtLeast(_) | Range::Any => {}
        }
    });
    if let Some(id) = material.textures().find(|&id| scene.textures.get(id).is_none()) {
        let message = format!("names texture #{}, which does not exist", id.index());
        findings.add("materials name textures that do not exist", name, Diagnostic::error(message));
    }
}

fn texture(scene: &Scene, texture: &Texture, name: &impl Fn() -> String, findings: &mut Findings) {
    if scene.images.get(texture.image).is_none() {
        let message = format!("names image #{}, which does not exist", texture.image.index());
        findings.add("textures name images that do not exist", name, Diagnostic::error(message));
    }
    if !(texture.transform.is_finite() && texture.scale.is_finite() && texture.bias.is_finite()) {
        let message = "transform, scale or bias is not finite";
        findings.add("textures are not finite", name, Diagnostic::error(message));
    }
}

/// What must hold of a number, and what to say otherwise.
struct Claim(&'static str, f32, bool, &'static str);

impl Claim {
    fn non_negative(what: &'static str, value: f32) -> Self {
        Self(what, value, value >= 0.0, "must be at least 0")
    }

    fn positive(what: &'static str, value: f32) -> Self {
        Self(what, value, value > 0.0, "must be greater than 0")
    }

    fn finite(what: &'static str, value: f32) -> Self {
        Self(what, value, true, "")
    }

    fn check(self, rule: &'static str, name: &impl Fn() -> String, findings: &mut Findings) {
        let Self(what, value, holds, wanted) = self;
        let message = if !value.is_finite() {
            format!("{what} is not finite")
        } else if !holds {
            format!("{what} {wanted}, is {value}")
        } else {
            return;
        };
        findings.add(rule, name, Diagnostic::error(message));
    }
}

fn light(scene: &Scene, light: &Light, name: &impl Fn() -> String, findings: &mut Findings) {
    let mut claims: Vec<_> =
        light.color.to_array().map(|channel| Claim::non_negative("color", channel)).into();
    let mut used = None;
    claims.extend(match light.kind {
        LightKind::Point { intensity } => vec![Claim::non_negative("intensity", intensity)],
        LightKind::Spot { intensity, inner, outer } => vec![
            Claim::non_negative("intensity", intensity),
            Claim("inner", inner, (0.0..=outer).contains(&inner), "must lie between 0 and outer"),
            // glTF's own upper bound, π/2 rounded to a float, must pass.
            Claim(
                "outer",
                outer,
                outer > 0.0 && outer <= FRAC_PI_2 * (1.0 + f32::EPSILON),
                "must lie in (0, π/2]",
            ),
        ],
        LightKind::Directional { illuminance, angle } => vec![
            Claim::non_negative("illuminance", illuminance),
            Claim("angle", angle, (0.0..=PI * (1.0 + f32::EPSILON)).contains(&angle), "must lie in [0, π]"),
        ],
        LightKind::Rect { radiance, width, height, texture } => {
            used = texture;
            vec![
                Claim::non_negative("radiance", radiance),
                Claim::positive("width", width),
                Claim::positive("height", height),
            ]
        }
        LightKind::Disk { radiance, radius } | LightKind::Sphere { radiance, radius } => {
            vec![Claim::non_negative("radiance", radiance), Claim::positive("radius", radius)]
        }
        LightKind::Cylinder { radiance, radius, length } => vec![
            Claim::non_negative("radiance", radiance),
            Claim::positive("radius", radius),
            Claim::positive("length", length),
        ],
        LightKind::Environment { radiance, texture } => {
            used = texture;
            vec![Claim::non_negative("radiance", radiance)]
        }
    });
    claims.into_iter().for_each(|claim| claim.check("lights without meaning", name, findings));
    if let Some(id) = used.filter(|&id| scene.textures.get(id).is_none()) {
        let message = format!("names texture #{}, which does not exist", id.index());
        findings.add("lights name textures that do not exist", name, Diagnostic::error(message));
    }
    let image = used.and_then(|id| scene.textures.get(id));
    let is_placed = |it: &Texture| it.transform.is_finite() && it.transform != Affine2::IDENTITY;
    if matches!(light.kind, LightKind::Environment { .. }) && image.is_some_and(is_placed) {
        let message = "its image surrounds everything: the transform of the texture is ignored";
        let rule = "images of surroundings are placed like textures";
        findings.add(rule, name, Diagnostic::warning(message).hint("turn the light"));
    }
}

fn camera(camera: &Camera, name: &impl Fn() -> String, findings: &mut Findings) {
    let mut claims = vec![Claim::non_negative("exposure", camera.exposure)];
    claims.extend(camera.aspect.map(|aspect| Claim::positive("aspect", aspect)));
    match camera.projection {
        Projection::Perspective { yfov, lens_radius, focus_distance, shift: [right, up] } => claims.extend([
            Claim("yfov", yfov, yfov > 0.0 && yfov < PI, "must lie in (0, π)"),
            Claim::non_negative("lens_radius", lens_radius),
            Claim::positive("focus_distance", focus_distance),
            Claim::finite("shift", right),
            Claim::finite("shift", up),
        ]),
        Projection::Orthographic { half_height } => claims.push(Claim::positive("half_height", half_height)),
    }
    claims.into_iter().for_each(|claim| claim.check("cameras without meaning", name, findings));
}
