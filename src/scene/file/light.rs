//! `[[light]]`.

use std::ops::RangeBounds;

use glam::{DAffine3, Vec3};

use super::{
    keys::Keys,
    placement,
    report::Complaint,
    texture::{Assets, Use},
    value::{POSITIVE, choice, number, numbers, text},
};
use crate::{Id, Light, LightKind, Node, Texture};

#[derive(Clone, Copy)]
enum Kind {
    Point,
    Spot,
    Directional,
    Rect,
    Disk,
    Sphere,
    Cylinder,
    Environment,
}

const KINDS: [(&str, Kind); 8] = [
    ("point", Kind::Point),
    ("spot", Kind::Spot),
    ("directional", Kind::Directional),
    ("rect", Kind::Rect),
    ("disk", Kind::Disk),
    ("sphere", Kind::Sphere),
    ("cylinder", Kind::Cylinder),
    ("environment", Kind::Environment),
];

/// Reads a light and adds its node. `index` counts from 0.
pub(super) fn read(mut keys: Keys<'_>, index: usize, assets: &mut Assets) {
    let name = keys.optional("name", text).unwrap_or_else(|| format!("light {}", index + 1));
    let color = keys.optional("color", numbers::<3>(0.0..)).unwrap_or([1.0; 3]);
    // Which keys there are depends on the type: without it, none can be called unknown.
    let Some(kind) = keys.required("type", choice(KINDS)) else { return };
    let transform = place(&mut keys, kind);
    let kind = shape(&mut keys, kind, assets);
    keys.finish();
    let color = Vec3::from_array(color.map(|channel| channel as f32));
    let light = assets.scene.lights.push(Light { name: name.clone(), color, kind });
    assets.scene.add_root(Node { name, transform, light: Some(light), ..Node::default() });
}

fn place(keys: &mut Keys<'_>, kind: Kind) -> DAffine3 {
    match kind {
        Kind::Point | Kind::Sphere => placement::positioned(keys),
        Kind::Cylinder => placement::turned(keys),
        Kind::Spot | Kind::Directional | Kind::Rect | Kind::Disk => placement::aimed(keys),
        Kind::Environment => keys
            .optional("rotate", super::value::vector)
            .map_or(DAffine3::IDENTITY, |degrees| DAffine3::from_mat3(placement::rotation(degrees))),
    }
}

fn shape(keys: &mut Keys<'_>, kind: Kind, assets: &mut Assets) -> LightKind {
    match kind {
        Kind::Point => LightKind::Point { intensity: strength(keys, "intensity") },
        Kind::Spot => spot(keys),
        Kind::Directional => LightKind::Directional {
            illuminance: strength(keys, "illuminance"),
            angle: degrees(keys, "angle", 0.53, 0.0..=180.0),
        },
        Kind::Rect => LightKind::Rect {
            radiance: strength(keys, "radiance"),
            width: length(keys, "width"),
            height: length(keys, "height"),
            texture: texture(keys, assets),
        },
        Kind::Disk => {
            LightKind::Disk { radiance: strength(keys, "radiance"), radius: length(keys, "radius") }
        }
        Kind::Sphere => {
            LightKind::Sphere { radiance: strength(keys, "radiance"), radius: length(keys, "radius") }
        }
        Kind::Cylinder => LightKind::Cylinder {
            radiance: strength(keys, "radiance"),
            radius: length(keys, "radius"),
            length: length(keys, "length"),
        },
        Kind::Environment => {
            LightKind::Environment { radiance: strength(keys, "radiance"), texture: texture(keys, assets) }
        }
    }
}

fn spot(keys: &mut Keys<'_>) -> LightKind {
    let inner = degrees(keys, "inner", 20.0, 0.0..=90.0);
    let outer =
        degrees(keys, "outer", 30.0, (std::ops::Bound::Excluded(0.0), std::ops::Bound::Included(90.0)));
    if inner > outer {
        let key = if keys.has("inner") { "inner" } else { "outer" };
        keys.complain(key, Complaint::new("the inner angle must not exceed the outer"));
    }
    LightKind::Spot { intensity: strength(keys, "intensity"), inner, outer }
}

fn strength(keys: &mut Keys<'_>, key: &str) -> f32 {
    keys.optional(key, number(0.0..)).unwrap_or(1.0) as f32
}

fn length(keys: &mut Keys<'_>, key: &str) -> f32 {
    keys.optional(key, number(POSITIVE)).unwrap_or(1.0) as f32
}

fn degrees(keys: &mut Keys<'_>, key: &str, default: f64, range: impl RangeBounds<f64>) -> f32 {
    keys.optional(key, number(range)).unwrap_or(default).to_radians() as f32
}

fn texture(keys: &mut Keys<'_>, assets: &mut Assets) -> Option<Id<Texture>> {
    assets.texture(keys, "texture", Use::Color).map(|input| input.texture)
}
