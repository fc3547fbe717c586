//! The keys of `[node]` that begin with `light_`: changes to the lights of imported nodes.

use std::ops::{Bound, RangeBounds};

use glam::Vec3;

use super::{
    keys::Keys,
    report::Complaint,
    texture::{Assets, Use},
    value::{POSITIVE, number, numbers},
};
use crate::{Light, LightKind};

/// One change; tells whether the light is of a type that has what it changes.
type Change = Box<dyn Fn(&mut Light) -> bool>;

/// What a table says about lights, by its keys.
#[derive(Default)]
pub(super) struct LightEdit(Vec<Said>);

struct Said {
    key: &'static str,
    /// Types of lights that have it; empty: all.
    of: &'static str,
    change: Change,
}

/// Reads all keys about lights.
pub(super) fn read(keys: &mut Keys<'_>, assets: &mut Assets) -> LightEdit {
    let mut edit = LightEdit::default();
    let scale = keys.optional("light_scale", number(0.0..)).map(|scale| scale as f32);
    edit.say("light_scale", "", scale, |light, scale| {
        *strength(&mut light.kind) *= scale;
        true
    });
    let color = keys.optional("light_color", numbers::<3>(0.0..));
    let color = color.map(|color| Vec3::from_array(color.map(|channel| channel as f32)));
    edit.say("light_color", "", color, |light, color| {
        light.color = color;
        true
    });
    for (key, of, field) in SIZES {
        let size = keys.optional(key, number(POSITIVE)).map(|metres| metres as f32);
        edit.number(key, of, size, field);
    }
    let angle = degrees(keys, "light_angle", 0.0..=180.0);
    edit.number("light_angle", "directional", angle, |kind| match kind {
        LightKind::Directional { angle, .. } => Some(angle),
        _ => None,
    });
    let inner = degrees(keys, "light_inner", 0.0..=90.0);
    edit.number("light_inner", "spot", inner, |kind| match kind {
        LightKind::Spot { inner, .. } => Some(inner),
        _ => None,
    });
    let outer = degrees(keys, "light_outer", (Bound::Excluded(0.0), Bound::Included(90.0)));
    edit.number("light_outer", "spot", outer, |kind| match kind {
        LightKind::Spot { outer, .. } => Some(outer),
        _ => None,
    });
    let image = assets.texture(keys, "light_texture", Use::Color).map(|input| input.texture);
    edit.say("light_texture", "rect and environment", image, |light, image| match &mut light.kind {
        LightKind::Rect { texture, .. } | LightKind::Environment { texture, .. } => {
            *texture = Some(image);
            true
        }
        _ => false,
    });
    edit
}

/// A number of some types of lights.
type Field = fn(&mut LightKind) -> Option<&mut f32>;

/// Lengths, in metres.
const SIZES: [(&str, &str, Field); 4] = [
    ("light_width", "rect", |kind| match kind {
        LightKind::Rect { width, .. } => Some(width),
        _ => None,
    }),
    ("light_height", "rect", |kind| match kind {
        LightKind::Rect { height, .. } => Some(height),
        _ => None,
    }),
    ("light_radius", "disk, sphere and cylinder", |kind| match kind {
        LightKind::Disk { radius, .. }
        | LightKind::Sphere { radius, .. }
        | LightKind::Cylinder { radius, .. } => Some(radius),
        _ => None,
    }),
    ("light_length", "cylinder", |kind| match kind {
        LightKind::Cylinder { length, .. } => Some(length),
        _ => None,
    }),
];

fn degrees(keys: &mut Keys<'_>, key: &str, range: impl RangeBounds<f64>) -> Option<f32> {
    keys.optional(key, number(range)).map(|degrees| degrees.to_radians() as f32)
}

/// What a light's colour is multiplied with.
fn strength(kind: &mut LightKind) -> &mut f32 {
    match kind {
        LightKind::Point { intensity } | LightKind::Spot { intensity, .. } => intensity,
        LightKind::Directional { illuminance, .. } => illuminance,
        LightKind::Rect { radiance, .. }
        | LightKind::Disk { radiance, .. }
        | LightKind::Sphere { radiance, .. }
        | LightKind::Cylinder { radiance, .. }
        | LightKind::Environment { radiance, .. } => radiance,
    }
}

impl LightEdit {
    fn say<T: Copy + 'static>(
        &mut self,
        key: &'static str,
        of: &'static str,
        value: Option<T>,
        change: fn(&mut Light, T) -> bool,
    ) {
        let change = value.map(|value| Box::new(move |light: &mut Light| change(light, value)) as Change);
        self.0.extend(change.map(|change| Said { key, of, change }));
    }

    fn number(&mut self, key: &'static str, of: &'static str, value: Option<f32>, field: Field) {
        let change = value.map(|value| {
            Box::new(move |light: &mut Light| field(&mut light.kind).map(|number| *number = value).is_some())
                as Change
        });
        self.0.extend(change.map(|change| Said { key, of, change }));
    }

    /// Whether the table says nothing about lights.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The lights as the table wants them. What it says and none of them can have is its mistake.
    pub fn apply(&self, lights: &mut [Light], keys: &Keys<'_>) {
        for Said { key, of, change } in &self.0 {
            // All of them change: no short cut after the first.
            let changed = lights.iter_mut().filter_map(|light| change(light).then_some(())).count();
            if changed == 0 {
                let why = if lights.is_empty() {
                    "no node that fits has a light".to_owned()
                } else {
                    format!("no node that fits has a light with it: {of} lights have")
                };
                keys.complain(key, Complaint::new(why));
            }
        }
        let crossed =
            |light: &Light| matches!(light.kind, LightKind::Spot { inner, outer, .. } if inner > outer);
        let said = |key: &str| self.0.iter().any(|it| it.key == key);
        if let Some(light) = lights.iter().find(|light| crossed(light))
            && let Some(key) = ["light_inner", "light_outer"].into_iter().find(|key| said(key))
        {
            let name = light.name.escape_debug();
            let why = format!("the inner angle must not exceed the outer, as it would for light \"{name}\"");
            keys.complain(key, Complaint::new(why));
        }
    }
}
