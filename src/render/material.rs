//! Materials at a point: textured parameters into a BSDF, an emission, an opacity.

use ajar_scene as scene;
use ajar_scene::{AlphaMode, Channel, Input, NormalMap, TextureInput};
use glam::{DVec3, Vec2, Vec3, Vec4};

use crate::{
    bsdf::{Bsdf, SurfaceParameters},
    math::Rgb,
    texture::Textures,
};

/// Where on a surface a material is asked for.
pub trait Place {
    /// Texture coordinates of a set; the origin where the mesh has no such set.
    fn uv(&self, set: u32) -> Vec2;
    /// Vertex colour, white where the mesh has none.
    fn color(&self) -> Vec4;
}

/// A material prepared for lookups.
#[derive(Clone, Debug)]
pub struct Material {
    source: scene::Material,
    uses_color: bool,
    constant: Option<Bsdf>,
    absorption: Option<Rgb>,
}

impl Material {
    /// Prepares `source`; `uses_color` if some mesh that has it carries vertex colours.
    pub fn new(source: scene::Material, uses_color: bool) -> Self {
        let textured = is_textured(&source) || uses_color;
        let absorption = absorption(&source);
        let mut material = Self { source, uses_color, constant: None, absorption };
        if !textured {
            material.constant = Some(material.build(&Textures::default(), &Nowhere, 1.0));
        }
        material
    }

    /// The scene's description of it.
    pub fn source(&self) -> &scene::Material {
        &self.source
    }

    /// Whether camera rays pass its back.
    pub fn cull_back(&self) -> bool {
        self.source.cull_back
    }

    /// Absorption coefficient of its inside, 1/m, if it absorbs.
    pub fn absorption(&self) -> Option<Rgb> {
        self.absorption
    }

    /// Whether it emits anywhere.
    pub fn emits(&self) -> bool {
        self.emission_factor().max_element() > 0.0
    }

    /// What the emission texture, if any, multiplies.
    pub fn emission_factor(&self) -> Rgb {
        let factor =
            if self.source.unlit { self.source.base_color.value } else { self.source.emission.value };
        factor.as_dvec3()
    }

    /// Whether rays may pass it by chance.
    pub fn has_alpha(&self) -> bool {
        let constant = self.source.opacity.texture.is_none() && !self.uses_color;
        match self.source.alpha_mode {
            AlphaMode::Opaque => false,
            AlphaMode::Mask(_) | AlphaMode::Blend => !(constant && self.source.opacity.value >= 1.0),
        }
    }

    /// Whether its back emits too.
    pub fn emits_both_sides(&self) -> bool {
        self.source.double_sided
    }

    /// Makes `bsdf` how it scatters at `place`; `turn` is −1 where texture coordinates run clockwise, else 1.
    #[inline]
    pub fn set_bsdf(&self, textures: &Textures, place: &impl Place, turn: f64, bsdf: &mut Bsdf) {
        match &self.constant {
            Some(constant) => bsdf.set(constant),
            None => *bsdf = self.build(textures, place, turn),
        }
    }

    /// Whether its coat has another normal than the rest.
    pub fn tilts_coat(&self) -> bool {
        let m = &self.source;
        m.coat.value > 0.0 && !m.unlit && (m.normal_map.is_some() || m.coat_normal_map.is_some())
    }

    /// Emitted radiance at `place`, of the sides that emit.
    pub fn emission(&self, textures: &Textures, place: &impl Place) -> Rgb {
        if self.source.unlit {
            self.base_color(textures, place)
        } else {
            color(&self.source.emission, textures, place)
        }
    }

    /// Coverage at `place` in [0, 1].
    pub fn opacity(&self, textures: &Textures, place: &impl Place) -> f64 {
        let opacity = || {
            let vertex = if self.uses_color { f64::from(place.color().w.clamp(0.0, 1.0)) } else { 1.0 };
            (number(&self.source.opacity, textures, place) * vertex).clamp(0.0, 1.0)
        };
        match self.source.alpha_mode {
            AlphaMode::Opaque => 1.0,
            AlphaMode::Mask(cutoff) => f64::from(u8::from(opacity() >= f64::from(cutoff))),
            AlphaMode::Blend => opacity(),
        }
    }

    /// Tangent-space shading normal of the normal map at `place`.
    pub fn mapped_normal(&self, textures: &Textures, place: &impl Place) -> Option<DVec3> {
        mapped(self.source.normal_map?, textures, place)
    }

    /// The same of the coat's normal map.
    pub fn mapped_coat_normal(&self, textures: &Textures, place: &impl Place) -> Option<DVec3> {
        mapped(self.source.coat_normal_map?, textures, place)
    }

    /// Angle from the tangent in which highlights are stretched.
    fn stretch(&self, textures: &Textures, place: &impl Place) -> f64 {
        let m = &self.source;
        let direction = m.anisotropy_direction.map_or(0.0, |texture| {
            let texel = fetch(TextureInput { texture, channel: Channel::R }, textures, place);
            let direction = texel.truncate().truncate() * 2.0 - Vec2::ONE;
            f64::from(direction.y.atan2(direction.x))
        });
        direction + f64::from(m.anisotropy_rotation)
    }

    fn base_color(&self, textures: &Textures, place: &impl Place) -> Rgb {
        let vertex = if self.uses_color { place.color().truncate().as_dvec3() } else { Rgb::ONE };
        color(&self.source.base_color, textures, place) * vertex
    }

    fn build(&self, textures: &Textures, place: &impl Place, turn: f64) -> Bsdf {
        let m = &self.source;
        if m.unlit {
            return Bsdf::BLACK;
        }
        let unit = |input: &Input<f32>| number(input, textures, place).clamp(0.0, 1.0);
        let within = |c: Rgb| c.clamp(Rgb::ZERO, Rgb::ONE);
        Bsdf::new(&SurfaceParameters {
            base_color: within(self.base_color(textures, place)),
            diffuse_roughness: unit(&m.diffuse_roughness),
            metallic: unit(&m.metallic),
            roughness: unit(&m.roughness),
            anisotropy: unit(&m.anisotropy),
            anisotropy_rotation: turn * self.stretch(textures, place),
            specular: unit(&m.specular),
            specular_color: within(color(&m.specular_color, textures, place)),
            ior: m.ior.into(),
            dispersion: m.dispersion.into(),
            transmission: unit(&m.transmission),
            diffuse_transmission: unit(&m.diffuse_transmission),
            diffuse_transmission_color: within(color(&m.diffuse_transmission_color, textures, place)),
            sheen_color: within(color(&m.sheen_color, textures, place)),
            sheen_roughness: unit(&m.sheen_roughness),
            film: unit(&m.film),
            film_ior: m.film_ior.into(),
            film_thickness: number(&m.film_thickness, textures, place),
            thin_walled: m.thin_walled,
            coat: unit(&m.coat),
            coat_roughness: unit(&m.coat_roughness),
            coat_ior: m.coat_ior.into(),
        })
    }
}

fn is_textured(m: &scene::Material) -> bool {
    let numbers = [
        &m.diffuse_roughness,
        &m.metallic,
        &m.roughness,
        &m.anisotropy,
        &m.specular,
        &m.transmission,
        &m.diffuse_transmission,
        &m.sheen_roughness,
        &m.film,
        &m.film_thickness,
        &m.coat,
        &m.coat_roughness,
    ];
    let colors = [&m.base_color, &m.specular_color, &m.diffuse_transmission_color, &m.sheen_color];
    m.anisotropy_direction.is_some()
        || numbers.iter().any(|i| i.texture.is_some())
        || colors.iter().any(|i| i.texture.is_some())
}

/// Beer–Lambert coefficient: σ = −ln(colour) / distance (KHR_materials_volume).
fn absorption(m: &scene::Material) -> Option<Rgb> {
    let absorbs = m.transmission.value.max(m.diffuse_transmission.value) > 0.0
        && !m.thin_walled
        && m.attenuation_distance.is_finite()
        && m.attenuation_color.min_element() < 1.0;
    absorbs.then(|| {
        let color = m.attenuation_color.as_dvec3().clamp(Rgb::splat(1e-6), Rgb::ONE);
        -color.ln() / f64::from(m.attenuation_distance).max(1e-9)
    })
}

fn mapped(map: NormalMap, textures: &Textures, place: &impl Place) -> Option<DVec3> {
    let texel = fetch(TextureInput { texture: map.texture, channel: Channel::R }, textures, place);
    let n = texel.truncate() * 2.0 - Vec3::ONE;
    (n * Vec3::new(map.scale, map.scale, 1.0)).as_dvec3().try_normalize()
}

/// Raw texel of an input's texture.
fn fetch(input: TextureInput, textures: &Textures, place: &impl Place) -> Vec4 {
    let Some(texture) = textures.get(input.texture) else { return Vec4::ONE };
    texture.sample(place.uv(texture.uv_set()).to_array())
}

fn number(input: &Input<f32>, textures: &Textures, place: &impl Place) -> f64 {
    let Some(texture) = input.texture else { return input.value.into() };
    let texel = fetch(texture, textures, place);
    f64::from(input.value) * f64::from(texture.channel.of(texel))
}

fn color(input: &Input<Vec3>, textures: &Textures, place: &impl Place) -> Rgb {
    let Some(texture) = input.texture else { return input.value.as_dvec3() };
    let texel = fetch(texture, textures, place).truncate().max(Vec3::ZERO);
    input.value.as_dvec3() * texel.as_dvec3()
}

/// For materials that are the same everywhere.
struct Nowhere;

impl Place for Nowhere {
    fn uv(&self, _: u32) -> Vec2 {
        Vec2::ZERO
    }
    fn color(&self) -> Vec4 {
        Vec4::ONE
    }
}
