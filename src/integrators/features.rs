//! What the camera sees first: the auxiliary images (albedo, normals, depth, position, texture coordinates, ids).

use ajar_render::{World, path::Kind, sampler::Sequence};
use glam::{DVec2, DVec3, Vec2, Vec3};
use rayon::prelude::*;

use crate::Window;

/// Eye samples a pixel for what is averaged.
const SAMPLES: u32 = 16;
/// Their stream of samples, which no image uses.
const STREAM: u32 = u32::MAX - 1;

/// First-hit features of one pixel. Albedo and normals are averages over the pixel (0 where nothing is hit); the rest is
/// taken at its centre.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Features {
    /// Reflectance, linear Rec.709.
    pub albedo: Vec3,
    /// Shading normal, world space, towards the camera.
    pub normal: Vec3,
    /// Geometric normal, world space, towards the camera.
    pub geometric_normal: Vec3,
    /// Share of the pixel that some surface covers.
    pub alpha: f32,
    /// Distance along the optical axis, metres; 0 where nothing is hit.
    pub depth: f32,
    /// World position, metres.
    pub position: Vec3,
    /// First texture coordinates.
    pub uv: Vec2,
    /// 1 + index of the material; 0 where nothing is hit.
    pub material: u32,
    /// 1 + index of the placed mesh; 0 where nothing is hit.
    pub object: u32,
}

/// The features of all pixels of `window`, row by row.
pub fn features(world: &World, window: Window) -> Vec<Features> {
    features_of(world, window, SAMPLES)
}

/// The same with another number of eye samples a pixel, for who is in a hurry.
pub fn features_of(world: &World, window: Window, samples: u32) -> Vec<Features> {
    (window.y0..window.y1)
        .into_par_iter()
        .flat_map_iter(|y| (window.x0..window.x1).map(move |x| pixel(world, x, y, samples)))
        .collect()
}

fn pixel(world: &World, x: u32, y: u32, samples: u32) -> Features {
    let corner = DVec2::new(x.into(), y.into());
    let mut found = at_centre(world, corner + 0.5);
    let index = u64::from(y) * u64::from(world.camera.width) + u64::from(x);
    let (mut albedo, mut normal, mut geometric, mut hits) = (DVec3::ZERO, DVec3::ZERO, DVec3::ZERO, 0.0);
    let sequence = Sequence::new(0, STREAM, index);
    for sample in 0..samples {
        let mut sobol = sequence.sample(sample.into());
        let raster = corner + DVec2::from_array(sobol.next_2d());
        let ray = world.camera.ray(raster, sobol.next_2d());
        let seed = (sobol.next_1d() * 4_294_967_296.0) as u32;
        let Some(hit) = world.trace(ray.origin, ray.direction, true, seed) else { continue };
        let facing = -hit.ng.dot(ray.direction).signum();
        albedo += hit.bsdf.albedo();
        normal += hit.frame.z * facing;
        geometric += hit.ng * facing;
        hits += 1.0;
    }
    let count = f64::from(samples);
    found.albedo = (albedo / count).as_vec3();
    found.normal = (normal / count).as_vec3();
    found.geometric_normal = (geometric / count).as_vec3();
    found.alpha = (hits / count) as f32;
    found
}

fn at_centre(world: &World, raster: DVec2) -> Features {
    let ray = world.camera.ray(raster, [0.5; 2]);
    let Some(hit) = world.trace(ray.origin, ray.direction, true, 0) else {
        return Features::default();
    };
    debug_assert_eq!(hit.kind, Kind::Surface);
    Features {
        depth: world.camera.depth(hit.p) as f32,
        position: hit.p.as_vec3(),
        uv: world.uv(&hit),
        material: 1 + world.instances()[hit.site.instance as usize].material,
        object: 1 + hit.site.instance,
        ..Features::default()
    }
}
