//! The mapping of MTL to the principled material; the table is in the module above.

use std::f32::consts::TAU;

use ajar_scene::{
    AlphaMode, Channel, ColorSpace, Diagnostic, Input, Loss, Material, NormalMap, TextureInput,
};
use glam::Vec3;

use super::{
    bake::Recipe,
    lines::quote,
    mtl::Definition,
    texture::{Map, Textures},
};

/// Roughness of sheen, which the format does not state.
const SHEEN_ROUGHNESS: f32 = 0.3;

/// The exponent at which the format's range ends; it is written for perfectly smooth surfaces.
const MOST_SHINY: f32 = 1000.0;

/// Statements that nothing here can show, and why.
const UNSHOWN: [(&str, &str); 4] = [
    ("disp", "surfaces are not displaced"),
    ("decal", "there is no mask between Kd and map_Kd"),
    ("refl", "surfaces reflect the scene itself"),
    ("map_aat", "all textures are smoothed by samples"),
];

/// Perceptual roughness of an exponent: α = √(2 / (Ns + 2)) has the width of the Phong lobe (B. Walter et al., "Microfacet
/// models for refraction through rough surfaces", EGSR 2007, §5.2), and roughness is √α.
pub(super) fn roughness_of(ns: f32) -> f32 {
    if ns >= MOST_SHINY { 0.0 } else { (2.0 / (ns.max(0.0) + 2.0)).sqrt().sqrt() }
}

/// Turns a material as written into one of ours, and its images into textures.
pub(super) fn convert(mut of: Definition, textures: &mut Textures<'_>) -> Material {
    let mut converter = Converter { of: &mut of, textures };
    let (opacity, opacity_map) = converter.opacity();
    let illum = converter.of.source.illumination_model.unwrap_or(2);
    let ior = converter.of.source.optical_density;
    let glass = converter.is_glass(illum, ior, opacity);
    let mut material = Material { name: converter.of.source.name.clone(), ..Material::default() };
    material.ior = ior.filter(|&n| n > 1.0).unwrap_or(material.ior);
    converter.colors(&mut material, illum);
    converter.roughness(&mut material, glass || matches!(illum, 3 | 5 | 8));
    if glass {
        material.transmission = Input::constant(1.0);
        let tint = converter.parameter("Tf", vector).unwrap_or(Vec3::ONE);
        material.base_color = Input::constant(converter.unit("Tf", tint));
    } else if opacity < 1.0 {
        material.opacity.value = opacity;
        material.alpha_mode = AlphaMode::Blend;
    }
    if let Some(map) = opacity_map {
        material.opacity.texture = converter.textures.add(converter.of, "map_d", &map, ColorSpace::Raw);
        if material.opacity.texture.is_some() && material.alpha_mode == AlphaMode::Opaque {
            material.alpha_mode = AlphaMode::Mask(0.5);
        }
    }
    converter.coat(&mut material);
    converter.sheen(&mut material);
    converter.normals(&mut material);
    converter.report_leftovers();
    material
}

struct Converter<'a, 'b> {
    of: &'a mut Definition,
    textures: &'a mut Textures<'b>,
}

impl Converter<'_, '_> {
    /// Takes a statement that `tobj` does not know.
    fn parameter<T>(&mut self, name: &str, read: impl Fn(&str) -> Option<T>) -> Option<T> {
        read(&self.of.source.unknown_param.remove(name)?)
    }

    fn warn(&mut self, statement: &str, message: impl Into<String>) {
        self.textures.warn(self.of, statement, message.into());
    }

    fn approximate(&mut self, statement: &str, message: impl Into<String>) {
        self.textures.lose(self.of, statement, message.into(), Loss::Approximated);
    }

    /// Keeps weights and reflectances in [0, 1].
    fn unit(&mut self, name: &str, value: Vec3) -> Vec3 {
        let kept = value.clamp(Vec3::ZERO, Vec3::ONE);
        if kept != value {
            self.approximate(name, format!("{name} lies outside [0, 1] and is clamped"));
        }
        kept
    }

    /// A colour with its map. With a map, nothing or black is taken as white: many writers leave it so.
    fn color(
        &mut self,
        name: &str,
        written: Option<[f32; 3]>,
        map: Option<String>,
        default: Vec3,
    ) -> Input<Vec3> {
        let map_name = format!("map_{name}");
        let map = map.map(|text| Map::parse(&text));
        let texture = map.and_then(|map| self.textures.add(self.of, &map_name, &map, ColorSpace::Srgb));
        let value = match (written.map(Vec3::from_array), texture) {
            (Some(Vec3::ZERO), Some(_)) => {
                self.approximate(name, format!("{name} is 0 and would hide {map_name}; taken as 1"));
                Vec3::ONE
            }
            (None, Some(_)) => Vec3::ONE,
            (written, _) => written.unwrap_or(default),
        };
        Input { value, texture }
    }

    /// A weight of the PBR extension with its map, if either is there.
    fn scalar(&mut self, name: &str) -> Option<Input<f32>> {
        let map = self.parameter(&format!("map_{name}"), |text| Some(text.to_owned()));
        let written = self.parameter(name, |text| text.parse().ok());
        if written.is_none() && map.is_none() {
            return None;
        }
        let map_name = format!("map_{name}");
        let map = map.map(|text| Map::parse(&text));
        let texture = map.and_then(|map| self.textures.add(self.of, &map_name, &map, ColorSpace::Raw));
        let value = match (written, texture) {
            (Some(0.0), Some(_)) => {
                self.approximate(name, format!("{name} is 0 and would hide {map_name}; taken as 1"));
                1.0
            }
            (None, Some(_)) => 1.0,
            (written, _) => self.unit(name, Vec3::splat(written?)).x,
        };
        Some(Input { value, texture })
    }

    /// Opacity from `d`, else from `Tr`, and the map of it.
    fn opacity(&mut self) -> (f32, Option<Map>) {
        let transparency = self.parameter("Tr", |text| text.parse::<f32>().ok());
        if let (Some(d), Some(tr)) = (self.of.source.dissolve, transparency)
            && (d + tr - 1.0).abs() > 1e-3
        {
            self.approximate("Tr", "d and Tr disagree; d counts");
        }
        let opacity = self.of.source.dissolve.or(transparency.map(|tr| 1.0 - tr)).unwrap_or(1.0);
        let opacity = self.unit("d or 1 - Tr", Vec3::splat(opacity)).x;
        let color = self.of.source.diffuse_texture.as_deref().map(|text| Map::parse(text).file);
        let mut map = self.of.source.dissolve_texture.take().map(|text| Map::parse(&text));
        if let Some(map) = &mut map
            && Some(&map.file) == color.as_ref()
        {
            // One image for colour and mask: the mask is its alpha.
            map.channel.get_or_insert(Channel::A);
        }
        if let Some(map) = &mut map {
            map.channel.get_or_insert(Channel::L);
        }
        (opacity, map)
    }

    /// Whether an illumination model with transparency really refracts. Some exporters write `illum 4` and `Ni 1`
    /// for every opaque material.
    fn is_glass(&mut self, illum: u8, ior: Option<f32>, opacity: f32) -> bool {
        if !matches!(illum, 4 | 6 | 7 | 9) {
            return false;
        }
        let refracts = match ior {
            Some(ior) => ior > 1.0,
            None => matches!(illum, 6 | 7) || opacity < 1.0,
        };
        if !refracts && opacity == 1.0 {
            let message = format!("illum {illum} without an index of refraction above 1 is taken as opaque");
            self.textures.report.add(Diagnostic::note(message).in_file(&self.of.file).at(self.of.line, 1));
        }
        refracts
    }

    /// Base colour, metal, highlight and emission.
    fn colors(&mut self, material: &mut Material, illum: u8) {
        let (kd, kd_map) = (self.of.source.diffuse, self.of.source.diffuse_texture.take());
        let (ks, ks_map) = (self.of.source.specular, self.of.source.specular_texture.take());
        let extended = ["Pr", "map_Pr", "Pm", "map_Pm", "Pc", "Ps", "map_Ps"]
            .iter()
            .any(|p| self.of.source.unknown_param.contains_key(*p));
        let base = self.color("Kd", kd, kd_map, material.base_color.value);
        material.base_color = Input { value: self.unit("Kd", base.value), ..base };
        let specular = self.color("Ks", ks, ks_map, if extended { Vec3::splat(0.5) } else { Vec3::ZERO });
        let ks = self.unit("Ks", specular.value);
        let (diffuse, strength) = (material.base_color.value.max_element(), ks.max_element());
        if let Some(metallic) = self.scalar("Pm") {
            material.metallic = metallic;
        } else if matches!(illum, 3 | 5 | 8) && strength > 0.0 {
            // (1 − m)·b = Kd and m·b = Ks, exactly where both have one hue.
            material.metallic = Input::constant(strength / (strength + diffuse));
            material.base_color.value = (material.base_color.value + ks).min(Vec3::ONE);
            if specular.texture.is_some() {
                self.warn("map_Ks", "map_Ks of a mirror (illum 3, 5, 8) is dropped");
            }
        }
        let shines = illum >= 2 && strength > 0.0;
        material.specular = Input::constant(if shines { (2.0 * strength).min(1.0) } else { 0.0 });
        if shines {
            material.specular_color = Input { value: ks / strength, texture: specular.texture };
        }
        let ke_map = self.parameter("map_Ke", |text| Some(text.to_owned()));
        let emission = self.color("Ke", self.of.source.emissive, ke_map, Vec3::ZERO);
        material.emission = Input { value: emission.value.max(Vec3::ZERO), ..emission };
    }

    /// `Pr`, else the exponent.
    fn roughness(&mut self, material: &mut Material, traced: bool) {
        let map = self.of.source.shininess_texture.take().map(|text| Map::parse(&text));
        let (stated, ns) = (self.scalar("Pr"), self.of.source.shininess);
        if stated.is_some() && map.is_some() {
            self.warn("map_Ns", "map_Ns beside Pr is dropped");
        }
        let mapped = map.filter(|_| stated.is_none()).and_then(|map| self.shininess(&map, ns));
        material.roughness = match (stated.or(mapped), ns) {
            (Some(roughness), _) => roughness,
            (None, Some(ns)) => Input::constant(roughness_of(ns)),
            (None, None) if traced => Input::constant(0.0),
            (None, None) => material.roughness,
        };
        material.anisotropy = self.scalar("aniso").unwrap_or(material.anisotropy);
        material.anisotropy_rotation =
            TAU * self.parameter("anisor", |text| text.parse().ok()).unwrap_or(0.0);
    }

    /// The roughness of an exponent times its map.
    fn shininess(&mut self, map: &Map, written: Option<f32>) -> Option<Input<f32>> {
        let stated = written.filter(|&ns| ns > 0.0);
        let ns = stated.unwrap_or(MOST_SHINY);
        let recipe = Recipe::Roughness { base: ns * map.base, gain: ns * map.gain };
        let texture = self.textures.bake(self.of, "map_Ns", map, recipe)?;
        if stated.is_none() {
            let message = format!("map_Ns is there without an Ns above 0, which is taken as {MOST_SHINY}");
            self.approximate("map_Ns", message);
        }
        Some(Input { value: 1.0, texture: Some(TextureInput { texture, channel: Channel::R }) })
    }

    fn coat(&mut self, material: &mut Material) {
        material.coat = self.scalar("Pc").unwrap_or(material.coat);
        material.coat_roughness = self.scalar("Pcr").unwrap_or(material.coat_roughness);
    }

    /// The extension says no more than how much.
    fn sheen(&mut self, material: &mut Material) {
        let Some(sheen) = self.scalar("Ps") else { return };
        material.sheen_color = Input { value: Vec3::splat(sheen.value), texture: sheen.texture };
        material.sheen_roughness = Input::constant(SHEEN_ROUGHNESS);
    }

    /// `norm` is a normal map; what `map_Bump` names is one if its file says so, a height map otherwise.
    fn normals(&mut self, material: &mut Material) {
        let norm = self.parameter("norm", |text| Some(Map::parse(text)));
        let bump = self.of.source.normal_texture.take().map(|text| Map::parse(&text));
        let map = match (norm, bump) {
            (Some(norm), bump) => {
                if bump.is_some() {
                    self.warn("map_Bump", "map_Bump beside norm is dropped");
                }
                ("norm", norm)
            }
            (None, Some(bump)) if names_normals(&bump.file) => ("map_Bump", bump),
            (None, Some(heights)) => return self.heights(material, &heights),
            (None, None) => return,
        };
        let texture = self.textures.add(self.of, map.0, &map.1, ColorSpace::Raw);
        material.normal_map = texture.map(|input| NormalMap { texture: input.texture, scale: map.1.bump });
    }

    /// Slopes are in proportion to heights, so that factors of heights are the normal map's scale.
    fn heights(&mut self, material: &mut Material, map: &Map) {
        let mirrored = [map.scale.x < 0.0, map.scale.y < 0.0];
        let recipe = Recipe::Normals { clamp: map.clamp, mirrored };
        let Some(texture) = self.textures.bake(self.of, "map_Bump", map, recipe) else { return };
        self.approximate(
            "map_Bump",
            "map_Bump is a height map without unit; its heights are taken as -bm texels",
        );
        material.normal_map = Some(NormalMap { texture, scale: map.bump * map.gain });
    }

    fn report_leftovers(&mut self) {
        if self.of.source.ambient.is_some_and(|ka| ka != [0.0; 3]) || self.of.source.ambient_texture.is_some()
        {
            let note = Diagnostic::note("ambient colour (Ka, map_Ka) has no meaning in light transport");
            let hint = "light is emitted where Ke is written";
            self.textures.report.add(note.in_file(&self.of.file).at(self.of.line, 1).hint(hint));
        }
        // Maps have no order of their own.
        let mut left: Vec<_> = self.of.source.unknown_param.keys().cloned().collect();
        left.sort_unstable();
        for name in left {
            let why = UNSHOWN.iter().find(|(known, _)| *known == name);
            let why = why.map_or(String::new(), |(_, why)| format!(": {why}"));
            self.warn(&name, format!("statement {} is dropped{why}", quote(&name)));
        }
    }
}

/// Three numbers, as the library's reader writes them.
fn vector(text: &str) -> Option<Vec3> {
    let mut numbers = text.split_ascii_whitespace().map(str::parse);
    Some(Vec3::new(numbers.next()?.ok()?, numbers.next()?.ok()?, numbers.next()?.ok()?))
}

/// Whether a file name is one that people give normal maps.
fn names_normals(file: &str) -> bool {
    let file = file.to_ascii_lowercase();
    let stem = file.rsplit_once('.').map_or(file.as_str(), |(stem, _)| stem);
    ["normal", "nrm"].iter().any(|part| stem.contains(part))
        || ["_n", "_nor", "_norm", "_ddn"].iter().any(|end| stem.ends_with(end))
}
