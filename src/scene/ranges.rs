//! The ranges that material parameters make sense in.

use glam::Vec3;

use crate::{AlphaMode, Material};

impl Material {
    /// The same with every number moved to the nearest one that has a meaning: weights, roughnesses and reflectances to
    /// [0, 1], refractive indices to at least 1, emission to at least 0. What is not a number is left alone, `validate`
    /// refuses it. Renderers use this, so that what `validate` says about numbers out of range is what happens.
    pub fn in_range(&self) -> Material {
        let mut it = self.clone();
        it.numbers(|number| match number.range {
            _ if number.value.is_nan() => {}
            Range::Unit => *number.value = number.value.clamp(0.0, 1.0),
            Range::AtLeast(low) => *number.value = number.value.max(low),
            Range::Any => {}
        });
        it
    }

    /// Calls `visit` for every number, a channel at a time.
    pub(crate) fn numbers(&mut self, mut visit: impl FnMut(Number<'_>)) {
        let Material {
            base_color,
            diffuse_roughness,
            metallic,
            roughness,
            anisotropy,
            anisotropy_rotation,
            specular,
            specular_color,
            ior,
            dispersion,
            transmission,
            diffuse_transmission,
            diffuse_transmission_color,
            attenuation_color,
            attenuation_distance,
            sheen_color,
            sheen_roughness,
            film,
            film_ior,
            film_thickness,
            coat,
            coat_roughness,
            coat_ior,
            emission,
            opacity,
            alpha_mode,
            normal_map,
            coat_normal_map,
            name: _,
            path: _,
            anisotropy_direction: _,
            thin_walled: _,
            double_sided: _,
            cull_back: _,
            unlit: _,
        } = self;
        let mut see = |name, value, range| visit(Number { name, value, range });
        for (name, Vec3 { x, y, z }, range) in [
            ("base_color", &mut base_color.value, Range::Unit),
            ("specular_color", &mut specular_color.value, Range::Unit),
            ("diffuse_transmission_color", &mut diffuse_transmission_color.value, Range::Unit),
            ("attenuation_color", attenuation_color, Range::Unit),
            ("sheen_color", &mut sheen_color.value, Range::Unit),
            ("emission", &mut emission.value, Range::AtLeast(0.0)),
        ] {
            [x, y, z].into_iter().for_each(|channel| see(name, channel, range));
        }
        for (name, value) in [
            ("diffuse_roughness", &mut diffuse_roughness.value),
            ("metallic", &mut metallic.value),
            ("roughness", &mut roughness.value),
            ("anisotropy", &mut anisotropy.value),
            ("specular", &mut specular.value),
            ("transmission", &mut transmission.value),
            ("diffuse_transmission", &mut diffuse_transmission.value),
            ("sheen_roughness", &mut sheen_roughness.value),
            ("film", &mut film.value),
            ("coat", &mut coat.value),
            ("coat_roughness", &mut coat_roughness.value),
            ("opacity", &mut opacity.value),
        ] {
            see(name, value, Range::Unit);
        }
        see("ior", ior, Range::AtLeast(1.0));
        see("dispersion", dispersion, Range::AtLeast(0.0));
        see("film_ior", film_ior, Range::AtLeast(1.0));
        see("film_thickness", &mut film_thickness.value, Range::AtLeast(0.0));
        see("coat_ior", coat_ior, Range::AtLeast(1.0));
        see("anisotropy_rotation", anisotropy_rotation, Range::Any);
        if *attenuation_distance != f32::INFINITY {
            see("attenuation_distance", attenuation_distance, Range::AtLeast(0.0));
        }
        if let AlphaMode::Mask(cutoff) = alpha_mode {
            // A cutoff above 1 is how glTF hides everything.
            see("alpha_mode", cutoff, Range::AtLeast(0.0));
        }
        for (name, map) in [("normal_map.scale", normal_map), ("coat_normal_map.scale", coat_normal_map)] {
            map.iter_mut().for_each(|map| see(name, &mut map.scale, Range::Any));
        }
    }
}

/// One number of a material.
pub(crate) struct Number<'a> {
    pub name: &'static str,
    pub value: &'a mut f32,
    pub range: Range,
}

/// Where a number has a meaning.
#[derive(Clone, Copy)]
pub(crate) enum Range {
    /// [0, 1].
    Unit,
    /// From here on.
    AtLeast(f32),
    /// Everywhere.
    Any,
}
