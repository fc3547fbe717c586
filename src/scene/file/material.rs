//! `[material."Chrome*"]`: changes to imported materials.

use std::ops::RangeBounds;

use glam::Vec3;
use toml::de::DeValue;

use super::{
    glob,
    keys::Keys,
    report::{Complaint, advice},
    shown,
    texture::{Assets, Use},
    value::{ANY, choice, distance_or_infinity, flag, number, numbers},
};
use crate::{AlphaMode, Input, Material, NormalMap};

/// One change, applied to every material that fits.
type Edit = Box<dyn Fn(&mut Material)>;

/// Reads one table and applies it to the materials that fit `pattern`. `complete` says that all imports were read, so
/// that a name which fits nothing is the file's mistake.
pub(super) fn read(pattern: &str, mut keys: Keys<'_>, assets: &mut Assets, complete: bool) {
    let edits = edits(&mut keys, assets);
    let fitting = shown::fitting(pattern, &mut assets.scene);
    for &id in &fitting {
        let material = &mut assets.scene.materials[id];
        edits.iter().for_each(|edit| edit(material));
    }
    if fitting.is_empty() && complete {
        unmatched(pattern, &keys, assets);
    }
    keys.finish();
}

fn unmatched(pattern: &str, keys: &Keys<'_>, assets: &Assets) {
    // Who writes the path of a material in another file means the name at its end.
    let name = pattern.rsplit('/').next().unwrap_or(pattern);
    let mut names: Vec<_> = assets.scene.materials.iter().map(|material| material.name.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    if glob::is_glob(pattern) {
        keys.warn("no imported material fits this pattern");
    } else if pattern.contains('/') {
        let complaint = Complaint::new("no import shows a material at this path");
        keys.reject(complaint.hint(advice(name, names)));
    } else {
        let complaint = Complaint::new("no import has a material of this name");
        keys.reject(complaint.hint(advice(name, names)));
    }
}

/// All keys of a material table.
fn edits(keys: &mut Keys<'_>, assets: &mut Assets) -> Vec<Edit> {
    let mut found = Found { keys, assets, edits: Vec::new() };
    found.input("base_color", 0.0..=1.0, |m| &mut m.base_color);
    found.input("diffuse_roughness", 0.0..=1.0, |m| &mut m.diffuse_roughness);
    found.input("metallic", 0.0..=1.0, |m| &mut m.metallic);
    found.input("roughness", 0.0..=1.0, |m| &mut m.roughness);
    found.input("anisotropy", 0.0..=1.0, |m| &mut m.anisotropy);
    found.input("specular", 0.0..=1.0, |m| &mut m.specular);
    found.input("specular_color", 0.0..=1.0, |m| &mut m.specular_color);
    found.input("transmission", 0.0..=1.0, |m| &mut m.transmission);
    found.input("diffuse_transmission", 0.0..=1.0, |m| &mut m.diffuse_transmission);
    found.input("diffuse_transmission_color", 0.0..=1.0, |m| &mut m.diffuse_transmission_color);
    found.input("sheen_color", 0.0..=1.0, |m| &mut m.sheen_color);
    found.input("sheen_roughness", 0.0..=1.0, |m| &mut m.sheen_roughness);
    found.input("film", 0.0..=1.0, |m| &mut m.film);
    found.input("film_thickness", 0.0.., |m| &mut m.film_thickness);
    found.input("coat", 0.0..=1.0, |m| &mut m.coat);
    found.input("coat_roughness", 0.0..=1.0, |m| &mut m.coat_roughness);
    found.input("emission", 0.0.., |m| &mut m.emission);
    found.input("opacity", 0.0..=1.0, |m| &mut m.opacity);
    found.value("anisotropy_rotation", number(ANY), |m, degrees| {
        m.anisotropy_rotation = degrees.to_radians() as f32;
    });
    found.value("ior", number(1.0..), |m, ior| m.ior = ior as f32);
    found.value("dispersion", number(0.0..), |m, dispersion| m.dispersion = dispersion as f32);
    found.value("film_ior", number(1.0..), |m, ior| m.film_ior = ior as f32);
    found.value("coat_ior", number(1.0..), |m, ior| m.coat_ior = ior as f32);
    found.value("attenuation_color", Vec3::read(0.0..=1.0), |m, color| m.attenuation_color = color);
    found.value("attenuation_distance", distance_or_infinity, |m, distance| {
        m.attenuation_distance = distance as f32;
    });
    found.value("thin_walled", flag, |m, on| m.thin_walled = on);
    found.value("double_sided", flag, |m, on| m.double_sided = on);
    found.value("cull_back", flag, |m, on| m.cull_back = on);
    found.value("unlit", flag, |m, on| m.unlit = on);
    found.alpha();
    found.anisotropy_direction();
    found.normal_map("normal", |m| &mut m.normal_map);
    found.normal_map("coat_normal", |m| &mut m.coat_normal_map);
    found.edits
}

struct Found<'k, 'r> {
    keys: &'k mut Keys<'r>,
    assets: &'k mut Assets,
    edits: Vec<Edit>,
}

impl Found<'_, '_> {
    /// A plain parameter.
    fn value<T: Copy + 'static>(
        &mut self,
        key: &str,
        read: impl FnOnce(&DeValue<'_>) -> Result<T, Complaint>,
        set: fn(&mut Material, T),
    ) {
        if let Some(value) = self.keys.optional(key, read) {
            self.edits.push(Box::new(move |material| set(material, value)));
        }
    }

    /// `key` and `key_texture` together are the whole input: what the import had is gone.
    fn input<T: Factor>(
        &mut self,
        key: &str,
        range: impl RangeBounds<f64>,
        field: fn(&mut Material) -> &mut Input<T>,
    ) {
        let value = self.keys.optional(key, T::read(range));
        let texture = self.assets.texture(self.keys, &format!("{key}_texture"), T::USE);
        if value.is_some() || texture.is_some() {
            let input = Input { value: value.unwrap_or(T::ONE), texture };
            self.edits.push(Box::new(move |material| *field(material) = input));
        }
    }

    fn alpha(&mut self) {
        let cutoff = self.keys.optional("alpha_cutoff", number(0.0..=1.0));
        let modes = [
            ("opaque", AlphaMode::Opaque),
            ("mask", AlphaMode::Mask(cutoff.unwrap_or(0.5) as f32)),
            ("blend", AlphaMode::Blend),
        ];
        let mode = self.keys.optional("alpha_mode", choice(modes));
        if cutoff.is_some() && !matches!(mode, Some(AlphaMode::Mask(_))) {
            self.keys.complain("alpha_cutoff", Complaint::new("needs alpha_mode = \"mask\" beside it"));
        }
        if let Some(mode) = mode {
            self.edits.push(Box::new(move |material| material.alpha_mode = mode));
        }
    }

    fn anisotropy_direction(&mut self) {
        if let Some(map) = self.assets.texture(self.keys, "anisotropy_direction_texture", Use::Normal) {
            self.edits.push(Box::new(move |m| m.anisotropy_direction = Some(map.texture)));
        }
    }

    fn normal_map(&mut self, name: &str, field: fn(&mut Material) -> &mut Option<NormalMap>) {
        let map = self.assets.texture(self.keys, &format!("{name}_texture"), Use::Normal);
        let scale = self.keys.optional(&format!("{name}_scale"), number(ANY)).map(|scale| scale as f32);
        if let Some(map) = map {
            let map = NormalMap { texture: map.texture, scale: scale.unwrap_or(1.0) };
            self.edits.push(Box::new(move |material| *field(material) = Some(map)));
        } else if let Some(scale) = scale {
            // Without a texture of its own, the key scales the map that the import has.
            self.edits.push(Box::new(move |material| {
                field(material).iter_mut().for_each(|map| map.scale = scale);
            }));
        }
    }
}

/// What an input can be: one number or a colour.
trait Factor: Copy + 'static {
    const ONE: Self;
    const USE: Use;
    fn read(range: impl RangeBounds<f64>) -> impl FnOnce(&DeValue<'_>) -> Result<Self, Complaint>;
}

impl Factor for f32 {
    const ONE: Self = 1.0;
    const USE: Use = Use::Scalar;
    fn read(range: impl RangeBounds<f64>) -> impl FnOnce(&DeValue<'_>) -> Result<Self, Complaint> {
        move |value| number(range)(value).map(|number| number as f32)
    }
}

impl Factor for Vec3 {
    const ONE: Self = Vec3::ONE;
    const USE: Use = Use::Color;
    fn read(range: impl RangeBounds<f64>) -> impl FnOnce(&DeValue<'_>) -> Result<Self, Complaint> {
        move |value| numbers::<3>(range)(value).map(|color| Vec3::from_array(color.map(|c| c as f32)))
    }
}
