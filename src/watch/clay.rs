//! Everything as if made of clay: form and light, without colour and gloss.

use ajar_scene::{Input, Material, Scene};
use glam::Vec3;

/// Albedo of clay.
const ALBEDO: f32 = 0.5;

/// Makes all of it clay but what lets light through or shines, which the light of the rest depends on. Cut-outs and normal
/// maps stay, for they are form.
pub(super) fn cover(scene: &mut Scene) {
    scene.materials.iter_mut().filter(|it| it.transmission.value == 0.0).for_each(|it| *it = clay(it));
}

fn clay(material: &Material) -> Material {
    Material {
        name: material.name.clone(),
        base_color: Input::constant(Vec3::splat(ALBEDO)),
        specular: Input::constant(0.0),
        emission: material.emission,
        double_sided: material.double_sided,
        cull_back: material.cull_back,
        opacity: material.opacity,
        alpha_mode: material.alpha_mode,
        normal_map: material.normal_map,
        ..Material::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_but_glass_and_lamps_is_clay() {
        let mut scene = Scene::default();
        let chrome = Material { metallic: Input::constant(1.0), unlit: true, ..Material::default() };
        let glass = Material { transmission: Input::constant(1.0), ..Material::default() };
        let lamp = Material { emission: Input::constant(Vec3::splat(9.0)), ..Material::default() };
        for material in [&chrome, &glass, &lamp] {
            scene.materials.push(material.clone());
        }
        cover(&mut scene);
        let covered: Vec<_> = scene.materials.iter().collect();
        assert_eq!(covered[0].base_color.value, Vec3::splat(ALBEDO));
        assert_eq!((covered[0].metallic.value, covered[0].unlit), (0.0, false));
        assert_eq!(*covered[1], glass);
        assert_eq!((covered[2].emission, covered[2].base_color.value), (lamp.emission, Vec3::splat(ALBEDO)));
    }
}
