//! Lights of the scene → emitters of the world.

use std::sync::Arc;

use ajar_scene::{Light, LightKind};
use glam::{DAffine3, DMat3, DVec3};
use rayon::prelude::*;

use super::World;
use crate::{
    environment::Environment,
    light::{DiracLight, Lights, TriangleLight},
    math::{Frame, Rgb, scalar},
    texture::{Texture, Textures},
};

/// One of the lights that make the surroundings.
#[derive(Clone, Debug)]
pub(super) enum Surrounding {
    /// Radiance.
    Uniform(Rgb),
    /// Image, rotation and radiance.
    Image(Texture, DMat3, Rgb),
    /// Direction to the centre, full angle and illuminance.
    Sun(DVec3, f64, Rgb),
}

impl Surrounding {
    fn is_same(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Uniform(a), Self::Uniform(b)) => a == b,
            (Self::Image(a, turn_a, radiance_a), Self::Image(b, turn_b, radiance_b)) => {
                a.is_same(b) && (turn_a, radiance_a) == (turn_b, radiance_b)
            }
            (Self::Sun(a, angle_a, lux_a), Self::Sun(b, angle_b, lux_b)) => {
                (a, angle_a, lux_a) == (b, angle_b, lux_b)
            }
            _ => false,
        }
    }
}

/// Finds all emitters of the world and names them to its instances. Surroundings that are those of `previous` are shared
/// with it.
pub(super) fn emitters(world: &mut World, sphere: (DVec3, f64), previous: Option<&World>) -> Lights {
    let mut dirac = Vec::new();
    let mut surroundings = Vec::new();
    let scene = Arc::clone(&world.scene);
    for placed in scene.placed().into_iter().filter(|p| p.visible) {
        let Some(light) = placed.node.light.map(|id| &scene.lights[id]) else { continue };
        add_light(light, &placed.world, &world.textures, &mut dirac, &mut surroundings);
    }
    world.surroundings = surroundings;
    let sky = environment(&world.surroundings, previous);
    let first = dirac.len() + usize::from(sky.is_some());
    let mut triangles = Vec::new();
    for index in 0..world.instances.len() {
        if world.materials[world.instances[index].material as usize].emits() {
            world.instances[index].first_emitter = Some((first + triangles.len()) as u32);
            let count = world.scene.meshes[world.instances[index].mesh].triangles.len() as u32;
            triangles.par_extend((0..count).into_par_iter().map(|t| triangle_light(world, index as u32, t)));
        }
    }
    Lights::new(dirac, sky, triangles, sphere)
}

/// What the surroundings look like together; `None` if they are black.
fn environment(surroundings: &[Surrounding], previous: Option<&World>) -> Option<Arc<Environment>> {
    let is_same = |old: &World| {
        old.surroundings.len() == surroundings.len()
            && old.surroundings.iter().zip(surroundings).all(|(a, b)| a.is_same(b))
    };
    if let Some(old) = previous.filter(|old| is_same(old)) {
        return old.lights.shared_environment();
    }
    let mut sky = Environment::default();
    for surrounding in surroundings {
        match surrounding.clone() {
            Surrounding::Uniform(radiance) => sky.add_uniform(radiance),
            Surrounding::Image(image, rotation, radiance) => sky.add_image(image, rotation, radiance),
            Surrounding::Sun(centre, angle, illuminance) => sky.add_sun(centre, angle, illuminance),
        }
    }
    (!sky.is_empty()).then(|| Arc::new(sky))
}

fn add_light(
    light: &Light,
    to_world: &DAffine3,
    textures: &Textures,
    dirac: &mut Vec<DiracLight>,
    surroundings: &mut Vec<Surrounding>,
) {
    let color = light.color.as_dvec3();
    let axis = to_world.transform_vector3(DVec3::NEG_Z).normalize_or(DVec3::NEG_Z);
    match light.kind {
        LightKind::Point { intensity } => dirac.push(DiracLight::Point {
            position: to_world.translation,
            intensity: color * f64::from(intensity),
        }),
        LightKind::Spot { intensity, inner, outer } => dirac.push(DiracLight::Spot {
            position: to_world.translation,
            frame: Frame::from_z(axis),
            intensity: color * f64::from(intensity),
            inner: f64::from(inner).cos(),
            outer: f64::from(outer).cos(),
        }),
        LightKind::Directional { illuminance, angle } => {
            let illuminance = color * f64::from(illuminance);
            if angle > 0.0 {
                surroundings.push(Surrounding::Sun(-axis, angle.into(), illuminance));
            } else {
                dirac.push(DiracLight::Directional { to_light: -axis, illuminance });
            }
        }
        LightKind::Environment { radiance, texture } => {
            let radiance = color * f64::from(radiance);
            surroundings.push(match texture.and_then(|id| textures.get(id)) {
                Some(image) => Surrounding::Image(image.clone(), rotation(to_world), radiance),
                None => Surrounding::Uniform(radiance),
            });
        }
        LightKind::Rect { .. }
        | LightKind::Disk { .. }
        | LightKind::Sphere { .. }
        | LightKind::Cylinder { .. } => {}
    }
}

/// The rotation of an affine map, by orthonormalizing its axes.
fn rotation(map: &DAffine3) -> DMat3 {
    let z = map.transform_vector3(DVec3::Z).normalize_or(DVec3::Z);
    let frame = Frame::from_zx(z, map.transform_vector3(DVec3::X));
    DMat3::from_cols(frame.x, frame.y, frame.z)
}

/// Barycentric points at which the emission of a triangle is averaged.
const EMISSION_PROBES: [[f64; 2]; 7] =
    [[1.0 / 3.0, 1.0 / 3.0], [0.6, 0.2], [0.2, 0.6], [0.2, 0.2], [0.05, 0.05], [0.9, 0.05], [0.05, 0.9]];

fn triangle_light(world: &World, instance: u32, triangle: u32) -> TriangleLight {
    let placed = &world.instances[instance as usize];
    let material = &world.materials[placed.material as usize];
    let vertices = world.geometry.vertices(instance, triangle);
    let [a, b, c] = vertices;
    let normal = (b - a).cross(c - a);
    let probe = |uv| scalar(material.emission(&world.textures, &world.point(placed, triangle, uv)));
    let mean = EMISSION_PROBES.iter().map(|&uv| probe(uv)).sum::<f64>() / EMISSION_PROBES.len() as f64;
    // Probes may miss the bright texels of a texture: some density stays wherever the material might shine.
    TriangleLight {
        instance,
        triangle,
        vertices,
        normal: normal.normalize_or(DVec3::Z) * placed.handedness,
        area: normal.length() / 2.0,
        rounding: world.geometry.rounding(instance, &vertices),
        both_sides: material.emits_both_sides(),
        brightness: mean.max(0.02 * scalar(material.emission_factor())),
    }
}
