//! Materials: one principled model that every format maps to.

use glam::{Vec3, Vec4};
use serde::{Deserialize, Serialize};

use crate::{Id, Texture};

/// Which part of a texture a scalar input reads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Channel {
    /// Red; also what colour inputs say, which read red, green and blue.
    #[default]
    R,
    /// Green.
    G,
    /// Blue.
    B,
    /// Alpha.
    A,
    /// Luminance of red, green and blue.
    L,
}

/// Weights of red, green and blue in a luminance (ITU-R BT.709).
const LUMINANCE: Vec3 = Vec3::new(0.2126, 0.7152, 0.0722);

impl Channel {
    /// Its number of a texel: red, green, blue and alpha, linear.
    #[inline]
    pub fn of(self, texel: Vec4) -> f32 {
        match self {
            Self::R => texel.x,
            Self::G => texel.y,
            Self::B => texel.z,
            Self::A => texel.w,
            Self::L => texel.truncate().dot(LUMINANCE),
        }
    }
}

/// A texture as one input sees it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TextureInput {
    /// What to read.
    pub texture: Id<Texture>,
    /// Channel of scalar inputs; colours read RGB.
    #[serde(default)]
    pub channel: Channel,
}

/// A material parameter: `value`, times the texture where there is one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Input<T> {
    /// Constant factor.
    pub value: T,
    /// Multiplies `value`.
    pub texture: Option<TextureInput>,
}

impl<T> Input<T> {
    /// An input without texture.
    pub const fn constant(value: T) -> Self {
        Self { value, texture: None }
    }
}

/// How opacity is used.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum AlphaMode {
    /// Opacity is ignored.
    #[default]
    Opaque,
    /// Opaque where opacity ≥ the cutoff, absent elsewhere.
    Mask(f32),
    /// Opacity is coverage: a ray meets the surface with this probability.
    Blend,
}

/// A tangent-space normal map: linear, green up, `n = 2c − 1` with `xy` scaled before normalization.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct NormalMap {
    /// The map.
    pub texture: Id<Texture>,
    /// Scale of the `x` and `y` components.
    #[serde(default = "one")]
    pub scale: f32,
}

fn one() -> f32 {
    1.0
}

/// A principled surface. Colours are linear Rec.709; reflectances and weights lie in [0, 1].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Material {
    /// Name from the asset; not necessarily unique.
    pub name: String,
    /// Where it is in its own file, as `/World/Looks/Chrome`; empty where files have no such places.
    pub path: String,
    /// Diffuse albedo, metal reflectance at normal incidence, tint of transmission.
    pub base_color: Input<Vec3>,
    /// Oren–Nayar roughness σ of the diffuse part, 0 (Lambert) to 1.
    pub diffuse_roughness: Input<f32>,
    /// 0 dielectric, 1 metal.
    pub metallic: Input<f32>,
    /// Perceptual roughness; the GGX width is its square. 0 is a perfect mirror.
    pub roughness: Input<f32>,
    /// Stretch of the highlight, 0 to 1: α along the tangent grows from α to 1 with its square (KHR_materials_anisotropy).
    pub anisotropy: Input<f32>,
    /// Rotation of the stretch, radians counter-clockwise from the tangent.
    pub anisotropy_rotation: f32,
    /// Texture whose red and green say the direction of the stretch, 2c − 1 along tangent and bitangent, before rotation.
    pub anisotropy_direction: Option<Id<Texture>>,
    /// Strength of the dielectric reflection, 1 is Fresnel's.
    pub specular: Input<f32>,
    /// Tint of the dielectric reflection at normal incidence.
    pub specular_color: Input<Vec3>,
    /// Index of refraction, ≥ 1.
    pub ior: f32,
    /// Spread of the index over wavelengths, 20 over the Abbe number (KHR_materials_dispersion); 0: none. Red, green and
    /// blue have three indices.
    pub dispersion: f32,
    /// Share of the dielectric's body that transmits instead of scattering diffusely.
    pub transmission: Input<f32>,
    /// A shell without inside: transmission does not refract, nothing is absorbed.
    pub thin_walled: bool,
    /// Share of the diffuse light that leaves on the other side.
    pub diffuse_transmission: Input<f32>,
    /// Its colour.
    pub diffuse_transmission_color: Input<Vec3>,
    /// Colour that white light has after `attenuation_distance` inside.
    pub attenuation_color: Vec3,
    /// In metres, world space; infinite: no absorption.
    #[serde(with = "crate::serde_finite")]
    pub attenuation_distance: f32,
    /// Colour of a layer of fibres over everything but the coat (KHR_materials_sheen).
    pub sheen_color: Input<Vec3>,
    /// Perceptual roughness of the fibres.
    pub sheen_roughness: Input<f32>,
    /// Weight of a thin film on the interface, which makes it iridescent.
    pub film: Input<f32>,
    /// Index of refraction of the film, ≥ 1.
    pub film_ior: f32,
    /// Thickness of the film, nanometres.
    pub film_thickness: Input<f32>,
    /// Weight of a clear coat over everything.
    pub coat: Input<f32>,
    /// Perceptual roughness of the coat.
    pub coat_roughness: Input<f32>,
    /// Index of refraction of the coat.
    pub coat_ior: f32,
    /// Emitted radiance in cd/m² per unit of the colour's channels.
    pub emission: Input<Vec3>,
    /// Whether the back emits too. Reflection is always two-sided.
    pub double_sided: bool,
    /// Camera rays pass through the back (glTF `doubleSided: false`).
    pub cull_back: bool,
    /// Coverage.
    pub opacity: Input<f32>,
    /// How `opacity` is used.
    pub alpha_mode: AlphaMode,
    /// Normal map of everything but the coat.
    pub normal_map: Option<NormalMap>,
    /// Normal map of the coat, with the tangents of `normal_map`.
    pub coat_normal_map: Option<NormalMap>,
    /// Shows `base_color` as it is, whatever the light (KHR_materials_unlit); all else but opacity is ignored.
    pub unlit: bool,
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: String::new(),
            path: String::new(),
            base_color: Input::constant(Vec3::splat(0.8)),
            diffuse_roughness: Input::constant(0.0),
            metallic: Input::constant(0.0),
            roughness: Input::constant(0.5),
            anisotropy: Input::constant(0.0),
            anisotropy_rotation: 0.0,
            anisotropy_direction: None,
            specular: Input::constant(1.0),
            specular_color: Input::constant(Vec3::ONE),
            ior: 1.5,
            dispersion: 0.0,
            transmission: Input::constant(0.0),
            diffuse_transmission: Input::constant(0.0),
            diffuse_transmission_color: Input::constant(Vec3::ONE),
            thin_walled: false,
            attenuation_color: Vec3::ONE,
            attenuation_distance: f32::INFINITY,
            sheen_color: Input::constant(Vec3::ZERO),
            sheen_roughness: Input::constant(0.0),
            film: Input::constant(0.0),
            film_ior: 1.3,
            film_thickness: Input::constant(400.0),
            coat: Input::constant(0.0),
            coat_roughness: Input::constant(0.0),
            coat_ior: 1.5,
            emission: Input::constant(Vec3::ZERO),
            double_sided: true,
            cull_back: false,
            opacity: Input::constant(1.0),
            alpha_mode: AlphaMode::Opaque,
            normal_map: None,
            coat_normal_map: None,
            unlit: false,
        }
    }
}
