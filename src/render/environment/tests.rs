use std::{f64::consts::TAU, sync::Arc};

use ajar_scene::Filter;
use glam::Vec3;

use super::*;
use crate::{
    chi2,
    rng::{Purpose, Rng},
    texture::{Bitmap, Texels},
};

/// An RGB image whose texels are `color(column, row)`.
fn image(width: usize, height: usize, filter: Filter, color: impl Fn(usize, usize) -> Vec3) -> Texture {
    let texels = (0..width * height).flat_map(|i| color(i % width, i / width).to_array()).collect();
    let bitmap = Bitmap::new(width, height, 3, Texels::F32(texels)).unwrap();
    let read = ajar_scene::Texture { filter, ..ajar_scene::Texture::new(ajar_scene::Id::new(0)) };
    Texture::new(Arc::new(bitmap), &read)
}

fn rotation() -> DMat3 {
    DMat3::from_axis_angle(DVec3::new(1.0, 2.0, -0.5).normalize(), 1.1)
}

/// Uneven image, uniform light and a wide sun together.
fn mixture() -> Environment {
    let mut environment = Environment::default();
    let color = |x: usize, y: usize| Vec3::splat((x * 7 % 5) as f32) * if y == 1 { 3.0 } else { 0.2 };
    environment.add_image(image(12, 5, Filter::Linear, color), rotation(), Rgb::new(1.0, 0.5, 0.2));
    environment.add_uniform(Rgb::new(0.1, 0.2, 0.6));
    environment.add_sun(DVec3::new(-1.0, 2.0, 0.3).normalize(), 1.0, Rgb::splat(2.0));
    environment
}

fn only(add: impl FnOnce(&mut Environment)) -> Environment {
    let mut environment = Environment::default();
    add(&mut environment);
    environment
}

#[test]
fn the_image_hangs_as_usd_says() {
    let texture = image(8, 4, Filter::Nearest, |x, y| Vec3::new(x as f32, y as f32, 1.0));
    let straight = only(|e| e.add_image(texture.clone(), DMat3::IDENTITY, Rgb::ONE));
    let at = |e: &Environment, x, y, z| {
        let c = e.radiance(DVec3::new(x, y, z).normalize());
        (c.x, c.y)
    };
    // Left edge: longitude +π, which is −Z reached from +X.
    assert_eq!(at(&straight, 0.1, 0.1, -1.0), (0.0, 1.0));
    assert_eq!(at(&straight, -0.1, 0.1, -1.0), (7.0, 1.0));
    // The centre faces +Z; seen from inside −X is to the right of it.
    assert_eq!(at(&straight, -0.1, -0.1, 1.0), (4.0, 2.0));
    assert_eq!(at(&straight, 0.1, -0.1, 1.0), (3.0, 2.0));
    // Longitude +π/2, the border of columns 1 and 2, is +X.
    assert_eq!(at(&straight, 1.0, 0.1, -0.1), (1.0, 1.0));
    assert_eq!(at(&straight, 1.0, 0.1, 0.1), (2.0, 1.0));
    assert_eq!(at(&straight, 0.0, 1.0, 0.0).1, 0.0);
    assert_eq!(at(&straight, 0.0, -1.0, 0.0).1, 3.0);
    // A light turned from +Z to +X shows its centre there.
    let turned = only(|e| e.add_image(texture, DMat3::from_rotation_y(TAU / 4.0), Rgb::ONE));
    assert_eq!(at(&turned, 1.0, -0.1, 0.1), (4.0, 2.0));
}

#[test]
fn directions_follow_the_density_which_integrates_to_one() {
    let environment = mixture();
    let mut rng = Rng::new(1, Purpose::Test, 0, 0);
    let n = 200_000;
    let probabilities = chi2::integrals(&|w| environment.pdf(w));
    let total: f64 = probabilities.iter().sum();
    assert!((total - 1.0).abs() < 1e-3, "{total}");
    let mut counts = vec![0.0; probabilities.len()];
    for _ in 0..n {
        counts[chi2::cell(environment.sample(rng.f64(), rng.pair()).1)] += 1.0;
    }
    let expected: Vec<f64> = probabilities.iter().map(|p| p * f64::from(n)).collect();
    let p = chi2::p_value(expected.into_iter().zip(counts));
    assert!(p > 1e-4, "p {p}");
}

#[test]
fn sampling_is_unbiased_and_power_is_the_integral() {
    let environment = mixture();
    let mut rng = Rng::new(2, Purpose::Test, 0, 0);
    let (n, mut sum) = (200_000, Rgb::ZERO);
    for _ in 0..n {
        let (_, w) = environment.sample(rng.f64(), rng.pair());
        sum += environment.radiance(w) / environment.pdf(w) / f64::from(n);
    }
    let integral: f64 = chi2::integrals(&|w| scalar(environment.radiance(w))).iter().sum();
    assert!((environment.power() / integral - 1.0).abs() < 1e-3);
    assert!((scalar(sum) / integral - 1.0).abs() < 0.01);
    let mean = sum / (4.0 * PI);
    assert!((mean / environment.mean_radiance() - 1.0).abs().max_element() < 0.02);
}

#[test]
fn every_component_inverts() {
    let mut environment = mixture();
    environment.add_sun(DVec3::NEG_Z, 0.0093, Rgb::splat(1e3));
    let mut rng = Rng::new(3, Purpose::Test, 0, 0);
    let mut met = [0; 4];
    for _ in 0..100_000 {
        let u = rng.pair();
        let (component, w) = environment.sample(rng.f64(), u);
        met[component] += 1;
        assert!((w.length() - 1.0).abs() < 1e-12);
        assert!(environment.pdf(w) > 0.0);
        let back = environment.invert(component, w).unwrap();
        let tolerance = if component == 3 { 1e-7 } else { 1e-9 };
        let error = (back[0] - u[0]).abs().max((back[1] - u[1]).abs());
        // Numbers on a circle's seam may come back from its other end.
        assert!(error < tolerance || (1.0 - error) < tolerance, "{component}: {u:?} {back:?}");
    }
    assert!(met.iter().all(|&count| count > 100), "{met:?}");
    assert!(environment.invert(3, DVec3::Z).is_none());
    assert!(environment.invert(9, DVec3::Z).is_none());
    let total: f64 = (0..5).map(|i| environment.component_pmf(i)).sum();
    assert!((total - 1.0).abs() < 1e-15);
}

#[test]
fn density_is_positive_wherever_light_comes_from() {
    let mut rng = Rng::new(4, Purpose::Test, 0, 0);
    for (width, height) in [(1, 1), (5, 3), (130, 129), (5001, 7), (9, 2500)] {
        for filter in [Filter::Linear, Filter::Nearest] {
            for lit in [0, width * height / 2, width * height - 1] {
                let spot = |x, y| Vec3::splat(if y * width + x == lit { 1.0 } else { 0.0 });
                let sky = only(|e| e.add_image(image(width, height, filter, spot), rotation(), Rgb::ONE));
                let mut bright = 0;
                for _ in 0..2000 {
                    // Half of the directions around the lit texel, up to two texels away.
                    let near = |i: usize, u: f64, n: usize| (i as f64 + 0.5 + 4.0 * (u - 0.5)) / n as f64;
                    let u = rng.pair();
                    let (x, y) = (near(lit % width, u[0], width), near(lit / width, u[1], height));
                    let ((sin, cos), (east, south)) = ((PI * y).sin_cos(), (TAU * (0.5 - x)).sin_cos());
                    let w = rotation() * DVec3::new(sin * east, cos, sin * south);
                    if sky.radiance(w) != Rgb::ZERO {
                        bright += 1;
                        assert!(sky.pdf(w) > 0.0, "{width} × {height} {filter:?} {w}");
                    }
                }
                assert!(bright > 50, "{width} × {height} {filter:?} {bright}");
            }
        }
    }
}

#[test]
fn smooth_skies_are_sampled_almost_perfectly() {
    let sky = only(|e| {
        let color = |x: usize, y: usize| Vec3::splat(1.0 + 0.5 * (x as f32 * 0.1).sin() + y as f32 * 0.01);
        e.add_image(image(256, 128, Filter::Linear, color), rotation(), Rgb::ONE);
    });
    let mut rng = Rng::new(5, Purpose::Test, 0, 0);
    let mut variance = 0.0;
    for _ in 0..10_000 {
        let (_, w) = sky.sample(rng.f64(), rng.pair());
        variance += (scalar(sky.radiance(w)) / sky.pdf(w) / sky.power() - 1.0).powi(2) / 10_000.0;
    }
    assert!(variance < 2e-3, "{variance}");
}

#[test]
fn suns_of_all_sizes_give_their_illuminance() {
    let towards = DVec3::new(0.3, 0.9, -0.2).normalize();
    let mut rng = Rng::new(6, Purpose::Test, 0, 0);
    for angle in [1e-6, 1e-4, 0.0093, 0.5, PI, 4.0] {
        let sun = only(|e| e.add_sun(towards, angle, Rgb::new(100.0, 50.0, 0.0)));
        let (n, mut sum) = (20_000, Rgb::ZERO);
        for _ in 0..n {
            let (_, w) = sun.sample(rng.f64(), rng.pair());
            let density = sun.pdf(w);
            if density > 0.0 {
                sum += sun.radiance(w) * w.dot(towards) / density / f64::from(n);
            }
        }
        let tolerance = if angle < 0.1 { 2e-4 } else { 0.02 };
        assert!((sum / 100.0 - Rgb::new(1.0, 0.5, 0.0)).abs().max_element() < tolerance, "{angle}: {sum}");
        let rim = (0.5 * angle.min(PI)) * 1.01;
        let beside = towards * rim.cos() + towards.any_orthonormal_vector() * rim.sin();
        assert_eq!((sun.radiance(beside), sun.pdf(beside)), (Rgb::ZERO, 0.0));
    }
}

#[test]
fn black_lights_are_no_lights() {
    let mut environment = Environment::default();
    environment.add_uniform(Rgb::ZERO);
    environment.add_image(image(4, 4, Filter::Linear, |_, _| Vec3::splat(-1.0)), DMat3::IDENTITY, Rgb::ONE);
    environment.add_sun(DVec3::Y, 0.01, Rgb::ZERO);
    assert!(environment.is_empty());
    assert_eq!(environment.power(), 0.0);
    let (_, w) = environment.sample(0.5, [0.5; 2]);
    assert_eq!((environment.radiance(w), environment.pdf(w)), (Rgb::ZERO, 0.0));
}
