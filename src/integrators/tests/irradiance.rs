//! Light in its unit, from the scene to the pixel: a white patch under one light of each kind shows E ρ/π, with the
//! irradiance E (lux) of textbook formulas, by every integrator.
#![allow(clippy::unwrap_used, reason = "a failing test panics")]

mod common;

use std::f64::consts::{PI, TAU};

use ajar_integrators::integrators;
use ajar_scene::{Filter, Id, Input, LightKind, Material, Texture, TextureInput};
use common::{Builder, diffuse, pinhole, render_blocks, settings, shapes};
use glam::{DVec3, Vec3};

const ALBEDO: f64 = 0.5;
/// Of the patch, which lies at the origin and faces +Z, to a light.
const DISTANCE: f64 = 2.0;

/// The patch, two metres wide, and a camera that sees eight millimetres of it.
fn patch() -> Builder {
    let mut b = Builder::default();
    let grey = b.diffuse(Vec3::splat(ALBEDO as f32));
    b.mesh(shapes::quad(Vec3::new(-1.0, -1.0, 0.0), Vec3::X * 2.0, Vec3::Y * 2.0), grey);
    b.camera(pinhole(0.004), DVec3::new(0.3, -1.8, 0.9), DVec3::ZERO);
    b
}

/// Asserts that every integrator measures the irradiance `lux`.
#[track_caller]
fn assert_irradiance(name: &str, b: Builder, lux: f64) {
    let world = b.world(4);
    let expected = lux * ALBEDO / PI;
    for integrator in integrators() {
        let blocks = render_blocks(&world, *integrator, &settings(&world, 1, 3, 256), 48);
        // Of the whole image, which is smaller than a block.
        let (mean, variance) = blocks.estimate(0);
        let error = variance.powf(0.5) * 4.0 + expected * 1e-3;
        println!("{name}, {}: {:.5}, expected {expected:.5} ± {:.5}", integrator.name(), mean.x, error.x);
        assert!(error.max_element() <= 0.02 * expected, "{name}, {}: too noisy to tell", integrator.name());
        let off = (mean - expected).abs();
        assert!(off.cmple(error).all(), "{name}, {}: {mean}, expected {expected}", integrator.name());
    }
}

/// The patch under a light above it that shines down.
#[track_caller]
fn assert_light(name: &str, kind: LightKind, at: DVec3, target: DVec3, lux: f64) {
    let mut b = patch();
    b.light(kind, at, target);
    assert_irradiance(name, b, lux);
}

const ABOVE: DVec3 = DVec3::new(0.0, 0.0, DISTANCE);
/// Aside by as much as it is above: 45°.
const ASIDE: DVec3 = DVec3::new(DISTANCE, 0.0, DISTANCE);

#[test]
fn lights_without_extent() {
    let point = LightKind::Point { intensity: 100.0 };
    // I cosθ / d².
    let aside = 100.0 * 0.5f64.sqrt() / (2.0 * DISTANCE * DISTANCE);
    assert_light("point above", point.clone(), ABOVE, DVec3::ZERO, 100.0 / (DISTANCE * DISTANCE));
    assert_light("point aside", point, ASIDE, DVec3::ZERO, aside);
    let spot = |inner, outer| LightKind::Spot { intensity: 100.0, inner, outer };
    assert_light("spot", spot(0.3, 0.5), ASIDE, DVec3::ZERO, aside);
    // Half way between the cosines of both angles it has a quarter of its intensity (KHR_lights_punctual).
    let angle = f64::acos(0.5 * (0.3f64.cos() + 0.5f64.cos()));
    let target = ABOVE - DVec3::new(angle.sin(), 0.0, angle.cos());
    assert_light("edge of a spot", spot(0.3, 0.5), ABOVE, target, 25.0 / (DISTANCE * DISTANCE));
}

#[test]
fn suns() {
    for (angle, name) in [(0.0, "sun without extent"), (0.009_3, "sun"), (0.8, "wide sun")] {
        // Illuminance is that of a surface which faces it: the cosine law holds for a whole disc above the horizon.
        let kind = LightKind::Directional { illuminance: 50.0, angle };
        assert_light(name, kind, ASIDE, DVec3::ZERO, 50.0 * 0.5f64.sqrt());
    }
}

/// Configuration factor of a rectangle to a parallel element below one of its corners; sides in multiples of the
/// distance (Howell, A Catalog of Radiation Heat Transfer Configuration Factors, B-3).
fn corner_factor(a: f64, b: f64) -> f64 {
    let (x, y) = ((1.0 + a * a).sqrt(), (1.0 + b * b).sqrt());
    (a / x * (b / x).atan() + b / y * (a / y).atan()) / TAU
}

#[test]
fn flat_lights() {
    let rect = LightKind::Rect { radiance: 30.0, width: 1.0, height: 2.4, texture: None };
    let factor = 4.0 * corner_factor(0.5 / DISTANCE, 1.2 / DISTANCE);
    assert_light("rectangle", rect, ABOVE, DVec3::ZERO, PI * 30.0 * factor);
    // Howell B-13, a disc above its centre.
    let disk = LightKind::Disk { radiance: 30.0, radius: 0.8 };
    let factor = 0.64 / (0.64 + DISTANCE * DISTANCE);
    assert_light("disc", disk, ABOVE, DVec3::ZERO, PI * 30.0 * factor);
    let backwards = LightKind::Disk { radiance: 3.0, radius: 0.8 };
    let mut b = patch();
    b.light(backwards, ABOVE, ABOVE * 2.0);
    b.light(LightKind::Point { intensity: 4.0 }, ABOVE * 0.5, DVec3::ZERO);
    assert_irradiance("a disc shines to one side only", b, 4.0);
}

/// E of a tube along X or Y above the patch: its surface summed up, as far as it is seen.
fn tube(radiance: f64, radius: f64, length: f64) -> f64 {
    const N: usize = 400;
    let middle = |i: usize, size: f64| (i as f64 + 0.5) / N as f64 * size;
    let mut sum = 0.0;
    for i in 0..N * N {
        let (along, (sin, cos)) = (middle(i % N, length) - 0.5 * length, middle(i / N, TAU).sin_cos());
        let normal = DVec3::new(0.0, sin, cos);
        let p = ABOVE + normal * radius + DVec3::X * along;
        let towards = -p.normalize();
        sum += normal.dot(towards).max(0.0) * p.normalize().z / p.length_squared();
    }
    radiance * sum * TAU * radius * length / (N * N) as f64
}

#[test]
fn round_lights() {
    let (radiance, radius) = (30.0, 0.4);
    let ball = LightKind::Sphere { radiance, radius };
    let (r, d) = (f64::from(radius), DISTANCE);
    // E = π L (r/d)² cosθ above the horizon.
    assert_light("ball above", ball.clone(), ABOVE, DVec3::ZERO, PI * 30.0 * (r / d).powi(2));
    let aside = PI * 30.0 * r * r / (2.0 * d * d) * 0.5f64.sqrt();
    assert_light("ball aside", ball, ASIDE, DVec3::ZERO, aside);
    let kind = LightKind::Cylinder { radiance, radius: 0.2, length: 1.5 };
    assert_light("tube", kind, ABOVE, DVec3::ZERO, tube(30.0, 0.2, 1.5));
}

/// A texture of one column of pixels from top to bottom, in fractions of 255.
fn column(b: &mut Builder, values: &[u8]) -> Id<Texture> {
    let texture = b.texture([1, values.len() as u32], |_, y| [values[y as usize]; 3]);
    b.scene.textures[texture].filter = Filter::Nearest;
    texture
}

#[test]
fn emitting_meshes() {
    let lamp = || shapes::quad(Vec3::new(-0.5, 1.2, 2.0), Vec3::X, Vec3::NEG_Y * 2.4);
    let half = 2.0 * corner_factor(0.5 / DISTANCE, 1.2 / DISTANCE);
    let mut b = patch();
    let material = b.emitter(Vec3::splat(30.0));
    b.mesh(lamp(), material);
    assert_irradiance("emitting mesh", b, PI * 30.0 * 2.0 * half);
    // One half of it shines three times as bright as the other.
    let mut b = patch();
    let texture = column(&mut b, &[85, 255]);
    let texture = Some(TextureInput { texture, channel: Default::default() });
    let emission = Input { value: Vec3::splat(30.0), texture };
    let material = b.material(Material { emission, ..diffuse(Vec3::ZERO) });
    b.mesh(lamp(), material);
    assert_irradiance("textured mesh", b, PI * 10.0 * (1.0 + 3.0) * half);
}

#[test]
fn skies() {
    let sky = |radiance, texture| LightKind::Environment { radiance, texture };
    assert_light("even sky", sky(20.0, None), DVec3::ZERO, DVec3::NEG_Z, PI * 20.0);
    // The image's pole is +Y, in the plane of the patch, which sees half of each half.
    let mut b = patch();
    let texture = column(&mut b, &[255, 51]);
    b.light(sky(20.0, Some(texture)), DVec3::ZERO, DVec3::NEG_Z);
    assert_irradiance("image", b, PI * 20.0 * (1.0 + 0.2) / 2.0);
}
